//! Maps over ellipsoids and cylinders.

use crate::papers::terrain::reference::fixtures::{Dice, grid_of, march};
use crate::papers::terrain::reference::{Base, Grid, Interpolation, Part, Place, Ray, Terrain};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const EARTH: Base = Base::Ellipsoid { equatorial_m: 6_378_137.0, polar_m: 6_356_752.314_245 };
const BASES: [Base; 4] = [
    EARTH,
    Base::Ellipsoid { equatorial_m: 10.0, polar_m: 7.0 },
    Base::Ellipsoid { equatorial_m: 7.0, polar_m: 10.0 },
    Base::Cylinder { radius_m: 5.0 },
];
const FAR: [f64; 2] = [0.0, f64::INFINITY];

fn size_m(base: Base) -> f64 {
    match base {
        Base::Ellipsoid { equatorial_m, .. } => equatorial_m,
        Base::Cylinder { radius_m } => radius_m,
        Base::Plane => 1.0,
    }
}

fn random_place(base: Base, dice: &mut Dice) -> Place {
    let size = size_m(base);
    let v = if matches!(base, Base::Cylinder { .. }) { dice.between(-9.0, 9.0) } else { dice.between(-1.57, 1.57) };
    Place { uv: [dice.between(-PI, PI), v], h: size * dice.between(-0.3, 1.0).powi(3) }
}

#[test]
fn places_and_points_are_each_others_inverse() {
    let mut dice = Dice::new(1);
    for base in BASES {
        for _ in 0..1000 {
            let place = random_place(base, &mut dice);
            let back = base.place(base.point(place));
            assert!((back.h - place.h).abs() < 1e-14 * size_m(base).max(100.0), "{base:?} {place:?} {back:?}");
            for axis in 0..2 {
                assert!((back.uv[axis] - place.uv[axis]).abs() < 1e-11, "{base:?} {place:?} {back:?}");
            }
        }
    }
}

#[test]
fn known_points_of_the_earth() {
    let pole = EARTH.place(DVec3::Y * 6_356_852.314_245);
    assert!((pole.uv[1] - FRAC_PI_2).abs() < 1e-12 && (pole.h - 100.0).abs() < 1e-8);
    let equator = EARTH.place(DVec3::new(0.0, 0.0, -6_378_137.0));
    assert!((equator.uv[0] - FRAC_PI_2).abs() < 1e-12 && equator.uv[1].abs() < 1e-15 && equator.h.abs() < 1e-8);
    // At 45° the geocentric radius of this ellipsoid is 6 367 489.5 m.
    let middle = EARTH.point(Place { uv: [0.0, PI / 4.0], h: 0.0 });
    assert!((middle.length() - 6_367_489.5).abs() < 0.1, "{}", middle.length());
}

#[test]
fn frames_are_the_derivatives_of_the_point() {
    let mut dice = Dice::new(2);
    for base in BASES {
        for _ in 0..200 {
            let place = Place { h: 0.1 * size_m(base), ..random_place(base, &mut dice) };
            let frame = base.frame(place);
            let change = |du: f64, dv: f64, dh: f64| {
                let moved = |s: f64| {
                    base.point(Place { uv: [place.uv[0] + s * du, place.uv[1] + s * dv], h: place.h + s * dh })
                };
                (moved(1.0) - moved(-1.0)) / 2.0
            };
            let size = size_m(base);
            assert!((change(1e-4, 0.0, 0.0) / 1e-4 - frame.axes[0] * frame.scales[0]).length() < 1e-7 * size);
            assert!((change(0.0, 1e-4, 0.0) / 1e-4 - frame.axes[1] * frame.scales[1]).length() < 1e-7 * size);
            assert!((change(0.0, 0.0, 1.0) - frame.normal).length() < 1e-8);
        }
    }
}

/// The nearest distance at which a ray enters a sphere about the origin.
fn sphere_distance(ray: &Ray, radius: f64) -> Option<f64> {
    let nearest = -ray.origin.dot(ray.direction);
    let miss = (ray.origin + ray.direction * nearest).length_squared();
    let half = radius * radius - miss;
    (half >= 0.0).then(|| nearest - half.sqrt()).filter(|t| *t >= 0.0)
}

