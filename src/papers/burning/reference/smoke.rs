//! Smoke as a volume: the extinction of particles in a grid, and rays through it.

use glam::{DVec2, DVec3, DVec4, IVec3};

use super::super::SMOKE_CELLS;
use super::flames::Particle;
use super::lights::{noise, smoothstep};

/// Cubic cells, [`SMOKE_CELLS`] along each axis, x first.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Corner, diagonals.
    pub low: DVec3,
    /// Side of a cell, diagonals.
    pub width: f64,
}

/// Opacity of the square of smoke of an age summed over it, over the squared half of its side: the mean over particles.
pub fn shown(age: f64) -> f64 {
    const SIDE: u32 = 24;
    const PARTICLES: u32 = 200;
    let middle = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(SIDE) - 1.0;
    let opacity = |at: DVec2, own: f64| {
        let turbulence = noise(1.6 * at + DVec2::new(47.0 * own, 31.0 * own - 1.2 * age));
        let body = (1.0 - at.length() - 0.7 * (turbulence - 0.3)).clamp(0.0, 1.0);
        0.3 * body * smoothstep(0.0, 0.2, age) * (1.0 - age)
    };
    let of_particle = |own: f64| -> f64 {
        (0..SIDE * SIDE).map(|i| opacity(DVec2::new(middle(i % SIDE), middle(i / SIDE)), own)).sum()
    };
    let sum: f64 = (0..PARTICLES).map(|i| of_particle((f64::from(i) + 0.5) / f64::from(PARTICLES))).sum();
    4.0 * sum / f64::from(PARTICLES * SIDE * SIDE)
}

/// Extinction of each cell by smoke particles of a radius: of each what its square shows, shared among the eight cells
/// around it; `body` is the share of [`shown`] that no age has.
pub fn extinctions(smoke: &[Particle], grid: Grid, radius: f64, body: f64) -> Vec<f64> {
    let mut cells = vec![0.0; SMOKE_CELLS.pow(3)];
    for particle in smoke.iter().filter(|particle| particle.life > 0) {
        let age = f64::from(particle.age) / f64::from(particle.life);
        let half_side = radius * (0.45 + 0.55 * age) * (0.75 + 0.25 * particle.own[1]);
        let area = body * 0.3 * smoothstep(0.0, 0.2, age) * (1.0 - age) * half_side * half_side;
        let at = (particle.position - grid.low) / grid.width - 0.5;
        for (cell, weight) in around(at) {
            cells[number(cell)] += area * weight / grid.width.powi(3);
        }
    }
    cells
}

/// Light and opacity of a ray from the eye up to a distance, through cells that hold light times extinction and extinction.
/// `increments` are those of a cell's length.
pub fn marched(cells: &[DVec4], grid: Grid, (eye, ray): (DVec3, DVec3), to: f64, increments: f64) -> DVec4 {
    let high = grid.low + SMOKE_CELLS as f64 * grid.width;
    let (one, other) = ((grid.low - eye) / ray, (high - eye) / ray);
    let from = one.min(other).max_element().max(0.0);
    let to = one.max(other).min_element().min(to);
    if to <= from {
        return DVec4::ZERO;
    }
    let count = ((to - from) * increments / grid.width).ceil();
    let length = (to - from) / count;
    let (mut light, mut transparency) = (DVec3::ZERO, 1.0);
    for i in 0..count as u32 {
        let at = (eye + ray * (from + (f64::from(i) + 0.5) * length) - grid.low) / grid.width - 0.5;
        let most = IVec3::splat(SMOKE_CELLS as i32 - 1);
        let lit: DVec4 = around(at).map(|(cell, weight)| weight * cells[number(cell.clamp(IVec3::ZERO, most))]).sum();
        let kept = (-lit.w * length).exp();
        if lit.w > 0.0 {
            light += transparency * (1.0 - kept) * lit.truncate() / lit.w;
        }
        transparency *= kept;
    }
    light.extend(1.0 - transparency)
}

/// The eight cells around a place, whose middles lie at whole numbers, with their shares.
fn around(at: DVec3) -> impl Iterator<Item = (IVec3, f64)> {
    let (first, t) = (at.floor().as_ivec3(), at - at.floor());
    (0..8).map(move |k| {
        let corner = IVec3::new(k & 1, (k >> 1) & 1, k >> 2);
        let share = |axis: usize| if corner[axis] == 1 { t[axis] } else { 1.0 - t[axis] };
        (first + corner, share(0) * share(1) * share(2))
    })
}

fn number(cell: IVec3) -> usize {
    let [x, y, z] = cell.to_array().map(|at| at as usize);
    (z * SMOKE_CELLS + y) * SMOKE_CELLS + x
}
