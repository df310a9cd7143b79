//! Scenes of more than one map, and cameras in odd places.

use std::f64::consts::TAU;
use std::sync::Arc;

use fumarole::papers::terrain::{
    Base, Drape, Inputs, Lod, MapInput, Parameters, Placement, Rays, Sun, Surface, Variant, View,
};
use fumarole::scene::{Camera, Mesh, Samples, shapes};
use glam::{DVec2, Mat4, Vec2, Vec3};

use super::drawing::Drawing;
use super::maps::{alone, map, volcano};
use super::variants::{assert_agree, small};
use crate::common::gpu_test;

const VARIANTS: [Variant; 7] = [
    Variant::GpuCompute,
    Variant::GpuFragment,
    Variant::Cpu,
    Variant::Mesh,
    Variant::DdaCompute,
    Variant::DdaFragment,
    Variant::DdaCpu,
];

fn camera(eye: Vec3, target: Vec3) -> View {
    let up = Vec3::Y;
    View::Camera(Camera { eye, target, up, vertical_fov_rad: 0.8, near_m: 1.0, far_m: 1.0e6 })
}

/// A level map of 20 x 20 cells of 10 m, `height_m` high over its base.
fn table(height_m: f32) -> fumarole::scene::HeightMap {
    map(21, 21, Samples::Float(vec![height_m; 21 * 21]), 10.0)
}

#[test]
fn extreme_cameras_see_what_is_there() {
    gpu_test(|device| {
        let maps = alone(volcano(64));
        let cases = [
            ("straight down", Vec3::new(100.0, 5000.0, 50.0), Vec3::new(100.0, 0.0, 50.0), Surface::Terrain),
            (
                "straight up from the ground",
                Vec3::new(2000.0, 2500.0, 0.0),
                Vec3::new(2000.0, 9000.0, 0.0),
                Surface::Sky,
            ),
            ("inside the mountain", Vec3::new(0.0, 200.0, 600.0), Vec3::new(0.0, 200.0, -5000.0), Surface::Inside),
            ("below the base", Vec3::new(0.0, -50.0, 0.0), Vec3::new(0.0, 500.0, 10.0), Surface::Base),
            ("far outside", Vec3::new(0.0, 60_000.0, 200_000.0), Vec3::new(0.0, 300.0, 0.0), Surface::Terrain),
        ];
        for (name, eye, target, expected) in cases {
            for lod in [Lod::Exact, Lod::Pixel] {
                let parameters = Parameters { view: camera(eye, target), ..small(View::Side, lod) };
                for variant in [Variant::GpuCompute, Variant::Cpu] {
                    let drawing = Drawing::of(device, variant, &parameters, &maps);
                    let middle = drawing.hits[60 * 160 + 80];
                    assert_eq!(middle.surface, expected, "{name} {lod:?} {variant:?}: {middle:?}");
                    let is_at_once = matches!(expected, Surface::Inside | Surface::Base);
                    assert!(!is_at_once || middle.depth_m == 0.0, "{name}: {middle:?}");
                    assert!(drawing.normals.iter().flatten().all(|c| c.is_finite()), "{name}: a normal is no number");
                }
            }
        }
    });
}

