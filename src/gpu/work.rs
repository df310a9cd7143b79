//! The work of a pass that follows from its declaration and its counters: bytes by access, samples by target, triangles,
//! multiply-adds.
//!
//! Certain work stands apart from resources that are merely bound: a shader may read all of a buffer, a part of it, or
//! parts many times, which no declaration tells unless the pass declares the access [whole](super::PassBuilder::whole).

use std::ops::AddAssign;

use ash::vk;

use super::bindings::Resource;
use super::format::format_info;
use super::pass_builder::PassDesc;
use super::pipeline::Topology;
use super::program::Slot;
use super::render_pass::{Blend, DepthTest, Load, Target};
use super::sample::Counts;
use super::transfer::copied_bytes;
use crate::shader_build::BindingKind;

/// Bytes by direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Bytes {
    /// Read by the pass.
    pub read: u64,
    /// Written by the pass.
    pub written: u64,
}

impl AddAssign for Bytes {
    fn add_assign(&mut self, other: Bytes) {
        self.read += other.read;
        self.written += other.written;
    }
}

/// Samples that passed every test and went into a colour attachment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    /// Format of the attachment.
    pub format: vk::Format,
    /// Set where they are blended with what is there.
    pub blends: bool,
    /// Number of samples.
    pub samples: u64,
}

/// Work of one pass in one frame, summed over its recordings.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Work {
    /// Bytes that are certain: of attachments by samples kept, clears included; of copies; of what draws fetch; of accesses
    /// that are declared whole, once a recording.
    pub bytes: Bytes,
    /// The same with all that is merely bound, once a recording; `None` where the samples of an attachment are not known.
    pub bytes_at_most: Option<Bytes>,
    /// Names of resources of which the bytes are not certain.
    pub uncertain: Vec<String>,
    /// Bytes that must come from memory or go there: the certain ones, with attachments once a pixel, without clears and
    /// without what a test or a blend reads of an attachment that is cleared first.
    pub memory_bytes: u64,
    /// Triangles that are set up: assembled, and let through by the clipper; `None` where they are not counted.
    pub triangles: Option<u64>,
    /// Samples of each colour attachment.
    pub kept: Vec<Kept>,
    /// Multiply-adds by the pass's formula; `None` without one.
    pub multiply_adds: Option<u64>,
    /// Recordings with draws or dispatches.
    pub launches: u32,
}

impl Work {
    pub(super) fn add(&mut self, other: Work) {
        let is_first = *self == Work::default();
        self.bytes += other.bytes;
        self.bytes_at_most = match (self.bytes_at_most, other.bytes_at_most) {
            (None, one) if is_first => one,
            (Some(mut sum), Some(one)) => {
                sum += one;
                Some(sum)
            }
            _ => None,
        };
        for name in other.uncertain {
            if !self.uncertain.contains(&name) {
                self.uncertain.push(name);
            }
        }
        self.memory_bytes += other.memory_bytes;
        let sum = |sum: Option<u64>, one: Option<u64>| sum.into_iter().chain(one).reduce(|a, b| a + b);
        self.triangles = sum(self.triangles, other.triangles);
        self.multiply_adds = sum(self.multiply_adds, other.multiply_adds);
        for kept in other.kept {
            match self.kept.iter_mut().find(|known| (known.format, known.blends) == (kept.format, kept.blends)) {
                Some(known) => known.samples += kept.samples,
                None => self.kept.push(kept),
            }
        }
        self.launches += other.launches;
    }
}

/// Elements that the longest draw of a recording fetched, and whether others fetched other ones.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Fetched {
    /// Vertices of draws without indices.
    pub vertices: u64,
    /// Instances.
    pub instances: u64,
    /// Indices.
    pub indices: u64,
    /// Set by a draw whose parameters the device made.
    pub is_indirect: bool,
    /// Set by a draw that does not begin with the first element.
    pub is_partial: bool,
}

