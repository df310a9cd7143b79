//! Images, their views, and samplers.

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use gpu_allocator::vulkan::Allocation;

use super::access::State;
use super::buffer::Location;
use super::device::Device;
use super::error::{Context, Error};
use super::format::format_info;
use super::live::Kind;
use super::memory::allocate;
use super::tracked::{InUse, SubmissionId, Tracked};

/// The description of an image; [`Image::new`] makes it.
#[derive(Debug, Clone)]
pub struct ImageDesc {
    /// Debug name.
    pub name: String,
    /// Format of a texel.
    pub format: vk::Format,
    /// Width in texels.
    pub width: u32,
    /// Height in texels.
    pub height: u32,
    /// Depth in texels of a three-dimensional image, at least 1.
    pub depth: u32,
    /// Array layers, at least 1.
    pub layers: u32,
    /// Every use that Vulkan is to allow of it.
    pub usage: vk::ImageUsageFlags,
    /// Set for an image whose whole view is an array view.
    array: bool,
    kind: vk::ImageType,
}

impl ImageDesc {
    /// A two-dimensional image of one mip level, which copies may fill and read.
    pub fn new_2d(name: impl Into<String>, format: vk::Format, width: u32, height: u32) -> Self {
        ImageDesc {
            name: name.into(),
            format,
            width,
            height,
            depth: 1,
            layers: 1,
            usage: vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST,
            array: false,
            kind: vk::ImageType::TYPE_2D,
        }
    }

    /// A three-dimensional image of one mip level, which copies may read; nothing draws into it.
    pub fn new_3d(name: impl Into<String>, format: vk::Format, [width, height, depth]: [u32; 3]) -> Self {
        ImageDesc {
            depth,
            usage: vk::ImageUsageFlags::TRANSFER_SRC,
            kind: vk::ImageType::TYPE_3D,
            ..Self::new_2d(name, format, width, height)
        }
    }

    fn is_3d(&self) -> bool {
        self.kind == vk::ImageType::TYPE_3D
    }

    /// Makes it an array; its whole view is an array view even for one layer.
    pub fn layers(mut self, layers: u32) -> Self {
        self.layers = layers;
        self.array = true;
        self
    }

    /// Adds uses to those of copies.
    pub fn usage(mut self, usage: vk::ImageUsageFlags) -> Self {
        self.usage |= usage;
        self
    }

    fn check_limits(&self, device: &Device) -> Result<(), Error> {
        use vk::ImageUsageFlags as U;
        let limits = &device.physical().limits;
        let (side, layers) = if self.is_3d() {
            (limits.max_image_dimension3_d, 1)
        } else {
            (limits.max_image_dimension2_d, limits.max_image_array_layers)
        };
        let (mut widest, mut highest) = (side, side);
        if self.usage.intersects(U::COLOR_ATTACHMENT | U::DEPTH_STENCIL_ATTACHMENT) {
            widest = widest.min(limits.max_framebuffer_width);
            highest = highest.min(limits.max_framebuffer_height);
        }
        let checks = [
            ("width in texels", self.width, widest),
            ("height in texels", self.height, highest),
            ("depth in texels", self.depth, if self.is_3d() { side } else { 1 }),
            ("layer count", self.layers, layers),
        ];
        for (what, wanted, limit) in checks {
            if wanted == 0 || wanted > limit {
                return Err(Error::Limit {
                    object: self.name.clone(),
                    what,
                    wanted: wanted.into(),
                    limit: limit.into(),
                });
            }
        }
        Ok(())
    }

