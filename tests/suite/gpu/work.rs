//! Bytes, samples and triangles of counted frames, by hand.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, Bytes, DepthTest, Device, Error, Frame, Image, ImageDesc, ImageView, Kept, Load, Mode,
    Pass, Recorder, Work, transfer,
};
use fumarole::host_block;

use super::fixtures::{Paint, Range, Vertex, color_target, shaders, storage_buffer};
use crate::common::gpu_test;

host_block! {
    /// `limits/multiply-add.comp`
    struct MultiplyAdd {
        iterations: u32,
        factor: f32,
    }
}

const PIXELS: u64 = 32 * 16;

fn work_of(device: &Arc<Device>, record: impl Fn(&mut Frame<'_>) -> Result<(), Error>) -> Work {
    let mut recorder = Recorder::new(device).unwrap();
    let sample = recorder.run(Mode::Counted, |frame| record(frame)).unwrap();
    sample.passes.last().unwrap().work.clone().unwrap()
}

fn bytes(read: u64, written: u64) -> Bytes {
    Bytes { read, written }
}

fn target(device: &Arc<Device>, format: vk::Format) -> Arc<ImageView> {
    color_target(device, "work", format, 32, 16)
}

/// Paints the whole target once a draw.
fn paint(frame: &mut Frame<'_>, pass: &Pass, draws: u32) -> Result<(), Error> {
    frame.graphics(pass, |draw| {
        draw.constants(&Paint { value: [0.1; 4] });
        (0..draws).for_each(|_| {
            draw.vertices(3);
        });
    })
}

fn painter(device: &Arc<Device>, target: &Arc<ImageView>, load: Load, blend: Blend) -> Pass {
    Pass::graphics("paint", "", "common/fullscreen.vert", "test/constant.frag")
        .constants::<Paint>()
        .color(target, load, blend)
        .build(&shaders(device))
        .unwrap()
}

#[test]
fn attachments_count_by_the_samples_kept() {
    gpu_test(|device| {
        let format = vk::Format::R16G16B16A16_SFLOAT;
        let target = target(device, format);
        let cleared = painter(device, &target, Load::Clear([0.0; 4]), Blend::Add);
        let work = work_of(device, |frame| paint(frame, &cleared, 3));
        let samples = 3 * PIXELS;
        // Each sample is read and written, and the clear writes once more; memory sees each pixel once.
        assert_eq!(work.bytes, bytes(samples * 8, (samples + PIXELS) * 8));
        assert_eq!(work.bytes_at_most, Some(work.bytes));
        assert_eq!(work.memory_bytes, PIXELS * 8);
        assert_eq!(work.kept, [Kept { format, blends: true, samples }]);
        assert_eq!((work.triangles, work.launches), (Some(3), 1));
        assert!(work.uncertain.is_empty());

        // Recorded twice, the second over what is there.
        let kept = painter(device, &target, Load::Keep, Blend::Add);
        let twice = work_of(device, |frame| {
            paint(frame, &cleared, 1)?;
            paint(frame, &kept, 1)
        });
        assert_eq!(twice.bytes, bytes(2 * PIXELS * 8, 3 * PIXELS * 8));
        assert_eq!((twice.memory_bytes, twice.launches), (3 * PIXELS * 8, 2));

        let masked = painter(device, &target, Load::Keep, Blend::Masked);
        let nothing = work_of(device, |frame| {
            paint(frame, &cleared, 1)?;
            paint(frame, &masked, 1)
        });
        assert_eq!(nothing.bytes, bytes(PIXELS * 8, 2 * PIXELS * 8), "a masked target gets nothing");
    });
}

#[test]
fn a_depth_test_reads_and_writes_what_it_keeps() {
    gpu_test(|device| {
        let desc = ImageDesc::new_2d("depth", vk::Format::D32_SFLOAT, 32, 16);
        let depth = Image::new(device, desc.usage(vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)).unwrap();
        let depth = depth.view().unwrap();
        let target = target(device, vk::Format::R8G8B8A8_UNORM);
        let pass = Pass::graphics("tested", "", "common/fullscreen.vert", "test/constant.frag")
            .constants::<Paint>()
            .color(&target, Load::Discard, Blend::Replace)
            .depth(&depth, Load::Clear([1.0, 0.0, 0.0, 0.0]), DepthTest::LessWrite)
            .build(&shaders(device))
            .unwrap();
        // The second draw is no nearer.
        let work = work_of(device, |frame| paint(frame, &pass, 2));
        assert_eq!(work.bytes, bytes(PIXELS * 4, PIXELS * 4 + PIXELS * 4 + PIXELS * 4));
        assert_eq!(work.memory_bytes, 2 * PIXELS * 4);
    });
}

#[test]
fn copies_and_fetches_are_certain_and_indexed_vertices_are_not() {
    gpu_test(|device| {
        let from = storage_buffer(device, "from", &[1.0; 250]);
        let to = Buffer::new(device, BufferDesc::new("to", 4000)).unwrap();
        let copy = Pass::copy("copy", "", &from, &to);
        let work = work_of(device, |frame| frame.copy(&copy));
        assert_eq!((work.bytes, work.memory_bytes, work.launches), (bytes(1000, 1000), 2000, 0));

        let vertex = |x: f32, y: f32| Vertex { paint: [1.0; 3], place: [x, y] };
        let vertices = [vertex(-1.0, -1.0), vertex(3.0, -1.0), vertex(-1.0, 3.0), vertex(0.0, 0.0)];
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        let vertices = transfer::upload(device, "vertices", usage, bytemuck::cast_slice(&vertices)).unwrap();
        let usage = vk::BufferUsageFlags::INDEX_BUFFER;
        let indices = transfer::upload(device, "indices", usage, bytemuck::cast_slice(&[0u32, 1, 2, 0])).unwrap();
        let target = target(device, vk::Format::R8G8B8A8_UNORM);
        let grid =
            || {
                Pass::graphics("grid", "", "test/grid.vert", "test/asymmetric.frag")
                    .vertices::<Vertex>(&vertices)
                    .color(&target, Load::Discard, Blend::Replace)
            };
        let loose = grid().build(&shaders(device)).unwrap();
        let work = work_of(device, |frame| frame.graphics(&loose, |draw| draw.vertices(3)));
        assert_eq!(work.bytes, bytes(3 * 20, PIXELS * 4));
        let indexed = grid().indices(&indices).build(&shaders(device)).unwrap();
        let work = work_of(device, |frame| frame.graphics(&indexed, |draw| draw.indices(3)));
        assert_eq!(work.bytes, bytes(3 * 4, PIXELS * 4));
        assert_eq!(work.bytes_at_most, Some(bytes(3 * 4 + 4 * 20, PIXELS * 4)));
        assert_eq!(work.uncertain, ["vertices"]);
    });
}

#[test]
fn what_is_merely_bound_is_at_most_unless_it_is_declared_whole() {
    gpu_test(|device| {
        let results = storage_buffer(device, "results", &[0.0; 64 * 4]);
        let build = |whole: &[&'static str]| {
            Pass::compute("multiply-add", "", "limits/multiply-add.comp")
                .with("results", &results)
                .whole(whole)
                .multiply_adds(|counts| Some(32 * 5 * counts.compute_invocations?))
                .constants::<MultiplyAdd>()
                .build(&shaders(device))
        };
        let work = |pass: &Pass| {
            work_of(device, |frame| {
                frame.compute(pass, |dispatch| {
                    dispatch.constants(&MultiplyAdd { iterations: 5, factor: 0.5 }).threads(64, 1, 1);
                })
            })
        };
        let bound = work(&build(&[]).unwrap());
        assert_eq!((bound.bytes, bound.memory_bytes), (bytes(0, 0), 0));
        assert_eq!(bound.bytes_at_most, Some(bytes(1024, 1024)));
        assert_eq!(bound.uncertain, ["results"]);
        assert_eq!(bound.multiply_adds, Some(32 * 5 * 64));
        let whole = work(&build(&["results"]).unwrap());
        assert_eq!((whole.bytes, whole.memory_bytes), (bytes(0, 1024), 1024));
        assert_eq!(whole.bytes_at_most, Some(bytes(0, 1024)));
        let error = build(&["nothing"]).err().unwrap().to_string();
        assert!(error.contains("declares nothing whole"), "{error}");

        // A shader that reads has its buffers among the reads.
        let values = storage_buffer(device, "values", &[1.0; 100]);
        let sum = storage_buffer(device, "sum", &[0.0; 4]);
        let pass = Pass::compute("sum", "", "test/sum.comp")
            .with("Values", &values)
            .with("Sums", &sum)
            .constants::<Range>()
            .build(&shaders(device))
            .unwrap();
        let work = work_of(device, |frame| {
            frame.compute(&pass, |dispatch| {
                dispatch.constants(&Range { value_count: 100 }).threads(1, 1, 1);
            })
        });
        assert_eq!(work.bytes_at_most, Some(bytes(400 + 16, 16)));
        assert_eq!(work.uncertain, ["sum", "values"]);
    });
}
