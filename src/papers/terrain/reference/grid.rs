//! The altitude map: a grid of nodes and the surface through them (eq. 7).

use crate::papers::terrain::reference::interval::Interval;

/// The function h(u, v) between the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Eq. 7.
    Bilinear,
    /// Catmull-Rom splines in u and v ("bicubic", section 3); the nodes beyond the border repeat the border's.
    Bicubic,
}

/// Node heights over a rectangle of the base surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Nodes along u and v, at least 2 each.
    pub size: [usize; 2],
    /// Heights in metres, row by row: a row runs along u.
    pub heights_m: Vec<f64>,
    /// (u, v) of the first node, in the base's units.
    pub origin: [f64; 2],
    /// From node to node along u and v, in the base's units; above 0.
    pub spacing: [f64; 2],
    /// The map goes once round: the first column follows the last one along u.
    pub closes: bool,
    /// Lowest and highest height of all nodes, metres.
    pub(super) range_m: [f64; 2],
}

/// The interpolated surface at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// In metres.
    pub height_m: f64,
    /// Metres for each unit of u and of v.
    pub gradient: [f64; 2],
}

impl Grid {
    /// A grid of finite heights; `None` when the numbers do not make one.
    pub fn new(size: [usize; 2], heights_m: Vec<f64>, origin: [f64; 2], spacing: [f64; 2]) -> Option<Grid> {
        let fits = size[0] >= 2 && size[1] >= 2 && size[0].checked_mul(size[1]) == Some(heights_m.len());
        let numbers = fits
            && heights_m.iter().chain(&origin).all(|x| x.is_finite())
            && spacing.iter().all(|s| s.is_finite() && *s > 0.0);
        if !numbers {
            return None;
        }
        let low = heights_m.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Some(Grid { size, heights_m, origin, spacing, closes: false, range_m: [low, high] })
    }

    /// The same grid once round: its columns fill a whole turn.
    pub fn closed(self) -> Grid {
        Grid { closes: true, ..self }
    }

    /// Cells along u and v.
    pub fn cells(&self) -> [usize; 2] {
        [self.size[0] - usize::from(!self.closes), self.size[1] - 1]
    }

    /// The height of node (i, j); beyond the border the border's.
    pub fn node(&self, i: isize, j: isize) -> f64 {
        let columns = self.size[0] as isize;
        let column = if self.closes { i.rem_euclid(columns) } else { i.clamp(0, columns - 1) } as usize;
        let row = j.clamp(0, self.size[1] as isize - 1) as usize;
        self.heights_m[row * self.size[0] + column]
    }

