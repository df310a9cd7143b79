//! Draws whose parameters lie on the device, passes of several steps, and copies between buffers.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::transfer::{copy_buffers, upload};
use fumarole::gpu::{Blend, Buffer, BufferDesc, Device, Error, Mode, Pass};

use super::fixtures::{Advance, BLACK, Vertex, color_target, run, shaders, storage_buffer, texels, values};
use crate::common::gpu_test;

/// A quad over the left half of the target and one over the right half, in one vertex buffer.
fn quads(device: &Arc<Device>) -> (Arc<Buffer>, Arc<Buffer>) {
    let vertex = |x: f32, y: f32| Vertex { paint: [1.0, 0.5, 0.25], place: [x, y] };
    let vertices = [
        vertex(-1.0, -1.0),
        vertex(0.0, -1.0),
        vertex(-1.0, 1.0),
        vertex(0.0, 1.0),
        vertex(1.0, -1.0),
        vertex(1.0, 1.0),
    ];
    let indices = [0_u32, 1, 2, 1, 3, 2, 1, 4, 3, 4, 5, 3];
    let vertices =
        upload(device, "vertices", vk::BufferUsageFlags::VERTEX_BUFFER, bytemuck::cast_slice(&vertices)).unwrap();
    (vertices, upload(device, "indices", vk::BufferUsageFlags::INDEX_BUFFER, bytemuck::cast_slice(&indices)).unwrap())
}

fn arguments(device: &Arc<Device>, name: &str, index_count: u32) -> Arc<Buffer> {
    let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
    upload(device, name, usage, bytemuck::cast_slice(&[index_count, 1, 0, 0, 0])).unwrap()
}

#[test]
fn an_indirect_draw_takes_what_the_last_pass_wrote() {
    gpu_test(|device| {
        let library = shaders(device);
        let (vertices, indices) = quads(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 8, 2);
        let parameters = arguments(device, "parameters", 0);
        let draw = Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag")
            .vertices::<Vertex>(&vertices)
            .indices(&indices)
            .indirect(&parameters)
            .color(&target, BLACK, Blend::Replace)
            .build(&library)
            .unwrap();
        assert!(draw.info().reads.contains(&"parameters".to_owned()));
        let more = [0, 6, 12].map(|count| Pass::copy("refill", "", &arguments(device, "more", count), &parameters));
        for (refill, columns) in more.iter().zip([0, 4, 8]) {
            let sample = run(device, Mode::Plain, |frame| {
                frame.copy(refill)?;
                frame.graphics(&draw, |draw| draw.indices_indirect())
            })
            .unwrap();
            assert_eq!(sample.passes[1].calls, 1);
            let painted: Vec<[u8; 4]> = texels(device, &target);
            for (at, texel) in painted.iter().enumerate() {
                let expected = if at % 8 < columns { [255, 128, 64, 255] } else { [0, 0, 0, 255] };
                assert_eq!(*texel, expected, "{columns} columns, texel {at}");
            }
        }
    });
}

#[test]
fn a_buffer_that_holds_no_parameters_is_refused() {
    gpu_test(|device| {
        let library = shaders(device);
        let (vertices, indices) = quads(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 8, 2);
        let usage = vk::BufferUsageFlags::INDIRECT_BUFFER;
        let short = Buffer::new(device, BufferDesc::new("short", 16).usage(usage)).unwrap();
        for (parameters, name) in [(&vertices, "vertices"), (&short, "short")] {
            let built = Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag")
                .vertices::<Vertex>(&vertices)
                .indices(&indices)
                .indirect(parameters)
                .color(&target, BLACK, Blend::Replace)
                .build(&library);
            let message = built.map(|_| ()).unwrap_err().to_string();
            assert_eq!(message, format!("pass draw: {name} is no indirect buffer of 20 bytes"));
        }
        let tiny = Buffer::new(device, BufferDesc::new("tiny", 8).usage(usage)).unwrap();
        for (parameters, name) in [(&vertices, "vertices"), (&tiny, "tiny")] {
            let pass = Pass::compute("advance", "", "test/advance.comp").constants::<Advance>();
            let pass = pass.with("Values", &storage_buffer(device, "numbers", &[0.0; 64]));
            let message = pass.indirect(parameters).build(&library).map(|_| ()).unwrap_err().to_string();
            assert_eq!(message, format!("pass advance: {name} is no indirect buffer of 12 bytes"));
        }
    });
}

