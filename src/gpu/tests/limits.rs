//! Devices of lower limits than the driver's: what is beyond them is refused before Vulkan sees it.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use ash::vk;

use super::super::pass::Pass;
use super::super::profiling_lock::ProfilingLock;
use super::super::render_pass::{Blend, Load};
use super::super::shader::{Compiler, ShaderLibrary};
use super::super::{Buffer, BufferDesc, Device, Error, Image, ImageDesc, Mode, Recorder, Sampler, Topology, transfer};
use super::{alone, open_device};

crate::host_block! {
    struct Splat {
        place: [f32; 2],
        paint: [f32; 4],
    }
}

crate::host_block! {
    struct Quad {
        half_extent: [f32; 2],
    }
}

crate::host_block! {
    struct Range {
        value_count: u32,
    }
}

/// Draws points into a target, with a geometry stage or without.
fn draw(device: &Arc<Device>, geometry: Option<&str>) -> Result<(), Error> {
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
    let desc = ImageDesc::new_2d("target", vk::Format::R8G8B8A8_UNORM, 8, 8).usage(usage);
    let target = Image::new(device, desc)?.view()?;
    let splats = Buffer::new(device, BufferDesc::new("splats", 240).usage(vk::BufferUsageFlags::VERTEX_BUFFER))?;
    let mut pass = Pass::graphics("draw", "", "test/splat-point.vert", "test/splat.frag")
        .vertices::<Splat>(&splats)
        .topology(Topology::Points)
        .color(&target, Load::Discard, Blend::Replace);
    if let Some(geometry) = geometry {
        pass = pass.geometry(geometry).constants::<Quad>();
    }
    pass.build(&ShaderLibrary::new(device, Compiler::Glslang, None)?).map(|_| ())
}

fn points(device: &Arc<Device>) -> Result<(), Error> {
    draw(device, None)
}

fn quads(device: &Arc<Device>) -> Result<(), Error> {
    draw(device, Some("test/strip.geom"))
}

fn area(device: &Arc<Device>) -> Result<(), Error> {
    let pass = Pass::graphics("area", "", "common/fullscreen.vert", "common/empty.frag").extent(8, 8);
    pass.build(&ShaderLibrary::new(device, Compiler::Glslang, None)?).map(|_| ())
}

fn sum(device: &Arc<Device>) -> Result<(), Error> {
    let desc = |name| BufferDesc::new(name, 256).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    let (values, sums) = (Buffer::new(device, desc("values"))?, Buffer::new(device, desc("sums"))?);
    let pass = Pass::compute("sum", "", "test/sum.comp").constants::<Range>();
    let pass = pass.with("Values", &values).with("Sums", &sums);
    pass.build(&ShaderLibrary::new(device, Compiler::Glslang, None)?).map(|_| ())
}

fn smooth(device: &Arc<Device>) -> Result<(), Error> {
    Sampler::new(device, "smooth", vk::Filter::LINEAR).map(|_| ())
}

type Work = fn(&Arc<Device>) -> Result<(), Error>;
type Lower = fn(&mut vk::PhysicalDeviceLimits);

