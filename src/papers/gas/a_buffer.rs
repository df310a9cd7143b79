//! The A-buffer: a list of fragments a pixel, with sections of gas between them.

use std::sync::Arc;

use ash::vk;
use glam::{Vec2, Vec3};
use half::f16;

use super::blocks::{ColorBlock, CountersBlock, LinkBlock, PixelBlock, SectionBlock, SurfaceBlock};
use super::capacity::Capacity;
use super::context::Context;
use super::progress::Progress;
use crate::gpu::transfer::{read_buffer, upload};
use crate::gpu::{Buffer, BufferDesc, Error, ShaderLibrary};

/// The bit of a link that leads to a section, see `lists.glsl`.
const SECTION_LINK: u32 = 1 << 31;

/// The lists of the pixels of a band.
pub struct ABuffer {
    /// Rows and slots.
    pub capacity: Capacity,
    /// Of each pixel, the first fragment or section of its list.
    pub heads: Arc<Buffer>,
    /// Of each fragment, a [`LinkBlock`].
    pub links: Arc<Buffer>,
    /// Of each fragment, a [`SurfaceBlock`].
    pub surfaces: Arc<Buffer>,
    /// Of each fragment, a [`ColorBlock`].
    pub colors: Arc<Buffer>,
    /// Of each pixel, a [`PixelBlock`].
    pub pixels: Arc<Buffer>,
    /// One [`CountersBlock`].
    pub counters: Arc<Buffer>,
    /// The pixels whose rays meet gas, see `gas-pixels.glsl`: a `VkDispatchIndirectCommand`, their count, and each.
    pub gas_pixels: Arc<Buffer>,
    /// States of pixels that a pass has not finished.
    pub progress: Progress,
}

/// A fragment as the device left it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fragment {
    /// Bit 4 row + column of a sub-pixel, rows from the top.
    pub mask: u32,
    /// Depth along the view direction, metres.
    pub depth_m: [f32; 2],
    /// Area of the triangle inside the pixel, pixels.
    pub coverage: f32,
    /// 0 to 1.
    pub opacity: f32,
    /// Index of the object.
    pub object: u32,
    /// Index of the triangle among those of all objects.
    pub triangle: u32,
    /// Linear RGB, as half floats hold it.
    pub color: [f32; 3],
    /// Unit vector, to the 16 bits that hold each half of it.
    pub normal: [f32; 3],
}

impl ABuffer {
    /// # Errors
    /// [`Error::Limit`] for a capacity or a picture beyond what the device binds.
    pub fn new(context: &Context<'_>, capacity: Capacity) -> Result<Self, Error> {
        let pixel_count = u64::from(context.parameters.width.saturating_mul(capacity.rows));
        let fragment_count = capacity.fragments.into();
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let zeros = [0; size_of::<CountersBlock>()];
        let device = context.shaders.device();
        let gas_pixels = BufferDesc::new(context.name("gas-pixels"), 4 * (4 + pixel_count));
        Ok(ABuffer {
            capacity,
            heads: context.storage::<u32>("heads", pixel_count)?,
            links: context.storage::<LinkBlock>("fragment-links", fragment_count)?,
            surfaces: context.storage::<SurfaceBlock>("fragment-surfaces", fragment_count)?,
            colors: context.storage::<ColorBlock>("fragment-colors", fragment_count)?,
            pixels: context.storage::<PixelBlock>("pixels", pixel_count)?,
            counters: upload(device, &context.name("counters"), usage, &zeros)?,
            gas_pixels: Buffer::new(device, gas_pixels.usage(usage | vk::BufferUsageFlags::INDIRECT_BUFFER))?,
            progress: Progress::new(context, pixel_count)?,
        })
    }

