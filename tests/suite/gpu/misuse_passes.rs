//! Attempts to make and record passes that do not fit what is bound, what is declared, or what the device has: the second
//! part of `misuse`.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::bindings::Resource;
use fumarole::gpu::pass::PassBuilder;
use fumarole::gpu::physical::choose;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, BufferView, DepthTest, Device, Draw, Error, Feature, Image, ImageDesc, ImageView, Load,
    Location, Mode, Pass, PhysicalDevice, Sampler, transfer,
};

use super::fixtures::{
    Advance, BLACK, Range, Vertex, color_target, paint_pass, run, shaders, storage_buffer, texels, values,
};
use super::misuse::{advance_pass, message};
use super::misuse_shaders::replaced;
use crate::common::{gpu_test, gpu_test_alone};

fn vertices(device: &Arc<Device>, count: usize) -> Arc<Buffer> {
    let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
    transfer::upload(device, "corners", usage, &vec![0; count * size_of::<Vertex>()]).unwrap()
}

#[test]
fn draws_beyond_what_is_bound_are_refused() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let corners = vertices(device, 3);
        let usage = vk::BufferUsageFlags::INDEX_BUFFER;
        let indices = transfer::upload(device, "indices", usage, bytemuck::cast_slice(&[0_u32, 1, 2])).unwrap();
        let draw = |name| {
            let pass = Pass::graphics(name, "", "test/grid.vert", "test/asymmetric.frag");
            pass.color(&target, BLACK, Blend::Replace)
        };
        let plain = draw("plain").vertices::<Vertex>(&corners).build(&library).unwrap();
        let indexed = draw("indexed").vertices::<Vertex>(&corners).indices(&indices).build(&library).unwrap();
        let instanced = draw("instanced").instances::<Vertex>(&corners).build(&library).unwrap();
        let refuse = |pass: &Pass, body: &dyn Fn(&mut Draw<'_>)| {
            message(run(device, Mode::Plain, |frame| frame.graphics(pass, |draw| body(draw))))
        };
        let beyond = "up to 4, and the bound buffer holds 3";
        assert_eq!(refuse(&plain, &|d| d.vertices(4)), format!("pass plain: draws vertices {beyond}"));
        assert_eq!(refuse(&plain, &|d| d.vertices_from(2, 2)), format!("pass plain: draws vertices {beyond}"));
        assert!(refuse(&plain, &|d| d.vertices_from(u32::MAX, u32::MAX)).contains("up to 8589934590"));
        assert_eq!(refuse(&indexed, &|d| d.indices(4)), format!("pass indexed: draws indices {beyond}"));
        assert_eq!(refuse(&instanced, &|d| d.instances(3, 4)), format!("pass instanced: draws instances {beyond}"));
        let unbound = "pass plain: draws indices, and no index buffer is bound";
        assert_eq!(refuse(&plain, &|d| d.indices(3)), unbound);
        assert_eq!(refuse(&plain, &|d| d.indices_indirect()), "pass plain: it has no indirect buffer");
        assert_eq!(refuse(&plain, &|d| _ = d.counting(true)), "pass plain: it has no counting pipeline");
        // All that is bound may be drawn, and rebinding takes the bounds along.
        let sample = run(device, Mode::Plain, |frame| {
            frame.graphics(&plain, |draw| {
                draw.vertices(3);
                draw.vertices_from(1, 2);
                draw.instances(3, 1_000);
            })?;
            frame.graphics(&indexed, |draw| draw.indices(3))?;
            frame.graphics(&instanced, |draw| draw.instances(1_000, 3))
        });
        assert_eq!(sample.unwrap().passes[0].calls, 3);
        let fewer = plain.rebind().vertices(&vertices(device, 2)).build(&library).unwrap();
        assert!(refuse(&fewer, &|d| d.vertices(3)).contains("up to 3, and the bound buffer holds 2"));
    });
}

