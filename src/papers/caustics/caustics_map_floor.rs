//! Pass `caustics-map-floor`: the triangles of `caustics-map` on the same target with an empty fragment stage, nothing
//! shaded. No frame contains it; it tells what vertices and rasterisation cost alone.

use super::caustics_map::{CausticsMap, intersections};
use super::illumination_volumes::IlluminationVolumes;
use super::resources::{BLACK, Context};
use super::water_surface::WaterSurface;
use crate::gpu::{Blend, Error, Pass};

/// The pass, which draws on the caustics map and spoils it; [`draw_planes`](super::caustics_map::draw_planes) records
/// it.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn caustics_map_floor(
    context: Context<'_>,
    volumes: &IlluminationVolumes,
    water: &WaterSurface,
    caustics: &CausticsMap,
) -> Result<Pass, Error> {
    intersections("caustics-map-floor", "4.5", "common/empty.frag", volumes, water)
        .color(&caustics.map, BLACK, Blend::Masked)
        .build(context.shaders)
}
