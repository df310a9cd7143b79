//! Protocol between the window and its worker.
//!
//! One JSON document a line: [`Numbered`] requests on the worker's standard input, [`Event`]s on its standard output.
//! Pictures and values lie in a file that both have open, in memory where the system offers such a folder: an event names
//! the [`Block`], and [`Client`](super::client::Client) has read it before the window sees the event. The worker draws
//! at most two frames ahead of what the window has taken, so neither side's queue grows.

mod event;
mod frame;
mod request;

pub use event::*;
pub use frame::*;
pub use request::*;
