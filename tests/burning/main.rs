//! The paper `burning` on the device.

#[path = "../common/mod.rs"]
mod common;
mod fire;
mod laws;
mod meshes;
mod refusals;
mod time;
