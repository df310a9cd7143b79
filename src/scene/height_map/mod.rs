//! Height maps: what the terrain is made of.
//!
//! Readers keep integral sources in 16-bit steps. Voids are recognised, counted, and filled until somebody asks for another
//! height.

mod coordinates;
mod formats;
mod geographic;
mod grid;
mod map;
mod rows;
mod shown;
mod slope;
mod source;
mod void_samples;
mod voids;
mod volcano;

pub use coordinates::Coordinates;
pub(in crate::scene) use formats::vrt::parts as mosaic_parts;
pub(in crate::scene) use formats::{is_picture, read_text};
pub use geographic::Geographic;
pub use map::{HeightMap, Samples};
pub use rows::{RowSource, Rows};
pub use shown::{Shown, shown};
pub use source::{HeightMapSource, MapOptions};
pub use void_samples::{Suspect, Voids};
pub use volcano::volcano;
