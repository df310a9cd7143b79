//! The surface between the samples of a map on the processor: in single precision, as `shaders/terrain/interpolation.glsl`
//! has it, for rays; over one cell in double precision, as a Bézier patch, for what is exact about collisions.

use std::ops::{Add, Div, Sub};

use glam::{DVec2, DVec3, IVec2, Mat4, Vec2, Vec3, Vec3Swizzles, Vec4};

use super::height_field::{Cell, Field, shift_for};
use super::parameters::Interpolation;
use super::pyramid::{Bound, Texel};

/// The most by which Catmull-Rom surfaces exceed their nodes, as a fraction of the nodes' range: the negative weights' sum.
pub const OVERSHOOT: f64 = 9.0 / 32.0;

impl<T: Texel> Field<'_, T> {
    /// The height at a place in nodes, on a level.
    #[inline]
    pub fn height(&self, shift: i32, place: Vec2) -> f32 {
        let cell = self.cell(shift, place);
        match self.interpolation {
            Interpolation::Bilinear => {
                let c = self.corners(shift, cell.corner);
                let north = c.x + (c.y - c.x) * cell.uv.x;
                let south = c.z + (c.w - c.z) * cell.uv.x;
                north + (south - north) * cell.uv.y
            }
            Interpolation::Bicubic => {
                let rows = self.around(shift, cell.corner).transpose() * weights(cell.uv.x);
                rows.dot(weights(cell.uv.y))
            }
        }
    }

    /// Change of the height over a texel of the level along u and v.
    pub fn slope(&self, shift: i32, place: Vec2) -> Vec2 {
        let cell = self.cell(shift, place);
        match self.interpolation {
            Interpolation::Bilinear => {
                let c = self.corners(shift, cell.corner);
                let (north, south) = (c.y - c.x, c.w - c.z);
                let (west, east) = (c.z - c.x, c.w - c.y);
                Vec2::new(north + (south - north) * cell.uv.y, west + (east - west) * cell.uv.x)
            }
            Interpolation::Bicubic => {
                let rows = self.around(shift, cell.corner).transpose();
                Vec2::new(
                    (rows * weight_slopes(cell.uv.x)).dot(weights(cell.uv.y)),
                    (rows * weights(cell.uv.x)).dot(weight_slopes(cell.uv.y)),
                )
            }
        }
    }

    /// The slopes of the nodes around a place of a level, interpolated: the change of the height over a texel along u and v,
    /// without steps at the borders of cells.
    pub fn slope_between_nodes(&self, shift: i32, place: Vec2) -> Vec2 {
        let Cell { corner: a, uv } = self.cell(shift, place);
        let b = (a + 1).min(self.last(shift));
        let north = self.slope_at_node(shift, a).lerp(self.slope_at_node(shift, IVec2::new(b.x, a.y)), uv.x);
        let south = self.slope_at_node(shift, IVec2::new(a.x, b.y)).lerp(self.slope_at_node(shift, b), uv.x);
        north.lerp(south, uv.y)
    }

    /// Of the line through a node's neighbours, or to the only one at a border.
    fn slope_at_node(&self, shift: i32, node: IVec2) -> Vec2 {
        let (low, high) = ((node - 1).max(IVec2::ZERO), (node + 1).min(self.last(shift)));
        let at = |column: i32, row: i32| self.value(Bound::Highest, shift, IVec2::new(column, row));
        let rise = Vec2::new(at(high.x, node.y) - at(low.x, node.y), at(node.x, high.y) - at(node.x, low.y));
        rise / (high - low).max(IVec2::ONE).as_vec2()
    }

    /// A height that nothing which interpolation reads between two places exceeds; none where no map is. `shift` is that of the
    /// rectangle's extent; a coarser level answers where more than four texels of it are touched.
    #[inline]
    pub fn highest_below(&self, low: Vec2, high: Vec2, shift: i32) -> Option<f32> {
        let last_node = self.last(0);
        let end = last_node.as_vec2();
        if high.x < 0.0 || high.y < 0.0 || low.x > end.x || low.y > end.y {
            return None;
        }
        let (before, after) = match self.interpolation {
            Interpolation::Bilinear => (0, 1),
            Interpolation::Bicubic => (1, 2),
        };
        let first = (low.max(Vec2::splat(-4.0)).floor().as_ivec2() - before).clamp(IVec2::ZERO, last_node);
        let last = (high.min(end + 4.0).floor().as_ivec2() + after).clamp(IVec2::ZERO, last_node);
        let most = ((last >> shift) - (first >> shift)).max_element().max(1) as u32;
        let level = (shift + (2 * most - 1).ilog2() as i32).min(self.shape().top as i32);
        Some(self.highest_of(level, first >> level, last >> level))
    }

    /// The ray parameter, 0 to 1 from `near` to `far` in nodes, at which a line as short as a texel of a level first meets the
    /// interpolated surface of that level. It crosses at most three cells. `tolerance` is how near a height counts as met where
    /// the root is approached, on the data.
    #[inline]
    pub fn intersect(&self, shift: i32, near: Vec3, far: Vec3, tolerance: f32) -> Option<f32> {
        // A coarser level's texel stands in the middle of the nodes that it covers.
        let size = (-shift as f32).exp2();
        let texel = |place: Vec3| (place.xy() * size + (0.5 * size - 0.5)).extend(place.z);
        let near = texel(near);
        let whole = texel(far) - near;
        let u = crossing(near.x, near.x + whole.x);
        let v = crossing(near.y, near.y + whole.y);
        let ends = [0.0, u.min(v), u.max(v), 1.0];
        let last_cell = (self.last(shift) - 1).max(IVec2::ZERO);
        ends.windows(2).find_map(|ends| {
            let length = ends[1] - ends[0];
            if length <= 0.0 {
                return None;
            }
            let (from, moved) = (near + ends[0] * whole, length * whole);
            let cell = (from + 0.5 * moved).xy().floor().as_ivec2().clamp(IVec2::ZERO, last_cell);
            // Beyond the outermost texels' middles the surface stays as it is there.
            let inside = |place: Vec3| (place.xy() - cell.as_vec2()).clamp(Vec2::ZERO, Vec2::ONE);
            let first = inside(from);
            let (from, direction) = (first.extend(from.z), (inside(from + moved) - first).extend(moved.z));
            self.touch(shift, cell, from, direction, tolerance / size).map(|t| ends[0] + t * length)
        })
    }

    /// The fraction of a line inside a cell of a level, `from` counted from its corner, at which it first meets the surface.
    #[inline]
    pub fn touch(&self, shift: i32, cell: IVec2, from: Vec3, direction: Vec3, tolerance: f32) -> Option<f32> {
        match self.interpolation {
            Interpolation::Bilinear => touch_bilinear(self.corners(shift, cell), from, direction),
            Interpolation::Bicubic => touch_bicubic(self.around(shift, cell), from, direction, tolerance),
        }
    }

    /// A height above the surface over a block of cells, where levels are [`Cover::Cells`].
    ///
    /// [`Cover::Cells`]: super::pyramid::Cover::Cells
    #[inline]
    pub fn highest_over(&self, level: i32, block: IVec2) -> f32 {
        let highest = self.value(Bound::Highest, level, block);
        match self.interpolation {
            Interpolation::Bilinear => highest,
            Interpolation::Bicubic => highest + OVERSHOOT as f32 * (highest - self.value(Bound::Lowest, level, block)),
        }
    }

    /// A height above the surface between two places, by texels that bound whole cells; none where no map is.
    #[inline]
    pub fn highest_between(&self, low: Vec2, high: Vec2, shift: i32) -> Option<f32> {
        let end = self.last(0).as_vec2();
        if high.x < 0.0 || high.y < 0.0 || low.x > end.x || low.y > end.y {
            return None;
        }
        let last_cell = (self.last(0) - 1).max(IVec2::ZERO);
        let cell = |place: Vec2| place.clamp(Vec2::ZERO, end).floor().as_ivec2().min(last_cell);
        let (first, last) = (cell(low), cell(high));
        let least = shift.max(1);
        let touched = ((last >> least) - (first >> least)).max_element();
        let top = self.shape().top;
        let level = (least + shift_for(touched as f32, top)).min(top as i32).max(1);
        Some(self.highest_of(level, first >> level, last >> level))
    }

    /// A height that no interpolated one exceeds where nothing but these four texels of a level and those between is read.
    #[inline]
    fn highest_of(&self, level: i32, a: IVec2, b: IVec2) -> f32 {
        let four = [a, IVec2::new(b.x, a.y), IVec2::new(a.x, b.y), b];
        let highest = four.map(|texel| self.value(Bound::Highest, level, texel)).into_iter().fold(f32::MIN, f32::max);
        match self.interpolation {
            Interpolation::Bilinear => highest,
            Interpolation::Bicubic => {
                let lowest =
                    four.map(|texel| self.value(Bound::Lowest, level, texel)).into_iter().fold(f32::MAX, f32::min);
                highest + OVERSHOOT as f32 * (highest - lowest)
            }
        }
    }

    /// Four corner values: north-west, north-east, south-west, south-east.
    #[inline]
    fn corners(&self, shift: i32, a: IVec2) -> Vec4 {
        let b = (a + 1).min(self.last(shift));
        let four = [a, IVec2::new(b.x, a.y), IVec2::new(a.x, b.y), b];
        Vec4::from_array(four.map(|texel| self.value(Bound::Highest, shift, texel)))
    }

    /// The sixteen values around a cell: rows from north to south, borders repeated.
    fn rows_around(&self, shift: i32, cell: IVec2) -> [[f32; 4]; 4] {
        let last = self.last(shift);
        let value = |column: i32, row: i32| {
            let texel = (cell + IVec2::new(column, row)).clamp(IVec2::ZERO, last);
            self.value(Bound::Highest, shift, texel)
        };
        [-1, 0, 1, 2].map(|row| [-1, 0, 1, 2].map(|column| value(column, row)))
    }

    fn around(&self, shift: i32, cell: IVec2) -> Mat4 {
        Mat4::from_cols_array_2d(&self.rows_around(shift, cell))
    }
}

