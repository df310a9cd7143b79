//! `light-attenuation`: what the gas takes of the light on visible fragments (section "Shadowing of the gas").

use std::sync::Arc;

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::context::Context;
use super::densities::Densities;
use super::parameters::March;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, Pass};

/// The pass `light-attenuation`.
pub struct LightAttenuation {
    /// The fraction of each light that the gas takes, 0 to 1: for each fragment, each light's.
    pub attenuations: Arc<Buffer>,
    pass: Pass,
}

impl LightAttenuation {
    /// By the table where there are `shadow_sums`, else by tracing.
    ///
    /// # Errors
    /// [`Error::Limit`] for a capacity beyond what the device binds.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        sections: &Arc<Buffer>,
        densities: &Densities,
        shadow_sums: Option<&Arc<Buffer>>,
    ) -> Result<Self, Error> {
        let count = u64::from(lists.capacity.fragments) * context.parameters.lights.len() as u64;
        let attenuations = context.storage::<f32>("light-attenuations", count)?;
        let shader = match shadow_sums {
            Some(_) => format!("gas/light-attenuation-table-{}.comp", context.parameters.count_shader()),
            None if context.parameters.march == March::Delta => {
                format!("gas/light-attenuation-ratio-{}.comp", context.parameters.density_shader())
            }
            None => format!("gas/light-attenuation-traced-{}.comp", context.parameters.ray_shader()),
        };
        let pass = Pass::compute("light-attenuation", "Shadowing of the gas", &shader)
            .with("frame", &scene.frame)
            .with("counts", &scene.counts)
            .with("Volumes", &scene.volumes)
            .with("Lights", &scene.lights)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Sections", sections)
            .with("Attenuations", &attenuations)
            .with("Progress", &lists.progress.states)
            .with("Unfinished", &lists.progress.unfinished)
            .constants::<BandConstants>();
        let pass = match shadow_sums {
            Some(sums) => pass.with("ShadowTables", sums),
            None => densities.of_rays(scene, pass),
        };
        let pass = pass.build(context.shaders)?;
        Ok(LightAttenuation { attenuations, pass })
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        band.dispatch_in_parts(calls, frame, &self.pass)
    }
}
