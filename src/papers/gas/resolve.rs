//! The visible fragments, shaded and blended, and the picture.

use std::sync::Arc;

use ash::vk;

use super::blocks::SectionBlock;
use super::capacity::Band;
use super::geometry::Geometry;
use super::lists::Lists;
use super::march::March;
use super::parameters::Parameters;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, ShaderLibrary};

/// The last passes.
pub struct Resolve {
    /// Linear RGB, and the opacity of all together.
    pub radiance: Arc<ImageView>,
    pub picture: Arc<ImageView>,
    resolve: Pass,
    view: Pass,
}

impl Resolve {
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        geometry: &Geometry,
        lists: &Lists,
        march: Option<&March>,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let image = |name: &str, format, usage| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, parameters.width, parameters.height);
            Image::new(device, desc.usage(usage)).map_err(|error| error.set_by("--size"))?.view()
        };
        let stored = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        let radiance = image("radiance", vk::Format::R32G32B32A32_SFLOAT, stored)?;
        let picture = image("picture", vk::Format::R8G8B8A8_SRGB, vk::ImageUsageFlags::COLOR_ATTACHMENT)?;
        // A binding needs a buffer where the variant has none; nothing reads it.
        let nothing = |name: &str| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(device, &format!("{label}/{name}"), usage, &[0; size_of::<SectionBlock>()])
        };
        let sections = march.map_or_else(|| nothing("no sections"), |m| Ok(m.sections.clone()))?;
        let attenuations = march.and_then(|m| m.attenuations.clone()).map_or_else(|| nothing("no attenuations"), Ok)?;
        let resolve = Pass::compute("resolve", "A-buffer", "gas/resolve.comp")
            .with("frame", &geometry.frame)
            .with("Lights", &geometry.lights)
            .with("Objects", &geometry.objects)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Surfaces", &lists.surfaces)
            .with("Colors", &lists.colors)
            .with("Sections", &sections)
            .with("Attenuations", &attenuations)
            .with("radiance", &radiance)
            .constants::<Band>()
            .build(shaders)?;
        let view = Pass::graphics("view", "A-buffer", "common/fullscreen.vert", "gas/view.frag")
            .with("radiance", &radiance)
            .color(&picture, Load::Discard, Blend::Replace)
            .build(shaders)?;
        Ok(Resolve { radiance, picture, resolve, view })
    }

    /// Resolves the lists of a band.
    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        frame.compute(&self.resolve, |dispatch| {
            dispatch.constants(&band).threads(self.picture.width(), band.rows(), 1);
        })
    }

    /// Draws the picture from what is resolved.
    pub fn draw(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.view, |draw| {
            draw.vertices(3);
        })
    }
}
