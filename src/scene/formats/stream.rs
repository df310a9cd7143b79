//! The bytes of a mesh file, read in their order, a piece at a time, so that no file is ever in memory as a whole.

use std::io::{self, Read};

use crate::scene::error::Fault;
use crate::scene::loading::Watch;

/// Bytes between two looks at whether the load is still wanted.
const STEP_BYTES: usize = 4 << 20;

/// Bytes of text that the threads parse at once, each its share.
const WAVE_BYTES: usize = 1 << 20;

/// Why a file is not read to its end.
#[derive(Debug)]
pub enum Stop {
    /// A fault in its contents.
    Fault(Fault),
    /// An error of the system.
    Read(io::Error),
    /// Nobody waits for it any more.
    Interrupted,
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Stop::Fault(fault)
    }
}

/// A file of known size, or bytes in memory.
pub struct Stream<'a> {
    input: Box<dyn Read + 'a>,
    size_bytes: u64,
    done_bytes: u64,
    watch: &'a Watch<'a>,
    /// Parts and colours are wanted.
    pub keeps_tags: bool,
}

impl<'a> Stream<'a> {
    /// Reads at most `size_bytes` of what `input` gives.
    pub fn new(input: impl Read + 'a, size_bytes: u64, watch: &'a Watch<'a>) -> Self {
        Stream { input: Box::new(input), size_bytes, done_bytes: 0, watch, keeps_tags: false }
    }

    /// Size of the whole file in bytes.
    pub fn size_bytes(&self) -> u64 {
        self.size_bytes
    }

    /// Bytes that were read.
    pub fn done_bytes(&self) -> u64 {
        self.done_bytes
    }

    /// Bytes that are not read yet.
    pub fn left_bytes(&self) -> u64 {
        self.size_bytes - self.done_bytes
    }

    /// Appends the next bytes, `most` or as many as are left, and gives their number.
    ///
    /// # Errors
    /// [`Stop::Read`], [`Stop::Interrupted`].
    pub fn append(&mut self, buffer: &mut Vec<u8>, most: usize) -> Result<usize, Stop> {
        let wanted = self.left_bytes().min(most as u64) as usize;
        buffer.try_reserve_exact(wanted).map_err(|error| Stop::Read(error.into()))?;
        let before = buffer.len();
        while buffer.len() - before < wanted {
            self.watch.look(self.done_bytes, self.size_bytes)?;
            let step = STEP_BYTES.min(wanted - (buffer.len() - before));
            let count = (&mut self.input).take(step as u64).read_to_end(buffer).map_err(Stop::Read)?;
            self.done_bytes += count as u64;
            if count < step {
                // The file has shrunk meanwhile.
                self.size_bytes = self.done_bytes;
                break;
            }
        }
        Ok(buffer.len() - before)
    }

    /// All that is left.
    ///
    /// # Errors
    /// As [`Stream::append`].
    pub fn rest(&mut self) -> Result<Vec<u8>, Stop> {
        let mut bytes = Vec::new();
        self.append(&mut bytes, usize::MAX)?;
        Ok(bytes)
    }
}

/// Lines of a text file, many at once.
pub struct Lines<'s, 'a> {
    stream: &'s mut Stream<'a>,
    buffer: Vec<u8>,
    used: usize,
    /// True for a line, without its end, that the next one does not continue.
    is_whole: fn(&[u8]) -> bool,
}

impl<'s, 'a> Lines<'s, 'a> {
    /// The lines that begin with `buffer` and go on with the stream.
    pub fn new(stream: &'s mut Stream<'a>, buffer: Vec<u8>, is_whole: fn(&[u8]) -> bool) -> Self {
        Lines { stream, buffer, used: 0, is_whole }
    }

    /// Whole lines in pieces for the threads; none at the end of the file.
    ///
    /// # Errors
    /// As [`Stream::append`].
    pub fn next(&mut self) -> Result<Vec<&[u8]>, Stop> {
        self.buffer.drain(..self.used);
        let mut searched = 0;
        loop {
            let is_last = self.stream.append(&mut self.buffer, WAVE_BYTES)? == 0;
            let end = if is_last { Some(self.buffer.len()) } else { self.last_end(searched) };
            if let Some(end) = end {
                self.used = end;
                return Ok(self.pieces());
            }
            searched = self.buffer.len();
        }
    }

    /// Bytes that are read and were not given yet.
    pub fn rest(&self) -> &[u8] {
        &self.buffer[self.used..]
    }

    /// One past the last end of a whole line at or after `from`.
    fn last_end(&self, from: usize) -> Option<usize> {
        let mut ends = memchr::memrchr_iter(b'\n', &self.buffer[from..]).map(|at| from + at);
        ends.find(|&at| (self.is_whole)(&self.buffer[..at])).map(|at| at + 1)
    }

    fn pieces(&self) -> Vec<&[u8]> {
        let mut rest = &self.buffer[..self.used];
        let share = (rest.len() / rayon::current_num_threads()).max(1 << 16);
        let mut pieces = Vec::new();
        while !rest.is_empty() {
            let from = share.min(rest.len());
            let mut ends = memchr::memchr_iter(b'\n', &rest[from..]).map(|at| from + at);
            let end = ends.find(|&at| (self.is_whole)(&rest[..at])).map_or(rest.len(), |at| at + 1);
            let (piece, after) = rest.split_at(end);
            pieces.push(piece);
            rest = after;
        }
        pieces
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_whole_lines_and_lose_nothing() {
        let text: String =
            (0..200_000).map(|i| format!("line {i}{}\n", if i % 7 == 0 { " \\" } else { "" })).collect::<String>()
                + "the end";
        let watch = Watch::default();
        let mut stream = Stream::new(text.as_bytes(), text.len() as u64, &watch);
        let mut lines = Lines::new(&mut stream, Vec::new(), |line| !line.ends_with(b"\\"));
        let mut read = Vec::new();
        loop {
            let pieces = lines.next().unwrap();
            if pieces.is_empty() {
                break;
            }
            for piece in pieces {
                let is_last = piece.ends_with(b"the end");
                assert!(is_last || (piece.ends_with(b"\n") && !piece.ends_with(b"\\\n")));
                read.extend_from_slice(piece);
            }
        }
        assert!(read == text.as_bytes());
    }

    #[test]
    fn what_nobody_waits_for_is_not_read() {
        let interrupted = std::sync::atomic::AtomicBool::new(true);
        let watch = Watch { interrupted: &interrupted, ..Watch::default() };
        let mut stream = Stream::new(&b"abc"[..], 3, &watch);
        assert!(matches!(stream.rest(), Err(Stop::Interrupted)));
        let watch = Watch::default();
        // One that was cut while it was read ends there.
        let mut stream = Stream::new(&b"abc"[..], 5, &watch);
        assert_eq!((stream.rest().unwrap(), stream.size_bytes()), (b"abc".to_vec(), 3));
    }
}
