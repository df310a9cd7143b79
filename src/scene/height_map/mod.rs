//! Height maps: what the terrain is made of.
//!
//! Readers keep integral sources in 16-bit steps. Voids are recognised, filled and counted.

mod formats;
mod geographic;
mod grid;
mod map;
mod source;
mod voids;
mod volcano;

pub use geographic::Geographic;
pub use map::{HeightMap, Samples};
pub use source::HeightMapSource;
pub use volcano::volcano;