/// The part of a pass's work that its declaration fixes.
pub(crate) struct Declared {
    whole: Bytes,
    bound: Bytes,
    uncertain: Vec<String>,
    attachments: Vec<Attachment>,
    pixels: u64,
    vertices: Option<Vertices>,
    index_bytes: Option<u64>,
    has_triangles: bool,
    is_draw_or_dispatch: bool,
}

struct Vertices {
    is_per_instance: bool,
    /// Bytes of the attributes of one element.
    element_bytes: u64,
    buffer_bytes: u64,
}

struct Attachment {
    name: String,
    format: vk::Format,
    texel_bytes: u64,
    is_color: bool,
    is_cleared: bool,
    reads: bool,
    writes: bool,
    blends: bool,
    /// The samples kept tell what happens to it.
    is_certain: bool,
}

impl Declared {
    /// Of a copy.
    pub fn copy(from: &Resource) -> Self {
        let bytes = copied_bytes(from);
        Declared { whole: Bytes { read: bytes, written: bytes }, ..Declared::none() }
    }

    /// Of a pass with `slots`, all of which `desc` has resources for; `element_bytes` are what an element of its vertex
    /// buffer has for the attributes.
    pub fn new(desc: &PassDesc, slots: &[Slot], element_bytes: u64) -> Self {
        let mut declared = Declared::none();
        declared.is_draw_or_dispatch = true;
        for slot in slots {
            let resource = desc.resources.iter().find(|(name, _)| *name == slot.name).map(|(_, resource)| resource);
            let Some(resource) = resource else { continue };
            let bytes = size_bytes(resource);
            let is_whole = desc.whole.contains(&slot.name.as_str());
            match slot.kind {
                BindingKind::Sampler => {}
                kind if kind.is_written() && is_whole => declared.whole.written += bytes,
                kind if kind.is_written() => declared.bind(resource, Bytes { read: bytes, written: bytes }),
                _ if is_whole => declared.whole.read += bytes,
                BindingKind::UniformBuffer => {
                    let block = slot.block_bytes.map_or(bytes, u64::from);
                    declared.bind(resource, Bytes { read: block.min(bytes), written: 0 });
                }
                _ => declared.bind(resource, Bytes { read: bytes, written: 0 }),
            }
        }
        if let Some(extent) = desc.targets.extent() {
            declared.pixels = u64::from(extent.width) * u64::from(extent.height);
        }
        let is_counting = desc.counting.is_some();
        let colors = desc.targets.colors.iter().map(|(target, blend)| Attachment::color(target, *blend, is_counting));
        let depth = desc.targets.depth.iter().map(|(target, test)| Attachment::depth(target, *test, is_counting));
        declared.attachments = colors.chain(depth).collect();
        declared.vertices = desc.vertices.as_ref().map(|view| Vertices {
            is_per_instance: desc.vertex_rate == vk::VertexInputRate::INSTANCE,
            element_bytes,
            buffer_bytes: view.len_bytes(),
        });
        declared.index_bytes = desc.indices.as_ref().map(|view| view.len_bytes());
        let has_geometry = desc.shaders.iter().any(|shader| shader.ends_with(".geom"));
        declared.has_triangles =
            !has_geometry && matches!(desc.topology, Topology::Triangles | Topology::TriangleStrip);
        declared
    }

    fn none() -> Self {
        Declared {
            whole: Bytes::default(),
            bound: Bytes::default(),
            uncertain: Vec::new(),
            attachments: Vec::new(),
            pixels: 0,
            vertices: None,
            index_bytes: None,
            has_triangles: false,
            is_draw_or_dispatch: false,
        }
    }

    fn bind(&mut self, resource: &Resource, bytes: Bytes) {
        self.bound += bytes;
        self.uncertain.push(resource.name().to_owned());
    }

