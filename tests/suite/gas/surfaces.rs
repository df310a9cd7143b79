//! Surfaces that intersect, surface-defined gases, bands of rows, and devices without geometry stages.

use std::ops::Range;
use std::sync::Arc;

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, Error, Feature, PhysicalDevice};
use fumarole::gpu::{Mode, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::gas::model::{DensityFunction, Object, SolidTexture};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::Rays;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Gas, Lists, Parameters, Variant};
use fumarole::scene::{Camera, Light, Mesh, shapes};
use glam::{DVec3, Mat4, Quat, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::scenes::small;
use crate::common::{gpu_test, gpu_test_alone, shaders_by};

const WIDTH: u32 = 45;
const HEIGHT: u32 = 31;

/// The camera at the origin looks along -Z; colours are the surfaces' own.
fn parameters() -> Parameters {
    Parameters {
        volumes: Vec::new(),
        lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }],
        ambient: Vec3::ONE,
        camera: Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, near_m: 0.5, ..Parameters::default().camera },
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

/// A square of 8 m across the view at z, turned by `slope` = dz/dx about the line x = 0.
fn pane(z_m: f32, slope: f32, color: Vec3) -> Object {
    let corner = |x: f32, y: f32| Vec3::new(x, y, z_m + slope * x);
    let positions = vec![corner(-4.0, -4.0), corner(4.0, -4.0), corner(4.0, 4.0), corner(-4.0, 4.0)];
    let normals = vec![Vec3::Z; 4];
    let mesh = Mesh { name: "pane".to_owned(), positions, normals, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() };
    Object::new(mesh, color)
}

/// Depths of such a pane over a pixel, nearest and farthest: on the ray (x, y, -1) d lies z + slope x d = -d.
fn depths(column: u32, z_m: f64, slope: f64) -> [f64; 2] {
    let size = (f64::from(parameters().camera.vertical_fov_rad) / 2.0).tan() / (f64::from(HEIGHT) / 2.0);
    let at = |border: u32| -z_m / (1.0 + slope * (f64::from(border) - f64::from(WIDTH) / 2.0) * size);
    let [a, b] = [at(column), at(column + 1)];
    [a.min(b), a.max(b)]
}

/// Of two panes that intersect the nearer on average is seen in the share (far_max - near_min) / (sum of both
/// thicknesses) (Carpenter), as long as their depths overlap.
#[test]
fn intersecting_surfaces_share_the_pixel_by_carpenters_estimate() {
    gpu_test(|device| {
        let mut shared = 0;
        for (z_m, slope, other_z_m, other_slope) in
            [(-3.0, 0.7, -3.0, -0.7), (-3.0, 0.9, -3.1, -0.2), (-4.0, 1.5, -3.9, 1.4)]
        {
            let objects = [pane(z_m, slope, Vec3::X), pane(other_z_m, other_slope, Vec3::Y)];
            let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &objects);
            for pixel in 0..(WIDTH * HEIGHT) as usize {
                let list = &drawing.lists[pixel];
                if list.len() != 2 || list.iter().any(|f| f.mask != u32::MAX) {
                    continue; // at the panes' borders and diagonals
                }
                let column = pixel as u32 % WIDTH;
                let of = |z: f32, slope: f32| depths(column, z.into(), slope.into());
                let (red, green) = (of(z_m, slope), of(other_z_m, other_slope));
                let is_red_first = red[0] + red[1] <= green[0] + green[1];
                let (first, second) = if is_red_first { (red, green) } else { (green, red) };
                let thickness = first[1] - first[0] + second[1] - second[0];
                let seen = if second[0] >= first[1] { 1.0 } else { ((second[1] - first[0]) / thickness).min(1.0) };
                shared += usize::from(seen < 0.99);
                let expected = if is_red_first { [seen, 1.0 - seen] } else { [1.0 - seen, seen] };
                let found = drawing.color(pixel);
                let error = (found.x - expected[0]).abs().max((found.y - expected[1]).abs());
                assert!(error < 2e-3, "pixel {pixel}: {found} for {expected:?}");
            }
        }
        assert!(shared > 100, "{shared} pixels show both");
    });
}

