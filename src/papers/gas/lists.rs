//! The A-buffer: a list of fragments a pixel, sorted, with the slots of the sections to come.

use std::sync::Arc;

use ash::vk;
use glam::{Vec2, Vec3};
use half::f16;

use super::capacity::{Band, Capacity, LINK_BYTES, PIXEL_BYTES};
use super::geometry::Geometry;
use super::parameters::Parameters;
use crate::gpu::transfer::{read_buffer, upload};
use crate::gpu::{Buffer, BufferDesc, Error, Feature, Frame, Pass, ShaderLibrary, Topology};

const COLOR_BYTES: u64 = 8;

/// Of a link that leads to a section, see `lists.glsl`.
const SECTION_LINK: u32 = 1 << 31;

/// The section of the paper that these passes come from.
const SECTION: &str = "A-buffer";

/// The lists of one configuration.
pub struct Lists {
    pub capacity: Capacity,
    pub heads: Arc<Buffer>,
    pub links: Arc<Buffer>,
    pub surfaces: Arc<Buffer>,
    pub colors: Arc<Buffer>,
    pub pixels: Arc<Buffer>,
    counters: Arc<Buffer>,
    empty: Pass,
    fragments: Pass,
    sort: Pass,
    width: u32,
    /// Vertices that the fragments pass draws.
    vertex_count: u32,
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
    pub object: u32,
    pub triangle: u32,
    /// Linear RGB, as half floats hold it.
    pub color: [f32; 3],
    /// Of unit length, to the 16 bits that hold each half of it.
    pub normal: [f32; 3],
}

impl Lists {
    /// # Errors
    /// [`Error::Limit`] for a capacity or a picture beyond what the device binds.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        geometry: &Geometry,
        parameters: &Parameters,
        capacity: Capacity,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let pixel_count = parameters.width.saturating_mul(capacity.rows);
        let buffer = |name: &str, count: u32, bytes: u64| {
            let desc = BufferDesc::new(format!("{label}/{name}"), u64::from(count) * bytes);
            Buffer::new(device, desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
        };
        let heads = buffer("heads", pixel_count, 4)?;
        let links = buffer("fragment-links", capacity.fragments, LINK_BYTES)?;
        let surfaces = buffer("fragment-surfaces", capacity.fragments, LINK_BYTES)?;
        let colors = buffer("fragment-colors", capacity.fragments, COLOR_BYTES)?;
        let pixels = buffer("pixels", pixel_count, PIXEL_BYTES)?;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let counters = upload(device, &format!("{label}/counters"), usage, &[0; 16])?;
        let empty = Pass::compute("empty-lists", SECTION, "gas/empty-lists.comp")
            .with("frame", &geometry.frame)
            .with("Heads", &heads)
            .with("Counters", &counters)
            .constants::<Band>()
            .build(shaders)?;
        let has_geometry_stage = parameters.geometry_stage && device.physical().has(Feature::GeometryShader);
        let first = if has_geometry_stage {
            Pass::graphics("fragments", SECTION, "gas/fragments.vert", "gas/fragments.frag")
                .geometry("gas/fragments.geom")
                .topology(Topology::Points)
        } else {
            Pass::graphics("fragments", SECTION, "gas/fragments-pulled.vert", "gas/fragments.frag")
        };
        let fragments = first
            .with("frame", &geometry.frame)
            .with("Volumes", &geometry.volumes)
            .with("Offsets", &geometry.offsets)
            .with("Vertices", &geometry.vertices)
            .with("Triangles", &geometry.triangles)
            .with("Objects", &geometry.objects)
            .with("Heads", &heads)
            .with("Links", &links)
            .with("Surfaces", &surfaces)
            .with("Colors", &colors)
            .with("Counters", &counters)
            .constants::<Band>()
            .extent(parameters.width, parameters.height)
            .build(shaders)?;
        let sort = Pass::compute("sort", SECTION, "gas/sort.comp")
            .with("frame", &geometry.frame)
            .with("Volumes", &geometry.volumes)
            .with("Heads", &heads)
            .with("Links", &links)
            .with("Surfaces", &surfaces)
            .with("Colors", &colors)
            .with("Counters", &counters)
            .with("Pixels", &pixels)
            .constants::<Band>()
            .build(shaders)?;
        Ok(Lists {
            capacity,
            heads,
            links,
            surfaces,
            colors,
            pixels,
            counters,
            empty,
            fragments,
            sort,
            width: parameters.width,
            vertex_count: geometry.triangle_count.saturating_mul(if has_geometry_stage { 1 } else { 6 }),
        })
    }

