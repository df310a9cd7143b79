//! The CPU oracle of the caustics paper: plain `f64` written from the equations, not a port of a shader.
//!
//! The world is right handed with +Y up; the water lies near a height `water_level_m`, the receivers below it. Light
//! directions point from the light into the scene. Every light has unit intensity (its spectrum multiplies outside),
//! and a point light has no falloff: the thesis states none, so I_i is the light's intensity at the water.
//!
//! ```text
//! align_box ─► place_planes ─► position_map ─► depth_profile ─► smart_sub_boxes ─► smart_planes
//!     │                            │
//! illumination_volumes ─► caustics_map ─► combine (with diffuse_map) ─► cast
//! ```
//!
//! Box space has its origin at the box's centre P0 and the axes (U, V, W) as (x, y, z); y grows towards the light. Maps
//! are square and stored row by row: a column runs along +U and a row along +W, texel centres at half integers, so
//! row 0 is at z = -d/2. Looking along -V with U to the right, +W points down the picture.

mod caustics_map;
#[cfg(test)]
mod fixtures;
mod flux;
mod illumination;
mod landed;
mod light;
mod photons;
mod planes;
mod position_map;
mod raster;
mod receiver_box;
mod tracer;
mod water;

pub use caustics_map::{CausticsMap, cast, caustics_map, combine, volumetric};
pub use flux::{flat_water_intensity, flat_water_point_intensity, flux_in_map, flux_reaching_box, flux_through_water};
pub use illumination::{IlluminationVolume, Intersection, illumination_volumes, intensity, intersection_triangle};
pub use landed::{LandedTriangle, landed_map};
pub use light::{AIR, Medium, ReferenceLight, refract, transmitted};
pub use photons::{GRAZING, Photons, correlation};
pub use planes::{Cell, depth_profile, keep_occupied, place_planes, smart_planes, smart_sub_boxes, uniform_epsilon};
pub use position_map::{PositionMap, ReceiverTriangle, diffuse, diffuse_map, position_map};
pub use receiver_box::{ReceiverBox, align_box};
pub use tracer::Tracer;
pub use water::{HeightField, Water, WaterVertex, Wave, spherical_cap_focus, spherical_cap_vertex, wave_vertex};

/// Half width, in texels, of the band around an edge in which a rasteriser with snapped vertices may decide either way.
pub const EDGE_BAND_TEXELS: f64 = 1.0 / 128.0;
