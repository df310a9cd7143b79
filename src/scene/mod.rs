//! The input of rendering, on the CPU only: meshes, height maps, cameras, lights and seeded random numbers.
//!
//! The world is right handed with +Y up. A [`MeshSource`] is what a user types (a built-in shape or
//! a file); [`MeshSource::load`] turns it into a checked [`Mesh`] or an [`Error`] that names the
//! file and the place in it. So do a [`HeightMapSource`] with a [`HeightMap`] and [`load_voxels`] with a [`VoxelGrid`].

mod binary;
mod bounds;
pub mod cache;
mod camera;
mod creases;
mod divide;
mod error;
mod file;
mod formats;
mod height_map;
mod identity;
mod light;
pub mod loading;
mod mesh;
mod mesh_cache;
mod normals;
pub mod notes;
mod numbering;
mod polygon;
pub mod random;
pub mod shapes;
mod source;
mod tags;
mod vertex_order;
mod voxels;
pub mod world_file;

pub use bounds::Bounds;
pub use camera::Camera;
pub use divide::divided;
pub use error::{Asset, Error, Fault, Place};
pub use height_map::{
    Coordinates, Geographic, HeightMap, HeightMapSource, MapOptions, RowSource, Rows, Samples, Shown, Suspect, Voids,
    shown, volcano,
};
pub use identity::{SourceState, read_files, source_sha256};
pub use light::Light;
pub use loading::MeshOptions;
pub use mesh::Mesh;
pub use mesh_cache::{folder as mesh_cache_folder, read as read_kept_mesh};
pub use source::{MeshSource, promised_triangles};
pub use tags::Tags;
pub use voxels::{VoxelGrid, load as load_voxels};
