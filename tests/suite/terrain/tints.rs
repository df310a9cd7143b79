//! Drapes that are drawn of the land itself: lines of equal height, colours by slope and by height, against double precision.

use fumarole::measure::Variant as _;
use fumarole::papers::terrain::reference::{Hit, Part, Ray, lambert};
use fumarole::papers::terrain::{
    Base, Drape, Draping, Inputs, Interpolation, MapInput, Normals, Parameters, Rays, Sun, Surface, Variant, View,
};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap, Samples};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::drawing::Drawing;
use super::maps::{alone, map};
use super::world::{Stand, World};
use crate::common::gpu_test;

const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 1500.0 }, Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 }];
const SIZE: (u32, u32) = (96, 72);
/// Of the sun and of the sky from above, linear.
const SUNLIGHT: DVec3 = DVec3::new(2.0, 1.88, 1.7);
const SKYLIGHT: DVec3 = DVec3::new(0.55 * 0.45, 0.68 * 0.45, 0.9 * 0.45);
const INK: DVec3 = DVec3::new(0.08, 0.045, 0.02);
const INTERVAL_M: f64 = 60.0;
/// Of the heights over those that are coloured: the land spans all colours.
const SCALE: f64 = 0.05;

/// Hills and hollows of 600 m from the lowest to the highest, around 0 m.
fn hills() -> HeightMap {
    let height = |column: u32, row: u32| {
        let (x, y) = (column as f32, row as f32);
        300.0 * (0.25 * x + 0.1 * y).sin() * (0.2 * y - 0.05 * x).cos()
    };
    let heights = (0..44).flat_map(|row| (0..61).map(move |column| height(column, row))).collect();
    map(61, 44, Samples::Float(heights), 40.0)
}

fn decoded(color: [u8; 4]) -> DVec3 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    DVec3::new(linear(color[0]), linear(color[1]), linear(color[2]))
}

fn encoded(linear: DVec3) -> [f64; 3] {
    linear
        .min(DVec3::ONE)
        .to_array()
        .map(|c| 255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 })
}

/// A polygon through colours.
fn between<const N: usize>(stops: [(f64, [f64; 3]); N], at: f64) -> DVec3 {
    let place = stops.windows(2).find(|pair| pair[0].0 <= at && at < pair[1].0);
    let colors = place.map(|pair| {
        [DVec3::from(pair[0].1), DVec3::from(pair[1].1), DVec3::splat((at - pair[0].0) / (pair[1].0 - pair[0].0))]
    });
    let end = if at < stops[0].0 { stops[0].1 } else { stops[N - 1].1 };
    colors.map_or(end.into(), |[low, high, share]| low + share * (high - low))
}

fn slope_color(degrees: f64) -> DVec3 {
    let stops = [
        (0.0, [0.42, 0.45, 0.40]),
        (15.0, [0.28, 0.40, 0.12]),
        (30.0, [0.52, 0.36, 0.04]),
        (45.0, [0.50, 0.07, 0.03]),
        (60.0, [0.16, 0.02, 0.16]),
    ];
    between(stops, degrees)
}

fn height_color(height_m: f64) -> DVec3 {
    if height_m < 0.0 {
        return between(
            [(-6000.0, [0.01, 0.03, 0.12]), (-200.0, [0.05, 0.16, 0.35]), (0.0, [0.18, 0.35, 0.46])],
            height_m,
        );
    }
    let stops = [
        (0.0, [0.10, 0.26, 0.10]),
        (200.0, [0.22, 0.34, 0.11]),
        (500.0, [0.44, 0.41, 0.17]),
        (1000.0, [0.38, 0.25, 0.09]),
        (2000.0, [0.24, 0.12, 0.05]),
        (3500.0, [0.32, 0.26, 0.24]),
        (5000.0, [0.56, 0.56, 0.57]),
    ];
    between(stops, height_m)
}

