//! Sequences of passes about the same resources: the derived barriers satisfy synchronization validation, and the
//! contents come through.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, DepthTest, Device, Image, ImageDesc, ImageView, Load, Location, Mode, Pass, PassKind,
    Recorder, Track,
};

use super::fixtures::{
    Advance, BLACK, Vertex, color_target, paint, paint_pass, run, shaders, storage_buffer, texels, values,
};
use crate::common::gpu_test;

#[test]
fn two_layers_written_by_two_passes_are_read_together() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let layers = |name| {
            Image::new(device, ImageDesc::new_2d(name, vk::Format::R32_SFLOAT, 8, 8).layers(2).usage(usage)).unwrap()
        };
        let image = layers("layers");
        let first = paint_pass(&shaders, "paint-layer", &image.layer(0).unwrap(), Load::Discard, Blend::Replace);
        let second = first.rebind().color(0, &image.layer(1).unwrap(), Load::Discard).build(&shaders).unwrap();
        let seen = color_target(device, "seen", vk::Format::R32G32B32A32_SFLOAT, 8, 8);
        let look = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag")
            .with("layers", &image.view().unwrap())
            .color(&seen, Load::Discard, Blend::Replace)
            .build(&shaders)
            .unwrap();
        for (a, b) in [(3.0, 5.0), (-1.0, 7.5)] {
            let sample = run(device, Mode::Plain, |frame| {
                paint(frame, &first, a)?;
                paint(frame, &second, b)?;
                frame.graphics(&look, |draw| draw.vertices(3))
            })
            .unwrap();
            assert_eq!(texels::<[f32; 4]>(device, &seen), [[a, b, 0.0, 1.0]; 64]);
            let calls: Vec<_> = sample.passes.iter().map(|p| (p.info.name, p.calls)).collect();
            assert_eq!(calls, [("paint-layer", 2), ("look", 1)], "a rebound pass is the same pass");
        }

        // About another image altogether: the pipeline is shared, the descriptor is not.
        let other = layers("other layers");
        let paint_other = |layer| first.rebind().color(0, &other.layer(layer).unwrap(), BLACK).build(&shaders).unwrap();
        let look_other = look.rebind().with("layers", &other.view().unwrap()).build(&shaders).unwrap();
        let (clear_first, clear_second) = (paint_other(0), paint_other(1));
        run(device, Mode::Plain, |frame| {
            paint(frame, &clear_first, 11.0)?;
            frame.graphics(&clear_second, |_| {})?;
            frame.graphics(&look_other, |draw| draw.vertices(3))
        })
        .unwrap();
        assert_eq!(texels::<[f32; 4]>(device, &seen), [[11.0, 0.0, 0.0, 1.0]; 64]);
    });
}

#[test]
fn a_target_keeps_sums_over_passes_and_frames() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let target = color_target(device, "sum", vk::Format::R32_SFLOAT, 8, 8);
        let clear = paint_pass(&shaders, "clear", &target, BLACK, Blend::Add);
        let add = paint_pass(&shaders, "add", &target, Load::Keep, Blend::Add);
        run(device, Mode::Plain, |frame| {
            paint(frame, &clear, 1.0)?;
            paint(frame, &add, 2.0)?;
            paint(frame, &add, 4.0)
        })
        .unwrap();
        assert_eq!(texels::<f32>(device, &target), [7.0; 64]);
        // After the readback, in another submission.
        run(device, Mode::Plain, |frame| paint(frame, &add, 8.0)).unwrap();
        assert_eq!(texels::<f32>(device, &target), [15.0; 64]);
    });
}

#[test]
fn stored_values_are_fetched_as_vertices_and_stored_again() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];
        let vertices = corners.map(|place| Vertex { paint: [0.5; 3], place });
        // One less everywhere: the first step of the kernel puts it right.
        let start: Vec<f32> = bytemuck::cast_slice::<Vertex, f32>(&vertices).iter().map(|v| v - 1.0).collect();
        let buffer = storage_buffer(device, "vertices", &start);
        let advance = Pass::compute("advance", "", "test/advance.comp")
            .constants::<Advance>()
            .with("Values", &buffer)
            .build(&shaders)
            .unwrap();
        let target = color_target(device, "drawn", vk::Format::R32G32B32A32_SFLOAT, 8, 8);
        let draw = Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag")
            .vertices::<Vertex>(&buffer)
            .color(&target, BLACK, Blend::Replace)
            .build(&shaders)
            .unwrap();
        let readback = Buffer::new(device, BufferDesc::new("copy", 60).location(Location::Readback)).unwrap();
        let copy = Pass::copy("copy-out", "", &buffer, &readback);
        let constants = Advance { value_count: 15, step: 1.0 };
        let sample = run(device, Mode::Plain, |frame| {
            frame.compute(&advance, |dispatch| dispatch.constants(&constants).threads(15, 1, 1))?;
            frame.graphics(&draw, |draw| draw.vertices(3))?;
            frame.compute(&advance, |dispatch| dispatch.constants(&constants).threads(15, 1, 1))?;
            frame.copy(&copy)
        })
        .unwrap();
        assert_eq!(texels::<[f32; 4]>(device, &target), [[0.5, 0.5, 0.5, 1.0]; 64], "the vertices of the first step");
        let expected: Vec<f32> = start.iter().map(|v| v + 2.0).collect();
        assert_eq!(values(device, &buffer), expected);
        let copied = readback.read(60, bytemuck::pod_collect_to_vec::<u8, f32>).unwrap();
        assert_eq!(copied, expected);
        let kinds: Vec<PassKind> = sample.passes.iter().map(|p| p.info.kind).collect();
        assert_eq!(kinds, [PassKind::Compute, PassKind::Graphics, PassKind::Transfer]);
    });
}