    fn check_support(&self, device: &Device) -> Result<(), Error> {
        use vk::ImageUsageFlags as U;
        let known = U::TRANSFER_SRC
            | U::TRANSFER_DST
            | U::SAMPLED
            | U::STORAGE
            | U::COLOR_ATTACHMENT
            | U::DEPTH_STENCIL_ATTACHMENT;
        // What draws into a target, or fills it from the host, knows two dimensions.
        let flat = U::TRANSFER_DST | U::COLOR_ATTACHMENT | U::DEPTH_STENCIL_ATTACHMENT;
        let is_known = format_info(self.format).is_some()
            && !self.usage.is_empty()
            && known.contains(self.usage)
            && !(self.is_3d() && self.usage.intersects(flat));
        // SAFETY: the physical device is the device's own; the usage is not empty.
        let asked = is_known.then(|| unsafe {
            device.instance().raw.get_physical_device_image_format_properties(
                device.physical().raw,
                self.format,
                self.kind,
                vk::ImageTiling::OPTIMAL,
                self.usage,
                vk::ImageCreateFlags::empty(),
            )
        });
        let most = match asked {
            None | Some(Err(vk::Result::ERROR_FORMAT_NOT_SUPPORTED)) => None,
            Some(answer) => Some(answer.context("asking for the sizes of image", &self.name)?),
        };
        let fits = most.is_some_and(|most| {
            let extent = most.max_extent;
            self.width <= extent.width
                && self.height <= extent.height
                && self.depth <= extent.depth
                && self.layers <= most.max_array_layers
        });
        if fits {
            return Ok(());
        }
        let problem = format!("{} x {} images of {:?} for {:?}", self.width, self.height, self.format, self.usage);
        Err(Error::Unsupported { object: self.name.clone(), problem })
    }
}

/// An image with its memory; it remembers what was last done to each of its layers.
pub struct Image {
    /// Handle.
    pub(crate) raw: vk::Image,
    device: Arc<Device>,
    allocation: Option<Allocation>,
    allocated_bytes: u64,
    desc: ImageDesc,
    /// The state of each layer.
    pub(super) states: Tracked<Vec<State>>,
}

impl Image {
    /// Makes an image with undefined contents.
    ///
    /// # Errors
    /// [`Error::Limit`] when an extent is zero or larger than the device allows, [`Error::OutOfMemory`].
    pub fn new(device: &Arc<Device>, desc: ImageDesc) -> Result<Arc<Self>, Error> {
        desc.check_limits(device)?;
        desc.check_support(device)?;
        let info = vk::ImageCreateInfo::default()
            .image_type(desc.kind)
            .format(desc.format)
            .extent(vk::Extent3D { width: desc.width, height: desc.height, depth: desc.depth })
            .mip_levels(1)
            .array_layers(desc.layers)
            .samples(vk::SampleCountFlags::TYPE_1)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(desc.usage)
            .sharing_mode(vk::SharingMode::EXCLUSIVE)
            .initial_layout(vk::ImageLayout::UNDEFINED);
        // SAFETY: the device was asked for this format, usage and extent, and the description is complete.
        let raw = unsafe { device.raw.create_image(&info, None) }.context("creating image", &desc.name)?;
        device.live().add(Kind::Image);
        let layers = desc.layers as usize;
        let mut image = Image {
            raw,
            device: device.clone(),
            allocation: None,
            allocated_bytes: 0,
            desc,
            states: Tracked::new(vec![State::NEW; layers]),
        };
        device.name(raw, &image.desc.name);
        // SAFETY: `raw` is a live image of this device.
        let requirements = unsafe { device.raw.get_image_memory_requirements(raw) };
        let allocation = allocate(device, &image.desc.name, requirements, Location::Device, false)?;
        // SAFETY: the memory fits the requirements, is bound once, and is freed after the image is destroyed.
        unsafe { device.raw.bind_image_memory(raw, allocation.memory(), allocation.offset()) }
            .context("binding memory of image", &image.desc.name)?;
        image.allocated_bytes = allocation.size();
        device.live().add_memory(&image.desc.name, allocation.size(), false);
        image.allocation = Some(allocation);
        Ok(Arc::new(image))
    }

    /// The description it was made from.
    pub fn desc(&self) -> &ImageDesc {
        &self.desc
    }

    /// Debug name.
    pub fn name(&self) -> &str {
        &self.desc.name
    }

    /// The aspect that the format has: depth or colour.
    pub fn aspect(&self) -> vk::ImageAspectFlags {
        // Every image's format is known.
        format_info(self.desc.format).map_or(vk::ImageAspectFlags::COLOR, |info| info.aspect)
    }