/// The fraction of the change from one number to another at which it crosses a whole one; 1 where it crosses none.
#[inline]
fn crossing(from: f32, to: f32) -> f32 {
    if from.floor() == to.floor() {
        return 1.0;
    }
    ((from.floor().max(to.floor()) - from) / (to - from)).clamp(0.0, 1.0)
}

/// The ray parameter, 0 to 1, at which a line from `from` along `direction` inside a cell first touches the cell's surface.
/// Along a line the surface (eq. 7) is a quadratic.
#[inline]
fn touch_bilinear(corners: Vec4, from: Vec3, direction: Vec3) -> Option<f32> {
    let a = corners.x;
    let (b, c) = (corners.y - a, corners.z - a);
    let e = corners.w - corners.y - c;
    let qa = -e * direction.x * direction.y;
    let qb = direction.z - b * direction.x - c * direction.y - e * (from.x * direction.y + from.y * direction.x);
    let qc = from.z - (a + b * from.x + c * from.y + e * from.x * from.y);
    if qc <= 0.0 {
        return Some(0.0);
    }
    // The smaller positive root of a function that begins above zero, without cancellation.
    let discriminant = qb * qb - 4.0 * qa * qc;
    let root = discriminant.max(0.0).sqrt();
    let (numerator, denominator) = if qb < 0.0 { (2.0 * qc, root - qb) } else { (qb + root, -2.0 * qa) };
    if discriminant >= 0.0 && denominator > 0.0 && numerator <= denominator {
        return Some(numerator / denominator);
    }
    (qa + qb + qc <= 0.0).then_some(1.0)
}

