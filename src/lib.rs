//! `fumarole` reproduces rendering papers on Vulkan, pass by pass, and measures every pass.
//!
//! ```text
//!  what the user typed        what is measured              what is drawn
//!  ┌─────┐   Setup   ┌────────────┐   Paper::record()   ┌────────┐   Pass, Frame   ┌─────┐
//!  │ cli │ ────────► │  measure   │ ──────────────────► │ papers │ ──────────────► │ gpu │ ──► Vulkan
//!  └─────┘           └────────────┘                     └────────┘                 └─────┘
//!     │                │   │    │                            │                        ▲
//!     │         Record │   │    └──────► scene ◄─────────────┘                        │ SPIR-V, interfaces
//!     ▼                ▼   ▼      (meshes, cameras, lights)                     shader_build
//!   report ◄───────────┘  image (pictures, dumps, metrics)
//! ```
//!
//! Arrows point one way. [`gpu`] knows no paper; [`papers`] know no command line, window or file; [`report`] knows no
//! Vulkan. A paper's `record()` lists its passes in the paper's order under the paper's names; each has its oracle in
//! the paper's `reference`, in `f64`, written from the equations.

pub mod cli;
pub mod content;
pub mod file;
pub mod gpu;
pub mod image;
pub mod measure;
mod names;
pub mod papers;
pub mod report;
pub mod scene;
pub mod shader_build;
#[cfg(feature = "window")]
pub mod window;
