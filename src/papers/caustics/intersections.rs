//! The intersection triangles of the illumination volumes with planes (section 4.4): how a pass draws them by the
//! thesis's own reading, and beside it.

use std::sync::Arc;

use glam::DVec3;

use super::illumination_volumes::{IlluminationVolumes, Ray};
use super::parameters::IntensityRule;
use super::planes::Cell;
use super::receiver::LitReceiver;
use super::resources::Context;
use super::shadow_map::ShadowMap;
use super::water_surface::WaterSurface;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    /// Constants of one plane's draw.
    struct PlaneConstants {
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

host_block! {
    /// The same beside the thesis's reading.
    pub(super) struct OptionConstants {
        center: [f32; 2],
        to_clip: [f32; 2],
        height: f32,
        lower: f32,
        upper: f32,
        absorption_per_m: f32,
        texel_area_m2: f32,
        coverage: u32,
        by_vertex: u32,
        columns: u32,
        up: [f32; 3],
        rows: u32,
        shadow_center: [f32; 2],
        shadow_texels_per_m: [f32; 2],
        shadow_middle: f32,
        shadow_top: f32,
        receiver: f32,
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
            height: cell.height(offset.y),
            lower: cell.lower,
            upper: cell.upper,
            absorption_per_m: lit.absorption_per_m,
            texel_area_m2: (extent.x * extent.z / texels) as f32,
            _pad: [0.0; 3],
            up: volumes.axes.along(DVec3::Y).as_vec3().to_array(),
        }
    }
}

impl OptionConstants {
    /// The same in water of that absorption.
    pub(super) fn absorbing(self, absorption_per_m: f32) -> Self {
        OptionConstants { absorption_per_m, ..self }
    }
}

/// Resources of a pass that draws intersection triangles.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    /// Device, shaders and parameters.
    pub context: Context<'a>,
    /// Refracted rays of the water's vertices, which bound the illumination volumes.
    pub volumes: &'a IlluminationVolumes,
    /// The water's mesh.
    pub water: &'a WaterSurface,
    /// Heights that decide which plane lights a texel; none where every plane lights all that it meets.
    pub position_map: Option<&'a Arc<ImageView>>,
    /// Occluders, when receivers cast shadows on one another.
    pub shadows: Option<&'a ShadowMap>,
}

/// Numbers of a configuration that departs from the thesis's reading; those of the plane are zero.
#[derive(Clone, Copy)]
pub(super) struct Options(OptionConstants);

/// A pass that draws the intersection triangles of each plane.
pub struct Intersections {
    pass: Pass,
    options: Option<Options>,
}

