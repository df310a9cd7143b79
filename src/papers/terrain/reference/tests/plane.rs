//! Maps over the plane.

use crate::papers::terrain::reference::fixtures::{Dice, grid_of, march, random_grid};
use crate::papers::terrain::reference::path::Path;
use crate::papers::terrain::reference::search::Search;
use crate::papers::terrain::reference::{Base, Grid, Hit, Interpolation, Part, Ray, Terrain, is_lit, lambert};
use glam::DVec3;

const BOTH: [Interpolation; 2] = [Interpolation::Bilinear, Interpolation::Bicubic];
const FAR: [f64; 2] = [0.0, f64::INFINITY];

fn over_plane(interpolation: Interpolation, maps: Vec<Grid>) -> Terrain {
    Terrain::new(Base::Plane, interpolation, maps, Some(0.0))
}

fn towards(from: DVec3, to: DVec3) -> Ray {
    Ray::new(from, to - from)
}

/// A ray from around the map of `side` cells and `top` metres through the box over it.
fn random_ray(dice: &mut Dice, side: f64, top: f64) -> Ray {
    let to = DVec3::new(dice.between(-1.0, side + 1.0), dice.between(-0.5, top), dice.between(-1.0, side + 1.0));
    let from =
        DVec3::new(side / 2.0, top / 2.0, side / 2.0) + dice.direction() * (side + top) * dice.between(0.05, 1.5);
    towards(from, to)
}

/// The ray has no solid before its hit, and the hit is on the boundary.
fn check_against_marching(terrain: &Terrain, ray: &Ray, reach_m: f64, step_m: f64) -> Option<Hit> {
    let hit = terrain.first_hit(ray, [0.0, reach_m]);
    let marched = march(terrain, ray, [0.0, reach_m], step_m);
    let near = |t: f64| terrain.is_solid(ray.at(t + 1e-9)) || terrain.is_solid(ray.at(t));
    match (hit, marched) {
        (None, None) => {}
        (None, Some(t)) => panic!("solid at {t} was missed by {ray:?}"),
        (Some(hit), None) => assert!(near(hit.t), "{hit:?} {ray:?}"),
        (Some(hit), Some(t)) => assert!(hit.t <= t + 1e-9 && near(hit.t), "{hit:?}, marched {t}, {ray:?}"),
    }
    if let Some(hit) = hit
        && hit.part == Part::Surface
        && let Some(map) = hit.map
    {
        let height = terrain.height_above_base(&terrain.maps[map], hit.place.uv);
        assert!((height - hit.place.h).abs() < 1e-9 * (1.0 + reach_m), "{height} {hit:?}");
        assert!((hit.normal.length() - 1.0).abs() < 1e-12);
    }
    hit
}

#[test]
fn a_tilted_plane_is_hit_where_the_line_meets_it() {
    let map = grid_of([9, 7], [-2.0, 3.0], [0.5, 2.0], |u, v| 10.0 + 0.3 * u - 0.2 * v);
    let terrain = over_plane(Interpolation::Bilinear, vec![map]);
    let mut dice = Dice::new(1);
    for _ in 0..500 {
        let to = [dice.between(-1.9, 1.9), dice.between(3.1, 14.9)];
        let target = DVec3::new(to[0], 10.0 + 0.3 * to[0] - 0.2 * to[1], to[1]);
        let from = target + DVec3::new(dice.between(-30.0, 30.0), 40.0, dice.between(-30.0, 30.0));
        let hit = terrain.first_hit(&towards(from, target), FAR).unwrap();
        assert_eq!((hit.part, hit.map), (Part::Surface, Some(0)));
        assert!((hit.point - target).length() < 1e-11);
        assert!((hit.normal - DVec3::new(-0.3, 1.0, 0.2).normalize()).length() < 1e-12);
    }
}

#[test]
fn surfaces_that_the_interpolation_reproduces_are_hit_at_the_roots_of_their_equation() {
    // Bilinear: the saddle u v. Catmull-Rom: the paraboloid (u² + v²) / 4 away from the border.
    let saddle = grid_of([12, 12], [0.0; 2], [1.0; 2], |u, v| u * v / 4.0);
    let bowl = grid_of([12, 12], [0.0; 2], [1.0; 2], |u, v| (u * u + v * v) / 4.0);
    let mut dice = Dice::new(2);
    let mut seen = 0;
    for (interpolation, map, is_saddle) in [(BOTH[0], saddle, true), (BOTH[1], bowl, false)] {
        let terrain = over_plane(interpolation, vec![map]);
        for _ in 0..1000 {
            let spot = |dice: &mut Dice, y: f64| DVec3::new(dice.between(2.0, 9.0), y, dice.between(2.0, 9.0));
            let [from, to] = [spot(&mut dice, 45.0), spot(&mut dice, 0.5)];
            let (o, d) = (from, to - from);
            let [a, b, c] = if is_saddle {
                [-d.x * d.z / 4.0, d.y - (o.x * d.z + o.z * d.x) / 4.0, o.y - o.x * o.z / 4.0]
            } else {
                let (dd, od, oo) = (d.x * d.x + d.z * d.z, o.x * d.x + o.z * d.z, o.x * o.x + o.z * o.z);
                [-dd / 4.0, d.y - od / 2.0, o.y - oo / 4.0]
            };
            let root = (b * b - 4.0 * a * c).sqrt();
            let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
            let s = roots.into_iter().filter(|s| (0.0..=1.0).contains(s)).fold(f64::INFINITY, f64::min);
            let Some(hit) = terrain.first_hit(&towards(from, to), [0.0, d.length()]) else {
                assert!(s.is_infinite());
                continue;
            };
            assert!((hit.t / d.length() - s).abs() < 1e-11, "{hit:?} {s}");
            seen += 1;
        }
    }
    assert!(seen > 1500);
}