#[test]
fn nothing_is_made_beyond_the_limits() {
    let _alone = alone();
    let cases: [(Work, Lower, &str); 23] = [
        (points, |l| l.max_framebuffer_width = 7, "target: width in texels 8 is beyond this device's limit of 7"),
        (points, |l| l.max_framebuffer_height = 7, "target: height in texels 8 is"),
        (area, |l| l.max_framebuffer_width = 7, "pass area: width in pixels 8 is"),
        (area, |l| l.max_viewport_dimensions = [8, 7], "pass area: height in pixels 8 is"),
        (points, |l| l.max_vertex_input_attributes = 1, "(shader test/splat-point.vert): count of locations of vertex"),
        (points, |l| l.max_vertex_output_components = 3, "count of locations that a stage gives to another 1 is"),
        (points, |l| l.max_fragment_input_components = 3, "count of locations that a stage takes from another 1 is"),
        (points, |l| l.max_fragment_output_attachments = 0, "count of locations of colours 1 is"),
        (
            points,
            |l| l.max_fragment_combined_output_resources = 0,
            "storage images that the fragment stage writes 1 is",
        ),
        (points, |l| l.max_per_stage_resources = 0, "pass draw: count of descriptors and colours of one stage 1 is"),
        (
            quads,
            |l| l.max_geometry_input_components = 3,
            "(shader test/strip.geom): count of locations that a stage takes",
        ),
        (
            quads,
            |l| l.max_geometry_output_components = 3,
            "(shader test/strip.geom): count of locations that a stage gives",
        ),
        (quads, |l| l.max_geometry_output_vertices = 3, "count of vertices of a geometry stage 4 is"),
        (quads, |l| l.max_geometry_total_output_components = 31, "components of a geometry stage's vertices 32 is"),
        (points, |l| l.max_vertex_output_components = 10, "built-ins among them, 11 is"),
        (quads, |l| l.max_geometry_shader_invocations = 0, "count of invocations of a geometry stage 1 is"),
        (
            sum,
            |l| l.max_per_stage_descriptor_storage_buffers = 1,
            "(storage buffers): count of descriptors of one stage 2 is",
        ),
        (sum, |l| l.max_descriptor_set_storage_buffers = 1, "pass sum (storage buffers): count of descriptors 2 is"),
        (sum, |l| l.max_compute_work_group_size[0] = 63, "threads of a workgroup along one axis 64 is"),
        (sum, |l| l.max_compute_work_group_invocations = 63, "threads of a workgroup 64 is"),
        (sum, |l| l.max_compute_shared_memory_size = 255, "bytes that a workgroup shares 256 is"),
        (smooth, |l| l.max_sampler_allocation_count = 0, "smooth: count of samplers 1 is"),
        (sum, |l| l.max_memory_allocation_count = 1, "sums: count of blocks of memory 2 is"),
    ];
    let device = open_device();
    for work in [points, quads, area, sum, smooth] {
        work(&device).unwrap();
    }
    drop(device);
    for (work, lower, expected) in cases {
        let mut device = Arc::into_inner(open_device()).unwrap();
        lower(&mut device.physical.limits);
        let device = Arc::new(device);
        let error = work(&device).unwrap_err();
        assert!(matches!(error, Error::Limit { .. }) && error.to_string().contains(expected), "{expected}: {error}");
        let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
        assert!(messages.is_empty(), "{messages:#?}");
    }
}

/// Columns of the target where points lie that are drawn by these indices, which no vertex buffer bounds.
fn columns(device: &Arc<Device>, indices: &[u32]) -> Vec<usize> {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("test")).unwrap();
    let text = "#version 450\nlayout(location = 0) out vec3 colour;\n\
                void main() {\n\
                    colour = vec3(1.0);\n\
                    gl_PointSize = 1.0;\n\
                    gl_Position = vec4((float(gl_VertexIndex) + 0.5) / 4.0 - 1.0, 0.0, 0.5, 1.0);\n\
                }\n";
    fs::write(folder.path().join("test/asymmetric.vert"), text).unwrap();
    let library = ShaderLibrary::new(device, Compiler::Glslang, Some(folder.path())).unwrap();
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
    let target = ImageDesc::new_2d("target", vk::Format::R8G8B8A8_UNORM, 8, 1).usage(usage);
    let target = Image::new(device, target).unwrap().view().unwrap();
    let bytes: &[u8] = bytemuck::cast_slice(indices);
    let buffer = transfer::upload(device, "indices", vk::BufferUsageFlags::INDEX_BUFFER, bytes).unwrap();
    let pass = Pass::graphics("draw", "", "test/asymmetric.vert", "test/asymmetric.frag")
        .indices(&buffer)
        .topology(Topology::Points)
        .color(&target, Load::Clear([0.0; 4]), Blend::Replace)
        .build(&library)
        .unwrap();
    assert_eq!(pass.info().reads, ["indices"]);
    let mut recorder = Recorder::new(device).unwrap();
    let count = indices.len() as u32;
    recorder.run(Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.indices(count))).unwrap();
    let texels = transfer::read_image(device, &target).unwrap();
    texels.chunks_exact(4).enumerate().filter(|(_, texel)| texel[0] > 0).map(|(column, _)| column).collect()
}

#[test]
fn indices_beyond_the_largest_are_not_drawn() {
    let _alone = alone();
    // As many as lie in two rows of workgroups of a device that takes one along x.
    let mut indices = vec![0; 100];
    (indices[1], indices[2], indices[98], indices[99]) = (3, 4_000_000_000, 5, 7);
    let device = open_device();
    assert_eq!(columns(&device, &indices), [0, 3, 5, 7]);
    let mut device = Arc::into_inner(device).unwrap();
    device.physical.has_full_indices = false;
    device.physical.limits.max_draw_indexed_index_value = 6;
    device.physical.limits.max_compute_work_group_count[0] = 1;
    let device = Arc::new(device);
    assert_eq!(columns(&device, &indices), [0, 3, 5, 6]);
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{messages:#?}");
}

#[test]
fn a_device_has_its_profiling_lock_once() {
    let _alone = alone();
    let device = open_device();
    device.is_profiling.store(true, Ordering::Relaxed);
    let refused = ProfilingLock::take(&device).map(|_| ()).unwrap_err().to_string();
    assert!(refused.ends_with("the profiling lock, which another recorder holds"), "{refused}");
}