/// The share of a pixel that lines cover: a narrow one by a tent of a pixel around the line, every fifth by one twice as wide.
fn ink(height_m: f64, rise_m: f64) -> f64 {
    let line = |interval_m: f64, width_px: f64| {
        let off_px = (height_m - interval_m * (height_m / interval_m).round()).abs() / rise_m;
        let apart_px = interval_m / rise_m;
        ((width_px + 1.0) / 2.0 - off_px).clamp(0.0, 1.0) * (apart_px / 2.0 - 1.0).clamp(0.0, 1.0)
    };
    0.75 * line(INTERVAL_M, 1.0).max(line(5.0 * INTERVAL_M, 2.0))
}

/// The oracle at a place in the picture.
fn seen(world: &World, rays: &Rays, x: f64, y: f64) -> Option<Hit> {
    let direction = rays.corner + x * rays.across + y * rays.down;
    let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
    world.terrain.first_hit(&ray, [0.0, f64::INFINITY]).filter(|hit| hit.part == Part::Surface)
}

/// The oracle's hit at a pixel's middle, and the change of height to the next pixel; none where it bends there.
fn hit_and_rise_m(world: &World, rays: &Rays, x: f64, y: f64) -> Option<(Hit, f64)> {
    const STEP: f64 = 1e-3;
    let hit = seen(world, rays, x, y)?;
    let change_m = |dx: f64, dy: f64| Some((seen(world, rays, x + dx, y + dy)?.place.h - hit.place.h) / STEP);
    let [west, east] = [-change_m(-STEP, 0.0)?, change_m(STEP, 0.0)?];
    let [north, south] = [-change_m(0.0, -STEP)?, change_m(0.0, STEP)?];
    let rise_m = east.hypot(south);
    let is_smooth = (east - west).abs().max((south - north).abs()) < 0.01 * rise_m;
    is_smooth.then_some((hit, rise_m))
}

