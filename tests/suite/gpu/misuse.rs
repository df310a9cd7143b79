//! One attempt for each line of the page in `gpu/mod.rs` on what a caller cannot get wrong: each is a clear error, and
//! the validation layer, which sees all that is submitted, says nothing.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use ash::vk;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, Device, Error, Feature, Frame, Instance, Load, Location, Mode, Pass, PhysicalDevice,
    Recorder, transfer,
};

use super::fixtures::{Advance, BLACK, color_target, paint, paint_pass, run, shaders, storage_buffer, texels, values};
use crate::common::{gpu_test, gpu_test_alone};

/// The message of a refusal, which is one line.
pub fn message<T>(outcome: Result<T, Error>) -> String {
    let message = outcome.map(|_| ()).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

pub fn advance_pass(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Pass {
    let pass = Pass::compute("advance", "", "test/advance.comp").constants::<Advance>().with("Values", buffer);
    pass.build(&shaders(device)).unwrap()
}

/// Adds 1 to every one of 64 values.
fn advance(frame: &mut fumarole::gpu::Frame<'_>, pass: &Pass) -> Result<(), Error> {
    frame.compute(pass, |dispatch| {
        dispatch.constants(&Advance { value_count: 64, step: 1.0 }).threads(64, 1, 1);
    })
}

/// Another device of the same kind, under the same validation.
fn other_device(device: &Arc<Device>) -> Arc<Device> {
    let devices = PhysicalDevice::enumerate(device.instance()).unwrap();
    let same = choose(devices, Some(&device.physical().uuid_text()), &[]).unwrap();
    Device::open(device.instance(), same).unwrap()
}

#[test]
fn a_frame_that_is_given_up_leaves_no_trace() {
    gpu_test(|device| {
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let library = shaders(device);
        let fill = paint_pass(&library, "fill", &target, BLACK, Blend::Replace);
        let add = paint_pass(&library, "add", &target, Load::Keep, Blend::Add);
        let stop = || Error::Pass { pass: "stop".into(), problem: "on purpose".into() };

        let never = run(device, Mode::Plain, |frame| paint(frame, &fill, 1.0).and(Err(stop())));
        assert_eq!(message(never), "pass stop: on purpose");
        let message = message(transfer::read_image(device, &target));
        assert_eq!(message, "pass readback: reads target, which no pass has written");

        run(device, Mode::Plain, |frame| paint(frame, &fill, 2.0)).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            recorder
                .run(Mode::Plain, |frame| {
                    paint(frame, &add, 4.0)?;
                    if frame.host(fill.info(), || true) {
                        panic!("on purpose");
                    }
                    Ok::<(), Error>(())
                })
                .map(|_| ())
        }));
        assert!(panicked.is_err());
        assert_eq!(texels::<f32>(device, &target), [2.0; 16]);

        // The first submission of a frame stands, the second was given up.
        let readback = Buffer::new(device, BufferDesc::new("copy", 64).location(Location::Readback)).unwrap();
        let copy = Pass::copy("copy-out", "", &target, &readback);
        let half = recorder.run(Mode::Plain, |frame| {
            paint(frame, &add, 8.0)?;
            frame.copy(&copy)?;
            frame.wait_for(&copy)?;
            paint(frame, &fill, 0.0)?;
            Err(stop())
        });
        assert!(half.is_err());
        assert_eq!(readback.read(4, <[u8]>::to_vec).unwrap(), 10.0f32.to_le_bytes());
        assert_eq!(texels::<f32>(device, &target), [10.0; 16]);
    });
}

#[test]
fn a_frame_is_given_up_between_submissions_alone() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let fill = paint_pass(&library, "fill", &target, BLACK, Blend::Replace);
        let mut recorder = Recorder::new(device).unwrap();
        let interrupted = AtomicBool::new(true);
        // Room for both is no reason to wait.
        let record = |frame: &mut Frame<'_>, most: f64| -> Result<(), Error> {
            for value in [1.0, 2.0] {
                frame.reserve_work(&fill, 3.0, most)?;
                paint(frame, &fill, value)?;
            }
            Ok(())
        };
        for (most, painted) in [(6.0, Some(2.0)), (5.0, None), (2.0, None)] {
            let ended = recorder.run_unless(&interrupted, Mode::Plain, |frame| record(frame, most)).map(|_| ());
            assert_eq!(matches!(ended, Err(Error::Interrupted)), painted.is_none(), "{most}: {ended:?}");
            // What was submitted before stands.
            assert_eq!(texels::<f32>(device, &target), [painted.unwrap_or(1.0); 16]);
        }
        interrupted.store(false, Ordering::Relaxed);
        for mode in [Mode::Plain, Mode::Timestamped, Mode::Bracketed, Mode::Counted] {
            let sample = recorder.run_unless(&interrupted, mode, |frame| record(frame, 5.0)).unwrap();
            let [pass] = &sample.passes[..] else { panic!("{sample:?}") };
            assert!(pass.calls == 2 && pass.wait_ms.is_none(), "{pass:?}");
            assert_eq!(texels::<f32>(device, &target), [2.0; 16]);
        }
    });
}