/// Figure 4's three planes, and an ellipsoid: at every pixel the opacity is the solid texture's density there, where it varies
/// little within a pixel.
#[test]
fn surface_defined_gases_are_as_opaque_as_their_texture() {
    gpu_test(|device| {
        let texture = |function, opaque, power| SolidTexture {
            function,
            opaque,
            power,
            scale_per_m: 0.35,
            offset: Vec3::new(4.2, 1.7, 9.1),
        };
        let gas = |mesh: Mesh, texture| Object { gas: Some(texture), opacity: 0.9, ..Object::new(mesh, Vec3::ONE) };
        let turn = |z: f32| Mat4::from_rotation_translation(Quat::from_rotation_x(1.4), Vec3::Z * z);
        let plane = |z: f32| shapes::plane(Vec2::splat(9.0), UVec2::ONE).transformed(&turn(z));
        let squeeze =
            Mat4::from_scale_rotation_translation(Vec3::new(0.7, 0.4, 0.5), Quat::IDENTITY, Vec3::NEG_Z * 3.5);
        let ellipsoid = shapes::sphere(10, 6).transformed(&squeeze);
        let clouds = DensityFunction::Clouds { frequency: 4.0 };
        let objects = [
            gas(plane(-4.5), texture(clouds, 0.9, 1.0)),
            gas(plane(-5.0), texture(clouds, 1.0, 3.0)),
            gas(plane(-5.5), texture(DensityFunction::Turbulence, 1.4, 2.0)),
            gas(ellipsoid, texture(DensityFunction::Turbulence, 1.2, 1.5)),
        ];
        let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &objects);
        let scene = parameters();
        let rays = Rays::new(&scene, 0);
        let triangles: Vec<[DVec3; 3]> = objects
            .iter()
            .flat_map(|o| {
                o.mesh.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|i| o.mesh.positions[t[i] as usize].as_dvec3()))
            })
            .collect();
        let mut counts = [0; 4];
        for (pixel, list) in drawing.lists.iter().enumerate() {
            for fragment in list.iter().filter(|f| f.coverage == 1.0) {
                let [a, b, c] = triangles[fragment.triangle as usize];
                let normal = (b - a).cross(c - a);
                let pixel = pixel as u32;
                let ray = rays.direction(f64::from(pixel % WIDTH) + 0.5, f64::from(pixel / WIDTH) + 0.5);
                let point = ray * (normal.dot(a) / normal.dot(ray));
                let texture = objects[fragment.object as usize].gas.unwrap();
                let expected = 0.9 * rays.medium.texture_density(&texture, None, point).clamp(0.0, 1.0);
                let error = (f64::from(fragment.opacity) - expected).abs();
                assert!(error < 2e-4, "{fragment:?}: {expected} at {point}");
                counts[fragment.object as usize] += 1;
            }
        }
        assert!(counts.iter().all(|&c| c > 25), "{counts:?}");
    });
}

/// The picture in bands of a few rows is that of all rows at once, bit for bit.
#[test]
fn a_picture_in_bands_is_the_picture_at_once() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Fig6);
        for variant in [Variant::NoVolume, Variant::Traced, Variant::Table] {
            let whole = Drawing::of(device, variant, &parameters, &objects);
            assert_eq!(whole.demand.rows, parameters.height);
            let bound = Parameters { list_bytes: Some(40_000), ..parameters.clone() };
            let banded = Drawing::of(device, variant, &bound, &objects);
            assert!((1..7).contains(&banded.demand.rows), "{:?}", banded.demand);
            assert!(banded.radiance == whole.radiance, "{variant:?}");
        }
    });
}