#[test]
fn maps_are_united_and_turned() {
    gpu_test(|device| {
        let place = |x: f64, z: f64, yaw_rad: f64| Placement { center_m: DVec2::new(x, z), yaw_rad };
        let low = Arc::new(table(30.0));
        let high = Arc::new(table(80.0));
        let maps = [
            MapInput { map: low.clone(), placement: place(0.0, 0.0, 0.0) },
            MapInput { map: high, placement: place(150.0, 0.0, 0.3) },
            MapInput { map: low, placement: place(-400.0, 100.0, 0.0) },
        ];
        let eye = Vec3::new(0.0, 900.0, 0.0);
        let view = View::Camera(Camera {
            eye,
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            vertical_fov_rad: 0.8,
            near_m: 1.0,
            far_m: 1.0e6,
        });
        let parameters = Parameters { view, base_level_m: Some(0.0), ..small(View::Top, Lod::Exact) };
        let drawings = VARIANTS.map(|variant| Drawing::of(device, variant, &parameters, &maps));
        // The rays' own pixel that looks at a place on a level.
        let seen = |drawing: &Drawing, x: f32, y_m: f32, z: f32| {
            let scale = 120.0 / (2.0 * (0.4f32).tan()) / (900.0 - y_m);
            let (column, row) = ((80.0 + x * scale) as usize, (60.0 + z * scale) as usize);
            let hit = drawing.hits[row * 160 + column];
            (hit.surface, 900.0 - hit.depth_m)
        };
        for (variant, drawing) in VARIANTS.iter().zip(&drawings) {
            let near = |(surface, y_m): (Surface, f32), expected: Surface, expected_m: f32| {
                assert_eq!(surface, expected, "{variant:?}");
                assert!((y_m - expected_m).abs() < 0.5, "{variant:?}: {y_m} m, not {expected_m}");
            };
            near(seen(drawing, -50.0, 30.0, 0.0), Surface::Terrain, 30.0);
            // Where two maps lie, the higher one is seen.
            near(seen(drawing, 80.0, 80.0, 10.0), Surface::Terrain, 80.0);
            near(seen(drawing, 0.0, 0.0, 200.0), Surface::Base, 0.0);
            // Turned counterclockwise seen from above, the map's eastern corners move north.
            let (c, s) = (0.3f32.cos(), 0.3f32.sin());
            near(seen(drawing, 150.0 + 95.0 * c + 60.0 * s, 80.0, -95.0 * s + 60.0 * c), Surface::Terrain, 80.0);
        }
        for (variant, drawing) in VARIANTS.iter().zip(&drawings).skip(1).take(2) {
            assert_agree(&format!("{variant:?}"), &drawings[0], drawing);
        }
    });
}

/// A tower of 80 m on the western edge of a plain, the sun low in the west: its shadow is as long as it must be.
#[test]
fn shadows_are_as_long_as_the_sun_is_low() {
    gpu_test(|device| {
        let heights = (0..61 * 61).map(|i| if i % 61 < 6 { 80.0 } else { 0.0 }).collect();
        let maps = alone(map(61, 61, Samples::Float(heights), 5.0));
        let sun = Sun { azimuth_rad: 270f32.to_radians(), elevation_rad: 30f32.to_radians() };
        for lod in [Lod::Exact, Lod::Pixel] {
            let parameters = Parameters { shadows: true, sun, ..small(View::Top, lod) };
            for variant in VARIANTS {
                let drawing = Drawing::of(device, variant, &parameters, &maps);
                assert!(drawing.passes.contains(&"shadow"));
                // Of the plain, the columns from 6 to about 5 + 80 / tan(30) / 5 = 33 lie in the shadow.
                let brightness = |from: f32, to: f32| {
                    let pixels = drawing.hits.iter().zip(drawing.picture.pixels().chunks_exact(4));
                    let on = pixels.filter(|(hit, _)| {
                        hit.surface == Surface::Terrain && (from..to).contains(&hit.place[0]) && hit.place[1] > 5.0
                    });
                    let values: Vec<f64> = on.map(|(_, pixel)| f64::from(pixel[0])).collect();
                    assert!(
                        values.len() > 50,
                        "{variant:?} {lod:?}: {} pixels between columns {from} and {to}",
                        values.len()
                    );
                    let (low, high) = values.iter().fold((255.0f64, 0.0f64), |(l, h), v| (l.min(*v), h.max(*v)));
                    assert!(high - low < 20.0, "{variant:?} {lod:?}: {low} to {high} between columns {from} and {to}");
                    low
                };
                let (shadow, sunlit) = (brightness(9.0, 30.0), brightness(36.0, 58.0));
                assert!(sunlit > shadow + 30.0, "{variant:?} {lod:?}: {sunlit} in the sun, {shadow} in the shadow");
            }
        }
    });
}