#[test]
fn marching_finds_nothing_before_the_hit_on_random_maps() {
    let mut dice = Dice::new(3);
    let mut hits = [0; 4];
    for (number, interpolation) in (0..40).map(|n| (n, BOTH[n % 2])) {
        let range = [0.1, 1.0, 4.0, 20.0][number / 2 % 4];
        let terrain = over_plane(interpolation, vec![random_grid([5 + number % 7, 9], number as u64, range)]);
        for _ in 0..40 {
            let ray = random_ray(&mut dice, 8.0, range);
            if let Some(hit) = check_against_marching(&terrain, &ray, 40.0 + range, 0.01) {
                hits[hit.part as usize] += 1;
            }
        }
    }
    assert!(hits.iter().all(|&count| count > 30), "{hits:?}");
}

#[test]
fn the_polynomial_and_the_interval_search_find_the_same_roots() {
    let mut dice = Dice::new(4);
    let mut found = 0;
    for interpolation in BOTH {
        let map = random_grid([6, 6], 11, 1.0);
        for _ in 0..1500 {
            let ray = random_ray(&mut dice, 5.0, 1.0);
            let path = Path { base: Base::Plane, grid: &map, ray };
            for piece in path.pieces([0.0, 20.0]) {
                let Some(cell) = piece.cell else { continue };
                let search = Search::new(&path, interpolation, 0.0, cell);
                let one = search.first_root(piece.from, piece.to);
                let other = search.first_root_by_intervals(piece.from, piece.to);
                match (one, other) {
                    (Some(one), Some(other)) => assert!((one - other).abs() < 1e-6, "{one} {other}"),
                    _ => assert_eq!(one, other),
                }
                found += usize::from(one.is_some());
            }
        }
    }
    assert!(found > 1000);
}

#[test]
fn adversarial_maps_hide_nothing() {
    let spike = |u: f64, v: f64| if [u, v] == [3.0, 4.0] { 1000.0 } else { 0.0 };
    let checkerboard = |u: f64, v: f64| if (u + v) % 2.0 == 0.0 { 0.0 } else { 50.0 };
    let cliff = |u: f64, _: f64| if u == 7.0 { 100.0 } else { 1.0 };
    let flat = |_: f64, _: f64| 5.0;
    let mut dice = Dice::new(5);
    let maps: [&dyn Fn(f64, f64) -> f64; 4] = [&spike, &checkerboard, &cliff, &flat];
    for (f, interpolation) in maps.into_iter().flat_map(|f| BOTH.map(|i| (f, i))) {
        let map = grid_of([8, 8], [0.0; 2], [1.0; 2], f);
        let top = map.range_m()[1];
        let terrain = over_plane(interpolation, vec![map]);
        for _ in 0..60 {
            let ray = random_ray(&mut dice, 7.0, top);
            check_against_marching(&terrain, &ray, 2.0 * top + 20.0, (top + 10.0) / 4000.0);
        }
    }
    // Half a cell beside the spike its sides are met where their height is the ray's.
    let terrain = over_plane(Interpolation::Bilinear, vec![grid_of([8, 8], [0.0; 2], [1.0; 2], spike)]);
    let ray = towards(DVec3::new(-5.0, 400.0, 4.5), DVec3::new(0.0, 400.0, 4.5));
    let hit = terrain.first_hit(&ray, FAR).unwrap();
    assert!((hit.t - 7.8).abs() < 1e-12, "{hit:?}");
    let above = towards(DVec3::new(-5.0, 500.001, 4.5), DVec3::new(0.0, 500.001, 4.5));
    assert_eq!(terrain.first_hit(&above, FAR), None);
}

