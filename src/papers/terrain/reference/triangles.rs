//! The map as two triangles for each square of nodes, coarser than the map (the variant `mesh-lod`), against the surface.

use super::Grid;

/// A square of `step` x `step` cells from node `first` on, cut off at the map's end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    /// Column and row of the first corner.
    pub first: [usize; 2],
    /// Cells along its sides, at least 1.
    pub step: usize,
}

impl Square {
    /// Column and row of the last corner.
    pub fn end(self, grid: &Grid) -> [usize; 2] {
        [0, 1].map(|axis| (self.first[axis] + self.step).min(grid.size[axis] - 1))
    }

    fn corners_m(self, grid: &Grid) -> [f64; 4] {
        let ([a, b], [c, d]) = (self.first, self.end(grid));
        let node = |x: usize, y: usize| grid.node(x as isize, y as isize);
        [node(a, b), node(c, b), node(a, d), node(c, d)]
    }

    /// Coordinates in the square, 0 to 1, of a place in nodes.
    fn part(self, grid: &Grid, place: [f64; 2]) -> [f64; 2] {
        let end = self.end(grid);
        [0, 1].map(|axis| (place[axis] - self.first[axis] as f64) / (end[axis] - self.first[axis]) as f64)
    }

    /// The height of its bilinear surface (eq. 7) at a place in nodes.
    pub fn bilinear_m(self, grid: &Grid, place: [f64; 2]) -> f64 {
        let ([u, v], [a, b, c, d]) = (self.part(grid, place), self.corners_m(grid));
        (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d)
    }

    /// The height of its two triangles, which share the edge from its north-east to its south-west corner.
    pub fn triangles_m(self, grid: &Grid, place: [f64; 2]) -> f64 {
        let ([u, v], [a, b, c, d]) = (self.part(grid, place), self.corners_m(grid));
        if u + v <= 1.0 { a + u * (b - a) + v * (c - a) } else { d + (1.0 - u) * (c - d) + (1.0 - v) * (b - d) }
    }

    /// The bound that the patches' errors are made of: the most by which the nodes halfway leave the bilinear surface, and what
    /// of that the quarters had before.
    pub fn bilinear_error_m(self, grid: &Grid) -> f64 {
        if self.step == 1 {
            return 0.0;
        }
        let half = self.step / 2;
        let end = self.end(grid);
        let nodes = |axis: usize| [self.first[axis], (self.first[axis] + half).min(end[axis]), end[axis]];
        let places = nodes(1).into_iter().flat_map(|y| nodes(0).map(|x| [x, y]));
        let off = places
            .map(|[x, y]| (grid.node(x as isize, y as isize) - self.bilinear_m(grid, [x as f64, y as f64])).abs());
        let quarters = [[0, 0], [half, 0], [0, half], [half, half]]
            .map(|[x, y]| Square { first: [self.first[0] + x, self.first[1] + y], step: half });
        let inside = quarters.into_iter().filter(|q| q.first[0] < end[0] && q.first[1] < end[1]);
        let before = inside.map(|quarter| quarter.bilinear_error_m(grid)).fold(0.0, f64::max);
        off.fold(0.0, f64::max) + before
    }

    /// A quarter of the twist: what the two triangles and the bilinear surface differ by at most.
    pub fn twist_error_m(self, grid: &Grid) -> f64 {
        let [a, b, c, d] = self.corners_m(grid);
        0.25 * (a - b - c + d).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::random_grid;
    use super::*;

    #[test]
    fn triangles_stay_within_the_bound_of_the_map() {
        for (size, seed) in [([33, 33], 1), ([20, 29], 2), ([7, 40], 3)] {
            let grid = random_grid(size, seed, 50.0);
            for step in [1, 2, 4, 8] {
                let firsts = |axis: usize| (0..size[axis] - 1).step_by(step);
                for square in firsts(1).flat_map(|y| firsts(0).map(move |x| Square { first: [x, y], step })) {
                    let bound_m = square.bilinear_error_m(&grid) + square.twist_error_m(&grid);
                    let end = square.end(&grid);
                    for sample in 0..41 * 41 {
                        let part = [sample % 41, sample / 41].map(|i| i as f64 / 40.0);
                        let place = [0, 1].map(|axis| {
                            square.first[axis] as f64 + part[axis] * (end[axis] - square.first[axis]) as f64
                        });
                        let cell = [0, 1].map(|axis| (place[axis] as usize).min(size[axis] - 2));
                        let exact_m = Square { first: cell, step: 1 }.bilinear_m(&grid, place);
                        let off_m = (square.triangles_m(&grid, place) - exact_m).abs();
                        assert!(
                            off_m <= bound_m * (1.0 + 1e-12) + 1e-12,
                            "{square:?} at {place:?}: {off_m} m, {bound_m} m"
                        );
                    }
                }
            }
        }
    }
}
