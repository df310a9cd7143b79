//! Progress and interruption of long work: a progress bar on a terminal, and Ctrl-C, which keeps what is
//! finished.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::measure::measure::Watch;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The flag that Ctrl-C sets, as do the signals TERM and HUP; a second one ends the program at once.
pub fn interrupted() -> &'static AtomicBool {
    static HANDLER: std::sync::Once = std::sync::Once::new();
    HANDLER.call_once(|| {
        // Without a handler Ctrl-C ends the program, which is the default anyway.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
    });
    &INTERRUPTED
}

/// A bar on standard error; nothing when it is piped or `quiet`.
pub fn progress_bar(quiet: bool, what: &str) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {elapsed} {eta}") {
        bar.set_style(style);
    }
    // A frame of minutes shows that it goes on.
    bar.enable_steady_tick(Duration::from_secs(1));
    bar.set_message(what.to_owned());
    bar
}

/// Runs measured work under a progress bar.
pub fn watched<T>(quiet: bool, what: &str, work: impl FnOnce(&mut Watch<'_>) -> T) -> T {
    let bar = progress_bar(quiet, what);
    let result = work(&mut Watch {
        interrupted: interrupted(),
        progress: &mut |done, expected| {
            bar.set_length(expected);
            bar.set_position(done);
        },
    });
    bar.finish_and_clear();
    result
}
