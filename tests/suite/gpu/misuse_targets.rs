//! Attempts to draw into attachments, to view images and to use one image by two names in ways that Vulkan forbids: the
//! third part of `misuse`.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{Blend, DepthTest, Device, Error, Image, ImageDesc, ImageView, Load, Mode, Pass, transfer};

use super::fixtures::{BLACK, color_target, run, shaders, texels};
use super::misuse::message;
use crate::common::gpu_test;

pub fn depth_target(device: &Arc<Device>, format: vk::Format) -> Arc<ImageView> {
    let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    Image::new(device, ImageDesc::new_2d("depth", format, 4, 4).usage(usage)).unwrap().view().unwrap()
}

/// The first format of depth and stencil that the device draws into.
fn stencil_target(device: &Arc<Device>) -> Arc<ImageView> {
    let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
    let formats = [vk::Format::D24_UNORM_S8_UINT, vk::Format::D32_SFLOAT_S8_UINT];
    let mut made =
        formats.iter().filter_map(|&f| Image::new(device, ImageDesc::new_2d("volume", f, 4, 4).usage(usage)).ok());
    made.next().unwrap().view().unwrap()
}

#[test]
fn depth_is_cleared_to_what_it_can_hold() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let depth = depth_target(device, vk::Format::D32_SFLOAT);
        let draw = |value: f32| {
            let pass = Pass::graphics("draw", "", "test/asymmetric.vert", "test/asymmetric.frag");
            let pass = pass.color(&target, BLACK, Blend::Replace);
            pass.depth(&depth, Load::Clear([value, -7.0, f32::NAN, 9.0]), DepthTest::LessWrite).build(&library)
        };
        for value in [-0.5, 1.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let expected = format!("pass draw: clears depth depth to {value}, which lies outside 0 to 1");
            assert_eq!(message(draw(value)), expected);
            let rebound = draw(1.0).unwrap().rebind().depth(&depth, Load::Clear([value; 4])).build(&library);
            assert_eq!(message(rebound), expected);
        }
        for value in [0.0, 1.0] {
            let pass = draw(value).unwrap();
            run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.vertices(3))).unwrap();
        }
    });
}

#[test]
fn integers_are_cleared_to_integers() {
    gpu_test(|device| {
        let library = shaders(device);
        let clear = |format, color| -> Result<Arc<ImageView>, Error> {
            let target = color_target(device, "target", format, 2, 1);
            let pass = Pass::graphics("clear", "", "common/fullscreen.vert", "common/empty.frag");
            let pass = pass.color(&target, Load::Clear(color), Blend::Masked).build(&library)?;
            run(device, Mode::Plain, |frame| frame.graphics(&pass, |_| {}))?;
            Ok(target)
        };
        let counted = clear(vk::Format::R32_UINT, [7.0, 0.0, 0.0, 1.0]).unwrap();
        assert_eq!(texels::<u32>(device, &counted), [7; 2]);
        let short = clear(vk::Format::R16_UINT, [65535.0, 0.0, 0.0, 0.0]).unwrap();
        assert_eq!(texels::<u16>(device, &short), [u16::MAX; 2]);
        let signed = clear(vk::Format::R32G32B32A32_SINT, [-7.0, 1.0, 0.0, -1.0]).unwrap();
        assert_eq!(texels::<[i32; 4]>(device, &signed), [[-7, 1, 0, -1]; 2]);
        for (format, value) in [
            (vk::Format::R32_UINT, -1.0),
            (vk::Format::R32_UINT, 0.5),
            (vk::Format::R32_UINT, f32::powi(2.0, 32)),
            (vk::Format::R32_UINT, f32::NAN),
            (vk::Format::R16_UINT, 65536.0),
            (vk::Format::R32G32B32A32_SINT, f32::powi(2.0, 31)),
            (vk::Format::R32G32B32A32_SINT, f32::NEG_INFINITY),
        ] {
            let expected =
                format!("pass clear: clears target to [{value:?}, 0.0, 0.0, 0.0], which {format:?} does not hold");
            assert_eq!(message(clear(format, [value, 0.0, 0.0, 0.0])), expected);
        }
    });
}

#[test]
fn depth_that_is_only_tested_keeps_what_it_holds() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let depth = depth_target(device, vk::Format::D32_SFLOAT);
        for test in [DepthTest::LessReadOnly, DepthTest::EqualReadOnly] {
            let draw = |load| {
                let pass = Pass::graphics("draw", "", "test/asymmetric.vert", "test/asymmetric.frag");
                pass.color(&target, BLACK, Blend::Replace).depth(&depth, load, test).build(&library)
            };
            let expected = "pass draw: discards depth depth, which it declares read only";
            assert_eq!(message(draw(Load::Discard)), expected);
            let kept = draw(Load::Keep).unwrap();
            let rebound = kept.rebind().depth(&depth, Load::Discard).build(&library);
            assert_eq!(message(rebound), expected);
        }
    });
}

