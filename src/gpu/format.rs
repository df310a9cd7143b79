//! The image formats that the layer knows.

use ash::vk;

use crate::shader_build::{ImageFormat, Scalar};

/// Properties of an image format.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FormatInfo {
    /// Bytes of a texel as copies pack it: of depth and stencil, of the depth.
    pub texel_bytes: u64,
    /// Type of the values that a shader sees.
    pub scalar: Scalar,
    /// Aspects that an image of the format has.
    pub aspect: vk::ImageAspectFlags,
    /// The format's name in a shader's storage image.
    pub storage: Option<ImageFormat>,
}

/// Properties of `format`; `None` for a format that no image of this layer has.
pub(crate) fn format_info(format: vk::Format) -> Option<FormatInfo> {
    use vk::Format as F;
    let depth = vk::ImageAspectFlags::DEPTH;
    let (texel_bytes, scalar, aspect, storage) = match format {
        F::R8G8B8A8_UNORM => (4, Scalar::Float, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba8)),
        F::B8G8R8A8_UNORM => (4, Scalar::Float, vk::ImageAspectFlags::COLOR, None),
        F::R8G8B8A8_SRGB => (4, Scalar::Float, vk::ImageAspectFlags::COLOR, None),
        F::R16_UINT => (2, Scalar::Uint, vk::ImageAspectFlags::COLOR, Some(ImageFormat::R16ui)),
        F::R32_UINT => (4, Scalar::Uint, vk::ImageAspectFlags::COLOR, Some(ImageFormat::R32ui)),
        F::R32_SFLOAT => (4, Scalar::Float, vk::ImageAspectFlags::COLOR, Some(ImageFormat::R32f)),
        F::R32G32_SFLOAT => (8, Scalar::Float, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rg32f)),
        F::R16G16B16A16_SFLOAT => (8, Scalar::Float, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba16f)),
        F::R16G16B16A16_UINT => (8, Scalar::Uint, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba16ui)),
        F::R32G32B32A32_SFLOAT => (16, Scalar::Float, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba32f)),
        F::R32G32B32A32_SINT => (16, Scalar::Int, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba32i)),
        F::R32G32B32A32_UINT => (16, Scalar::Uint, vk::ImageAspectFlags::COLOR, Some(ImageFormat::Rgba32ui)),
        F::D16_UNORM => (2, Scalar::Float, depth, None),
        F::D32_SFLOAT => (4, Scalar::Float, depth, None),
        F::D32_SFLOAT_S8_UINT | F::D24_UNORM_S8_UINT => (4, Scalar::Float, depth | vk::ImageAspectFlags::STENCIL, None),
        _ => return None,
    };
    Some(FormatInfo { texel_bytes, scalar, aspect, storage })
}
