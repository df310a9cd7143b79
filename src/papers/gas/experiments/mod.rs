//! The tables and figures of the `gas` paper, with the paper's own numbers.

pub mod tables;