#[test]
fn an_error_that_is_passed_over_stops_the_frame() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let empty = color_target(device, "empty", vk::Format::R32_SFLOAT, 4, 4);
        let fill = paint_pass(&library, "fill", &target, BLACK, Blend::Replace);
        let keep = paint_pass(&library, "keep", &empty, Load::Keep, Blend::Add);
        let stopped = "pass keep: it failed earlier in this frame, which goes no further";
        let outcome = run(device, Mode::Plain, |frame| {
            assert!(paint(frame, &keep, 1.0).is_err());
            assert_eq!(message(paint(frame, &fill, 1.0)), stopped);
            assert_eq!(message(frame.wait_for(&fill)), stopped);
            Ok(())
        });
        assert_eq!(message(outcome), stopped);
        assert!(transfer::read_image(device, &target).is_err(), "nothing was submitted");
    });
}

#[test]
fn two_threads_record_and_submit_at_once() {
    gpu_test(|device| {
        let work = |name: &'static str| {
            let numbers = storage_buffer(device, name, &[0.0; 64]);
            let pass = advance_pass(device, &numbers);
            let mut recorder = Recorder::new(device).unwrap();
            for _ in 0..40 {
                recorder.run(Mode::Plain, |frame| advance(frame, &pass)).unwrap();
                device.wait_idle().unwrap();
            }
            assert_eq!(values(device, &numbers), [40.0; 64]);
        };
        thread::scope(|scope| {
            for name in ["a", "b", "c"] {
                scope.spawn(move || work(name));
            }
        });
    });
}

#[test]
fn what_an_unfinished_frame_uses_is_kept_from_all_others() {
    gpu_test(|device| {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let desc = BufferDesc::new("numbers", 256).usage(usage).location(Location::Upload);
        let numbers = Buffer::new(device, desc).unwrap();
        numbers.write(0, &[0; 256]).unwrap();
        let pass = advance_pass(device, &numbers);
        let mut second = Recorder::new(device).unwrap();
        let busy = "numbers is in use by a frame, a copy or a reader that has not finished; let that finish first";
        run(device, Mode::Plain, |frame| {
            advance(frame, &pass)?;
            let inner = second.run(Mode::Plain, |frame| advance(frame, &pass));
            assert_eq!(message(inner), format!("pass advance: {busy}"));
            assert_eq!(message(transfer::read_buffer(device, &numbers)), format!("pass readback: {busy}"));
            let by_host = |what| {
                format!("host access to numbers: {what} it: a frame, a copy or a reader that has not finished uses it")
            };
            assert_eq!(message(numbers.write(0, &[1; 4])), by_host("writing"));
            assert_eq!(message(numbers.read(4, |_| ())), by_host("reading"));
            // It goes on as if nothing had happened.
            advance(frame, &pass)
        })
        .unwrap();
        assert_eq!(values(device, &numbers), [2.0; 64]);
        second.run(Mode::Plain, |frame| advance(frame, &pass)).unwrap();
        assert_eq!(values(device, &numbers), [3.0; 64]);
    });
}