#[test]
fn an_indirect_dispatch_takes_what_the_last_pass_wrote_within_the_devices_limits() {
    gpu_test(|device| {
        let library = shaders(device);
        let groups = |name: &str, groups: [u32; 3]| {
            let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(device, name, usage, bytemuck::cast_slice(&groups)).unwrap()
        };
        let (numbers, wanted) = (storage_buffer(device, "numbers", &[0.0; 256]), groups("wanted", [0; 3]));
        let pass = Pass::compute("advance", "", "test/advance.comp").constants::<Advance>().with("Values", &numbers);
        let advance = pass.clone().indirect(&wanted).build(&library).unwrap();
        assert!(advance.info().reads.contains(&"wanted".to_owned()));
        let run_by = |count: [u32; 3]| {
            let refill = Pass::copy("refill", "", &groups("more", count), &wanted);
            let sample = run(device, Mode::Plain, |frame| {
                frame.copy(&refill)?;
                frame.compute(&advance, |dispatch| {
                    dispatch.constants(&Advance { value_count: 256, step: 1.0 }).groups_indirect();
                })
            });
            assert_eq!(sample.unwrap().passes[1].calls, 1);
            values(device, &numbers)
        };
        assert_eq!(run_by([0, 1, 1]), [0.0; 256]);
        let expected: Vec<f32> = (0..256).map(|i| f32::from(u8::from(i < 128))).collect();
        assert_eq!(run_by([2, 1, 1]), expected);
        // Nothing ends where four billion workgroups do not become as many as the device takes.
        let limit = device.physical().limits.max_compute_work_group_count[2];
        if limit < 1 << 17 {
            let most = 1.0 + limit as f32;
            assert!(run_by([1, 1, u32::MAX])[..64].iter().all(|&value| value > 1.0 && value <= most));
        }

        let without = pass.build(&library).unwrap();
        let refused = run(device, Mode::Plain, |frame| {
            frame.compute(&without, |dispatch| {
                dispatch.constants(&Advance { value_count: 1, step: 1.0 }).groups_indirect();
            })
        });
        assert_eq!(refused.unwrap_err().to_string(), "pass advance: it has no indirect buffer");
    });
}

#[test]
fn steps_are_one_pass_with_a_barrier_between_them() {
    gpu_test(|device| {
        let library = shaders(device);
        let [numbers, others] = ["numbers", "others"].map(|name| storage_buffer(device, name, &[1.0; 64]));
        let first = Pass::compute("advance", "1", "test/advance.comp")
            .constants::<Advance>()
            .with("Values", &numbers)
            .build(&library)
            .unwrap();
        let second = first.rebind().with("Values", &others).build(&library).unwrap();
        let steps = Pass::steps([first.clone(), second, first]);
        let info = steps[0].info();
        assert_eq!((info.name, &info.writes[..]), ("advance", &["numbers".to_owned(), "others".to_owned()][..]));
        assert_eq!(info.shaders, ["test/advance.comp"]);
        let sample = run(device, Mode::Plain, |frame| {
            steps.iter().try_for_each(|step| {
                frame.compute(step, |dispatch| {
                    dispatch.constants(&Advance { value_count: 64, step: 2.0 }).threads(64, 1, 1);
                })
            })
        })
        .unwrap();
        assert_eq!((sample.passes.len(), sample.passes[0].calls), (1, 3));
        assert_eq!(values(device, &numbers), [5.0; 64]);
        assert_eq!(values(device, &others), [3.0; 64]);
    });
}

#[test]
fn buffers_are_copied_together() {
    gpu_test(|device| {
        let from = [storage_buffer(device, "a", &[1.0, 2.0]), storage_buffer(device, "b", &[3.0])];
        let to = [storage_buffer(device, "c", &[0.0, 0.0]), storage_buffer(device, "d", &[0.0])];
        copy_buffers(device, &[(&from[0], &to[0]), (&from[1], &to[1])]).unwrap();
        assert_eq!((values(device, &to[0]), values(device, &to[1])), (vec![1.0, 2.0], vec![3.0]));
        let never = Buffer::new(device, BufferDesc::new("never", 8)).unwrap();
        let error = copy_buffers(device, &[(&never, &to[0])]).unwrap_err();
        assert!(matches!(error, Error::ReadBeforeWrite { .. }), "{error}");
    });
}
