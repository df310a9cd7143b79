//! Patches of triangles at the level of detail that a picture needs: their bounds, their choice, and what is seen of them.

use std::collections::HashMap;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::papers::terrain::reference::{Part, Ray, Square};
use fumarole::papers::terrain::{
    Base, Bound, Cover, Ground, Inputs, Interpolation, Levels, Origin, PATCH_SIDE, Parameters, Patch, Quadtree, Rays,
    Selection, Sun, Variant, Viewer,
};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, HeightMap};
use glam::{DVec2, DVec3};

use super::drawing::Painter;
use super::maps::{adversaries, ridges};
use super::silhouette::{Silhouette, is_land};
use super::variants::assert_agree;
use super::world::{Relief, Stand, World, random_map};
use crate::common::{gpu_test, shaders_by};

const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 40_000.0 }, Base::Ellipsoid { equatorial_m: 60_000.0, polar_m: 50_000.0 }];
const SIZE: (u32, u32) = (160, 120);

fn tree(device: &Arc<Device>, compiler: Compiler, map: &HeightMap, base: f64) -> Quadtree {
    let shaders = shaders_by(device, compiler);
    let levels = Levels::new(&shaders, "test", map, &[Bound::Highest], Cover::Nodes).unwrap();
    Quadtree::new(&shaders, "test", &levels, base).unwrap()
}

/// The first nodes of the squares of a patch.
fn squares(patch: [usize; 2], level: usize, size: [usize; 2]) -> impl Iterator<Item = Square> {
    let (step, side) = (1 << level, PATCH_SIDE as usize);
    let firsts = move |axis: usize| {
        (patch[axis] * side..(patch[axis] + 1) * side)
            .map(move |cell| cell * step)
            .filter(move |at| *at < size[axis] - 1)
    };
    firsts(1).flat_map(move |y| firsts(0).map(move |x| Square { first: [x, y], step }))
}

#[test]
fn bounds_of_patches_are_the_oracle_s() {
    gpu_test(|device| {
        let mut random = Random::new(90);
        let mut maps: Vec<(String, HeightMap)> =
            adversaries().into_iter().map(|(name, map)| (name.to_owned(), map)).collect();
        maps.push(("ridges".into(), ridges(&mut random, (130, 97), 3000.0)));
        for size in [(33, 17), (200, 5), (65, 65)] {
            maps.push((format!("{size:?}"), random_map(&mut random, Relief::Waves, size, 5.0)));
        }
        for (name, map) in maps {
            let world = World::alone(&name, Base::Plane, Interpolation::Bilinear, None, map.clone());
            let grid = &world.terrain.maps[0];
            let ground = Ground::new(&map, Default::default(), Base::Plane, Origin::default(), map.range_m().0.into());
            for compiler in [Compiler::Glslang, Compiler::Naga] {
                let tree = tree(device, compiler, &map, ground.base);
                assert_eq!(tree.levels.last().unwrap().patches.len(), 1, "{name}");
                for (level, of_level) in tree.levels.iter().enumerate() {
                    for (index, found) in of_level.patches.iter().enumerate() {
                        let patch = [index % of_level.columns as usize, index / of_level.columns as usize];
                        let squares: Vec<Square> = squares(patch, level, grid.size).collect();
                        let error = |square: &Square| square.bilinear_error_m(grid) + square.twist_error_m(grid);
                        let error_m = squares.iter().map(error).fold(0.0, f64::max);
                        let found_m = found.error * ground.unit_m;
                        let highest_m = ground.unit_m * found.low.abs().max(found.high.abs());
                        let slack_m = 2e-5 * error_m + 1e-6 * (level + 1) as f64 * highest_m;
                        let is_bound = (error_m * (1.0 - 1e-9)..error_m + slack_m).contains(&found_m);
                        assert!(is_bound || found_m == error_m, "{name} {level} {patch:?}: {found_m} m, not {error_m}");
                        let nodes = squares.iter().flat_map(|square| {
                            let ([a, b], [c, d]) = (square.first, square.end(grid));
                            (b..=d).flat_map(move |y| (a..=c).map(move |x| grid.node(x as isize, y as isize)))
                        });
                        let nodes: Vec<f64> =
                            nodes.map(|m| ground.base + (m - f64::from(map.range_m().0)) / ground.unit_m).collect();
                        let (low, high) =
                            nodes.iter().fold((f64::MAX, f64::MIN), |(low, high), h| (low.min(*h), high.max(*h)));
                        let near = |a: f64, b: f64| (a - b).abs() < 1e-3 + 1e-6 * a.abs();
                        assert!(near(found.high, high), "{name} {level} {patch:?}: {}, not {high}", found.high);
                        assert!(
                            near(found.low, low) || near(found.low, ground.base),
                            "{name} {level} {patch:?}: {}",
                            found.low
                        );
                    }
                }
            }
        }
    });
}

