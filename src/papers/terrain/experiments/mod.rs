//! The tables and figures of the `terrain` paper, with the paper's own numbers.

pub mod collisions;
pub mod figures;
pub mod table;
