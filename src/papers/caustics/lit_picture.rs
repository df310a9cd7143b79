//! Pictures of light that no pass found, such as photons': what a method's picture is judged by.

use std::sync::Arc;

use super::level_map::LevelMap;
use super::{Caustics, Technique};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Device, Error, Frame};

impl Caustics {
    /// Puts I_c of each receiver under each light, light by light, in place of what the last frame found. The hidden surfaces of
    /// `hit` keep theirs.
    ///
    /// # Errors
    /// [`Error::Pass`] for a method without maps of I_c; errors of the Vulkan layer.
    pub fn set_light(&self, device: &Arc<Device>, maps: &[Vec<f32>]) -> Result<(), Error> {
        for (passes, light) in self.with_maps()?.receivers.iter().zip(maps) {
            let map = &passes.caustics_map.map;
            let row = map.width() as usize;
            upload_rows(device, map, (map.width(), map.height()), |first, bytes| {
                let texels = &light[first as usize * row..];
                bytes.copy_from_slice(&bytemuck::cast_slice::<f32, u8>(texels)[..bytes.len()]);
            })?;
        }
        Ok(())
    }

    /// The last frame's picture once more, by the light that was set.
    ///
    /// # Errors
    /// As [`Caustics::set_light`].
    pub fn record_lit_picture(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let LevelMap { receivers, .. } = self.with_maps()?;
        for passes in receivers {
            passes.combine.record(frame)?;
            passes.combine_hidden.iter().try_for_each(|combine| combine.record(frame))?;
        }
        for (lit, passes) in self.lit_receivers.iter().zip(receivers) {
            passes.cast.record(frame, lit, 0.0)?;
        }
        self.is_viewed = true;
        self.view.record(frame)
    }

    fn with_maps(&self) -> Result<&LevelMap, Error> {
        match &self.technique {
            Technique::LevelMap(level_map) => Ok(level_map),
            Technique::Volumetric(_) | Technique::Stencil { .. } => {
                let problem = "this method has no map of all light on a receiver".to_owned();
                Err(Error::Pass { pass: "combine".into(), problem })
            }
        }
    }
}
