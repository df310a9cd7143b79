//! The multilevel altitude map (section 3): each coarser level takes the extreme of four neighbours.

use crate::papers::terrain::reference::Grid;

/// The choice of a coarser level among four neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The paper's.
    Maximum,
    /// Its mirror image, for the overshoot of splines.
    Minimum,
}

/// One level of the pyramid.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Values along u and v.
    pub size: [usize; 2],
    /// Heights in metres, row by row.
    pub heights_m: Vec<f64>,
}

/// All levels, level 0 of one value first and the data last. A size is half the finer one's, rounded up; where a
/// neighbour is missing, those that are there count.
pub fn pyramid(grid: &Grid, extreme: Extreme) -> Vec<Level> {
    let choose: fn(f64, f64) -> f64 = match extreme {
        Extreme::Maximum => f64::max,
        Extreme::Minimum => f64::min,
    };
    let mut finest_first = vec![Level { size: grid.size, heights_m: grid.heights_m.clone() }];
    while let Some(fine) = finest_first.last()
        && fine.size != [1, 1]
    {
        let size = fine.size.map(|n| n.div_ceil(2));
        let neighbours = |i: usize, n: usize| 2 * i..(2 * i + 2).min(n);
        let value = |(x, y): (usize, usize)| {
            let rows = neighbours(y, fine.size[1]);
            let four = rows.flat_map(|row| neighbours(x, fine.size[0]).map(move |column| (row, column)));
            four.map(|(row, column)| fine.heights_m[row * fine.size[0] + column]).reduce(choose)
        };
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        let heights_m = places.filter_map(value).collect();
        finest_first.push(Level { size, heights_m });
    }
    finest_first.reverse();
    finest_first
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::reference::fixtures::random_grid;

    #[test]
    fn a_small_map_has_the_levels_counted_by_hand() {
        let grid = Grid::new([3, 2], vec![1.0, 5.0, 2.0, 4.0, -3.0, 7.0], [0.0; 2], [1.0; 2]).unwrap();
        let highest = pyramid(&grid, Extreme::Maximum);
        let heights: Vec<_> = highest.iter().map(|level| (level.size, level.heights_m.clone())).collect();
        assert_eq!(heights[0], ([1, 1], vec![7.0]));
        assert_eq!(heights[1], ([2, 1], vec![5.0, 7.0]));
        assert_eq!(heights[2], ([3, 2], grid.heights_m.clone()));
        assert_eq!(heights.len(), 3);
        let lowest = pyramid(&grid, Extreme::Minimum);
        assert_eq!((lowest[0].heights_m[0], &lowest[1].heights_m), (-3.0, &vec![-3.0, 2.0]));
    }

    #[test]
    fn every_value_is_the_extreme_of_the_nodes_below_it() {
        for size in [[2, 2], [64, 64], [37, 5], [3, 129], [100, 63]] {
            let grid = random_grid(size, 7, 100.0);
            let levels = pyramid(&grid, Extreme::Maximum);
            let count = usize::max(size[0], size[1]).next_power_of_two().ilog2() as usize + 1;
            assert_eq!(levels.len(), count);
            for (number, level) in levels.iter().enumerate() {
                let step = 1 << (count - 1 - number);
                for (index, value) in level.heights_m.iter().enumerate() {
                    let [x, y] = [index % level.size[0], index / level.size[0]];
                    let within = |at: usize, first: usize| at / step == first;
                    let below = (0..size[0] * size[1]).filter(|n| within(n % size[0], x) && within(n / size[0], y));
                    let highest = below.map(|n| grid.heights_m[n]).fold(f64::NEG_INFINITY, f64::max);
                    assert_eq!(*value, highest);
                }
            }
        }
    }
}
