//! Section 4: normal and illumination on the device, and shadows, whoever found the depth.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::scene::DeviceScene;
use super::stage::Stage;
use crate::gpu::{Error, Frame, ImageView, Load, Pass, ShaderLibrary};
use crate::papers::Target;

/// The passes `normal`, once for each map, and `illumination`.
pub struct Lighting {
    stage: Stage,
    depth: Arc<ImageView>,
    normal: Arc<ImageView>,
    pub picture: Arc<ImageView>,
    normal_passes: Vec<Pass>,
    /// What the maps leave of the sunlight.
    shadow: Option<Arc<ImageView>>,
    shadow_passes: Vec<Pass>,
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
        let program = format!("normal-{}", parameters.interpolation.word());
        let mut normal_passes = Vec::new();
        for (i, map) in scene.maps.iter().enumerate() {
            let load = if i == 0 { Load::Discard } else { Load::Keep };
            let pass = stage.say(
                ("normal", "4"),
                &program,
                (&normal, load),
                &[("land", (&map.land).into()), ("levels", (&map.levels.view).into()), ("depth", depth.into())],
            );
            normal_passes.push(pass.build(shaders)?);
        }
        let program = format!("shadow-{}-{}", parameters.base.kind(), parameters.interpolation.word());
        let mut shadow_passes = Vec::new();
        let mut shadow = scene.all_lit.clone();
        if parameters.shadows {
            let shadows = (0..scene.maps.len().min(2))
                .map(|_| image("shadow", vk::Format::R32_SFLOAT))
                .collect::<Result<Vec<_>, _>>()?;
            for (map, target) in scene.maps.iter().zip(shadows.iter().cycle()) {
                let pass = stage.say(
                    ("shadow", "2"),
                    &program,
                    (target, Load::Discard),
                    &[
                        ("land", (&map.land).into()),
                        ("levels", (&map.levels.view).into()),
                        ("depth", depth.into()),
                        ("prior", (&shadow).into()),
                    ],
                );
                shadow_passes.push(pass.build(shaders)?);
                shadow = target.clone();
            }
        }
        let illumination = stage.say(
            ("illumination", "4"),
            "illumination",
            (&picture, Load::Discard),
            &[
                ("light", (&scene.light).into()),
                ("depth", depth.into()),
                ("normal", (&normal).into()),
                ("shadow", (&shadow).into()),
                ("drape", (&scene.drape).into()),
            ],
        );
        let illumination = illumination.build(shaders)?;
        let shadow = parameters.shadows.then_some(shadow);
        Ok(Lighting {
            stage,
            depth: depth.clone(),
            normal,
            picture,
            normal_passes,
            shadow,
            shadow_passes,
            illumination,
        })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        for pass in self.normal_passes.iter().chain(&self.shadow_passes) {
            self.stage.record(frame, pass, &self.normal)?;
        }
        self.stage.record(frame, &self.illumination, &self.picture)
    }

    /// What the rays or the grids found.
    pub fn depth(&self) -> &Arc<ImageView> {
        &self.depth
    }

    pub fn targets(&self) -> Vec<Target> {
        let mut targets = vec![Target::image("depth", &self.depth), Target::image("normal", &self.normal)];
        targets.extend(self.shadow.iter().map(|shadow| Target::image("shadow", shadow)));
        targets
    }
}