#[test]
fn constants_are_those_declared_and_are_set_first() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let fill = paint_pass(&library, "fill", &target, BLACK, Blend::Replace);
        let plain = Pass::graphics("plain", "", "test/asymmetric.vert", "test/asymmetric.frag");
        let plain = plain.color(&target, BLACK, Blend::Replace).build(&library).unwrap();
        let numbers = storage_buffer(device, "numbers", &[0.0; 64]);
        let step = advance_pass(device, &numbers);
        let draw = |pass: &Pass, body: &dyn Fn(&mut Draw<'_>)| {
            message(run(device, Mode::Plain, |frame| frame.graphics(pass, |draw| body(draw))))
        };
        let wrong = draw(&fill, &|d| d.constants(&Range { value_count: 1 }).vertices(3));
        assert!(wrong.starts_with("pass fill: its constants are Paint, and ") && wrong.contains("Range"), "{wrong}");
        let unset = "its constants are not set before it draws or dispatches";
        assert_eq!(draw(&fill, &|d| d.vertices(3)), format!("pass fill: {unset}"));
        let unknown = draw(&plain, &|d| d.constants(&Range { value_count: 1 }).vertices(3));
        assert_eq!(unknown, "pass plain: it has no constants, and some are given");
        let dispatch = run(device, Mode::Plain, |frame| frame.compute(&step, |d| d.threads(64, 1, 1)));
        assert_eq!(message(dispatch), format!("pass advance: {unset}"));
    });
}

#[test]
fn more_workgroups_than_the_device_takes_are_refused() {
    gpu_test(|device| {
        let numbers = storage_buffer(device, "numbers", &[0.0; 64]);
        let step = advance_pass(device, &numbers);
        let [x, y, z] = device.physical().limits.max_compute_work_group_count;
        let dispatch = |threads: [u32; 3]| {
            run(device, Mode::Plain, |frame| {
                frame.compute(&step, |dispatch| {
                    let [x, y, z] = threads;
                    dispatch.constants(&Advance { value_count: 64, step: 0.0 }).threads(x, y, z);
                })
            })
        };
        if let Some(beyond) = x.checked_mul(64).and_then(|threads| threads.checked_add(1)) {
            let text = message(dispatch([beyond, 1, 1]));
            let expected = format!(
                "pass advance: count of workgroups along one axis {} is beyond this device's limit of {x}; lower it",
                x + 1
            );
            assert_eq!(text, expected);
            dispatch([beyond - 1, 1, 1]).unwrap();
            // Its shader does not number its threads by rows of workgroups.
            let in_rows = run(device, Mode::Plain, |frame| {
                frame.compute(&step, |dispatch| {
                    dispatch.constants(&Advance { value_count: 64, step: 0.0 }).elements(beyond);
                })
            });
            assert_eq!(message(in_rows), expected);
        }
        for (limit, threads) in [(y, [1, y.saturating_add(1), 1]), (z, [1, 1, z.saturating_add(1)])] {
            assert!(limit == u32::MAX || matches!(dispatch(threads), Err(Error::Limit { .. })));
        }
        dispatch([0, 0, 0]).unwrap();
    });
}

#[test]
fn an_indirect_draw_stays_inside_its_buffers() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let corners = [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]].map(|place| Vertex { paint: [1.0; 3], place });
        let (vertex, index) = (vk::BufferUsageFlags::VERTEX_BUFFER, vk::BufferUsageFlags::INDEX_BUFFER);
        let corners = transfer::upload(device, "corners", vertex, bytemuck::cast_slice(&corners)).unwrap();
        // The last index names no vertex: robust access fetches nothing from beyond the buffer.
        let indices = [0_u32, 1, 2, 0, 0, 1 << 24];
        let indices = transfer::upload(device, "indices", index, bytemuck::cast_slice(&indices)).unwrap();
        let usage = vk::BufferUsageFlags::INDIRECT_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        // Count, instances, first index, vertex offset, first instance.
        for (command, is_drawn) in [
            ([3_000_000_u32, 1, 0, 0, 0], true),
            ([u32::MAX, 1, 0, 0, u32::MAX], true),
            ([3, 1, 6, 0, 0], false),
            ([u32::MAX, 1, u32::MAX, 0, 0], false),
        ] {
            let command = transfer::upload(device, "command", usage, bytemuck::cast_slice(&command)).unwrap();
            let pass = Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag")
                .vertices::<Vertex>(&corners)
                .indices(&indices)
                .indirect(&command)
                .color(&target, BLACK, Blend::Replace)
                .build(&library)
                .unwrap();
            run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.indices_indirect())).unwrap();
            let texel = if is_drawn { [255; 4] } else { [0, 0, 0, 255] };
            assert_eq!(texels::<[u8; 4]>(device, &target), [texel; 16]);
        }
    });
}

