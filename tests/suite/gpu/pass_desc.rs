//! A description that does not fit its shaders is refused when the pass is built; the message names pass and object.

use ash::vk;
use fumarole::gpu::{Blend, DepthTest, Error, Image, ImageDesc, Load, Pass, Sampler};
use fumarole::host_block;

use super::fixtures::{BLACK, Paint, Range, Vertex, color_target, paint_pass, shaders, storage_buffer};
use crate::common::gpu_test;

host_block! {
    struct Shifted {
        _pad: [f32; 4],
        value: [f32; 4],
    }
}

host_block! {
    struct Paintless {
        place: [f32; 2],
    }
}

host_block! {
    struct FlatPaint {
        place: [f32; 2],
        paint: [f32; 2],
    }
}

/// Checks that the message is about the pass and holds every one of `words`.
fn assert_says(outcome: Result<Pass, Error>, pass: &str, words: &[&str]) {
    let error = outcome.map(|_| ()).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, Error::Pass { .. }), "{message}");
    assert!(message.starts_with(&format!("pass {pass}: ")), "{message}");
    assert!(words.iter().all(|w| message.contains(w)), "{words:?} in: {message}");
    assert!(!message.contains('\n'), "{message}");
}

#[test]
fn a_binding_that_does_not_fit_is_named() {
    gpu_test(|device| {
        let library = shaders(device);
        let values = storage_buffer(device, "numbers", &[0.0; 4]);
        let sampler = Sampler::new(device, "smooth", vk::Filter::LINEAR).unwrap();
        let image = color_target(device, "picture", vk::Format::R32_SFLOAT, 4, 4);
        let sum = || Pass::compute("sum", "", "test/sum.comp").constants::<Range>().with("Values", &values);

        assert_says(sum().build(&library), "sum", &["Sums"]);
        assert_says(
            sum().with("Sums", &values).with("sums", &values).build(&library),
            "sum",
            &["sums", "Sums", "Values"],
        );
        assert_says(sum().with("Sums", &values).with("Sums", &values).build(&library), "sum", &["Sums", "once"]);
        assert_says(sum().with("Sums", &image).build(&library), "sum", &["Sums", "StorageBuffer", "picture"]);
        assert_says(sum().with("Sums", &sampler).build(&library), "sum", &["Sums", "StorageBuffer", "sampler"]);
        let look = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag").color(
            &color_target(device, "seen", vk::Format::R32_SFLOAT, 4, 4),
            BLACK,
            Blend::Replace,
        );
        assert_says(look.with("layers", &values).build(&library), "look", &["layers", "SampledImage", "numbers"]);
    });
}

#[test]
fn constants_that_do_not_fit_are_named() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let paint = || {
            Pass::graphics("paint", "", "common/fullscreen.vert", "test/constant.frag").color(
                &target,
                BLACK,
                Blend::Add,
            )
        };
        let words = ["test/constant.frag", "Shifted", "`value` takes 16 bytes at 16 on the host and 16 at 0 in GLSL"];
        assert_says(paint().constants::<Shifted>().build(&library), "paint", &words);
        assert_says(paint().constants::<Range>().build(&library), "paint", &["Range", "`value` has no field"]);
        assert_says(paint().build(&library), "paint", &["push constants"]);
        let plain = Pass::graphics("plain", "", "test/asymmetric.vert", "test/asymmetric.frag").constants::<Paint>();
        assert_says(plain.color(&target, BLACK, Blend::Add).build(&library), "plain", &["no push constants", "Paint"]);
    });
}

#[test]
fn vertices_that_do_not_fit_are_named() {
    gpu_test(|device| {
        let library = shaders(device);
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let buffer = storage_buffer(device, "vertices", &[0.0; 15]);
        let draw = || {
            Pass::graphics("draw", "", "test/grid.vert", "test/asymmetric.frag").color(&target, BLACK, Blend::Replace)
        };
        draw().vertices::<Vertex>(&buffer).build(&library).unwrap();
        assert_says(draw().vertices::<Paintless>(&buffer).build(&library), "draw", &["Paintless", "paint", "12 bytes"]);
        assert_says(draw().vertices::<FlatPaint>(&buffer).build(&library), "draw", &["FlatPaint", "paint", "12 bytes"]);
        assert_says(draw().build(&library), "draw", &["place", "test/grid.vert"]);
    });
}

#[test]
fn targets_that_do_not_fit_are_named() {
    gpu_test(|device| {
        let library = shaders(device);
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let desc = ImageDesc::new_2d("feedback", vk::Format::R32_SFLOAT, 4, 4).layers(2).usage(usage);
        let image = Image::new(device, desc).unwrap();
        let look = Pass::graphics("look", "", "common/fullscreen.vert", "test/layers.frag")
            .with("layers", &image.view().unwrap())
            .color(&image.layer(0).unwrap(), Load::Discard, Blend::Replace);
        assert_says(look.build(&library), "look", &["feedback", "two ways"]);

        let large = color_target(device, "large", vk::Format::R8G8B8A8_UNORM, 8, 8);
        let small = color_target(device, "small", vk::Format::R8G8B8A8_UNORM, 8, 4);
        let both = Pass::graphics("both", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&large, BLACK, Blend::Replace)
            .color(&small, BLACK, Blend::Replace);
        assert_says(both.build(&library), "both", &["small has 8 x 4", "large has 8 x 8"]);

        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let desc = ImageDesc::new_2d("depth", vk::Format::D32_SFLOAT, 8, 8).usage(usage);
        let depth = Image::new(device, desc).unwrap().view().unwrap();
        let cleared = Pass::graphics("cleared", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&large, BLACK, Blend::Replace)
            .depth(&depth, Load::Clear([1.0; 4]), DepthTest::LessReadOnly);
        assert_says(cleared.build(&library), "cleared", &["clears depth", "read only"]);
    });
}

#[test]
fn shaders_and_passes_that_are_not_there_are_named() {
    gpu_test(|device| {
        let library = shaders(device);
        let error = Pass::compute("missing", "", "test/missing.comp").build(&library).map(|_| ()).unwrap_err();
        assert_eq!(error.to_string(), "shader test/missing.comp: no such shader is built in");
        let outside = Pass::graphics("sprites", "", "test/sprites.vert", "test/sprites.frag").build(&library);
        assert_says(outside, "sprites", &["test/sprites.frag", "outside descriptor set 0"]);
        let target = color_target(device, "target", vk::Format::R32_SFLOAT, 4, 4);
        let paint = paint_pass(&library, "paint", &target, BLACK, Blend::Replace);
        assert_says(paint.rebind().with("Nothing", &target).build(&library), "paint", &["Nothing"]);
    });
}
