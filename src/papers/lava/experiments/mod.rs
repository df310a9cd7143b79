//! The tables and figures of the `lava` paper, with the paper's own numbers.

pub mod figures;
pub mod floors;
pub mod results;
pub mod scaling;