#[test]
fn shaders_that_reach_beyond_a_buffer_hit_nothing_else() {
    gpu_test(|device| {
        let numbers = storage_buffer(device, "numbers", &[0.0; 64]);
        let step = advance_pass(device, &numbers);
        run(device, Mode::Plain, |frame| {
            frame.compute(&step, |dispatch| {
                dispatch.constants(&Advance { value_count: u32::MAX, step: 1.0 }).threads(1 << 16, 1, 1);
            })
        })
        .unwrap();
        assert_eq!(values(device, &numbers), [1.0; 64]);
    });
}

#[test]
fn what_is_bound_was_made_for_it() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let draw = || Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag");
        let refuse = |outcome: Result<Pass, Error>| message(outcome);
        let plain = Buffer::new(device, BufferDesc::new("plain", 256)).unwrap();
        let drawn = draw().vertices::<Vertex>(&plain).color(&target, BLACK, Blend::Replace);
        assert_eq!(refuse(drawn.build(&library)), "pass draw: plain is no vertex buffer");
        let corners = vertices(device, 3);
        let drawn = || draw().vertices::<Vertex>(&corners);
        let indexed = drawn().indices(&plain).color(&target, BLACK, Blend::Replace).build(&library);
        assert_eq!(refuse(indexed), "pass draw: plain is no index buffer");
        let advance = Pass::compute("advance", "", "test/advance.comp").constants::<Advance>();
        let bound = advance.clone().with("Values", &plain).build(&library);
        assert_eq!(refuse(bound), "pass advance: Values is a storage buffer, which plain was not made to be");
        let numbers = storage_buffer(device, "numbers", &[0.0; 256]);
        let alignment = device.physical().limits.min_storage_buffer_offset_alignment;
        if alignment > 4 {
            let bound = advance.with("Values", &numbers.range(4..64).unwrap()).build(&library);
            let expected = format!("pass advance: numbers is bound from byte 4, no multiple of {alignment}");
            assert_eq!(refuse(bound), expected);
        }
        assert!(numbers.range(8..8).is_err() && numbers.range(0..1025).is_err() && numbers.range(0..1024).is_ok());

        let image = |name: &str, format, usage| {
            Image::new(device, ImageDesc::new_2d(name, format, 4, 4).usage(usage)).unwrap().view().unwrap()
        };
        let sampled = image("sampled", vk::Format::R8G8B8A8_UNORM, vk::ImageUsageFlags::SAMPLED);
        let onto = drawn().color(&sampled, BLACK, Blend::Replace).build(&library);
        assert_eq!(refuse(onto), "pass draw: image sampled was not made to be this attachment: COLOR_ATTACHMENT");
        let look = || {
            let pass = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag");
            pass.color(&target, BLACK, Blend::Replace)
        };
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let layers = |usage, format| {
            let desc = ImageDesc::new_2d("layers", format, 4, 4).layers(2).usage(usage);
            Image::new(device, desc).unwrap().view().unwrap()
        };
        let unsampled = look().with("layers", &layers(usage, vk::Format::R32_SFLOAT)).build(&library);
        assert_eq!(refuse(unsampled), "pass look: layers is a sampled image, which layers was not made to be");
        let shape = "layers has another format, aspect or shape than";
        assert_eq!(refuse(look().with("layers", &sampled).build(&library)), format!("pass look: {shape} sampled"));
        let integers = layers(vk::ImageUsageFlags::SAMPLED, vk::Format::R32_UINT);
        assert_eq!(refuse(look().with("layers", &integers).build(&library)), format!("pass look: {shape} layers"));
        let both = layers(usage, vk::Format::R8G8B8A8_UNORM);
        let onto = drawn().color(&both, BLACK, Blend::Replace).build(&library);
        assert_eq!(refuse(onto), "pass draw: draws into all 2 layers of layers; give one");
    });
}

