//! Stage two, sections 6.3 and 6.4: heights and normals of the surface.

use glam::DVec3;

use super::density::Grid;

/// Heights and normals in columns along x, row after row along z.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Sides of the simulation space, metres.
    pub space: DVec3,
    /// Texels along x.
    pub columns: usize,
    /// Texels along z.
    pub rows: usize,
    /// Metres, row by row.
    pub heights: Vec<f64>,
    /// Unit normals, row by row.
    pub normals: Vec<DVec3>,
}

/// The Gaussian of eq. 6.3 and 7.2 at r / R.
pub(super) fn gaussian(ratio: f64) -> f64 {
    // The standard deviation is a third of the radius.
    if ratio > 1.0 { 0.0 } else { (-0.5 * (3.0 * ratio).powi(2)).exp() }
}

impl Surface {
    /// Both sums of eq. 6.3 in every column: weighted heights and weights.
    pub fn sums(grid: &Grid, accepted: &[DVec3], radius: f64) -> Vec<[f64; 2]> {
        let column = |i, k| {
            let place = grid.place([i, 0, k]);
            accepted.iter().fold([0.0; 2], |[heights, weights], point| {
                let r = (point.x - place.x).hypot(point.z - place.z);
                // Points a whole number of cells away may lie on the radius but for rounding: they count.
                let ratio = r / radius;
                let ratio = if (ratio - 1.0).abs() < 1e-7 { 1.0 } else { ratio };
                let weight = gaussian(ratio);
                [heights + weight * point.y, weights + weight]
            })
        };
        (0..grid.points[2]).flat_map(|k| (0..grid.points[0]).map(move |i| (i, k))).map(|(i, k)| column(i, k)).collect()
    }

    /// Section 6.4 on the sums of eq. 6.3; the heights sink over `border`, and normals are
    /// those of the heights that have sunk, turned upwards.
    pub fn from_sums(grid: &Grid, sums: &[[f64; 2]], border: f64) -> Self {
        let [columns, _, rows] = grid.points;
        let texels = || (0..rows).flat_map(|k| (0..columns).map(move |i| (i, k)));
        let fraction = |i: usize, k: usize| {
            let place = grid.place([i, 0, k]);
            let distances = [place.x, grid.space.x - place.x, place.z, grid.space.z - place.z];
            let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
            if border > 0.0 { (nearest / border).clamp(0.0, 1.0) } else { 1.0 }
        };
        let heights: Vec<f64> = texels()
            .zip(sums)
            .map(|((i, k), [heights, weights])| if *weights > 0.0 { heights / weights * fraction(i, k) } else { 0.0 })
            .collect();
        let height = |i: usize, k: usize| heights[k * columns + i];
        let difference = |after: f64, before: f64, steps: usize, spacing: f64| {
            if steps == 0 { 0.0 } else { (after - before) / (steps as f64 * spacing) }
        };
        let normal = |(i, k): (usize, usize)| {
            let (left, right) = (i.saturating_sub(1), (i + 1).min(columns - 1));
            let (front, back) = (k.saturating_sub(1), (k + 1).min(rows - 1));
            let along_x = difference(height(right, k), height(left, k), right - left, grid.space.x / columns as f64);
            let along_z = difference(height(i, back), height(i, front), back - front, grid.space.z / rows as f64);
            let normal = DVec3::new(-along_x, 1.0, -along_z).normalize();
            DVec3::Y.lerp(normal, fraction(i, k)).normalize()
        };
        let normals = texels().map(normal).collect();
        Surface { space: grid.space, columns, rows, heights, normals }
    }

    /// Height and unit normal at a place, bilinear between the columns' middles (section 7.1).
    pub fn at(&self, x: f64, z: f64) -> (f64, DVec3) {
        let u = x / self.space.x * self.columns as f64 - 0.5;
        let v = z / self.space.z * self.rows as f64 - 0.5;
        let mut height = 0.0;
        let mut normal = DVec3::ZERO;
        for (di, dk) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let weight = |at: f64, d: i32| if d == 1 { at - at.floor() } else { 1.0 - (at - at.floor()) };
            let index =
                |at: f64, d: i32, count: usize| (at.floor() + f64::from(d)).clamp(0.0, count as f64 - 1.0) as usize;
            let texel = index(v, dk, self.rows) * self.columns + index(u, di, self.columns);
            let weight = weight(u, di) * weight(v, dk);
            height += weight * self.heights[texel];
            normal += weight * self.normals[texel];
        }
        (height, normal.normalize())
    }
}
