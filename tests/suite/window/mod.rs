//! The window and its worker.

mod accessibility;
mod client;
mod desktop;
mod display;
mod drop;
mod faults;
mod headless;
mod interface;
mod lasting;
mod painting;
mod presents;
mod scene;
mod wayland;
mod worker;
mod worker_answers;
mod worker_capture;
mod worker_ends;
mod worker_shaders;
