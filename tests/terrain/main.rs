//! The paper `terrain` on the device: variant against variant, adversarial maps, extreme cameras, pictures.

#[path = "../common/mod.rs"]
mod common;
mod drawing;
mod land;
mod pictures;
mod pyramids;
mod variants;
