//! Planes of a box and the cells of heights that they accept (section 4.2.1).

use crate::host_block;

/// A plane and the heights along V from the box's centre that it accepts, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Height of the plane.
    pub plane: f32,
    /// Lowest height accepted.
    pub lower: f32,
    /// First height no longer accepted.
    pub upper: f32,
}

impl Cell {
    /// Height of the plane from the rays' reference point, the box's centre being at `middle_m`: in single precision, as
    /// `smart-planes.comp` adds them up.
    pub fn height(&self, middle_m: f64) -> f32 {
        middle_m as f32 + self.plane
    }
}

/// Slices a box of `height` into `count` equal cells with a plane at the centre of each, the nearest to the light
/// first; epsilon of eq. 4-15 is half a cell. Neighbours share one boundary value, so that every height is accepted by
/// exactly one cell; the uppermost is closed.
pub fn slice(height: f64, count: u32, cells: &mut Vec<Cell>) {
    let at = |i: f64| (height / 2.0 - height * (i / f64::from(count))) as f32;
    cells.clear();
    cells.extend((0..count).map(|i| Cell {
        plane: at(f64::from(i) + 0.5),
        lower: at(f64::from(i + 1)),
        upper: if i == 0 { at(0.0).next_up() } else { at(f64::from(i)) },
    }));
}

/// Smart slicing (section 4.7.2): how planes are placed once the depth profile is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SmartPlacement {
    /// Sub-boxes of valid levels, each sliced anew by the acceptance threshold (eq. 4-21 and 4-22).
    Fitted {
        /// Acceptance threshold in metres; without one it is h / (2 (N - 1)) for N planes, as in table 5-4.
        epsilon_m: Option<f32>,
    },
    /// The uniform planes whose cell holds a texel: the caustics map is the level map's, bit for bit.
    Kept,
}

host_block! {
    /// Planes of a sub-box of so many levels, and the height of its cells as a sum of two numbers of [`BITS`] bits: their products
    /// with the number of a plane are exact, so that device and host place planes bit for bit alike, however a compiler
    /// contracts.
    pub struct Fit {
        planes: u32,
        coarse: f32,
        fine: f32,
    }
}

/// The most planes of a box, and so the least acceptance threshold: single precision tells its cells apart.
const MOST: f64 = 4096.0;
/// Bits of a part of a cell's height. Twice a plane's place in its sub-box, which counts halves, has the others of 24.
const BITS: u32 = 11;

/// The number of [`BITS`] bits that is nearest.
fn rounded(x: f64) -> f32 {
    let dropped = f32::MANTISSA_DIGITS - BITS;
    f32::from_bits(((x as f32).to_bits() + (1 << (dropped - 1))) >> dropped << dropped)
}

/// Acceptance threshold in a box of `height`: the one given, or that of `planes`.
pub fn threshold(height: f64, planes: u32, epsilon_m: Option<f32>) -> f64 {
    let of_planes = |planes: f64| height / (2.0 * planes);
    epsilon_m.map_or_else(|| of_planes(f64::from(planes.saturating_sub(1))), f64::from).max(of_planes(MOST))
}

impl Fit {
    /// A sub-box of `run` of the `levels` of a box of `height`, with as many planes as the acceptance threshold asks for (eq. 4-21
    /// and 4-22).
    pub fn new(height: f64, levels: u32, run: u32, epsilon: f64) -> Self {
        // Eq. 4-21: h_i = h hr_i. Eq. 4-22 prints the ratio for the height; table 5-4 fits planes, at least one. The last factor
        // absorbs the rounding of a quotient that should be whole.
        let height_i = height * f64::from(run) / f64::from(levels);
        let planes = (height_i / (2.0 * epsilon) * (1.0 - 1e-9)).ceil().max(1.0);
        let coarse = rounded(height_i / planes);
        Fit { planes: planes as u32, coarse, fine: rounded(height_i / planes - f64::from(coarse)) }
    }

    /// Of one level, of two, and so on to all.
    pub fn of_each(height: f64, levels: u32, epsilon: f64) -> Vec<Self> {
        (1..=levels).map(|run| Fit::new(height, levels, run, epsilon)).collect()
    }
}

