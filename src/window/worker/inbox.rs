//! Requests, read while frames are drawn.

use std::collections::VecDeque;
use std::io::{self, BufRead};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use super::outbox::Outbox;
use crate::window::protocol::{Event, Numbered, Request};

/// Time that the worker has to end in order when nobody wants it any more; a frame may take longer.
const GRACE: Duration = Duration::from_secs(2);

/// Requests that have come and are not yet taken.
#[derive(Clone)]
pub struct Inbox {
    shared: Arc<Shared>,
}

struct Shared {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    requests: VecDeque<Numbered>,
    is_over: bool,
}

impl Inbox {
    /// Reads standard input on a thread of its own. When that ends, or asks for the end, and the worker does not end by
    /// itself, the process ends.
    ///
    /// # Errors
    /// Of a system without another thread.
    pub fn open(outbox: Outbox) -> io::Result<Self> {
        let inbox = Inbox { shared: Arc::new(Shared { waiting: Mutex::default(), changed: Condvar::new() }) };
        let filled = inbox.clone();
        thread::Builder::new().name("requests".into()).spawn(move || {
            for line in io::stdin().lock().lines().map_while(Result::ok) {
                match serde_json::from_str::<Numbered>(&line) {
                    Ok(Numbered { request: Request::Quit, .. }) => break,
                    Ok(request) => filled.push(request),
                    Err(error) => outbox.tell(&Event::Failed { id: 0, problem: format!("reading a request: {error}") }),
                }
            }
            filled.lock().is_over = true;
            filled.shared.changed.notify_all();
            thread::sleep(GRACE);
            // A driver that is busy has nothing to save.
            super::process::end_now();
        })?;
        Ok(inbox)
    }

    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.shared.waiting.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Adds a request of the worker's own.
    pub fn push(&self, request: Numbered) {
        self.lock().requests.push_back(request);
        self.shared.changed.notify_all();
    }

    /// All requests that have come, in their order; waits for one, or until `end` where there is one. `None` when nobody wants
    /// the worker any more.
    pub fn take(&self, end: Option<Instant>) -> Option<Vec<Numbered>> {
        let mut waiting = self.lock();
        loop {
            if waiting.is_over {
                return None;
            }
            let left = end.map(|end| end.saturating_duration_since(Instant::now()));
            if !waiting.requests.is_empty() || left == Some(Duration::ZERO) {
                return Some(waiting.requests.drain(..).collect());
            }
            let changed = &self.shared.changed;
            waiting = match left {
                None => changed.wait(waiting).unwrap_or_else(|poisoned| poisoned.into_inner()),
                Some(left) => changed.wait_timeout(waiting, left).unwrap_or_else(|poisoned| poisoned.into_inner()).0,
            };
        }
    }

    /// True when something waits that what is being done now would come before for nothing.
    pub fn is_stale(&self) -> bool {
        let waiting = self.lock();
        let changes = |numbered: &Numbered| !matches!(numbered.request, Request::Taken(_));
        waiting.is_over || waiting.requests.iter().any(changes)
    }

    /// True when the end is wanted, of the worker or of what takes long; that request is taken out.
    pub fn is_cancelled(&self) -> bool {
        let mut waiting = self.lock();
        let before = waiting.requests.len();
        waiting.requests.retain(|numbered| numbered.request != Request::Cancel);
        waiting.is_over || waiting.requests.len() < before
    }
}