/// A sphere half in the ground: below the ground it is hidden, above it hides the ground.
#[test]
fn objects_and_terrain_hide_each_other() {
    gpu_test(|device| {
        let maps = alone(table(40.0));
        let sphere = shapes::sphere(48, 48);
        let size = sphere.bounds().diagonal().max_element();
        let scaled = |radius_m: f32, place: Vec3| -> Mesh {
            let scale = Mat4::from_scale(Vec3::splat(2.0 * radius_m / size));
            sphere.transformed(&(Mat4::from_translation(place) * scale))
        };
        let objects = [scaled(30.0, Vec3::new(0.0, 40.0, 0.0)), scaled(15.0, Vec3::new(60.0, 20.0, 0.0))];
        let inputs = Inputs { maps: &maps, objects: &objects, ..Inputs::default() };
        for variant in VARIANTS {
            let parameters = Parameters { base_level_m: Some(0.0), ..small(View::Top, Lod::Exact) };
            let with = Drawing::with(device, variant, &parameters, &inputs);
            let without = Drawing::of(device, variant, &parameters, &maps);
            assert!(with.passes.ends_with(&["object-depth", "objects"]), "{:?}", with.passes);
            let pixels = with.picture.pixels().chunks_exact(4).zip(without.picture.pixels().chunks_exact(4));
            let changed: Vec<usize> = pixels.enumerate().filter(|(_, (a, b))| a != b).map(|(i, _)| i).collect();
            // The disc of the first sphere, and nothing of the second, which is buried.
            let ground = without.hits[60 * 160 + 80].depth_m;
            let Some(camera) = camera_of(&without) else { panic!("no ground is seen") };
            let radius = 30.0 * camera / ground;
            let expected = std::f32::consts::PI * radius * radius;
            let fraction = changed.len() as f32 / expected;
            assert!((0.9..1.1).contains(&fraction), "{variant:?}: {} pixels, {expected} expected", changed.len());
            assert!(
                changed.iter().all(|i| ((i % 160) as f32 - 79.5).hypot((i / 160) as f32 - 59.5) < radius * 1.1 + 1.0)
            );
        }
    });
}

/// Pixels for a metre at a depth of a metre, from the places of two pixels.
fn camera_of(drawing: &Drawing) -> Option<f32> {
    let (a, b) = (drawing.hits[60 * 160 + 70], drawing.hits[60 * 160 + 90]);
    let is_ground = a.surface == Surface::Terrain && b.surface == Surface::Terrain;
    is_ground.then(|| 20.0 * a.depth_m / ((b.place[0] - a.place[0]) * 10.0))
}

/// Four quarters of a picture over a level map.
#[test]
fn a_drape_lies_with_its_corners_on_the_maps() {
    gpu_test(|device| {
        let maps = alone(table(0.0));
        let colors = [[200, 40, 40, 255], [40, 200, 40, 255], [40, 40, 200, 255], [200, 200, 40, 255]];
        let texels = (0..64u32).map(|i| colors[(i % 8 / 4 + 2 * (i / 8 / 4)) as usize]).collect();
        let drape = Drape::new(8, 8, texels).unwrap();
        let inputs = Inputs { maps: &maps, drape: Some(&drape), ..Inputs::default() };
        let parameters = Parameters { haze_per_km: Some(0.0), ..small(View::Top, Lod::Exact) };
        for variant in VARIANTS {
            let drawing = Drawing::with(device, variant, &parameters, &inputs);
            for (hit, pixel) in drawing.hits.iter().zip(drawing.picture.pixels().chunks_exact(4)) {
                let off_middle = hit.place.iter().all(|c| (c - 10.0).abs() > 2.0);
                if hit.surface == Surface::Terrain && off_middle {
                    let quarter = usize::from(hit.place[0] > 10.0) + 2 * usize::from(hit.place[1] > 10.0);
                    let order = |c: &[u8]| [c[0], c[1], c[2]].map(|channel| channel > 120);
                    assert_eq!(order(pixel), order(&colors[quarter]), "{variant:?}: {pixel:?} at {:?}", hit.place);
                }
            }
        }
        assert!(Drape::new(8, 8, vec![[0; 4]; 63]).is_err());
    });
}

