//! Pass `caustics-map-floor`: the triangles of `caustics-map` on the same target with an empty fragment stage, nothing
//! shaded. No frame contains it; it tells what vertices and rasterisation cost alone.

use super::caustics_map::{CausticsMap, draw_planes, intersections};
use super::illumination_volumes::IlluminationVolumes;
use super::receiver::LitReceiver;
use super::resources::{BLACK, Context};
use super::water_surface::WaterSurface;
use crate::gpu::{Blend, Error, Frame, Pass};

/// The pass.
pub struct CausticsMapFloor {
    pass: Pass,
}

impl CausticsMapFloor {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        water: &WaterSurface,
        caustics: &CausticsMap,
    ) -> Result<Self, Error> {
        let pass = intersections("caustics-map-floor", "4.5", "common/empty.frag", volumes, water)
            .color(&caustics.map, BLACK, Blend::Masked)
            .build(context.shaders)?;
        Ok(CausticsMapFloor { pass })
    }

    /// Draws the planes of the last frame. It spoils the caustics map.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver, volumes: &IlluminationVolumes) -> Result<(), Error> {
        draw_planes(frame, &self.pass, lit, &lit.cells, volumes)
    }
}