#[test]
fn attachments_take_what_the_shaders_write_and_the_device_blends() {
    gpu_test(|device| {
        let library = shaders(device);
        let draw = || Pass::graphics("draw", "", "test/asymmetric.vert", "test/asymmetric.frag");
        let target = |format| color_target(device, "target", format, 4, 4);
        let integer = target(vk::Format::R32_UINT);
        let wrong = "pass draw: shader test/asymmetric.frag writes no value of its type to target";
        let onto = draw().color(&integer, Load::Discard, Blend::Replace).build(&library);
        assert_eq!(message(onto), format!("{wrong} 0, target"));
        let two = draw().color(&target(vk::Format::R32_SFLOAT), BLACK, Blend::Replace);
        let two = two.color(&target(vk::Format::R32_SFLOAT), BLACK, Blend::Replace).build(&library);
        assert_eq!(message(two), format!("{wrong} 1, target"));
        let blended = draw().color(&integer, BLACK, Blend::Add).build(&library);
        assert_eq!(message(blended), "pass draw: this device does not blend into R32_UINT, which target has");
        let limits = device.physical().limits;
        let unorm = target(vk::Format::R8G8B8A8_UNORM);
        let many = (0..=limits.max_color_attachments).fold(draw(), |pass, _| pass.color(&unorm, BLACK, Blend::Replace));
        assert!(message(many.build(&library)).contains("count of colour attachments"));
        let wide = Pass::graphics("wide", "", "common/fullscreen.vert", "test/checker.frag");
        let wide = |width| wide.clone().extent(width, 1).build(&library);
        assert!(message(wide(limits.max_framebuffer_width + 1)).contains("width in pixels"));
        assert_eq!(message(wide(0)), "pass wide: its extent is empty");
        let twice = draw().color(&unorm, BLACK, Blend::Replace).color(&unorm, BLACK, Blend::Masked).build(&library);
        assert_eq!(message(twice), "pass draw: uses image target in two ways at once");
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let depth = Image::new(device, ImageDesc::new_2d("depth", vk::Format::D32_SFLOAT, 4, 4).usage(usage)).unwrap();
        let volume = draw().color(&unorm, BLACK, Blend::Replace);
        let volume = volume.depth(&depth.view().unwrap(), BLACK, DepthTest::CountVolume).build(&library);
        assert!(message(volume).contains("image depth was not made to be this attachment"));
    });
}

#[test]
fn stages_fit_each_other_and_their_pass() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let onto = |pass: PassBuilder| message(pass.color(&target, BLACK, Blend::Replace).build(&library));
        let unfed = Pass::graphics("unfed", "", "common/fullscreen.vert", "test/asymmetric.frag");
        let expected =
            "pass unfed: shader test/asymmetric.frag takes colour, which common/fullscreen.vert does not give it";
        assert_eq!(onto(unfed), expected);
        let swapped = Pass::graphics("swapped", "", "test/asymmetric.frag", "test/asymmetric.vert");
        assert!(onto(swapped).ends_with("are not the stages of a graphics pass"));
        let compute = Pass::compute("step", "", "test/asymmetric.vert").build(&library);
        assert_eq!(message(compute), "pass step: test/asymmetric.vert are not the stages of a compute pass");
        let step = Pass::compute("step", "", "test/advance.comp").constants::<Advance>();
        assert_eq!(onto(step.clone()), "pass step: a compute pass has neither attachments nor vertices");
        let elsewhere = Pass::compute("filter", "", "test/filter.comp").build(&library);
        assert!(message(elsewhere).contains("lies outside descriptor set 0"));
    });
}

