//! Passes, blocks and targets that several tests share.

use std::sync::Arc;

use ash::vk;
use bytemuck::Pod;
use fumarole::gpu::{
    Blend, Buffer, Compiler, Device, Error, Frame, FrameSample, Image, ImageDesc, ImageView, Load, Mode, Pass,
    Recorder, ShaderLibrary, transfer,
};
use fumarole::host_block;

use crate::common::shaders_by;

host_block! {
    /// `test/constant.frag`
    pub struct Paint {
        pub value: [f32; 4],
    }
}

host_block! {
    /// `test/sum.comp`
    pub struct Range {
        pub value_count: u32,
    }
}

host_block! {
    /// `test/advance.comp`
    pub struct Advance {
        pub value_count: u32,
        pub step: f32,
    }
}

host_block! {
    /// `test/grid.vert`, in another order than the shader's
    pub struct Vertex {
        pub paint: [f32; 3],
        pub place: [f32; 2],
    }
}

pub const BLACK: Load = Load::Clear([0.0, 0.0, 0.0, 1.0]);

pub fn shaders(device: &Arc<Device>) -> Arc<ShaderLibrary> {
    shaders_by(device, Compiler::Glslang)
}

/// A colour target that shaders can sample.
pub fn color_target(device: &Arc<Device>, name: &str, format: vk::Format, width: u32, height: u32) -> Arc<ImageView> {
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    Image::new(device, ImageDesc::new_2d(name, format, width, height).usage(usage)).unwrap().view().unwrap()
}

pub fn storage_buffer(device: &Arc<Device>, name: &str, values: &[f32]) -> Arc<Buffer> {
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::VERTEX_BUFFER;
    transfer::upload(device, name, usage, bytemuck::cast_slice(values)).unwrap()
}

/// Fills a target with one value.
pub fn paint_pass(
    shaders: &ShaderLibrary,
    name: &'static str,
    target: &Arc<ImageView>,
    load: Load,
    blend: Blend,
) -> Pass {
    Pass::graphics(name, "", "common/fullscreen.vert", "test/constant.frag")
        .constants::<Paint>()
        .color(target, load, blend)
        .build(shaders)
        .unwrap()
}

/// Records a call of a [`paint_pass`].
pub fn paint(frame: &mut Frame<'_>, pass: &Pass, value: f32) -> Result<(), Error> {
    frame.graphics(pass, |draw| {
        draw.constants(&Paint { value: [value; 4] }).vertices(3);
    })
}

/// Runs one frame on a recorder of its own.
pub fn run(
    device: &Arc<Device>,
    mode: Mode,
    record: impl FnOnce(&mut Frame<'_>) -> Result<(), Error>,
) -> Result<FrameSample, Error> {
    Recorder::new(device)?.run(mode, record).cloned()
}

pub fn texels<T: Pod>(device: &Arc<Device>, view: &Arc<ImageView>) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&transfer::read_image(device, view).unwrap())
}

pub fn values(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&transfer::read_buffer(device, buffer).unwrap())
}
