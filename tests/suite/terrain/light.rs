//! The passes `shadow` and `illumination` against the oracle, and objects in the terrain's light.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Variant as _;
use fumarole::measure::parameter::Choice;
use fumarole::papers::terrain::reference::{is_lit, lambert};
use fumarole::papers::terrain::{
    Base, Drape, Inputs, Interpolation, Lod, MapInput, Parameters, Placement, Rays, Sun, Surface, Variant, View,
};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap, Samples, shapes};
use glam::{DVec2, DVec3, Mat4, Vec3};

use super::drawing::{Drawing, Painter, differing};
use super::maps::{self, map};
use super::ridges::{self, lens};
use super::world::{Relief, Stand, World, random_map};
use crate::common::gpu_test;

const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 900.0 }, Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 }];
const SIZE: (u32, u32) = (48, 36);

/// Distance by which single precision moves a ray, cells.
const HAIR_CELLS: f64 = 2e-3;

#[test]
fn shadows_fall_where_the_oracle_s_rays_meet_a_map() {
    gpu_test(|device| {
        for (seed, base) in (40..).zip(BASES) {
            for &interpolation in Interpolation::ALL {
                let mut random = Random::new(seed);
                let map = random_map(&mut random, Relief::Waves, (61, 44), 6.0);
                let world = World::alone("waves", base, interpolation, None, map);
                let azimuth_rad = random.range(0.0, 6.2);
                let sun = Sun { azimuth_rad, elevation_rad: random.range(0.2, 0.5) };
                let cameras = [Stand::Above, Stand::Hovering].map(|stand| world.camera(stand, &mut random));
                assert_shadows(device, &world, Lod::Exact, sun, cameras);
            }
        }
    });
}

/// As long as a pixel is smaller than a cell.
#[test]
fn shadows_of_rough_land_fall_at_every_level_of_detail() {
    gpu_test(|device| {
        let mut random = Random::new(47);
        for base in ridges::BASES {
            for &interpolation in Interpolation::ALL {
                let map = maps::ridges(&mut random, (129, 97), 3000.0);
                let world = World::alone("ridges", base, interpolation, None, map);
                let near = lens(&world, DVec2::new(0.05, 0.1), 60.0, DVec2::new(0.4, 0.5), 0.25);
                let across = lens(&world, DVec2::new(0.95, 0.9), 400.0, DVec2::new(0.3, 0.2), 0.25);
                let sun = Sun { azimuth_rad: random.range(0.0, 6.2), elevation_rad: random.range(0.2, 0.5) };
                for &lod in Lod::ALL {
                    assert_shadows(device, &world, lod, sun, [near, across]);
                }
            }
        }
    });
}

/// However far apart its columns are: the shadow of a wall falls along them.
#[test]
fn a_wall_s_shadow_is_as_long_whatever_the_spacing_across_it() {
    gpu_test(|device| {
        let heights: Vec<f32> =
            (0..33 * 257).map(|at| if (120..=126).contains(&(at / 33)) { 8.0 } else { 0.0 }).collect();
        let draw = |across_m: f64, variant| {
            let map = HeightMap::new(33, 257, Samples::Float(heights.clone())).unwrap();
            let map = map.with_spacing_m(DVec2::new(across_m, 1.0)).unwrap();
            let world = World::alone("wall", Base::Plane, Interpolation::Bilinear, None, map);
            let camera = lens(&world, DVec2::new(0.5, 0.75), 60.0, DVec2::new(0.5, 0.52), 0.25);
            let sun = Sun { azimuth_rad: 0.0, elevation_rad: 0.5 };
            let parameters = Parameters { shadows: true, sun, lod: Lod::Exact, ..world.parameters(camera, SIZE) };
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs).from(camera)
        };
        let dark = |drawing: &Drawing| drawing.sunlit.iter().filter(|&&light| light == 0.0).count();
        let square = dark(&draw(1.0, Variant::GpuCompute));
        assert!(square > 40, "{square}");
        for across_m in [16.0, 100.0] {
            let compute = draw(across_m, Variant::GpuCompute);
            let found = dark(&compute);
            assert!(found.abs_diff(square) * 8 <= square, "{found} at {across_m} m, {square} at 1 m");
            for variant in [Variant::Cpu, Variant::DdaCompute, Variant::DdaCpu] {
                let differing = differing(&compute, &draw(across_m, variant));
                assert!(differing * 200 <= compute.hits.len(), "{variant:?} at {across_m} m: {differing}");
            }
        }
    });
}

