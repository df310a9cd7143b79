//! The paper `terrain` on the device: variant against variant, adversarial maps, extreme cameras, pictures.

mod collisions;
mod corners;
mod drawing;
mod far;
mod footprint;
mod light;
mod maps;
mod mesh_lod;
mod normals;
mod oracle;
mod pictures;
mod pyramids;
mod ridges;
mod rough;
mod scenes;
mod silhouette;
mod start;
mod tiles;
mod tints;
mod variants;
mod verdict;
mod world;
