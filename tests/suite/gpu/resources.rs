//! Buffers and images: round trips, limits, memory.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Buffer, BufferDesc, DepthTest, Device, Error, Image, ImageDesc, Load, Location, Mode, Pass, transfer,
};

use super::fixtures::{Paint, color_target, run, shaders, texels};
use crate::common::gpu_test;

fn name_of<T>(outcome: Result<T, Error>) -> String {
    match outcome.map(|_| ()) {
        Err(Error::Limit { object, what, .. }) => format!("{object}: {what}"),
        other => format!("{other:?}"),
    }
}

#[test]
fn buffers_of_every_length_come_back_as_they_went() {
    gpu_test(|device| {
        for length in [4, 5, 64, 1000, 70_000] {
            let bytes: Vec<u8> = (0..length).map(|i| (i * 7 % 251) as u8).collect();
            let buffer = transfer::upload(device, "bytes", vk::BufferUsageFlags::STORAGE_BUFFER, &bytes).unwrap();
            assert_eq!(transfer::read_buffer(device, &buffer).unwrap(), bytes, "{length} bytes");
        }
    });
}

#[test]
fn the_shortest_buffers_are_four_bytes_long() {
    gpu_test(|device| {
        for length in 0..4 {
            let bytes = vec![9; length];
            let buffer = transfer::upload(device, "short", vk::BufferUsageFlags::STORAGE_BUFFER, &bytes).unwrap();
            let read = transfer::read_buffer(device, &buffer).unwrap();
            assert_eq!((read.len(), &read[..length]), (4, &bytes[..]));
        }
    });
}

#[test]
fn a_mapped_buffer_is_written_and_read_within_its_bounds() {
    gpu_test(|device| {
        let upload = Buffer::new(device, BufferDesc::new("staging", 16).location(Location::Upload)).unwrap();
        upload.write(0, &[1; 16]).unwrap();
        upload.write(8, &[2; 8]).unwrap();
        let read = transfer::read_buffer(device, &upload).unwrap();
        assert_eq!(read, [[1; 8], [2; 8]].concat());
        let local = Buffer::new(device, BufferDesc::new("local", 16)).unwrap();
        for error in [upload.write(9, &[0; 8]), upload.read(17, |_| ()), local.write(0, &[0]), local.read(1, |_| ())] {
            let message = error.unwrap_err().to_string();
            assert!(message.contains("staging") || message.contains("local"), "{message}");
        }
    });
}

/// The bytes of a texel after clearing to `value`.
fn cleared(device: &Arc<Device>, format: vk::Format, value: [f32; 4]) -> Vec<u8> {
    let (width, height) = (5, 3);
    let pass = Pass::graphics("clear", "", "common/fullscreen.vert", "test/constant.frag").constants::<Paint>();
    let (pass, view) = if format == vk::Format::D32_SFLOAT {
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let image = Image::new(device, ImageDesc::new_2d("cleared", format, width, height).usage(usage)).unwrap();
        let view = image.view().unwrap();
        let color = color_target(device, "beside", vk::Format::R8G8B8A8_UNORM, width, height);
        let pass = pass.color(&color, Load::Discard, Blend::Replace);
        (pass.depth(&view, Load::Clear(value), DepthTest::LessWrite), view)
    } else {
        let view = color_target(device, "cleared", format, width, height);
        (pass.color(&view, Load::Clear(value), Blend::Replace), view)
    };
    let pass = pass.build(&shaders(device)).unwrap();
    run(device, Mode::Plain, |frame| frame.graphics(&pass, |_| {})).unwrap();
    let bytes = transfer::read_image(device, &view).unwrap();
    let texel = bytes[..bytes.len() / 15].to_vec();
    assert_eq!(bytes, texel.repeat(15), "{format:?}");
    texel
}

#[test]
fn texels_of_every_format_come_back_tightly_packed() {
    gpu_test(|device| {
        let floats = |values: &[f32]| bytemuck::cast_slice::<f32, u8>(values).to_vec();
        let color = [1.0, 0.2, 0.4, 0.6];
        assert_eq!(cleared(device, vk::Format::R8G8B8A8_UNORM, color), [255, 51, 102, 153]);
        // 0.5 of light is 188 of 255 in sRGB; alpha stays linear.
        assert_eq!(cleared(device, vk::Format::R8G8B8A8_SRGB, [1.0, 0.5, 0.0, 0.6]), [255, 188, 0, 153]);
        assert_eq!(cleared(device, vk::Format::R32_SFLOAT, color), floats(&color[..1]));
        assert_eq!(cleared(device, vk::Format::R32G32B32A32_SFLOAT, color), floats(&color));
        // 1.0, -2.0, 0.5 and 2^-14 as half floats.
        let halves = cleared(device, vk::Format::R16G16B16A16_SFLOAT, [1.0, -2.0, 0.5, 6.103_515_6e-5]);
        assert_eq!(halves, [0x00, 0x3c, 0x00, 0xc0, 0x00, 0x38, 0x00, 0x04]);
        assert_eq!(cleared(device, vk::Format::D32_SFLOAT, [0.25; 4]), floats(&[0.25]));
    });
}

