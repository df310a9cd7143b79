//! The tables and figures of the `caustics` paper, with the paper's own numbers.

mod bars;
pub mod slicing;
pub mod sweep;
mod thesis;
