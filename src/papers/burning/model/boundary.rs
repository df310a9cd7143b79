//! The irregular heat boundary of 3.3: the radius at which it reaches each point of the object at rest.
//!
//! R² = psi d² (1 + a (sin(pi Theta / delta) + sin pi Theta) / 2), the least over the sources. Printed, the sines stand
//! beside the squared distance without a scale and delta is the growth of a frame; with fixed a and delta the boundary
//! looks alike at any size of object and any frame rate. Theta is a smooth noise of the position and not of the time,
//! so that a point once inside stays inside.

use std::f64::consts::PI;

use glam::{DVec3, IVec3, Vec3};

/// a: reach of the irregularity.
const IRREGULARITY: f64 = 0.3;
/// delta, in position of the paper's growth of the radius a frame.
const DELTA: f64 = 0.25;
/// Wavelength of Theta, a fraction of the diagonal.
const WAVELENGTH: f64 = 1.0 / 8.0;

/// R of a point of the object at rest by the squared length of the fire's way to it, diagonals.
pub fn distance(rest: Vec3, squared_way: f64, psi: f32, seed: u32) -> f64 {
    let angle = 2.0 * noise(rest.as_dvec3() / WAVELENGTH, seed);
    let ripple = 0.5 * ((PI * angle / DELTA).sin() + (PI * angle).sin());
    (f64::from(psi) * squared_way * (1.0 + IRREGULARITY * ripple)).sqrt()
}

/// Squared length of the straight way from the nearest source, as in the text.
pub fn straight(rest: Vec3, sources: &[Vec3]) -> f64 {
    let rest = rest.as_dvec3();
    sources.iter().map(|s| (rest - s.as_dvec3()).length_squared()).fold(f64::INFINITY, f64::min)
}

/// Smooth noise in [0, 1): random values at whole positions, blended by quintics.
fn noise(position: DVec3, seed: u32) -> f64 {
    let cell = position.floor();
    let t = position - cell;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let cell = cell.as_ivec3();
    let blend = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along_x =
        |y, z| blend(corner(cell + IVec3::new(0, y, z), seed), corner(cell + IVec3::new(1, y, z), seed), fade.x);
    let along_y = |z| blend(along_x(0, z), along_x(1, z), fade.y);
    blend(along_y(0), along_y(1), fade.z)
}

/// A multiple of 2^-32 in [0, 1) for each whole position.
fn corner(position: IVec3, seed: u32) -> f64 {
    let [x, y, z] = position.to_array().map(|c| c as u32);
    f64::from(scramble(x ^ scramble(y ^ scramble(z ^ scramble(seed))))) / 4_294_967_296.0
}

/// Integer hash with full avalanche, the shaders' own.
fn scramble(value: u32) -> u32 {
    let mut h = value;
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^ (h >> 16)
}
