//! The window's end of a worker: starts it, speaks to it, and ends it.

use std::collections::VecDeque;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use tempfile::TempPath;

use super::protocol::{Block, Ended, Event, Numbered, Request};
use crate::file;
use crate::gpu::for_another_process;

/// Lines of standard error that are kept.
const LINES: usize = 20;
/// Time that a worker has to end by itself.
const GRACE: Duration = Duration::from_millis(250);
/// Between two looks at a worker that is about to end.
const LOOK: Duration = Duration::from_millis(2);

/// An event, as the window is told it.
struct Told {
    event: Event,
    /// Number of the frame that it is, or that it stands for.
    serial: Option<u64>,
}

/// A worker. It ends when this is dropped.
pub struct Client {
    child: Arc<Mutex<Child>>,
    requests: Option<Sender<Numbered>>,
    events: Receiver<Told>,
    last_id: u64,
    is_alive: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Client {
    /// Starts `program` with `arguments`: a paper's hidden verb `worker` with the options of its set-up, to which the
    /// option that names the common file is added. `wake` is called on another thread whenever there is an event.
    ///
    /// # Errors
    /// Of a program that does not start, or a file for the pictures that cannot be made.
    pub fn spawn(program: &Path, arguments: &[OsString], wake: impl Fn() + Send + 'static) -> io::Result<Self> {
        let exchange = file::exchange()?;
        let blocks = exchange.reopen()?;
        let mut command = Command::new(program);
        command.args(arguments).arg("--exchange").arg(exchange.path());
        for_another_process(&mut command);
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let (input, output, errors) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (Some(input), Some(output), Some(errors)) = (input, output, errors) else {
            return Err(io::Error::other("the worker has no pipes"));
        };
        let child = Arc::new(Mutex::new(child));
        let is_alive = Arc::new(AtomicBool::new(true));
        let (requests, queue) = mpsc::channel();
        let (sender, events) = mpsc::channel();
        let writer = thread::Builder::new().name("requests".into()).spawn(move || write_requests(input, &queue))?;
        let heard = Arc::new(Mutex::new(VecDeque::new()));
        let listener = Listener {
            blocks,
            exchange: Some(exchange.into_temp_path()),
            heard: heard.clone(),
            child: child.clone(),
            is_alive: is_alive.clone(),
        };
        let errors = thread::Builder::new().name("errors".into()).spawn(move || {
            for line in BufReader::new(errors).split(b'\n').map_while(Result::ok) {
                remember(&heard, String::from_utf8_lossy(&line).into_owned());
            }
        })?;
        let reader = thread::Builder::new().name("events".into()).spawn(move || {
            listener.listen(BufReader::new(output), errors, |told| {
                // A window that has gone wants no more.
                let _ = sender.send(told);
                wake();
            });
        })?;
        Ok(Client { child, requests: Some(requests), events, last_id: 0, is_alive, threads: vec![writer, reader] })
    }

    /// Sends a request and gives its number; never waits. What is sent to a worker that is gone is lost.
    pub fn send(&mut self, request: Request) -> u64 {
        self.last_id += 1;
        if let Some(requests) = &self.requests {
            let _ = requests.send(Numbered { id: self.last_id, request });
        }
        self.last_id
    }

    /// The next event, if there is one; never waits. The worker may then draw another frame.
    pub fn try_receive(&mut self) -> Option<Event> {
        let Told { event, serial } = self.events.try_recv().ok()?;
        // Of a frame that could not be read as well: the worker waits for those that it has told of.
        if let Some(serial) = serial {
            self.send(Request::Taken(serial));
        }
        Some(event)
    }

    /// False when the worker is gone; [`Event::Ended`] tells how.
    pub fn is_alive(&self) -> bool {
        self.is_alive.load(Ordering::Acquire)
    }

    /// Number of the worker's process.
    pub fn process_id(&self) -> u32 {
        lock(&self.child).id()
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.send(Request::Quit);
        self.requests = None;
        // One that draws a long frame does not hear; it holds nothing that outlives it.
        end(&self.child, GRACE);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

fn remember(heard: &Mutex<VecDeque<String>>, line: String) {
    let mut heard = lock(heard);
    heard.push_back(line);
    if heard.len() > LINES {
        heard.pop_front();
    }
}

fn write_requests(mut input: ChildStdin, queue: &Receiver<Numbered>) {
    for request in queue {
        let Ok(mut line) = serde_json::to_vec(&request) else { continue };
        line.push(b'\n');
        if input.write_all(&line).is_err() {
            return;
        }
    }
}

/// Waits for the child to end by itself, and kills it after `grace`.
fn end(child: &Mutex<Child>, grace: Duration) -> Option<ExitStatus> {
    let started = Instant::now();
    let mut is_killed = false;
    loop {
        let mut child = lock(child);
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) => {}
            Err(_) => return None,
        }
        if !is_killed && started.elapsed() >= grace {
            is_killed = child.kill().is_ok();
        }
        drop(child);
        thread::sleep(LOOK);
    }
}

/// Hears what the worker says.
struct Listener {
    blocks: File,
    /// Removed as soon as the worker has it open, which it has when it speaks.
    exchange: Option<TempPath>,
    heard: Arc<Mutex<VecDeque<String>>>,
    child: Arc<Mutex<Child>>,
    is_alive: Arc<AtomicBool>,
}

impl Listener {
    fn listen(mut self, output: impl BufRead, errors: JoinHandle<()>, tell: impl Fn(Told)) {
        for line in output.split(b'\n').map_while(Result::ok) {
            self.exchange = None;
            match serde_json::from_slice::<Event>(&line) {
                Ok(mut event) => {
                    let serial = if let Event::Frame(frame) = &event { Some(frame.serial) } else { None };
                    if let Err(error) = self.fill(&mut event) {
                        let problem = format!("reading the worker's pictures: {error}");
                        event = Event::Failed { id: 0, problem };
                    }
                    tell(Told { event, serial });
                }
                // A driver's own words on standard output.
                Err(_) => remember(&self.heard, String::from_utf8_lossy(&line).into_owned()),
            }
        }
        let status = end(&self.child, GRACE);
        let _ = errors.join();
        self.is_alive.store(false, Ordering::Release);
        let stderr = lock(&self.heard).drain(..).collect();
        let ended = Ended { code: status.and_then(|s| s.code()), signal: signal(status), stderr };
        tell(Told { event: Event::Ended(ended), serial: None });
    }

