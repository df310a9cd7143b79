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

pub mod client;
pub mod protocol;
pub mod worker;