/// The height of what is drawn of a patch at a place in nodes that lies in a square whose corners are all its own.
fn is_inner(patch: &Patch, square: &Square) -> bool {
    let cell = |axis: usize| (square.first[axis] - patch.corner[axis] as usize) / square.step;
    let last = PATCH_SIDE as usize - 1;
    let sides = [cell(0) == 0, cell(0) == last, cell(1) == 0, cell(1) == last];
    !sides.iter().zip([1, 2, 4, 8]).any(|(is_side, bit)| *is_side && patch.coarser & bit != 0)
}

/// No cell twice, none of the picture's left out, none beside one more than twice as large, and sides said right; the rays
/// that saw land.
fn assert_covers(name: &str, world: &World, ground: &Ground, rays: &Rays, patches: &[Patch]) -> usize {
    let grid = &world.terrain.maps[0];
    let size = [ground.shape.width as usize, ground.shape.height as usize];
    let side = PATCH_SIDE as usize;
    let mut level_of: HashMap<[usize; 2], &Patch> = HashMap::new();
    for patch in patches {
        let corner = patch.corner.map(|at| at as usize / side);
        for y in corner[1]..corner[1] + (1 << patch.shift) {
            for x in corner[0]..corner[0] + (1 << patch.shift) {
                assert!(level_of.insert([x, y], patch).is_none(), "{name}: patch {x}, {y} twice");
            }
        }
    }
    for (&[x, y], patch) in &level_of {
        for (bit, dx, dy) in [(1, -1, 0), (2, 1, 0), (4, 0, -1), (8, 0, 1)] {
            let beside = [x.wrapping_add_signed(dx), y.wrapping_add_signed(dy)];
            let Some(other) = level_of.get(&beside).filter(|other| other.corner != patch.corner) else { continue };
            assert!((other.shift - patch.shift).abs() <= 1, "{name}: levels {} and {}", other.shift, patch.shift);
            let is_coarser = patch.coarser & bit != 0;
            assert_eq!(other.shift > patch.shift, is_coarser, "{name}: side {bit} of {patch:?} beside {other:?}");
        }
    }
    let mut land = 0;
    for pixel in (0..SIZE.0 * SIZE.1).step_by(7) {
        let direction = rays.corner + f64::from(pixel % SIZE.0) * rays.across + f64::from(pixel / SIZE.0) * rays.down;
        let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
        let Some(hit) = world.terrain.first_hit(&ray, [0.0, f64::INFINITY]) else { continue };
        if hit.part == Part::Surface {
            land += 1;
            let node = [0, 1].map(|axis| {
                ((hit.place.uv[axis] - grid.origin[axis]) / grid.spacing[axis]).clamp(0.0, (size[axis] - 2) as f64)
            });
            // Rows of the oracle's maps on an ellipsoid run north.
            let is_northward = matches!(world.base, Base::Ellipsoid { .. });
            let row = if is_northward { (size[1] - 1) as f64 - node[1] } else { node[1] };
            let at = [node[0] as usize / side, (row.max(0.0) as usize).min(size[1] - 2) / side];
            assert!(level_of.contains_key(&at), "{name}: pixel {pixel} sees patch {at:?}, which is not drawn");
        }
    }
    land
}