/// Of Catmull-Rom.
fn weights(t: f32) -> Vec4 {
    0.5 * Vec4::new(
        t * (-1.0 + t * (2.0 - t)),
        2.0 + t * t * (3.0 * t - 5.0),
        t * (1.0 + t * (4.0 - 3.0 * t)),
        t * t * (t - 1.0),
    )
}

fn weight_slopes(t: f32) -> Vec4 {
    0.5 * Vec4::new(-1.0 + t * (4.0 - 3.0 * t), t * (9.0 * t - 10.0), 1.0 + t * (8.0 - 9.0 * t), t * (3.0 * t - 2.0))
}

/// Four curves at once from `s` to `e`, given and left as Bézier points.
fn restricted(p: Mat4, s: f32, e: f32) -> Mat4 {
    let mix = |a: Vec4, b: Vec4, t: f32| a + (b - a) * t;
    let [p0, p1, p2, p3] = [p.x_axis, p.y_axis, p.z_axis, p.w_axis];
    let (s0, s1, s2) = (mix(p0, p1, s), mix(p1, p2, s), mix(p2, p3, s));
    let (e0, e1, e2) = (mix(p0, p1, e), mix(p1, p2, e), mix(p2, p3, e));
    let (ss0, ss1) = (mix(s0, s1, s), mix(s1, s2, s));
    Mat4::from_cols(
        mix(ss0, ss1, s),
        mix(ss0, ss1, e),
        mix(mix(s0, s1, e), mix(s1, s2, e), e),
        mix(mix(e0, e1, e), mix(e1, e2, e), e),
    )
}

