//! Height maps: what the terrain is made of.

mod geographic;
mod map;
mod volcano;

pub use geographic::Geographic;
pub use map::{HeightMap, Samples};
pub use volcano::volcano;
