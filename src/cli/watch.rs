//! Progress and interruption of long work: a progress bar on a terminal, and Ctrl-C, which keeps what is
//! finished.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::outcome::say;
use crate::file;
use crate::measure::measure::Watch;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Called at an interruption in place of setting the flag.
static QUIT: Mutex<Option<Box<dyn Fn() + Send>>> = Mutex::new(None);

/// Keeps the signal HUP from a program whose caller ignores it, as `nohup` does: it goes on when its terminal is
/// closed. Keeps XFSZ from any: a file that grows beyond the caller's limit is an error like others. To be called first
/// in `main`: threads that are started later inherit it. Linux alone tells what is ignored.
#[cfg(unix)]
pub fn keep_ignored() {
    use nix::sys::signal::{SigSet, Signal};
    let hang_up = 1u64 << (Signal::SIGHUP as i32 - 1);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default();
    let mut held_back = SigSet::empty();
    // One that is held back does not end the program.
    held_back.add(Signal::SIGXFSZ);
    if ignored & hang_up != 0 {
        // The handler takes all its signals, so this one is held back before it.
        held_back.add(Signal::SIGHUP);
    }
    let _ = held_back.thread_block();
}

/// Only systems with those signals need it.
#[cfg(not(unix))]
pub fn keep_ignored() {}

/// The flag that Ctrl-C sets, as do the signals TERM and HUP; a second one ends the program at once.
pub fn interrupted() -> &'static AtomicBool {
    handle_interruptions();
    &INTERRUPTED
}

/// From now on an interruption calls `quit` and does nothing else: the program that has a window ends by it.
#[cfg(feature = "window")]
pub fn on_interruption(quit: Box<dyn Fn() + Send>) {
    *QUIT.lock().unwrap_or_else(PoisonError::into_inner) = Some(quit);
    handle_interruptions();
}

fn handle_interruptions() {
    // A process has one handler.
    static HANDLER: std::sync::Once = std::sync::Once::new();
    HANDLER.call_once(|| {
        file::heed(&INTERRUPTED);
        // Without a handler Ctrl-C ends the program, which is the default anyway.
        let _ = ctrlc::set_handler(|| match &*QUIT.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(quit) => quit(),
            None if INTERRUPTED.swap(true, Ordering::Relaxed) => std::process::exit(130),
            None => {}
        });
    });
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

/// The least time between two lines of progress where there is no terminal for a bar.
const BETWEEN_LINES: Duration = Duration::from_secs(30);

/// Time after which work without a bar of progress says that it goes on.
const SILENCE: Duration = Duration::from_secs(10);

/// Says from time to time that work goes on which cannot tell how far it is; until it is dropped.
struct Patience {
    /// Ends it when dropped.
    end: Option<mpsc::Sender<()>>,
    speaker: Option<JoinHandle<()>>,
}

impl Patience {
    fn new(quiet: bool, what: &str) -> Self {
        let (end, ended) = mpsc::channel::<()>();
        let (what, started) = (what.to_owned(), Instant::now());
        let speak = move || {
            let mut silence = SILENCE;
            while ended.recv_timeout(silence) == Err(RecvTimeoutError::Timeout) {
                say(&format!("note: {what} goes on, {:.0} s so far", started.elapsed().as_secs_f64()));
                silence = BETWEEN_LINES;
            }
        };
        // Without a thread for it nothing is said.
        let speaker = (!quiet).then(|| thread::Builder::new().spawn(speak).ok()).flatten();
        Patience { end: Some(end), speaker }
    }
}

impl Drop for Patience {
    fn drop(&mut self) {
        self.end = None;
        // Its last line is said before what comes next.
        let _ = self.speaker.take().map(JoinHandle::join);
    }
}

/// Runs work that cannot tell how far it is, and says from time to time that it goes on; nothing when `quiet`.
pub fn patiently<T>(quiet: bool, what: &str, work: impl FnOnce() -> T) -> T {
    let _patience = Patience::new(quiet, what);
    work()
}

/// Lines that tell from time to time how far work is, where there is no terminal for a bar; nothing when quiet.
pub struct ProgressLines {
    /// The last one; none where there are no lines.
    said: Option<Instant>,
}

impl ProgressLines {
    pub fn new(quiet: bool) -> Self {
        let is_piped = !quiet && !std::io::stderr().is_terminal();
        ProgressLines { said: is_piped.then(Instant::now) }
    }

    /// Says a line where it is time for one.
    pub fn tell(&mut self, line: impl FnOnce() -> String) {
        if let Some(said) = self.said.as_mut().filter(|said| said.elapsed() >= BETWEEN_LINES) {
            *said = Instant::now();
            say(&line());
        }
    }
}

/// Runs measured work under a progress bar. Piped work that takes long says that it goes on until its first frame is there, and then
/// how far it is, a line at a time.
pub fn watched<T>(quiet: bool, what: &str, work: impl FnOnce(&mut Watch<'_>) -> T) -> T {
    let bar = progress_bar(quiet, what);
    let mut lines = ProgressLines::new(quiet);
    let mut patience = Some(Patience::new(quiet || !bar.is_hidden(), &format!("{what}: the first frame")));
    let result = work(&mut Watch {
        interrupted: interrupted(),
        progress: &mut |done, expected| {
            patience = None;
            bar.set_length(expected);
            bar.set_position(done);
            lines.tell(|| {
                let percent = 100.0 * done as f64 / expected.max(1) as f64;
                format!("{what}: {done} of {expected} frames, {percent:.0} %")
            });
        },
    });
    drop(patience);
    bar.finish_and_clear();
    result
}