    /// (u, v) of the end of the last cell.
    pub fn end(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.origin[axis] + self.spacing[axis] * self.cells()[axis] as f64)
    }

    /// The lowest and the highest node.
    pub fn range_m(&self) -> [f64; 2] {
        self.range_m
    }

    /// Above every interpolated height: Catmull-Rom exceeds the nodes by at most 9/32 of their range.
    pub fn ceiling_m(&self, interpolation: Interpolation) -> f64 {
        let [low, high] = self.range_m();
        match interpolation {
            Interpolation::Bilinear => high,
            Interpolation::Bicubic => high + (high - low) * 9.0 / 32.0,
        }
    }

    /// True of a place (u, v) in the map's rectangle, borders included.
    pub fn contains(&self, uv: [f64; 2]) -> bool {
        let end = self.end();
        (0..2).all(|axis| axis == 0 && self.closes || self.origin[axis] <= uv[axis] && uv[axis] <= end[axis])
    }

    /// The cell that holds (u, v), clamped into the grid.
    pub(super) fn cell(&self, uv: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis| {
            let at = ((uv[axis] - self.origin[axis]) / self.spacing[axis]).floor();
            (at.max(0.0) as usize).min(self.cells()[axis] - 1)
        })
    }

    /// The surface at (u, v), which is clamped into the map's rectangle.
    pub fn interpolate(&self, interpolation: Interpolation, uv: [f64; 2]) -> Sample {
        let cell = self.cell(uv);
        let at = [0, 1].map(|axis| {
            let place = (uv[axis] - self.origin[axis]) / self.spacing[axis] - cell[axis] as f64;
            place.clamp(0.0, 1.0)
        });
        let (height_m, local) = match interpolation {
            Interpolation::Bilinear => self.bilinear(cell, at),
            Interpolation::Bicubic => self.bicubic(cell, at),
        };
        Sample { height_m, gradient: [local[0] / self.spacing[0], local[1] / self.spacing[1]] }
    }

    /// Gradients of the nodes, interpolated by eq. 7: a node's is the difference of its neighbours over their distance.
    pub fn gradient_between_nodes(&self, uv: [f64; 2]) -> [f64; 2] {
        let cell = self.cell(uv);
        let at = |axis: usize| {
            let place = (uv[axis] - self.origin[axis]) / self.spacing[axis] - cell[axis] as f64;
            place.clamp(0.0, 1.0)
        };
        [0, 1].map(|axis| {
            let of_node = |i: usize, j: usize| {
                let node = [cell[0] + i, cell[1] + j];
                let (mut before, mut after) = (node.map(|n| n as isize), node.map(|n| n as isize));
                let is_endless = axis == 0 && self.closes;
                before[axis] -= isize::from(is_endless || node[axis] > 0);
                after[axis] += isize::from(is_endless || node[axis] + 1 < self.size[axis]);
                let rise = self.node(after[0], after[1]) - self.node(before[0], before[1]);
                rise / (self.spacing[axis] * (after[axis] - before[axis]) as f64)
            };
            let along = |j: usize| (1.0 - at(0)) * of_node(0, j) + at(0) * of_node(1, j);
            (1.0 - at(1)) * along(0) + at(1) * along(1)
        })
    }

    /// Eq. 7 as printed, and its derivatives in cells.
    fn bilinear(&self, cell: [usize; 2], [u, v]: [f64; 2]) -> (f64, [f64; 2]) {
        let [mu, mv] = cell.map(|c| c as isize);
        let table = |i, j| self.node(mu + i, mv + j);
        let f0 = (1.0 - u) * table(0, 0) + u * table(1, 0);
        let f1 = (1.0 - u) * table(0, 1) + u * table(1, 1);
        let along_u = (1.0 - v) * (table(1, 0) - table(0, 0)) + v * (table(1, 1) - table(0, 1));
        (f0 + (f1 - f0) * v, [along_u, f1 - f0])
    }

    /// Four splines along u, one through their values along v.
    fn bicubic(&self, cell: [usize; 2], [u, v]: [f64; 2]) -> (f64, [f64; 2]) {
        let [mu, mv] = cell.map(|c| c as isize);
        let row = |j: isize| catmull_rom([-1, 0, 1, 2].map(|i| self.node(mu + i, mv + j)), u);
        let rows = [-1, 0, 1, 2].map(row);
        let (height, along_v) = catmull_rom(rows.map(|r| r.0), v);
        let (along_u, _) = catmull_rom(rows.map(|r| r.1), v);
        (height, [along_u, along_v])
    }
}

/// The spline between p1 (t = 0) and p2 (t = 1), its tangents half the difference of the neighbours, and its derivative.
fn catmull_rom([p0, p1, p2, p3]: [f64; 4], t: f64) -> (f64, f64) {
    let [m1, m2] = [(p2 - p0) / 2.0, (p3 - p1) / 2.0];
    let bend = 3.0 * (p2 - p1) - 2.0 * m1 - m2;
    let twist = 2.0 * (p1 - p2) + m1 + m2;
    (p1 + t * (m1 + t * (bend + t * twist)), m1 + t * (2.0 * bend + t * 3.0 * twist))
}

/// The surface over one cell as a polynomial in the cell's own coordinates, 0..1 along u and v.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// 1 or 3, along each axis.
    pub(super) degree: usize,
    /// The factor of u^a v^b at `[a][b]`.
    pub(super) factors: [[f64; 4]; 4],
}

