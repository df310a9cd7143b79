//! The rock texture of section 7.2: one that we make, or texels that the caller decoded from a file.

use std::sync::Arc;

use ash::vk;

use super::targets::desc;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Error, Image, ImageView, Load, Mode, Pass, Recorder, ShaderLibrary};
use crate::host_block;
use crate::papers::ParameterError;

host_block! {
    struct LoadConstants {
        size: [u32; 2],
    }
}

/// Texels of a rock, rows from the top, sRGB with an alpha that is ignored. It repeats in both directions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rock {
    pub width: u32,
    pub height: u32,
    /// `width` x `height`.
    pub texels: Vec<[u8; 4]>,
}

impl Rock {
    /// Checks that it is a texture.
    ///
    /// # Errors
    /// A size outside 2 to 4096 texels a side, or another number of texels.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let sides = 2..=4096;
        let is_sized = sides.contains(&self.width) && sides.contains(&self.height);
        if is_sized && self.texels.len() as u64 == u64::from(self.width) * u64::from(self.height) {
            return Ok(());
        }
        Err(ParameterError {
            name: "--rock",
            value: format!("{}x{}", self.width, self.height),
            range: "must have 2 to 4096 texels a side".to_owned(),
        })
    }

    /// The rock on the device, with a border of one texel that repeats the opposite side.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub(super) fn load(&self, shaders: &ShaderLibrary, label: &str) -> Result<Arc<ImageView>, Error> {
        let device = shaders.device();
        let name = format!("{label}/rock");
        let desc = desc(name.clone(), vk::Format::R8G8B8A8_UNORM, self.width + 2, self.height + 2);
        let image = Image::new(device, desc)?.view()?;
        let texels = upload(
            device,
            &format!("{name}-texels"),
            vk::BufferUsageFlags::STORAGE_BUFFER,
            bytemuck::cast_slice(&self.texels),
        )?;
        let pass = Pass::graphics("load-rock", "7.2", "common/fullscreen.vert", "lava/load-rock.frag")
            .constants::<LoadConstants>()
            .with("Rock", &texels)
            .color(&image, Load::Discard, Blend::Replace)
            .build(shaders)?;
        Recorder::new(device)?.run(Mode::Plain, |frame| {
            frame.graphics(&pass, |draw| {
                draw.constants(&LoadConstants { size: [self.width, self.height] }).vertices(3);
            })
        })?;
        Ok(image)
    }
}