/// A picture with a place of its own covers that and nothing else.
#[test]
fn a_placed_drape_ends_at_its_border() {
    gpu_test(|device| {
        let maps = alone(table(0.0));
        let parameters = Parameters { haze_per_km: Some(0.0), ..small(View::Top, Lod::Exact) };
        // The east half green, the west half red; the south-west corner lies beside the map.
        let texels = (0..32).map(|i| if i % 8 < 4 { [200, 40, 40, 255] } else { [40, 200, 40, 255] }).collect();
        let (corner, cells) = (Vec2::new(-3.0, 12.5), Vec2::new(11.0, 30.0));
        let drape = Drape::new(8, 4, texels).unwrap().placed(corner, cells);
        for variant in VARIANTS {
            let bare = Drawing::with(device, variant, &parameters, &Inputs { maps: &maps, ..Inputs::default() });
            let inputs = Inputs { maps: &maps, drape: Some(&drape), ..Inputs::default() };
            let drawing = Drawing::with(device, variant, &parameters, &inputs);
            let (mut inside, mut outside) = (0, 0);
            let pixels = drawing.picture.pixels().chunks_exact(4).zip(bare.picture.pixels().chunks_exact(4));
            for (hit, (pixel, bare)) in drawing.hits.iter().zip(pixels) {
                let fraction = (Vec2::from_array(hit.place) - corner) / cells;
                let is_near_an_edge =
                    [fraction.x, fraction.x - 0.5, fraction.x - 1.0, fraction.y].iter().any(|f| f.abs() < 0.1);
                if hit.surface != Surface::Terrain || fraction.cmplt(Vec2::ZERO).any() || fraction.x > 1.0 {
                    assert_eq!(pixel, bare, "{variant:?} at {:?}", hit.place);
                    outside += 1;
                } else if !is_near_an_edge {
                    assert_eq!(pixel[1] > pixel[0], fraction.x > 0.5, "{variant:?}: {pixel:?} at {:?}", hit.place);
                    inside += 1;
                }
            }
            assert!(inside > 100 && outside > 100, "{variant:?}: {inside} inside, {outside} outside");
        }
    });
}

/// Level maps at the very height of the base, in whatever order they come: each is seen, and the base around them.
#[test]
fn land_in_the_base_is_seen_on_every_map() {
    gpu_test(|device| {
        let places = [(-160.0, 10.0), (160.0, -40.0), (20.0, 220.0)].map(|(x, z)| DVec2::new(x, z));
        let maps = places.map(|center_m| MapInput {
            map: Arc::new(table(0.0)),
            placement: Placement { center_m, ..Placement::default() },
        });
        let View::Camera(camera) = camera(Vec3::new(33.0, 417.3, 611.7), Vec3::new(3.0, 0.0, 60.0)) else { return };
        let rays = Rays::new(&camera, 160, 120);
        // Of the pixel's middle, the metres to the nearest border of a map and the map that it is in.
        let seen = |pixel: usize| {
            let direction = rays.corner + (pixel % 160) as f64 * rays.across + (pixel / 160) as f64 * rays.down;
            let foot = rays.eye - rays.eye.y / direction.y * direction;
            let inside_m = |center_m: DVec2| 100.0 - (DVec2::new(foot.x, foot.z) - center_m).abs().max_element();
            let insides_m = places.map(inside_m);
            let border_m = insides_m.into_iter().map(f64::abs).fold(f64::INFINITY, f64::min);
            (direction.y < 0.0 && border_m > 2.0).then_some(insides_m.iter().position(|inside_m| *inside_m > 0.0))
        };
        let view = View::Camera(camera);
        let parameters = Parameters { view, base_level_m: Some(0.0), ..small(View::Side, Lod::Exact) };
        for variant in VARIANTS.into_iter().chain([Variant::TiledCompute]) {
            let drawing = Drawing::of(device, variant, &parameters, &maps);
            let (mut judged, mut wrong) = ([0; 4], 0);
            for (pixel, hit) in drawing.hits.iter().enumerate() {
                let Some(expected) = seen(pixel) else { continue };
                judged[expected.unwrap_or(3)] += 1;
                let found = (hit.surface == Surface::Terrain).then_some(hit.map as usize);
                let is_right = found == expected && (found.is_some() || hit.surface == Surface::Base && hit.map == 0);
                wrong += usize::from(!is_right);
            }
            assert!(judged.iter().all(|pixels| *pixels > 300), "{variant:?}: {judged:?}");
            assert!(wrong * 1000 <= drawing.hits.len(), "{variant:?}: {wrong} pixels of {judged:?} see something else");
        }
    });
}

