//! TIFFs whose samples are read as they are stored.
//!
//! A picture can say that its lowest number is white, and the library turns its samples over for that. Heights are the
//! numbers themselves, so the library is told that the lowest number is black.

use std::collections::BTreeSet;
use std::io::{self, Read, Seek, SeekFrom};

/// A TIFF of which all pictures say that their lowest number is black.
pub(super) struct Stored<R> {
    input: R,
    position: u64,
    /// Offsets of the bytes that are read as 1, black is the lowest, and not as the 0 that they are.
    ones: BTreeSet<u64>,
}

/// Directories, one a picture, that are looked at: far more than overviews can be asked for.
const MOST_DIRECTORIES: usize = 1024;
/// Entries of a directory that are looked at: they are in the order of their tags, and few tags have lower numbers.
const MOST_ENTRIES: u64 = 512;
const PHOTOMETRIC_INTERPRETATION: u64 = 262;

impl<R: Read + Seek> Stored<R> {
    /// From the first byte on.
    ///
    /// # Errors
    /// Those of going back there.
    pub(super) fn new(mut input: R) -> io::Result<Self> {
        let mut ones = BTreeSet::new();
        // What is cut off or damaged is told by whoever reads all of it.
        let _ = find_zeros(&mut input, &mut ones);
        input.rewind()?;
        Ok(Stored { input, position: 0, ones })
    }
}

/// Finds the bytes that say white is the lowest number, up to the first that are not there.
fn find_zeros(input: &mut (impl Read + Seek), zeros: &mut BTreeSet<u64>) -> Option<()> {
    let mut bytes = |offset: u64, count: u64| {
        let mut bytes = Vec::new();
        input.seek(SeekFrom::Start(offset)).ok()?;
        Read::take(&mut *input, count).read_to_end(&mut bytes).ok()?;
        Some(bytes)
    };
    let head = bytes(0, 16)?;
    let is_big_endian = head.starts_with(b"MM");
    let number = |bytes: Option<&[u8]>| {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        bytes.map(|bytes| if is_big_endian { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) })
    };
    let is_big_tiff = number(head.get(2..4))? == 43;
    // Bytes of an offset, of the number of entries, and of an entry: tag, kind, number of values, value.
    let (offset_bytes, count_bytes, entry_bytes) = if is_big_tiff { (8, 8, 20) } else { (4, 2, 12) };
    let mut directory = number(head.get(offset_bytes..2 * offset_bytes))?;
    let mut seen = BTreeSet::new();
    while directory != 0 && seen.len() < MOST_DIRECTORIES && seen.insert(directory) {
        let count = number(bytes(directory, count_bytes)?.get(..count_bytes as usize))?;
        let first = directory.checked_add(count_bytes)?;
        let entries = bytes(first, count.min(MOST_ENTRIES) * entry_bytes)?;
        for (index, entry) in (0..).zip(entries.chunks_exact(entry_bytes as usize)) {
            let value_bytes = match number(entry.get(2..4))? {
                1 => 1,
                3 => 2,
                4 => 4,
                16 => 8,
                _ => continue,
            };
            let place = 4 + offset_bytes;
            let is_zero = number(entry.get(place..place + value_bytes)) == Some(0);
            if is_zero && number(entry.get(..2))? == PHOTOMETRIC_INTERPRETATION {
                let lowest = if is_big_endian { value_bytes - 1 } else { 0 };
                zeros.insert(first.checked_add(index * entry_bytes)?.checked_add((place + lowest) as u64)?);
            }
        }
        let next = bytes(first.checked_add(count.checked_mul(entry_bytes)?)?, offset_bytes as u64)?;
        directory = number(next.get(..offset_bytes))?;
    }
    Some(())
}

impl<R: Read> Read for Stored<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        let end = self.position.saturating_add(count as u64);
        for place in self.ones.range(self.position..end) {
            if let Some(byte) = buffer.get_mut((place - self.position) as usize) {
                *byte = 1;
            }
        }
        self.position = end;
        Ok(count)
    }
}