/// The most planes that sub-boxes can have together, whichever levels are valid: a level between two is not.
pub fn most_fitted(fits: &[Fit]) -> u32 {
    let slots = fits.len() as f64 + 1.0;
    let shares = fits.iter().zip(2_u32..).map(|(fit, slots)| f64::from(fit.planes) / f64::from(slots));
    (slots * shares.fold(0.0, f64::max) * (1.0 + 1e-12)).floor() as u32
}

/// Adds the planes of a sub-box of a box of `height` (section 4.7.2): neighbouring levels, with the box's top where `on_top`. Every
/// number is `smart-planes.comp`'s.
pub fn fit_into(sub_box: &[Cell], height: f64, on_top: bool, fit: Fit, cells: &mut Vec<Cell>) {
    let ([first, ..], [.., last]) = (sub_box, sub_box) else { return };
    let Fit { planes, coarse, fine } = fit;
    // The box's own top belongs to the level under it, whose bound is the number after.
    let top = if on_top { (height / 2.0) as f32 } else { first.upper };
    let at = |place: f32| (top - place * coarse) - place * fine;
    // The ends are given, not computed, so that they are the levels' bit for bit.
    cells.extend((0..planes).map(|i| Cell {
        plane: at(i as f32 + 0.5),
        lower: if i + 1 == planes { last.lower } else { at((i + 1) as f32) },
        upper: if i == 0 { first.upper } else { at(i as f32) },
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every choice of valid levels, of few levels.
    #[test]
    fn no_runs_have_more_planes_than_there_is_room_for() {
        for (levels, planes) in [(1, 1), (8, 3), (9, 11), (12, 101), (12, 5)] {
            let fits = Fit::of_each(1.7, levels, threshold(1.7, planes, None));
            let of_mask = |mask: u32| {
                let mut run = 0;
                let mut total = 0;
                for level in 0..=levels {
                    if level < levels && mask >> level & 1 == 1 {
                        run += 1;
                    } else if run > 0 {
                        total += fits[run - 1].planes;
                        run = 0;
                    }
                }
                total
            };
            let found = (0..1_u32 << levels).map(of_mask).max().unwrap();
            let most = most_fitted(&fits);
            assert!(found <= most && most <= found + 1, "{levels} levels, {planes} planes: {found}, room for {most}");
        }
    }

    /// Products of a plane's place, which counts halves, with either part of a cell's height lose nothing.
    #[test]
    fn heights_of_cells_have_few_enough_bits() {
        for (height, levels, planes) in [(1.7, 1, 4096), (0.3, 100, 101), (3.0, 65_536, 4096)] {
            let fits = Fit::of_each(height, levels, threshold(height, planes, None));
            for fit in fits.iter().step_by(37) {
                let cell_m = f64::from(fit.coarse) + f64::from(fit.fine);
                for half_places in [1, 3, 2 * fit.planes - 1] {
                    let place = half_places as f32 / 2.0;
                    for part in [fit.coarse, fit.fine] {
                        assert_eq!(f64::from(place * part), f64::from(place) * f64::from(part), "{fit:?}");
                    }
                }
                assert!(cell_m > 0.99 * height / 65_536.0, "{fit:?}");
            }
            let whole = fits[levels as usize - 1];
            let sum = f64::from(whole.planes) * (f64::from(whole.coarse) + f64::from(whole.fine));
            assert!((sum / height - 1.0).abs() < 2e-7, "{sum} {height}");
        }
    }

    fn count_accepting(cells: &[Cell], y: f32) -> usize {
        cells.iter().filter(|cell| cell.lower <= y && y < cell.upper).count()
    }

    #[test]
    fn every_height_of_the_box_is_accepted_by_exactly_one_plane() {
        let mut cells = Vec::new();
        for count in [1, 2, 3, 9, 31, 101, 4096] {
            slice(1.7, count, &mut cells);
            assert_eq!(cells.len(), count as usize);
            let ends = [0.85f32, -0.85];
            let boundaries = cells.iter().flat_map(|c| [c.lower, c.lower.next_up(), c.lower.next_down(), c.plane]);
            for y in boundaries.chain(ends).filter(|y| (-0.85..=0.85).contains(y)) {
                assert_eq!(count_accepting(&cells, y), 1, "{count} planes at {y}");
            }
        }
    }
}
