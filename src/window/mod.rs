//! The window, and the worker that draws for it.
//!
//! ```text
//!  window process                                    worker process: the same program, with a hidden verb
//!  ┌───────────┐  send    ┌────────┐  requests (stdin)   ┌────────┐  Paper::record()  ┌────────┐
//!  │ interface │ ───────► │ client │ ──────────────────► │ worker │ ────────────────► │ papers │ ──► Vulkan
//!  └───────────┘ ◄─────── └────────┘ ◄────────────────── └────────┘                   └────────┘
//!              try_receive     ▲       events (stdout)       │
//!                              └──── pictures, values ◄──────┘
//!                                  (a file in memory)
//! ```
//!
//! A frame of the paper, however long, is never in the way of the interface, and a lost device or a crash ends the worker
//! alone. The two speak by [`protocol`].

pub mod application;
mod area;
mod bench_tab;
mod camera;
pub mod client;
mod compare;
mod controls;
mod damage;
mod drawer;
mod error;
mod event_loop;
mod false_colour;
pub mod interface;
mod keep_tab;
mod keys;
pub mod layout;
pub mod painter;
mod parameters_panel;
mod passes_panel;
mod picture_view;
mod pictures;
mod program;
pub mod protocol;
mod reduction;
mod scale;
mod screen;
mod sent;
pub mod session;
mod table_view;
mod target_view;
mod times_tab;
mod top_bar;
pub mod worker;

pub use application::{Options, run};
pub use error::Error;
