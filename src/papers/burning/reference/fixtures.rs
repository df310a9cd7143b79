//! Small meshes and a scene around each.

use std::f64::consts::TAU;

use glam::DVec3;

use super::model::{Model, scaled};
use super::{Constants, Parameters, Tick, Variant};

/// A number in [-1, 1] that no pattern shows in.
pub fn wave(i: i32) -> f64 {
    (((f64::from(i) * 12.9898).sin() * 43758.5453).rem_euclid(1.0) - 0.5) * 2.0
}

/// A box with 24 corners, four a side.
pub fn boxed() -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = positions.len();
            let [u, v] = [1, 2].map(|turn| DVec3::AXES[(axis + turn) % 3] * [1.0, 1.6, 0.7][(axis + turn) % 3]);
            let out = DVec3::AXES[axis] * side * [1.0, 1.6, 0.7][axis];
            positions.extend([out - u - v, out + u - v, out + u + v, out - u + v]);
            let square = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| first + i));
            triangles.extend(square.map(|[a, b, c]| if side > 0.0 { [a, b, c] } else { [a, c, b] }));
        }
    }
    (scaled(&positions), triangles)
}

/// A sphere of 20 * 4^`levels` triangles.
pub fn sphere(levels: u32) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let ring = |height: f64, turn: f64| {
        (0..5).map(move |i| {
            let angle = (f64::from(i) + turn) / 5.0 * TAU;
            DVec3::new(angle.cos() * 2.0, height, -angle.sin() * 2.0) / 5f64.sqrt()
        })
    };
    let mut corners: Vec<DVec3> = ring(1.0, 0.0).chain(ring(-1.0, 0.5)).collect();
    corners.extend([DVec3::Y, -DVec3::Y]);
    let triangles: Vec<[usize; 3]> = (0..5)
        .flat_map(|i| {
            let next = (i + 1) % 5;
            [[10, i, next], [i, 5 + i, next], [next, 5 + i, 5 + next], [11, 5 + next, 5 + i]]
        })
        .collect();
    let fine = Model::new(&corners, &triangles, levels, [1; 3]);
    let positions: Vec<DVec3> = fine.rest.iter().map(|p| p.normalize()).collect();
    (scaled(&positions), fine.triangles.iter().map(|t| t.vertices).collect())
}

/// A model with constants that fit it.
pub struct Scene {
    /// Variant under test.
    pub variant: Variant,
    /// Its model.
    pub model: Model,
    /// Its constants.
    pub constants: Constants,
}

impl Scene {
    pub fn refined(positions: &[DVec3], triangles: &[[usize; 3]], variant: Variant, levels: u32) -> Self {
        Self::around(Model::new(positions, triangles, levels, [3, 4, 3]), variant)
    }

    /// Lit at the lowest vertex, the highest if it melts.
    pub fn around(model: Model, variant: Variant) -> Self {
        let mut rest = model.rest.clone();
        rest.sort_by(|a, b| a.y.total_cmp(&b.y));
        let source = if variant == Variant::Melting { rest[rest.len() - 1] } else { rest[0] };
        let constants = Constants::new(&Parameters::default(), &model, &[source], 0.0);
        Scene { variant, model, constants }
    }

    pub fn of(positions: &[DVec3], triangles: &[[usize; 3]], variant: Variant) -> Self {
        Self::refined(positions, triangles, variant, 0)
    }

    /// 1,280 triangles.
    pub fn sphere(variant: Variant) -> Self {
        let (positions, triangles) = sphere(3);
        Self::of(&positions, &triangles, variant)
    }

    pub fn tick(&self) -> Tick<'_> {
        Tick { variant: self.variant, model: &self.model, constants: &self.constants }
    }
}
