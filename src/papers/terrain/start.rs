//! The pass `start` of the variants that walk from cell to cell on the device, over a plane: a depth up to which no ray of a tile of 8 x 8
//! pixels has met the map. Once for each map, before `depth`, where the rays begin there.

use std::sync::Arc;

use ash::vk;

use super::parameters::{Base, Start};
use super::scene::{DeviceScene, Map, texels};
use super::stage::{Build, PixelPass, Traversal};
use crate::gpu::{Error, Frame, Image, ImageDesc, ImageView, Load};
use crate::measure::Target;

/// Pixels a side of a tile; `shaders/terrain/tile-pixels.glsl` has it, too.
pub const TILE_PIXELS: u32 = 8;

/// Format of depths.
const FORMAT: vk::Format = vk::Format::R32_SFLOAT;

/// Beginnings of the rays of each map.
pub struct Starts {
    /// Of each map in their order; none where each ray begins at its own beginning.
    passes: Vec<PixelPass>,
    /// A single texel of 0 metres, where shaders read one all the same.
    nothing: Option<Arc<ImageView>>,
}

impl Starts {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, scene: &DeviceScene) -> Result<Self, Error> {
        let parameters = build.parameters;
        if build.traversal != Traversal::Cells || parameters.base != Base::Plane {
            return Ok(Starts { passes: Vec::new(), nothing: None });
        }
        if parameters.start == Start::Rays {
            let name = format!("{}/no-start", build.label);
            let nothing = texels(build.shaders.device(), &name, FORMAT, (1, 1), |_, bytes| bytes.fill(0))?;
            return Ok(Starts { passes: Vec::new(), nothing: Some(nothing) });
        }
        let of_map = |(index, map): (usize, &Map)| {
            let target = tiles(build, index)?;
            let own = [("terrain", (&map.terrain).into())];
            let resources = [&own[..], &map.levels.ray_resources()].concat();
            let program = format!("start-{}", build.surface(&map.levels));
            let pass = build.pass(("start", "3"), &program, (&target, Load::Discard), &resources)?;
            Ok(PixelPass { stage: build.stage, passes: vec![pass], target })
        };
        Ok(Starts { passes: scene.maps.iter().enumerate().map(of_map).collect::<Result<_, Error>>()?, nothing: None })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| pass.record(frame))
    }

    /// Of the first map.
    pub fn target(&self) -> Option<Target> {
        let start = self.passes.first()?;
        let what = "depth in metres up to which no ray of a tile of 8 x 8 pixels has met the first map";
        Some(Target::image("start", &start.target).of(what))
    }

    /// The image that rays at a map begin with; none where no shader reads one.
    pub fn of_map(&self, index: usize) -> Option<&Arc<ImageView>> {
        self.passes.get(index).map(|pass| &pass.target).or(self.nothing.as_ref())
    }
}

/// An image with a texel for each tile of the picture.
fn tiles(build: &Build<'_>, index: usize) -> Result<Arc<ImageView>, Error> {
    let size = [build.parameters.width, build.parameters.height].map(|pixels| pixels.div_ceil(TILE_PIXELS));
    let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
    let desc = ImageDesc::new_2d(format!("{}/start-{index}", build.label), FORMAT, size[0], size[1]);
    Image::new(build.shaders.device(), desc.usage(usage))?.view()
}