    /// The most fragments and sections that any band of any frame has wanted; more than the capacity means a picture
    /// with gaps.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn demand(&self, shaders: &ShaderLibrary) -> Result<Capacity, Error> {
        let counters = read::<CountersBlock>(shaders, &self.counters)?;
        let most = |of: fn(&CountersBlock) -> u32| counters.iter().map(of).max().unwrap_or(0);
        Ok(Capacity {
            fragments: most(|c| c.fragment_count.max(c.most_fragments)),
            sections: most(|c| c.section_count.max(c.most_sections)),
            chunks: most(|c| c.most_chunks),
            ..self.capacity
        })
    }

    /// Fragments that all bands of the last frame have wanted.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn wanted_fragments(&self, shaders: &ShaderLibrary) -> Result<u64, Error> {
        let counters = read::<CountersBlock>(shaders, &self.counters)?;
        let of_frame = |c: &CountersBlock| {
            (u64::from(c.earlier_fragments_high) << 32) + u64::from(c.earlier_fragments) + u64::from(c.fragment_count)
        };
        Ok(counters.iter().map(of_frame).sum())
    }

    /// The most triangles of a tile that any band of any frame has had.
    ///
    /// # Errors
    /// [`Error::Pass`] where the device ended a loop over them; those of Vulkan.
    pub fn most_of_tile(&self, shaders: &ShaderLibrary) -> Result<u32, Error> {
        let counters = read::<CountersBlock>(shaders, &self.counters)?;
        if counters.iter().any(|c| c.is_ended != 0) {
            let problem = "the device ends its loops over the triangles of a tile; give `lists` linked".to_owned();
            return Err(Error::Pass { pass: "fragments".to_owned(), problem });
        }
        Ok(counters.iter().map(|c| c.most_of_tile).max().unwrap_or(0))
    }

    /// Pixels that lack fragments which linked lists may show, in the frame that has the most of them; 0 without a
    /// k-buffer.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn lost_pixels(&self, shaders: &ShaderLibrary) -> Result<u32, Error> {
        let counters = read::<CountersBlock>(shaders, &self.counters)?;
        Ok(counters.iter().map(|c| c.lost_pixels.max(c.most_lost_pixels)).max().unwrap_or(0))
    }

    /// Evaluations of the density that `volume` has noted of the first `pixel_count` pixels of a band: behind those of the last
    /// band stand others of bands before it.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn evaluations(&self, shaders: &ShaderLibrary, pixel_count: usize) -> Result<u64, Error> {
        let pixels = read::<PixelBlock>(shaders, &self.pixels)?;
        Ok(pixels.iter().take(pixel_count).map(|pixel| u64::from(pixel.evaluations)).sum())
    }

    /// The sorted fragments of the last band of the last frame, pixel by pixel; `sections` are those between them.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn read(&self, shaders: &ShaderLibrary, sections: Option<&Arc<Buffer>>) -> Result<Vec<Vec<Fragment>>, Error> {
        let heads = read::<u32>(shaders, &self.heads)?;
        let links = read::<LinkBlock>(shaders, &self.links)?;
        let surfaces = read::<SurfaceBlock>(shaders, &self.surfaces)?;
        let colors = read::<ColorBlock>(shaders, &self.colors)?;
        let sections = sections.map_or_else(|| Ok(Vec::new()), |buffer| read::<SectionBlock>(shaders, buffer))?;
        let fragment_at = |node: u32| {
            let after = |&node: &u32| {
                let section = (node != u32::MAX && node & SECTION_LINK != 0).then_some(node & !SECTION_LINK)?;
                sections.get(section as usize).map(|section| section.next)
            };
            std::iter::successors(Some(node), after).last().unwrap_or(u32::MAX) as usize
        };
        let list = |&head: &u32| {
            let mut next = head;
            std::iter::from_fn(|| {
                let index = fragment_at(next);
                let link = links.get(index)?;
                next = link.next;
                Some(Fragment::new(link, surfaces.get(index)?, colors.get(index)?))
            })
            .collect()
        };
        Ok(heads.iter().map(list).collect())
    }
}

/// The elements of a buffer.
pub fn read<T: bytemuck::Pod>(shaders: &ShaderLibrary, buffer: &Arc<Buffer>) -> Result<Vec<T>, Error> {
    Ok(bytemuck::pod_collect_to_vec(&read_buffer(shaders.device(), buffer)?))
}

impl Fragment {
    fn new(link: &LinkBlock, surface: &SurfaceBlock, color: &ColorBlock) -> Self {
        let ColorBlock { red_green, blue_opacity } = *color;
        Fragment {
            mask: link.mask,
            depth_m: [link.near_m, link.far_m],
            coverage: surface.coverage,
            opacity: (blue_opacity >> 16) as f32 / 65535.0,
            object: surface.object,
            triangle: surface.triangle,
            color: [red_green, red_green >> 16, blue_opacity].map(|half| f16::from_bits(half as u16).to_f32()),
            normal: unpack_normal(surface.normal).to_array(),
        }
    }
}

/// The unit vector of an octahedral normal, 16 bits each way.
fn unpack_normal(packed: u32) -> Vec3 {
    let folded = [packed, packed >> 16].map(|half| (f32::from(half as u16 as i16) / 32767.0).max(-1.0));
    let folded = Vec2::from(folded);
    let z = 1.0 - folded.x.abs() - folded.y.abs();
    let t = (-z).max(0.0);
    (folded - folded.signum() * t).extend(z).normalize_or(Vec3::Y)
}
