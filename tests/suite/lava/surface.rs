//! Heights and normals: eq. 6.3 and section 6.4.

use fumarole::measure::Paper;
use fumarole::papers::lava::reference::{Grid, Surface};
use fumarole::papers::lava::{Bed, Parameters, Particles, SurfaceKind, Variant};
use glam::{DVec3, Vec3};

use super::scene::{densities, draw, grid, lava, parameters, read_back, texels, variant_of};
use crate::common::gpu_test;

#[test]
fn heights_and_normals_follow_from_the_accepted_points() {
    gpu_test(|device| {
        use Variant::{GpuDriven, Paper};
        for (variant, border_m, geometry_stage) in [
            (Paper, 0.2, true),
            (Paper, 0.2, false),
            (Paper, 0.0, true),
            (GpuDriven, 0.2, true),
            (GpuDriven, 0.0, true),
        ] {
            let parameters = Parameters { border_m, geometry_stage, ..parameters() };
            let mut lava = variant_of(device, variant, &parameters, &Particles::seeded(&parameters));
            draw(device, &mut lava, 0);
            let grid = grid(&parameters);
            let accepted: Vec<DVec3> = match variant {
                Paper => {
                    let points = read_back(&lava).extract.accepted.iter();
                    points.map(|p| Vec3::from_array(p.position).as_dvec3()).collect()
                }
                GpuDriven => grid.accepted(&densities(device, &lava, &parameters), f64::from(parameters.rho())),
            };
            assert_eq!(lava.method.accepted(device).unwrap().count, accepted.len());
            let expected = Surface::sums(&grid, &accepted, f64::from(parameters.radius_m));
            let found: Vec<[f32; 4]> = texels(device, lava.method.sums());
            assert_eq!(found.len(), expected.len());
            for (found, [heights, weights]) in found.iter().zip(&expected) {
                let off = (f64::from(found[0]) - heights).abs() + (f64::from(found[3]) - weights).abs();
                assert!(off < 1e-4 * weights.max(1.0), "{found:?} {heights} {weights}");
            }
            // From the sums of the device, so that one rounding does not count twice.
            let sums: Vec<[f64; 2]> = found.iter().map(|s| [f64::from(s[0]), f64::from(s[3])]).collect();
            let surface = Surface::from_sums(&grid, &sums, f64::from(border_m));
            let found: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
            for (texel, found) in found.iter().enumerate() {
                let normal = Vec3::from_slice(found).as_dvec3();
                assert!(normal.distance(surface.normals[texel]) < 1e-4, "{texel}: {normal}");
                assert!((f64::from(found[3]) - surface.heights[texel]).abs() < 1e-5, "{texel}: {found:?}");
            }
        }
    });
}

/// The three surfaces over the same densities, each against its own oracle.
#[test]
fn the_surface_is_the_mean_the_top_or_the_crossing() {
    gpu_test(|device| {
        let mut means = Vec::new();
        for (variant, surface, geometry_stage) in [
            (Variant::Paper, SurfaceKind::Mean, true),
            (Variant::Paper, SurfaceKind::Top, true),
            (Variant::Paper, SurfaceKind::Top, false),
            (Variant::Paper, SurfaceKind::Crossing, true),
            (Variant::GpuDriven, SurfaceKind::Mean, true),
            (Variant::GpuDriven, SurfaceKind::Top, true),
            (Variant::GpuDriven, SurfaceKind::Crossing, true),
        ] {
            let parameters = Parameters { surface, geometry_stage, border_m: 0.0, ..parameters() };
            let mut lava = variant_of(device, variant, &parameters, &Particles::seeded(&parameters));
            // Twice: a frame leaves nothing to the next.
            draw(device, &mut lava, 0);
            draw(device, &mut lava, 1);
            let (grid, rho) = (grid(&parameters), f64::from(parameters.rho()));
            let densities = densities(device, &lava, &parameters);
            let radius = f64::from(parameters.radius_m);
            let (points, radius) = match surface {
                SurfaceKind::Mean => (grid.accepted(&densities, rho), radius),
                SurfaceKind::Top => (grid.tops(&densities, rho), radius),
                SurfaceKind::Crossing => (grid.crossings(&densities, rho), 1e-3),
            };
            let expected = Surface::from_sums(&grid, &Surface::sums(&grid, &points, radius), 0.0);
            let found: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
            for (texel, (found, expected)) in found.iter().zip(&expected.heights).enumerate() {
                assert!((f64::from(found[3]) - expected).abs() < 1e-5, "{surface:?} {texel}: {found:?} {expected}");
            }
            if variant == Variant::Paper {
                assert_eq!(read_back(&lava).extract.points().len(), points.len(), "{surface:?}");
            }
            let fractions = points.iter().filter(|p| (p.y * 10.0 - 0.5).fract().abs() > 0.01).count();
            assert_eq!(
                fractions > 300,
                surface == SurfaceKind::Crossing,
                "{surface:?}: {fractions} lie between planes"
            );
            means.push(expected.heights.iter().sum::<f64>() / expected.heights.len() as f64);
        }
        println!("mean heights {means:?}");
        assert!(means[1] > means[0] + 0.2 && means[3] > means[0] + 0.2, "{means:?}");
    });
}

