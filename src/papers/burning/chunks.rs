//! The chunks of vertices and triangles, and the lists of those that a tick visits, which the device makes.

use std::sync::Arc;

use ash::vk;

use super::model::{CHUNK, Chunks};
use super::ping_pong::Work;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/chunks-visited.comp`.
    pub struct ChunkCount {
        /// Chunks in all.
        count: u32,
        /// Workgroups that the device takes in a row.
        row: u32,
    }
}

/// Words of a chunk beside its elements: its span, twice whether it has finished, and its number in lists, twice in that of what changes.
pub(super) const WORDS: f64 = 7.0 / CHUNK as f64;

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// The chunks of vertices or of triangles.
pub struct ChunkBuffers {
    /// uint\[whole chunks\]: elements, NONE beyond the last.
    pub order: Arc<Buffer>,
    /// float\[2 chunks\]: least and greatest R.
    pub spans: Arc<Buffer>,
    /// uint\[chunks\]: 1 where nothing is left to burn.
    pub finished: Arc<Buffer>,
    /// Those that the tick changes; before the first one all.
    pub changed: Visits,
    count: ChunkCount,
}

/// A list of chunks that the device makes.
pub struct Visits {
    /// uint\[1 + chunks\]: how many, then their numbers.
    pub visited: Arc<Buffer>,
    /// `VkDispatchIndirectCommand`.
    pub groups: Arc<Buffer>,
}

impl ChunkBuffers {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, label: &str, chunks: &Chunks) -> Result<Self, Error> {
        let [row, ..] = shaders.device().physical().limits.max_compute_work_group_count;
        let count = ChunkCount { count: chunks.count(), row };
        let table = |what: &str, bytes: &[u8]| upload(shaders.device(), &format!("{label}-{what}"), STORAGE, bytes);
        Ok(ChunkBuffers {
            order: table("order", bytemuck::cast_slice(&chunks.order))?,
            spans: table("spans", bytemuck::cast_slice(&chunks.spans))?,
            finished: table("finished", &vec![0; 4 * count.count as usize])?,
            changed: Visits::all(shaders, &format!("{label}-changed"), count)?,
            count,
        })
    }

    /// A list of other chunks than those that change.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn list(&self, shaders: &ShaderLibrary, label: &str) -> Result<Visits, Error> {
        Visits::new(shaders, label, self.count.count)
    }

    /// A list of all chunks.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn all(&self, shaders: &ShaderLibrary, label: &str) -> Result<Visits, Error> {
        Visits::all(shaders, label, self.count)
    }

    /// The step of a pass that makes a list; what it needs beside spans and list is the caller's.
    pub fn listing(&self, step: PassBuilder, visits: &Visits) -> PassBuilder {
        step.constants::<ChunkCount>()
            .with("Spans", &self.spans)
            .with("Visited", &visits.visited)
            .with("Groups", &visits.groups)
    }

    /// The work of such a step.
    pub fn lists(&self) -> Work {
        Work::Lists(self.count)
    }

    /// The pass over the elements of the chunks of a list.
    pub fn visiting(&self, pass: PassBuilder, visits: &Visits) -> PassBuilder {
        pass.with("Order", &self.order).with("Visited", &visits.visited).indirect(&visits.groups)
    }

    /// As [`ChunkBuffers::visiting`], of the chunks that change.
    pub fn changing(&self, pass: PassBuilder) -> PassBuilder {
        self.visiting(pass, &self.changed)
    }

    /// An unwritten word for each chunk, 0.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn word(&self, shaders: &ShaderLibrary, label: &str) -> Result<Arc<Buffer>, Error> {
        upload(shaders.device(), label, STORAGE, &vec![0; 4 * self.count.count as usize])
    }
}

impl Visits {
    fn all(shaders: &ShaderLibrary, label: &str, chunks: ChunkCount) -> Result<Self, Error> {
        let ChunkCount { count, row } = chunks;
        let numbers: Vec<u32> = std::iter::once(count).chain(0..count).collect();
        let rows = count.div_ceil(row).max(1);
        let visited = upload(shaders.device(), label, STORAGE, bytemuck::cast_slice(&numbers))?;
        let groups = vk::BufferUsageFlags::INDIRECT_BUFFER | STORAGE;
        let groups = upload(
            shaders.device(),
            &format!("{label}-groups"),
            groups,
            bytemuck::cast_slice(&[count.div_ceil(rows), rows, 1]),
        )?;
        Ok(Visits { visited, groups })
    }

    fn new(shaders: &ShaderLibrary, label: &str, count: u32) -> Result<Self, Error> {
        let groups = STORAGE | vk::BufferUsageFlags::INDIRECT_BUFFER;
        let empty =
            |name: String, bytes: u64, usage| Buffer::new(shaders.device(), BufferDesc::new(name, bytes).usage(usage));
        Ok(Visits {
            visited: empty(label.to_owned(), 4 * (1 + u64::from(count)), STORAGE)?,
            groups: empty(format!("{label}-groups"), size_of::<vk::DispatchIndirectCommand>() as u64, groups)?,
        })
    }
}