    /// Makes the sorted lists of a band.
    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        frame.compute(&self.empty, |dispatch| {
            dispatch.constants(&band).threads(self.width, band.rows(), 1);
        })?;
        frame.graphics(&self.fragments, |draw| {
            draw.constants(&band).vertices(self.vertex_count);
        })?;
        frame.compute(&self.sort, |dispatch| {
            dispatch.constants(&band).threads(self.width, band.rows(), 1);
        })
    }

    /// The most fragments and sections that any band of any frame has wanted; more than the capacity means a picture with
    /// gaps.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn demand(&self, shaders: &ShaderLibrary) -> Result<Capacity, Error> {
        let bytes = read_buffer(shaders.device(), &self.counters)?;
        let counts: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let most = |a: usize, b: usize| counts.get(a).max(counts.get(b)).copied().unwrap_or(0);
        Ok(Capacity { fragments: most(0, 2), sections: most(1, 3), ..self.capacity })
    }

    /// Evaluations of the density that `volume` has noted in the last band.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn evaluations(&self, shaders: &ShaderLibrary) -> Result<u64, Error> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(shaders.device(), &self.pixels)?);
        Ok(words.chunks_exact(4).map(|pixel| u64::from(pixel[3])).sum())
    }

    /// The sorted fragments of the last band of the last frame, pixel by pixel; `sections` are those between them.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn read(&self, shaders: &ShaderLibrary, sections: Option<&Arc<Buffer>>) -> Result<Vec<Vec<Fragment>>, Error> {
        let words = |buffer: &Arc<Buffer>| -> Result<Vec<u32>, Error> {
            Ok(bytemuck::pod_collect_to_vec(&read_buffer(shaders.device(), buffer)?))
        };
        let (heads, links) = (words(&self.heads)?, words(&self.links)?);
        let (surfaces, colors) = (words(&self.surfaces)?, words(&self.colors)?);
        let sections = sections.map_or_else(|| Ok(Vec::new()), words)?;
        let fragment_at = |node: u32| {
            let after = |&node: &u32| {
                let section = (node != u32::MAX && node & SECTION_LINK != 0).then_some(node & !SECTION_LINK)?;
                sections.get(8 * section as usize + 3).copied()
            };
            std::iter::successors(Some(node), after).last().unwrap_or(u32::MAX)
        };
        let fragment = |at: usize| -> Option<(Fragment, u32)> {
            let &[next, mask, near, far] = links.get(4 * at..4 * at + 4)? else { return None };
            let &[normal, object, triangle, coverage] = surfaces.get(4 * at..4 * at + 4)? else { return None };
            let &[red_green, blue_opacity] = colors.get(2 * at..2 * at + 2)? else { return None };
            let opacity = (blue_opacity >> 16) as f32 / 65535.0;
            let color = [red_green, red_green >> 16, blue_opacity].map(|c| f16::from_bits(c as u16).to_f32());
            let normal = unpack_normal(normal).to_array();
            let depth_m = [near, far].map(f32::from_bits);
            let coverage = f32::from_bits(coverage);
            Some((Fragment { mask, depth_m, coverage, opacity, object, triangle, color, normal }, next))
        };
        let list = |&head: &u32| {
            let mut next = head;
            std::iter::from_fn(|| {
                let (found, after) = fragment(fragment_at(next) as usize)?;
                next = after;
                Some(found)
            })
            .collect()
        };
        Ok(heads.iter().map(list).collect())
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