/// A particle on one grid point of each column, no two within reach of each other: the surface goes through them.
#[test]
fn a_known_height_field_comes_out() {
    gpu_test(|device| {
        let parameters = Parameters {
            space_m: Vec3::new(2.0, 1.0, 1.0),
            density: [20, 10, 10],
            radius_m: 0.09,
            rho: Some(0.5),
            border_m: 0.0,
            time_step_s: 0.0,
            particles: 200,
            ..parameters()
        };
        let grid = Grid::new(parameters.space_m, parameters.density);
        let plane = |i: usize, k: usize| (i * i / 3 + 2 * k + i * k) % 10;
        let columns = || (0..10).flat_map(|k| (0..20).map(move |i| (i, k)));
        let positions = columns().map(|(i, k)| grid.place([i, plane(i, k), k]).as_vec3()).collect();
        let particles =
            Particles { positions, velocities: vec![Vec3::X; 200], temperatures_k: Vec::new(), bed: Bed::level() };
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let mut lava = variant_of(device, variant, &parameters, &particles);
            draw(device, &mut lava, 0);
            let found: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
            let height = |i: usize, k: usize| grid.place([0, plane(i, k), 0]).y;
            for ((i, k), texel) in columns().zip(&found) {
                assert!((f64::from(texel[3]) - height(i, k)).abs() < 1e-6, "{i} {k}: {texel:?}");
                // Cells are squares of 0.1 m; at the sides the difference is one-sided.
                let along = |before: f64, after: f64, steps: usize| (after - before) / (0.1 * steps as f64);
                let (left, right) = (i.saturating_sub(1), (i + 1).min(19));
                let (front, back) = (k.saturating_sub(1), (k + 1).min(9));
                let slopes = [
                    along(height(left, k), height(right, k), right - left),
                    along(height(i, front), height(i, back), back - front),
                ];
                let expected = DVec3::new(-slopes[0], 1.0, -slopes[1]).normalize();
                assert!(Vec3::from_slice(texel).as_dvec3().distance(expected) < 1e-5, "{i} {k}: {texel:?} {expected}");
            }
        }
    });
}

#[test]
fn the_surface_sinks_and_turns_up_towards_the_borders() {
    gpu_test(|device| {
        let parameters = Parameters { density: [40, 1, 24], radius_m: 0.3, rho: Some(1e-6), ..parameters() };
        let mut lava = lava(device, &parameters);
        draw(device, &mut lava, 0);
        let found: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
        let grid = grid(&parameters);
        // One plane at half the height, accepted everywhere.
        assert_eq!(read_back(&lava).extract.accepted.len(), 40 * 24);
        let fraction = |i: usize, k: usize| {
            let place = grid.place([i, 0, k]);
            let sides = [place.x, 2.0 - place.x, place.z, f64::from(1.2f32) - place.z];
            (sides.into_iter().fold(f64::INFINITY, f64::min) / f64::from(0.2f32)).min(1.0)
        };
        for (texel, found) in found.iter().enumerate() {
            let (i, k) = (texel % 40, texel / 40);
            assert!((f64::from(found[3]) - 0.5 * fraction(i, k)).abs() < 1e-5, "{i} {k}: {found:?}");
        }
        // Across the middle, cells of 0.05 m: at the foot the slope is 2.5 and the normal's fraction of it small, then it
        // follows the slope, above it the surface is level.
        let normals: Vec<DVec3> = (0..24).map(|k| Vec3::from_slice(&found[k * 40 + 20]).as_dvec3()).collect();
        for (k, normal) in normals.iter().enumerate() {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(23));
            let slope = 0.5 * (fraction(20, after) - fraction(20, before)) / (0.05 * (after - before) as f64);
            let expected = DVec3::Y.lerp(DVec3::new(0.0, 1.0, -slope).normalize(), fraction(20, k)).normalize();
            assert!(normal.distance(expected) < 1e-4, "{k}: {normal} {expected}");
        }
        assert!(normals[0].y > 0.98 && normals[2].y < 0.8 && normals[12].y > 0.9999, "{normals:?}");
    });
}

#[test]
fn a_threshold_that_nothing_reaches_leaves_the_ground_and_a_warning() {
    gpu_test(|device| {
        let parameters = Parameters { rho: Some(1e9), ..parameters() };
        let mut lava = lava(device, &parameters);
        assert_eq!(lava.warnings(), Vec::<String>::new());
        draw(device, &mut lava, 0);
        let found: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
        assert!(found.iter().all(|t| *t == [0.0, 1.0, 0.0, 0.0]));
        let [lowest, highest] = read_back(&lava).extract.density_range;
        assert!(lowest >= 0.0 && highest > 10.0 * lowest);
        let warnings = lava.warnings();
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(warning.contains(&format!("{lowest} to {highest}")) && warning.contains("`rho`"), "{warning}");
    });
}
