//! Counts of the Vulkan objects alive, by kind. A test ends with every count at zero.

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
}

impl Kind {
    pub const ALL: [Kind; 16] = [
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
    ];
}

/// The ledger of one instance: counts by kind, memory by resource name, and the peak.
#[derive(Debug, Default)]
pub struct LiveObjects {
    ledger: Mutex<Ledger>,
}

#[derive(Debug, Default)]
struct Ledger {
    counts: [usize; Kind::ALL.len()],
    memory: Vec<MemoryUse>,
    total_bytes: u64,
    peak_bytes: u64,
}

/// Memory that the live resources of one name hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MemoryUse {
    pub name: String,
    pub bytes: u64,
    /// Whether the memory lies where the host maps it.
    pub host_visible: bool,
    count: usize,
}

impl LiveObjects {
    fn lock(&self) -> std::sync::MutexGuard<'_, Ledger> {
        self.ledger.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    pub(crate) fn add(&self, kind: Kind) {
        self.lock().counts[kind as usize] += 1;
    }

    pub(crate) fn remove(&self, kind: Kind) {
        let mut ledger = self.lock();
        let count = &mut ledger.counts[kind as usize];
        *count = count.saturating_sub(1);
    }

    pub(crate) fn add_memory(&self, name: &str, bytes: u64, host_visible: bool) {
        let mut ledger = self.lock();
        ledger.total_bytes += bytes;
        ledger.peak_bytes = ledger.peak_bytes.max(ledger.total_bytes);
        match ledger.memory.iter_mut().find(|m| m.name == name && m.host_visible == host_visible) {
            Some(entry) => {
                entry.bytes += bytes;
                entry.count += 1;
            }
            None => ledger.memory.push(MemoryUse { name: name.to_owned(), bytes, host_visible, count: 1 }),
        }
    }

    pub(crate) fn remove_memory(&self, name: &str, bytes: u64, host_visible: bool) {
        let mut ledger = self.lock();
        ledger.total_bytes = ledger.total_bytes.saturating_sub(bytes);
        if let Some(at) = ledger.memory.iter().position(|m| m.name == name && m.host_visible == host_visible) {
            ledger.memory[at].bytes = ledger.memory[at].bytes.saturating_sub(bytes);
            ledger.memory[at].count -= 1;
            if ledger.memory[at].count == 0 {
                ledger.memory.remove(at);
            }
        }
    }

    /// The kinds with live objects and how many; empty when nothing is alive.
    pub fn alive(&self) -> Vec<(Kind, usize)> {
        let ledger = self.lock();
        Kind::ALL.into_iter().map(|k| (k, ledger.counts[k as usize])).filter(|&(_, n)| n > 0).collect()
    }

    /// Live memory by resource name, in order of first use; bytes include alignment.
    pub fn memory(&self) -> Vec<MemoryUse> {
        self.lock().memory.clone()
    }

    /// The highest sum of live memory since the start or the last [`LiveObjects::reset_peak`], in bytes.
    pub fn peak_bytes(&self) -> u64 {
        self.lock().peak_bytes
    }

    /// Starts a new peak at what is alive now.
    pub fn reset_peak(&self) {
        let mut ledger = self.lock();
        ledger.peak_bytes = ledger.total_bytes;
    }
}
