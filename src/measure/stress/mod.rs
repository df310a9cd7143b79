//! Growing one axis of a paper until a limit stops it: time, memory, device or correctness.
//!
//! ```text
//! Axis (a paper's) ─┐
//! Ladder ───────────┴─► Climb ── a step at a time, in a process of its own ──► step::measure
//!                         │            (the command line starts it)
//!                         └─► Series of Steps, Stop ──► fit::scaling, console
//! ```
//!
//! Nothing here knows a paper, and nothing starts a process: a [`Climber`] does.

mod axis;
mod climb;
pub mod console;
mod costs;
mod fit;
mod foretell;
pub mod host_memory;
mod ladder;
pub mod plots;
pub mod step;

pub use axis::{Amount, Axis, scaled, side};
pub use climb::{Cell, Climb, Climber, Outcome};
pub use costs::costs;
pub use fit::scaling;
pub use ladder::Ladder;
