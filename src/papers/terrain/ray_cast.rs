//! Section 4's second application: the rays on the device.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::stage::Stage;
use crate::gpu::{Error, Frame, ImageView, Load, Pass, ShaderLibrary};

/// The pass `depth`, once for each map.
pub struct RayCast {
    stage: Stage,
    passes: Vec<Pass>,
    /// What all maps' passes found.
    pub depth: Arc<ImageView>,
}

impl RayCast {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        stage: Stage,
        parameters: &Parameters,
        scene: &DeviceScene,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let format = vk::Format::R32G32B32A32_SFLOAT;
        let Parameters { base, interpolation, lod, .. } = parameters;
        let program = format!("depth-{}-{}-{}", base.kind(), interpolation.as_str(), lod.as_str());
        let size = (parameters.width, parameters.height);
        let depths = (0..scene.maps.len().min(2))
            .map(|_| stage.image(device, format!("{label}/depth"), format, size))
            .collect::<Result<Vec<_>, _>>()?;
        let mut passes = Vec::new();
        // Each map's pass reads what the maps before it found.
        let mut depth = scene.nothing.clone();
        for (map, target) in scene.maps.iter().zip(depths.iter().cycle()) {
            let pass = stage.say(
                ("depth", "3"),
                &program,
                (target, Load::Discard),
                &[
                    ("terrain", (&map.terrain).into()),
                    ("levels", (&map.levels.view).into()),
                    ("prior", (&depth).into()),
                ],
            );
            passes.push(pass.build(shaders)?);
            depth = target.clone();
        }
        Ok(RayCast { stage, passes, depth })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| self.stage.record(frame, pass, &self.depth))
    }
}
