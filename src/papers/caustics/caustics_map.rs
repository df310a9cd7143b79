//! Pass `caustics-map` (sections 4.4 and 4.5): the intersection triangles of every plane, the light of each added up.

use std::sync::Arc;

use super::coverage::Coverage;
use super::culled_map::CulledMap;
use super::hidden_surfaces::HiddenSurfaces;
use super::hit_map::HitMap;
use super::illumination_volumes::IlluminationVolumes;
use super::intersections::{Intersections, Scope};
use super::planes::Cell;
use super::receiver::LitReceiver;
use super::resources::{BLACK, CAUSTICS, Context};
use super::shadow_map::ShadowMap;
use super::smart_planes::SmartPlanes;
use super::water_surface::WaterSurface;
use crate::gpu::{Blend, Buffer, Device, Error, Frame, ImageView};

/// The pass.
pub struct CausticsMap {
    drawing: Drawing,
    coverage: Option<Coverage>,
    /// I_c of eq. 4-18 for light of unit intensity.
    pub map: Arc<ImageView>,
}

/// The way in which triangles come to the map.
enum Drawing {
    /// Those of every plane.
    All {
        intersections: Box<Intersections>,
        /// The same triangles with nothing shaded. It draws on the map and spoils it; no frame contains it.
        floor: Box<Intersections>,
    },
    /// Those alone that may light it.
    Culled(Box<CulledMap>),
    /// Each where its light lands.
    Hit(Box<HitMap>),
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
        let Maps { map, drawn, coverage } = Maps::new(context)?;
        let scope = Scope { context, volumes, water, position_map, shadows };
        let intersections = Intersections::new(scope, |pass| pass.color(&drawn, BLACK, Blend::Add))?;
        let floor = Intersections::floor(scope, |pass| pass.color(&drawn, BLACK, Blend::Masked))?;
        let drawing = Drawing::All { intersections: Box::new(intersections), floor: Box::new(floor) };
        Ok(CausticsMap { drawing, coverage, map })
    }

    /// The culled level map's: it sums up what [`CausticsMap::new`] sums up with the same position map.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn culled(
        context: Context<'_>,
        lit: &LitReceiver,
        volumes: &IlluminationVolumes,
        water: &WaterSurface,
        position_map: &Arc<ImageView>,
        shadows: Option<&ShadowMap>,
    ) -> Result<Self, Error> {
        let Maps { map, drawn, coverage } = Maps::new(context)?;
        let scope = Scope { context, volumes, water, position_map: Some(position_map), shadows };
        let culled = CulledMap::new(scope, lit, position_map, &drawn)?;
        Ok(CausticsMap { drawing: Drawing::Culled(Box::new(culled)), coverage, map })
    }

    /// That of the variant `hit`, which has no samples that a coverage could multiply, and the maps of hidden surfaces.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn hit(
        scope: Scope<'_>,
        lit: &LitReceiver,
        position_map: &Arc<ImageView>,
        hidden: Option<&HiddenSurfaces>,
    ) -> Result<Self, Error> {
        let map = scope.context.map("caustics-map", CAUSTICS)?;
        let hit = HitMap::new(scope, lit, [position_map, &map], hidden)?;
        Ok(CausticsMap { drawing: Drawing::Hit(Box::new(hit)), coverage: None, map })
    }

    /// Landing points of the rays of the water's vertices, in the variant `hit`.
    pub fn landings(&self) -> Option<&Arc<Buffer>> {
        match &self.drawing {
            Drawing::Hit(hit) => Some(&hit.landings),
            Drawing::All { .. } | Drawing::Culled(_) => None,
        }
    }

    /// Smart slicing on the device, of the variant `culled`.
    pub fn smart_planes(&self) -> Option<&SmartPlanes> {
        match &self.drawing {
            Drawing::Culled(culled) => culled.smart_planes(),
            Drawing::All { .. } | Drawing::Hit(_) => None,
        }
    }

    /// Fails where light of the last frame is missing.
    ///
    /// # Errors
    /// [`Error::Pass`] where the driver left a loop before its end; errors of the Vulkan layer.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        match &self.drawing {
            Drawing::Hit(hit) => hit.check(device),
            Drawing::All { .. } | Drawing::Culled(_) => Ok(()),
        }
    }

    /// The triangles with nothing shaded, where all of them are drawn.
    pub fn floor(&self) -> Option<&Intersections> {
        match &self.drawing {
            Drawing::All { floor, .. } => Some(floor),
            Drawing::Culled(_) | Drawing::Hit(_) => None,
        }
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
        match &self.drawing {
            Drawing::All { intersections, .. } => intersections.record(frame, lit, planes, volumes)?,
            Drawing::Culled(culled) => culled.record(frame, lit.absorption_per_m)?,
            Drawing::Hit(hit) => hit.record(frame, lit.absorption_per_m)?,
        }
        self.coverage.as_ref().map_or(Ok(()), |coverage| coverage.record(frame))
    }
}

/// The caustics map and what is drawn.
struct Maps {
    map: Arc<ImageView>,
    /// The map itself, or a multiple of it.
    drawn: Arc<ImageView>,
    /// From the multiple to the map.
    coverage: Option<Coverage>,
}

impl Maps {
    fn new(context: Context<'_>) -> Result<Self, Error> {
        let map = context.map("caustics-map", CAUSTICS)?;
        if context.parameters.coverage == 1 {
            return Ok(Maps { drawn: map.clone(), map, coverage: None });
        }
        let drawn = context.multiple_of_map("caustics-map-drawn", CAUSTICS)?;
        let coverage = Coverage::new(context, &drawn, &map)?;
        Ok(Maps { map, drawn, coverage: Some(coverage) })
    }
}
