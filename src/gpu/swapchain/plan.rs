//! Plan of a swapchain: a decision on what the surface offers.

use ash::vk;

use super::super::error::Error;
use crate::named;

named! {
    /// A mode of presenting.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub enum PresentMode {
        /// Every picture in turn, at the display's pace; every display has it.
        #[default]
        Fifo = "fifo",
        /// As `Fifo`, and at once where one comes late.
        FifoRelaxed = "fifo-relaxed",
        /// The newest picture at the display's pace.
        Mailbox = "mailbox",
        /// At once, even in the middle of the display's own picture.
        Immediate = "immediate",
    }
}

impl PresentMode {
    pub(super) fn vulkan(self) -> vk::PresentModeKHR {
        match self {
            PresentMode::Fifo => vk::PresentModeKHR::FIFO,
            PresentMode::FifoRelaxed => vk::PresentModeKHR::FIFO_RELAXED,
            PresentMode::Mailbox => vk::PresentModeKHR::MAILBOX,
            PresentMode::Immediate => vk::PresentModeKHR::IMMEDIATE,
        }
    }
}

/// Choices that a swapchain is made by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Plan {
    /// Size of the images in pixels, within the surface's bounds.
    pub extent: vk::Extent2D,
    /// Format and colour space of the images.
    pub format: vk::SurfaceFormatKHR,
    /// Format of the pictures whose bytes are copied into its images.
    pub picture_format: vk::Format,
    /// Present mode, one that the surface has.
    pub mode: PresentMode,
    /// Least number of images that is asked for.
    pub image_count: u32,
    /// Turn that pictures are drawn with: none where the display can turn them itself, else the surface's current one.
    pub transform: vk::SurfaceTransformFlagsKHR,
    /// Way in which the display blends the window with those below it.
    pub alpha: vk::CompositeAlphaFlagsKHR,
}

/// Plans a swapchain for a window of `window` pixels; `None` while the window has none.
pub(super) fn plan(
    capabilities: &vk::SurfaceCapabilitiesKHR,
    formats: &[vk::SurfaceFormatKHR],
    modes: &[vk::PresentModeKHR],
    mode: PresentMode,
    window: (u32, u32),
) -> Result<Option<Plan>, Error> {
    let (least, most) = (capabilities.min_image_extent, capabilities.max_image_extent);
    let extent = match capabilities.current_extent {
        // The surface takes the size of the swapchain.
        vk::Extent2D { width: u32::MAX, height: u32::MAX } if window.0 > 0 && window.1 > 0 => vk::Extent2D {
            width: window.0.clamp(least.width, most.width.max(least.width)),
            height: window.1.clamp(least.height, most.height.max(least.height)),
        },
        vk::Extent2D { width: u32::MAX, height: u32::MAX } => return Ok(None),
        current => current,
    };
    if extent.width == 0 || extent.height == 0 {
        return Ok(None);
    }
    let lacks = |problem: String| Error::Unsupported { object: "the window".into(), problem };
    if !capabilities.supported_usage_flags.contains(vk::ImageUsageFlags::TRANSFER_DST) {
        return Err(lacks("images of a swapchain that can be copied into".into()));
    }
    if !modes.contains(&mode.vulkan()) {
        let offered: Vec<&str> =
            PresentMode::ALL.iter().filter(|mode| modes.contains(&mode.vulkan())).map(|mode| mode.as_str()).collect();
        let problem = format!("the way of presenting {}; there are {}", mode.as_str(), offered.join(", "));
        return Err(lacks(problem));
    }
    let (format, picture_format) = choose_format(formats)
        .ok_or_else(|| lacks("an 8-bit format of the sRGB colour space for its pictures".into()))?;
    let most_images = if capabilities.max_image_count == 0 { u32::MAX } else { capabilities.max_image_count };
    let identity = vk::SurfaceTransformFlagsKHR::IDENTITY;
    let opaque = vk::CompositeAlphaFlagsKHR::OPAQUE;
    let alphas = capabilities.supported_composite_alpha;
    Ok(Some(Plan {
        extent,
        format,
        picture_format,
        mode,
        image_count: capabilities.min_image_count.saturating_add(1).min(most_images),
        transform: if capabilities.supported_transforms.contains(identity) {
            identity
        } else {
            capabilities.current_transform
        },
        alpha: if alphas.contains(opaque) {
            opaque
        } else {
            // The lowest that is offered; pictures are opaque, so all of them show the same.
            vk::CompositeAlphaFlagsKHR::from_raw(alphas.as_raw() & alphas.as_raw().wrapping_neg())
        },
    }))
}

