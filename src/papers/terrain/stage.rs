//! Passes over all pixels, by compute stages or as full-screen fragment passes, and all that they are built with.

use std::sync::Arc;

use ash::vk;

use super::levels::Levels;
use super::parameters::{Interpolation, Parameters};
use super::pyramid::Cover;
use super::scene::DeviceScene;
use crate::gpu::bindings::Resource;
use crate::gpu::{Blend, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};
use crate::measure::parameter::Choice;

/// Format of hits and normals.
pub const VECTOR: vk::Format = vk::Format::R32G32B32A32_SFLOAT;

/// Nothing is as far as that in a depth buffer, which holds near / depth: to a ten millionth of any depth, where 1 - near / depth would
/// be off by its square over the near plane's.
pub const FARTHEST: Load = Load::Clear([0.0; 4]);

/// The stages that a device offers for one program over all pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    Compute,
    Fragment,
}

/// The way of a ray through the levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traversal {
    /// Section 3: halves, the near one first.
    Halving,
    /// From border to border of blocks of cells.
    Cells,
    /// Section 3, through levels in tiles of which the device holds some.
    Tiles,
}

impl Traversal {
    /// The nodes that texels of coarser levels cover.
    pub fn cover(self, interpolation: Interpolation) -> Cover {
        match self {
            Traversal::Halving | Traversal::Tiles => Cover::Nodes,
            Traversal::Cells => Cover::Cells(interpolation),
        }
    }

    /// The part of a pixel that texels are as large as at which a ray ends. One that bounds what bicubic cells read has the heights of
    /// three nodes more along each side: as large as a pixel it would lift silhouettes by more than that.
    pub fn footprint(self, interpolation: Interpolation) -> f32 {
        if self.cover(interpolation) == Cover::Cells(Interpolation::Bicubic) { 0.5 } else { 1.0 }
    }
}

/// All that passes are built with.
#[derive(Clone, Copy)]
pub struct Build<'a> {
    /// The compiled shaders of the device.
    pub shaders: &'a ShaderLibrary,
    /// Goes before the names of the resources.
    pub label: &'a str,
    /// The numbers of the configuration.
    pub parameters: &'a Parameters,
    /// Of the passes over all pixels.
    pub stage: Stage,
    /// Of all rays.
    pub traversal: Traversal,
    /// Rays read a cell's corners by one fetch.
    pub is_packed: bool,
}

impl Build<'_> {
    /// The nodes that texels of coarser levels cover.
    pub fn cover(&self) -> Cover {
        self.traversal.cover(self.parameters.interpolation)
    }

    /// The name of the program of `pass` that casts rays at a map, before what it is made of beside base and interpolation.
    pub fn ray_program(&self, pass: &str, levels: &Levels) -> String {
        let (base, surface) = (self.parameters.base.kind(), self.surface(levels));
        match self.traversal {
            Traversal::Halving => format!("{pass}-{base}-{surface}"),
            Traversal::Cells => format!("{pass}-dda-{base}-{surface}"),
            Traversal::Tiles => format!("{pass}-tiled-{base}-{surface}"),
        }
    }

    /// The surface between a map's samples as the shaders of rays call it.
    pub fn surface(&self, levels: &Levels) -> &'static str {
        match (&levels.packed, levels.is_float) {
            (None, _) => self.parameters.interpolation.name(),
            (Some(_), false) => "packed16",
            (Some(_), true) => "packed32",
        }
    }

    fn image_of(&self, name: &str, format: vk::Format, usage: vk::ImageUsageFlags) -> Result<Arc<ImageView>, Error> {
        let Parameters { width, height, .. } = *self.parameters;
        let desc = ImageDesc::new_2d(format!("{}/{name}", self.label), format, width, height);
        Image::new(self.shaders.device(), desc.usage(usage))?.view()
    }

    /// An image of the picture's size that passes write and later ones read.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn image(&self, name: &str, format: vk::Format) -> Result<Arc<ImageView>, Error> {
        // Polygons are drawn into what compute stages wrote.
        let written = match self.stage {
            Stage::Compute => vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::COLOR_ATTACHMENT,
            Stage::Fragment => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        self.image_of(name, format, written | vk::ImageUsageFlags::SAMPLED)
    }

    /// A depth buffer of the picture's size.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn depth_buffer(&self, name: &str) -> Result<Arc<ImageView>, Error> {
        self.image_of(name, vk::Format::D32_SFLOAT, vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT)
    }

    /// A pass of `program` over all pixels of `target`, which compute stages know by the pass's name, be it of objects or not.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn pass(
        &self,
        (name, section): (&'static str, &'static str),
        program: &str,
        (target, load): (&Arc<ImageView>, Load),
        resources: &[(&'static str, Resource)],
    ) -> Result<Pass, Error> {
        let pass = match self.stage {
            Stage::Compute => Pass::compute(name, section, &format!("terrain/{program}.comp"))
                .with(name.strip_prefix("object-").unwrap_or(name), target),
            Stage::Fragment => {
                Pass::graphics(name, section, "common/fullscreen.vert", &format!("terrain/{program}.frag")).color(
                    target,
                    load,
                    Blend::Replace,
                )
            }
        };
        let pass = resources.iter().fold(pass, |pass, (name, resource)| pass.with(name, resource.clone()));
        pass.build(self.shaders)
    }

    /// A pass once for each map, that reads as `prior` what it left of the maps before, and `others` of a map. It writes two images in
    /// turn.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn map_passes(
        &self,
        name: (&'static str, &'static str),
        program: &dyn Fn(&Levels) -> String,
        ping_pong: [&Arc<ImageView>; 2],
        scene: &DeviceScene,
        mut prior: Arc<ImageView>,
        others: &dyn Fn(usize) -> Vec<(&'static str, Resource)>,
    ) -> Result<PixelPass, Error> {
        let mut passes = Vec::new();
        for ((index, map), target) in scene.maps.iter().enumerate().zip(ping_pong.into_iter().cycle()) {
            let own = [("terrain", (&map.terrain).into()), ("prior", (&prior).into())];
            let resources = [&own[..], &map.levels.ray_resources(), &others(index)].concat();
            passes.push(self.pass(name, &program(&map.levels), (target, Load::Discard), &resources)?);
            prior = target.clone();
        }
        Ok(PixelPass { stage: self.stage, passes, target: prior })
    }
}

/// A pass over all pixels, once or once for each map.
pub struct PixelPass {
    /// The stage of its shaders.
    pub stage: Stage,
    /// In the order of the maps.
    pub passes: Vec<Pass>,
    /// The image that the last of them writes.
    pub target: Arc<ImageView>,
}

impl PixelPass {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| match self.stage {
            Stage::Compute => frame.compute(pass, |dispatch| {
                dispatch.threads(self.target.width(), self.target.height(), 1);
            }),
            Stage::Fragment => frame.graphics(pass, |draw| {
                draw.vertices(3);
            }),
        })
    }
}
