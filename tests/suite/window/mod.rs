//! The window and its worker.

mod accessibility;
mod client;
mod desktop;
mod devices;
mod display;
mod displays;
mod drop;
mod faults;
mod headless;
mod interface;
mod interface_keeps;
mod interface_reach;
mod interface_waits;
mod lasting;
mod looking;
mod painting;
mod presents;
mod scene;
mod wayland;
mod worker;
mod worker_answers;
mod worker_capture;
mod worker_ends;
mod worker_shaders;
