//! The crust of a fluid's surface in more detail than its particles have (chapter 3): ropes, pieces with gaps between them, and seams between
//! toes. Ours.
//!
//! ```text
//! surface-temperature ─► surface-motion ─► crust-relief ─► crust-normals ─► stage three
//! ```

mod crust_normals;
mod crust_relief;
mod surface_motion;

use std::sync::Arc;

use ash::vk;

use self::crust_normals::crust_normals;
use self::crust_relief::crust_relief;
use self::surface_motion::surface_motion;
use super::sph::crust::stiffness;
use super::sph::surface_temperature::SurfaceTemperature;
use super::sph::toes::toe_of;
use super::sph::{FlowConstants, Scale, Sph};
use super::targets::{Context, FLOATS};
use crate::gpu::transfer::upload_each;
use crate::gpu::{Error, Frame, Image, ImageDesc, ImageView, Pass};
use crate::host_block;

/// Depth of lava that bears all of the relief, in distances of particles.
const LEAST_DEPTH: f64 = 1.5;
/// Depth of the seam between two toes, likewise.
const SEAM_DEPTH: f64 = 1.5;

host_block! {
    struct CrustConstants {
        rope_m: f32,
        piece_m: f32,
        jumble: f32,
        healing_s: f32,
        kept: f32,
        melt_k: f32,
        solidus_k: f32,
        ambient_k: f32,
        radiance: f32,
        least_m: f32,
        seam_m: f32,
    }
}

host_block! {
    struct SideConstants {
        space_m: [f32; 2],
    }
}

/// The passes.
pub struct Relief {
    surface_motion: Pass,
    crust_relief: Pass,
    crust_normals: Pass,
    flow: FlowConstants,
    sides: SideConstants,
    /// Speed along x and z in metres per second, mean temperature of the lava in kelvin and its depth in metres, on the surface's grid.
    pub motion: Arc<ImageView>,
    /// Normals of the crust in RGB, its heights in metres in alpha, on its own grid as all that follows.
    pub normal_height: Arc<ImageView>,
    /// As [`SurfaceTemperature::temperatures`].
    pub temperatures: Arc<ImageView>,
    /// As [`SurfaceTemperature::carried`].
    pub carried: Arc<ImageView>,
}

impl Relief {
    /// Of a fluid's surface; `None` where its crust has no relief.
    ///
    /// # Errors
    /// Errors of the Vulkan layer. The caller has validated the parameters.
    pub fn new(
        context: Context<'_>,
        sph: &Sph,
        surface: &Arc<ImageView>,
        surface_temperature: &SurfaceTemperature,
    ) -> Result<Option<Self>, Error> {
        let parameters = context.parameters;
        let (flow, heat) = (&parameters.flow, &parameters.flow.heat);
        let Some(detail) = flow.crust.detail(parameters) else { return Ok(None) };
        let stored = |name: &str, detail: u32| {
            let (width, height) = (detail * surface.width(), detail * surface.height());
            let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
            Image::new(context.device(), ImageDesc::new_2d(context.name(name), FLOATS, width, height).usage(usage))?
                .view()
        };
        let spacing_m = Scale::of(parameters).spacing_m;
        let toes = flow.vent.toes(parameters);
        let toe_of = |particle: usize| toe_of(&toes, particle as f64 * spacing_m.powi(3));
        let (name, usage) = (context.name("toes"), vk::BufferUsageFlags::STORAGE_BUFFER);
        let toe_of_each = upload_each(context.device(), &name, usage, parameters.particles as usize, toe_of)
            .map_err(|error| error.set_by("particles"))?;
        let constants = CrustConstants {
            rope_m: flow.crust.rope_m(stiffness(flow)) as f32,
            piece_m: flow.crust.piece_m(spacing_m) as f32,
            jumble: flow.crust.jumble,
            healing_s: flow.crust.healing_s,
            kept: flow.crust.pieces.max(1.0).powi(-3),
            melt_k: heat.melt_k,
            solidus_k: heat.solidus_k,
            ambient_k: heat.ambient_k,
            radiance: heat.crust_radiance(spacing_m) as f32,
            least_m: (LEAST_DEPTH * spacing_m) as f32,
            seam_m: if toes.is_empty() { 0.0 } else { (SEAM_DEPTH * spacing_m) as f32 },
        };
        let crust = context.upload("crust", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&constants))?;
        let motion = stored("surface-motion", 1)?;
        let heights = stored("crust-heights", detail)?;
        let temperatures = stored("crust-temperatures", detail)?;
        let carried = stored("crust-carried", detail)?;
        let normal_height = stored("crust-normals", detail)?;
        let coarse = [&motion, &surface_temperature.temperatures, &surface_temperature.carried];
        Ok(Some(Relief {
            surface_motion: surface_motion(context, sph, surface, &motion)?,
            crust_relief: crust_relief(
                context,
                sph,
                coarse,
                [&crust, &toe_of_each],
                [&heights, &temperatures, &carried],
            )?,
            crust_normals: crust_normals(context, &heights, &normal_height)?,
            flow: sph.constants,
            sides: SideConstants { space_m: [parameters.space_m.x, parameters.space_m.z] },
            motion,
            normal_height,
            temperatures,
            carried,
        }))
    }

    /// After `surface-temperature`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.surface_motion, |dispatch| {
            dispatch.constants(&self.flow).threads(self.motion.width(), self.motion.height(), 1)
        })?;
        let (columns, rows) = (self.normal_height.width(), self.normal_height.height());
        frame.compute(&self.crust_relief, |dispatch| dispatch.constants(&self.flow).threads(columns, rows, 1))?;
        frame.compute(&self.crust_normals, |dispatch| dispatch.constants(&self.sides).threads(columns, rows, 1))
    }
}