    fn fill(&mut self, event: &mut Event) -> io::Result<()> {
        let Event::Frame(frame) = event else { return Ok(()) };
        let pictures = frame.sides.iter_mut().filter_map(|side| side.picture.as_mut());
        let difference = frame.difference.as_mut().map(|difference| &mut difference.picture);
        let thumbnails = frame.thumbnails.iter_mut().filter_map(|thumbnail| thumbnail.picture.as_mut());
        let pictures = pictures.chain(difference).chain(thumbnails).map(|picture| &mut picture.block);
        let values = frame.target.as_mut().map(|target| &mut target.block);
        pictures.chain(values).try_for_each(|block| read_block(&mut self.blocks, block))
    }
}

fn read_block(file: &mut File, block: &mut Block) -> io::Result<()> {
    // A length that a damaged line makes up must not take all memory.
    let end = block.offset.saturating_add(block.len);
    if end > file.metadata()?.len() {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    file.seek(SeekFrom::Start(block.offset))?;
    block.bytes = vec![0; usize::try_from(block.len).map_err(io::Error::other)?];
    file.read_exact(&mut block.bytes)
}

#[cfg(unix)]
fn signal(status: Option<ExitStatus>) -> Option<i32> {
    use std::os::unix::process::ExitStatusExt;
    status.and_then(|status| status.signal())
}

#[cfg(not(unix))]
fn signal(_: Option<ExitStatus>) -> Option<i32> {
    None
}
