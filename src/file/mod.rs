//! Files that a user names: input that is there to its end, and output that appears whole or not at all. CPU only.

mod input;
mod output;

pub use input::{below, open, read, read_text};
pub use output::{OutputError, check_writable, write, write_with};
