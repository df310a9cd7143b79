//! Events on standard output, and the blocks of the file that they name.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;

use crate::window::protocol::{Block, Event};

/// Tells events, from any thread.
#[derive(Clone)]
pub struct Outbox {
    output: Arc<io::Stdout>,
}

impl Outbox {
    pub fn new() -> Self {
        Outbox { output: Arc::new(io::stdout()) }
    }

    /// Tells an event. A window that is gone hears nothing; the end of standard input tells of that.
    pub fn tell(&self, event: &Event) {
        let Ok(mut line) = serde_json::to_vec(event) else { return };
        line.push(b'\n');
        let mut output = self.output.lock();
        let _unheard = output.write_all(&line).and_then(|()| output.flush());
    }
}

/// The file that both processes have open, in blocks. A block belongs to a frame until that is taken.
pub struct Exchange {
    file: File,
    /// Blocks in use, by offset.
    used: Vec<Used>,
}

struct Used {
    offset: u64,
    len: u64,
    serial: u64,
}

/// Blocks begin at its multiples.
const PAGE: u64 = 4096;

impl Exchange {
    /// Opens the file and takes its name away, so that nothing of it stays.
    ///
    /// # Errors
    /// Of a file that is not there.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = File::options().write(true).open(path)?;
        // The window takes it away as well.
        let _gone = std::fs::remove_file(path);
        Ok(Exchange { file, used: Vec::new() })
    }

    /// Writes bytes of frame `serial` where no other frame's are.
    ///
    /// # Errors
    /// Of a file that cannot grow.
    pub fn put(&mut self, serial: u64, bytes: &[u8]) -> io::Result<Block> {
        let len = bytes.len() as u64;
        let (mut offset, mut at) = (0, self.used.len());
        for (index, used) in self.used.iter().enumerate() {
            if offset + len <= used.offset {
                at = index;
                break;
            }
            offset = (used.offset + used.len).next_multiple_of(PAGE);
        }
        self.file.seek(SeekFrom::Start(offset))?;
        self.file.write_all(bytes)?;
        self.used.insert(at, Used { offset, len, serial });
        Ok(Block { offset, len, bytes: Vec::new() })
    }

    /// Frees the blocks of the frames up to `serial`.
    pub fn free(&mut self, serial: u64) {
        self.used.retain(|used| used.serial > serial);
    }

    /// Frees the blocks of frame `serial` alone, which nobody was told of.
    pub fn withdraw(&mut self, serial: u64) {
        self.used.retain(|used| used.serial != serial);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_frames_that_are_not_taken_stay_apart() {
        let file = crate::file::exchange().unwrap();
        let mut exchange = Exchange::open(file.path()).unwrap();
        // Windows may keep the name until both have closed the file.
        assert!(cfg!(windows) || !file.path().exists());
        let first = exchange.put(1, &[1; 5000]).unwrap();
        let second = exchange.put(1, &[2; 10]).unwrap();
        let third = exchange.put(2, &[3; 100]).unwrap();
        assert_eq!([first.offset, second.offset, third.offset], [0, 8192, 12288]);
        exchange.free(1);
        // It lies before the third, the next does not fit there.
        assert_eq!(exchange.put(3, &[4; 9000]).unwrap().offset, 0);
        assert_eq!(exchange.put(3, &[5; 9000]).unwrap().offset, 16384);
        exchange.free(3);
        assert_eq!(exchange.put(4, &[6; 1]).unwrap().offset, 0);
    }

    #[test]
    fn a_frame_that_is_withdrawn_leaves_its_place_and_no_other() {
        let file = crate::file::exchange().unwrap();
        let mut exchange = Exchange::open(file.path()).unwrap();
        let offsets = [1, 2, 2].map(|serial| exchange.put(serial, &[0; 10]).unwrap().offset);
        assert_eq!(offsets, [0, 4096, 8192]);
        exchange.withdraw(2);
        assert_eq!(exchange.put(2, &[0; 10]).unwrap().offset, 4096);
    }
}
