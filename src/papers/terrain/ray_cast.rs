//! Section 4's second application: depth, normal and illumination on the device, by compute stages or by full-screen
//! fragment passes.

use std::sync::Arc;

use ash::vk;

use super::hit::NO_DEPTH;
use super::parameters::{Lod, Parameters};
use super::scene::DeviceScene;
use crate::gpu::bindings::Resource;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Blend, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::papers::Target;

/// The stages that a device offers for one program over all pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    Compute,
    Fragment,
}

impl Stage {
    fn file(self, program: &str) -> String {
        format!("terrain/{program}.{}", if self == Stage::Compute { "comp" } else { "frag" })
    }

    fn usage(self) -> vk::ImageUsageFlags {
        let written = match self {
            Stage::Compute => vk::ImageUsageFlags::STORAGE,
            Stage::Fragment => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        written | vk::ImageUsageFlags::SAMPLED
    }
}

/// The passes of both GPU variants.
pub struct RayCast {
    stage: Stage,
    size: (u32, u32),
    depth: Arc<ImageView>,
    normal: Arc<ImageView>,
    pub picture: Arc<ImageView>,
    depth_passes: Vec<Pass>,
    normal_passes: Vec<Pass>,
    illumination: Pass,
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
        let size = (parameters.width, parameters.height);
        let image = |name: &str, format| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, size.0, size.1);
            Image::new(device, desc.usage(stage.usage()))?.view()
        };
        let float = vk::Format::R32G32B32A32_SFLOAT;
        let picture = image("picture", vk::Format::R8G8B8A8_UNORM)?;
        let normal = image("normal", float)?;
        // Each map's pass reads what the maps before it found. Before the first is a single texel: nothing yet.
        let nothing = ImageDesc::new_2d(format!("{label}/nothing"), float, 1, 1);
        let nothing = Image::new(device, nothing.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        upload_rows(device, &nothing, (1, 1), |_, bytes| {
            bytes.copy_from_slice(bytemuck::bytes_of(&[NO_DEPTH, 0.0, 0.0, 0.0]));
        })?;
        let program = match parameters.lod {
            Lod::Exact => "depth-plane-exact",
            Lod::Pixel => "depth-plane-pixel",
        };
        let mut depths = vec![image("depth", float)?];
        if scene.maps.len() > 1 {
            depths.push(image("depth", float)?);
        }
        let mut depth_passes: Vec<Pass> = Vec::new();
        let mut prior = nothing;
        for (i, map) in scene.maps.iter().enumerate() {
            let depth = depths[i % depths.len()].clone();
            let (land, levels) = ((&map.land).into(), (&map.levels.view).into());
            let pass = say(
                stage,
                "depth",
                "3",
                program,
                &depth,
                Load::Discard,
                &[("land", land), ("levels", levels), ("prior", (&prior).into())],
            );
            depth_passes.push(pass.build(shaders)?);
            prior = depth;
        }
        let depth = prior;
        let mut normal_passes = Vec::new();
        for (i, map) in scene.maps.iter().enumerate() {
            let load = if i == 0 { Load::Discard } else { Load::Keep };
            let (land, levels) = ((&map.land).into(), (&map.levels.view).into());
            let pass = say(
                stage,
                "normal",
                "4",
                "normal",
                &normal,
                load,
                &[("land", land), ("levels", levels), ("depth", (&depth).into())],
            );
            normal_passes.push(pass.build(shaders)?);
        }
        let illumination = say(
            stage,
            "illumination",
            "4",
            "illumination",
            &picture,
            Load::Discard,
            &[("light", (&scene.light).into()), ("depth", (&depth).into()), ("normal", (&normal).into())],
        );
        let illumination = illumination.build(shaders)?;
        Ok(RayCast { stage, size, depth, normal, picture, depth_passes, normal_passes, illumination })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        for pass in self.depth_passes.iter().chain(&self.normal_passes).chain([&self.illumination]) {
            match self.stage {
                Stage::Compute => frame.compute(pass, |dispatch| {
                    dispatch.threads(self.size.0, self.size.1, 1);
                })?,
                Stage::Fragment => frame.graphics(pass, |draw| {
                    draw.vertices(3);
                })?,
            }
        }
        Ok(())
    }

    pub fn targets(&self) -> Vec<Target> {
        vec![Target::image("depth", &self.depth), Target::image("normal", &self.normal)]
    }
}

/// One sentence for both stages: a program over all pixels of `target`.
fn say(
    stage: Stage,
    name: &'static str,
    section: &'static str,
    program: &str,
    target: &Arc<ImageView>,
    load: Load,
    resources: &[(&'static str, Resource)],
) -> PassBuilder {
    let sentence = match stage {
        Stage::Compute => Pass::compute(name, section, &stage.file(program)).with(name, target),
        Stage::Fragment => Pass::graphics(name, section, "common/fullscreen.vert", &stage.file(program)).color(
            target,
            load,
            Blend::Replace,
        ),
    };
    resources.iter().fold(sentence, |sentence, (name, resource)| sentence.with(name, resource.clone()))
}