fn depth_target(device: &Arc<Device>) -> Arc<ImageView> {
    let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    let desc = ImageDesc::new_2d("depth", vk::Format::D32_SFLOAT, 8, 8).usage(usage);
    Image::new(device, desc).unwrap().view().unwrap()
}

#[test]
fn depth_is_written_tested_read_only_read_back_and_tested_again() {
    gpu_test(|device| {
        let shaders = shaders(device);
        let depth = depth_target(device);
        let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]];
        let vertices = corners.map(|place| Vertex { paint: [0.5; 3], place });
        let buffer = storage_buffer(device, "vertices", bytemuck::cast_slice(&vertices));
        let target = color_target(device, "drawn", vk::Format::R32G32B32A32_SFLOAT, 8, 8);
        let draw = |name, color_load, load, test| {
            Pass::graphics(name, "", "test/grid.vert", "test/asymmetric.frag")
                .vertices::<Vertex>(&buffer)
                .color(&target, color_load, Blend::Add)
                .depth(&depth, load, test)
                .build(&shaders)
                .unwrap()
        };
        // `test/grid.vert` draws at depth 0.5.
        let write = draw("write", BLACK, Load::Clear([0.75, 0.0, 0.0, 0.0]), DepthTest::LessWrite);
        let equal = draw("equal", Load::Keep, Load::Keep, DepthTest::EqualReadOnly);
        let less = draw("less", Load::Keep, Load::Keep, DepthTest::LessReadOnly);
        let write_again = draw("write-again", Load::Keep, Load::Keep, DepthTest::LessWrite);
        let passes = [&write, &equal, &equal, &less, &write_again, &equal];
        for _ in 0..2 {
            run(device, Mode::Plain, |frame| {
                passes.into_iter().try_for_each(|pass| frame.graphics(pass, |draw| draw.vertices(3)))
            })
            .unwrap();
            assert_eq!(texels::<f32>(device, &depth), [0.5; 64]);
            // Written once, and equal three times; nothing is nearer than itself.
            let seen = texels::<[f32; 4]>(device, &target);
            assert_eq!(seen[0][..3], [2.0; 3]);
            assert_eq!(seen, [seen[0]; 64]);
        }
    });
}

#[test]
fn the_host_reads_in_the_middle_of_a_frame() {
    gpu_test(|device| {
        let buffer = storage_buffer(device, "counters", &[0.0; 4]);
        let advance = Pass::compute("advance", "", "test/advance.comp")
            .constants::<Advance>()
            .with("Values", &buffer)
            .build(&shaders(device))
            .unwrap();
        let readback = Buffer::new(device, BufferDesc::new("copy", 16).location(Location::Readback)).unwrap();
        let copy = Pass::copy("copy-out", "", &buffer, &readback);
        for mode in [Mode::Plain, Mode::Bracketed, Mode::Timestamped, Mode::Counted] {
            let mut seen = Vec::new();
            let sample = run(device, mode, |frame| {
                for step in [1.0, 10.0] {
                    frame.compute(&advance, |dispatch| {
                        dispatch.constants(&Advance { value_count: 4, step }).threads(4, 1, 1);
                    })?;
                    frame.copy(&copy)?;
                    frame.wait_for(&copy)?;
                    seen.push(readback.read(4, bytemuck::pod_read_unaligned::<f32>)?);
                }
                Ok(())
            })
            .unwrap();
            assert_eq!(seen[1] - seen[0], 10.0, "{mode:?}");
            let [advanced, copied] = &sample.passes[..] else { panic!("{mode:?}: {:?}", sample.passes) };
            assert_eq!((advanced.calls, advanced.submission), (2, 0), "{mode:?}");
            assert!(advanced.wait_ms.is_none() && copied.wait_ms.is_some_and(|ms| ms <= sample.frame_ms), "{mode:?}");
            let on_device = sample.spans.iter().filter(|span| span.track == Track::Gpu).count();
            // Calls of passes, or submissions: two that the host waits for, and the last.
            let expected = match mode {
                Mode::Timestamped => 4,
                Mode::Bracketed => 3,
                Mode::Plain | Mode::Counted => 0,
            };
            assert_eq!(on_device, expected, "{mode:?}");
            if let Some(counts) = advanced.counts {
                assert_eq!(counts.compute_invocations, Some(2 * 64), "both submissions count");
            }
        }
        assert_eq!(values(device, &buffer), [44.0; 4]);
    });
}

