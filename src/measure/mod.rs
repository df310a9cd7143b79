//! The measured loop, set-ups and sweeps, statistics, limits and comparisons, by the trait of a paper.

pub mod assembly;
pub mod bench;
pub mod compare;
pub mod config;
mod error;
pub mod estimate;
pub mod experiment;
pub mod floor;
pub mod limits;
pub mod machine;
#[allow(clippy::module_inception)]
pub mod measure;
pub mod paper;
pub mod parameter;
pub mod picture;
pub mod profile;
pub mod result_table;
pub mod shard;
pub mod shared_sweep;
pub mod statistics;
pub mod stress;
pub mod study;
pub mod sweep;

pub use error::Error;
pub use paper::{Kind, Paper, Target, Variant};
pub use parameter::{ParameterError, components};
