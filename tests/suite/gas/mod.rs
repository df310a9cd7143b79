//! The paper `gas` on the device: against its oracle, closed forms and laws.

mod cache;
mod cut;
mod delta;
mod density;
mod drawing;
mod files;
mod froxels;
mod lists;
mod long;
mod march;
mod paths;
mod pictures;
mod resolve;
mod scale;
mod scenes;
mod shadows;
mod skipping;
mod slab;
mod surfaces;
mod tables;
mod textures;
mod tiles;