/// The pixel that a point of the world is seen at, where it is in front of the camera.
fn seen(rays: &Rays, point: DVec3) -> Option<DVec2> {
    let forward = rays.across.cross(rays.down).normalize();
    let forward = forward * forward.dot(rays.corner).signum();
    let depth = (point - rays.eye).dot(forward);
    let on_screen = (point - rays.eye) / depth - rays.corner;
    let pixel = DVec2::new(on_screen.dot(rays.across), on_screen.dot(rays.down))
        / DVec2::new(rays.across.length_squared(), rays.down.length_squared());
    (depth > 0.0).then_some(pixel)
}

/// Places of each patch whose triangles are its own: as drawn and as the surface has them they are within the bound.
fn assert_within(name: &str, world: &World, ground: &Ground, rays: &Rays, (patches, most): (&[Patch], f64)) -> f64 {
    let grid = &world.terrain.maps[0];
    let is_northward = matches!(world.base, Base::Ellipsoid { .. });
    let size = grid.size;
    // The device's row of a place of the oracle's grid.
    let flipped = |y: f64| if is_northward { (size[1] - 1) as f64 - y } else { y };
    let point = |place: [f64; 2], height_m: f64| {
        ground.point(DVec2::from(place), ground.base + (height_m - world.terrain.base_level_m) / ground.unit_m)
    };
    let height_m = |place: [f64; 2]| {
        let uv = [grid.origin[0] + place[0] * grid.spacing[0], grid.origin[1] + flipped(place[1]) * grid.spacing[1]];
        grid.interpolate(fumarole::papers::terrain::reference::Interpolation::Bilinear, uv).height_m
    };
    let mut largest: f64 = 0.0;
    for patch in patches.iter().filter(|patch| patch.shift > 0) {
        let corner = patch.corner.map(|at| (at as usize / PATCH_SIDE as usize) >> patch.shift);
        for square in squares(corner, patch.shift as usize, size).filter(|square| is_inner(patch, square)) {
            let end = square.end(grid);
            let corners =
                [[square.first[0], square.first[1]], [end[0], square.first[1]], [square.first[0], end[1]], end].map(
                    |[x, y]| {
                        let place = [x as f64, y as f64];
                        point(place, height_m(place))
                    },
                );
            for part in [[0.5, 0.5], [0.5, 0.0], [0.0, 0.5], [0.25, 0.25], [0.75, 0.75], [0.9, 0.4]] {
                let [u, v] = part;
                let place =
                    [0, 1].map(|axis| square.first[axis] as f64 + part[axis] * (end[axis] - square.first[axis]) as f64);
                let exact = point(place, height_m(place));
                let [a, b, c, d] = corners;
                let drawn = if u + v <= 1.0 {
                    a + u * (b - a) + v * (c - a)
                } else {
                    d + (1.0 - u) * (c - d) + (1.0 - v) * (b - d)
                };
                let (Some(exact), Some(drawn)) = (seen(rays, exact), seen(rays, drawn)) else { continue };
                let inside =
                    exact.cmpge(DVec2::splat(-0.5)).all() && exact.x < f64::from(SIZE.0) && exact.y < f64::from(SIZE.1);
                if inside {
                    let off = exact.distance(drawn);
                    largest = largest.max(off);
                    assert!(off <= most * (1.0 + 1e-6), "{name}: {patch:?} is {off} pixels off at {place:?}");
                }
            }
        }
    }
    largest
}