#[test]
fn a_constant_height_on_a_sphere_is_a_larger_sphere() {
    let base = Base::Ellipsoid { equatorial_m: 10.0, polar_m: 10.0 };
    let map = grid_of([13, 7], [-PI, -FRAC_PI_2], [TAU / 12.0, PI / 6.0], |_, _| 2.5);
    let mut dice = Dice::new(3);
    for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
        let terrain = Terrain::new(base, interpolation, vec![map.clone()], Some(0.5));
        let mut hits = 0;
        for number in 0..1000 {
            let origin = dice.direction() * dice.between(13.0, 60.0);
            let straight = number % 10 == 0;
            let to = if straight { DVec3::ZERO } else { dice.direction() * dice.between(0.0, 14.0) };
            let ray = Ray::new(origin, to - origin);
            let hit = terrain.first_hit(&ray, FAR);
            let expected = sphere_distance(&ray, 12.0);
            assert_eq!(hit.is_some(), expected.is_some());
            if let (Some(hit), Some(t)) = (hit, expected) {
                assert!((hit.t - t).abs() < 1e-9, "{hit:?} {t}");
                assert!((hit.normal - hit.point.normalize()).length() < 1e-9);
                assert_eq!(hit.part, Part::Surface);
                hits += 1;
            }
        }
        assert!((500..1000).contains(&hits));
    }
}

#[test]
fn a_constant_height_on_a_cylinder_is_a_larger_cylinder() {
    let base = Base::Cylinder { radius_m: 5.0 };
    let map = grid_of([9, 5], [0.0, -4.0], [TAU / 8.0, 2.0], |_, _| 1.0);
    let terrain = Terrain::new(base, Interpolation::Bilinear, vec![map], Some(0.0));
    let mut dice = Dice::new(4);
    let mut parts = [0; 4];
    for _ in 0..1000 {
        let origin = DVec3::new(dice.between(-9.0, 9.0), dice.between(-9.0, 9.0), 20.0);
        let to = DVec3::new(dice.between(-7.0, 7.0), dice.between(-5.0, 5.0), 0.0);
        let ray = Ray::new(origin, to - origin);
        let Some(hit) = terrain.first_hit(&ray, FAR) else { continue };
        let out = hit.point.x.hypot(hit.point.z);
        match hit.part {
            Part::Surface => assert!((out - 6.0).abs() < 1e-9 && hit.point.y.abs() <= 4.0 + 1e-9),
            Part::Wall => {
                assert!((hit.point.y.abs() - 4.0).abs() < 1e-9 && (5.0..=6.0).contains(&out));
                assert!((hit.normal - DVec3::Y * hit.point.y.signum()).length() < 1e-9);
            }
            Part::Base => assert!((out - 5.0).abs() < 1e-9 && hit.point.y.abs() >= 4.0 - 1e-9),
            Part::Inside => panic!("{hit:?}"),
        }
        parts[hit.part as usize] += 1;
    }
    assert!(parts[1..].iter().all(|&n| n > 10), "{parts:?}");
}

fn random_map(dice: &mut Dice, size: [usize; 2], origin: [f64; 2], spacing: [f64; 2], range_m: f64) -> Grid {
    let heights = (0..size[0] * size[1]).map(|_| dice.between(0.0, range_m)).collect();
    Grid::new(size, heights, origin, spacing).unwrap()
}

fn check(terrain: &Terrain, ray: &Ray, reach_m: f64, step_m: f64, noise_m: f64) -> Option<Part> {
    let hit = terrain.first_hit(ray, [0.0, reach_m]);
    let marched = march(terrain, ray, [0.0, reach_m], step_m);
    if let Some(hit) = hit {
        let touches = [-noise_m, 0.0, noise_m].iter().any(|d| terrain.is_solid(ray.at(hit.t + d)));
        assert!(touches, "{hit:?} {ray:?}");
    }
    match (hit, marched) {
        (None, Some(t)) => panic!("solid at {t} was missed by {ray:?} over {:?}", terrain.base),
        (Some(hit), Some(t)) => assert!(hit.t <= t + noise_m, "{hit:?}, marched {t}, {ray:?}"),
        _ => {}
    }
    hit.map(|h| h.part)
}