/// Rows alone have the pixels of the whole, and no row's lists but theirs are made.
#[test]
fn some_rows_are_those_of_the_picture() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Fig6);
        let row_bytes = 4 * parameters.width as usize;
        for (lists, list_bytes) in [(Lists::Linked, None), (Lists::Tiles, None), (Lists::Nearest(8), Some(40_000))] {
            let parameters = Parameters { lists, list_bytes, ..parameters.clone() };
            let shaders = shaders_by(device, Compiler::Glslang);
            let mut recorder = Recorder::new(device).unwrap();
            let mut drawn = |rows: Option<Range<u32>>| {
                let mut gas = Gas::new(&shaders, "test", Variant::Table, &parameters, &objects, None).unwrap();
                rows.into_iter().for_each(|rows| gas.keep_rows(rows));
                loop {
                    recorder.run(Mode::Plain, |frame| gas.record_picture(frame, 0)).unwrap();
                    if gas.settle(&shaders).unwrap() {
                        break;
                    }
                }
                let picture = read_image(device, gas.picture()).unwrap();
                (picture, gas.demand(&shaders).unwrap().fragments, gas.lost_pixels())
            };
            let (whole, all_fragments, all_lost) = drawn(None);
            let third = parameters.height / 3;
            let (mut most_fragments, mut lost) = (0, 0);
            for rows in [0..third, third..third + 1, third + 1..parameters.height] {
                let (picture, fragments, lost_pixels) = drawn(Some(rows.clone()));
                let kept = rows.start as usize * row_bytes..rows.end as usize * row_bytes;
                assert!(picture[kept.clone()] == whole[kept], "{lists:?} {rows:?}");
                // The demand is that of a band: only without bands can it be compared.
                if list_bytes.is_none() {
                    let share = if rows.len() == 1 { 8 } else { 1 };
                    assert!(share * fragments <= all_fragments, "{lists:?} {rows:?}: {fragments} of {all_fragments}");
                }
                most_fragments = most_fragments.max(fragments);
                lost += lost_pixels.unwrap_or_default();
            }
            assert!(most_fragments > 0 && lost == all_lost.unwrap_or_default(), "{lists:?}: {lost} of {all_lost:?}");
        }
    });
}

/// 4096 x 4096 pixels are done in bands: across a border between two of them, and in the first and the last, rows are those that are
/// drawn alone, in a band of their own.
#[test]
fn a_picture_of_4096_by_4096_is_done_in_bands() {
    const SIDE: u32 = 4096;
    gpu_test(|device| {
        let panes = [pane(-3.0, 0.7, Vec3::X), Object { opacity: 0.4, ..pane(-2.5, -0.3, Vec3::Y) }];
        let parameters = Parameters { width: SIDE, height: SIDE, list_bytes: Some(32 << 20), ..parameters() };
        let shaders = shaders_by(device, Compiler::Glslang);
        let mut gas = Gas::new(&shaders, "test", Variant::NoVolume, &parameters, &panes, None).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut draw = |rows: Range<u32>| {
            gas.keep_rows(rows.clone());
            recorder.run(Mode::Plain, |frame| gas.record_picture(frame, 0)).unwrap();
            assert!(gas.settle(&shaders).unwrap());
            let row_bytes = 4 * SIDE as usize;
            let picture = read_image(device, gas.picture()).unwrap();
            let kept = rows.start as usize * row_bytes..rows.end as usize * row_bytes;
            (picture[kept].to_vec(), gas.demand(&shaders).unwrap().rows)
        };
        let (whole, rows) = draw(0..SIDE);
        assert!(rows < SIDE / 8, "{rows} rows at once");
        let colors: std::collections::BTreeSet<&[u8]> = whole.chunks_exact(4).step_by(997).collect();
        assert!(colors.len() > 2, "{colors:?}");
        for alone in [0..3, rows - 2..rows + 2, SIDE - 3..SIDE] {
            let place = [alone.start, alone.end].map(|row| row as usize * 4 * SIDE as usize);
            assert!(draw(alone.clone()).0 == whole[place[0]..place[1]], "rows {alone:?}");
        }
    });
}