#[test]
fn mapped_memory_is_lent_to_readers_alone_and_only_what_was_written_for_them() {
    gpu_test(|device| {
        let readback = Buffer::new(device, BufferDesc::new("copy", 256).location(Location::Readback)).unwrap();
        let unwritten = "host access to copy: reading it: nothing was written there for the host to read";
        assert_eq!(message(readback.read(4, |_| ())), unwritten);
        let numbers = storage_buffer(device, "numbers", &[7.0; 64]);
        let copy = Pass::copy("copy-out", "", &numbers, &readback);
        run(device, Mode::Plain, |frame| frame.copy(&copy)).unwrap();
        let first = readback.read(256, |bytes| {
            assert!(message(readback.write(0, &[0; 4])).contains("not finished"));
            assert!(message(run(device, Mode::Plain, |frame| frame.copy(&copy))).contains("in use"));
            readback.read(4, |again| assert_eq!(again, &bytes[..4])).unwrap();
            bytes[..4].to_vec()
        });
        assert_eq!(first.unwrap(), 7.0f32.to_le_bytes());
        readback.write(0, &[0; 256]).unwrap();
    });
}

#[test]
fn a_copy_into_a_longer_buffer_is_read_as_far_as_it_reaches() {
    gpu_test(|device| {
        let readback = Buffer::new(device, BufferDesc::new("copy", 64).location(Location::Readback)).unwrap();
        let numbers = storage_buffer(device, "numbers", &[7.0; 4]);
        let copy = Pass::copy("copy-out", "", &numbers, &readback);
        run(device, Mode::Plain, |frame| frame.copy(&copy)).unwrap();
        assert_eq!(readback.read(16, <[u8]>::to_vec).unwrap(), [7.0f32.to_le_bytes(); 4].concat());
        assert!(message(readback.read(17, |_| ())).contains("nothing was written there"));
    });
}

#[test]
fn passes_are_bound_anew_while_they_are_recorded() {
    gpu_test(|device| {
        let library = shaders(device);
        let [numbers, others] = ["numbers", "others"].map(|name| storage_buffer(device, name, &[0.0; 64]));
        let pass = advance_pass(device, &numbers);
        thread::scope(|scope| {
            scope.spawn(|| {
                let mut recorder = Recorder::new(device).unwrap();
                for _ in 0..100 {
                    recorder.run(Mode::Plain, |frame| advance(frame, &pass)).unwrap();
                }
            });
            scope.spawn(|| {
                for _ in 0..200 {
                    pass.rebind().with("Values", &others).build(&library).unwrap();
                    // Of the same pipeline.
                    let _equal = advance_pass(device, &others);
                }
            });
        });
        assert_eq!(values(device, &numbers), [100.0; 64]);
    });
}

#[test]
fn objects_of_another_device_are_refused() {
    gpu_test_alone(|device| {
        let other = other_device(device);
        let theirs = storage_buffer(&other, "theirs", &[0.0; 64]);
        let pass = advance_pass(&other, &theirs);
        let foreign = "belongs to another device; make it on this one";
        let outcome = run(device, Mode::Plain, |frame| advance(frame, &pass));
        assert_eq!(message(outcome), format!("pass advance: advance {foreign}"));
        assert_eq!(message(transfer::read_buffer(device, &theirs)), format!("pass readback: theirs {foreign}"));
    });
}

#[test]
fn a_device_is_opened_as_it_is_and_where_it_was_found() {
    gpu_test_alone(|device| {
        let wanted = device.physical().uuid_text();
        let find = |instance: &Arc<Instance>| {
            choose(PhysicalDevice::enumerate(instance).unwrap(), Some(&wanted), &[]).unwrap()
        };
        let other = Instance::new(false).unwrap();
        let refused = message(Device::open(&other, find(device.instance())));
        assert!(refused.contains("belongs to another instance"), "{refused}");
        let mut boastful = find(device.instance());
        boastful.limits.max_push_constants_size = u32::MAX;
        boastful.queue = Some((7, 64));
        let opened = Device::open(device.instance(), boastful.without(Feature::GeometryShader)).unwrap();
        let (found, own) = (opened.physical(), device.physical());
        assert_eq!(found.limits.max_push_constants_size, own.limits.max_push_constants_size);
        assert_eq!(found.queue, own.queue);
        assert!(!found.has(Feature::GeometryShader));
    });
}

#[test]
fn names_may_hold_anything() {
    gpu_test(|device| {
        let target = color_target(device, "nul \0 inside", vk::Format::R32_SFLOAT, 4, 4);
        let fill = paint_pass(&shaders(device), "fill\0", &target, BLACK, Blend::Replace);
        run(device, Mode::Plain, |frame| paint(frame, &fill, 1.0)).unwrap();
        assert_eq!(texels::<f32>(device, &target), [1.0; 16]);
    });
}
