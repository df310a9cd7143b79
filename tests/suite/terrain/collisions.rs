//! Collisions against brute force.

use std::f64::consts::TAU;
use std::sync::Arc;

use fumarole::papers::terrain::reference::Ray;
use fumarole::papers::terrain::{
    Base, Collider, Inputs, Interpolation, MapInput, Parameters, Placement, Stand, Surface,
};
use fumarole::scene::random::Random;
use fumarole::scene::{Samples, shapes};
use glam::{DVec2, DVec3, Mat4, Vec3};

use super::maps::{alone, map, volcano};
use super::world::{Relief, World, random_map};

/// Steps along a segment.
const STEPS: u32 = 20_000;

#[test]
fn segments_touch_where_small_steps_do() {
    let map = volcano(65);
    let spacing_m = map.spacing_m().x;
    let lowest_m = f64::from(map.range_m().0);
    let height_m = |x: f64, z: f64| {
        let [u, v] = [x, z].map(|c| c / spacing_m + 32.0);
        if u < 0.0 || v < 0.0 || u > 64.0 || v > 64.0 {
            return 0.0;
        }
        let (column, row) = ((u as u32).min(63), (v as u32).min(63));
        let (a, b) = (u - f64::from(column), v - f64::from(row));
        let at = |i: u32, j: u32| f64::from(map.height_m(column + i, row + j));
        let north = at(0, 0) + (at(1, 0) - at(0, 0)) * a;
        let south = at(0, 1) + (at(1, 1) - at(0, 1)) * a;
        north + (south - north) * b - lowest_m
    };
    let maps = alone(map.clone());
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let mut random = Random::new(3);
    let mut met = 0;
    for _ in 0..300 {
        let mut place = |high: f64| {
            let [x, y, z] = [(); 3].map(|()| f64::from(random.unit()));
            DVec3::new((x - 0.5) * 14_000.0, y * high, (z - 0.5) * 14_000.0)
        };
        let (a, b) = (place(3000.0), place(200.0));
        let is_inside = |t: f64| {
            let p = a.lerp(b, t);
            p.y <= height_m(p.x, p.z)
        };
        let step = (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS)).find(|&t| is_inside(t));
        let contact = collider.segment(a, b);
        let slack = 2.0 / f64::from(STEPS);
        match (step, contact) {
            (Some(t), Some(contact)) => {
                met += 1;
                // Steps may pass a ridge that the collider meets, never the other way round.
                assert!(contact.t.unwrap() <= t + 1e-5, "{a} to {b}: {} after {t}", contact.t.unwrap());
                let p = a.lerp(b, contact.t.unwrap());
                let is_wall = contact.normal.y.abs() < 1e-6;
                assert!(is_wall || (p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m || contact.t.unwrap() == 0.0);
                assert!(contact.t.unwrap() >= t - slack || (p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m);
            }
            (None, Some(contact)) => {
                let p = contact.point;
                assert!((p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m, "{a} to {b}: {contact:?}");
            }
            (Some(t), None) => panic!("{a} to {b}: nothing is met, but the ground at {t}"),
            (None, None) => {}
        }
    }
    assert!(met > 100, "only {met} segments meet the ground");
}

/// However far away a segment begins and ends, it meets the ground where its piece over the map does.
#[test]
fn long_segments_meet_what_their_pieces_meet() {
    let maps = alone(volcano(65));
    let cell_m = maps[0].map.spacing_m().x;
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let mut random = Random::new(4);
    for far_m in [1e6, 1e7, 5e7] {
        for _ in 0..60 {
            let mut place = |y: f64| {
                let [x, z] = [(); 2].map(|()| 10_000.0 * (f64::from(random.unit()) - 0.5));
                DVec3::new(x, y, z)
            };
            let (above, below) = (place(2500.0), place(-1.0));
            let direction = (below - above).normalize();
            let expected = collider.segment(above, below).unwrap();
            let (from, to) = (above - far_m * direction, below + far_m * direction);
            let found = collider.segment(from, to).unwrap();
            let off_m = found.point.distance(expected.point);
            assert!(off_m < 2e-3 * cell_m, "{above} to {below} from {far_m} m: {off_m} m, {found:?}, not {expected:?}");
            assert_eq!(found.surface, expected.surface);
            assert!((found.distance_m - from.distance(expected.point)).abs() < 2e-3 * cell_m, "{found:?}");
            assert!(from.lerp(to, found.t.unwrap()).distance(found.point) < 2e-3 * cell_m, "{found:?}");
        }
    }
}

const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 900.0 }, Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 }];
const INTERPOLATIONS: [Interpolation; 2] = [Interpolation::Bilinear, Interpolation::Bicubic];

