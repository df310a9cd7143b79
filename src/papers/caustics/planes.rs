//! Planes of a box and the cells of heights that they accept (section 4.2.1).

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

/// Slices a box of `height` into `count` equal cells with a plane at the centre of each, the nearest to the light
/// first; epsilon of eq. 4-15 is half a cell. Neighbours share one boundary value, so that every height is accepted by
/// exactly one cell; the uppermost is closed.
pub fn slice(height: f64, count: u32, cells: &mut Vec<Cell>) {
    cells.clear();
    slice_between(height / 2.0, -height / 2.0, count, true, cells);
}

/// Adds the cells between two heights; `on_top` says that `top` is the box's own, which belongs to the cell under it.
pub fn slice_between(top: f64, bottom: f64, count: u32, on_top: bool, cells: &mut Vec<Cell>) {
    // The ends are given, not computed, so that neighbouring pieces share them bit for bit.
    let at = |fraction: f64| top + (bottom - top) * fraction;
    let boundary = |i: u32| (if i == count { bottom } else { at(f64::from(i) / f64::from(count)) }) as f32;
    cells.extend((0..count).map(|i| Cell {
        plane: at((f64::from(i) + 0.5) / f64::from(count)) as f32,
        lower: boundary(i + 1),
        upper: if i == 0 && on_top { boundary(0).next_up() } else { boundary(i) },
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

#[cfg(test)]
mod tests {
    use super::*;

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
