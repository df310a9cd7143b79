//! Experiments: presets named after the papers' tables and figures, the measured loop, statistics.

pub mod caustics;
pub mod compare;
mod error;
pub mod limits;
pub mod machine;
pub mod measure;
pub mod picture;
pub mod run;
pub mod statistics;

pub use error::Error;