#[test]
fn the_choice_covers_the_picture_within_the_bound() {
    gpu_test(|device| {
        let mut random = Random::new(91);
        let (mut nearest, mut land) = (0.0_f64, 0);
        for base in BASES {
            let map = ridges(&mut random, (300, 221), 3000.0);
            let world = World::alone("ridges", base, Interpolation::Bilinear, None, map.clone());
            let ground = Ground::new(&map, Default::default(), base, Origin::default(), world.terrain.base_level_m);
            let tree = tree(device, Compiler::Glslang, &map, ground.base);
            let finest = tree.most();
            let mut selection = Selection::new(tree);
            for stand in [Stand::Above, Stand::Hovering, Stand::Beside, Stand::Down, Stand::Far(4.0), Stand::Far(20.0)]
            {
                let camera = world.camera(stand, &mut random);
                let rays = Rays::new(&camera, SIZE.0, SIZE.1);
                let viewer = Viewer::new(&ground, &rays, SIZE);
                let mut before = usize::MAX;
                for most in [0.5, 1.0, 4.0] {
                    let name = format!("{base:?} {stand:?} {most}");
                    selection.choose(&viewer, most);
                    land += assert_covers(&name, &world, &ground, &rays, &selection.patches);
                    let largest = assert_within(&name, &world, &ground, &rays, (&selection.patches, most));
                    nearest = nearest.max(largest / most);
                    let drawn = selection.patches.len();
                    assert!(drawn <= before && drawn <= finest, "{name}: {drawn} patches, {before} before");
                    assert_eq!(selection.by_level().iter().sum::<u64>(), drawn as u64);
                    before = drawn;
                }
                if let Stand::Far(_) = stand {
                    assert!(before * 4 < finest, "{base:?} {stand:?}: {before} of {finest} patches");
                }
            }
        }
        assert!(land > 20_000, "only {land} rays met land");
        // The bound is no formality: some place comes near it.
        assert!(nearest > 0.2, "{nearest}");
    });
}

/// Inside the land that all triangles show no base and no sky is seen through those that are chosen.
#[test]
fn no_crack_is_seen() {
    gpu_test(|device| {
        let mut random = Random::new(92);
        for base in BASES {
            let map = ridges(&mut random, (300, 221), 3000.0);
            // So deep that what is seen through a crack is far away.
            let level_m = Some(map.range_m().0 - 2000.0);
            let world = World::alone("ridges", base, Interpolation::Bilinear, level_m, map);
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            let first = world.parameters(world.camera(Stand::Above, &mut random), SIZE);
            let mut all = Painter::new(device, Compiler::Glslang, Variant::Mesh, &first, &inputs);
            for (most, compiler) in [(0.5, Compiler::Glslang), (2.0, Compiler::Naga), (6.0, Compiler::Glslang)] {
                let parameters = Parameters { mesh_error_px: most, ..first.clone() };
                let mut chosen = Painter::new(device, compiler, Variant::MeshLod, &parameters, &inputs);
                for stand in
                    [Stand::Above, Stand::Hovering, Stand::Down, Stand::Beside, Stand::Far(3.0), Stand::Far(8.0)]
                {
                    let camera = world.camera(stand, &mut random);
                    let (expected, found) = (all.from(camera), chosen.from(camera));
                    // Beside a coarser patch triangles may be off by 2.25 times the bound.
                    let reach = (2.25 * most).ceil() as i32 + 1;
                    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
                    let is_inside = |x: i32, y: i32| {
                        (y - reach..=y + reach).all(|y| {
                            (x - reach..=x + reach).all(|x| {
                                let is_seen = (0..width).contains(&x) && (0..height).contains(&y);
                                !is_seen || is_land(expected.hits[(y * width + x) as usize].surface)
                            })
                        })
                    };
                    let mut inside = 0;
                    for (pixel, hit) in found.hits.iter().enumerate() {
                        let (x, y) = (pixel as i32 % width, pixel as i32 / width);
                        if is_inside(x, y) {
                            inside += 1;
                            assert!(is_land(hit.surface), "{base:?} {stand:?} {most}: {x}, {y} shows {hit:?}");
                        }
                    }
                    assert!(
                        inside > 200 || matches!(stand, Stand::Far(_)),
                        "{base:?} {stand:?}: {inside} pixels of land"
                    );
                }
            }
        }
    });
}

