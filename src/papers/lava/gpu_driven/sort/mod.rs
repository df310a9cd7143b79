//! Passes `cell-keys` to `cell-starts`: the particles in the order of their cells, in place of the thesis's clusters (section
//! 5.2). The sort is stable and takes no atomics, so that sums over its order are the same to the bit in every run.

mod arrange;
mod cell_keys;
mod cell_starts;
mod sort_count;
mod sort_scatter;
mod sort_sum;

use std::sync::Arc;

use ash::vk;

use self::arrange::arrange;
use self::cell_keys::cell_keys;
use self::cell_starts::cell_starts;
use self::sort_count::sort_count;
use self::sort_scatter::sort_scatter;
use self::sort_sum::sort_sum;
use super::super::targets::Context;
use super::by_cells;
use super::cells::Cells;
use super::density;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, ImageView, Pass};
use crate::host_block;
use crate::papers::texels;

host_block! {
    struct CellConstants {
        space_m: [f32; 3],
        particles: u32,
        counts: [u32; 3],
        width: u32,
        pieces: u32,
    }
}

host_block! {
    struct SortConstants {
        items: u32,
        blocks: u32,
        shift: u32,
        first_sum: u32,
        second_sum: u32,
    }
}

host_block! {
    struct SumConstants {
        first: u32,
        count: u32,
        to: u32,
    }
}

/// Values of a digit, bits of it, items of a block and counts of a run: those of `lava/sort.glsl`.
const DIGITS: u32 = 1 << BITS;
const BITS: u32 = 7;
const BLOCK: u32 = 256;
const RUN: u32 = 256;

/// The passes, and what they leave.
pub struct Sort {
    /// One for each texture of positions.
    cell_keys: Vec<Pass>,
    /// Of each digit, the lowest first.
    digits: Vec<Digit>,
    sort_sum: Pass,
    /// One for each texture of positions.
    arrange: Vec<Pass>,
    cell_starts: Pass,
    constants: CellConstants,
    cell_count: u32,
    /// Cell and number of each particle by cells.
    pub items: Arc<Buffer>,
    /// Places by cells, metres.
    pub places: Arc<ImageView>,
    /// The first particle of each cell, and the end of the last.
    pub starts: Arc<Buffer>,
    /// A word for each piece of `density`.
    pub reached: Arc<Buffer>,
}

struct Digit {
    sort_count: Pass,
    sort_scatter: Pass,
    shift: u32,
}

/// Words of the buffer of counts: those of all digits and blocks, the sums of their runs, and of the runs of those.
struct Counts {
    blocks: u32,
    first_sum: u32,
    second_sum: u32,
    third_sum: u32,
}

impl Counts {
    fn of(items: u32) -> Self {
        let blocks = items.div_ceil(BLOCK);
        let first_sum = blocks * DIGITS;
        let second_sum = first_sum + first_sum.div_ceil(RUN);
        let third_sum = second_sum + (second_sum - first_sum).div_ceil(RUN);
        Counts { blocks, first_sum, second_sum, third_sum }
    }
}

/// Bytes of all that the sort has.
pub fn bytes(cells: &Cells) -> f64 {
    let words = f64::from(Counts::of(cells.particles).third_sum) + 1.0;
    let places = texels::bytes_of(f64::from(cells.particles));
    16.0 * f64::from(cells.particles) + places + 4.0 * words + 4.0 * (f64::from(cells.count()) + 1.0)
}