/// Every variant on every base: the colour that is lit is the oracle's.
#[test]
fn lines_and_colours_are_the_oracle_s() {
    gpu_test(|device| {
        for (seed, base) in (110..).zip(BASES) {
            let mut random = Random::new(seed);
            let world = World::alone("tints", base, Interpolation::Bilinear, None, hills());
            let camera = world.camera(Stand::Above, &mut random);
            let rays = Rays::new(&camera, SIZE.0, SIZE.1);
            let sun = Sun { azimuth_rad: 5.0, elevation_rad: 0.6 };
            let to_sun = sun.direction().as_dvec3();
            let parameters = Parameters { sun, haze_per_km: Some(0.0), ..world.parameters(camera, SIZE) };
            let oracle: Vec<Option<(Hit, f64)>> = (0..SIZE.0 * SIZE.1)
                .into_par_iter()
                .map(|pixel| hit_and_rise_m(&world, &rays, f64::from(pixel % SIZE.0), f64::from(pixel / SIZE.0)))
                .collect();
            for &variant in Variant::ALL {
                let draw = |drape: Option<&Drape>| {
                    let inputs = Inputs { maps: &world.maps, drape, ..Inputs::default() };
                    Drawing::with(device, variant, &parameters, &inputs)
                };
                let bare = draw(None);
                let bare_pixels = bare.picture.pixels().as_chunks::<4>().0;
                for draping in [
                    Draping::Contours { interval_m: INTERVAL_M as f32 },
                    Draping::Slope,
                    Draping::Hypsometric { scale: SCALE as f32 },
                ] {
                    let drawing = draw(Some(&Drape::of_terrain(draping)));
                    let pixels = drawing.picture.pixels().as_chunks::<4>().0;
                    let (mut judged, mut marked, mut off) = (0, 0, 0);
                    for (pixel, found) in pixels.iter().enumerate() {
                        let (x, y) = (f64::from(pixel as u32 % SIZE.0), f64::from(pixel as u32 / SIZE.0));
                        if drawing.hits[pixel].surface != Surface::Terrain {
                            assert_eq!(*found, bare_pixels[pixel], "{base:?} {variant:?} {draping:?}: beside the land");
                            continue;
                        }
                        let Some((hit, rise_m)) = oracle[pixel] else { continue };
                        let height_m = hit.place.h + world.terrain.base_level_m;
                        // Triangles, and rays that pass a crest on the other side.
                        let distance_m = f64::from(drawing.hits[pixel].depth_m)
                            * (rays.corner + x * rays.across + y * rays.down).length();
                        if (distance_m - hit.t).abs() > 1e-4 * hit.t {
                            continue;
                        }
                        let [nx, ny, nz, _] = drawing.normals[pixel].map(f64::from);
                        let normal = DVec3::new(nx, ny, nz);
                        let up = world.terrain.base.frame(hit.place).normal;
                        let upright = world.turned(normal).dot(up);
                        let light = SUNLIGHT * lambert(normal, to_sun) + SKYLIGHT * (1.0 + upright) / 2.0;
                        let linear = match draping {
                            Draping::Contours { .. } => {
                                let share = ink(height_m, rise_m);
                                marked += usize::from(share > 0.3);
                                decoded(bare_pixels[pixel]) * (1.0 - share) + share * INK * light
                            }
                            Draping::Slope => {
                                let degrees = upright.clamp(-1.0, 1.0).acos().to_degrees();
                                marked += usize::from(degrees > 35.0);
                                light * slope_color(degrees)
                            }
                            _ => {
                                marked += usize::from(height_m < 0.0);
                                light * height_color(height_m / SCALE)
                            }
                        };
                        // The colour changes at once at 0 m; what is too bright is cut.
                        let is_step = draping == (Draping::Hypsometric { scale: SCALE as f32 }) && height_m.abs() < 0.5;
                        let is_cut =
                            matches!(draping, Draping::Contours { .. }) && bare_pixels[pixel][..3].contains(&255);
                        if is_step || is_cut {
                            continue;
                        }
                        judged += 1;
                        let worst = found
                            .iter()
                            .zip(encoded(linear))
                            .map(|(found, expected)| (f64::from(*found) - expected).abs());
                        off += usize::from(worst.fold(0.0, f64::max) > 3.0);
                    }
                    let name = format!("{base:?} {} {draping:?}", variant.as_str());
                    assert!(off * 500 <= judged, "{name}: {off} of {judged} pixels");
                    let least = if variant.is_rasterised() { 100 } else { 1000 };
                    assert!(judged > least && marked * 20 > judged, "{name}: {marked} marked of {judged} pixels");
                }
            }
        }
    });
}

