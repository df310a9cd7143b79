//! The explicit Vulkan layer. It knows no paper.
//!
//! - **Who validates**: the description of a pass is checked against the shaders when a [`Pass`] is built (names, kinds,
//!   block layouts); with validation on, the Khronos layer checks the rest, synchronization included, and any message
//!   is a failure ([`Instance::check_messages`]).
//! - **Who synchronises**: [`Frame`] alone. Each pass declares its reads and writes; barriers are derived from them
//!   ([`access`]) and recorded by the one envelope. Passes run in the order they are written.
//! - **Who keeps what alive**: every object is an `Arc` with `Drop` and holds its parents; a frame holds its passes
//!   until its fence, and one frame is in flight.
//! - **What can fail**: [`Error`], one line each.

pub mod access;
mod barrier;
pub mod bindings;
pub mod buffer;
mod commands;
pub mod device;
mod draw;
pub mod error;
mod format;
pub mod frame;
pub mod image;
mod indirect;
pub mod instance;
pub mod live;
pub mod messages;
pub mod pass;
mod pass_builder;
mod pass_check;
mod pass_info;
pub mod physical;
pub mod pipeline;
pub mod program;
mod query;
mod rebind;
mod recorder;
pub mod render_pass;
mod sample;
pub mod shader;
#[cfg(test)]
mod tests;
mod tracked;
pub mod transfer;

pub use access::{Access, Stages};
pub use buffer::{Buffer, BufferDesc, BufferView, Location};
pub use device::Device;
pub use draw::{Dispatch, Draw};
pub use error::Error;
pub use frame::Frame;
pub use image::{Image, ImageDesc, ImageView, Sampler};
pub use instance::Instance;
pub use pass::Pass;
pub use pass_info::{PassInfo, PassKind};
pub use physical::{Feature, PhysicalDevice};
pub use pipeline::Topology;
pub use recorder::Recorder;
pub use render_pass::{Blend, DepthTest, Load};
pub use sample::{Counts, FrameSample, Mode, PassSample, Span};
pub use shader::{Compiler, ShaderLibrary};
