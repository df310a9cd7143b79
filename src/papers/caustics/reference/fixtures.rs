//! Small scenes for the oracle's tests.

use crate::papers::caustics::reference::{
    Medium, ReceiverBox, ReceiverTriangle, ReferenceLight, Water, WaterVertex, Wave, align_box,
};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

pub(super) const WATER: Medium = Medium { refraction_index: 4.0 / 3.0, absorption_per_m: 0.0 };

pub(super) const OVERHEAD: ReferenceLight = ReferenceLight::Parallel { direction: DVec3::NEG_Y };

pub(super) const OBLIQUE: ReferenceLight = ReferenceLight::Parallel { direction: DVec3::new(0.36, -0.8, 0.48) };

pub(super) struct Receiver {
    /// Its faces.
    pub(super) triangles: Vec<ReceiverTriangle>,
}

impl Receiver {
    /// A parametric surface over the unit square in `cells` x `cells` quads.
    fn surface(cells: usize, at: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Self {
        let mut triangles = Vec::new();
        for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
            let corner = |di, dj| at((i + di) as f64 / cells as f64, (j + dj) as f64 / cells as f64);
            let quad = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                triangles.push(ReceiverTriangle {
                    positions: [quad[a].0, quad[b].0, quad[c].0],
                    normals: [quad[a].1, quad[b].1, quad[c].1],
                });
            }
        }
        Self { triangles }
    }

    pub(super) fn positions(&self) -> Vec<DVec3> {
        self.triangles.iter().flat_map(|t| t.positions).collect()
    }

    /// The receiver's box in clear water, the world box being its own.
    pub(super) fn aligned(&self, light: ReferenceLight) -> ReceiverBox {
        let positions = self.positions();
        let low = positions.iter().copied().reduce(DVec3::min).unwrap();
        let high = positions.iter().copied().reduce(DVec3::max).unwrap();
        align_box(light, &positions, (low + high) / 2.0, WATER).unwrap()
    }
}

/// A horizontal square floor of half width `half` at height `y`.
pub(super) fn horizontal(half: f64, y: f64) -> Receiver {
    Receiver::surface(1, |s, t| {
        let point = DVec3::new((2.0 * s - 1.0) * half, y, (2.0 * t - 1.0) * half);
        (point, DVec3::Y)
    })
}

/// A square plane of half width 1 that rises by 0.45 along x and falls by 0.2 along z.
pub(super) fn tilted() -> Receiver {
    let normal = DVec3::new(-0.45, 1.0, 0.2).normalize();
    Receiver::surface(1, |s, t| {
        let (x, z) = (2.0 * s - 1.0, 2.0 * t - 1.0);
        (DVec3::new(x, -2.0 + 0.45 * x - 0.2 * z, z), normal)
    })
}

/// A sphere around (0, -2, 0).
pub(super) fn sphere(cells: usize, radius: f64) -> Receiver {
    Receiver::surface(cells, |s, t| {
        let (around, down) = (TAU * s, PI * t);
        let normal = DVec3::new(down.sin() * around.cos(), down.cos(), down.sin() * around.sin());
        (normal * radius - DVec3::Y * 2.0, normal)
    })
}

pub(super) struct Mesh {
    vertices: Vec<WaterVertex>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// A square water mesh of half width `half` around the origin, `cells` quads a side.
    pub(super) fn grid(cells: u32, half: f64, at: impl Fn(f64, f64) -> WaterVertex) -> Self {
        let line = cells + 1;
        let coordinate = |i: u32| (2.0 * f64::from(i) / f64::from(cells) - 1.0) * half;
        let vertices = (0..line * line).map(|i| at(coordinate(i % line), coordinate(i / line))).collect();
        let triangles = (0..cells * cells)
            .map(|i| i / cells * line + i % cells)
            .flat_map(|i| [[i, i + line, i + 1], [i + 1, i + line, i + line + 1]])
            .collect();
        Self { vertices, triangles }
    }

    pub(super) fn water(&self) -> Water<'_> {
        Water { vertices: &self.vertices, triangles: &self.triangles }
    }
}

/// Two waves whose slopes sum to less than 0.2, with no focus within 3 m.
pub(super) fn gentle_waves() -> Vec<Wave> {
    vec![
        Wave {
            amplitude_m: 0.02,
            direction: DVec2::new(0.8, 0.6),
            wavelength_m: 1.1,
            angular_frequency_rad_s: 2.5,
            phase_rad: 0.3,
        },
        Wave {
            amplitude_m: 0.012,
            direction: DVec2::new(-0.6, 0.8),
            wavelength_m: 1.0,
            angular_frequency_rad_s: 3.5,
            phase_rad: 1.0,
        },
    ]
}

pub(super) fn box_corners(low: DVec3, high: DVec3) -> Vec<DVec3> {
    (0..8)
        .map(|i| {
            let pick = |bit: u32, a: f64, b: f64| if i >> bit & 1 == 0 { a } else { b };
            DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
        })
        .collect()
}
