//! Experiments: presets named after the papers' tables and figures, the measured loop, statistics.

pub mod bench;
pub mod burning;
pub mod caustics;
pub mod compare;
mod config;
mod error;
pub mod facts;
pub mod gas;
pub mod lava;
pub mod limits;
pub mod machine;
pub mod measure;
pub mod picture;
pub mod run;
pub mod statistics;
pub mod study;
pub mod sweep;
pub mod terrain;

pub use error::Error;
