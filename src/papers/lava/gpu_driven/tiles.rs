//! A dispatch as several, each of no more work than a submission is to have.

/// Sides of the smallest tile: a workgroup.
const LEAST: [u32; 3] = [8, 8, 1];

/// Invocations from `first` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// First invocation along x, y and z.
    pub first: [u32; 3],
    /// Invocations along x, y and z, at least 1 each.
    pub count: [u32; 3],
}

impl Tile {
    /// Work of the tile, where each of its invocations does so much.
    pub fn work(&self, each: f64) -> f64 {
        self.count.iter().fold(each, |work, &side| work * f64::from(side))
    }
}

/// The invocations of `grid`, `each` of so much work, in tiles of at most `most` of it, or of one workgroup. All but the
/// last along an axis are whole workgroups.
pub fn tiles(grid: [u32; 3], each: f64, most: f64) -> impl Iterator<Item = Tile> {
    let mut sides = grid;
    // Whole planes first, then rows.
    for axis in [2, 1, 0] {
        while (Tile { first: [0; 3], count: sides }).work(each) > most && sides[axis] > LEAST[axis] {
            sides[axis] = sides[axis].div_ceil(2).next_multiple_of(LEAST[axis]);
        }
    }
    let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| {
        let (end, side) = (grid[axis], sides[axis]);
        (0..end).step_by(side as usize).map(move |first| (first, side.min(end - first)))
    });
    along_z.flat_map(move |z| {
        let along_x = along_x.clone();
        along_y
            .clone()
            .flat_map(move |y| along_x.clone().map(move |x| Tile { first: [x.0, y.0, z.0], count: [x.1, y.1, z.1] }))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_hold_every_invocation_once_and_no_more_work_than_they_may() {
        let cases =
            [([100, 24, 6], 1.0, 1e6), ([100, 25, 6], 10.0, 9e3), ([1, 1, 1], 5.0, 1.0), ([37, 9, 3], 1.0, 1.0)];
        for (grid, each, most) in cases {
            let mut seen = vec![0; grid.iter().map(|&n| n as usize).product()];
            for tile in tiles(grid, each, most) {
                let Tile { first, count } = tile;
                let is_least = (0..3).all(|axis| count[axis] <= LEAST[axis]);
                assert!(is_least || tile.work(each) <= most, "{tile:?}");
                for axis in 0..2 {
                    let end = first[axis] + count[axis];
                    assert!(end == grid[axis] || count[axis].is_multiple_of(LEAST[axis]), "{tile:?}");
                }
                for z in first[2]..first[2] + count[2] {
                    for y in first[1]..first[1] + count[1] {
                        for x in first[0]..first[0] + count[0] {
                            seen[((z * grid[1] + y) * grid[0] + x) as usize] += 1;
                        }
                    }
                }
            }
            assert!(seen.iter().all(|&times| times == 1), "{grid:?}");
        }
        assert_eq!(tiles([100, 24, 6], 1.0, 1e6).count(), 1);
        assert_eq!(tiles([4096, 1024, 1], 60_000.0, 4e8).count(), 1024);
    }
}
