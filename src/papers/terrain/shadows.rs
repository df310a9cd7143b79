//! Rays to the sun from what is seen, through the same levels (optional; section 2 has the sun as a source of light).

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::scene::{DeviceScene, texels};
use super::stage::Stage;
use crate::gpu::{Device, Error, Frame, ImageView, Load, Pass, ShaderLibrary};

/// One pass for each map; none where no shadows are thrown.
pub struct Shadows {
    stage: Stage,
    passes: Vec<Pass>,
    /// What the maps leave of the sunlight: 0 in the shadow, 1 outside. A single texel where no shadows are thrown.
    pub sunlit: Arc<ImageView>,
}

impl Shadows {
    /// The sun reaches everything.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn none(device: &Arc<Device>, label: &str) -> Result<Self, Error> {
        let sunlit = texels(device, &format!("{label}/all-lit"), vk::Format::R32_SFLOAT, (1, 1), |_, bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&1.0_f32));
        })?;
        Ok(Shadows { stage: Stage::Fragment, passes: Vec::new(), sunlit })
    }

    /// Those of the scene's maps on what `depth` has, in passes of that name.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn of_maps(
        shaders: &ShaderLibrary,
        label: &str,
        (stage, name): (Stage, &'static str),
        parameters: &Parameters,
        scene: &DeviceScene,
        depth: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let program = format!("shadow-{}-{}", parameters.base.kind(), parameters.interpolation.as_str());
        let size = (parameters.width, parameters.height);
        let targets = (0..scene.maps.len().min(2))
            .map(|turn| stage.image(device, format!("{label}/{name}-{turn}"), vk::Format::R32_SFLOAT, size))
            .collect::<Result<Vec<_>, _>>()?;
        let Shadows { mut sunlit, mut passes, .. } = Shadows::none(device, &format!("{label}/{name}"))?;
        // Each map's pass reads what the maps before it left.
        for (map, target) in scene.maps.iter().zip(targets.iter().cycle()) {
            let pass = stage.say(
                (name, "2"),
                &program,
                (target, Load::Discard),
                &[
                    ("terrain", (&map.terrain).into()),
                    ("levels", (&map.levels.view).into()),
                    ("depth", depth.into()),
                    ("prior", (&sunlit).into()),
                ],
            );
            passes.push(pass.build(shaders)?);
            sunlit = target.clone();
        }
        Ok(Shadows { stage, passes, sunlit })
    }

    /// Whether any are thrown.
    pub fn are_thrown(&self) -> bool {
        !self.passes.is_empty()
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| self.stage.record(frame, pass, &self.sunlit))
    }
}