fn collider(world: &World) -> Collider {
    let (base, interpolation, base_level_m) = (world.base, world.interpolation, world.base_level_m);
    let parameters = Parameters { base, interpolation, base_level_m, ..Parameters::default() };
    Collider::new(&parameters, &Inputs { maps: &world.maps, ..Inputs::default() })
}

/// A map of 31 x 24 samples on every base, by both interpolations, over a base that it rises above or partly sinks into.
fn worlds(seed: u64) -> impl Iterator<Item = World> {
    let cases = BASES.into_iter().flat_map(|base| INTERPOLATIONS.map(|interpolation| (base, interpolation)));
    (seed..).zip(cases).map(|(seed, (base, interpolation))| {
        let mut random = Random::new(seed);
        let relief = if seed.is_multiple_of(2) { Relief::Waves } else { Relief::Noise };
        let map = random_map(&mut random, relief, (31, 24), 4.0);
        let (low, high) = map.range_m();
        let level = [None, Some(low + 0.3 * (high - low)), Some(low - 0.2 * (high - low))][seed as usize % 3];
        World::alone(&format!("{base:?} {interpolation:?}"), base, interpolation, level, map)
    })
}

/// A world's point by chance, somewhat beyond the map's edges, up to `reach` times its height above the base.
fn place(world: &World, random: &mut Random, reach: f64) -> DVec3 {
    let [u, v, h] = [(); 3].map(|()| f64::from(random.unit()));
    world.point(DVec2::new(1.4 * u - 0.2, 1.4 * v - 0.2), h * reach * world.top_m())
}

/// The oracle tries every cell. Where it ends elsewhere, the contact must be as near to the ground as single precision
/// is, or the segment must have passed as near to a silhouette.
#[test]
fn segments_meet_what_brute_force_meets_on_every_surface() {
    for world in worlds(1) {
        let collider = collider(&world);
        let mut random = Random::new(5);
        let hair_m = 1e-3 * world.cell_m();
        let (mut met, mut elsewhere) = (0, 0);
        for _ in 0..400 {
            let (a, b) = (place(&world, &mut random, 2.0), place(&world, &mut random, 1.0));
            let (start, end) = (world.moved(a), world.moved(b));
            let expected = world.terrain.segment(start, end);
            let found = collider.segment(a, b);
            let length_m = a.distance(b);
            let is_same = match (found, expected) {
                (None, None) => true,
                (Some(found), Some(expected)) => {
                    met += 1;
                    let cosine = expected.normal.dot((end - start) / length_m).abs().max(1e-2);
                    (found.t.unwrap() * length_m - expected.t).abs() <= 2.0 * hair_m / cosine
                }
                _ => false,
            };
            if is_same {
                continue;
            }
            elsewhere += 1;
            match found {
                Some(contact) => {
                    let near = world.terrain.sphere(world.moved(contact.point), 2.0 * hair_m);
                    assert!(near.is_some(), "{}: {a} to {b}: {contact:?}, not {expected:?}", world.name);
                }
                None => {
                    let ray = Ray::new(start, end - start);
                    let clearance = world.terrain.clearance(&ray, [0.0, length_m], expected.as_ref());
                    let is_end = expected.is_some_and(|hit| length_m - hit.t < 2.0 * hair_m);
                    let is_graze = clearance.after_cells < 2e-3 || is_end;
                    assert!(is_graze, "{}: {a} to {b}: nothing, not {expected:?}", world.name);
                }
            }
        }
        assert!(met > 100, "{}: only {met} segments meet the ground", world.name);
        assert!(elsewhere * 100 <= 400, "{}: {elsewhere} end elsewhere", world.name);
    }
}

/// A millionth of a cell is what the oracle promises of its own distance.
#[test]
fn spheres_are_as_far_from_the_ground_as_brute_force_says() {
    for world in worlds(7) {
        let collider = collider(&world);
        let mut random = Random::new(6);
        let cell_m = world.cell_m();
        let mut seen = [0; 4];
        for _ in 0..120 {
            let center = place(&world, &mut random, 1.6);
            let radius_m = cell_m * f64::from(random.range(0.1, 8.0));
            let expected = world.terrain.sphere(world.moved(center), radius_m);
            let found = collider.sphere(center, radius_m);
            let say = || format!("{}: {center}, {radius_m} m: {found:?}, not {expected:?}", world.name);
            let Some(touch) = found else {
                let is_edge = expected.is_none_or(|e| (e.distance_m - radius_m).abs() < 2e-6 * cell_m);
                assert!(is_edge, "{}", say());
                continue;
            };
            let distance_m = expected.map_or(radius_m, |expected| expected.distance_m);
            assert!((touch.distance_m - distance_m).abs() <= 2e-6 * cell_m, "{}", say());
            let kind = match touch.surface {
                Surface::Inside => 0,
                Surface::Base => 1,
                Surface::Terrain => 2,
                _ => 3,
            };
            seen[kind] += 1;
            assert!((touch.normal.length() - 1.0).abs() < 1e-9, "{}", say());
            if kind == 0 {
                assert_eq!((touch.distance_m, touch.point), (0.0, center));
                continue;
            }
            // The point is where it is said to be: on the ground, and as far from the centre as the normal points.
            let back = touch.point + touch.normal * touch.distance_m;
            assert!(back.distance(center) < 1e-6 * cell_m, "{}", say());
            assert!(world.terrain.sphere(world.moved(touch.point), 2e-6 * cell_m).is_some(), "{}", say());
        }
        assert!(seen.iter().all(|&seen| seen >= 3), "{} saw too little: {seen:?}", world.name);
    }
}

