//! Built-in meshes, all around the origin with +Y up.

mod primitives;
mod teapot;
mod teapot_patches;

pub use primitives::{cuboid, plane, sphere};
pub use teapot::teapot;