/// Two pictures of 4 x 4 texels, and the passes `first` and `second` that clear and paint one each.
fn two_paints(device: &Arc<Device>) -> ([Arc<ImageView>; 2], [Pass; 2]) {
    let shaders = shaders(device);
    let targets = ["a", "b"].map(|name| color_target(device, name, vk::Format::R32_SFLOAT, 4, 4));
    let passes =
        [("first", 0), ("second", 1)].map(|(name, at)| paint_pass(&shaders, name, &targets[at], BLACK, Blend::Replace));
    (targets, passes)
}

#[test]
fn work_that_is_parted_is_waited_for_by_no_pass() {
    gpu_test(|device| {
        let (targets, passes) = two_paints(device);
        for mode in [Mode::Plain, Mode::Bracketed, Mode::Timestamped, Mode::Counted] {
            let sample = run(device, mode, |frame| {
                for (pass, value) in [(&passes[0], 1.0), (&passes[1], 2.0), (&passes[1], 3.0)] {
                    frame.reserve_work(pass, 2.0, 3.0)?;
                    paint(frame, pass, value)?;
                }
                Ok(())
            })
            .unwrap();
            let listed: Vec<_> =
                sample.passes.iter().map(|pass| (pass.info.name, pass.calls, pass.submission)).collect();
            assert_eq!(listed, [("first", 1, 0), ("second", 2, 1)], "{mode:?}");
            assert!(sample.passes.iter().all(|pass| pass.wait_ms.is_none()), "{mode:?}: nothing is read back");
            // Behind what was handed in, not before what comes next.
            let waits = sample.spans.iter().filter(|span| span.track == Track::Wait).map(|span| span.pass);
            assert_eq!(waits.collect::<Vec<_>>(), [Some(0), Some(1), None], "{mode:?}");
            let found: Vec<f32> = targets.iter().map(|target| texels::<f32>(device, target)[5]).collect();
            assert_eq!(found, [1.0, 3.0], "{mode:?}");
        }
    });
}

#[test]
fn passes_that_are_submitted_one_by_one_draw_the_same() {
    gpu_test(|device| {
        let (targets, passes) = two_paints(device);
        let mut recorder = Recorder::new(device).unwrap();
        for (is_wanted, mode, submissions) in [
            (true, Mode::Plain, [0, 1]),
            (false, Mode::Plain, [0, 0]),
            // What is timed is one submission.
            (true, Mode::Timestamped, [0, 0]),
        ] {
            recorder.submit_by_pass(is_wanted);
            let sample = recorder.run(mode, |frame| {
                paint(frame, &passes[0], 1.0)?;
                paint(frame, &passes[0], 2.0)?;
                paint(frame, &passes[1], 3.0)?;
                paint(frame, &passes[0], 4.0)
            });
            let sample = sample.unwrap();
            let listed: Vec<_> =
                sample.passes.iter().map(|pass| (pass.info.name, pass.calls, pass.submission)).collect();
            assert_eq!(listed, [("first", 3, submissions[0]), ("second", 1, submissions[1])]);
            let waits = sample.spans.iter().filter(|span| span.track == Track::Wait).count();
            assert_eq!(waits, if submissions[1] > 0 { 3 } else { 1 }, "{mode:?}");
            assert!(sample.passes.iter().all(|pass| pass.wait_ms.is_none()), "the method itself waits for nothing");
            let found: Vec<f32> = targets.iter().map(|target| texels::<f32>(device, target)[5]).collect();
            assert_eq!(found, [4.0, 3.0]);
        }
        // A frame that ends before its last pass, as well.
        recorder.submit_by_pass(true);
        let record = |frame: &mut fumarole::gpu::Frame<'_>| {
            paint(frame, &passes[0], 5.0)?;
            paint(frame, &passes[1], 6.0)
        };
        assert_eq!(recorder.run_first(Mode::Plain, 1, record).unwrap().passes.len(), 1);
        let found: Vec<f32> = targets.iter().map(|target| texels::<f32>(device, target)[5]).collect();
        assert_eq!(found, [5.0, 3.0]);
    });
}
