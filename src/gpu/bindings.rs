//! The descriptors of a pass: resources by the names the shaders give them, written into one
//! set, once, when the pass is built.

use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::buffer::BufferView;
use super::device::Device;
use super::error::{Context, Error};
use super::format::format_info;
use super::image::{ImageView, Sampler};
use super::live::Kind;
use super::program::{Program, Slot};
use crate::shader_build::BindingKind;

/// A view of something that a pass touches.
#[derive(Clone)]
pub enum Resource {
    /// A byte range of a buffer.
    Buffer(BufferView),
    /// Some layers of an image.
    Image(Arc<ImageView>),
    /// A sampler, which has no memory.
    Sampler(Arc<Sampler>),
}

impl Resource {
    /// The debug name of the buffer or image.
    pub fn name(&self) -> &str {
        match self {
            Resource::Buffer(view) => view.buffer.name(),
            Resource::Image(view) => view.image.name(),
            Resource::Sampler(_) => "sampler",
        }
    }

    /// # Errors
    /// [`Error::Foreign`] for a resource of another device than `device`.
    pub(crate) fn check_device(&self, device: &Arc<Device>, pass: &str) -> Result<(), Error> {
        let own = match self {
            Resource::Buffer(view) => view.buffer.device(),
            Resource::Image(view) => view.image.device(),
            Resource::Sampler(sampler) => &sampler.device,
        };
        device.check_own(own, pass, self.name())
    }
}

impl From<&BufferView> for Resource {
    fn from(view: &BufferView) -> Self {
        Resource::Buffer(view.clone())
    }
}

impl From<&Arc<super::buffer::Buffer>> for Resource {
    fn from(buffer: &Arc<super::buffer::Buffer>) -> Self {
        Resource::Buffer(buffer.view())
    }
}

impl From<&Arc<ImageView>> for Resource {
    fn from(view: &Arc<ImageView>) -> Self {
        Resource::Image(view.clone())
    }
}

impl From<&Arc<Sampler>> for Resource {
    fn from(sampler: &Arc<Sampler>) -> Self {
        Resource::Sampler(sampler.clone())
    }
}

/// One thing that a pass does with one resource.
#[derive(Clone)]
pub struct Use {
    /// The view that is touched.
    pub resource: Resource,
    /// The access to it.
    pub access: Access,
    /// Set where the old contents are not needed.
    pub discard: bool,
}

/// A descriptor set with a pool of its own, sized exactly, and what it refers to.
pub struct Bindings {
    device: Arc<Device>,
    pool: vk::DescriptorPool,
    /// The descriptor set, every descriptor of which is written.
    pub(crate) set: vk::DescriptorSet,
    /// Accesses that the descriptors mean.
    pub(crate) uses: Vec<Use>,
    _program: Arc<Program>,
}

