//! The paper `gas` on the device: against its oracle, closed forms and laws.

#[path = "../common/mod.rs"]
mod common;
mod density;
mod drawing;
mod lists;
mod march;
mod pictures;
mod scenes;
mod slab;
mod surfaces;
mod tables;