    /// The work of one recording that fetched so much and was counted so.
    pub fn work(&self, desc: &PassDesc, fetched: Fetched, counts: &Counts) -> Work {
        let mut certain = self.whole;
        let mut beyond = self.bound;
        let mut uncertain = self.uncertain.clone();
        if let Some(buffer) = &self.vertices {
            let elements = if buffer.is_per_instance { fetched.instances } else { fetched.vertices };
            let known = (elements * buffer.element_bytes).min(buffer.buffer_bytes);
            certain.read += known;
            // Indices name vertices in any order.
            if fetched.indices > 0 || fetched.is_indirect || fetched.is_partial {
                beyond.read += buffer.buffer_bytes - known;
                uncertain.push("vertices".to_owned());
            }
        }
        if let Some(bytes) = self.index_bytes {
            let known = (fetched.indices * size_of::<u32>() as u64).min(bytes);
            certain.read += known;
            if fetched.is_indirect || fetched.is_partial {
                beyond.read += bytes - known;
                uncertain.push("indices".to_owned());
            }
        }
        let mut memory_bytes = certain.read + certain.written;
        let mut kept = Vec::new();
        let mut are_samples_known = true;
        for attachment in &self.attachments {
            if attachment.is_cleared {
                certain.written += self.pixels * attachment.texel_bytes;
            }
            if !attachment.reads && !attachment.writes {
                continue;
            }
            let Some(samples) = counts.samples_passed.filter(|_| attachment.is_certain) else {
                are_samples_known = false;
                uncertain.push(attachment.name.clone());
                continue;
            };
            let bytes = samples * attachment.texel_bytes;
            let bytes_once = samples.min(self.pixels) * attachment.texel_bytes;
            if attachment.reads {
                certain.read += bytes;
            }
            if attachment.writes {
                certain.written += bytes;
                memory_bytes += bytes_once;
            }
            if attachment.blends && !attachment.is_cleared {
                memory_bytes += bytes_once;
            }
            if attachment.is_color {
                kept.push(Kept { format: attachment.format, blends: attachment.blends, samples });
            }
        }
        let mut at_most = certain;
        at_most += beyond;
        uncertain.sort();
        uncertain.dedup();
        Work {
            bytes: certain,
            bytes_at_most: are_samples_known.then_some(at_most),
            uncertain,
            memory_bytes,
            // Those outside of the picture are not set up, and those that the clipper cuts count once.
            triangles: self.has_triangles.then(|| counts.primitives.min(counts.clipped_primitives)).flatten(),
            kept,
            multiply_adds: desc.multiply_adds.as_ref().and_then(|formula| formula(counts)),
            launches: u32::from(self.is_draw_or_dispatch),
        }
    }
}

impl Attachment {
    fn new(target: &Target) -> Self {
        let format = target.view.image().desc().format;
        Attachment {
            name: target.view.image().name().to_owned(),
            format,
            // Every image's format is known.
            texel_bytes: format_info(format).map_or(0, |info| info.texel_bytes),
            is_color: false,
            is_cleared: matches!(target.load, Load::Clear(_)),
            reads: false,
            writes: false,
            blends: false,
            is_certain: true,
        }
    }

    /// Draws that count into the stencil keep samples too, of which colours get nothing.
    fn color(target: &Target, blend: Blend, is_counting: bool) -> Self {
        let blends = !matches!(blend, Blend::Replace | Blend::Masked);
        let writes = blend != Blend::Masked;
        Attachment { is_color: true, reads: blends, writes, blends, is_certain: !is_counting, ..Self::new(target) }
    }

    /// Samples that fail the test are read as well, and nobody counts them; a stencil changes by rules of its own.
    fn depth(target: &Target, test: DepthTest, is_counting: bool) -> Self {
        let is_certain = !is_counting && !test.has_stencil();
        Attachment { reads: true, writes: test.writes(), is_certain, ..Self::new(target) }
    }
}

fn size_bytes(resource: &Resource) -> u64 {
    match resource {
        Resource::Buffer(view) => view.len_bytes(),
        Resource::Image(_) => copied_bytes(resource),
        Resource::Sampler(_) => 0,
    }
}
