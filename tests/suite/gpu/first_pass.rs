//! The pass that `docs/first-pass.md` builds from nothing, and a test that the page shows this code.

// begin
use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    Blend, Compiler, Device, Error, Image, ImageDesc, Load, Mode, Pass, Recorder, ShaderLibrary, transfer,
};
use fumarole::host_block;

host_block! {
    /// `test/constant.frag`
    pub struct Paint {
        pub value: [f32; 4],
    }
}

/// Fills a picture of 4 x 4 pixels with one colour, and reads it back.
fn orange(device: &Arc<Device>) -> Result<Vec<u8>, Error> {
    let shaders = ShaderLibrary::new(device, Compiler::Glslang, None)?;
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT;
    let desc = ImageDesc::new_2d("picture", vk::Format::R8G8B8A8_UNORM, 4, 4).usage(usage);
    let picture = Image::new(device, desc)?.view()?;
    let fill = Pass::graphics("fill", "1.1", "common/fullscreen.vert", "test/constant.frag")
        .constants::<Paint>()
        .color(&picture, Load::Discard, Blend::Replace)
        .build(&shaders)?;
    let mut recorder = Recorder::new(device)?;
    let sample = recorder.run(Mode::Timestamped, |frame| {
        frame.graphics(&fill, |draw| draw.constants(&Paint { value: [1.0, 0.5, 0.0, 1.0] }).vertices(3))
    })?;
    for pass in &sample.passes {
        println!("{}: {:?} ms", pass.info.name, pass.gpu_ms);
    }
    transfer::read_image(device, &picture)
}
// end

#[test]
fn the_first_pass_fills_its_picture() {
    crate::common::gpu_test(|device| {
        let texels = orange(device).unwrap();
        assert!(texels.len() == 64 && texels.chunks(4).all(|texel| texel == [255, 128, 0, 255]), "{texels:?}");
    });
}

#[test]
fn the_page_shows_this_code() {
    let page = include_str!("../../../docs/first-pass.md");
    let code = include_str!("first_pass.rs").split("// begin\n").nth(1).and_then(|rest| rest.split("// end").next());
    assert!(
        page.contains(code.unwrap().trim()),
        "docs/first-pass.md does not show the code of tests/suite/gpu/first_pass.rs"
    );
}