impl Intersections {
    /// The pass `caustics-map`, once it has its target.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(scope: Scope<'_>, target: impl FnOnce(PassBuilder) -> PassBuilder) -> Result<Self, Error> {
        let options = Options::of(scope);
        let fragment = match (&options, scope.position_map, scope.shadows) {
            (None, Some(_), _) => "caustics/caustics-map.frag",
            (None, None, _) => "caustics/caustics-map-plane.frag",
            (Some(_), Some(_), None) => "caustics/caustics-map-options-cells-off.frag",
            (Some(_), Some(_), Some(_)) => "caustics/caustics-map-options-cells-on.frag",
            (Some(_), None, None) => "caustics/caustics-map-options-slice-off.frag",
            (Some(_), None, Some(_)) => "caustics/caustics-map-options-slice-on.frag",
        };
        let section = if scope.position_map.is_some() { "4.4, 4.5" } else { "5.2.1" };
        let mut pass = builder("caustics-map", section, fragment, scope, &options);
        if let Some(position_map) = scope.position_map {
            pass = pass.with("position_map", position_map);
        }
        if let Some(shadows) = scope.shadows {
            pass = pass.with("shadow_map", &shadows.map);
        }
        if scope.position_map.is_some() || scope.shadows.is_some() {
            pass = pass.with("nearest", scope.context.nearest);
        }
        Ok(Intersections { pass: target(pass).build(scope.context.shaders)?, options })
    }

    /// The pass `caustics-map-floor`: the same triangles with an empty fragment stage. No frame contains it; it tells
    /// what vertices and rasterisation cost alone.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn floor(scope: Scope<'_>, target: impl FnOnce(PassBuilder) -> PassBuilder) -> Result<Self, Error> {
        let options = Options::of(scope);
        // A vertex shader that `caustics-map` shares with this pass may have been replaced by one that reads what it reads.
        let mut pass = builder("caustics-map-floor", "4.5", "common/empty.frag", scope, &options);
        pass = pass.offer("nearest", scope.context.nearest);
        if let Some(position_map) = scope.position_map {
            pass = pass.offer("position_map", position_map);
        }
        if let Some(shadows) = scope.shadows {
            pass = pass.offer("shadow_map", &shadows.map);
        }
        Ok(Intersections { pass: target(pass).build(scope.context.shaders)?, options })
    }

    /// Draws the intersection triangles of each plane.
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
        frame.graphics(&self.pass, |draw| {
            for cell in planes {
                let plane = PlaneConstants::new(lit, cell, volumes);
                match &self.options {
                    None => draw.constants(&plane),
                    Some(options) => draw.constants(&options.of_plane(plane, lit)),
                }
                .indices(volumes.index_count);
            }
        })
    }
}

fn builder(
    name: &'static str,
    section: &'static str,
    fragment: &str,
    scope: Scope<'_>,
    options: &Option<Options>,
) -> PassBuilder {
    if options.is_some() {
        Pass::graphics(name, section, "caustics/caustics-map-options-all.vert", fragment)
            .with("rays", &scope.volumes.rays)
            .indices(&scope.water.indices)
            .constants::<OptionConstants>()
    } else {
        Pass::graphics(name, section, "caustics/caustics-map.vert", fragment)
            .vertices::<Ray>(&scope.volumes.rays)
            .indices(&scope.water.indices)
            .constants::<PlaneConstants>()
    }
}

impl Options {
    /// `None` for the thesis's own reading.
    pub(super) fn of(Scope { context, volumes, water, shadows, .. }: Scope<'_>) -> Option<Self> {
        let parameters = context.parameters;
        let by_vertex = parameters.intensity == IntensityRule::Vertex;
        if parameters.coverage == 1 && !by_vertex && shadows.is_none() {
            return None;
        }
        let mut constants = OptionConstants {
            coverage: parameters.coverage,
            by_vertex: u32::from(by_vertex),
            columns: water.grid.columns + 1,
            rows: water.grid.rows + 1,
            ..bytemuck::Zeroable::zeroed()
        };
        if let Some(shadow) = shadows {
            [constants.shadow_center, constants.shadow_texels_per_m, [constants.shadow_middle, constants.shadow_top]] =
                shadow.place(volumes.reference);
        }
        Some(Options(constants))
    }

    /// For triangles of all planes of a receiver, which have their planes from elsewhere.
    pub(super) fn of_receiver(&self, lit: &LitReceiver, volumes: &IlluminationVolumes) -> OptionConstants {
        self.of_plane(PlaneConstants::new(lit, &Cell { plane: 0.0, lower: 0.0, upper: 0.0 }, volumes), lit)
    }

    fn of_plane(&self, plane: PlaneConstants, lit: &LitReceiver) -> OptionConstants {
        let PlaneConstants { center, to_clip, height, lower, upper, absorption_per_m, texel_area_m2, up, .. } = plane;
        let texel_area_m2 = texel_area_m2 / (self.0.coverage * self.0.coverage) as f32;
        let receiver = lit.index as f32;
        OptionConstants {
            center,
            to_clip,
            height,
            lower,
            upper,
            absorption_per_m,
            texel_area_m2,
            up,
            receiver,
            ..self.0
        }
    }
}
