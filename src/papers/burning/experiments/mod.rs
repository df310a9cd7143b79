//! The tables and figures of the `burning` paper, with the paper's own numbers.

pub mod course;
pub mod presets;
pub mod rates;
pub mod refining;
pub mod strips;
pub mod sweeps;
pub mod texture;
