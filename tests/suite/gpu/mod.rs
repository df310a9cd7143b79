//! Tests of the Vulkan layer.

mod barriers;
mod counters;
mod devices;
mod estimates;
mod first_pass;
mod first_passes;
mod fixtures;
mod indirect;
mod kept_pipelines;
mod loops;
mod memory;
mod memory_model;
mod misuse;
mod misuse_passes;
mod misuse_shaders;
mod misuse_targets;
mod pass_desc;
mod pictures;
mod refusals;
mod replay;
mod resources;
mod sequences;
mod splats;
mod timing;
mod work;