/// A map that goes once round is as near at its seam as elsewhere, and two maps are as near as the nearer.
#[test]
fn spheres_touch_closed_and_united_maps() {
    let radius_m = 300.0;
    let mut random = Random::new(8);
    let map = random_map(&mut random, Relief::Noise, (60, 12), 2.0);
    let map = map.with_spacing_m(DVec2::splat(TAU * radius_m / 60.0)).unwrap();
    let base = Base::Cylinder { radius_m: radius_m as f32 };
    let closed = World::alone("once round", base, Interpolation::Bicubic, None, map.clone());
    let input = |map, x| MapInput {
        map: Arc::new(map),
        placement: Placement { center_m: DVec2::new(x, 0.0), ..Placement::default() },
    };
    let other = random_map(&mut random, Relief::Waves, (30, 20), 3.0);
    let maps = vec![input(map, 0.0), input(other, 700.0)];
    let united = World::new("united", Base::Plane, Interpolation::Bilinear, None, maps);
    for world in [closed, united] {
        let collider = collider(&world);
        for number in 0..60 {
            let u = if number % 2 == 0 { 1.0 } else { f64::from(random.unit()) };
            let fraction = DVec2::new(u, f64::from(random.unit()));
            let center = world.point(fraction, world.top_m() * f64::from(random.range(0.7, 1.5)));
            let expected = world.terrain.sphere(world.moved(center), 1e6).unwrap();
            let touch = collider.sphere(center, 1e6).unwrap();
            let off_m = (touch.distance_m - expected.distance_m).abs();
            assert!(off_m <= 2e-6 * world.cell_m(), "{}: {fraction}: {touch:?}, not {expected:?}", world.name);
        }
    }
}

/// Of a million cells a sphere and a segment try few: the levels above answer for the rest.
#[test]
fn the_pyramid_leaves_nearly_all_cells_out() {
    let maps = alone(volcano(1025));
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let mut random = Random::new(9);
    for _ in 0..50 {
        let [x, z] = [(); 2].map(|()| 10_000.0 * (f64::from(random.unit()) - 0.5));
        let above = DVec3::new(x, 4000.0, z);
        let touch = collider.sphere(above, 1e5).unwrap();
        assert!((1..20_000).contains(&touch.steps), "{touch:?}");
        let contact = collider.segment(above, DVec3::new(z, -10.0, x)).unwrap();
        assert!((1..500).contains(&contact.steps), "{contact:?}");
    }
}

/// An object stands with its lowest point on the ground, turned and scaled, wherever its mesh lies.
#[test]
fn objects_stand_on_the_ground() {
    let maps = alone(volcano(65));
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let (map, spacing_m) = (&maps[0].map, maps[0].map.spacing_m().x);
    let mesh = shapes::cuboid().transformed(&Mat4::from_translation(Vec3::new(0.0, 7.0, 0.0)));
    let [width, length] = [0, 2].map(|axis| mesh.bounds().diagonal()[axis]);
    for (column, row) in [(32, 32), (20, 40), (50, 11)] {
        let [east_m, south_m] = [column, row].map(|node: u32| ((f64::from(node) - 32.0) * spacing_m) as f32);
        let placed = Stand { east_m, south_m, yaw_deg: 90.0, scale: 25.0 }.place(&mesh, &collider);
        let bounds = placed.bounds();
        let ground_m = map.height_m(column, row) - map.range_m().0;
        assert!((bounds.min.y - ground_m).abs() < 1e-2, "{column}, {row}: {bounds:?} over {ground_m}");
        let middle = bounds.min + bounds.diagonal() / 2.0;
        assert!((middle.x - east_m).abs() < 1e-2 && (middle.z - south_m).abs() < 1e-2, "{bounds:?}");
        let [across, along] = [0, 2].map(|axis| bounds.diagonal()[axis]);
        assert!((across - 25.0 * length).abs() < 1e-2 && (along - 25.0 * width).abs() < 1e-2, "{bounds:?}");
    }
    // Beside the map there is the base.
    let beside = Stand { east_m: 40_000.0, south_m: 0.0, yaw_deg: 0.0, scale: 1.0 }.place(&mesh, &collider);
    assert!(beside.bounds().min.y.abs() < 1e-3, "{:?}", beside.bounds());
}

