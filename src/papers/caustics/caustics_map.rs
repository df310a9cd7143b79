//! Pass `caustics-map` (sections 4.4 and 4.5): the intersection triangles of every plane, the light of each added up.

use std::sync::Arc;

use glam::DVec3;

use super::illumination_volumes::{IlluminationVolumes, Ray};
use super::planes::Cell;
use super::receiver::LitReceiver;
use super::resources::{BLACK, CAUSTICS, Context};
use super::water_surface::WaterSurface;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    /// Constants of one plane's draw.
    pub struct PlaneConstants {
        center: [f32; 2],
        to_clip: [f32; 2],
        height: f32,
        lower: f32,
        upper: f32,
        absorption_per_m: f32,
        texel_area_m2: f32,
        _pad: [f32; 3],
        up: [f32; 3],
    }
}

impl PlaneConstants {
    fn new(lit: &LitReceiver, cell: &Cell, volumes: &IlluminationVolumes) -> Self {
        let extent = lit.aligned.extent;
        let offset = lit.aligned.center - volumes.reference;
        let texels = f64::from(lit.map_size).powi(2);
        PlaneConstants {
            center: [offset.x as f32, offset.z as f32],
            to_clip: [(2.0 / extent.x) as f32, (2.0 / extent.z) as f32],
            height: (offset.y + f64::from(cell.plane)) as f32,
            lower: cell.lower,
            upper: cell.upper,
            absorption_per_m: lit.absorption_per_m,
            texel_area_m2: (extent.x * extent.z / texels) as f32,
            _pad: [0.0; 3],
            up: volumes.axes.along(DVec3::Y).as_vec3().to_array(),
        }
    }
}

/// The pass.
pub struct CausticsMap {
    pass: Pass,
    /// I_c of eq. 4-18 for light of unit intensity.
    pub map: Arc<ImageView>,
}

impl CausticsMap {
    /// The level map's: a plane lights the texels whose height lies in its cell (figure 4-15, steps 2.1 to 2.3).
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn of_level_map(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        water: &WaterSurface,
        position_map: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let builder = intersections("caustics-map", "4.4, 4.5", "caustics/caustics-map.frag", volumes, water);
        Self::build(context, builder.with("position_map", position_map).with("nearest", context.nearest))
    }

    /// The volumetric method's: a plane at a time, which lights every texel that it meets (figure 5-4).
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn of_sample_plane(
        context: Context<'_>,
        volumes: &IlluminationVolumes,
        water: &WaterSurface,
    ) -> Result<Self, Error> {
        let fragment = "caustics/caustics-map-plane.frag";
        Self::build(context, intersections("caustics-map", "5.2.1", fragment, volumes, water))
    }

    fn build(context: Context<'_>, builder: PassBuilder) -> Result<Self, Error> {
        let map = context.map("caustics-map", CAUSTICS)?;
        Ok(CausticsMap { pass: builder.color(&map, BLACK, Blend::Add).build(context.shaders)?, map })
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
        draw_planes(frame, &self.pass, lit, planes, volumes)
    }
}

/// A pass that draws the intersection triangles of the volumes with a plane.
pub fn intersections(
    name: &'static str,
    section: &'static str,
    fragment: &str,
    volumes: &IlluminationVolumes,
    water: &WaterSurface,
) -> PassBuilder {
    Pass::graphics(name, section, "caustics/caustics-map.vert", fragment)
        .vertices::<Ray>(&volumes.rays)
        .indices(&water.indices)
        .constants::<PlaneConstants>()
}

/// Draws the intersection triangles of each plane.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn draw_planes(
    frame: &mut Frame<'_>,
    pass: &Pass,
    lit: &LitReceiver,
    planes: &[Cell],
    volumes: &IlluminationVolumes,
) -> Result<(), Error> {
    frame.graphics(pass, |draw| {
        for cell in planes {
            draw.constants(&PlaneConstants::new(lit, cell, volumes)).indices(volumes.index_count);
        }
    })
}