/// Rays to the sun start a texel away from what is seen. Lifted by a hair they must be free where the device sees the sun, and
/// lowered by a hair they must meet a map where it sees none.
fn assert_shadows(device: &Arc<Device>, world: &World, lod: Lod, sun: Sun, cameras: [Camera; 2]) {
    let spacing_m = world.maps[0].map.spacing_m();
    let to_sun = world.turned(sun.direction().as_dvec3());
    let texel_m = match world.base {
        Base::Plane => {
            (1.0 / (to_sun.x / spacing_m.x).abs().max((to_sun.z / spacing_m.y).abs())).min(spacing_m.max_element())
        }
        _ => spacing_m.max_element(),
    };
    let parameters = Parameters { shadows: true, sun, lod, ..world.parameters(cameras[0], SIZE) };
    let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
    let paint = |variant| Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs);
    let mut painters = [Variant::GpuCompute, Variant::GpuFragment, Variant::Cpu].map(paint);
    let mut dda = [Variant::DdaCompute, Variant::DdaFragment, Variant::DdaCpu].map(paint);
    let name = format!("{} {:?} {:?} {lod:?}", world.name, world.base, world.interpolation);
    let (mut lit, mut dark) = (0, 0);
    for camera in cameras {
        let rays = Rays::new(&camera, SIZE.0, SIZE.1);
        let [compute, fragment, cpu] = painters.each_mut().map(|painter| painter.from(camera));
        for (pixel, (hit, sunlit)) in compute.hits.iter().zip(&compute.sunlit).enumerate().step_by(5) {
            if hit.surface == Surface::Sky {
                assert_eq!(*sunlit, 1.0);
                continue;
            }
            let (x, y) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
            let direction = rays.corner + f64::from(x) * rays.across + f64::from(y) * rays.down;
            let depth_m = f64::from(hit.depth_m);
            let start = world.moved(rays.eye + depth_m * direction) + (texel_m + 1e-5 * depth_m) * to_sun;
            let up = world.terrain.base.frame(world.terrain.base.place(start)).normal;
            let moved = |cells: f64| start + cells * world.cell_m() * up;
            if *sunlit == 1.0 {
                lit += 1;
                let is_free = is_lit(&world.terrain, moved(HAIR_CELLS), to_sun);
                assert!(is_free, "{name}: pixel {pixel}, {hit:?} in the sun");
            } else {
                dark += 1;
                let meets = !is_lit(&world.terrain, moved(-HAIR_CELLS), to_sun);
                assert!(meets, "{name}: pixel {pixel}, {hit:?} in the shadow");
            }
        }
        let dda = dda.iter_mut().map(|painter| ("dda", painter.from(camera)));
        for (other, drawing) in [("fragment", fragment), ("cpu", cpu)].into_iter().chain(dda) {
            let differing = differing(&compute, &drawing);
            assert!(differing * 200 <= drawing.hits.len(), "{name}: {other} {differing}");
        }
    }
    assert!(lit > 40 && dark > 5, "{name}: {lit} in the sun, {dark} in the shadow");
}

/// Of the sun and of the sky from above, linear, and the haze at a great distance.
const SUNLIGHT: DVec3 = DVec3::new(2.0, 1.88, 1.7);
const SKYLIGHT: DVec3 = DVec3::new(0.55 * 0.45, 0.68 * 0.45, 0.9 * 0.45);
const HAZE: DVec3 = DVec3::new(0.42, 0.53, 0.66);