/// Rows are powers, columns the nodes -1, 0, 1, 2.
const LINEAR: [[f64; 4]; 4] = [[0.0, 1.0, 0.0, 0.0], [0.0, -1.0, 1.0, 0.0], [0.0; 4], [0.0; 4]];
const CUBIC: [[f64; 4]; 4] =
    [[0.0, 1.0, 0.0, 0.0], [-0.5, 0.0, 0.5, 0.0], [1.0, -2.5, 2.0, -0.5], [-0.5, 1.5, -1.5, 0.5]];

impl Patch {
    /// Of a grid's `cell`, less `level_m`.
    pub(super) fn new(grid: &Grid, interpolation: Interpolation, cell: [usize; 2], level_m: f64) -> Self {
        let (degree, basis) = match interpolation {
            Interpolation::Bilinear => (1, LINEAR),
            Interpolation::Bicubic => (3, CUBIC),
        };
        let node = |p: usize, q: usize| {
            grid.node(cell[0] as isize + p as isize - 1, cell[1] as isize + q as isize - 1) - level_m
        };
        let mut factors = [[0.0; 4]; 4];
        for a in 0..=degree {
            for b in 0..=degree {
                let along = |p: usize| (0..4).map(|q| basis[b][q] * node(p, q)).sum::<f64>();
                factors[a][b] = (0..4).map(|p| basis[a][p] * along(p)).sum();
            }
        }
        Patch { degree, factors }
    }

    pub(super) fn height(&self, u: f64, v: f64) -> f64 {
        let power = |row: &[f64; 4]| row.iter().rev().fold(0.0, |sum, &c| sum * v + c);
        self.factors.iter().rev().fold(0.0, |sum, row| sum * u + power(row))
    }

    /// Bounds of the derivative along u and along v over a part of the cell.
    pub(super) fn slopes(&self, u: Interval, v: Interval) -> [Interval; 2] {
        let zero = Interval::point(0.0);
        let value = |c: f64| Interval::point(c);
        let mut along_u = zero;
        let mut along_v = zero;
        for a in (0..=self.degree).rev() {
            let row = &self.factors[a];
            let in_v = (0..=self.degree).rev().fold(zero, |sum, b| sum * v + value(row[b]));
            let slope_v = (1..=self.degree).rev().fold(zero, |sum, b| sum * v + value(row[b] * b as f64));
            if a > 0 {
                along_u = along_u * u + in_v * a as f64;
            }
            along_v = along_v * u + slope_v;
        }
        [along_u, along_v]
    }

    /// The lowest and highest of the patch's Bernstein factors, which enclose the surface.
    pub(super) fn bounds(&self) -> Interval {
        let in_v = self.factors.map(bernstein);
        let transposed = [0, 1, 2, 3].map(|b| in_v.map(|row| row[b]));
        let mut bounds = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for value in transposed.into_iter().flat_map(bernstein) {
            bounds = Interval { low: bounds.low.min(value), high: bounds.high.max(value) };
        }
        bounds
    }
}

