//! The window and its worker.

mod client;
