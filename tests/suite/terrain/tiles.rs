//! Maps of which the device holds some tiles: settled pictures are those of the whole map, and what has no room is drawn from the
//! level above and counted.

use std::path::Path;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Paper;
use fumarole::papers::terrain::{
    Base, Hit, Inputs, Interpolation, Lod, MapInput, Parameters, Surface, TileFile, Variant, View,
};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, RowSource, Samples, SourceState};
use glam::Vec3;

use super::drawing::{Drawing, Painter, differing};
use super::maps::{alone, map, ridges, volcano};
use crate::common::gpu_test;

fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, vertical_fov_rad: 0.6, near_m: 1.0, far_m: 1.0e6 }
}

/// A flight of some stations over the volcano of 12 km, ever lower, each far from the one before.
fn flight() -> Vec<Camera> {
    let station = |number: u32| {
        let (east, north) = (number as f32 * 2.4).sin_cos();
        let (east_m, south_m) = (4200.0 * east, -4200.0 * north);
        let eye = Vec3::new(east_m, 2600.0 - 400.0 * number as f32, south_m);
        camera(eye, Vec3::new(0.8 * east_m - 300.0, 300.0, 0.8 * south_m - 300.0))
    };
    (0..5).map(station).collect()
}

fn parameters(lod: Lod, tile_memory_mib: u32) -> Parameters {
    let (width, height) = (96, 72);
    Parameters { lod, tile_memory_mib, width, height, shadows: true, ..Parameters::default() }
}

fn painter(device: &Arc<Device>, variant: Variant, parameters: &Parameters, maps: &[MapInput]) -> Painter {
    let inputs = Inputs { maps, ..Inputs::default() };
    Painter::new(device, Compiler::Glslang, variant, parameters, &inputs)
}

/// Texels as the pass `depth` left them, to the last bit.
fn bits(drawing: &Drawing) -> Vec<(u32, [u32; 2], Surface, u32, u32)> {
    let of = |hit: &Hit| (hit.depth_m.to_bits(), hit.place.map(f32::to_bits), hit.surface, hit.shift, hit.steps);
    drawing.hits.iter().map(of).collect()
}

fn assert_same(name: &str, whole: &Drawing, tiled: &Drawing) {
    assert!(bits(whole) == bits(tiled), "{name}: rays end elsewhere");
    assert_eq!(whole.sunlit, tiled.sunlit, "{name}: shadows");
    assert!(whole.normals == tiled.normals, "{name}: normals");
    assert!(whole.picture.pixels() == tiled.picture.pixels(), "{name}: colours");
}

/// A pool of less than a quarter of the levels, over which a flight goes: every picture is that of the whole map, bit for bit.
#[test]
fn a_flight_over_tiles_shows_the_whole_map() {
    gpu_test(|device| {
        let maps = alone(volcano(2049));
        for lod in [Lod::Pixel, Lod::Exact] {
            let parameters = parameters(lod, 2);
            let mut whole = painter(device, Variant::GpuCompute, &parameters, &maps);
            let mut tiled = painter(device, Variant::TiledCompute, &parameters, &maps);
            for (number, camera) in flight().into_iter().enumerate() {
                let (expected, drawing) = (whole.from(camera), tiled.from(camera));
                let counts = tiled.paper.tiles().unwrap();
                assert_eq!(counts.missing, 0, "{lod:?}, station {number}: {counts:?}");
                assert!(counts.held * 4 < counts.tiles, "{counts:?}");
                assert_same(&format!("{lod:?}, station {number}"), &expected, &drawing);
            }
            let counts = tiled.paper.tiles().unwrap();
            // Something had to make room.
            assert!(lod == Lod::Pixel || counts.loaded > counts.held as u64, "{counts:?}");
            assert!(counts.loading_ms > 0.0 && counts.exchanges >= 1, "{counts:?}");
        }
    });
}

/// Floats and 16-bit steps, both interpolations, a round base, several maps.
#[test]
fn tiles_of_every_kind_show_the_whole_map() {
    gpu_test(|device| {
        let rough = ridges(&mut Random::new(7), (700, 391), 4000.0);
        let eye = camera(Vec3::new(-9000.0, 9000.0, 21_000.0), Vec3::new(0.0, 1000.0, 0.0));
        for base in [Base::Plane, Base::EARTH] {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                for compiler in [Compiler::Glslang, Compiler::Naga] {
                    let mut maps = alone(rough.clone());
                    maps.extend(alone(volcano(300)));
                    maps[1].placement.center_m.x = 25_000.0;
                    let inputs = Inputs { maps: &maps, ..Inputs::default() };
                    let parameters = Parameters { base, interpolation, ..parameters(Lod::Pixel, 8) };
                    let [expected, drawing] = [Variant::GpuCompute, Variant::TiledCompute]
                        .map(|variant| Painter::new(device, compiler, variant, &parameters, &inputs).from(eye));
                    assert_same(&format!("{base:?} {interpolation:?} {compiler:?}"), &expected, &drawing);
                    assert!(expected.hits.iter().filter(|hit| hit.surface == Surface::Terrain).count() > 1000);
                }
            }
        }
    });
}