/// The Bézier points of the Catmull-Rom curve between the second value and the third.
fn bezier<V, S: From<u8>>([before, from, to, after]: [V; 4]) -> [V; 4]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Div<S, Output = V>,
{
    [from, from + (to - before) / S::from(6), to - (after - from) / S::from(6), to]
}

/// The same of four curves at once.
fn bezier_columns(p: Mat4) -> Mat4 {
    let [a, b, c, d] = bezier::<Vec4, f32>([p.x_axis, p.y_axis, p.z_axis, p.w_axis]);
    Mat4::from_cols(a, b, c, d)
}

/// As [`touch_bilinear`]. Along a line the surface is of the sixth degree. Its Bézier points bound it, so the line is free up
/// to where their hull meets it; what is left is restricted and bounded anew. This approaches the first root from the near
/// side and misses none. The hull's lower edge may start at any point above, not only at the first.
fn touch_bicubic(mut values: Mat4, from: Vec3, direction: Vec3, tolerance: f32) -> Option<f32> {
    let reference = values.y_axis.y;
    for row in 0..4 {
        *values.col_mut(row) -= Vec4::splat(reference);
    }
    let points = restricted(bezier_columns(values), from.y, from.y + direction.y).transpose();
    let c = restricted(bezier_columns(points), from.x, from.x + direction.x).to_cols_array_2d();
    let (above, rise) = (from.z - reference, direction.z / 6.0);
    let mut g = [
        above - c[0][0],
        above + rise - 0.5 * (c[0][1] + c[1][0]),
        above + 2.0 * rise - (c[0][2] + 3.0 * c[1][1] + c[2][0]) / 5.0,
        above + 3.0 * rise - (c[0][3] + 9.0 * (c[1][2] + c[2][1]) + c[3][0]) / 20.0,
        above + 4.0 * rise - (c[1][3] + 3.0 * c[2][2] + c[3][1]) / 5.0,
        above + 5.0 * rise - 0.5 * (c[2][3] + c[3][2]),
        above + 6.0 * rise - c[3][3],
    ];
    if g[0] <= 0.0 {
        return Some(0.0);
    }
    let mut start = 0.0;
    for _ in 0..40 {
        let edges = (1..7).flat_map(|k| (0..k).map(move |i| (i, k))).filter(|&(i, k)| g[i] > 0.0 && g[k] <= 0.0);
        let meets = edges.map(|(i, k)| (i as f32 + (k - i) as f32 * g[i] / (g[i] - g[k])) / 6.0);
        let free = meets.reduce(f32::min)?;
        for j in 1..7 {
            for k in 0..7 - j {
                g[k] += (g[k + 1] - g[k]) * free;
            }
        }
        start += free * (1.0 - start);
        if g[0] <= tolerance {
            break;
        }
    }
    Some(start)
}

/// Sixteen points in metres above the base, of which the surface is a weighted mean: `[row][column]`, from the cell's
/// north-west corner. A bilinear cell (eq. 7) is one whose points lie on its lines.
#[derive(Debug, Clone)]
pub struct Patch {
    points: [[f64; 4]; 4],
}

/// The surface at a place of the cell: the height, and its derivatives along u and v, metres for a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Above the base.
    pub height_m: f64,
    /// Along u and v.
    pub slope: DVec2,
}

impl Patch {
    /// Of the cell whose north-west corner is `cell`; `above_base_m` turns the map's own numbers into metres.
    pub fn new<T: Texel>(field: &Field<'_, T>, cell: IVec2, above_base_m: impl Fn(f64) -> f64) -> Self {
        let along = |values: [f64; 4]| match field.interpolation {
            Interpolation::Bilinear => line(values[1], values[2]),
            Interpolation::Bicubic => bezier::<f64, f64>(values),
        };
        let metres = |row: [f32; 4]| row.map(|number| above_base_m(number.into()));
        let rows = field.rows_around(0, cell).map(|row| along(metres(row)));
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

fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

fn bernstein_slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}
