//! Every test that needs a device or a program, in one program of its own: `cargo test --release --locked --test suite
//! gas::` runs those of one module.

mod burning;
mod caustics;
mod cli;
mod common;
mod corpus;
mod drivers;
mod faults;
mod gas;
mod gpu;
mod house;
mod lava;
mod page;
mod setup;
mod terrain;
#[cfg(feature = "window")]
mod window;
