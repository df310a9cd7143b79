//! Reading of mesh files on behalf of a terminal: a bar in bytes for large ones, Ctrl-C, and the cache.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use clap::{Arg, ArgAction, ArgMatches};
use indicatif::{ProgressBar, ProgressStyle};

use super::watch::{interrupted, progress_bar};
use crate::scene::loading::{Conditions, Watch};
use crate::scene::mesh_cache_folder;

const NO_CACHE: &str = "no-cache";

/// Bytes of a file that is read before a bar for it would be seen.
const SEEN_BYTES: u64 = 64 << 20;

/// The option that leaves the cache out.
pub fn option() -> Arg {
    Arg::new(NO_CACHE).long(NO_CACHE).action(ArgAction::SetTrue).help_heading("Scene").help(
        "Read mesh files and maps anew: look for neither in the cache of the user's folder, nor keep anything there",
    )
}

/// Makes what was typed hold for all files that this process loads.
pub fn begin(matches: &ArgMatches) {
    let is_set = |name: &str| matches.try_get_one::<bool>(name).ok().flatten() == Some(&true);
    IS_QUIET.store(is_set("quiet"), Ordering::Relaxed);
    let cache = if is_set(NO_CACHE) { None } else { mesh_cache_folder() };
    Conditions { watch: Watch { interrupted: interrupted(), progress: &show }, cache }.hold();
}

/// Takes the bar away.
pub fn end() {
    if let Some(bar) = BAR.lock().unwrap_or_else(PoisonError::into_inner).take() {
        bar.finish_and_clear();
    }
}

static IS_QUIET: AtomicBool = AtomicBool::new(false);
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn show(done_bytes: u64, size_bytes: u64) {
    if size_bytes < SEEN_BYTES {
        return;
    }
    if done_bytes >= size_bytes {
        return end();
    }
    let mut bar = BAR.lock().unwrap_or_else(PoisonError::into_inner);
    let bar = bar.get_or_insert_with(|| {
        let bar = progress_bar(IS_QUIET.load(Ordering::Relaxed), "reading");
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {bytes}/{total_bytes} {bytes_per_sec} {eta}")
        {
            bar.set_style(style);
        }
        bar
    });
    bar.set_length(size_bytes);
    bar.set_position(done_bytes);
}
