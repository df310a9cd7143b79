//! A pass that reads what no pass wrote is refused when it is recorded.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, DepthTest, Device, Error, Image, ImageDesc, ImageView, Load, Location, Mode, Pass,
    Recorder, transfer,
};

use super::fixtures::{BLACK, Range, Vertex, color_target, paint, paint_pass, run, shaders, storage_buffer};
use crate::common::gpu_test;

fn unwritten_buffer(device: &Arc<Device>, name: &str, size_bytes: u64) -> Arc<Buffer> {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::VERTEX_BUFFER;
    Buffer::new(device, BufferDesc::new(name, size_bytes).usage(usage)).unwrap()
}

fn assert_refused<T>(outcome: Result<T, Error>, pass_name: &str, resource_name: &str) {
    match outcome.map(|_| ()) {
        Err(error @ Error::ReadBeforeWrite { .. }) => {
            assert_eq!(
                error.to_string(),
                format!("pass {pass_name}: reads {resource_name}, which no pass has written")
            );
        }
        other => panic!("{pass_name} reading {resource_name}: {other:?}"),
    }
}

/// Records `pass` alone, then shows that the recorder still works.
fn assert_graphics_refused(device: &Arc<Device>, pass: &Pass, resource_name: &str) {
    let mut recorder = Recorder::new(device).unwrap();
    let outcome = recorder.run(Mode::Plain, |frame| frame.graphics(pass, |draw| draw.vertices(3)));
    assert_refused(outcome, pass.info().name, resource_name);
    let target = color_target(device, "next", vk::Format::R32_SFLOAT, 4, 4);
    let next = paint_pass(&shaders(device), "next", &target, BLACK, Blend::Replace);
    recorder.run(Mode::Plain, |frame| paint(frame, &next, 1.0)).unwrap();
}

fn layered_image(device: &Arc<Device>, name: &str) -> Arc<Image> {
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    Image::new(device, ImageDesc::new_2d(name, vk::Format::R32_SFLOAT, 4, 4).layers(2).usage(usage)).unwrap()
}

fn sampling_pass(device: &Arc<Device>, layers: &Arc<ImageView>) -> Pass {
    let target = color_target(device, "seen", vk::Format::R32G32_SFLOAT, 4, 4);
    Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag")
        .with("layers", layers)
        .color(&target, Load::Discard, Blend::Replace)
        .build(&shaders(device))
        .unwrap()
}

#[test]
fn a_sampled_image_must_be_written_in_every_layer() {
    gpu_test(|device| {
        let none = layered_image(device, "unwritten layers");
        assert_graphics_refused(device, &sampling_pass(device, &none.view().unwrap()), "unwritten layers");

        let half = layered_image(device, "half-written layers");
        let first = half.layer(0).unwrap();
        let paint_first = paint_pass(&shaders(device), "paint-first", &first, BLACK, Blend::Replace);
        run(device, Mode::Plain, |frame| paint(frame, &paint_first, 1.0)).unwrap();
        assert_graphics_refused(device, &sampling_pass(device, &half.view().unwrap()), "half-written layers");
    });
}

#[test]
fn a_storage_buffer_that_is_only_read_must_be_written_in_every_byte() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let sums = storage_buffer(device, "sums", &[0.0; 2]);
        let refuse = |values: &Arc<Buffer>| {
            let pass = Pass::compute("sum", "", "test/sum.comp")
                .constants::<Range>()
                .with("Values", values)
                .with("Sums", &sums)
                .build(&shaders)
                .unwrap();
            let outcome = run(device, Mode::Plain, |frame| {
                frame.compute(&pass, |dispatch| {
                    dispatch.constants(&Range { value_count: 64 }).threads(64, 1, 1);
                })
            });
            assert_refused(outcome, "sum", values.name());
        };
        refuse(&unwritten_buffer(device, "unwritten values", 256));
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let desc = BufferDesc::new("half-written values", 256).usage(usage).location(Location::Upload);
        let half = Buffer::new(device, desc).unwrap();
        half.write(0, &[0; 128]).unwrap();
        refuse(&half);
    });
}

#[test]
fn a_target_that_keeps_its_contents_must_have_some() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let color = color_target(device, "empty colour", vk::Format::R32_SFLOAT, 4, 4);
        let keep_color = paint_pass(&shaders, "keep-colour", &color, Load::Keep, Blend::Add);
        assert_graphics_refused(device, &keep_color, "empty colour");

        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let desc = ImageDesc::new_2d("empty depth", vk::Format::D32_SFLOAT, 4, 4).usage(usage);
        for (name, test) in [("keep-depth", DepthTest::LessWrite), ("test-depth", DepthTest::LessReadOnly)] {
            let depth = Image::new(device, desc.clone()).unwrap().view().unwrap();
            let pass = Pass::graphics(name, "", "test/asymmetric.vert", "test/asymmetric.frag")
                .color(&color_target(device, "drawn", vk::Format::R8G8B8A8_UNORM, 4, 4), BLACK, Blend::Replace)
                .depth(&depth, Load::Keep, test)
                .build(&shaders)
                .unwrap();
            assert_graphics_refused(device, &pass, "empty depth");
        }
    });
}

#[test]
fn vertices_and_copies_must_have_a_source() {
    gpu_test(|device| {
        let vertices = unwritten_buffer(device, "empty vertices", 60);
        let pass = Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag")
            .vertices::<Vertex>(&vertices)
            .color(&color_target(device, "drawn", vk::Format::R8G8B8A8_UNORM, 4, 4), BLACK, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        assert_graphics_refused(device, &pass, "empty vertices");

        let source = unwritten_buffer(device, "empty source", 64);
        let target = Buffer::new(device, BufferDesc::new("copy", 64).location(Location::Readback)).unwrap();
        let copy = Pass::copy("copy-out", "", &source, &target);
        assert_refused(run(device, Mode::Plain, |frame| frame.copy(&copy)), "copy-out", "empty source");
        assert_refused(transfer::read_buffer(device, &source), "readback", "empty source");
        let image = color_target(device, "empty image", vk::Format::R32_SFLOAT, 4, 4);
        assert_refused(transfer::read_image(device, &image), "readback", "empty image");
    });
}

#[test]
fn a_kind_of_recording_takes_its_kind_of_pass() {
    gpu_test(|device| {
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let graphics = paint_pass(&shaders(device), "paint", &target, BLACK, Blend::Replace);
        let message =
            |outcome: Result<_, Error>| outcome.map(|_: fumarole::gpu::FrameSample| ()).unwrap_err().to_string();
        let compute = run(device, Mode::Plain, |frame| frame.compute(&graphics, |_| {}));
        assert_eq!(message(compute), "pass paint: it is not a compute pass");
        let copy = run(device, Mode::Plain, |frame| frame.copy(&graphics));
        assert_eq!(message(copy), "pass paint: it is not a copy pass");
    });
}
