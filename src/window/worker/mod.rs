//! The worker: draws a paper's frames for a window that it knows by requests and events alone.
//!
//! One thread reads requests; this one heeds all that have come, draws one frame, and looks again. What is set by a
//! request that cannot be is taken back, and the last good picture stays in the window.

mod choice;
mod command;
mod describe;
mod frame;
mod inbox;
mod jobs;
mod keep;
mod look;
mod outbox;
mod process;
mod shaders;
mod side;
mod state;
mod times;
mod wanted;

use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ash::vk;

use self::choice::Choice;
pub use self::choice::Typed;
use self::inbox::Inbox;
use self::outbox::{Exchange, Outbox};
use self::shaders::Shaders;
use self::state::State;
use super::protocol::{Event, Numbered, Request, SideChoice};
use crate::gpu;
use crate::measure::Error;
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::study::Study;

/// Start of a worker.
pub struct Start {
    /// Preset of the whole.
    pub preset: Option<String>,
    /// Values set by hand.
    pub typed: Vec<Typed>,
    /// Variants, of which the first two are the sides; the set-up's own without any.
    pub variants: Vec<String>,
    /// The device, its layers and its shaders.
    pub machine: MachineOptions,
    /// The file for pictures.
    pub exchange: PathBuf,
    /// Tries in another process whether the compilers live through a folder of shaders, as they did through the one of the start.
    pub try_shaders: fn(&Path) -> Result<(), Error>,
}

/// A picture is shown at least this long while the clock plays.
const SHORTEST: Duration = Duration::from_micros(16_667);
/// Frames that the window has not taken.
const AHEAD: u64 = 2;

/// Draws until nobody wants more.
///
/// # Errors
/// Of a device that cannot be opened or is lost, and of a file that is not there.
pub fn run<S: Study>(start: Start) -> Result<(), Error> {
    process::give_way();
    let outbox = Outbox::new();
    let inbox = Inbox::open(outbox.clone()).map_err(|error| starting(&error))?;
    let exchange = Exchange::open(&start.exchange).map_err(|error| starting(&error))?;
    let machine = Machine::open(&start.machine, S::NEEDS)?;
    let live = machine.device.live().clone();
    let compiler = start.machine.compiler.to_string();
    let side = |variant: Option<String>| SideChoice { variant, compiler: Some(compiler.clone()), preset: None };
    let sides = match start.variants.as_slice() {
        [] => vec![side(None)],
        named => named.iter().take(2).map(|name| side(Some(name.clone()))).collect(),
    };
    let choice = Choice { preset: start.preset, typed: start.typed, sides };
    let shaders = Shaders::open(&machine, start.machine.shader_dir.clone(), start.try_shaders, &inbox);
    let folder = start.machine.shader_dir.as_ref().map(|folder| folder.display().to_string());
    outbox.tell(&Event::Ready(describe::ready::<S>(&machine, folder, gpu::RenderDoc::attach().is_ok())));
    let mut state = State::<S>::new(machine, start.machine, shaders, choice, outbox, inbox, exchange);
    state.serve()?;
    drop(state);
    // What a test of the window sees by the exit code.
    match live.alive().as_slice() {
        [] => Ok(()),
        left => Err(Error::Input(format!("Vulkan objects were left: {left:?}"))),
    }
}

fn starting(error: &io::Error) -> Error {
    Error::Input(format!("starting the worker: {error}; it is started by the window alone"))
}

/// True for an error after which the device does nothing any more.
fn is_fatal(error: &Error) -> bool {
    matches!(error, Error::Gpu(gpu::Error::Vulkan { result: vk::Result::ERROR_DEVICE_LOST, .. }))
}

/// When the clock's next picture is due.
fn due(last: Option<Instant>) -> Option<Instant> {
    last.map(|last| last + SHORTEST)
}

/// A request that only the worker makes: a shader was saved.
fn saved() -> Numbered {
    Numbered { id: 0, request: Request::Reload }
}