/// Lists that no buffer holds make the bands smaller; of one row they end the run, naming what allows more.
#[test]
fn bands_shrink_until_their_lists_fit() {
    gpu_test(|device| {
        let sheets: Vec<Object> =
            (0..9).map(|i| Object { opacity: 0.2, ..pane(-2.0 - 0.3 * i as f32, 0.1, Vec3::ONE) }).collect();
        let expected = Drawing::of(device, Variant::NoVolume, &parameters(), &sheets);
        let bound = |bytes| Parameters { list_bytes: Some(bytes), ..parameters() };
        let banded = Drawing::of(device, Variant::NoVolume, &bound(30_000), &sheets);
        // Four fragments a pixel would be ten rows; there are nine.
        assert!((1..5).contains(&banded.demand.rows), "{:?}", banded.demand);
        assert!(banded.radiance == expected.radiance);
        let shaders = shaders_by(device, Compiler::Glslang);
        let mut gas = Gas::new(&shaders, "test", Variant::NoVolume, &bound(4096), &sheets, None).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let error = loop {
            recorder.run(Mode::Plain, |frame| gas.record(frame, 0)).unwrap();
            match gas.settle(&shaders) {
                Ok(is_settled) => assert!(!is_settled),
                Err(error) => break error,
            }
        };
        let told = "and `list-bytes` allows 4096; raise `list-bytes` or lower `size`";
        assert!(matches!(error, Error::Filling { .. }) && error.to_string().ends_with(told), "{error}");
    });
}

/// lavapipe, as if it had no geometry stages.
fn without_geometry_stages(device: &Arc<Device>) -> Arc<Device> {
    let devices = PhysicalDevice::enumerate(device.instance()).unwrap();
    let same = devices.into_iter().find(|d| d.uuid == device.physical().uuid).unwrap();
    Device::open(device.instance(), same.without(Feature::GeometryShader)).unwrap()
}

/// Vertex pulling makes the footprints that a geometry stage makes, those cut by the hither plane among them.
#[test]
fn a_device_without_geometry_stages_draws_the_same() {
    gpu_test_alone(|device| {
        let lesser = without_geometry_stages(device);
        for preset in [Preset::Fig6, Preset::Fig4] {
            let (mut parameters, objects) = small(preset);
            // Cuts through the floor and what stands on it.
            parameters.camera.near_m = 4.0;
            let frame = preset.bench_frame();
            let draw = |device, parameters: &Parameters| {
                Drawing::frame(device, Compiler::Glslang, preset.variant(), parameters, &objects, frame)
            };
            let expected = draw(device, &parameters);
            let pulled = draw(&lesser, &parameters);
            assert!(pulled.lists == expected.lists && pulled.radiance == expected.radiance, "{preset:?}");
            let chosen = draw(device, &Parameters { geometry_stage: false, ..parameters });
            assert!(chosen.lists == expected.lists && chosen.radiance == expected.radiance, "{preset:?}");
        }
    });
}

#[test]
fn a_missing_geometry_stage_is_told() {
    gpu_test_alone(|device| {
        let lesser = without_geometry_stages(device);
        let warnings = |device: &Arc<Device>, geometry_stage| {
            let shaders = shaders_by(device, Compiler::Glslang);
            let parameters = Parameters { geometry_stage, volumes: vec![default_volume()], ..parameters() };
            Gas::new(&shaders, "test", Variant::None, &parameters, &[], None).unwrap().warnings()
        };
        assert!(warnings(device, true).is_empty() && warnings(device, false).is_empty());
        let told = warnings(&lesser, true);
        assert!(told.len() == 1 && told[0].contains("no geometry stage"), "{told:?}");
    });
}
