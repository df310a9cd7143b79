//! The paper `burning` on the device: against its laws.

#[path = "../common/mod.rs"]
mod common;
mod dump;
mod fire;
mod laws;
mod meshes;
mod refinement;
mod oracle;
mod refusals;
mod time;
mod twin;
