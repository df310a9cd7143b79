//! Pass `caustics-map` (sections 4.4 and 4.5): the intersection triangles of every plane, the light of each added up.

use std::sync::Arc;

use super::coverage::Coverage;
use super::illumination_volumes::IlluminationVolumes;
use super::intersections::{Intersections, Scope};
use super::planes::Cell;
use super::receiver::LitReceiver;
use super::resources::{BLACK, CAUSTICS, Context};
use super::shadow_map::ShadowMap;
use super::water_surface::WaterSurface;
use crate::gpu::{Blend, Error, Frame, ImageView};

/// The pass.
pub struct CausticsMap {
    intersections: Intersections,
    /// The same triangles with nothing shaded. It draws on the map and spoils it; no frame contains it.
    pub floor: Intersections,
    coverage: Option<Coverage>,
    /// I_c of eq. 4-18 for light of unit intensity.
    pub map: Arc<ImageView>,
}

impl CausticsMap {
    /// The level map's, with its position map: a plane lights the texels whose height lies in its cell (figure 4-15,
    /// steps 2.1 to 2.3). The volumetric method's, without: a plane at a time, which lights every texel that it meets
    /// (figure 5-4).
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        water: &WaterSurface,
        position_map: Option<&Arc<ImageView>>,
        shadows: Option<&ShadowMap>,
    ) -> Result<Self, Error> {
        let multiple = context.parameters.coverage;
        let map = context.map("caustics-map", CAUSTICS)?;
        let drawn =
            if multiple == 1 { map.clone() } else { context.multiple_of_map("caustics-map-drawn", CAUSTICS)? };
        let scope = Scope { context, volumes, water, position_map, shadows };
        let intersections = Intersections::new(scope, |pass| pass.color(&drawn, BLACK, Blend::Add))?;
        let floor = Intersections::floor(scope, |pass| pass.color(&drawn, BLACK, Blend::Masked))?;
        let coverage = (multiple > 1).then(|| Coverage::new(context, &drawn, &map)).transpose()?;
        Ok(CausticsMap { intersections, floor, coverage, map })
    }

    /// Clears the map and adds the light of these planes.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &self,
        frame: &mut Frame<'_>,
        lit: &LitReceiver,
        planes: &[Cell],
        volumes: &IlluminationVolumes,
    ) -> Result<(), Error> {
        self.intersections.record(frame, lit, planes, volumes)?;
        self.coverage.as_ref().map_or(Ok(()), |coverage| coverage.record(frame))
    }
}
