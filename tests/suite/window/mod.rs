//! The window and its worker.

mod client;
mod headless;
mod scene;
mod worker;
mod worker_answers;
mod worker_capture;
mod worker_ends;
mod worker_shaders;
