//! Grids of samples in space, from the files of scanners and simulations.

mod grid;
mod header;
mod lines;
mod metaimage;
mod nanovdb;
mod nifti;
mod nrrd;
mod raw;
mod source;

pub use grid::VoxelGrid;
pub(super) use source::companions;
pub use source::load;

#[cfg(test)]
mod tests;