/// The surface's format, and that of the pictures whose bytes, which are encoded in sRGB, are copied into it. Formats
/// that encode on writes are as good as those that do not: a copy writes bytes.
fn choose_format(formats: &[vk::SurfaceFormatKHR]) -> Option<(vk::SurfaceFormatKHR, vk::Format)> {
    use vk::Format as F;
    const WANTED: [(F, F); 4] = [
        (F::B8G8R8A8_UNORM, F::B8G8R8A8_UNORM),
        (F::R8G8B8A8_UNORM, F::R8G8B8A8_UNORM),
        (F::B8G8R8A8_SRGB, F::B8G8R8A8_UNORM),
        (F::R8G8B8A8_SRGB, F::R8G8B8A8_UNORM),
    ];
    let color_space = vk::ColorSpaceKHR::SRGB_NONLINEAR;
    WANTED.into_iter().find_map(|(wanted, picture)| {
        let format = vk::SurfaceFormatKHR { format: wanted, color_space };
        formats.contains(&format).then_some((format, picture))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(width: u32, height: u32) -> vk::Extent2D {
        vk::Extent2D { width, height }
    }

    fn capabilities(current: vk::Extent2D) -> vk::SurfaceCapabilitiesKHR {
        vk::SurfaceCapabilitiesKHR {
            min_image_count: 3,
            max_image_count: 0,
            current_extent: current,
            min_image_extent: extent(1, 1),
            max_image_extent: extent(16384, 16384),
            max_image_array_layers: 1,
            supported_transforms: vk::SurfaceTransformFlagsKHR::IDENTITY,
            current_transform: vk::SurfaceTransformFlagsKHR::IDENTITY,
            supported_composite_alpha: vk::CompositeAlphaFlagsKHR::OPAQUE | vk::CompositeAlphaFlagsKHR::INHERIT,
            supported_usage_flags: vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::COLOR_ATTACHMENT,
        }
    }

    fn format(format: vk::Format) -> vk::SurfaceFormatKHR {
        vk::SurfaceFormatKHR { format, color_space: vk::ColorSpaceKHR::SRGB_NONLINEAR }
    }

    const FIFO: [vk::PresentModeKHR; 1] = [vk::PresentModeKHR::FIFO];

    fn planned(capabilities: &vk::SurfaceCapabilitiesKHR, window: (u32, u32)) -> Option<Plan> {
        let formats = [format(vk::Format::B8G8R8A8_SRGB), format(vk::Format::B8G8R8A8_UNORM)];
        plan(capabilities, &formats, &FIFO, PresentMode::Fifo, window).expect("a plan")
    }

    #[test]
    fn a_window_without_pixels_has_no_swapchain() {
        let free = extent(u32::MAX, u32::MAX);
        for (current, window) in
            [(extent(0, 0), (640, 480)), (extent(0, 7), (640, 480)), (free, (0, 480)), (free, (640, 0))]
        {
            assert_eq!(planned(&capabilities(current), window), None, "{current:?} {window:?}");
        }
    }

    #[test]
    fn the_display_says_the_size_or_the_window_does() {
        let of = |current, window| planned(&capabilities(current), window).expect("a swapchain").extent;
        assert_eq!(of(extent(300, 200), (640, 480)), extent(300, 200));
        assert_eq!(of(extent(1, 1), (640, 480)), extent(1, 1));
        assert_eq!(of(extent(u32::MAX, u32::MAX), (640, 480)), extent(640, 480));
        assert_eq!(of(extent(u32::MAX, u32::MAX), (99_999, 480)), extent(16384, 480));
    }

    #[test]
    fn bytes_are_copied_into_any_format_of_the_srgb_space() {
        let chosen = |formats: &[vk::SurfaceFormatKHR]| choose_format(formats).map(|(f, p)| (f.format, p));
        let [bgra, bgra_srgb] = [vk::Format::B8G8R8A8_UNORM, vk::Format::B8G8R8A8_SRGB];
        assert_eq!(chosen(&[format(bgra_srgb), format(bgra)]), Some((bgra, bgra)));
        assert_eq!(chosen(&[format(bgra_srgb)]), Some((bgra_srgb, bgra)));
        let rgba_srgb = vk::Format::R8G8B8A8_SRGB;
        assert_eq!(chosen(&[format(rgba_srgb)]), Some((rgba_srgb, vk::Format::R8G8B8A8_UNORM)));
        assert_eq!(chosen(&[format(vk::Format::R5G6B5_UNORM_PACK16)]), None);
        let wide = vk::SurfaceFormatKHR { format: bgra, color_space: vk::ColorSpaceKHR::DISPLAY_P3_NONLINEAR_EXT };
        assert_eq!(chosen(&[wide]), None);
    }

    #[test]
    fn image_counts_and_alphas_stay_inside_what_is_offered() {
        let mut offered = capabilities(extent(10, 10));
        assert_eq!(planned(&offered, (10, 10)).expect("a swapchain").image_count, 4);
        offered.max_image_count = 3;
        offered.supported_composite_alpha =
            vk::CompositeAlphaFlagsKHR::INHERIT | vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED;
        let made = planned(&offered, (10, 10)).expect("a swapchain");
        assert_eq!((made.image_count, made.alpha), (3, vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED));
    }

    #[test]
    fn what_is_not_offered_is_refused_with_what_is() {
        let offered = capabilities(extent(10, 10));
        let formats = [format(vk::Format::B8G8R8A8_UNORM)];
        let error = plan(&offered, &formats, &FIFO, PresentMode::Mailbox, (10, 10)).expect_err("no mailbox");
        assert!(error.to_string().contains("mailbox; there are fifo"), "{error}");
        let unwritable = vk::SurfaceCapabilitiesKHR { supported_usage_flags: vk::ImageUsageFlags::STORAGE, ..offered };
        assert!(plan(&unwritable, &formats, &FIFO, PresentMode::Fifo, (10, 10)).is_err());
        assert!(plan(&offered, &[], &FIFO, PresentMode::Fifo, (10, 10)).is_err());
    }
}
