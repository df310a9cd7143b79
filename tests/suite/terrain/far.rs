//! Cameras far from land, near planes close to them: what is nearer hides what is farther all the same.

use std::sync::Arc;

use fumarole::measure::Variant as _;
use fumarole::papers::terrain::reference::{Hit, Part, Ray};
use fumarole::papers::terrain::{
    Base, Inputs, Interpolation, MapInput, Parameters, Placement, Rays, Surface, Variant, View,
};
use fumarole::scene::{Camera, Samples, shapes};
use glam::{DVec2, DVec3, Mat4, Vec3};

use super::drawing::Drawing;
use super::maps::map;
use super::silhouette::is_land;
use super::world::World;
use crate::common::gpu_test;

const AWAY_M: [f64; 2] = [160e3, 300e3];
const SIZE: (u32, u32) = (96, 72);

/// Level land in cells of 400 m.
fn level(cells: u32, height_m: f32, center_m: DVec2) -> MapInput {
    let samples = Samples::Float(vec![height_m; ((cells + 1) * (cells + 1)) as usize]);
    let placement = Placement { center_m, ..Placement::default() };
    MapInput { map: Arc::new(map(cells + 1, cells + 1, samples, 400.0)), placement }
}

/// As a camera that a user sets has it, a centimetre before which pictures begin; `across_m` are seen from side to side.
fn from_afar(away_m: f64, across_m: f64) -> Camera {
    Camera {
        eye: (away_m * DVec3::new(0.4, 0.25, 0.9).normalize()).as_vec3(),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: (0.75 * across_m / away_m) as f32,
        near_m: 0.01,
        far_m: 1e6,
    }
}

/// Directions through a pixel's middle and half a pixel around it.
fn directions(rays: &Rays, pixel: usize) -> [DVec3; 5] {
    let (x, y) = ((pixel % SIZE.0 as usize) as f64, (pixel / SIZE.0 as usize) as f64);
    [(0.0, 0.0), (-0.5, 0.0), (0.5, 0.0), (0.0, -0.5), (0.0, 0.5)]
        .map(|(a, b)| rays.corner + (x + a) * rays.across + (y + b) * rays.down)
}

/// A plateau 60 m over a plain 100 m over the base, each level: a ray passes from one to the next within 250 m.
#[test]
fn far_land_is_seen_in_its_order() {
    gpu_test(|device| {
        for base in [Base::Plane, Base::Cylinder { radius_m: 5e6 }, Base::EARTH] {
            let maps = vec![level(60, 100.0, DVec2::ZERO), level(30, 160.0, DVec2::new(1200.0, -800.0))];
            let world = World::new("plateau", base, Interpolation::Bilinear, Some(0.0), maps);
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            for away_m in AWAY_M {
                let camera = from_afar(away_m, 34e3);
                let rays = Rays::new(&camera, SIZE.0, SIZE.1);
                let seen = |direction: DVec3| -> Option<Hit> {
                    let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
                    world.terrain.first_hit(&ray, [0.0, f64::INFINITY])
                };
                let expected: Vec<_> = (0..(SIZE.0 * SIZE.1) as usize)
                    .map(|pixel| {
                        let seen = directions(&rays, pixel).map(&seen);
                        let what = seen.map(|hit| hit.map(|hit| (hit.part, hit.map)));
                        what.iter().all(|other| *other == what[0]).then_some(seen[0])
                    })
                    .collect();
                let counts = [None, Some(0), Some(1)].map(|map| {
                    expected.iter().flatten().flatten().filter(|hit| hit.map == map && hit.part != Part::Wall).count()
                });
                assert!(counts.iter().all(|count| *count > 100), "{base:?} {away_m} m: {counts:?} on base and maps");
                for &variant in Variant::ALL {
                    let parameters = world.parameters(camera, SIZE);
                    let drawing = Drawing::with(device, variant, &parameters, &inputs);
                    for (pixel, (found, expected)) in drawing.hits.iter().zip(&expected).enumerate() {
                        let Some(expected) = expected else { continue };
                        let name =
                            || format!("{base:?} {variant:?} {away_m} m: pixel {pixel}: {found:?}, not {expected:?}");
                        match expected {
                            None => assert_eq!(found.surface, Surface::Sky, "{}", name()),
                            Some(hit) => {
                                let map = is_land(found.surface).then_some(found.map as usize);
                                let t = f64::from(found.depth_m) * directions(&rays, pixel)[0].length();
                                assert!(map == hit.map && (t - hit.t).abs() < 1e-4 * hit.t, "{}", name());
                            }
                        }
                    }
                }
            }
        }
    });
}

/// True when a ray meets a box before a level 100 m high.
fn is_seen(eye: DVec3, direction: DVec3, (middle, half): (DVec3, DVec3)) -> bool {
    let (a, b) = ((middle - half - eye) / direction, (middle + half - eye) / direction);
    let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
    near < far && near < (100.0 - eye.y) / direction.y
}

/// A slab that hovers 40 m over the land is seen whole, one as deep in it is not.
#[test]
fn far_objects_and_land_hide_each_other() {
    gpu_test(|device| {
        let maps = [level(60, 100.0, DVec2::ZERO)];
        let half = DVec3::new(1500.0, 10.0, 1500.0);
        let slabs = [(DVec3::new(-3000.0, 50.0, 0.0), half), (DVec3::new(3000.0, 150.0, 0.0), half)];
        let objects = slabs.map(|(middle, half)| {
            let stand = Mat4::from_translation(middle.as_vec3()) * Mat4::from_scale(half.as_vec3());
            shapes::cuboid().transformed(&stand)
        });
        for away_m in AWAY_M {
            let camera = from_afar(away_m, 12e3);
            let rays = Rays::new(&camera, SIZE.0, SIZE.1);
            for (&variant, shadows) in Variant::ALL.iter().flat_map(|variant| [(variant, false), (variant, true)]) {
                let parameters = Parameters {
                    view: View::Camera(camera),
                    base_level_m: Some(0.0),
                    haze_per_km: Some(0.0),
                    shadows,
                    width: SIZE.0,
                    height: SIZE.1,
                    ..Parameters::default()
                };
                let [with, without] = [&objects[..], &[]].map(|objects| {
                    Drawing::with(device, variant, &parameters, &Inputs { maps: &maps, objects, ..Inputs::default() })
                        .picture
                });
                let pixels = [&with, &without].map(|picture| picture.pixels().as_chunks::<4>().0);
                let mut seen = [0, 0];
                for (pixel, (with, without)) in pixels[0].iter().zip(pixels[1]).enumerate() {
                    let expected = directions(&rays, pixel)
                        .map(|direction| slabs.iter().any(|slab| is_seen(rays.eye, direction, *slab)));
                    // Shadows of the hovering slab lie beside it.
                    let is_shadow = shadows && !expected[0];
                    if expected.iter().all(|is_seen| *is_seen == expected[0]) && !is_shadow {
                        seen[usize::from(expected[0])] += 1;
                        // Red paint, green land.
                        let is_painted = with[0] > with[1];
                        let name = || format!("{variant:?} {shadows} {away_m} m: pixel {pixel}: {with:?}, {without:?}");
                        assert!(is_painted == expected[0] && (is_painted || with == without), "{}", name());
                    }
                }
                assert!(seen[1] > 80, "{variant:?} {away_m} m: {seen:?}");
            }
        }
    });
}
