//! Tests of the programs themselves: what they print, what they write, and how they end.
//!
//! They run on lavapipe (`FUMAROLE_TEST_DEVICE` names another device) and fail where there is none.

mod ab;
#[cfg(unix)]
mod ab_looks;
mod arguments;
mod bench;
mod burning;
mod burning_dumps;
pub mod burning_materials;
mod burning_sweeps;
pub mod compare;
pub mod depth;
mod devices;
pub mod dumps;
mod experiment;
mod experiment_tables;
mod gas;
mod gas_experiments;
mod gas_volumes;
mod help;
mod hostile;
mod hostile_cost;
mod hostile_documents;
mod hostile_readers;
mod hostile_shaders;
mod interruption;
mod kubernetes;
mod lava;
mod lava_chapter_9;
mod loops;
mod meshes;
mod outputs;
#[cfg(unix)]
mod outputs_read;
mod pages;
mod parts;
mod passes;
pub mod program;
pub mod properties;
mod ranges;
mod render;
mod report;
mod scales;
mod shaders;
mod shards;
mod slurm;
mod streams;
mod stress;
mod stress_ends;
mod terrain;
mod terrain_drapes;
mod terrain_tiles;
mod vulkan;
