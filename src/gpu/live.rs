//! Counts of the Vulkan objects alive, by kind. A test ends with every count at zero, but for what libraries of shaders keep.

use std::sync::Mutex;

/// The kinds of object that are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Instance,
    Device,
    Buffer,
    Image,
    ImageView,
    Sampler,
    ShaderModule,
    DescriptorSetLayout,
    DescriptorPool,
    PipelineLayout,
    Pipeline,
    RenderPass,
    Framebuffer,
    CommandPool,
    Fence,
    QueryPool,
    Surface,
    Swapchain,
    Semaphore,
}

impl Kind {
    /// Every kind, in the order of its declaration.
    pub const ALL: [Kind; 19] = [
        Kind::Instance,
        Kind::Device,
        Kind::Buffer,
        Kind::Image,
        Kind::ImageView,
        Kind::Sampler,
        Kind::ShaderModule,
        Kind::DescriptorSetLayout,
        Kind::DescriptorPool,
        Kind::PipelineLayout,
        Kind::Pipeline,
        Kind::RenderPass,
        Kind::Framebuffer,
        Kind::CommandPool,
        Kind::Fence,
        Kind::QueryPool,
        Kind::Surface,
        Kind::Swapchain,
        Kind::Semaphore,
    ];
}

/// The live objects of one instance: counts by kind, memory by resource name, and the peak.
#[derive(Debug, Default)]
pub struct LiveObjects {
    counts: Mutex<LiveCounts>,
}

#[derive(Debug, Default)]
struct LiveCounts {
    counts: [usize; Kind::ALL.len()],
    memory: Vec<MemoryUse>,
    total_bytes: u64,
    peak_bytes: u64,
}

/// Memory that the live resources of one name hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryUse {
    /// Debug name of the resources.
    pub name: String,
    /// Bytes allocated for them, alignment included.
    pub bytes: u64,
    /// Set for memory that the host maps.
    pub host_visible: bool,
    count: usize,
}

impl LiveObjects {
    fn lock(&self) -> std::sync::MutexGuard<'_, LiveCounts> {
        self.counts.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    pub(crate) fn add(&self, kind: Kind) {
        self.lock().counts[kind as usize] += 1;
    }

    pub(crate) fn remove(&self, kind: Kind) {
        let mut live = self.lock();
        let count = &mut live.counts[kind as usize];
        *count = count.saturating_sub(1);
    }

    pub(crate) fn add_memory(&self, name: &str, bytes: u64, host_visible: bool) {
        let mut live = self.lock();
        live.total_bytes += bytes;
        live.peak_bytes = live.peak_bytes.max(live.total_bytes);
        match live.memory.iter_mut().find(|m| m.name == name && m.host_visible == host_visible) {
            Some(entry) => {
                entry.bytes += bytes;
                entry.count += 1;
            }
            None => live.memory.push(MemoryUse { name: name.to_owned(), bytes, host_visible, count: 1 }),
        }
    }

    pub(crate) fn remove_memory(&self, name: &str, bytes: u64, host_visible: bool) {
        let mut live = self.lock();
        live.total_bytes = live.total_bytes.saturating_sub(bytes);
        if let Some(at) = live.memory.iter().position(|m| m.name == name && m.host_visible == host_visible) {
            live.memory[at].bytes = live.memory[at].bytes.saturating_sub(bytes);
            live.memory[at].count -= 1;
            if live.memory[at].count == 0 {
                live.memory.remove(at);
            }
        }
    }

    /// Live objects of one kind.
    pub fn count(&self, kind: Kind) -> usize {
        self.lock().counts[kind as usize]
    }

    /// The kinds with live objects and how many; empty when nothing is alive.
    pub fn alive(&self) -> Vec<(Kind, usize)> {
        let live = self.lock();
        Kind::ALL.into_iter().map(|k| (k, live.counts[k as usize])).filter(|&(_, n)| n > 0).collect()
    }

    /// Live memory by resource name, in order of first use; bytes include alignment.
    pub fn memory(&self) -> Vec<MemoryUse> {
        self.lock().memory.clone()
    }

    /// Sum of live memory, bytes.
    pub fn total_bytes(&self) -> u64 {
        self.lock().total_bytes
    }

    /// The highest sum of live memory since the start or the last [`LiveObjects::reset_peak`], in bytes.
    pub fn peak_bytes(&self) -> u64 {
        self.lock().peak_bytes
    }

    /// Starts a new peak at what is alive now.
    pub fn reset_peak(&self) {
        let mut live = self.lock();
        live.peak_bytes = live.total_bytes;
    }
}