#[test]
fn counting_draws_write_no_attachment_that_is_read_only() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let volume = stencil_target(device);
        let draw = |name, load, own, counting| {
            let pass = Pass::graphics(name, "", "test/asymmetric.vert", "test/asymmetric.frag");
            let pass = pass.color(&target, BLACK, Blend::Replace).depth(&volume, load, own);
            pass.counting("common/empty.frag", counting).build(&library)
        };
        let expected = "pass draw: its counting draws write depth volume, which it declares read only";
        for counting in [DepthTest::CountVolume, DepthTest::InsideVolume, DepthTest::LessWrite] {
            assert_eq!(message(draw("draw", Load::Keep, DepthTest::EqualReadOnly, counting)), expected);
        }
        // What the pass writes may be cleared for draws that only test it; a pass that only tests may count testing.
        let first = draw("first", Load::Clear([1.0; 4]), DepthTest::LessWrite, DepthTest::LessReadOnly).unwrap();
        let second = draw("second", Load::Keep, DepthTest::LessReadOnly, DepthTest::EqualReadOnly).unwrap();
        run(device, Mode::Plain, |frame| {
            for pass in [&first, &second] {
                frame.graphics(pass, |draw| {
                    draw.vertices(3);
                    draw.counting(true).vertices(3);
                })?;
            }
            Ok(())
        })
        .unwrap();
    });
}

#[test]
fn an_image_of_several_layers_is_viewed_as_an_array() {
    gpu_test(|device| {
        let mut desc = ImageDesc::new_2d("layers", vk::Format::R32_SFLOAT, 2, 2).usage(vk::ImageUsageFlags::SAMPLED);
        desc.layers = 3;
        let view = Image::new(device, desc).unwrap().view().unwrap();
        assert_eq!(view.layer_count(), 3);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let look = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag");
        look.with("layers", &view).color(&target, BLACK, Blend::Replace).build(&shaders(device)).unwrap();
    });
}

#[test]
fn depth_is_not_uploaded() {
    gpu_test(|device| {
        let depth = depth_target(device, vk::Format::D32_SFLOAT);
        let expected = "pass upload: depth holds depth, which passes fill: bytes from the host may lie outside 0 to 1";
        let rows = transfer::upload_rows(device, &depth, (4, 4), |_, bytes| bytes.fill(0x7f));
        assert_eq!(message(rows), expected);
        let staging = transfer::upload(device, "staging", vk::BufferUsageFlags::STORAGE_BUFFER, &[0x7f; 64]).unwrap();
        assert_eq!(message(transfer::upload_rectangle(&staging, &depth, (0, 0), (4, 4))), expected);
    });
}

/// An image of three dimensions is viewed, bound and read as one, and nothing draws into it or fills it.
#[test]
fn images_of_three_dimensions_have_no_layers_and_are_no_targets() {
    gpu_test(|device| {
        let library = shaders(device);
        let format = vk::Format::R32_SFLOAT;
        let desc = |extent| ImageDesc::new_3d("cube", format, extent);
        for usage in [vk::ImageUsageFlags::COLOR_ATTACHMENT, vk::ImageUsageFlags::TRANSFER_DST] {
            let made = Image::new(device, desc([4; 3]).usage(usage));
            assert!(message(made).contains("cube"), "{usage:?}");
        }
        for extent in [[4, 4, 0], [4, 0, 4], [4, 4, u32::MAX]] {
            let error = message(Image::new(device, desc(extent).usage(vk::ImageUsageFlags::SAMPLED)));
            assert!(error.contains("in texels"), "{extent:?}: {error}");
        }
        let cube = Image::new(device, desc([4, 5, 6]).usage(vk::ImageUsageFlags::SAMPLED)).unwrap();
        assert!(cube.layer(0).is_err() && cube.layer_array(0).is_err() && cube.layer(1).is_err());
        let view = cube.view().unwrap();
        assert_eq!((view.width(), view.height(), view.depth(), view.layer_count()), (4, 5, 6, 1));
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let look = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag");
        let bound = look.color(&target, BLACK, Blend::Replace).with("layers", &view).build(&library);
        assert_eq!(message(bound), "pass look: layers has another format, aspect or shape than cube");
        assert!(message(transfer::read_image(device, &view)).contains("cube"), "nothing has written it");
    });
}