impl Bindings {
    /// Writes every descriptor of `program` from `resources`, by name.
    ///
    /// # Errors
    /// [`Error::Pass`] for a binding left out, named twice, unknown, or of the wrong kind. An unwritten descriptor is
    /// an error even where no shader reads it: drivers follow it all the same.
    pub fn new(
        device: &Arc<Device>,
        pass: &str,
        program: &Arc<Program>,
        resources: &[(&str, Resource)],
    ) -> Result<Option<Arc<Self>>, Error> {
        let problem = |problem: String| Error::Pass { pass: pass.to_owned(), problem };
        for (name, _) in resources {
            if !program.slots.iter().any(|s| s.name == *name) {
                let known: Vec<&str> = program.slots.iter().map(|s| s.name.as_str()).collect();
                return Err(problem(format!("its shaders read no {name}; they read {}", known.join(", "))));
            }
        }
        if program.slots.is_empty() {
            return Ok(None);
        }
        let mut uses = Vec::new();
        let mut chosen = Vec::new();
        for slot in &program.slots {
            let mut found = resources.iter().filter(|(name, _)| *name == slot.name);
            let (Some((_, resource)), None) = (found.next(), found.next()) else {
                return Err(problem(format!("{} must be given once", slot.name)));
            };
            resource.check_device(device, pass)?;
            check_range(device, slot, resource)?;
            check_resource(device, slot, resource).map_err(problem)?;
            if let Some(access) = access_of(slot, resource).map_err(problem)? {
                uses.push(Use { resource: resource.clone(), access, discard: false });
            }
            chosen.push(resource);
        }
        join_stages(&mut uses);

        let sizes: Vec<_> = program
            .slots
            .iter()
            .map(|s| vk::DescriptorPoolSize { ty: s.descriptor_type(), descriptor_count: 1 })
            .collect();
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the device is alive and `sizes` outlives the call.
        let pool = unsafe { device.raw.create_descriptor_pool(&info, None) }
            .context("creating the descriptor pool of pass", pass)?;
        device.live().add(Kind::DescriptorPool);
        let mut bindings =
            Bindings { device: device.clone(), pool, set: vk::DescriptorSet::null(), uses, _program: program.clone() };
        let layouts = [program.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layouts);
        // SAFETY: the pool was sized for exactly this layout.
        let sets = unsafe { device.raw.allocate_descriptor_sets(&info) }
            .context("allocating the descriptor set of pass", pass)?;
        bindings.set = sets[0];
        device.name(bindings.set, pass);
        for (slot, resource) in program.slots.iter().zip(chosen) {
            bindings.write(slot, resource);
        }
        Ok(Some(Arc::new(bindings)))
    }

    fn write(&self, slot: &Slot, resource: &Resource) {
        let mut buffers = [vk::DescriptorBufferInfo::default()];
        let mut images = [vk::DescriptorImageInfo::default()];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(self.set)
            .dst_binding(slot.binding)
            .descriptor_type(slot.descriptor_type());
        let write = match resource {
            Resource::Buffer(view) => {
                buffers[0] = vk::DescriptorBufferInfo {
                    buffer: view.buffer.raw,
                    offset: view.range.start,
                    range: view.len_bytes(),
                };
                write.buffer_info(&buffers)
            }
            Resource::Image(view) => {
                let layout = match slot.kind {
                    BindingKind::StorageImage { .. } => vk::ImageLayout::GENERAL,
                    _ => vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
                };
                images[0] = vk::DescriptorImageInfo::default().image_view(view.raw).image_layout(layout);
                write.image_info(&images)
            }
            Resource::Sampler(sampler) => {
                images[0] = vk::DescriptorImageInfo::default().sampler(sampler.raw);
                write.image_info(&images)
            }
        };
        // SAFETY: the set is not in use yet, the resource's kind was checked against the slot, and the views are kept
        // alive by the pass that owns these bindings.
        unsafe { self.device.raw.update_descriptor_sets(&[write], &[]) };
    }
}

impl Drop for Bindings {
    fn drop(&mut self) {
        // SAFETY: a frame keeps the pass, and with it these bindings, until its fence.
        unsafe { self.device.raw.destroy_descriptor_pool(self.pool, None) };
        self.device.live().remove(Kind::DescriptorPool);
    }
}

/// Makes every sampled use of an image one by all stages that sample it. Barriers that are recorded together do not wait for
/// each other: were the stages apart, the first use would move the image to its layout for its own stages alone.
fn join_stages(uses: &mut [Use]) {
    let sampled = |one: &Use| match (&one.resource, one.access) {
        (Resource::Image(view), Access::SampledRead(stages)) => Some((Arc::as_ptr(&view.image), stages)),
        _ => None,
    };
    let all: Vec<_> = uses.iter().filter_map(sampled).collect();
    for one in uses {
        if let Some((image, stages)) = sampled(one) {
            let of_image = all.iter().filter(|(other, _)| *other == image);
            one.access = Access::SampledRead(of_image.fold(stages, |sum, (_, stages)| sum | *stages));
        }
    }
}

