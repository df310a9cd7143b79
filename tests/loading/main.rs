//! Loading of mesh files: what it takes of memory, against another reader, and how fast it ends.
//!
//! A program of its own, whose allocations are counted.

mod files;
mod memory;
mod readers;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held by every test: the allocations of all threads are counted together, and what lasts is measured.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}
