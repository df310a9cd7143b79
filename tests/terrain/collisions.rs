//! Collisions against brute force.

use fumarole::papers::terrain::{Collider, Inputs, Parameters};
use fumarole::scene::random::Random;
use glam::DVec3;

use crate::land::{alone, volcano};

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
        let is_inside = |part: f64| {
            let p = a.lerp(b, part);
            p.y <= height_m(p.x, p.z)
        };
        let step = (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS)).find(|&part| is_inside(part));
        let contact = collider.segment(a, b);
        let slack = 2.0 / f64::from(STEPS);
        match (step, contact) {
            (Some(part), Some(contact)) => {
                met += 1;
                // Steps may pass a ridge that the collider meets, never the other way round.
                assert!(contact.part <= part + 1e-5, "{a} to {b}: {} after {part}", contact.part);
                let p = a.lerp(b, contact.part);
                let is_wall = contact.normal.y.abs() < 1e-6;
                assert!(is_wall || (p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m || contact.part == 0.0);
                assert!(contact.part >= part - slack || (p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m);
            }
            (None, Some(contact)) => {
                let p = contact.point;
                assert!((p.y - height_m(p.x, p.z)).abs() < 1e-3 * spacing_m, "{a} to {b}: {contact:?}");
            }
            (Some(part), None) => panic!("{a} to {b}: nothing is met, but the ground at {part}"),
            (None, None) => {}
        }
    }
    assert!(met > 100, "only {met} segments meet the ground");
}
