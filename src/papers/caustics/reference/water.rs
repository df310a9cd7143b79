//! The water surface: a triangle mesh, two surfaces with a closed form, and one through samples.

use crate::papers::caustics::reference::AIR;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A vertex of the water mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaterVertex {
    /// Position in the world, in metres.
    pub position: DVec3,
    /// Unit normal, upward.
    pub normal: DVec3,
}

/// The water as a triangle mesh; every index is below the number of vertices.
#[derive(Clone, Copy, Debug)]
pub struct Water<'a> {
    /// Vertices.
    pub vertices: &'a [WaterVertex],
    /// Faces F_j of section 4.3, wound either way.
    pub triangles: &'a [[u32; 3]],
}

/// One sine wave of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Amplitude, in metres.
    pub amplitude_m: f64,
    /// Unit direction of travel as (x, z).
    pub direction: DVec2,
    /// Wavelength, in metres, above 0.
    pub wavelength_m: f64,
    /// Angular frequency, in rad/s.
    pub angular_frequency_rad_s: f64,
    /// Phase at the origin at time 0, in radians.
    pub phase_rad: f64,
}

/// The sum of `waves` above `water_level_m` at (x, z): height Σ A sin(k·x - ωt + φ) and its analytic normal.
pub fn wave_vertex(waves: &[Wave], water_level_m: f64, x: f64, z: f64, time_s: f64) -> WaterVertex {
    let mut height = water_level_m;
    let mut slope = DVec2::ZERO;
    for wave in waves {
        let wave_vector = wave.direction * (TAU / wave.wavelength_m);
        let angle = wave_vector.dot(DVec2::new(x, z)) - wave.angular_frequency_rad_s * time_s + wave.phase_rad;
        height += wave.amplitude_m * angle.sin();
        slope += wave.amplitude_m * angle.cos() * wave_vector;
    }
    WaterVertex { position: DVec3::new(x, height, z), normal: DVec3::new(-slope.x, 1.0, -slope.y).normalize() }
}

/// The bicubic spline through the samples of a height map: their tensor product B-spline, whose coefficients go on
/// beyond the border as at the border.
#[derive(Clone, Debug)]
pub struct HeightField {
    /// Row by row, metres above the water's level.
    pub coefficients: Vec<f64>,
    columns: usize,
    spacing_m: DVec2,
    middle: DVec2,
}

impl HeightField {
    /// The surface through `heights`, row by row: `columns` of them along x, rows along z, `spacing_m` apart, with the
    /// middle of the map at x and z of `middle`. At least one row of at least one sample.
    pub fn through(heights: &[f64], columns: usize, spacing_m: DVec2, middle: DVec2) -> Self {
        let mut field = HeightField { coefficients: heights.to_vec(), columns, spacing_m, middle };
        // What a sample lacks is added to its coefficient until nothing is lacking: with weights of 4/9 at a
        // coefficient's own sample what lacks shrinks by 8/9 at least.
        for _ in 0..400 {
            let lacking = |(sample, height): (usize, &f64)| {
                height - field.height_and_slope(DVec2::new((sample % columns) as f64, (sample / columns) as f64)).0
            };
            let lacking: Vec<f64> = heights.iter().enumerate().map(lacking).collect();
            field.coefficients.iter_mut().zip(lacking).for_each(|(c, lacking)| *c += lacking);
        }
        field
    }

    /// The surface above `water_level_m` at (x, z) with its analytic normal.
    pub fn vertex(&self, water_level_m: f64, x: f64, z: f64) -> WaterVertex {
        let at = (DVec2::new(x, z) - self.middle) / self.spacing_m + self.last() / 2.0;
        let (height, slope) = self.height_and_slope(at);
        let slope = slope / self.spacing_m;
        WaterVertex {
            position: DVec3::new(x, water_level_m + height, z),
            normal: DVec3::new(-slope.x, 1.0, -slope.y).normalize(),
        }
    }

    /// Column and row of the last sample.
    fn last(&self) -> DVec2 {
        DVec2::new((self.columns - 1) as f64, (self.coefficients.len() / self.columns - 1) as f64)
    }

    /// At a place in samples from the first one: height, and slopes per sample.
    fn height_and_slope(&self, at: DVec2) -> (f64, DVec2) {
        let base = at.floor();
        let (mut height, mut slope) = (0.0, DVec2::ZERO);
        for (i, j) in [-1.0, 0.0, 1.0, 2.0].into_iter().flat_map(|j| [-1.0, 0.0, 1.0, 2.0].map(|i| (i, j))) {
            let node = base + DVec2::new(i, j);
            let inside = node.clamp(DVec2::ZERO, self.last());
            let coefficient = self.coefficients[inside.y as usize * self.columns + inside.x as usize];
            let ((x, x_slope), (y, y_slope)) = (b_spline(at.x - node.x), b_spline(at.y - node.y));
            height += coefficient * x * y;
            slope += coefficient * DVec2::new(x_slope * y, x * y_slope);
        }
        (height, slope)
    }
}

