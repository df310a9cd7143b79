//! The tracked state of a resource: as the finished submissions left it, and as the one being recorded will leave it.
//! One submission at a time holds a resource, from its first touch until it has finished or was given up.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use super::buffer::Buffer;
use super::image::Image;

/// Names a submission to the resources that it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct SubmissionId(u64);

impl SubmissionId {
    /// One that no other submission of the process has.
    pub fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        SubmissionId(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

/// The user of a resource that keeps all others away from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Holder {
    Nobody,
    /// The host reads its mapped memory, as many times at once.
    Host(u32),
    Submission(SubmissionId),
}

/// A resource is in use by another submission, or by the host.
pub(crate) struct InUse;

/// The state of one resource.
pub(crate) struct Tracked<S> {
    cell: Mutex<Cell<S>>,
}

struct Cell<S> {
    committed: S,
    pending: S,
    holder: Holder,
}

impl<S: Clone> Tracked<S> {
    pub fn new(state: S) -> Self {
        Tracked { cell: Mutex::new(Cell { pending: state.clone(), committed: state, holder: Holder::Nobody }) }
    }

    /// Visits the state on behalf of `submission`, which holds the resource from here on. True beside the visitor's
    /// answer says that it did not before: it must [release](Tracked::release) it.
    pub fn visit<T>(&self, submission: SubmissionId, visit: impl FnOnce(&mut S) -> T) -> Result<(T, bool), InUse> {
        let mut cell = self.lock();
        let cell = &mut *cell;
        let is_first = cell.holder != Holder::Submission(submission);
        if is_first {
            if cell.holder != Holder::Nobody {
                return Err(InUse);
            }
            cell.pending.clone_from(&cell.committed);
            cell.holder = Holder::Submission(submission);
        }
        Ok((visit(&mut cell.pending), is_first))
    }

    /// Ends the hold of `submission`: with `commit` the state is what it left, otherwise what was there before it.
    pub fn release(&self, submission: SubmissionId, commit: bool) {
        let mut cell = self.lock();
        let cell = &mut *cell;
        if cell.holder == Holder::Submission(submission) {
            cell.holder = Holder::Nobody;
            if commit {
                std::mem::swap(&mut cell.committed, &mut cell.pending);
            }
        }
    }

    /// Writes mapped memory from the host; no submission begins to use it meanwhile.
    pub fn write_from_host<T>(&self, write: impl FnOnce(&mut S) -> T) -> Result<T, InUse> {
        let mut cell = self.lock();
        if cell.holder != Holder::Nobody {
            return Err(InUse);
        }
        Ok(write(&mut cell.committed))
    }

    /// Begins to read mapped memory from the host after a look at the state; no submission can use it until the guard
    /// is dropped.
    pub fn read_from_host<T>(&self, look: impl FnOnce(&S) -> T) -> Result<(T, HostRead<'_, S>), InUse> {
        let mut cell = self.lock();
        let readers = match cell.holder {
            Holder::Nobody => 0,
            Holder::Host(readers) => readers,
            Holder::Submission(_) => return Err(InUse),
        };
        cell.holder = Holder::Host(readers + 1);
        Ok((look(&cell.committed), HostRead { tracked: self }))
    }

    fn lock(&self) -> MutexGuard<'_, Cell<S>> {
        self.cell.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

/// Keeps submissions away from mapped memory while the host reads it.
pub(crate) struct HostRead<'a, S: Clone> {
    tracked: &'a Tracked<S>,
}

impl<S: Clone> Drop for HostRead<'_, S> {
    fn drop(&mut self) {
        let mut cell = self.tracked.lock();
        cell.holder = match cell.holder {
            Holder::Host(readers) if readers > 1 => Holder::Host(readers - 1),
            _ => Holder::Nobody,
        };
    }
}

/// A resource that a submission holds and keeps alive.
pub(crate) enum Held {
    Buffer(Arc<Buffer>),
    Image(Arc<Image>),
}

impl Held {
    pub fn release(self, submission: SubmissionId, commit: bool) {
        match self {
            Held::Buffer(buffer) => buffer.states.release(submission, commit),
            Held::Image(image) => image.states.release(submission, commit),
        }
    }
}