#[test]
fn marching_finds_nothing_before_the_hit_over_small_curved_bases() {
    let mut dice = Dice::new(5);
    let mut parts = [0; 4];
    for (number, base) in (0..36).map(|n| (n, BASES[1 + n % 3])) {
        let (origin, spacing) = match base {
            Base::Cylinder { .. } => ([dice.between(-4.0, 4.0), -3.0], [TAU / 7.0, 1.0]),
            _ if number % 2 == 0 => ([dice.between(-4.0, 4.0), -FRAC_PI_2], [TAU / 7.0, PI / 7.0]),
            _ => ([dice.between(-4.0, 4.0), -0.4], [0.3, 0.2]),
        };
        let interpolation = [Interpolation::Bilinear, Interpolation::Bicubic][number / 3 % 2];
        let map = random_map(&mut dice, [8, 8], origin, spacing, 3.0);
        let terrain = Terrain::new(base, interpolation, vec![map], Some(0.0));
        for _ in 0..30 {
            let from = dice.direction() * dice.between(8.0, 30.0);
            let to = dice.direction() * dice.between(0.0, 12.0);
            if let Some(part) = check(&terrain, &Ray::new(from, to - from), 50.0, 0.02, 1e-8) {
                parts[part as usize] += 1;
            }
        }
    }
    assert!(parts.iter().all(|&n| n > 10), "{parts:?}");
}

#[test]
fn a_degree_of_the_earth_is_hit_from_aeroplanes_and_satellites() {
    let mut dice = Dice::new(6);
    let mut parts = [0; 4];
    for (number, latitude) in [0.0, 0.65, -1.2, 1.5].into_iter().enumerate() {
        let spacing = [1.5e-5 / f64::cos(latitude), 1.5e-5];
        let map = random_map(&mut dice, [20, 20], [2.4, latitude], spacing, 150.0);
        let interpolation = [Interpolation::Bilinear, Interpolation::Bicubic][number % 2];
        let terrain = Terrain::new(EARTH, interpolation, vec![map.clone()], Some(0.0));
        let spot = |dice: &mut Dice, h: f64, around: f64| {
            let cells = [(); 2].map(|()| dice.between(-around, 19.0 + around));
            EARTH.point(Place { uv: [0, 1].map(|axis| map.origin[axis] + map.spacing[axis] * cells[axis]), h })
        };
        for n in 0..50 {
            let height = if n % 5 == 0 { 700_000.0 } else { dice.between(100.0, 3000.0) };
            let from = spot(&mut dice, height, 5.0);
            let to = spot(&mut dice, 60.0, 1.0);
            let ray = Ray::new(from, to - from);
            let far = (to - from).length();
            let start = (far - 3000.0).max(0.0);
            let ray = Ray { origin: ray.at(start), ..ray };
            if let Some(part) = check(&terrain, &ray, 4000.0, 1.0, 1e-5) {
                parts[part as usize] += 1;
            }
        }
    }
    assert!(parts[1] > 50 && parts[2] > 0 && parts[3] > 5, "{parts:?}");
}

#[test]
fn rays_along_the_axis_and_through_a_pole_are_no_exception() {
    let base = Base::Ellipsoid { equatorial_m: 10.0, polar_m: 7.0 };
    let map = grid_of([13, 5], [0.0, FRAC_PI_2 - 0.4], [TAU / 12.0, 0.1], |_, v| v * 2.0);
    let terrain = Terrain::new(base, Interpolation::Bilinear, vec![map], Some(0.0));
    let down = terrain.first_hit(&Ray::new(DVec3::Y * 30.0, -DVec3::Y), FAR).unwrap();
    assert!((down.t - (23.0 - PI)).abs() < 1e-9, "{down:?}");
    let across = Ray::new(DVec3::new(-20.0, 9.9, 0.0), DVec3::X);
    let hit = terrain.first_hit(&across, FAR).unwrap();
    let marched = march(&terrain, &across, [0.0, 40.0], 1e-4).unwrap();
    assert!(hit.t <= marched && marched - hit.t < 2e-4, "{hit:?} {marched}");
    assert_eq!(terrain.first_hit(&Ray::new(DVec3::new(-20.0, 10.2, 0.0), DVec3::X), FAR), None);
}
