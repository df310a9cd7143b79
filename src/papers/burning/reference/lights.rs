//! The light of the flames: of a flame what its square shows, of a cell of the box around them one ball of light.

use glam::{DVec2, DVec3, IVec2, IVec3};

use super::super::LIGHT_CELLS;
use super::flames::Particle;

/// Half the square of a flame, over its height and the particle's radius.
pub(super) const HALF_SQUARE: DVec2 = DVec2::new(0.75, 1.15);

/// A light.
#[derive(Debug, Clone, Copy)]
pub struct Light {
    /// Diagonals.
    pub place: DVec3,
    /// Of the ball, diagonals.
    pub radius: f64,
    /// Radiance of a white surface that faces it from a distance of 1 diagonal.
    pub intensity: DVec3,
}

pub(super) fn smoothstep(from: f64, to: f64, at: f64) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The noise of flames: random values at whole places, blended by cubics.
pub(super) fn noise(at: DVec2) -> f64 {
    let cell = at.floor();
    let fade = [at.x - cell.x, at.y - cell.y].map(|t| smoothstep(0.0, 1.0, t));
    let corner = |step: IVec2| {
        let at = cell.as_ivec2().wrapping_add(step);
        let mut h = (at.x as u32).wrapping_mul(0x8da6_b343) ^ (at.y as u32).wrapping_mul(0xd816_3841);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        f64::from((h ^ (h >> 16)) & 0xffff) / 65535.0
    };
    let weight = |step: i32, axis: usize| if step == 1 { fade[axis] } else { 1.0 - fade[axis] };
    (0..4).map(|i| IVec2::new(i & 1, i >> 1)).map(|s| corner(s) * weight(s.x, 0) * weight(s.y, 1)).sum()
}

/// The glow of char at a place of the object at rest, of which so much is left, at a time: patches that wander up.
pub fn ember(place: DVec3, left: f64, time_s: f64) -> f64 {
    let at = 40.0 * place - DVec3::Y * (30.0 / 60.0) * time_s;
    let cell = at.floor();
    let fade = (at - cell).to_array().map(|t| smoothstep(0.0, 1.0, t));
    let corner = |i: i32| {
        let step = [i & 1, (i >> 1) & 1, i >> 2];
        let [x, y, z] = (cell.as_ivec3() + IVec3::from(step)).to_array().map(|c| c as u32);
        let mut h = x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        let weight = (0..3).map(|axis| if step[axis] == 1 { fade[axis] } else { 1.0 - fade[axis] }).product::<f64>();
        weight * f64::from((h ^ (h >> 16)) & 0xffff) / 65535.0
    };
    0.7 * left * smoothstep(0.45, 0.85, (0..8).map(corner).sum())
}

/// Light of a place of a flame's square, -1 to 1.
pub(super) fn flame(at: DVec2, age: f64, own: f64) -> DVec3 {
    let tip = (1.0 + at.y) / 2.0;
    let turbulence = noise(DVec2::new(2.2 * at.x + 61.0 * own, 1.5 * at.y - 3.0 * age + 61.0 * own));
    let edge = DVec2::new(at.x * (1.0 + 0.9 * tip), at.y).length() + (turbulence - 0.35) * (0.35 + 0.6 * tip);
    let body = (1.0 - edge).clamp(0.0, 1.0);
    let heat = body * (1.25 - 0.8 * age);
    let glow =
        DVec3::new(smoothstep(0.0, 0.45, heat), 0.72 * smoothstep(0.15, 0.85, heat), 0.42 * smoothstep(0.5, 1.0, heat));
    0.5 * body * glow
}

/// The mean of a flame's light over its square, and over all flames of an age.
pub fn shown(age: f64) -> DVec3 {
    const SIDE: u32 = 24;
    let middle = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(SIDE) - 1.0;
    let owns = (0..40).map(|i| (f64::from(i) + 0.5) / 40.0);
    let of_flame = |own: f64| -> DVec3 {
        (0..SIDE * SIDE).map(|i| flame(DVec2::new(middle(i % SIDE), middle(i / SIDE)), age, own)).sum()
    };
    owns.map(of_flame).sum::<DVec3>() / f64::from(40 * SIDE * SIDE)
}

/// The lights of fire particles of a radius, cell by cell, x first; without those that hold none. `factor` is theirs.
pub fn lights(fire: &[Particle], radius: f64, factor: f64) -> Vec<Light> {
    const AGES: usize = 32;
    let table: Vec<DVec3> = (0..=AGES).map(|i| shown(i as f64 / AGES as f64)).collect();
    let there: Vec<&Particle> = fire.iter().filter(|particle| particle.life > 0).collect();
    let low = there.iter().fold(DVec3::INFINITY, |low, p| low.min(p.position));
    let high = there.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(p.position));
    let cell = (high - low).max(DVec3::splat(1e-6)) / LIGHT_CELLS as f64;
    let number = |p: &Particle| {
        let at = ((p.position - low) / cell).to_array().map(|at| (at as usize).min(LIGHT_CELLS - 1));
        (at[2] * LIGHT_CELLS + at[1]) * LIGHT_CELLS + at[0]
    };
    let of_particle = |p: &Particle| {
        let age = f64::from(p.age) / f64::from(p.life);
        let height = radius * smoothstep(0.0, 0.15, age) * (1.0 - 0.5 * age) * (0.75 + 0.25 * p.own[1]);
        let square = 4.0 * HALF_SQUARE.x * HALF_SQUARE.y * height * height;
        let at = age.min(1.0) * AGES as f64;
        let before = (at as usize).min(AGES - 1);
        table[before].lerp(table[before + 1], at - before as f64) * (factor * square / std::f64::consts::PI)
    };
    let mut lights = Vec::new();
    for cell_number in 0..LIGHT_CELLS.pow(3) {
        let inside: Vec<_> = there.iter().filter(|particle| number(particle) == cell_number).collect();
        if !inside.is_empty() {
            lights.push(Light {
                place: inside.iter().map(|p| p.position).sum::<DVec3>() / inside.len() as f64,
                // A box's radius of gyration, and a flame's own radius.
                radius: (cell.length_squared() / 12.0 + radius * radius).sqrt(),
                intensity: inside.iter().map(|p| of_particle(p)).sum(),
            });
        }
    }
    lights
}

/// Radiance of a white surface by the lights: of a ball, as far as it is above the surface's horizon.
pub fn irradiance(lights: &[Light], place: DVec3, normal: DVec3) -> DVec3 {
    let of = |light: &Light| {
        let way = light.place - place;
        let squared = way.length_squared() + light.radius * light.radius;
        let (sine, cosine) = (light.radius / squared.sqrt(), normal.dot(way) / squared.sqrt());
        light.intensity * ((cosine + sine) / (1.0 + sine)).max(0.0) / squared
    };
    lights.iter().map(of).sum()
}