/// From straight above a ramp of 45 degrees, whatever the distance: each line is as dark as one or two pixels of ink.
#[test]
fn lines_are_as_wide_from_everywhere() {
    gpu_test(|device| {
        let heights = (0..41 * 201).map(|i| 5.0 * (i % 201) as f32).collect();
        let maps = alone(map(201, 41, Samples::Float(heights), 5.0));
        // One line is a wide one, at 500 m.
        let drape = Drape::of_terrain(Draping::Contours { interval_m: 100.0 });
        for above_m in [400.0, 900.0, 2500.0] {
            let camera = Camera {
                eye: Vec3::new(0.0, 500.0 + above_m, 0.0),
                target: Vec3::ZERO,
                up: Vec3::NEG_Z,
                vertical_fov_rad: 0.02,
                near_m: 1.0,
                far_m: 1e5,
            };
            for variant in [Variant::GpuCompute, Variant::GpuFragment, Variant::Cpu, Variant::Mesh] {
                let parameters = Parameters {
                    view: View::Camera(camera),
                    haze_per_km: Some(0.0),
                    normals: Normals::Surface,
                    base_level_m: Some(0.0),
                    width: 240,
                    height: 9,
                    ..Parameters::default()
                };
                let draw = |drape| {
                    Drawing::with(device, variant, &parameters, &Inputs { maps: &maps, drape, ..Inputs::default() })
                };
                let (bare, lined) = (draw(None), draw(Some(&drape)));
                // Lines hundreds of metres from the middle, by the column that they are in.
                let row = 4 * 240;
                let mut found_px: Vec<(i32, f64)> = Vec::new();
                for column in 0..240 {
                    let [from, to] = [&bare, &lined]
                        .map(|drawing| decoded(drawing.picture.pixels().as_chunks::<4>().0[row + column]));
                    let hit = lined.hits[row + column];
                    if hit.surface != Surface::Terrain {
                        continue;
                    }
                    let line = (f64::from(hit.place[0]) * 5.0 / 100.0).round() as i32;
                    // Of light, ink leaves the share that it has itself; one channel says as much as three.
                    let light = SUNLIGHT.y
                        * lambert(normal(&lined, row + column), parameters.sun.direction().as_dvec3())
                        + SKYLIGHT.y * (1.0 + normal(&lined, row + column).y) / 2.0;
                    let share = (from.y - to.y) / (from.y - INK.y * light) / 0.75;
                    match found_px.last_mut().filter(|(last, _)| *last == line) {
                        Some((_, sum)) => *sum += share,
                        None => found_px.push((line, share)),
                    }
                }
                let is_whole = |line: &&(i32, f64)| (1..10).contains(&line.0);
                // The first and the last may be cut by the picture.
                let inner = &found_px[1..found_px.len() - 1];
                assert!(inner.iter().filter(is_whole).count() >= 1, "{variant:?} {above_m} m: {found_px:?}");
                for (line, width_px) in inner.iter().filter(is_whole) {
                    let expected_px = if line % 5 == 0 { 2.0 } else { 1.0 };
                    assert!((width_px - expected_px).abs() < 0.1, "{variant:?} {above_m} m: line {line}: {width_px}");
                }
            }
        }
    });
}

fn normal(drawing: &Drawing, pixel: usize) -> DVec3 {
    let [x, y, z, _] = drawing.normals[pixel].map(f64::from);
    DVec3::new(x, y, z)
}

/// Level land at the very height of a line is no line; colours lie on every map, and on land alone.
#[test]
fn level_land_is_no_line_and_every_map_is_coloured() {
    gpu_test(|device| {
        let level = |height_m: f32| map(21, 21, Samples::Float(vec![height_m; 21 * 21]), 10.0);
        let mut maps: Vec<MapInput> = [100.0, 600.0].into_iter().flat_map(|height_m| alone(level(height_m))).collect();
        maps[1].placement.center_m.x = 300.0;
        for &variant in Variant::ALL {
            let draw = |draping: Option<Draping>| {
                let drape = draping.map(Drape::of_terrain);
                let inputs = Inputs { maps: &maps, drape: drape.as_ref(), ..Inputs::default() };
                let parameters = Parameters {
                    view: View::Top,
                    haze_per_km: Some(0.0),
                    base_level_m: Some(0.0),
                    width: 96,
                    height: 64,
                    ..Parameters::default()
                };
                Drawing::with(device, variant, &parameters, &inputs)
            };
            let bare = draw(None);
            let lined = draw(Some(Draping::Contours { interval_m: 20.0 }));
            assert_eq!(lined.picture.pixels(), bare.picture.pixels(), "{variant:?}");
            let colored = draw(Some(Draping::Hypsometric { scale: 1.0 }));
            let pixels =
                colored.picture.pixels().as_chunks::<4>().0.iter().zip(bare.picture.pixels().as_chunks::<4>().0);
            let mut seen = [0, 0];
            for (hit, (colored, bare)) in bare.hits.iter().zip(pixels) {
                let is_land = hit.surface == Surface::Terrain;
                assert!(is_land || colored == bare, "{variant:?}: {hit:?} is coloured");
                if is_land {
                    seen[hit.map as usize] += 1;
                    // Meadow at 100 m, dry land at 600 m.
                    assert_eq!(colored[0] < colored[1], hit.map == 0, "{variant:?}: {hit:?} is {colored:?}");
                }
            }
            assert!(seen.iter().all(|pixels| *pixels > 100), "{variant:?}: {seen:?}");
        }
    });
}
