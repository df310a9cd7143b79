//! Height maps: what the terrain is made of.

mod geographic;
mod map;

pub use geographic::Geographic;
pub use map::{HeightMap, Samples};
