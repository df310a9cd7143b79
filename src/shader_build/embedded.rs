//! The shaders that the build script compiled.

use super::{EmbeddedShader, Stage};

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
