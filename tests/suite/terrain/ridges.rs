//! Rough land: crests narrower than a piece of a ray must neither be passed through nor moved.

use fumarole::measure::Variant as _;
use fumarole::papers::terrain::{Base, Inputs, Interpolation, Lod, Parameters, Variant};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap, HeightMapSource};
use glam::{DVec2, Vec3};

use super::drawing::Drawing;
use super::maps::ridges;
use super::oracle::{THOUSANDTH, Trials};
use super::silhouette::Silhouette;
use super::world::World;
use crate::common::gpu_test;

pub const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 40_000.0 }, Base::Ellipsoid { equatorial_m: 60_000.0, polar_m: 50_000.0 }];
const INTERPOLATIONS: [Interpolation; 2] = [Interpolation::Bilinear, Interpolation::Bicubic];

/// A telephoto lens over a place, `above_m` over the surface there, that looks at another on the surface.
pub fn lens(world: &World, from: DVec2, above_m: f64, to: DVec2, fov_rad: f32) -> Camera {
    Camera {
        eye: world.point(from, world.height_m(from) + above_m).as_vec3(),
        target: world.point(to, 0.8 * world.height_m(to)).as_vec3(),
        up: Vec3::Y,
        vertical_fov_rad: fov_rad,
        near_m: 1.0,
        far_m: 1e7,
    }
}

/// As long as a pixel is smaller than a cell, `lod` pixel meets what brute force meets.
#[test]
fn magnified_crests_stand_as_brute_force_has_them() {
    let jacksboro: HeightMap = HeightMapSource::Jacksboro.load().unwrap();
    gpu_test(|device| {
        let mut random = Random::new(60);
        let mut trials = Trials::new(device, (64, 48)).at(Lod::Pixel);
        for (base, interpolation) in BASES.into_iter().flat_map(|base| INTERPOLATIONS.map(|i| (base, i))) {
            let map = ridges(&mut random, (129, 97), 3000.0);
            let mut worlds = vec![World::alone("ridges", base, interpolation, None, map)];
            if base == Base::Plane {
                worlds.push(World::alone("jacksboro", base, interpolation, None, jacksboro.clone()));
            }
            for world in worlds {
                // The farthest ground is 160 cells away, or 500 of the larger map, and a pixel less than a cell there.
                let fov_rad = if world.name == "ridges" { 0.25 } else { 0.08 };
                let near = lens(&world, DVec2::new(0.05, 0.1), 60.0, DVec2::new(0.4, 0.5), fov_rad);
                let across = lens(&world, DVec2::new(0.95, 0.9), 400.0, DVec2::new(0.3, 0.2), fov_rad);
                trials.compare(&world, &[(near, "near".into()), (across, "across".into())], THOUSANDTH);
            }
        }
        trials.assert([true, false, true, false, false]);
    });
}

/// When a pixel covers many cells, the land against the sky is at most a pixel off.
#[test]
fn far_silhouettes_are_within_a_pixel_of_brute_force() {
    gpu_test(|device| {
        let mut random = Random::new(61);
        let size = (88, 44);
        let cases = BASES.into_iter().flat_map(|base| INTERPOLATIONS.map(|i| (base, i, 3000.0)));
        // And walls, as an exaggeration of 30 makes them.
        for (base, interpolation, height_m) in cases.chain(INTERPOLATIONS.map(|i| (Base::Plane, i, 90_000.0))) {
            let map = ridges(&mut random, (200, 161), height_m);
            let world = World::alone("ridges", base, interpolation, None, map);
            for (number, sides) in [2.0, 5.0, 12.0].into_iter().enumerate() {
                let middle = world.point(DVec2::splat(0.5), 0.5 * f64::from(height_m));
                let away_m = sides * world.side_m();
                let towards = glam::DVec3::new(0.5, 0.12, 1.0).normalize();
                let camera = Camera {
                    eye: (middle + away_m * towards).as_vec3(),
                    target: middle.as_vec3(),
                    up: Vec3::Y,
                    vertical_fov_rad: (0.5 / sides) as f32 * [1.0, 1.6, 3.0][number],
                    near_m: 1.0,
                    far_m: 1e8,
                };
                let expected = Silhouette::of_world(&world, &camera, size);
                let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
                let ray_casts = Variant::ALL.iter().filter(|v| !v.is_rasterised());
                for &variant in ray_casts {
                    let parameters = Parameters { lod: Lod::Pixel, ..world.parameters(camera, size) };
                    let drawing = Drawing::with(device, variant, &parameters, &inputs);
                    let name = format!("{base:?} {interpolation:?} {variant:?} {sides} sides, {height_m} m");
                    Silhouette::of_drawing(&drawing).assert_near(&name, &expected, (1, 1));
                }
            }
        }
    });
}