/// The access that a descriptor of this kind means; `None` for a sampler, which has no memory.
fn access_of(slot: &Slot, resource: &Resource) -> Result<Option<Access>, String> {
    let stages = slot.stages;
    match (slot.kind, resource) {
        (BindingKind::UniformBuffer, Resource::Buffer(view)) => {
            let bytes = view.len_bytes();
            match slot.block_bytes {
                Some(block) if u64::from(block) > bytes => {
                    Err(format!("{} has {block} bytes and {} only {bytes}", slot.name, resource.name()))
                }
                _ => Ok(Some(Access::UniformRead(stages))),
            }
        }
        (BindingKind::SampledImage, Resource::Image(_)) => Ok(Some(Access::SampledRead(stages))),
        (BindingKind::StorageBuffer { readonly }, Resource::Buffer(_))
        | (BindingKind::StorageImage { readonly, .. }, Resource::Image(_)) => {
            Ok(Some(if readonly { Access::StorageRead(stages) } else { Access::StorageWrite(stages) }))
        }
        (BindingKind::Sampler, Resource::Sampler(_)) => Ok(None),
        (BindingKind::CombinedImageSampler, _) => {
            Err(format!("{} is a combined image and sampler; declare a texture and a sampler", slot.name))
        }
        (kind, resource) => Err(format!("{} is a {kind:?}, and {} is not", slot.name, resource.name())),
    }
}

/// Checks that the device can bind so many bytes at once.
fn check_range(device: &Device, slot: &Slot, resource: &Resource) -> Result<(), Error> {
    let Resource::Buffer(view) = resource else { return Ok(()) };
    let limits = &device.physical().limits;
    let (what, limit) = match slot.kind {
        BindingKind::UniformBuffer => ("size in bytes of a uniform buffer", limits.max_uniform_buffer_range),
        _ => ("size in bytes of a storage buffer", limits.max_storage_buffer_range),
    };
    if view.len_bytes() > u64::from(limit) {
        return Err(Error::Limit {
            object: resource.name().to_owned(),
            what,
            wanted: view.len_bytes(),
            limit: limit.into(),
        });
    }
    Ok(())
}

/// Checks that the device can bind the resource to a descriptor of this kind, and that the resource was made for it.
fn check_resource(device: &Device, slot: &Slot, resource: &Resource) -> Result<(), String> {
    let (limits, name) = (&device.physical().limits, resource.name());
    let not_made = |usage: &str| Err(format!("{} is a {usage}, which {name} was not made to be", slot.name));
    match resource {
        Resource::Buffer(view) => {
            let (usage, kind, alignment) = match slot.kind {
                BindingKind::UniformBuffer => {
                    (vk::BufferUsageFlags::UNIFORM_BUFFER, "uniform buffer", limits.min_uniform_buffer_offset_alignment)
                }
                _ => {
                    (vk::BufferUsageFlags::STORAGE_BUFFER, "storage buffer", limits.min_storage_buffer_offset_alignment)
                }
            };
            if !view.buffer.usage().contains(usage) {
                return not_made(kind);
            }
            if view.range.start % alignment.max(1) != 0 {
                return Err(format!("{name} is bound from byte {}, no multiple of {alignment}", view.range.start));
            }
        }
        Resource::Image(view) => {
            let Some(shape) = slot.image else { return Ok(()) };
            let info = format_info(view.image.desc().format);
            let (usage, kind, fits) = match slot.kind {
                BindingKind::StorageImage { format, .. } => {
                    let fits = info.is_some_and(|info| info.storage == Some(format));
                    (vk::ImageUsageFlags::STORAGE, "storage image", fits)
                }
                _ => {
                    let fits = info.is_some_and(|info| Some(info.scalar) == shape.scalar);
                    (vk::ImageUsageFlags::SAMPLED, "sampled image", fits && view.aspect.as_raw().count_ones() == 1)
                }
            };
            if !view.image.desc().usage.contains(usage) {
                return not_made(kind);
            }
            let is_shape =
                if view.is_3d() { shape.is_3d } else { shape.is_plain_2d && shape.is_array == view.is_array };
            if !fits || !is_shape {
                return Err(format!("{} has another format, aspect or shape than {name}", slot.name));
            }
        }
        Resource::Sampler(_) => {}
    }
    Ok(())
}
