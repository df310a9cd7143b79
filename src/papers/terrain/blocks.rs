//! What the shaders read besides textures.

use glam::{DVec2, DVec3, Vec3};

use super::ground::Ground;
use super::parameters::{Interpolation, Parameters};
use super::placement::Rays;
use crate::host_block;

host_block! {
    /// A map and how the camera sees it; `shaders/terrain/land.glsl` says what each is.
    pub struct LandBlock {
        pub eye: [f32; 4],
        pub corner: [f32; 4],
        pub across: [f32; 4],
        pub down: [f32; 4],
        pub bounds: [f32; 4],
        pub margin: [f32; 4],
        pub sundry: [f32; 4],
        pub size: [i32; 4],
        pub form: [i32; 4],
        pub curve: [f32; 4],
        pub middle: [f32; 4],
        pub steps: [f32; 4],
        pub shell: [f32; 4],
        pub slope: [f32; 4],
        pub ground: [f32; 4],
        pub east: [f32; 4],
        pub up: [f32; 4],
        pub south: [f32; 4],
        pub sun: [f32; 4],
    }
}

host_block! {
    pub struct LightBlock {
        pub corner: [f32; 4],
        pub across: [f32; 4],
        pub down: [f32; 4],
        pub sun: [f32; 4],
        pub haze: [f32; 4],
        pub range: [f32; 4],
        pub drape: [f32; 4],
    }
}

/// What rounding may cost a coordinate, as a share of the largest number that it is made of.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;
/// How near a height counts as met where a root is approached, as a share of a cell.
const MET: f64 = 2.5e-4;
/// The haze's colour, linear: the sky at the horizon.
const HAZE: Vec3 = Vec3::new(0.42, 0.53, 0.66);
/// The strength of the sky's light.
const SKY: f32 = 0.45;

fn four(v: DVec3, w: f64) -> [f32; 4] {
    v.extend(w).as_vec4().to_array()
}

fn pairs(a: DVec2, b: DVec2) -> [f32; 4] {
    [a.x, a.y, b.x, b.y].map(|v| v as f32)
}

impl LandBlock {
    /// Of the map that is number `index`; `rays` are the world's.
    pub fn new(ground: &Ground, parameters: &Parameters, is_float: bool, index: u32, rays: &Rays, near_m: f32) -> Self {
        let seen = rays.in_map(&ground.to_frame);
        let shape = ground.shape;
        let side = f64::from(shape.width.max(shape.height));
        let (spacing, unit) = (ground.spacing_m.min_element(), ground.unit_m);
        // How far away the eye is, in nodes and in heights.
        let (away, above) = match &ground.curve {
            None => (seen.eye.x.abs().max(seen.eye.y.abs()), seen.eye.z.abs()),
            Some(_) => (2.0 * seen.eye.length() / spacing, seen.eye.length() / unit),
        };
        let overshoot = match parameters.interpolation {
            Interpolation::Bilinear => 0.0,
            Interpolation::Bicubic => (ground.highest - ground.lowest) * 9.0 / 32.0,
        };
        // The ground is solid down to the base, so a ray may meet it below its lowest sample.
        let lowest = (ground.lowest - overshoot).min(ground.base);
        let bounds = [lowest, ground.highest + overshoot, ground.base, unit];
        let height = bounds[0].abs().max(bounds[1].abs()).max(ground.base.abs()).max(above);
        let (axis_u, axis_v) = shape.axis();
        let kind = ground.curve.as_ref().map_or(0, |curve| if curve.is_cylinder { 1 } else { 2 });
        let [east, up, south] = ground.axes.map(|axis| four(axis, 0.0));
        let flat = LandBlock {
            eye: four(seen.eye, rays.pixel_m() / ground.spacing_m.max_element()),
            corner: four(seen.corner, 0.0),
            across: four(seen.across, 0.0),
            down: four(seen.down, 0.0),
            bounds: bounds.map(|v| v as f32),
            margin: pairs(DVec2::new(side.max(away), height) * ROUNDING, ground.spacing_m),
            sundry: [(MET * spacing / unit) as f32, index as f32, near_m, 0.0],
            size: [shape.width, shape.height, shape.top, shape.side()].map(|v| v as i32),
            form: [axis_u as i32, axis_v as i32, is_float.into(), kind],
            curve: [0.0; 4],
            middle: [0.0; 4],
            steps: [0.0; 4],
            shell: [0.0; 4],
            slope: [0.0; 4],
            ground: [0.0; 4],
            east,
            up,
            south,
            sun: four(
                ground.to_frame.transform_vector3(parameters.sun.direction().as_dvec3()),
                ground.spacing_m.max_element(),
            ),
        };
        let Some(curve) = &ground.curve else { return flat };
        let (sine, cosine) = curve.latitude_rad.sin_cos();
        let (shell, base) = (curve.shell(), curve.ground());
        LandBlock {
            curve: pairs(DVec2::new(curve.a, curve.squared_eccentricity), DVec2::new(sine, cosine)),
            middle: pairs(DVec2::new(curve.off_m, curve.middle.x), DVec2::new(curve.middle.y, curve.smallest_radius_m)),
            steps: pairs(curve.steps, DVec2::new(curve.bend, 0.0)),
            shell: pairs(shell.squares, DVec2::new(shell.constant, 0.0)),
            slope: pairs(shell.linear, base.linear),
            ground: pairs(base.squares, DVec2::ZERO),
            ..flat
        }
    }
}

impl LightBlock {
    /// `range_m` is the lowest and the highest above the base, `near_m` the near plane of what is rasterised. Nothing is draped.
    pub fn new(parameters: &Parameters, rays: &Rays, range_m: (f64, f64), near_m: f32) -> Self {
        // A level map has one tint: over a range of nothing, rounding would choose it.
        let rounding_m = 1e-3 * range_m.0.abs().max(1.0);
        let highest_m = range_m.1.max(range_m.0 + rounding_m);
        LightBlock {
            corner: four(rays.corner, 0.0),
            across: four(rays.across, 0.0),
            down: four(rays.down, 0.0),
            sun: parameters.sun.direction().extend(SKY).to_array(),
            haze: HAZE.extend(parameters.haze_per_km / 1000.0).to_array(),
            range: [range_m.0 as f32, highest_m as f32, near_m, 0.0],
            drape: [1.0, 1.0, 0.0, 0.0],
        }
    }
}
