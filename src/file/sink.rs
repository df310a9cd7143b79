//! Destinations that are written to: files, and pipes and devices, whose reader may take its time, or nothing any more.

use std::io::{self, Seek, SeekFrom, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

#[cfg(unix)]
use std::os::fd::AsFd;

static INTERRUPTED: OnceLock<&AtomicBool> = OnceLock::new();

/// From now on, who waits for a reader gives up once `interrupted` is set; the first flag of a process stays.
pub fn heed(interrupted: &'static AtomicBool) {
    INTERRUPTED.get_or_init(|| interrupted);
}

/// A destination that is written to. One that is a stream takes a piece at a time, as it has room: the system would wait for
/// its reader, and no signal but a deadly one would end that.
pub struct Sink<W> {
    inner: W,
    /// Time that a slow reader has after an interruption; none of a regular file.
    #[cfg_attr(not(unix), expect(dead_code, reason = "nothing tells there of room"))]
    patience: Option<Duration>,
}

/// Of what is written when the interruption comes.
const PATIENCE: Duration = Duration::from_secs(1);
/// Of what an interruption has left to be written: less than batch systems wait before they end a program.
const PATIENCE_FOR_THE_REST: Duration = Duration::from_secs(20);

impl<W> Sink<W> {
    /// A regular file, which takes all that the system has space for.
    pub fn file(inner: W) -> Self {
        Sink { inner, patience: None }
    }

    /// A pipe or a device.
    pub fn stream(inner: W) -> Self {
        Sink { inner, patience: Some(if is_interrupted() { PATIENCE_FOR_THE_REST } else { PATIENCE }) }
    }
}

fn is_interrupted() -> bool {
    INTERRUPTED.get().is_some_and(|interrupted| interrupted.load(Ordering::Relaxed))
}

/// Bytes that a pipe with room takes at once: one page of memory.
#[cfg(unix)]
const PIECE_BYTES: usize = 4096;

#[cfg(unix)]
impl<W: Write + AsFd> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(patience) = self.patience else { return self.inner.write(bytes) };
        wait_for_room(&self.inner, patience, &is_interrupted)?;
        let written_bytes = self.inner.write(&bytes[..bytes.len().min(PIECE_BYTES)])?;
        // Standard output keeps a line that has no end yet.
        self.inner.flush()?;
        Ok(written_bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(not(unix))]
impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for Sink<W> {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.inner.seek(place)
    }
}

/// Waits until a page can be written, or the other end is gone, which the next write tells.
///
/// # Errors
/// [`io::ErrorKind::TimedOut`] where a reader takes nothing for so long after an interruption; those of the system.
#[cfg(unix)]
fn wait_for_room(stream: &impl AsFd, patience: Duration, is_interrupted: &dyn Fn() -> bool) -> io::Result<()> {
    use nix::errno::Errno;
    use nix::poll::{PollFd, PollFlags, poll};
    use std::time::Instant;

    const BETWEEN_LOOKS_MS: u8 = 100;
    let mut interrupted_at = None;
    loop {
        match poll(&mut [PollFd::new(stream.as_fd(), PollFlags::POLLOUT)], BETWEEN_LOOKS_MS) {
            Ok(0) | Err(Errno::EINTR) => {}
            Ok(_) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
        if is_interrupted() && interrupted_at.get_or_insert_with(Instant::now).elapsed() >= patience {
            return Err(io::Error::new(io::ErrorKind::TimedOut, "interrupted while its reader took nothing"));
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Read;
    use std::thread;
    use std::time::Instant;

    #[test]
    fn a_reader_that_takes_nothing_is_given_up_after_an_interruption() {
        let (reader, writer) = io::pipe().unwrap();
        let (mut sink, begun) = (Sink::stream(&writer), Instant::now());
        let error = loop {
            match wait_for_room(&writer, Duration::from_millis(200), &|| true) {
                Ok(()) => assert!((1..=PIECE_BYTES).contains(&sink.write(&[7; 1 << 20]).unwrap())),
                Err(error) => break error,
            }
        };
        assert_eq!(error.kind(), io::ErrorKind::TimedOut);
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
        drop(reader);
        assert_eq!(sink.write(&[7]).unwrap_err().kind(), io::ErrorKind::BrokenPipe);
    }

    #[test]
    fn a_slow_reader_gets_all() {
        let (mut reader, writer) = io::pipe().unwrap();
        let slow = thread::spawn(move || {
            thread::sleep(Duration::from_millis(300));
            let mut bytes = Vec::new();
            reader.read_to_end(&mut bytes).map(|_| bytes.len())
        });
        let mut sink = Sink::stream(writer);
        sink.write_all(&vec![7; 3 << 20]).unwrap();
        drop(sink);
        assert_eq!(slow.join().unwrap().unwrap(), 3 << 20);
    }
}
