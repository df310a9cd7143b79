//! The paper `burning` on the device: against its laws.

mod bending;
mod dump;
mod falling;
mod fire;
mod flames;
mod flames_oracle;
mod laws;
mod lights;
mod materials;
mod melting;
mod meshes;
mod oracle;
mod order;
mod pictures;
mod puddle;
mod refinement;
mod refusals;
mod registries;
mod shown;
mod smoke_volume;
mod solid;
mod spreading;
mod textures;
mod time;
mod twin;
mod visits;
