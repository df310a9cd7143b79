//! Tests of the Vulkan layer.

#[path = "../common/mod.rs"]
mod common;

mod barriers;
mod counters;
mod devices;
mod fixtures;
mod indirect;
mod memory_model;
mod pictures;
mod refusals;
mod replay;
mod resources;
mod sentences;
mod sequences;
mod splats;
mod timing;
