//! Rough land of many kinds, made and real, near and far: against brute force, by every variant that casts rays.

use std::path::Path;

use fumarole::measure::Variant as _;
use fumarole::papers::terrain::{Base, Inputs, Interpolation, Lod, Parameters, Variant};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap, HeightMapSource, Samples, Voids};
use glam::{DVec2, DVec3, Vec3};

use super::drawing::Drawing;
use super::maps::{map, ridges};
use super::oracle::{THOUSANDTH, Trials};
use super::ridges::lens;
use super::silhouette::Silhouette;
use super::world::{Relief, Stand, World, random_map};
use crate::common::gpu_test;

/// Land of 20 m between samples.
fn land((width, height): (u32, u32), mut height_m: impl FnMut(u32, u32) -> f32) -> HeightMap {
    let places = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
    map(width, height, Samples::Float(places.map(|(column, row)| height_m(column, row)).collect()), 20.0)
}

/// Needles of one sample on nearly level land.
fn needles(random: &mut Random) -> HeightMap {
    land((71, 53), |_, _| if random.unit() < 0.03 { random.range(60.0, 300.0) } else { random.range(0.0, 3.0) })
}

/// Every other sample is high, none as high as another.
fn checkers(random: &mut Random) -> HeightMap {
    land(
        (52, 47),
        |column, row| {
            if (column + row) % 2 == 0 { random.range(10.0, 80.0) } else { random.range(-40.0, 0.0) }
        },
    )
}

/// Walls of a cell in both directions.
fn cliffs() -> HeightMap {
    land((83, 60), |column, row| 150.0 * (column / 13 % 2) as f32 + 75.0 * (row / 11 % 3) as f32)
}

/// A sea at height 0, level to the last bit, with islands.
fn islands(random: &mut Random) -> HeightMap {
    let tops = [(); 5].map(|()| [random.range(5.0, 60.0), random.range(5.0, 50.0), random.range(40.0, 220.0)]);
    land((66, 58), |column, row| {
        let above = |[x, y, top_m]: &[f32; 3]| top_m - 30.0 * (column as f32 - x).hypot(row as f32 - y);
        tops.iter().map(above).fold(0.0, f32::max)
    })
}

