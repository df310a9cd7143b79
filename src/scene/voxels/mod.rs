//! Grids of samples in space, from the files of scanners and simulations.

mod grid;
mod lines;
mod nrrd;
mod raw;
mod source;

pub use grid::VoxelGrid;
pub(super) use source::companions;
pub use source::load;

#[cfg(test)]
mod tests;