#[test]
fn layers_are_read_back_one_after_the_other() {
    gpu_test(|device| {
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let desc = ImageDesc::new_2d("layers", vk::Format::R32_SFLOAT, 3, 2).layers(3).usage(usage);
        let image = Image::new(device, desc).unwrap();
        let shaders = shaders(device);
        let clears: Vec<Pass> = (0..3)
            .map(|layer| {
                Pass::graphics("clear", "", "common/fullscreen.vert", "test/constant.frag")
                    .constants::<Paint>()
                    .color(&image.layer(layer).unwrap(), Load::Clear([layer as f32; 4]), Blend::Replace)
                    .build(&shaders)
                    .unwrap()
            })
            .collect();
        run(device, Mode::Plain, |frame| clears.iter().try_for_each(|pass| frame.graphics(pass, |_| {}))).unwrap();
        assert_eq!(texels::<f32>(device, &image.view().unwrap()), [[0.0; 6], [1.0; 6], [2.0; 6]].concat());
        assert_eq!(texels::<f32>(device, &image.layer(2).unwrap()), [2.0; 6]);
        assert_eq!(name_of(image.layer(3)), "layers: layer");
    });
}

#[test]
fn sizes_beyond_the_device_are_refused_before_it_is_asked() {
    gpu_test(|device| {
        let limits = device.physical().limits;
        let side = limits.max_image_dimension2_d;
        let image = |width, height, layers| {
            let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
            let desc = ImageDesc::new_2d("map", vk::Format::R8G8B8A8_UNORM, width, height).layers(layers).usage(usage);
            name_of(Image::new(device, desc))
        };
        assert_eq!(image(0, 0, 1), "map: width in texels");
        assert_eq!(image(4, 0, 1), "map: height in texels");
        assert_eq!(image(side + 1, 4, 1), "map: width in texels");
        assert_eq!(image(4, u32::MAX, 1), "map: height in texels");
        assert_eq!(image(4, 4, 0), "map: layer count");
        assert_eq!(image(4, 4, limits.max_image_array_layers + 1), "map: layer count");

        let bytes = u64::from(limits.max_storage_buffer_range) + 1;
        let desc = BufferDesc::new("values", bytes).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
        let error = Buffer::new(device, desc).map(|_| ()).unwrap_err();
        let message = error.to_string();
        assert!(
            matches!(error, Error::Limit { wanted, limit, .. } if (wanted, limit) == (bytes, bytes - 1)),
            "{message}"
        );
        assert!(message.starts_with("values: size in bytes of a storage buffer"), "{message}");
    });
}

#[test]
fn more_memory_than_there_is_is_refused() {
    gpu_test(|device| {
        let refuse = |outcome: Result<(), Error>| {
            let error = outcome.unwrap_err();
            let message = error.to_string();
            assert!(matches!(error, Error::OutOfMemory { .. } | Error::Limit { .. }), "{message}");
            assert!(message.contains("huge"), "{message}");
        };
        let physical = device.physical();
        let heaps = &physical.memory.memory_heaps[..physical.memory.memory_heap_count as usize];
        let heap_bytes = heaps.iter().map(|h| h.size).max().unwrap();
        let side = physical.limits.max_image_dimension2_d;
        let layers = heap_bytes / (4 * u64::from(side) * u64::from(side)) + 1;
        let desc = ImageDesc::new_2d("huge map", vk::Format::R32_SFLOAT, side, side).layers(layers as u32);
        refuse(Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED)).map(|_| ()));
        refuse(Buffer::new(device, BufferDesc::new("huge mesh", heap_bytes + 1)).map(|_| ()));
    });
}

#[test]
fn memory_is_booked_by_resource_name_while_it_lives() {
    gpu_test(|device| {
        let live = device.live();
        live.reset_peak();
        let before = live.peak_bytes();
        {
            let make = |bytes| Buffer::new(device, BufferDesc::new("pair", bytes)).unwrap();
            let pair = [make(1000), make(3000)];
            let staging = Buffer::new(device, BufferDesc::new("staging", 500).location(Location::Upload)).unwrap();
            let booked = live.memory();
            let names: Vec<_> = booked.iter().map(|m| (m.name.as_str(), m.host_visible)).collect();
            assert_eq!(names, [("pair", false), ("staging", true)]);
            assert!((4000..8000).contains(&booked[0].bytes), "{booked:?}");
            drop((pair, staging));
        }
        assert_eq!(live.memory(), []);
        assert!(live.peak_bytes() >= before + 4500);
    });
}