/// Land whose border, and a ragged edge inside it, a file declares void.
fn ragged(random: &mut Random, voids: Voids) -> HeightMap {
    let (width, height) = (60, 44);
    let mut text =
        format!("ncols {width}\nnrows {height}\nxllcorner 0\nyllcorner 0\ncellsize 20\nNODATA_value -9999\n");
    for row in 0..height {
        for column in 0..width {
            let inside = [column, row, width - 1 - column, height - 1 - row].into_iter().min().unwrap_or(0);
            let is_void = inside == 0 || (inside < 5 && random.unit() < 0.4);
            let height_m = if is_void { -9999.0 } else { random.range(100.0, 190.0) };
            text.push_str(&format!("{height_m} "));
        }
        text.push('\n');
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ragged.asc");
    std::fs::write(&path, text).unwrap();
    HeightMapSource::File(path).load().unwrap().with_voids(voids, 80.0).unwrap()
}

fn shipped(name: &str) -> HeightMap {
    let maps = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/maps");
    HeightMapSource::File(maps.join(name)).load().unwrap()
}

/// Bilinear and bicubic in turn, over a base below all of the land, or at the level that holes lie below.
fn worlds(maps: Vec<(&str, HeightMap, Option<f32>)>) -> Vec<World> {
    let interpolations = [Interpolation::Bilinear, Interpolation::Bicubic];
    let world = |(number, (name, map, level_m)): (usize, (&str, HeightMap, Option<f32>))| {
        let (low, high) = map.range_m();
        let level_m = level_m.unwrap_or(low - 0.3 * (high - low));
        let base = if number % 3 == 1 { Base::Cylinder { radius_m: 3e5 } } else { Base::Plane };
        World::alone(name, base, interpolations[number % 2], Some(level_m), map)
    };
    maps.into_iter().enumerate().map(world).collect()
}

fn made(seed: u64) -> Vec<World> {
    let random = &mut Random::new(seed);
    worlds(vec![
        ("terraces", random_map(random, Relief::Terraces, (89, 62), 6.0), None),
        ("ridges", ridges(random, (117, 83), 2200.0), None),
        ("cliffs", cliffs(), None),
        ("islands", islands(random), Some(-5.0)),
        ("voids as holes", ragged(random, Voids::Hole), Some(80.0)),
        ("voids at a level", ragged(random, Voids::Level(90.0)), Some(80.0)),
        ("needles", needles(random), None),
        ("checkers", checkers(random), None),
    ])
}

fn real() -> Vec<World> {
    let coast = shipped("topobathy-int16.tif");
    worlds(vec![
        ("maunga-whau", HeightMapSource::MaungaWhau.load().unwrap(), None),
        ("coast", shipped("topobathy-float-deflate.tif"), None),
        ("coast with a hole", coast.with_voids(Voids::Hole, -1500.0).unwrap(), Some(-1500.0)),
        ("lidar", shipped("lidar-dem.tif").with_exaggeration(6.0).unwrap(), None),
    ])
}

/// Rays at a level of detail from near the ground, across the whole map, and with `from_afar` from four sides away.
fn assert_met(worlds: &[World], lod: Lod, from_afar: bool) {
    gpu_test(|device| {
        let mut random = Random::new(80);
        let size = (48, 36);
        let mut trials = Trials::new(device, size).at(lod);
        for world in worlds {
            let cells = world.side_m() / world.cell_m();
            // The farthest ground is a diagonal away: a pixel is smaller than a cell there.
            let fov_rad = (0.9 * f64::from(size.1) / (1.5 * cells)) as f32;
            let near = lens(world, DVec2::new(0.12, 0.15), 0.6 * world.cell_m(), DVec2::new(0.4, 0.5), fov_rad);
            let across = lens(world, DVec2::new(0.95, 0.9), 4.0 * world.cell_m(), DVec2::new(0.3, 0.2), fov_rad);
            let mut cameras = vec![(near, "near".to_owned()), (across, "across".to_owned())];
            if from_afar {
                cameras.push((world.camera(Stand::Far(4.0), &mut random), "far".to_owned()));
            }
            trials.compare(world, &cameras, THOUSANDTH);
        }
        trials.assert([true, false, true, false, false]);
    });
}

#[test]
fn made_rough_land_is_met_as_brute_force_meets_it() {
    assert_met(&made(81), Lod::Exact, true);
}

#[test]
fn real_rough_land_is_met_as_brute_force_meets_it() {
    assert_met(&real(), Lod::Exact, true);
}

#[test]
fn magnified_rough_land_is_the_same_at_both_levels_of_detail() {
    let mut worlds = made(82);
    worlds.extend(real());
    assert_met(&worlds, Lod::Pixel, false);
}

/// Needles and checkers are thinner than a pixel there: no row of theirs is right.
#[test]
fn far_rough_land_stands_within_a_pixel_of_brute_force() {
    gpu_test(|device| {
        let size = (64, 32);
        let mut worlds = made(83);
        worlds.truncate(6);
        worlds.extend(real());
        for world in &worlds {
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            let sides = 5.0;
            let middle = world.point(DVec2::splat(0.5), 0.5 * world.top_m());
            let eye = middle + sides * world.side_m() * DVec3::new(0.5, 0.12, 1.0).normalize();
            let camera = Camera {
                eye: eye.as_vec3(),
                target: middle.as_vec3(),
                up: Vec3::Y,
                vertical_fov_rad: (0.8 / sides) as f32,
                near_m: 1.0,
                far_m: 1e8,
            };
            let expected = Silhouette::of_world(world, &camera, size);
            for &variant in Variant::ALL.iter().filter(|variant| !variant.is_rasterised()) {
                let parameters = Parameters { lod: Lod::Pixel, ..world.parameters(camera, size) };
                let drawing = Drawing::with(device, variant, &parameters, &inputs);
                let name = format!("{} {}", world.name, variant.as_str());
                Silhouette::of_drawing(&drawing).assert_near(&name, &expected, (1, 1));
            }
        }
    });
}

/// Level land around a hole: a Catmull-Rom surface, whose nodes in the hole lie far below all of the land, rises over its rim.
#[test]
fn land_around_a_deep_hole_rises_as_brute_force_has_it() {
    let head = "ncols 25\nnrows 21\nxllcorner 0\nyllcorner 0\ncellsize 20\nNODATA_value -9999\n";
    let is_hole = |row: u32, column: u32| (9..12).contains(&row) && (10..15).contains(&column);
    let height_m = |row: u32, column: u32| if is_hole(row, column) { "-9999 " } else { "100 " };
    let rows: String =
        (0..21).map(|row| (0..25).map(|column| height_m(row, column)).collect::<String>() + "\n").collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hole.asc");
    std::fs::write(&path, format!("{head}{rows}")).unwrap();
    let land = HeightMapSource::File(path).load().unwrap().with_voids(Voids::Hole, -40.0).unwrap();
    assert_eq!(land.range_m(), (100.0, 100.0));
    gpu_test(|device| {
        let mut random = Random::new(84);
        let mut trials = Trials::new(device, (48, 36));
        for base in [Base::Plane, Base::Cylinder { radius_m: 3e5 }] {
            let world = World::alone("a deep hole", base, Interpolation::Bicubic, Some(-40.0), land.clone());
            let stands = [Stand::Above, Stand::Beside, Stand::Down];
            let cameras: Vec<_> =
                stands.iter().map(|&stand| (world.camera(stand, &mut random), format!("{stand:?}"))).collect();
            trials.compare(&world, &cameras, THOUSANDTH);
        }
        trials.assert_none_wrong();
    });
}
