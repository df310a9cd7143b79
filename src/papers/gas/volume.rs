//! `volume`: the gas of every pixel, marched between its fragments (section "Volume rendering").

use std::sync::Arc;

use super::a_buffer::ABuffer;
use super::band::{Band, BandConstants};
use super::blocks::SectionBlock;
use super::context::Context;
use super::densities::Densities;
use super::parameters::{March, Variant};
use super::scene_buffers::SceneBuffers;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, Error, Frame, ImageView, Pass};

/// The pass `volume`.
pub struct VolumeMarch {
    /// Sections of gas, [`SectionBlock`]s in the slots that `sort` reserved.
    pub sections: Arc<Buffer>,
    pass: Pass,
    /// The gas of a lattice of pixels is marched first, and others take what they can from it.
    has_lattice: bool,
}

impl VolumeMarch {
    /// The gas that `shadow_sums` shadows, those of [`Variant::Table`].
    ///
    /// # Errors
    /// [`Error::Limit`] for a capacity beyond what the device binds.
    pub fn new(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        variant: Variant,
        densities: &Densities,
        shadow_sums: Option<&Arc<Buffer>>,
    ) -> Result<Self, Error> {
        let sections = sections(context, lists)?;
        let parameters = context.parameters;
        let shader = match (parameters.march, variant) {
            (March::Steps, Variant::NoVolume | Variant::None | Variant::Surfaces) => {
                format!("gas/volume-none-{}.comp", parameters.ray_shader())
            }
            (March::Steps, Variant::Traced) => format!("gas/volume-traced-{}.comp", parameters.ray_shader()),
            (March::Steps, Variant::Table | Variant::Froxel) => {
                format!("gas/volume-table-{}.comp", parameters.ray_shader())
            }
            (March::Delta, Variant::NoVolume | Variant::None | Variant::Surfaces) => {
                format!("gas/volume-delta-none-{}.comp", parameters.density_shader())
            }
            (March::Delta, Variant::Traced) => format!("gas/volume-delta-ratio-{}.comp", parameters.density_shader()),
            (March::Delta, Variant::Table | Variant::Froxel) => {
                format!("gas/volume-delta-table-{}.comp", parameters.density_shader())
            }
        };
        let mut pass = with_lists(&shader, scene, lists, &sections).with("Lights", &scene.lights);
        if parameters.march == March::Steps {
            pass = pass.with("Jitter", &scene.jitter);
        }
        pass = scene.glow(parameters, densities.of_rays(scene, pass));
        if let Some(sums) = shadow_sums {
            pass = pass.with("ShadowTables", sums);
        }
        Ok(Self::of(context, pass.build(context.shaders)?, sections))
    }

    /// The gas that was integrated in froxels.
    ///
    /// # Errors
    /// [`Error::Limit`] for a capacity beyond what the device binds.
    pub fn of_froxels(
        context: &Context<'_>,
        scene: &SceneBuffers,
        lists: &ABuffer,
        sums: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let sections = sections(context, lists)?;
        let pass = with_lists("gas/volume-froxel.comp", scene, lists, &sections).with("froxel_sums", sums);
        Ok(Self::of(context, pass.build(context.shaders)?, sections))
    }

    fn of(context: &Context<'_>, pass: Pass, sections: Arc<Buffer>) -> Self {
        VolumeMarch { sections, pass, has_lattice: context.parameters.volume_scale > 1 }
    }

    pub fn record(&self, frame: &mut Frame<'_>, band: Band, calls: u32) -> Result<(), Error> {
        band.dispatch_listed(calls, frame, &self.pass)?;
        if self.has_lattice { band.dispatch_listed_rest(calls, frame, &self.pass) } else { Ok(()) }
    }
}

fn sections(context: &Context<'_>, lists: &ABuffer) -> Result<Arc<Buffer>, Error> {
    context.storage::<SectionBlock>("sections", lists.capacity.sections.into())
}

/// The pass with what every way through the gas goes by.
fn with_lists(shader: &str, scene: &SceneBuffers, lists: &ABuffer, sections: &Arc<Buffer>) -> PassBuilder {
    Pass::compute("volume", "Volume rendering", shader)
        .with("frame", &scene.frame)
        .with("counts", &scene.counts)
        .with("Volumes", &scene.volumes)
        .with("Heads", &lists.heads)
        .with("Links", &lists.links)
        .with("Pixels", &lists.pixels)
        .with("Sections", sections)
        .with("Progress", &lists.progress.states)
        .with("Unfinished", &lists.progress.unfinished)
        .with("GasPixels", &lists.gas_pixels)
        .indirect(&lists.gas_pixels)
        .constants::<BandConstants>()
}