/// The land against the sky is within the bound, and a pixel for the sampling, of brute force.
#[test]
fn silhouettes_are_within_the_bound_of_brute_force() {
    gpu_test(|device| {
        let mut random = Random::new(93);
        let size = (88, 44);
        for base in BASES {
            let map = ridges(&mut random, (300, 221), 3000.0);
            let world = World::alone("ridges", base, Interpolation::Bilinear, None, map);
            for (number, sides) in [0.7, 2.0, 6.0].into_iter().enumerate() {
                let middle = world.point(DVec2::splat(0.5), 1500.0);
                let towards = DVec3::new(0.5, 0.12, 1.0).normalize();
                let camera = Camera {
                    eye: (middle + sides * world.side_m() * towards).as_vec3(),
                    target: middle.as_vec3(),
                    up: glam::Vec3::Y,
                    vertical_fov_rad: (0.5 / sides) as f32 * [1.0, 1.3, 2.0][number],
                    near_m: 1.0,
                    far_m: 1e8,
                };
                let expected = Silhouette::of_world(&world, &camera, size);
                for most in [0.5_f32, 1.0, 3.0] {
                    let name = format!("{base:?} {sides} sides, {most} pixels");
                    let parameters = Parameters { mesh_error_px: most, ..world.parameters(camera, size) };
                    let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
                    let mut painter = Painter::new(device, Compiler::Glslang, Variant::MeshLod, &parameters, &inputs);
                    let reach = most.ceil() as usize;
                    let found = Silhouette::of_drawing(&painter.draw());
                    found.assert_near(&name, &expected, (reach, reach as u32 + 1));
                }
            }
        }
    });
}

/// Coarse triangles lie beneath the map in places: land that is lit is not in its own shadow there.
#[test]
fn coarse_triangles_throw_no_specks_of_shadow() {
    gpu_test(|device| {
        let mut random = Random::new(95);
        let mut in_shadow = 0;
        for base in BASES {
            let map = ridges(&mut random, (300, 221), 1500.0);
            let world = World::alone("ridges", base, Interpolation::Bilinear, None, map);
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            let camera = world.camera(Stand::Above, &mut random);
            let sun = Sun { azimuth_rad: 2.0, elevation_rad: 0.6 };
            let parameters = Parameters { mesh_error_px: 4.0, shadows: true, sun, ..world.parameters(camera, SIZE) };
            let dark = |variant| -> Vec<bool> {
                let drawn = Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs).draw();
                drawn.sunlit.iter().map(|lit| *lit < 0.5).collect()
            };
            let [all, chosen] = [Variant::Mesh, Variant::MeshLod].map(dark);
            let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
            let is_near = |at: usize| {
                let (x, y) = (at % width, at / width);
                (y.saturating_sub(6)..(y + 7).min(height))
                    .any(|y| (x.saturating_sub(6)..(x + 7).min(width)).any(|x| all[y * width + x]))
            };
            let specks = (0..all.len()).filter(|&at| chosen[at] && !is_near(at)).count();
            assert!(specks <= 2, "{base:?}: {specks} specks");
            in_shadow += all.iter().filter(|dark| **dark).count();
        }
        assert!(in_shadow > 100, "{in_shadow} pixels");
    });
}

#[test]
fn a_bound_of_nothing_draws_what_all_triangles_do() {
    gpu_test(|device| {
        let mut random = Random::new(94);
        for base in BASES {
            let map = random_map(&mut random, Relief::Waves, (101, 74), 5.0);
            let map = map.with_spacing_m(DVec2::splat(40.0)).unwrap();
            let world = World::alone("waves", base, Interpolation::Bilinear, None, map);
            let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
            for stand in [Stand::Above, Stand::Beside] {
                let camera = world.camera(stand, &mut random);
                let parameters = Parameters { mesh_error_px: 0.01, ..world.parameters(camera, SIZE) };
                let [all, chosen] = [Variant::Mesh, Variant::MeshLod]
                    .map(|variant| Painter::new(device, Compiler::Glslang, variant, &parameters, &inputs).draw());
                assert_agree(&format!("{base:?} {stand:?}"), &all, &chosen);
                let expected = ["geometric-transformation", "base", "select", "mesh-lod", "normal", "illumination"];
                assert_eq!(chosen.passes, expected);
            }
        }
    });
}
