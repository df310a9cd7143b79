//! Bands of rows, in which a picture is done whose lists no buffer of the device holds at once.

use std::ops::Range;

use bytemuck::Zeroable;

use crate::gpu::{Error, Frame, Pass};
use crate::host_block;

/// Rows of a dispatch: a slow variant's picture is made of many short dispatches, which no watchdog ends.
const DISPATCH_ROWS: u32 = 32;

host_block! {
    /// Rows of the picture: those whose lists are held, or a part of them.
    pub struct BandConstants {
        list_row: u32,
        first_row: u32,
        end_row: u32,
        call: u32,
        calls: u32,
        first_triangle: u32,
        triangle_count: u32,
        picture_row: u32,
        end_list_row: u32,
        rest: u32,
        part: u32,
        part_bits: u32,
    }
}

/// Rows of a picture whose lists are held at once.
#[derive(Debug, Clone, Copy)]
pub struct Band {
    width: u32,
    first_row: u32,
    end_row: u32,
    /// The first row of the frame's first band.
    picture_row: u32,
}

impl Band {
    /// The bands of some `rows` of a picture of `width` pixels a row, at most `at_once` rows each.
    pub fn all(width: u32, rows: &Range<u32>, at_once: u32) -> impl Iterator<Item = Band> {
        let picture_row = rows.start;
        ranges(rows.start, rows.end, at_once).map(move |(first_row, end_row)| Band {
            width,
            first_row,
            end_row,
            picture_row,
        })
    }

    pub fn is_first(self) -> bool {
        self.first_row == self.picture_row
    }

    pub fn constants(self) -> BandConstants {
        let Band { first_row, end_row, picture_row, .. } = self;
        let (list_row, end_list_row) = (first_row, end_row);
        let band = BandConstants { list_row, first_row, end_row, picture_row, end_list_row, ..BandConstants::zeroed() };
        BandConstants { calls: 1, part_bits: self.parts().trailing_zeros(), ..band }
    }

    /// For so many triangles of a piece, before which come others.
    pub fn constants_of_piece(self, first_triangle: u32, triangle_count: u32) -> BandConstants {
        BandConstants { first_triangle, triangle_count, ..self.constants() }
    }

    /// Dispatches of a pass over listed pixels, a power of two: each is of as many pixels as [`DISPATCH_ROWS`] rows have, or fewer.
    fn parts(self) -> u32 {
        (self.end_row - self.first_row).div_ceil(DISPATCH_ROWS).next_power_of_two()
    }

    /// Tiles of that many pixels a side along both axes, the first at its first row.
    pub fn tiles(self, side: u32) -> (u32, u32) {
        (self.width.div_ceil(side), (self.end_row - self.first_row).div_ceil(side))
    }

    /// Dispatches a thread a pixel `calls` times for the triangles of a piece.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_piece(
        self,
        piece: BandConstants,
        calls: u32,
        frame: &mut Frame<'_>,
        pass: &Pass,
    ) -> Result<(), Error> {
        (0..calls).try_for_each(|call| {
            frame.compute(pass, |dispatch| {
                let constants = BandConstants { call, calls, ..piece };
                dispatch.constants(&constants).threads(self.width, self.end_row - self.first_row, 1);
            })
        })
    }

    /// Dispatches a thread a pixel.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch(self, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        frame.compute(pass, |dispatch| {
            dispatch.constants(&self.constants()).threads(self.width, self.end_row - self.first_row, 1)
        })
    }

    /// Dispatches a thread a pixel `calls` times, each of which goes on with what the one before it has left.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_times(self, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        (0..calls).try_for_each(|call| self.dispatch_call(call, calls, frame, pass))
    }

    /// Dispatches a thread a pixel once, as number `call` of the band's `calls` dispatches of the pass.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_call(self, call: u32, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        frame.compute(pass, |dispatch| {
            let constants = BandConstants { call, calls, ..self.constants() };
            dispatch.constants(&constants).threads(self.width, self.end_row - self.first_row, 1);
        })
    }

    /// As [`Band::dispatch_times`], in dispatches that take a short time each.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_in_parts(self, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        (0..calls).try_for_each(|call| {
            frame.compute(pass, |dispatch| {
                for (first_row, end_row) in ranges(self.first_row, self.end_row, DISPATCH_ROWS) {
                    let constants = BandConstants { first_row, end_row, call, calls, ..self.constants() };
                    dispatch.constants(&constants).threads(self.width, end_row - first_row, 1);
                }
            })
        })
    }

    /// Dispatches a pass over the pixels with gas that `sort` has listed `calls` times, in parts that take a short time each.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_listed(self, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        self.dispatch_parts(self.constants(), calls, frame, pass)
    }

    /// The same for the pixels that are not of the lattice whose gas is marched first.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn dispatch_listed_rest(self, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        self.dispatch_parts(BandConstants { rest: 1, ..self.constants() }, calls, frame, pass)
    }

    fn dispatch_parts(self, band: BandConstants, calls: u32, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        (0..calls).try_for_each(|call| {
            frame.compute(pass, |dispatch| {
                for part in 0..self.parts() {
                    dispatch.constants(&BandConstants { part, call, calls, ..band }).groups_indirect();
                }
            })
        })
    }
}

/// `first..end` in ranges of `count`, the last one perhaps shorter.
fn ranges(first: u32, end: u32, count: u32) -> impl Iterator<Item = (u32, u32)> {
    (first..end).step_by(count.max(1) as usize).map(move |from| (from, end.min(from.saturating_add(count))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_in_one_band_of_short_dispatches() {
        for (height, rows) in [(1, 1), (768, 768), (4096, 512), (16384, 33), (5, 9)] {
            for picture in [0..height, height / 3..height / 2 + 1] {
                let bands: Vec<Band> = Band::all(16, &picture, rows).collect();
                assert!(bands.iter().map(|b| b.is_first()).eq((0..bands.len()).map(|number| number == 0)));
                let parts = bands.iter().flat_map(|b| ranges(b.first_row, b.end_row, DISPATCH_ROWS));
                assert!(parts.flat_map(|(first, end)| first..end).eq(picture), "{height} in {rows}");
                for band in &bands {
                    let (parts, pixels) = (band.parts(), 16 * (band.end_row - band.first_row));
                    assert!(pixels.div_ceil(parts) <= 16 * DISPATCH_ROWS && 1 << band.constants().part_bits == parts);
                }
            }
        }
    }
}