impl<R: Seek> Seek for Stored<R> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.position = self.input.seek(to)?;
        Ok(self.position)
    }

    fn stream_position(&mut self) -> io::Result<u64> {
        Ok(self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{geotiff, load};
    use super::*;
    use crate::scene::height_map::{RowSource, Rows};
    use std::io::Cursor;

    /// A value of a tag, as long as its kind.
    type Value<'a> = (u16, u16, &'a [u8]);

    /// A TIFF of pictures of 3 x 2 samples without packing: photometric interpretation, kind of sample, its bits, samples.
    fn tiff(is_big_endian: bool, pictures: &[(u16, u16, u32, [u8; 24])]) -> Vec<u8> {
        let short = |value: u16| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let long = |value: u32| if is_big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
        let mut file = if is_big_endian { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
        file.extend(long(8));
        for (number, (photometric, kind, bits, samples)) in pictures.iter().enumerate() {
            let directory = file.len() as u32;
            let pixels = directory + 2 + 11 * 12 + 4;
            let size_bytes = 6 * bits / 8;
            let values: [Value<'_>; 11] = [
                (254, 4, &long(u32::from(number > 0))),
                (256, 4, &long(3)),
                (257, 4, &long(2)),
                (258, 3, &short(*bits as u16)),
                (259, 3, &short(1)),
                (262, 3, &short(*photometric)),
                (273, 4, &long(pixels)),
                (277, 3, &short(1)),
                (278, 4, &long(2)),
                (279, 4, &long(size_bytes)),
                (339, 3, &short(*kind)),
            ];
            file.extend(short(values.len() as u16));
            for (tag, kind, value) in values {
                file.extend([&short(tag)[..], &short(kind), &long(1), value].concat());
                file.resize(file.len() + 4 - value.len(), 0);
            }
            let is_last = number + 1 == pictures.len();
            file.extend(long(if is_last { 0 } else { pixels + size_bytes }));
            file.extend(&samples[..size_bytes as usize]);
        }
        file
    }

    /// Numbers of so many bytes.
    fn samples<const N: usize>(numbers: [[u8; N]; 6]) -> [u8; 24] {
        let mut bytes = [0; 24];
        bytes[..6 * N].copy_from_slice(numbers.as_flattened());
        bytes
    }

    #[test]
    fn white_at_zero_turns_no_height_over() {
        let heights = [7.0, 100.0, 3.0, 0.0, 60.0, 12.0];
        let whole = heights.map(|height: f32| height as i16);
        for is_big_endian in [false, true] {
            let order = |[low, high]: [u8; 2]| if is_big_endian { [high, low] } else { [low, high] };
            let float = heights.map(|height| if is_big_endian { height.to_be_bytes() } else { height.to_le_bytes() });
            for (kind, bits, stored) in [
                (1, 8, samples(whole.map(|height| [height as u8]))),
                (1, 16, samples(whole.map(|height| order(height.to_le_bytes())))),
                (2, 16, samples(whole.map(|height| order(height.to_le_bytes())))),
                (3, 32, samples(float)),
            ] {
                let picture = |photometric| (photometric, kind, bits, stored);
                let [black, white] = [1, 0].map(|photometric| tiff(is_big_endian, &[picture(1), picture(photometric)]));
                let folder = tempfile::tempdir().unwrap();
                let path = folder.path().join("a.tif");
                for (bytes, overview) in
                    [(&tiff(is_big_endian, &[picture(0)]), 0), (&black, 1), (&white, 1), (&white, 0)]
                {
                    std::fs::write(&path, bytes).unwrap();
                    let map = load(&path, overview).unwrap();
                    let found: Vec<f32> = (0..6).map(|index| map.height_m(index % 3, index / 3)).collect();
                    assert_eq!(found, heights, "{bits} bits of kind {kind}, overview {overview}");
                    // Row by row.
                    let mut found = Vec::new();
                    let rows = RowSource::geotiff(&path, overview).unwrap().unwrap();
                    let take = &mut |rows: Rows<'_>| {
                        match rows {
                            Rows::Steps(steps) => found.extend(steps.iter().map(|&step| f32::from(step))),
                            Rows::Float(heights) => found.extend_from_slice(heights),
                        }
                        true
                    };
                    rows.read(&path, take).unwrap().unwrap();
                    assert_eq!(found, heights, "{bits} bits of kind {kind}, overview {overview}, row by row");
                }
            }
        }
    }

    #[test]
    fn damaged_directories_are_no_panic() {
        let stored = [9; 24];
        let whole = tiff(false, &[(0, 1, 8, stored), (0, 1, 8, stored)]);
        for place in 0..whole.len() {
            for byte in [0, 1, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] = byte;
                let _ = geotiff::parse(bytes.len() as u64, Cursor::new(&bytes[..]), 0);
                let _ = geotiff::parse(place as u64, Cursor::new(&whole[..place]), 0);
            }
        }
        // A directory whose next is itself.
        let mut ring = tiff(false, &[(0, 1, 8, stored)]);
        ring[8 + 2 + 11 * 12..][..4].copy_from_slice(&8_u32.to_le_bytes());
        assert_eq!(Stored::new(Cursor::new(ring)).unwrap().ones.len(), 1);
    }
}