#[test]
fn cameras_below_on_and_above_the_surface_and_far_outside() {
    let terrain = over_plane(BOTH[0], vec![grid_of([5, 5], [0.0; 2], [1.0; 2], |u, v| 1.0 + u + 2.0 * v)]);
    let surface = 1.0 + 1.5 + 2.0 * 2.5;
    let from = |y: f64| DVec3::new(1.5, y, 2.5);
    for direction in [DVec3::Y, -DVec3::Y, DVec3::X] {
        for y in [surface - 1e-6, surface, 0.5, -3.0] {
            let hit = terrain.first_hit(&Ray::new(from(y), direction), [0.25, 9.0]);
            let start = from(y) + direction * 0.25;
            if terrain.is_solid(start) {
                assert_eq!(hit.map(|h| (h.t, h.part)), Some((0.25, Part::Inside)));
            }
        }
    }
    let on = terrain.first_hit(&Ray::new(from(surface), DVec3::Y), FAR).unwrap();
    assert_eq!((on.t, on.part, on.map), (0.0, Part::Inside, Some(0)));
    assert_eq!(terrain.first_hit(&Ray::new(from(surface + 1e-6), DVec3::Y), FAR), None);
    let down = terrain.first_hit(&Ray::new(from(1000.0), -DVec3::Y), FAR).unwrap();
    assert!((down.t - (1000.0 - surface)).abs() < 1e-10 && down.part == Part::Surface);
    let far = towards(from(surface) + DVec3::new(-3e6, 2e6, 1e6), from(surface));
    let hit = terrain.first_hit(&far, FAR).unwrap();
    assert!((hit.point - from(surface)).length() < 1e-8, "{hit:?}");
    // A range that ends before the surface holds no hit.
    assert_eq!(terrain.first_hit(&far, [0.0, 3e6]), None);
}

#[test]
fn the_edges_of_a_map_are_walls_and_outside_is_the_base() {
    let terrain = over_plane(BOTH[0], vec![grid_of([3, 3], [10.0, 20.0], [5.0; 2], |_, _| 8.0)]);
    let sides = [
        (DVec3::new(0.0, 4.0, 25.0), DVec3::X, 10.0),
        (DVec3::new(30.0, 4.0, 25.0), -DVec3::X, 10.0),
        (DVec3::new(15.0, 4.0, 0.0), DVec3::Z, 20.0),
        (DVec3::new(15.0, 4.0, 40.0), -DVec3::Z, 10.0),
    ];
    for (origin, direction, t) in sides {
        let hit = terrain.first_hit(&Ray::new(origin, direction), FAR).unwrap();
        assert_eq!((hit.part, hit.normal, hit.map), (Part::Wall, -direction, Some(0)));
        assert!((hit.t - t).abs() < 1e-12);
        assert_eq!(terrain.first_hit(&Ray::new(origin + DVec3::Y * 4.1, direction), FAR), None);
    }
    let ground = terrain.first_hit(&towards(DVec3::new(0.0, 4.0, 25.0), DVec3::new(4.0, 0.0, 25.0)), FAR).unwrap();
    assert_eq!((ground.part, ground.normal, ground.map), (Part::Base, DVec3::Y, None));
    assert!(ground.place.h.abs() < 1e-12);
    // The base's level moves the map, not the base.
    let raised = Terrain { base_level_m: 6.0, ..terrain.clone() };
    assert_eq!(raised.first_hit(&Ray::new(sides[0].0, DVec3::X), FAR), None);
    assert_eq!(Terrain::new(Base::Plane, BOTH[0], terrain.maps, None).base_level_m, 8.0);
}

#[test]
fn united_maps_give_the_nearest_of_all() {
    let maps = |n: usize| random_grid([6, 6], 20 + n as u64, 3.0);
    let moved = Grid { origin: [2.5, 1.25], ..maps(1) };
    let both = over_plane(BOTH[1], vec![maps(0), moved.clone()]);
    let alone = [over_plane(BOTH[1], vec![maps(0)]), over_plane(BOTH[1], vec![moved])];
    let mut dice = Dice::new(6);
    let mut of_each = [0; 2];
    for _ in 0..400 {
        let ray = random_ray(&mut dice, 7.0, 3.0);
        let hit = check_against_marching(&both, &ray, 30.0, 0.02);
        let nearest = alone.iter().filter_map(|t| t.first_hit(&ray, [0.0, 30.0])).map(|h| h.t).min_by(f64::total_cmp);
        assert_eq!(hit.map(|h| h.t), nearest);
        if let Some(map) = hit.and_then(|h| h.map) {
            of_each[map] += 1;
        }
    }
    assert!(of_each.iter().all(|&n| n > 50), "{of_each:?}");
}

#[test]
fn light_follows_the_cosine_and_a_ridge_casts_a_shadow() {
    // A ridge of height 4 along v at u = 5; the sun stands at 45° over +u.
    let map = grid_of([21, 5], [0.0; 2], [1.0; 2], |u, _| if u == 5.0 { 4.0 } else { 0.0 });
    let terrain = over_plane(BOTH[0], vec![map]);
    let sun = DVec3::new(1.0, 1.0, 0.0).normalize();
    let at = |u: f64| terrain.first_hit(&Ray::new(DVec3::new(u, 100.0, 2.0), -DVec3::Y), FAR).unwrap();
    for (u, lit) in [(3.0, false), (1.5, false), (0.9, true), (6.5, true), (4.5, false)] {
        let hit = at(u);
        let is_turned = lambert(hit.normal, sun) > 0.0;
        assert_eq!(is_turned && is_lit(&terrain, hit.point + 1e-6 * hit.normal, sun), lit, "{u}");
    }
    assert!((lambert(at(10.5).normal, sun) - 0.5_f64.sqrt()).abs() < 1e-12);
    assert_eq!(lambert(at(4.5).normal, sun), 0.0);
}