    /// A view of all layers.
    ///
    /// # Errors
    /// [`Error::Vulkan`] when the device refuses.
    pub fn view(self: &Arc<Self>) -> Result<Arc<ImageView>, Error> {
        // A view that is no array has one layer.
        let is_array = self.desc.array || self.desc.layers > 1;
        let kind = match is_array {
            _ if self.desc.is_3d() => vk::ImageViewType::TYPE_3D,
            true => vk::ImageViewType::TYPE_2D_ARRAY,
            false => vk::ImageViewType::TYPE_2D,
        };
        ImageView::new(self, kind, self.aspect(), 0..self.desc.layers)
    }

    /// A view of the depth alone, which is what a shader may fetch of a depth and stencil image.
    ///
    /// # Errors
    /// [`Error::Vulkan`] when the device refuses.
    pub fn depth_view(self: &Arc<Self>) -> Result<Arc<ImageView>, Error> {
        ImageView::new(self, vk::ImageViewType::TYPE_2D, vk::ImageAspectFlags::DEPTH, 0..1)
    }

    /// A two-dimensional view of one layer.
    ///
    /// # Errors
    /// [`Error::Limit`] for a layer that is not there.
    pub fn layer(self: &Arc<Self>, layer: u32) -> Result<Arc<ImageView>, Error> {
        self.layer_as(layer, vk::ImageViewType::TYPE_2D)
    }

    /// A view of one layer as an array of one.
    ///
    /// # Errors
    /// [`Error::Limit`] for a layer that is not there.
    pub fn layer_array(self: &Arc<Self>, layer: u32) -> Result<Arc<ImageView>, Error> {
        self.layer_as(layer, vk::ImageViewType::TYPE_2D_ARRAY)
    }

    fn layer_as(self: &Arc<Self>, layer: u32, kind: vk::ImageViewType) -> Result<Arc<ImageView>, Error> {
        if layer >= self.desc.layers {
            return Err(Error::Limit {
                object: self.desc.name.clone(),
                what: "layer",
                wanted: layer.into(),
                limit: u64::from(self.desc.layers) - 1,
            });
        }
        ImageView::new(self, kind, self.aspect(), layer..layer + 1)
    }

    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Visits the states of `layers` on behalf of a submission; true when it is the first time.
    pub(crate) fn with_states<T>(
        &self,
        submission: SubmissionId,
        layers: Range<u32>,
        visit: impl FnOnce(&mut [State]) -> T,
    ) -> Result<(T, bool), InUse> {
        self.states.visit(submission, |states| visit(&mut states[layers.start as usize..layers.end as usize]))
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: views and frames hold an `Arc` of this image, so nothing refers to it any more.
        unsafe { self.device.raw.destroy_image(self.raw, None) };
        self.device.live().remove(Kind::Image);
        if let Some(allocation) = self.allocation.take() {
            self.device.live().remove_memory(&self.desc.name, self.allocated_bytes, false);
            // Freeing fails only for memory of another allocator.
            let _ = self.device.allocator().free(allocation);
        }
    }
}

/// A view of some layers of an image.
pub struct ImageView {
    /// Handle.
    pub(crate) raw: vk::ImageView,
    /// Aspects that it shows.
    pub(crate) aspect: vk::ImageAspectFlags,
    /// An array view, even of one layer.
    pub(crate) is_array: bool,
    /// The image that it shows.
    pub(crate) image: Arc<Image>,
    /// Array layers, from the first to the one behind the last.
    pub(crate) layers: Range<u32>,
}

impl ImageView {
    fn new(
        image: &Arc<Image>,
        kind: vk::ImageViewType,
        aspect: vk::ImageAspectFlags,
        layers: Range<u32>,
    ) -> Result<Arc<Self>, Error> {
        use vk::ImageUsageFlags as U;
        let viewed = U::SAMPLED | U::STORAGE | U::COLOR_ATTACHMENT | U::DEPTH_STENCIL_ATTACHMENT;
        let is_3d = kind == vk::ImageViewType::TYPE_3D;
        if !image.aspect().contains(aspect) || !image.desc.usage.intersects(viewed) || is_3d != image.desc.is_3d() {
            let problem = format!("a view of its {aspect:?}: it is made for {:?}", image.desc.usage);
            return Err(Error::Unsupported { object: image.desc.name.clone(), problem });
        }
        let info = vk::ImageViewCreateInfo::default()
            .image(image.raw)
            .view_type(kind)
            .format(image.desc.format)
            .subresource_range(subresource_range(aspect, &layers));
        let device = &image.device;
        // SAFETY: the image is alive, the callers name layers that exist, and aspect and usage allow the view.
        let raw =
            unsafe { device.raw.create_image_view(&info, None) }.context("creating a view of image", image.name())?;
        device.live().add(Kind::ImageView);
        device.name(raw, image.name());
        let is_array = kind == vk::ImageViewType::TYPE_2D_ARRAY;
        Ok(Arc::new(ImageView { raw, aspect, is_array, image: image.clone(), layers }))
    }