#[test]
fn what_lies_beside_touches_nothing() {
    let maps = alone(volcano(65));
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let above = DVec3::new(0.0, 9000.0, 0.0);
    assert_eq!(collider.segment(above, above + DVec3::X), None);
    assert_eq!(collider.sphere(above, 10.0), None);
    // On the base beside the map, its bottom at the base: it touches; a hair higher it does not.
    let beside = DVec3::new(30_000.0, 5.0, 0.0);
    let touch = collider.sphere(beside, 5.0).unwrap();
    assert_eq!((touch.surface, touch.distance_m), (Surface::Base, 5.0));
    assert!(touch.point.distance(DVec3::new(30_000.0, 0.0, 0.0)) < 1e-9, "{touch:?}");
    assert_eq!(collider.sphere(beside + DVec3::Y * 1e-6, 5.0), None);
}

/// A segment from far away that begins below the base is in the ground there, whatever land it would come to.
#[test]
fn a_segment_from_below_the_base_meets_it_at_once() {
    let maps = alone(volcano(65));
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let over_land = DVec3::new(-6000.0, 100.0, 0.0);
    // Near enough that single precision is enough, and so far away that the piece over the map is looked at alone.
    for far_m in [2e4, 5e6] {
        let climb = DVec3::new(1.0, 0.01, 0.0) * far_m;
        let from = over_land - climb;
        let contact = collider.segment(from, over_land + 1e5 * climb / far_m).unwrap();
        assert_eq!((contact.surface, contact.t, contact.point), (Surface::Base, Some(0.0), from), "{far_m} m");
        // From the base on it would meet the land.
        let above = over_land - DVec3::new(1.0, 0.01, 0.0) * 5e3;
        let contact = collider.segment(above, over_land + 1e5 * climb / far_m).unwrap();
        assert!(!matches!(contact.surface, Surface::Base | Surface::Inside), "{contact:?}");
    }
}

/// A level map of nodes a side, 10 m apart, so high, whose middle is at `x`.
fn level(side: u32, height_m: f32, x: f64) -> MapInput {
    MapInput {
        map: Arc::new(map(side, side, Samples::Float(vec![height_m; (side * side) as usize]), 10.0)),
        placement: Placement { center_m: DVec2::new(x, 0.0), ..Placement::default() },
    }
}

/// Level land at the very height of the base is land on the first map and on the next, however the segments come.
#[test]
fn land_in_the_base_is_met_on_every_map() {
    let maps = [-150.0, 150.0].map(|x| level(21, 70.0, x));
    let collider = Collider::new(&Parameters::default(), &Inputs { maps: &maps, ..Inputs::default() });
    let mut random = Random::new(11);
    for number in 0..200 {
        let mut place = |y: f64| {
            let [x, z] = [(); 2].map(|()| 180.0 * (f64::from(random.unit()) - 0.5));
            DVec3::new(x + if number % 2 == 0 { -150.0 } else { 150.0 }, y, z)
        };
        let (a, b) = (place(90.0), place(-0.001));
        let contact = collider.segment(a, b).unwrap();
        assert_eq!((contact.surface, contact.map), (Surface::Terrain, number % 2), "{a} to {b}: {contact:?}");
        assert!(contact.point.y.abs() < 1e-3, "{contact:?}");
    }
}

/// A flat segment that ends just below the base ends before the wall of another map, however near in height the base and its end
/// are for single precision.
#[test]
fn a_wall_beyond_the_end_of_a_segment_is_not_met() {
    // The western wall of the second stands at x = 12.
    let maps = [-1000.0, 62.0].map(|x| level(11, 1000.0, x));
    let parameters = Parameters { base_level_m: Some(0.0), ..Parameters::default() };
    let collider = Collider::new(&parameters, &Inputs { maps: &maps, ..Inputs::default() });
    let start = DVec3::new(0.0, 1e-4, 0.0);
    let before = collider.segment(start, DVec3::new(10.0, -1e-5, 0.0)).unwrap();
    assert_eq!(before.surface, Surface::Base, "{before:?}");
    assert!((before.t.unwrap() - 10.0 / 11.0).abs() < 1e-3, "{before:?}");
    let through = collider.segment(start, DVec3::new(20.0, -1e-5, 0.0)).unwrap();
    assert_eq!((through.surface, through.map), (Surface::WallWest, 1), "{through:?}");
    assert!((through.point.x - 12.0).abs() < 1e-3, "{through:?}");
}