/// A terrain of one grey, so that all that is seen is light: Lambert's of the sun, half of the sky's on a wall, and haze.
#[test]
fn a_grey_land_shows_the_light_alone() {
    gpu_test(|device| {
        let drape = Drape::new(1, 1, vec![[128, 128, 128, 255]]).unwrap();
        let grey = ((128.0 / 255.0 + 0.055) / 1.055_f64).powf(2.4);
        for (seed, base) in (50..).zip(BASES) {
            let mut random = Random::new(seed);
            let map = random_map(&mut random, Relief::Waves, (61, 44), 6.0);
            let world = World::alone("grey", base, Interpolation::Bilinear, None, map);
            let camera = world.camera(Stand::Above, &mut random);
            let rays = Rays::new(&camera, SIZE.0, SIZE.1);
            let sun = Sun { azimuth_rad: random.range(0.0, 6.2), elevation_rad: 0.6 };
            let to_sun = sun.direction().as_dvec3();
            // So that half of the light comes from the haze at the length of the map.
            for haze_per_km in [0.0, (700.0 / world.side_m()) as f32] {
                let parameters = Parameters { sun, haze_per_km: Some(haze_per_km), ..world.parameters(camera, SIZE) };
                let inputs = Inputs { maps: &world.maps, drape: Some(&drape), ..Inputs::default() };
                for variant in [Variant::GpuCompute, Variant::GpuFragment, Variant::Cpu] {
                    let drawing = Drawing::with(device, variant, &parameters, &inputs);
                    let mut seen = 0;
                    let pixels = drawing.picture.pixels().as_chunks::<4>().0.iter();
                    for (pixel, ((found, hit), normal)) in pixels.zip(&drawing.hits).zip(&drawing.normals).enumerate() {
                        if hit.surface != Surface::Terrain {
                            continue;
                        }
                        let (x, y) = (pixel as u32 % SIZE.0, pixel as u32 / SIZE.0);
                        let direction = rays.corner + f64::from(x) * rays.across + f64::from(y) * rays.down;
                        let normal = DVec3::new(normal[0].into(), normal[1].into(), normal[2].into());
                        let place = world.moved(rays.eye + f64::from(hit.depth_m) * direction);
                        let up = world.terrain.base.frame(world.terrain.base.place(place)).normal;
                        let open = (1.0 + world.turned(normal).dot(up)) / 2.0;
                        let light = grey * (SUNLIGHT * lambert(normal, to_sun) + SKYLIGHT * open);
                        let distance_km = f64::from(hit.depth_m) * direction.length() / 1000.0;
                        let linear = HAZE.lerp(light, (-f64::from(haze_per_km) * distance_km).exp());
                        let encoded = linear.min(DVec3::ONE).to_array().map(|c| {
                            255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
                        });
                        for (found, expected) in found.iter().zip(encoded) {
                            let off = (f64::from(*found) - expected).abs();
                            assert!(off <= 1.0, "{base:?} {variant:?} {haze_per_km}: {found}, not {expected}");
                        }
                        seen += 1;
                    }
                    assert!(seen > 300, "{base:?} {variant:?}: only {seen} pixels of terrain");
                }
            }
        }
    });
}

/// A level map of `columns` x 61 samples, 5 m apart, its middle at `x` metres east.
fn level(columns: u32, height_m: f32, x: f64) -> MapInput {
    let heights = vec![height_m; columns as usize * 61];
    let map: HeightMap = map(columns, 61, Samples::Float(heights), 5.0);
    MapInput { map: Arc::new(map), placement: Placement { center_m: DVec2::new(x, 0.0), ..Placement::default() } }
}

