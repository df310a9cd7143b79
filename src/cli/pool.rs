//! The threads that readers and references share.

use std::hint::black_box;
use std::io;
use std::num::NonZero;
use std::sync::{OnceLock, mpsc};
use std::thread::{self, JoinHandle};

use rayon::{ThreadBuilder, ThreadPoolBuilder};

use super::failure::Failure;

/// A thread that waits for its work.
type Waiting = (mpsc::Sender<ThreadBuilder>, JoinHandle<()>);

/// Starts the threads before they are first used, as many as rayon would, or one where the system does not give all of them:
/// rayon would panic. Does nothing once they are there.
///
/// # Errors
/// [`Failure::Running`] where the system does not give one.
pub fn start() -> Result<(), Failure> {
    static STARTED: OnceLock<Result<(), String>> = OnceLock::new();
    STARTED.get_or_init(build).clone().map_err(Failure::Running)
}

fn build() -> Result<(), String> {
    let waiting = waiting().map_err(|error| {
        format!("starting a thread: {error}; raise the limits of memory and of processes, as ulimit -a tells them")
    })?;
    let count = waiting.len();
    let mut senders = waiting.into_iter().map(|(sender, _)| sender);
    let mut hand_over = |thread| senders.next().and_then(|sender| sender.send(thread).ok());
    let gone = || io::Error::other("a thread has ended");
    let pool = ThreadPoolBuilder::new().num_threads(count);
    // Where a caller of this library has built it, it stays as it is.
    let _ = pool.spawn_handler(|thread| hand_over(thread).ok_or_else(gone)).build_global();
    Ok(())
}

/// Threads that are there, so that the pool, which is built once or never, cannot lack one.
fn waiting() -> io::Result<Vec<Waiting>> {
    let wanted = wanted();
    let count = [wanted, 1].into_iter().find(|count| has_room(*count)).ok_or(io::ErrorKind::OutOfMemory)?;
    let mut waiting: Vec<Waiting> = Vec::new();
    for _ in 0..count {
        let (sender, receiver) = mpsc::channel::<ThreadBuilder>();
        let run = move || {
            let _ = receiver.recv().map(ThreadBuilder::run);
        };
        match thread::Builder::new().spawn(run) {
            Ok(handle) => waiting.push((sender, handle)),
            Err(error) if waiting.is_empty() => return Err(error),
            // As many as there are would leave none for others.
            Err(_) => {
                for (sender, handle) in waiting.drain(1..) {
                    drop(sender);
                    // It has done nothing that could fail.
                    let _ = handle.join();
                }
                break;
            }
        }
    }
    Ok(waiting)
}

/// The number that rayon takes by itself.
fn wanted() -> usize {
    let named = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok()).filter(|count| *count > 0);
    let cores = || thread::available_parallelism().map_or(1, NonZero::get);
    named.unwrap_or_else(cores).min(rayon::max_num_threads())
}

/// True where there is memory for so many threads, each with its stack of 2 MiB and what it begins with. A thread that lacks
/// some of that as it begins takes the program down, or hangs it.
fn has_room(threads: usize) -> bool {
    /// Freed pieces of no more than this leave the allocator as it was.
    const PIECE_BYTES: usize = 96 << 10;
    const PIECES: usize = (3 << 20) / PIECE_BYTES;
    let mut pieces = Vec::new();
    let count = threads.saturating_mul(PIECES);
    pieces.try_reserve_exact(count).is_ok()
        && (0..count).all(|_| {
            let mut piece = Vec::<u8>::new();
            let is_there = piece.try_reserve_exact(PIECE_BYTES).is_ok();
            pieces.push(black_box(piece));
            is_there
        })
}
