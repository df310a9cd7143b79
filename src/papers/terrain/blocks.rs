//! What the shaders read besides textures.

use glam::{DVec3, Vec3};

use super::parameters::Parameters;
use super::placement::{Extent, Ground, Rays};
use crate::host_block;

host_block! {
    /// A map and how the camera sees it.
    pub struct LandBlock {
        pub eye: [f32; 4],
        pub corner: [f32; 4],
        pub across: [f32; 4],
        pub down: [f32; 4],
        pub bounds: [f32; 4],
        pub margin: [f32; 4],
        pub turn: [f32; 4],
        pub size: [i32; 4],
        pub form: [i32; 4],
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
    }
}

/// What rounding may cost a coordinate, as a share of the largest number that it is made of.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;
/// The haze's colour, linear: the sky at the horizon.
const HAZE: Vec3 = Vec3::new(0.62, 0.72, 0.82);
/// The strength of the sky's light.
const SKY: f32 = 0.45;

fn four(v: DVec3, w: f64) -> [f32; 4] {
    v.extend(w).as_vec4().to_array()
}

impl LandBlock {
    /// Of the map that is number `index`; `rays` are the world's.
    pub fn new(ground: &Ground, is_float: bool, index: u32, rays: &Rays, near_m: f32) -> Self {
        let seen = rays.in_map(&ground.to_map);
        let shape = ground.shape;
        let side = f64::from(shape.width.max(shape.height));
        let nodes = side.max(seen.eye.x.abs()).max(seen.eye.y.abs()) * ROUNDING;
        let height = ground.highest.abs().max(ground.lowest.abs()).max(seen.eye.z.abs()) * ROUNDING;
        let (axis_u, axis_v) = shape.axis();
        LandBlock {
            eye: four(seen.eye, rays.pixel_m() / ground.spacing_m.max_element()),
            corner: four(seen.corner, 0.0),
            across: four(seen.across, 0.0),
            down: four(seen.down, 0.0),
            bounds: [ground.lowest, ground.highest, ground.base, ground.unit_m].map(|v| v as f32),
            margin: [nodes, height, ground.spacing_m.x, ground.spacing_m.y].map(|v| v as f32),
            turn: [ground.turn_rad.cos() as f32, ground.turn_rad.sin() as f32, near_m, index as f32],
            size: [shape.width, shape.height, shape.top, shape.side()].map(|v| v as i32),
            form: [axis_u as i32, axis_v as i32, is_float.into(), 0],
        }
    }
}

impl LightBlock {
    pub fn new(parameters: &Parameters, rays: &Rays, extent: &Extent) -> Self {
        LightBlock {
            corner: four(rays.corner, 0.0),
            across: four(rays.across, 0.0),
            down: four(rays.down, 0.0),
            sun: parameters.sun.direction().extend(SKY).to_array(),
            haze: HAZE.extend(parameters.haze_per_km / 1000.0).to_array(),
            range: [extent.low.y as f32, extent.high.y as f32, 0.0, 0.0],
        }
    }
}