/// A ridge of 80 m in the west, a map of its own, and the sun low behind it: on a post in the plain the shadow ends where the
/// line from the ridge to the sun says.
#[test]
fn objects_stand_in_the_terrain_s_shadow() {
    gpu_test(|device| {
        let maps = [level(61, 1.0, 0.0), level(6, 80.0, -137.5)];
        let sun = Sun { azimuth_rad: 270f32.to_radians(), elevation_rad: 30f32.to_radians() };
        // Its western face stands 63 m behind the ridge's edge.
        let post = Mat4::from_translation(Vec3::new(-60.0, 40.0, 0.0)) * Mat4::from_scale(Vec3::new(2.0, 40.0, 20.0));
        let objects = [shapes::cuboid().transformed(&post)];
        let edge_m = 80.0 - 63.0 * 30f64.to_radians().tan();
        let camera = Camera {
            eye: Vec3::new(-220.0, 300.0, 0.0),
            target: Vec3::new(-62.0, 20.0, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.5,
            near_m: 1.0,
            far_m: 1e5,
        };
        let (width, height) = (160, 120);
        let rays = Rays::new(&camera, width, height);
        let inputs = Inputs { maps: &maps, objects: &objects, ..Inputs::default() };
        for &variant in Variant::ALL {
            for &lod in Lod::ALL {
                let view = View::Camera(camera);
                let base_level_m = Some(0.0);
                let of = |shadows| {
                    let parameters =
                        Parameters { lod, view, sun, base_level_m, shadows, width, height, ..Parameters::default() };
                    Drawing::with(device, variant, &parameters, &inputs)
                };
                let (with, without) = (of(true), of(false));
                assert!(with.passes.ends_with(&[
                    "object-depth",
                    "object-hits",
                    "object-shadow",
                    "object-occlusion",
                    "objects"
                ]));
                let last = if variant.is_host() { "show" } else { "illumination" };
                assert!(without.passes.ends_with(&[last, "object-depth", "objects"]), "{:?}", without.passes);
                let (mut lit, mut dark) = (0, 0);
                let pictures = [&with, &without].map(|drawing| drawing.picture.pixels().as_chunks::<4>().0);
                for (pixel, (with, without)) in pictures[0].iter().zip(pictures[1]).enumerate() {
                    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
                    let direction = rays.corner + f64::from(x) * rays.across + f64::from(y) * rays.down;
                    let place = rays.eye + (-62.0 - rays.eye.x) / direction.x * direction;
                    if place.z.abs() > 19.0 || !(2.0..79.0).contains(&place.y) {
                        continue;
                    }
                    if place.y > edge_m + 3.0 {
                        lit += 1;
                        assert_eq!(with, without, "{variant:?} {lod:?}: {place} in the sun");
                    } else if place.y < edge_m - 3.0 {
                        dark += 1;
                        assert!(with[0] + 40 < without[0], "{variant:?} {lod:?}: {place} in the shadow: {with:?}");
                    }
                }
                assert!(lit > 100 && dark > 100, "{variant:?} {lod:?}: {lit} in the sun, {dark} in the shadow");
            }
        }
    });
}

/// True when a ray in double precision meets a triangle grown by `slack` of its size; brute force.
fn is_hidden(triangles: &[[DVec3; 3]], origin: DVec3, direction: DVec3, slack: f64) -> bool {
    triangles.iter().any(|&[a, b, c]| {
        let (ab, ac) = (b - a, c - a);
        let across = direction.cross(ac);
        let determinant = ab.dot(across);
        let turned = (origin - a).cross(ab);
        let (v, w) = ((origin - a).dot(across) / determinant, direction.dot(turned) / determinant);
        // The place's own face is met at nearly nothing.
        let is_before = ac.dot(turned) / determinant > if slack > 0.0 { 1e-3 } else { 1e-2 };
        v.min(w) > -slack && v + w < 1.0 + slack && is_before
    })
}

/// True when the sun stands behind a face at `place` that the eye sees, or nearly: a sheet without thickness is dark
/// there, and no ray meets anything.
fn is_seen_from_behind(triangles: &[[DVec3; 3]], place: DVec3, towards: DVec3, to_sun: DVec3) -> bool {
    triangles.iter().any(|&[a, b, c]| {
        let face = (b - a).cross(c - a).normalize();
        let is_own = (place - a).dot(face).abs() < 1e-2 && is_hidden(&[[a, b, c]], place - 10.0 * face, face, 1e-2);
        let seen = if face.dot(towards) > 0.0 { -face } else { face };
        is_own && seen.dot(to_sun) < 0.03
    })
}

/// Objects shadow the land and each other where rays in double precision meet a triangle; what single precision moves across an
/// edge is left to either side.
#[test]
fn objects_cast_shadows_where_rays_meet_their_triangles() {
    gpu_test(|device| {
        let maps = [level(61, 1.0, 0.0)];
        let sun = Sun { azimuth_rad: 250f32.to_radians(), elevation_rad: 35f32.to_radians() };
        let place = |x: f32, z: f32, size: f32| {
            Mat4::from_translation(Vec3::new(x, 1.0 + size, z)) * Mat4::from_scale(Vec3::splat(size))
        };
        let stands = [place(-30.0, 5.0, 12.0), place(5.0, -8.0, 8.0), place(70.0, 40.0, 4.0)];
        let objects = stands.map(|stand| shapes::cuboid().transformed(&stand));
        let corners = |mesh: &fumarole::scene::Mesh| -> Vec<[DVec3; 3]> {
            let corner = |&i: &u32| mesh.positions[i as usize].as_dvec3();
            mesh.indices.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]).collect()
        };
        let triangles: Vec<[DVec3; 3]> = objects.iter().flat_map(corners).collect();
        let camera = Camera {
            eye: Vec3::new(60.0, 90.0, 170.0),
            target: Vec3::new(5.0, 5.0, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.6,
            near_m: 1.0,
            far_m: 1e5,
        };
        let (width, height) = (120, 90);
        let rays = Rays::new(&camera, width, height);
        let to_sun = sun.direction().as_dvec3();
        let inputs = Inputs { maps: &maps, objects: &objects, ..Inputs::default() };
        for &variant in Variant::ALL {
            let base_level_m = Some(0.0);
            let parameters = Parameters {
                view: View::Camera(camera),
                sun,
                base_level_m,
                shadows: true,
                width,
                height,
                ..Parameters::default()
            };
            let drawing = Drawing::with(device, variant, &parameters, &inputs);
            let objects = (&drawing.object_hits, &drawing.object_occlusion);
            let (objects, occlusion) =
                (objects.0.as_chunks::<4>().0.iter().map(|hit| (hit[0], hit[3] > 0.0)), objects.1);
            let mut seen = vec![("object-occlusion", objects.collect::<Vec<_>>(), occlusion)];
            if !variant.is_host() {
                let land = drawing.hits.iter().map(|hit| (hit.depth_m, hit.surface != Surface::Sky));
                seen.push(("occlusion", land.collect(), &drawing.occlusion));
            }
            for (name, hits, light) in seen {
                let (mut lit, mut dark, mut either, mut off) = (0, 0, 0, 0);
                for (pixel, ((depth_m, is_seen), light)) in hits.into_iter().zip(light).enumerate() {
                    if !is_seen {
                        continue;
                    }
                    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
                    let direction = rays.corner + f64::from(x) * rays.across + f64::from(y) * rays.down;
                    let place = rays.eye + f64::from(depth_m) * direction;
                    let [surely, perhaps] = [-1e-3, 1e-3].map(|slack| is_hidden(&triangles, place, to_sun, slack));
                    if is_seen_from_behind(&triangles, place, direction, to_sun) {
                        continue;
                    }
                    match (surely, perhaps, *light) {
                        (true, true, 0.0) => dark += 1,
                        (false, false, 1.0) => lit += 1,
                        (true, true, _) | (false, false, _) => off += 1,
                        _ => either += 1,
                    }
                }
                let least = if name == "occlusion" { 100 } else { 5 };
                let counts = format!("{variant:?} {name}: {lit} lit, {dark} dark, {either} either, {off} off");
                assert!(lit > 200 && dark > least && either < 60 && off * 100 <= lit + dark, "{counts}");
            }
        }
        // The processor's picture is the device's.
        let picture = |variant| {
            let parameters =
                Parameters { view: View::Camera(camera), sun, shadows: true, width, height, ..Parameters::default() };
            Drawing::with(device, variant, &parameters, &inputs).picture
        };
        let [host, compute] = [Variant::Cpu, Variant::GpuCompute].map(picture);
        let differing = host.pixels().iter().zip(compute.pixels()).filter(|(a, b)| a.abs_diff(**b) > 3).count();
        assert!(differing < 400, "{differing} bytes");
    });
}
