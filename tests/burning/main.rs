//! The paper `burning` on the device: against its laws.

#[path = "../common/mod.rs"]
mod common;
mod fire;
mod laws;
mod meshes;
mod refinement;
mod refusals;
mod time;