/// Maps of which nothing is held, their tiles in files: every picture is that of the whole maps, bit for bit, and nothing but tiles
/// can show them.
#[test]
fn tiles_from_files_show_the_whole_map() {
    gpu_test(|device| {
        let rough = ridges(&mut Random::new(9), (700, 391), 4000.0);
        let eye = camera(Vec3::new(-9000.0, 9000.0, 21_000.0), Vec3::new(0.0, 1000.0, 0.0));
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let mut maps = alone(rough.clone());
            maps.extend(alone(volcano(300)));
            maps[1].placement.center_m.x = 25_000.0;
            let file = |input: &MapInput| {
                let key = || Ok("key".to_owned());
                let state = || Ok(SourceState::default());
                let tiles = TileFile::open(None, Path::new("map"), interpolation, key, state, || {
                    Ok(RowSource::of(input.map.as_ref().clone())?)
                });
                Arc::new(tiles.unwrap())
            };
            let tiles: Vec<Arc<TileFile>> = maps.iter().map(file).collect();
            let bare =
                |(input, tiles): (&MapInput, &Arc<TileFile>)| MapInput { map: tiles.map().clone(), ..input.clone() };
            let bare: Vec<MapInput> = maps.iter().zip(&tiles).map(bare).collect();
            assert!(bare.iter().all(|input| input.map.samples().is_empty()));
            let parameters = Parameters { interpolation, ..parameters(Lod::Pixel, 8) };
            let expected = painter(device, Variant::GpuCompute, &parameters, &maps).from(eye);
            let inputs = Inputs { maps: &bare, tiles: &tiles, ..Inputs::default() };
            let drawing =
                Painter::new(device, Compiler::Glslang, Variant::TiledCompute, &parameters, &inputs).from(eye);
            assert_same(&format!("{interpolation:?}"), &expected, &drawing);
            assert!(expected.hits.iter().filter(|hit| hit.surface == Surface::Terrain).count() > 1000);
        }
    });
}

/// A pool that has no room for what a picture asks for: no ray passes through the land, whose missing tiles are as high as the
/// level above them has them.
#[test]
fn tiles_without_room_are_drawn_from_the_level_above_and_counted() {
    gpu_test(|device| {
        let maps = alone(volcano(2049));
        for view in [View::Side, View::Top] {
            let parameters = Parameters { view, ..parameters(Lod::Exact, 1) };
            let whole = painter(device, Variant::GpuCompute, &parameters, &maps).draw();
            let mut tiled = painter(device, Variant::TiledCompute, &parameters, &maps);
            let eye = tiled.paper.camera().unwrap();
            let drawing = tiled.from(eye);
            let counts = tiled.paper.tiles().unwrap();
            assert!(counts.missing > 20 && counts.held <= 32, "{counts:?}");
            let warned = tiled.paper.warnings().join("\n");
            assert!(
                warned.contains(&format!("{} tiles", counts.missing)) && warned.contains("tile-memory"),
                "{warned}"
            );
            let mut higher = 0;
            for (pixel, (tiled, whole)) in drawing.hits.iter().zip(&whole.hits).enumerate() {
                let is_land = |hit: &Hit| !matches!(hit.surface, Surface::Sky | Surface::Base);
                assert!(is_land(tiled) || !is_land(whole), "pixel {pixel}: a hole, {tiled:?} for {whole:?}");
                if is_land(whole) {
                    assert!(tiled.depth_m <= whole.depth_m * (1.0 + 1e-5), "pixel {pixel}: {tiled:?} behind {whole:?}");
                    higher += usize::from(tiled.depth_m < whole.depth_m);
                }
            }
            assert!(higher > 500, "{higher} rays end before the data");
        }
    });
}

/// A map that is longer than the images of many devices, seen at its eastern end: the processor's picture.
#[test]
fn maps_longer_than_images_lie_in_tiles() {
    gpu_test(|device| {
        let (width, height) = (40_000_u32, 40_u32);
        let value = |index: u32| {
            let (column, row) = (index % width, index / width);
            let waves = (column as f32 * 0.31).sin() * (row as f32 * 0.23).cos() + (column as f32 * 0.017).sin();
            (20_000.0 + 8000.0 * waves) as u16
        };
        let samples = Samples::Steps { values: (0..width * height).map(value).collect(), origin_m: 0.0, step_m: 0.005 };
        let maps = alone(map(width, height, samples, 10.0));
        let view = View::Camera(camera(Vec3::new(199_000.0, 500.0, 300.0), Vec3::new(197_500.0, 60.0, -20.0)));
        let parameters = Parameters { view, ..parameters(Lod::Exact, 4) };
        let host = painter(device, Variant::Cpu, &parameters, &maps).draw();
        let mut tiled = painter(device, Variant::TiledCompute, &parameters, &maps);
        let eye = tiled.paper.camera().unwrap();
        let drawing = tiled.from(eye);
        assert_eq!(tiled.paper.tiles().unwrap().missing, 0);
        assert!(drawing.hits.iter().filter(|hit| hit.place[0] > 39_000.0).count() > 2000);
        let others = differing(&host, &drawing);
        assert!(others * 500 <= host.hits.len(), "{others} pixels differ");
    });
}