/// The cubic B-spline around 0 and its derivative.
fn b_spline(x: f64) -> (f64, f64) {
    let a = x.abs();
    let (value, slope) = if a < 1.0 {
        (2.0 / 3.0 - a * a + a * a * a / 2.0, -2.0 * a + 1.5 * a * a)
    } else if a < 2.0 {
        ((2.0 - a).powi(3) / 6.0, -(2.0 - a).powi(2) / 2.0)
    } else {
        (0.0, 0.0)
    };
    (value, slope * x.signum())
}

/// A point of a spherical cap of water that bulges upward, highest at `vertex`; `None` beyond its radius.
pub fn spherical_cap_vertex(radius_m: f64, vertex: DVec3, x: f64, z: f64) -> Option<WaterVertex> {
    let offset = DVec2::new(x - vertex.x, z - vertex.z);
    let rise_squared = radius_m * radius_m - offset.length_squared();
    (rise_squared > 0.0).then(|| {
        let from_center = DVec3::new(offset.x, rise_squared.sqrt(), offset.y);
        WaterVertex { position: vertex - DVec3::Y * radius_m + from_center, normal: from_center / radius_m }
    })
}

/// Depth below its vertex at which a spherical cap focuses parallel light from overhead, for rays near the axis: n R /
/// (n - 1), which is 4 R for n = 4/3.
pub fn spherical_cap_focus(radius_m: f64, refraction_index: f64) -> f64 {
    refraction_index * radius_m / (refraction_index - AIR)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{Mesh, OVERHEAD, WATER, gentle_waves};
    use crate::papers::caustics::reference::{illumination_volumes, refract};

    #[test]
    fn the_analytic_normal_is_the_gradient_of_the_height() {
        let (waves, step) = (gentle_waves(), 1e-5);
        let at = |x, z| wave_vertex(&waves, 0.3, x, z, 0.7).position.y;
        for (x, z) in [(0.0, 0.0), (0.4, -1.2), (2.1, 0.9)] {
            let normal = wave_vertex(&waves, 0.3, x, z, 0.7).normal;
            let along_x = (at(x + step, z) - at(x - step, z)) / (2.0 * step);
            let along_z = (at(x, z + step) - at(x, z - step)) / (2.0 * step);
            assert!((normal.x / normal.y + along_x).abs() < 1e-8);
            assert!((normal.z / normal.y + along_z).abs() < 1e-8);
        }
    }

    const SPACING_M: DVec2 = DVec2::new(0.25, 0.5);
    const MIDDLE: DVec2 = DVec2::new(1.0, -2.0);

    /// The surface through samples of a function, 41 x 39 of them.
    fn field(height: impl Fn(f64, f64) -> f64) -> HeightField {
        let place = |i: u32, count: u32| f64::from(i) - f64::from(count - 1) / 2.0;
        let heights: Vec<f64> = (0..39)
            .flat_map(|row| (0..41).map(move |column| (column, row)))
            .map(|(column, row)| MIDDLE + SPACING_M * DVec2::new(place(column, 41), place(row, 39)))
            .map(|at| height(at.x, at.y))
            .collect();
        HeightField::through(&heights, 41, SPACING_M, MIDDLE)
    }

    /// The border makes no difference in the middle.
    #[test]
    fn a_cubic_surface_is_reproduced_by_its_samples() {
        let height = |x: f64, z: f64| 0.3 + 0.2 * x - 0.1 * z + 0.05 * x * x * z - 0.04 * z * z + 0.03 * x * z;
        let field = field(height);
        for (x, z) in [(1.0, -2.0), (0.6, -2.4), (1.37, -1.51), (1.7, -2.9)] {
            let vertex = field.vertex(0.5, x, z);
            assert!((vertex.position.y - 0.5 - height(x, z)).abs() < 1e-9);
            let slope = (0.2 + 0.1 * x * z + 0.03 * z, -0.1 + 0.05 * x * x - 0.08 * z + 0.03 * x);
            assert!((vertex.normal.x / vertex.normal.y + slope.0).abs() < 1e-9);
            assert!((vertex.normal.z / vertex.normal.y + slope.1).abs() < 1e-9);
        }
    }

    #[test]
    fn the_samples_lie_on_the_surface_and_the_curvature_is_continuous() {
        let height = |x: f64, z: f64| (5.0 * x).sin() + (3.0 * z + x).cos();
        let field = field(height);
        let step = 1e-4;
        let at = |x: f64, z: f64| field.vertex(0.0, x, z).position.y;
        // Nodes, at the border and inside; left and right of each the second derivatives agree.
        for (i, j) in [(0.0, 0.0), (20.0, 19.0), (13.0, -19.0), (-20.0, 4.0)] {
            let node = MIDDLE + SPACING_M * DVec2::new(i, j);
            assert!((at(node.x, node.y) - height(node.x, node.y)).abs() < 1e-10);
            for along in [DVec2::X, DVec2::Y] {
                let second = |from: DVec2| {
                    let [a, b, c] = [-1.0, 0.0, 1.0].map(|k| from + along * (k * step)).map(|p| at(p.x, p.y));
                    (a - 2.0 * b + c) / (step * step)
                };
                let (left, right) = (second(node - along * step), second(node + along * step));
                assert!((left - right).abs() < 0.1, "{left} {right}");
            }
        }
    }

    #[test]
    fn the_normal_of_a_height_map_is_its_gradient() {
        let field = field(|x, z| (5.0 * x).sin() + (3.0 * z + x).cos());
        let at = |x, z| field.vertex(0.0, x, z).position.y;
        let step = 1e-6;
        // Inside a cell, on its edges and corners, at the border and beyond it.
        for (x, z) in [(1.1, -2.1), (1.25, -2.2), (1.25, -1.5), (-4.0, -3.1), (6.4, -0.5), (-9.0, 14.0)] {
            let normal = field.vertex(0.0, x, z).normal;
            let along_x = (at(x + step, z) - at(x - step, z)) / (2.0 * step);
            let along_z = (at(x, z + step) - at(x, z - step)) / (2.0 * step);
            assert!((normal.x / normal.y + along_x).abs() < 1e-6, "{x} {z}: {normal} {along_x}");
            assert!((normal.z / normal.y + along_z).abs() < 1e-6, "{x} {z}: {normal} {along_z}");
        }
        assert!(field.vertex(0.0, -9.0, 14.0).normal.distance(DVec3::Y) < 1e-15);
    }

    #[test]
    fn waves_travel_along_their_direction() {
        let wave = gentle_waves()[0];
        let travelled = wave.direction * wave.angular_frequency_rad_s * wave.wavelength_m / TAU;
        let before = wave_vertex(&[wave], 0.0, 0.2, 0.1, 0.0).position.y;
        let after = wave_vertex(&[wave], 0.0, 0.2 + travelled.x, 0.1 + travelled.y, 1.0);
        assert!((before - after.position.y).abs() < 1e-12);
    }

    #[test]
    fn a_spherical_cap_focuses_four_radii_below_its_vertex() {
        let (radius, vertex) = (0.5, DVec3::new(1.0, 0.2, -1.0));
        let focus = spherical_cap_focus(radius, WATER.refraction_index);
        assert!((focus - 4.0 * radius).abs() < 1e-12);
        for (fraction, tolerance) in [(1e-3, 1e-5), (0.02, 1e-3)] {
            let offset = radius * fraction;
            let cap = spherical_cap_vertex(radius, vertex, vertex.x + offset, vertex.z).unwrap();
            let ray = refract(-DVec3::Y, cap.normal, AIR, WATER.refraction_index).unwrap();
            let crossing = cap.position.y - offset * ray.y / ray.x;
            assert!(((vertex.y - crossing) / focus - 1.0).abs() < tolerance);
        }
        assert_eq!(spherical_cap_vertex(radius, vertex, 3.0, 0.0), None);
    }

    #[test]
    fn the_illumination_volumes_of_a_cap_are_narrowest_at_its_focus() {
        let (radius, vertex) = (1.0, DVec3::ZERO);
        let cap = Mesh::grid(12, 0.2, |x, z| spherical_cap_vertex(radius, vertex, x, z).unwrap());
        let volumes = illumination_volumes(cap.water(), OVERHEAD, WATER);
        let spread = |depth: f64| -> f64 {
            let rays = volumes.iter().flat_map(|v| v.vertices.into_iter().zip(v.refracted));
            rays.map(|(p, t)| p + t * ((-depth - p.y) / t.y)).map(|p| p.x * p.x + p.z * p.z).sum()
        };
        let focus = spherical_cap_focus(radius, WATER.refraction_index);
        assert!(spread(focus) < 0.02 * spread(0.8 * focus));
        assert!(spread(focus) < 0.02 * spread(1.2 * focus));
    }
}
