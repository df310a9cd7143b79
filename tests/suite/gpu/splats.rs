//! Splats three ways: by a geometry stage, as instanced strips, as large points.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, Compiler, Device, Feature, Location, Mode, Pass, ShaderLibrary, Topology,
};
use fumarole::host_block;

use super::fixtures::{BLACK, color_target, run, shaders, texels};
use crate::common::{gpu_test, shaders_by};

host_block! {
    /// `test/splat-point.vert` and `test/splat-strip.vert`
    struct Splat {
        place: [f32; 2],
        paint: [f32; 4],
    }
}

host_block! {
    struct Quad {
        half_extent: [f32; 2],
    }
}

/// Two that overlap in a target of 8 x 4 texels.
const SPLATS: [Splat; 2] = [
    Splat { place: [-0.5, -0.25], paint: [1.0, 0.0, 0.0, 1.0] },
    Splat { place: [0.25, 0.25], paint: [0.0, 0.5, 0.0, 1.0] },
];

/// 4 x 3 texel centres, none on an edge.
const QUAD: Quad = Quad { half_extent: [0.5, 0.6] };

fn vertices(device: &Arc<Device>) -> Arc<Buffer> {
    let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
    fumarole::gpu::transfer::upload(device, "splats", usage, bytemuck::cast_slice(&SPLATS)).unwrap()
}

/// The red and green of a target of 8 x 4 texels after the splats are added up.
fn drawn(device: &Arc<Device>, shaders: &ShaderLibrary, geometry: bool) -> (Vec<[f32; 4]>, Compiler) {
    let target = color_target(device, "target", vk::Format::R32G32B32A32_SFLOAT, 8, 4);
    let splats = vertices(device);
    let pass = if geometry {
        Pass::graphics("splats", "", "test/splat-point.vert", "test/splat.frag")
            .geometry("test/strip.geom")
            .vertices::<Splat>(&splats)
            .topology(Topology::Points)
    } else {
        Pass::graphics("splats", "", "test/splat-strip.vert", "test/splat.frag")
            .instances::<Splat>(&splats)
            .topology(Topology::TriangleStrip)
    };
    let pass = pass.constants::<Quad>().color(&target, BLACK, Blend::Add).build(shaders).unwrap();
    run(device, Mode::Counted, |frame| {
        frame.graphics(&pass, |draw| {
            draw.constants(&QUAD);
            if geometry {
                draw.vertices(2)
            } else {
                draw.instances(4, 2)
            };
        })
    })
    .unwrap();
    (texels(device, &target), pass.info().compiler.unwrap())
}

#[test]
fn geometry_stages_and_instanced_strips_draw_the_same_quads() {
    gpu_test(|device| {
        let [geometry, strips] = [true, false].map(|geometry| drawn(device, &shaders(device), geometry).0);
        assert_eq!(geometry, strips);
        for (i, texel) in geometry.iter().enumerate() {
            // Texel centres in normalised device coordinates.
            let (x, y) = ((i % 8) as f32 / 4.0 - 0.875, (i / 8) as f32 / 2.0 - 0.75);
            let inside = |s: &Splat| (x - s.place[0]).abs() < 0.5 && (y - s.place[1]).abs() < 0.6;
            let sum = |channel: usize| SPLATS.iter().filter(|s| inside(s)).map(|s| s.paint[channel]).sum::<f32>();
            assert_eq!([texel[0], texel[1]], [sum(0), sum(1)], "texel {i}");
        }
        assert!(geometry.iter().any(|t| t[0] > 0.0 && t[1] > 0.0), "they overlap");
    });
}

#[test]
fn a_pass_with_a_geometry_stage_runs_one_compiler() {
    gpu_test(|device| {
        let naga = shaders_by(device, Compiler::Naga);
        assert_eq!(drawn(device, &naga, true).1, Compiler::Glslang);
        assert_eq!(drawn(device, &naga, false).1, Compiler::Naga);
    });
}

#[test]
fn points_cover_their_size() {
    gpu_test(|device| {
        assert!(device.physical().has(Feature::LargePoints));
        let target = color_target(device, "target", vk::Format::R32G32B32A32_SFLOAT, 16, 16);
        let splats = vertices(device);
        let pass = Pass::graphics("points", "", "test/splat-point.vert", "test/splat.frag")
            .vertices::<Splat>(&splats)
            .topology(Topology::Points)
            .color(&target, BLACK, Blend::Add)
            .build(&shaders(device))
            .unwrap();
        run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.vertices(1))).unwrap();
        let found: Vec<[f32; 4]> = texels(device, &target);
        // 4 texels a side, as `test/splat-point.vert` says, around (4, 6).
        for (i, texel) in found.iter().enumerate() {
            let (column, row) = (i % 16, i / 16);
            let inside = (2..6).contains(&column) && (4..8).contains(&row);
            assert_eq!(texel[0], if inside { 1.0 } else { 0.0 }, "{column} {row}");
        }
    });
}

/// A buffer that the host writes anew, at another length each time, stays one piece to the barriers.
#[test]
fn host_writes_of_any_length_may_be_drawn_again_and_again() {
    gpu_test(|device| {
        let target = color_target(device, "target", vk::Format::R32G32B32A32_SFLOAT, 8, 4);
        let desc = BufferDesc::new("splats", 100 * size_of::<Splat>() as u64)
            .usage(vk::BufferUsageFlags::VERTEX_BUFFER)
            .location(Location::Upload);
        let buffer = Buffer::new(device, desc).unwrap();
        let pass = Pass::graphics("splats", "", "test/splat-strip.vert", "test/splat.frag")
            .instances::<Splat>(&buffer)
            .topology(Topology::TriangleStrip)
            .constants::<Quad>()
            .color(&target, BLACK, Blend::Add)
            .build(&shaders(device))
            .unwrap();
        let draw = |count: u32| {
            run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.constants(&QUAD).instances(4, count)))
        };
        // All of it is bound, so all of it must hold something.
        buffer.write(0, bytemuck::bytes_of(&SPLATS[0])).unwrap();
        assert!(draw(1).unwrap_err().to_string().contains("no pass has written"));
        buffer.write(0, &vec![0; buffer.size_bytes() as usize]).unwrap();
        for count in [1, 7, 3, 100, 2] {
            buffer.write(0, bytemuck::cast_slice(&vec![SPLATS[0]; count as usize])).unwrap();
            draw(count).unwrap();
            let sum: f32 = texels::<[f32; 4]>(device, &target).iter().map(|t| t[0]).sum();
            assert_eq!(sum, 12.0 * count as f32);
        }
    });
}
