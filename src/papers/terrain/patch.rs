//! The surface over one cell in double precision, as a Bézier patch: what is exact about collisions.

use glam::{DVec2, DVec3, IVec2};

use super::parameters::Interpolation;
use super::pyramid::{Bound, Texel};
use super::relief::Field;

/// Sixteen points in metres above the base, of which the surface is a weighted mean: `[row][column]`, from the cell's
/// north-west corner. A bilinear cell (eq. 7) is one whose points lie on its lines.
#[derive(Debug, Clone)]
pub struct Patch {
    points: [[f64; 4]; 4],
}

/// The surface at a place of the cell: the height, and its derivatives along u and v, metres for a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub height_m: f64,
    pub slope: DVec2,
}

impl Patch {
    /// Of the cell whose north-west corner is `cell`; `above_base_m` turns the map's own numbers into metres.
    pub fn new<T: Texel>(
        field: &Field<'_, T>,
        interpolation: Interpolation,
        cell: IVec2,
        above_base_m: impl Fn(f64) -> f64,
    ) -> Self {
        let last = field.last(0);
        let node = |column: i32, row: i32| {
            let texel = (cell + IVec2::new(column, row)).clamp(IVec2::ZERO, last);
            above_base_m(field.value(Bound::Highest, 0, texel).into())
        };
        let along = |values: [f64; 4]| match interpolation {
            Interpolation::Bilinear => line(values[1], values[2]),
            Interpolation::Bicubic => spline(values),
        };
        let rows = [-1, 0, 1, 2].map(|row| along([-1, 0, 1, 2].map(|column| node(column, row))));
        let columns = [0, 1, 2, 3].map(|column| along(rows.map(|row| row[column])));
        Patch { points: [0, 1, 2, 3].map(|row| columns.map(|column| column[row])) }
    }

    /// At a place of 0 to 1 along u and v.
    pub fn at(&self, place: DVec2) -> Sample {
        let (u, v) = (bernstein(place.x), bernstein(place.y));
        let (du, dv) = (bernstein_slopes(place.x), bernstein_slopes(place.y));
        let sum = |across: &[f64; 4], down: &[f64; 4]| -> f64 {
            self.points.iter().zip(down).map(|(row, d)| d * dot(row, across)).sum()
        };
        Sample { height_m: sum(&u, &v), slope: DVec2::new(sum(&du, &v), sum(&u, &dv)) }
    }

    /// The largest second derivatives over the cell: along u twice, along u and v, along v twice; metres.
    pub fn bends(&self) -> DVec3 {
        let p = &self.points;
        let bend =
            |line: &[f64; 4]| line.windows(3).map(|w| 6.0 * (w[0] - 2.0 * w[1] + w[2]).abs()).fold(0.0, f64::max);
        let columns = [0, 1, 2, 3].map(|column| p.map(|row| row[column]));
        let along_u = p.iter().map(bend).fold(0.0, f64::max);
        let along_v = columns.iter().map(bend).fold(0.0, f64::max);
        let mut bends = DVec3::new(along_u, 0.0, along_v);
        for i in 0..3 {
            for j in 0..3 {
                let mixed = p[i + 1][j + 1] - p[i + 1][j] - p[i][j + 1] + p[i][j];
                bends.y = bends.y.max(9.0 * mixed.abs());
            }
        }
        bends
    }
}

fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn line(from: f64, to: f64) -> [f64; 4] {
    let third = (to - from) / 3.0;
    [from, from + third, to - third, to]
}

/// Catmull-Rom between the second value and the third.
fn spline([before, from, to, after]: [f64; 4]) -> [f64; 4] {
    [from, from + (to - before) / 6.0, to - (after - from) / 6.0, to]
}

fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

fn bernstein_slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}
