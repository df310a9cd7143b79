//! Section 4: normal and illumination on the device, and shadows, whoever found the depth.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::shadows::Shadows;
use super::stage::Stage;
use crate::gpu::{Error, Frame, ImageView, Load, Pass, ShaderLibrary};
use crate::measure::Target;

/// The passes `normal`, once for each map, and `illumination`.
pub struct Lighting {
    stage: Stage,
    depth: Arc<ImageView>,
    normal: Arc<ImageView>,
    pub picture: Arc<ImageView>,
    normal_passes: Vec<Pass>,
    shadows: Shadows,
    illumination: Pass,
}

impl Lighting {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        stage: Stage,
        parameters: &Parameters,
        scene: &DeviceScene,
        depth: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let image = |name: &str, format| {
            stage.image(device, format!("{label}/{name}"), format, (parameters.width, parameters.height))
        };
        let normal = image("normal", vk::Format::R32G32B32A32_SFLOAT)?;
        let picture = image("picture", vk::Format::R8G8B8A8_UNORM)?;
        let program = format!("normal-{}", parameters.interpolation.as_str());
        let mut normal_passes = Vec::new();
        for (i, map) in scene.maps.iter().enumerate() {
            let load = if i == 0 { Load::Discard } else { Load::Keep };
            let pass = stage.say(
                ("normal", "4"),
                &program,
                (&normal, load),
                &[("terrain", (&map.terrain).into()), ("levels", (&map.levels.view).into()), ("depth", depth.into())],
            );
            normal_passes.push(pass.build(shaders)?);
        }
        let shadows = if parameters.shadows {
            Shadows::of_maps(shaders, label, (stage, "shadow"), parameters, scene, depth)?
        } else {
            Shadows::none(device, label)?
        };
        let illumination = stage.say(
            ("illumination", "4"),
            "illumination",
            (&picture, Load::Discard),
            &[
                ("light", (&scene.light).into()),
                ("depth", depth.into()),
                ("normal", (&normal).into()),
                ("shadow", (&shadows.sunlit).into()),
                ("drape", (&scene.drape).into()),
            ],
        );
        let illumination = illumination.build(shaders)?;
        Ok(Lighting { stage, depth: depth.clone(), normal, picture, normal_passes, shadows, illumination })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        for pass in &self.normal_passes {
            self.stage.record(frame, pass, &self.normal)?;
        }
        self.shadows.record(frame)?;
        self.stage.record(frame, &self.illumination, &self.picture)
    }

    /// What the rays or the grids found.
    pub fn depth(&self) -> &Arc<ImageView> {
        &self.depth
    }

    pub fn targets(&self) -> Vec<Target> {
        let mut targets = vec![Target::image("depth", &self.depth), Target::image("normal", &self.normal)];
        if self.shadows.are_thrown() {
            targets.push(Target::image("shadow", &self.shadows.sunlit));
        }
        targets
    }
}
