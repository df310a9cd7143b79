//! placeholder
pub mod gpu;
pub mod shader_build;