/// A picture over the seam of a map that goes once round goes on beyond it.
#[test]
fn a_placed_drape_goes_on_across_the_seam() {
    gpu_test(|device| {
        let radius_m = 100.0;
        let maps = alone(map(60, 20, Samples::Float(vec![5.0; 60 * 20]), TAU * f64::from(radius_m) / 60.0));
        // From below: the map's middle is on top.
        let View::Camera(below) = camera(Vec3::new(0.0, -500.0, 0.0), Vec3::new(0.0, -200.0, 0.0)) else { return };
        let parameters = Parameters {
            base: Base::Cylinder { radius_m },
            base_level_m: Some(0.0),
            haze_per_km: Some(0.0),
            view: View::Camera(Camera { up: Vec3::Z, ..below }),
            ..small(View::Side, Lod::Exact)
        };
        // The east half green, the west half red.
        let texels = (0..32).map(|i| if i % 8 < 4 { [200, 40, 40, 255] } else { [40, 200, 40, 255] }).collect();
        let (corner, cells) = (Vec2::new(56.0, 4.0), Vec2::new(9.0, 11.0));
        let drape = Drape::new(8, 4, texels).unwrap().placed(corner, cells);
        for variant in [Variant::GpuCompute, Variant::GpuFragment, Variant::Cpu, Variant::Mesh, Variant::DdaFragment] {
            let bare = Drawing::of(device, variant, &parameters, &maps);
            let inputs = Inputs { maps: &maps, drape: Some(&drape), ..Inputs::default() };
            let drawing = Drawing::with(device, variant, &parameters, &inputs);
            let pixels = drawing.picture.pixels().chunks_exact(4).zip(bare.picture.pixels().chunks_exact(4));
            let (mut before, mut beyond, mut outside) = (0, 0, 0);
            for (hit, (pixel, bare)) in drawing.hits.iter().zip(pixels) {
                // Two columns more on each side repeat those of the other.
                let place = Vec2::from_array(hit.place) - Vec2::new(2.0, 0.0) - corner;
                let fraction = Vec2::new(place.x.rem_euclid(60.0), place.y) / cells;
                let edges = [fraction.x, fraction.x - 0.5, fraction.x - 1.0, fraction.y, fraction.y - 1.0];
                if edges.iter().any(|off| off.abs() < 0.1) {
                    continue;
                }
                let is_over = fraction.cmpgt(Vec2::ZERO).all() && fraction.cmplt(Vec2::ONE).all();
                if hit.surface != Surface::Terrain || !is_over {
                    assert_eq!(pixel, bare, "{variant:?} at {:?}", hit.place);
                    outside += usize::from(hit.surface == Surface::Terrain);
                    continue;
                }
                assert_eq!(pixel[1] > pixel[0], fraction.x > 0.5, "{variant:?}: {pixel:?} at {:?}", hit.place);
                if place.x < 0.0 { beyond += 1 } else { before += 1 }
            }
            let name = format!("{variant:?}: {before} before, {beyond} beyond the seam, {outside} outside");
            assert!(before > 30 && beyond > 30 && outside > 100, "{name}");
        }
    });
}
