//! The paper `lava` on the device: each stage against its oracle, laws, and its pictures.

mod animation;
mod bed;
mod benchmarks;
mod blackbody;
mod crust;
mod culling;
mod deferred;
mod density;
mod fluid;
mod frames;
mod gpu_driven;
mod heat;
mod kinds;
mod light;
mod march;
mod objects;
mod pictures;
mod refusals;
mod rock;
mod scene;
mod splatting;
mod surface;
mod vent;
