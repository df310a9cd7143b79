//! Pictures and dumps of a frame, read back after it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use ash::vk;

use super::error::Error;
use super::machine::Machine;
use crate::gpu::bindings::Resource;
use crate::gpu::{self, Device, Mode, transfer};
use crate::image::{Raster, Rgba8};
use crate::measure::{Kind, Paper, Target};
use crate::scene::notes;

/// Steps of a state in one frame of the recorder.
const STEPS: u32 = 128;

/// Nothing interrupts.
pub static NEVER: AtomicBool = AtomicBool::new(false);

/// Brings a paper's state to where frame `number` can be recorded, in submissions of bounded length; `proceed` is told
/// the steps that are left after some of them and says whether to go on. False when it did not, or once `interrupted` was set
/// between two submissions: the state is then to be restarted.
///
/// # Errors
/// [`Error::Gpu`].
pub fn advance(
    interrupted: &AtomicBool,
    machine: &mut Machine,
    paper: &mut dyn Paper,
    number: u32,
    mut proceed: impl FnMut(u32) -> bool,
) -> Result<bool, Error> {
    loop {
        let mut left = 0;
        let stepped = machine.recorder.run_unless(interrupted, Mode::Plain, |frame| {
            left = paper.advance(frame, number, STEPS)?;
            Ok::<(), Error>(())
        });
        match stepped {
            Err(Error::Gpu(gpu::Error::Interrupted)) => return Ok(false),
            other => other?,
        };
        if left == 0 {
            return Ok(true);
        }
        if !proceed(left) {
            return Ok(false);
        }
    }
}

/// Records frame `number` and reads its picture; numbers rise, unless the paper is restarted.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`].
pub fn render(machine: &mut Machine, paper: &mut dyn Paper, number: u32) -> Result<Rgba8, Error> {
    render_unless(&NEVER, machine, paper, number)
}

/// As [`render`], of a frame that is given up between two of its submissions once `interrupted` is set.
///
/// # Errors
/// Those of [`render`]; [`Interrupted`](crate::gpu::Error::Interrupted) among them.
pub fn render_unless(
    interrupted: &AtomicBool,
    machine: &mut Machine,
    paper: &mut dyn Paper,
    number: u32,
) -> Result<Rgba8, Error> {
    if !advance(interrupted, machine, paper, number, |_| true)? {
        return Err(gpu::Error::Interrupted.into());
    }
    loop {
        machine.recorder.run_unless(interrupted, Mode::Plain, |frame| paper.record_picture(frame, number))?;
        if paper.settle(&machine.shaders)? {
            break;
        }
    }
    machine.drawn.add(notes::take());
    machine.drawn.add(paper.warnings());
    let view = paper.picture();
    let texels = transfer::read_image(&machine.device, view)?;
    Ok(Rgba8::new(view.width(), view.height(), texels)?)
}

/// Reads a target of the last frame at full precision.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`].
pub fn read_target(device: &Arc<Device>, target: &Target) -> Result<Raster, Error> {
    match &target.resource {
        Resource::Buffer(view) => {
            let bytes = transfer::read_buffer(device, view.buffer())?;
            let columns = (target.columns as usize).max(1);
            let rows = bytes.len() / 4 / columns;
            let raster = match target.kind {
                Kind::F32 => Raster::table(rows, columns, bytemuck::pod_collect_to_vec::<u8, f32>(&bytes)),
                Kind::U32 => Raster::table(rows, columns, bytemuck::pod_collect_to_vec::<u8, u32>(&bytes)),
                Kind::I32 => Raster::table(rows, columns, bytemuck::pod_collect_to_vec::<u8, i32>(&bytes)),
            };
            Ok(raster?)
        }
        Resource::Image(view) => {
            let bytes = transfer::read_image(device, view)?;
            let (width, height, layers) = (view.width(), view.height(), view.layer_count() * view.depth());
            let floats = || bytemuck::pod_collect_to_vec::<u8, f32>(&bytes);
            let raster = match view.image().desc().format {
                vk::Format::R32_SFLOAT | vk::Format::D32_SFLOAT | vk::Format::D32_SFLOAT_S8_UINT => {
                    Raster::image(width, height, 1, layers, floats())
                }
                vk::Format::R32G32B32A32_SFLOAT => Raster::image(width, height, 4, layers, floats()),
                vk::Format::R16G16B16A16_SFLOAT => {
                    let halves: Vec<half::f16> = bytemuck::pod_collect_to_vec(&bytes);
                    let values: Vec<f32> = halves.into_iter().map(half::f16::to_f32).collect();
                    Raster::image(width, height, 4, layers, values)
                }
                _ => Raster::image(width, height, 4, layers, bytes),
            };
            Ok(if target.is_color() { raster? } else { raster?.of_numbers() })
        }
        Resource::Sampler(_) => Err(Error::Input(format!("{} holds no values", target.name))),
    }
}