impl Sort {
    /// Of the particles in any of these textures.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, cells: &Cells, positions: &[&Arc<ImageView>]) -> Result<Self, Error> {
        let Context { shaders, parameters, .. } = context;
        let particles = cells.particles;
        let buffer = |name: &str, words: u32| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let desc = BufferDesc::new(context.name(name), 4 * u64::from(words)).usage(usage);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by("particles"))
        };
        let items = [buffer("items-a", 2 * particles)?, buffer("items-b", 2 * particles)?];
        let counts = buffer("sort-counts", Counts::of(particles).third_sum + 1)?;
        let places = by_cells::texture(context, "places-by-cells", particles)?;
        let starts = buffer("cell-starts", cells.count() + 1)?;
        let pieces = density::pieces(particles);
        let reached = buffer("reached-pieces", pieces)?;

        let cell_keys = cell_keys(context, positions, &items[0])?;
        let digit = |n: u32| -> Result<Digit, Error> {
            let [from, to] = [n, n + 1].map(|n| &items[n as usize % 2]);
            Ok(Digit {
                sort_count: sort_count(shaders, from, &counts)?,
                sort_scatter: sort_scatter(shaders, [from, to], &counts)?,
                shift: BITS * n,
            })
        };
        let digits = (0..cells.bits().div_ceil(BITS)).map(digit).collect::<Result<Vec<_>, _>>()?;
        let sorted = &items[digits.len() % 2];
        let constants = CellConstants {
            space_m: parameters.space_m.to_array(),
            particles,
            counts: cells.counts,
            width: positions[0].width(),
            pieces,
        };
        Ok(Sort {
            cell_keys,
            digits,
            sort_sum: sort_sum(shaders, &counts)?,
            arrange: arrange(context, positions, sorted, &places, &reached)?,
            cell_starts: cell_starts(shaders, sorted, &starts)?,
            constants,
            cell_count: cells.count(),
            items: sorted.clone(),
            places,
            starts,
            reached,
        })
    }

    /// Sorts the first `particles`, at least one, of the texture with this index.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, state: usize, particles: u32) -> Result<(), Error> {
        let constants = CellConstants { particles, ..self.constants };
        let listed = |frame: &mut Frame<'_>, pass: &Pass, count: u32| {
            frame.compute(pass, |dispatch| dispatch.constants(&constants).elements(count))
        };
        let Counts { blocks, first_sum, second_sum, third_sum } = Counts::of(particles);
        let sums = [[0, first_sum], [first_sum, second_sum], [second_sum, third_sum]]
            .map(|[first, end]| SumConstants { first, count: end - first, to: end });
        listed(frame, &self.cell_keys[state], particles)?;
        for Digit { sort_count, sort_scatter, shift } in &self.digits {
            let constants = SortConstants { items: particles, blocks, shift: *shift, first_sum, second_sum };
            frame.compute(sort_count, |dispatch| dispatch.constants(&constants).elements(blocks))?;
            for sum in &sums {
                frame.compute(&self.sort_sum, |dispatch| dispatch.constants(sum).elements(sum.count.div_ceil(RUN)))?;
            }
            frame.compute(sort_scatter, |dispatch| dispatch.constants(&constants).elements(blocks))?;
        }
        listed(frame, &self.arrange[state], particles.max(constants.pieces))?;
        listed(frame, &self.cell_starts, self.cell_count + 1)
    }
}

/// The pass on the first texture of positions, and on each other.
fn of_each(first: PassBuilder, positions: &[&Arc<ImageView>], context: Context<'_>) -> Result<Vec<Pass>, Error> {
    let first = first.build(context.shaders)?;
    let other = |view: &&Arc<ImageView>| first.rebind().with("positions", *view).build(context.shaders);
    let others = positions.iter().skip(1).map(other).collect::<Result<Vec<_>, _>>()?;
    Ok([first].into_iter().chain(others).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_levels_sum_the_counts_of_the_most_particles() {
        for items in [1, 255, 256, 257, 40_000, 1_000_000, 16_777_216] {
            let Counts { blocks, first_sum, second_sum, third_sum } = Counts::of(items);
            assert!(u64::from(blocks) * u64::from(BLOCK) >= u64::from(items));
            assert_eq!(first_sum, blocks * DIGITS);
            assert!((second_sum - first_sum) * RUN >= first_sum, "{items}");
            // The last run is one alone.
            assert!(
                third_sum - second_sum <= RUN && (third_sum - second_sum) * RUN >= second_sum - first_sum,
                "{items}"
            );
        }
    }
}