    /// The image that is viewed.
    pub fn image(&self) -> &Arc<Image> {
        &self.image
    }

    /// Layers that the view shows.
    pub fn layer_count(&self) -> u32 {
        self.layers.end - self.layers.start
    }

    /// Width in texels.
    pub fn width(&self) -> u32 {
        self.image.desc.width
    }

    /// Height in texels.
    pub fn height(&self) -> u32 {
        self.image.desc.height
    }

    /// Depth in texels, 1 but for a three-dimensional image.
    pub fn depth(&self) -> u32 {
        self.image.desc.depth
    }

    /// A view of a three-dimensional image, of which a shader declares one.
    pub(crate) fn is_3d(&self) -> bool {
        self.image.desc.is_3d()
    }

    /// Texels of all rows, layers and slices.
    pub(crate) fn texel_count(&self) -> u64 {
        [self.width(), self.height(), self.depth(), self.layer_count()].into_iter().map(u64::from).product()
    }
}

impl Drop for ImageView {
    fn drop(&mut self) {
        // SAFETY: framebuffers, descriptor sets and frames hold an `Arc` of this view.
        unsafe { self.image.device.raw.destroy_image_view(self.raw, None) };
        self.image.device.live().remove(Kind::ImageView);
    }
}

pub(crate) fn subresource_range(aspect: vk::ImageAspectFlags, layers: &Range<u32>) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default()
        .aspect_mask(aspect)
        .level_count(1)
        .base_array_layer(layers.start)
        .layer_count(layers.end - layers.start)
}

/// A sampler; edges are clamped.
pub struct Sampler {
    /// Handle.
    pub(crate) raw: vk::Sampler,
    /// Reads between texels, which not every format allows.
    pub(super) is_linear: bool,
    /// The device that it was made on.
    pub(super) device: Arc<Device>,
}

impl Sampler {
    /// # Errors
    /// [`Error::Unsupported`] for a filter other than the nearest texel's or a linear one; [`Error::Limit`] for more samplers
    /// than the device has; any error of Vulkan.
    pub fn new(device: &Arc<Device>, name: &str, filter: vk::Filter) -> Result<Arc<Self>, Error> {
        if ![vk::Filter::NEAREST, vk::Filter::LINEAR].contains(&filter) {
            return Err(Error::Unsupported { object: name.to_owned(), problem: format!("the filter {filter:?}") });
        }
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_w(vk::SamplerAddressMode::CLAMP_TO_EDGE);
        let (count, limit) =
            (device.live().count(Kind::Sampler), device.physical().limits.max_sampler_allocation_count);
        if count >= limit as usize {
            let (object, wanted) = (name.to_owned(), count as u64 + 1);
            return Err(Error::Limit { object, what: "count of samplers", wanted, limit: limit.into() });
        }
        // SAFETY: the device is alive and the description is complete.
        let raw = unsafe { device.raw.create_sampler(&info, None) }.context("creating sampler", name)?;
        device.live().add(Kind::Sampler);
        device.name(raw, name);
        Ok(Arc::new(Sampler { raw, is_linear: filter == vk::Filter::LINEAR, device: device.clone() }))
    }
}

impl Drop for Sampler {
    fn drop(&mut self) {
        // SAFETY: descriptor sets hold an `Arc` of this sampler.
        unsafe { self.device.raw.destroy_sampler(self.raw, None) };
        self.device.live().remove(Kind::Sampler);
    }
}