#[test]
fn what_is_written_is_touched_once() {
    gpu_test(|device| {
        let library = shaders(device);
        let numbers = storage_buffer(device, "numbers", &[0.0; 128]);
        let sum = |values: &BufferView, sums: &BufferView| {
            let pass = Pass::compute("sum", "", "test/sum.comp").constants::<Range>();
            pass.with("Values", values).with("Sums", sums).build(&library)
        };
        let part = |range| numbers.range(range).unwrap();
        let twice = "pass sum: uses buffer numbers in two ways at once";
        assert_eq!(message(sum(&numbers.view(), &numbers.view())), twice);
        assert_eq!(message(sum(&part(0..260), &part(256..512))), twice);
        sum(&part(0..256), &part(256..512)).unwrap();
    });
}

#[test]
fn copies_fit() {
    gpu_test(|device| {
        let numbers = storage_buffer(device, "numbers", &[0.0; 64]);
        let short = Buffer::new(device, BufferDesc::new("short", 64).location(Location::Readback)).unwrap();
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 16, 16);
        let copy = |from: Resource, to: &Arc<Buffer>| {
            let pass = Pass::copy("copy-out", "", from, to);
            message(run(device, Mode::Plain, |frame| frame.copy(&pass)))
        };
        let expected = "pass copy-out: copies 256 bytes of numbers to short, which has 64";
        assert_eq!(copy((&numbers).into(), &short), expected);
        let expected = "pass copy-out: copies 1024 bytes of target to short, which has 64";
        assert_eq!(copy((&target).into(), &short), expected);
        assert_eq!(copy((&numbers).into(), &numbers), "pass copy-out: uses buffer numbers in two ways at once");
        let sampler = Sampler::new(device, "smooth", vk::Filter::LINEAR).unwrap();
        assert!(copy((&sampler).into(), &numbers).contains("copies 0 bytes"));
        let mut desc = BufferDesc::new("sums", 256);
        desc.usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let sums = Buffer::new(device, desc).unwrap();
        assert_eq!(copy((&numbers).into(), &sums), "pass copy-out: sums was not made to be copied so");
        assert!(message(transfer::copy_buffers(device, &[(&numbers, &short)])).contains("which has 64"));
        let pair = [(&numbers, &numbers)];
        assert!(message(transfer::copy_buffers(device, &pair)).contains("in two ways at once"));

        let upload = |view: &Arc<ImageView>, size| transfer::upload_rows(device, view, size, |_, bytes| bytes.fill(0));
        for size in [(0, 4), (4, 0)] {
            assert!(message(upload(&target, size)).contains("rectangles that are not empty"));
        }
        assert!(message(upload(&target, (17, 1))).contains("column of a copy 17"));
        upload(&target, (16, 16)).unwrap();
        let other = color_target(device, "other", vk::Format::R8G8B8A8_UNORM, 16, 16);
        let rectangle = |from, to, at, size| message(transfer::copy_rectangle(device, from, to, at, size));
        assert!(rectangle(&target, &other, (0, 0), (4, 4)).contains("target and other differ in format"));
        assert!(rectangle(&target, &target, (8, 8), (4, 4)).contains("in two ways at once"));
        assert!(rectangle(&target, &target, (u32::MAX, 0), (4, 4)).contains("column of a copy 4294967299"));
    });
}

#[test]
fn rebinding_keeps_to_what_the_pass_is() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = |format| color_target(device, "target", format, 4, 4);
        let unorm = target(vk::Format::R8G8B8A8_UNORM);
        let fill = paint_pass(&library, "fill", &unorm, BLACK, Blend::Replace);
        let rebound = fill.rebind().color(0, &target(vk::Format::R32_SFLOAT), BLACK).build(&library);
        assert_eq!(message(rebound), "pass fill: an attachment is replaced by one of another format");
        let missing = |outcome| assert!(message(outcome).starts_with("pass fill: it has no "));
        missing(fill.rebind().color(1, &unorm, BLACK).build(&library));
        missing(fill.rebind().depth(&unorm, BLACK).build(&library));
        missing(fill.rebind().vertices(&vertices(device, 3)).build(&library));
        missing(fill.rebind().indices(&vertices(device, 3)).build(&library));
    });
}

