//! The papers, one folder each. They know no option's spelling, no window and no terminal.

pub mod burning;
pub mod caustics;
pub mod gas;
pub mod lava;
#[cfg(test)]
mod layout;
pub mod terrain;