/// From powers to Bernstein factors of degree 3.
fn bernstein([c0, c1, c2, c3]: [f64; 4]) -> [f64; 4] {
    [c0, c0 + c1 / 3.0, c0 + c1 * 2.0 / 3.0 + c2 / 3.0, c0 + c1 + c2 + c3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::reference::fixtures::{Dice, random_grid};

    const BOTH: [Interpolation; 2] = [Interpolation::Bilinear, Interpolation::Bicubic];

    #[test]
    fn numbers_that_make_no_grid_are_refused() {
        let grid = |size, heights: &[f64], spacing| Grid::new(size, heights.to_vec(), [0.0; 2], spacing);
        assert!(grid([2, 2], &[0.0; 4], [1.0; 2]).is_some());
        assert!(grid([1, 4], &[0.0; 4], [1.0; 2]).is_none());
        assert!(grid([2, 3], &[0.0; 4], [1.0; 2]).is_none());
        assert!(grid([2, 2], &[0.0, 1.0, f64::NAN, 2.0], [1.0; 2]).is_none());
        assert!(grid([2, 2], &[0.0; 4], [1.0, 0.0]).is_none());
    }

    #[test]
    fn both_pass_through_the_nodes_and_bilinear_is_eq_7() {
        let grid = Grid { origin: [-3.0, 5.0], spacing: [0.5, 2.0], ..random_grid([6, 5], 1, 10.0) };
        for (i, j) in (0..5).flat_map(|j| (0..6).map(move |i| (i, j))) {
            let uv = [-3.0 + 0.5 * i as f64, 5.0 + 2.0 * j as f64];
            for interpolation in BOTH {
                let sample = grid.interpolate(interpolation, uv);
                assert!((sample.height_m - grid.node(i, j)).abs() < 1e-13);
            }
        }
        let small = Grid::new([2, 2], vec![1.0, 3.0, 7.0, 5.0], [0.0; 2], [2.0, 4.0]).unwrap();
        let sample = small.interpolate(Interpolation::Bilinear, [0.5, 3.0]);
        // f0 = 1.5, f1 = 6.5 and three quarters of the way.
        assert_eq!(sample.height_m, 5.25);
        assert_eq!(sample.gradient, [(0.25 * 2.0 - 0.75 * 2.0) / 2.0, 5.0 / 4.0]);
    }

    #[test]
    fn gradients_are_derivatives_and_patches_are_the_interpolation() {
        let grid = Grid { spacing: [0.5, 2.0], ..random_grid([5, 7], 2, 3.0) };
        let mut dice = Dice::new(1);
        for interpolation in BOTH {
            for _ in 0..500 {
                let uv = [dice.between(0.0, 2.0), dice.between(0.0, 12.0)];
                let cell = grid.cell(uv);
                let local = [0, 1].map(|axis| uv[axis] / grid.spacing[axis] - cell[axis] as f64);
                let sample = grid.interpolate(interpolation, uv);
                let patch = Patch::new(&grid, interpolation, cell, 1.0);
                assert!((patch.height(local[0], local[1]) + 1.0 - sample.height_m).abs() < 1e-12);
                let bounds = patch.bounds();
                assert!((bounds.low - 1e-12..=bounds.high + 1e-12).contains(&(sample.height_m - 1.0)));
                assert!(sample.height_m <= grid.ceiling_m(interpolation));
                let slopes = patch.slopes(Interval::point(local[0]), Interval::point(local[1]));
                for axis in 0..2 {
                    assert!((slopes[axis].center() / grid.spacing[axis] - sample.gradient[axis]).abs() < 1e-11);
                    if !(0.01..0.99).contains(&local[axis]) {
                        continue;
                    }
                    let mut ends = [uv, uv];
                    ends[0][axis] -= 1e-6;
                    ends[1][axis] += 1e-6;
                    let [a, b] = ends.map(|uv| grid.interpolate(interpolation, uv).height_m);
                    assert!(((b - a) / 2e-6 - sample.gradient[axis]).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn catmull_rom_reaches_its_overshoot_and_no_more() {
        // Half way along an axis the weights are -1/16, 9/16, 9/16, -1/16: 9/8 above, 1/8 below. In both axes the products
        // above 0 sum to (9/8)² + (1/8)² = 41/32: the corners of the sixteen high and their edges low.
        let rows = [0.0, 1.0, 1.0, 0.0];
        let ridge: Vec<f64> = (0..16).map(|n| rows[n % 4]).collect();
        let top: Vec<f64> = (0..16).map(|n| rows[n % 4] * rows[n / 4]).collect();
        let worst: Vec<f64> =
            (0..16).map(|n| if (rows[n % 4] > 0.0) == (rows[n / 4] > 0.0) { 1.0 } else { 0.0 }).collect();
        for (heights, expected) in [(ridge, 1.125), (top, 1.265625), (worst, 1.28125)] {
            let grid = Grid::new([4, 4], heights, [0.0; 2], [1.0; 2]).unwrap();
            let middle = grid.interpolate(Interpolation::Bicubic, [1.5, 1.5]).height_m;
            assert!((middle - expected).abs() < 1e-12, "{middle}");
            assert!(middle <= grid.ceiling_m(Interpolation::Bicubic) + 1e-12);
        }
    }
}
