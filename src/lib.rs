//! placeholder
pub mod gpu;
pub mod image;
pub mod papers;
pub mod scene;
pub mod shader_build;
