//! placeholder
pub mod cli;
pub mod experiment;
pub mod gpu;
pub mod image;
pub mod papers;
pub mod report;
pub mod scene;
pub mod shader_build;
