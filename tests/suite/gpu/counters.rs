//! Counted frames: what must be exact is exact.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::physical::DeviceType;
use fumarole::gpu::{Blend, Counts, Device, Mode, Pass, transfer};

use super::fixtures::{BLACK, Paint, Range, Vertex, color_target, run, shaders, storage_buffer};
use crate::common::gpu_test;

const SIDE: u32 = 9;
const QUADS: u32 = (SIDE - 1) * (SIDE - 1);

/// A grid over the whole target, by indices and as loose triangles.
fn grid() -> (Vec<Vertex>, Vec<u32>) {
    let place = |i: u32| 2.0 * i as f32 / (SIDE - 1) as f32 - 1.0;
    let vertex = |i: u32| Vertex { paint: [1.0; 3], place: [place(i % SIDE), place(i / SIDE)] };
    let vertices = (0..SIDE * SIDE).map(vertex).collect();
    let corners = |quad: u32| {
        let first = quad % (SIDE - 1) + SIDE * (quad / (SIDE - 1));
        [first, first + 1, first + SIDE, first + SIDE, first + 1, first + SIDE + 1]
    };
    (vertices, (0..QUADS).flat_map(corners).collect())
}

fn count(device: &Arc<Device>, pass: &Pass, calls: u32, draw: impl Fn(&mut fumarole::gpu::Draw<'_>)) -> Counts {
    let sample = run(device, Mode::Counted, |frame| frame.graphics(pass, &draw)).unwrap();
    assert_eq!(sample.passes.len(), 1);
    assert_eq!((sample.passes[0].calls, sample.passes[0].gpu_ms), (calls, None));
    sample.passes[0].counts.unwrap()
}

#[test]
fn vertices_primitives_and_samples_of_a_grid_are_exact() {
    gpu_test(|device| {
        let target = color_target(device, "grid", vk::Format::R8G8B8A8_UNORM, 32, 24);
        let (vertices, indices) = grid();
        let loose: Vec<Vertex> = indices.iter().map(|&i| vertices[i as usize]).collect();
        let upload = |name, usage, bytes: &[u8]| transfer::upload(device, name, usage, bytes).unwrap();
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        let vertex_buffer = upload("vertices", usage, bytemuck::cast_slice(&vertices));
        let index_buffer = upload("indices", vk::BufferUsageFlags::INDEX_BUFFER, bytemuck::cast_slice(&indices));
        let loose_buffer = upload("loose vertices", usage, bytemuck::cast_slice(&loose));
        let shaders = shaders(device);
        let indexed = Pass::graphics("indexed", "", "test/grid.vert", "test/asymmetric.frag")
            .vertices::<Vertex>(&vertex_buffer)
            .indices(&index_buffer)
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders)
            .unwrap();
        let loose_pass = Pass::graphics("loose", "", "test/grid.vert", "test/asymmetric.frag")
            .vertices::<Vertex>(&loose_buffer)
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders)
            .unwrap();
        let index_count = indices.len() as u32;

        let counts = count(device, &loose_pass, 1, |draw| draw.vertices(index_count));
        assert_eq!(counts.vertices, Some(u64::from(index_count)));
        assert_eq!(counts.primitives, Some(u64::from(2 * QUADS)));
        assert_eq!(counts.clipped_primitives, Some(u64::from(2 * QUADS)));
        assert_eq!(counts.samples_passed, Some(32 * 24));
        assert_eq!(counts.compute_invocations, None);

        let counts = count(device, &indexed, 1, |draw| draw.indices(index_count));
        assert_eq!(counts.primitives, Some(u64::from(2 * QUADS)));
        assert_eq!(counts.samples_passed, Some(32 * 24));
        // A device may run shared vertices again; lavapipe never does in so small a grid.
        let shaded = counts.vertices.unwrap();
        assert!((u64::from(SIDE * SIDE)..=u64::from(index_count)).contains(&shaded), "{shaded}");
        if device.physical().device_type == DeviceType::Cpu {
            assert_eq!(shaded, u64::from(SIDE * SIDE));
        }

        let twice = count(device, &indexed, 2, |draw| {
            draw.indices(index_count);
            draw.indices(index_count / 2);
        });
        assert_eq!(twice.primitives, Some(u64::from(3 * QUADS)), "all draws of a pass count");
    });
}

#[test]
fn samples_that_a_shader_discards_do_not_count() {
    gpu_test(|device| {
        let target = color_target(device, "chessboard", vk::Format::R8G8B8A8_UNORM, 64, 48);
        let pass = Pass::graphics("checker", "", "common/fullscreen.vert", "test/checker.frag")
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        let counts = count(device, &pass, 1, |draw| draw.vertices(3));
        assert_eq!(counts.samples_passed, Some(64 * 48 / 2));
        assert_eq!((counts.vertices, counts.primitives), (Some(3), Some(1)));
    });
}

#[test]
fn compute_invocations_are_exact_beside_graphics_work() {
    gpu_test(|device| {
        let target = color_target(device, "beside", vk::Format::R8G8B8A8_UNORM, 16, 16);
        let values = storage_buffer(device, "values", &[1.0; 1000]);
        let sums = storage_buffer(device, "sums", &[0.0; 17]);
        let shaders = shaders(device);
        let paint = Pass::graphics("paint", "", "common/fullscreen.vert", "test/constant.frag")
            .constants::<Paint>()
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders)
            .unwrap();
        let sum = Pass::compute("sum", "", "test/sum.comp")
            .constants::<Range>()
            .with("Values", &values)
            .with("Sums", &sums)
            .build(&shaders)
            .unwrap();
        let sample = run(device, Mode::Counted, |frame| {
            frame.graphics(&paint, |draw| {
                draw.constants(&Paint { value: [1.0; 4] }).vertices(3);
            })?;
            for _ in 0..2 {
                frame.compute(&sum, |dispatch| {
                    dispatch.constants(&Range { value_count: 1000 }).threads(1000, 1, 1);
                })?;
            }
            Ok(())
        })
        .unwrap();
        let counts: Vec<Counts> = sample.passes.iter().map(|p| p.counts.unwrap()).collect();
        assert_eq!(counts[0].compute_invocations, None);
        // Whole workgroups of 64, in two calls.
        assert_eq!(counts[1], Counts { compute_invocations: Some(2 * 16 * 64), ..Counts::default() });
        assert_eq!(sample.passes[1].calls, 2);
    });
}

#[test]
fn triangles_outside_of_the_picture_do_not_pass_the_clipper_and_are_no_work_of_its_set_up() {
    gpu_test(|device| {
        let target = color_target(device, "outside", vk::Format::R8G8B8A8_UNORM, 64, 48);
        let pass = Pass::graphics("outside", "", "limits/outside.vert", "limits/constant.frag")
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        let sample = run(device, Mode::Counted, |frame| frame.graphics(&pass, |draw| draw.vertices(300))).unwrap();
        let counts = sample.passes[0].counts.unwrap();
        assert_eq!((counts.vertices, counts.primitives), (Some(300), Some(100)));
        assert_eq!((counts.clipped_primitives, counts.samples_passed), (Some(0), Some(0)));
        assert_eq!(sample.passes[0].work.as_ref().unwrap().triangles, Some(0));
    });
}