#[test]
fn resources_are_such_as_the_device_has() {
    gpu_test(|device| {
        let refuse = |desc: ImageDesc| {
            let error = Image::new(device, desc).map(|_| ()).unwrap_err();
            assert!(matches!(error, Error::Unsupported { .. }), "{error}");
            error.to_string()
        };
        let desc = |format| ImageDesc::new_2d("map", format, 4, 4);
        let text = refuse(desc(vk::Format::D32_SFLOAT).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT));
        assert!(text.starts_with("map: neither this layer nor this device has 4 x 4 images of D32_SFLOAT"), "{text}");
        refuse(desc(vk::Format::BC1_RGB_UNORM_BLOCK).usage(vk::ImageUsageFlags::SAMPLED));
        refuse(desc(vk::Format::R32_SFLOAT).usage(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT));
        let mut nothing = desc(vk::Format::R32_SFLOAT);
        nothing.usage = vk::ImageUsageFlags::empty();
        refuse(nothing);
        let copied = Image::new(device, desc(vk::Format::R32_SFLOAT)).unwrap();
        assert!(message(copied.view()).contains("a view of its COLOR"));
        let seen = Image::new(device, desc(vk::Format::R32_SFLOAT).usage(vk::ImageUsageFlags::SAMPLED)).unwrap();
        assert!(message(seen.depth_view()).contains("a view of its DEPTH"));
        for usage in [vk::BufferUsageFlags::empty(), vk::BufferUsageFlags::SHADER_DEVICE_ADDRESS] {
            let mut desc = BufferDesc::new("numbers", 64);
            desc.usage = usage;
            assert!(message(Buffer::new(device, desc)).contains("numbers: neither"));
        }
        let huge = Buffer::new(device, BufferDesc::new("numbers", u64::MAX));
        assert!(matches!(huge, Err(Error::Limit { .. } | Error::OutOfMemory { .. })));
    });
}

#[test]
fn what_a_device_was_not_opened_with_is_refused() {
    gpu_test_alone(|device| {
        let devices = PhysicalDevice::enumerate(device.instance()).unwrap();
        let same = choose(devices, Some(&device.physical().uuid_text()), &[]).unwrap();
        let lesser = same.without(Feature::FragmentStores).without(Feature::GeometryShader);
        let lesser = Device::open(device.instance(), lesser).unwrap();
        let library = shaders(&lesser);
        let stores = Pass::graphics("stores", "", "gas/fragments-pulled.vert", "gas/fragments-plain.frag");
        let text = message(stores.extent(4, 4).build(&library));
        assert!(text.contains("which the device does not take"), "{text}");
        let strip = Pass::graphics("strip", "", "test/splat-point.vert", "test/splat.frag").geometry("test/strip.geom");
        assert!(matches!(strip.build(&library), Err(Error::MissingFeature { .. })));

        // A shader of the user's own that computes with 64 bits.
        let text = "layout(local_size_x = 1) in;\n\
                    layout(set = 0, binding = 0, std430) buffer Values { double values[]; };\n\
                    void main() { values[0] *= 2.0LF; }\n";
        let library = replaced(device, &[("test/advance.comp", text)]).unwrap();
        let numbers = storage_buffer(device, "numbers", &[0.0; 4]);
        let doubles = Pass::compute("doubles", "", "test/advance.comp").with("Values", &numbers);
        let text = message(doubles.build(&library));
        assert!(text.contains("test/advance.comp: it wants SPIR-V capability 10"), "{text}");

        // One that ends its invocations by an instruction of an extension, which wants no capability.
        let text = "#extension GL_EXT_terminate_invocation : require\n\
                    layout(location = 0) out vec4 target;\n\
                    void main() { terminateInvocation; }\n";
        let library = replaced(device, &[("test/constant.frag", text)]).unwrap();
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let ends = Pass::graphics("ends", "", "common/fullscreen.vert", "test/constant.frag");
        let text = message(ends.color(&target, BLACK, Blend::Replace).build(&library));
        assert!(text.contains("test/constant.frag: it wants SPIR-V extension SPV_KHR_terminate_invocation"), "{text}");
    });
}
