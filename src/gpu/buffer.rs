//! Buffers, their memory, and views of byte ranges of them.

use std::ops::Range;
use std::ptr::NonNull;
use std::sync::Arc;

use ash::vk;
use gpu_allocator::vulkan::Allocation;

use super::access::State;
use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;
use super::memory::allocate;
use super::tracked::{InUse, SubmissionId, Tracked};

/// The memory that a buffer lies in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Location {
    /// The device's own memory.
    Device,
    /// Mapped, for the host to write.
    Upload,
    /// Mapped, for the host to read.
    Readback,
}

/// The description of a buffer; [`Buffer::new`] makes it.
#[derive(Debug, Clone)]
pub struct BufferDesc {
    /// Debug name.
    pub name: String,
    /// Size in bytes.
    pub size_bytes: u64,
    /// Every use that Vulkan is to allow of it.
    pub usage: vk::BufferUsageFlags,
    /// The memory it lies in.
    pub location: Location,
}

impl BufferDesc {
    /// A buffer in device memory that copies may fill and read.
    pub fn new(name: impl Into<String>, size_bytes: u64) -> Self {
        BufferDesc {
            name: name.into(),
            size_bytes,
            usage: vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST,
            location: Location::Device,
        }
    }

    /// Adds uses to those of copies.
    pub fn usage(mut self, usage: vk::BufferUsageFlags) -> Self {
        self.usage |= usage;
        self
    }

    /// Chooses the memory it lies in.
    pub fn location(mut self, location: Location) -> Self {
        self.location = location;
        self
    }
}

/// A buffer with its memory; it remembers what was last done to each of its byte ranges.
pub struct Buffer {
    /// Handle.
    pub(crate) raw: vk::Buffer,
    /// The device that it was made on.
    pub(super) device: Arc<Device>,
    allocation: Option<Allocation>,
    allocated_bytes: u64,
    desc: BufferDesc,
    /// The state of each byte range, in order and without gaps.
    pub(super) states: Tracked<Vec<(Range<u64>, State)>>,
}

impl Buffer {
    /// Makes a buffer; its size is at least four bytes.
    ///
    /// # Errors
    /// [`Error::Limit`] when a storage buffer is larger than the device binds, [`Error::OutOfMemory`].
    pub fn new(device: &Arc<Device>, mut desc: BufferDesc) -> Result<Arc<Self>, Error> {
        let size_bytes = desc.size_bytes.max(4);
        if desc.usage.contains(vk::BufferUsageFlags::INDEX_BUFFER) && !device.physical().has_full_indices() {
            // A kernel reads the indices before each draw: see `indirect`.
            desc.usage |= vk::BufferUsageFlags::STORAGE_BUFFER;
        }
        let limit = device.physical().limits.max_storage_buffer_range as u64;
        if desc.usage.contains(vk::BufferUsageFlags::STORAGE_BUFFER) && size_bytes > limit {
            return Err(Error::Limit {
                object: desc.name,
                what: "size in bytes of a storage buffer",
                wanted: size_bytes,
                limit,
            });
        }
        check_usage(device, &desc, size_bytes)?;
        let info =
            vk::BufferCreateInfo::default().size(size_bytes).usage(desc.usage).sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is alive; usage and size are such as it takes.
        let raw = unsafe { device.raw.create_buffer(&info, None) }.context("creating buffer", &desc.name)?;
        device.live().add(Kind::Buffer);
        let whole = 0..size_bytes;
        let mut buffer = Buffer {
            raw,
            device: device.clone(),
            allocation: None,
            allocated_bytes: 0,
            desc: BufferDesc { size_bytes, ..desc },
            states: Tracked::new(vec![(whole, State::NEW)]),
        };
        device.name(raw, &buffer.desc.name);
        // SAFETY: `raw` is a live buffer of this device.
        let requirements = unsafe { device.raw.get_buffer_memory_requirements(raw) };
        let allocation = allocate(device, &buffer.desc.name, requirements, buffer.desc.location, true)?;
        // SAFETY: the memory fits the requirements, is bound once, and is freed after the buffer is destroyed.
        unsafe { device.raw.bind_buffer_memory(raw, allocation.memory(), allocation.offset()) }
            .context("binding memory of buffer", &buffer.desc.name)?;
        buffer.allocated_bytes = allocation.size();
        device.live().add_memory(&buffer.desc.name, allocation.size(), buffer.is_mapped());
        buffer.allocation = Some(allocation);
        Ok(Arc::new(buffer))
    }

    /// Debug name.
    pub fn name(&self) -> &str {
        &self.desc.name
    }

    /// Size in bytes, at least 4.
    pub fn size_bytes(&self) -> u64 {
        self.desc.size_bytes
    }

    pub(crate) fn usage(&self) -> vk::BufferUsageFlags {
        self.desc.usage
    }

    /// The whole buffer as a view.
    pub fn view(self: &Arc<Self>) -> BufferView {
        BufferView { buffer: self.clone(), range: 0..self.desc.size_bytes }
    }

    /// A range of bytes as a view.
    ///
    /// # Errors
    /// [`Error::Limit`] for a range that is empty or ends beyond the buffer.
    pub fn range(self: &Arc<Self>, range: Range<u64>) -> Result<BufferView, Error> {
        if range.is_empty() || range.end > self.desc.size_bytes {
            return Err(Error::Limit {
                object: self.desc.name.clone(),
                what: "end in bytes of a range that begins before it",
                wanted: range.end,
                limit: self.desc.size_bytes,
            });
        }
        Ok(BufferView { buffer: self.clone(), range })
    }

    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    pub(crate) fn is_readback(&self) -> bool {
        self.desc.location == Location::Readback
    }

    fn is_mapped(&self) -> bool {
        self.desc.location != Location::Device
    }

    /// Writes `bytes` at `offset_bytes` into a mapped buffer and marks it as written by the host.
    ///
    /// # Errors
    /// [`Error::HostAccess`] when the buffer is not mapped or too small, or while an unfinished frame or a reader uses it.
    pub fn write(&self, offset_bytes: u64, bytes: &[u8]) -> Result<(), Error> {
        let end = offset_bytes.saturating_add(bytes.len() as u64);
        let target = self.mapped(end).ok_or_else(|| self.not_mapped("writing"))?;
        let written = self.states.write_from_host(|states| {
            // SAFETY: the mapping holds `end` bytes; no submission and no reader has the buffer while its state is
            // locked, and `bytes` is no part of it, which is lent out by `read` alone.
            unsafe {
                target.add(offset_bytes as usize).copy_from_nonoverlapping(NonNull::from(bytes).cast(), bytes.len())
            };
            visit_range(states, offset_bytes..end, |state| *state = State::HOST_WRITTEN);
        });
        written.map_err(|InUse| self.in_use("writing"))
    }

    /// Hands the first `len_bytes` mapped bytes to `read`.
    ///
    /// # Errors
    /// [`Error::HostAccess`] when the buffer is not mapped, too small, or not written for the host that far, or while an
    /// unfinished frame uses it.
    pub fn read<T>(&self, len_bytes: u64, read: impl FnOnce(&[u8]) -> T) -> Result<T, Error> {
        let source = self.mapped(len_bytes).ok_or_else(|| self.not_mapped("reading"))?;
        let look = |states: &Vec<(Range<u64>, State)>| {
            states.iter().filter(|(range, _)| range.start < len_bytes).all(|(_, state)| state.is_for_host())
        };
        let (is_for_host, _guard) = self.states.read_from_host(look).map_err(|InUse| self.in_use("reading"))?;
        if !is_for_host {
            let problem = "reading it: nothing was written there for the host to read".to_owned();
            return Err(Error::HostAccess { object: self.desc.name.clone(), problem });
        }
        // SAFETY: the mapping holds `len_bytes`, which the device has written and the host may see; while the guard
        // lives no submission and no writer can have the buffer.
        Ok(read(unsafe { NonNull::slice_from_raw_parts(source, len_bytes as usize).as_ref() }))
    }

    /// The start of the mapped memory, where it holds `len_bytes`.
    fn mapped(&self, len_bytes: u64) -> Option<NonNull<u8>> {
        let allocation = self.allocation.as_ref().filter(|_| self.is_mapped() && len_bytes <= self.desc.size_bytes)?;
        allocation.mapped_ptr().map(NonNull::cast)
    }

    fn not_mapped(&self, what: &str) -> Error {
        let problem = format!("{what} it: it is not mapped that far");
        Error::HostAccess { object: self.desc.name.clone(), problem }
    }

    fn in_use(&self, what: &str) -> Error {
        let problem = format!("{what} it: a frame, a copy or a reader that has not finished uses it");
        Error::HostAccess { object: self.desc.name.clone(), problem }
    }

    /// Visits the states of `range` on behalf of a submission; true when it is the first time.
    pub(crate) fn with_states(
        &self,
        submission: SubmissionId,
        range: Range<u64>,
        visit: impl FnMut(&mut State),
    ) -> Result<bool, InUse> {
        self.states.visit(submission, |states| visit_range(states, range, visit)).map(|((), is_first)| is_first)
    }
}

/// Visits the states of `range`, split so that every visited piece lies inside it.
fn visit_range(states: &mut Vec<(Range<u64>, State)>, range: Range<u64>, mut visit: impl FnMut(&mut State)) {
    for cut in [range.start, range.end] {
        if let Some(at) = states.iter().position(|(r, _)| r.start < cut && cut < r.end) {
            let (piece, state) = states[at].clone();
            states[at].0.end = cut;
            states.insert(at + 1, (cut..piece.end, state));
        }
    }
    for (piece, state) in states.iter_mut() {
        if piece.start >= range.start && piece.end <= range.end {
            visit(state);
        }
    }
    // Ranges that are written anew each frame, at other lengths, would cut the list ever finer.
    states.dedup_by(|next, piece| {
        let same = piece.1 == next.1;
        if same {
            piece.0.end = next.0.end;
        }
        same
    });
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: a frame keeps an `Arc` of what it uses until its fence, so the device no longer reads this buffer.
        unsafe { self.device.raw.destroy_buffer(self.raw, None) };
        self.device.live().remove(Kind::Buffer);
        if let Some(allocation) = self.allocation.take() {
            self.device.live().remove_memory(&self.desc.name, self.allocated_bytes, self.is_mapped());
            // Freeing fails only for memory of another allocator.
            let _ = self.device.allocator().free(allocation);
        }
    }
}

/// A byte range of a buffer.
#[derive(Clone)]
pub struct BufferView {
    /// The buffer that the range lies in.
    pub(crate) buffer: Arc<Buffer>,
    /// Bytes, from the first to the one behind the last.
    pub(crate) range: Range<u64>,
}

impl BufferView {
    pub(crate) fn len_bytes(&self) -> u64 {
        self.range.end - self.range.start
    }

    /// The buffer that the range lies in.
    pub fn buffer(&self) -> &Arc<Buffer> {
        &self.buffer
    }
}

/// The uses that the layer knows, and a size that the device takes.
fn check_usage(device: &Device, desc: &BufferDesc, size_bytes: u64) -> Result<(), Error> {
    use vk::BufferUsageFlags as U;
    let known = U::TRANSFER_SRC
        | U::TRANSFER_DST
        | U::UNIFORM_BUFFER
        | U::STORAGE_BUFFER
        | U::VERTEX_BUFFER
        | U::INDEX_BUFFER
        | U::INDIRECT_BUFFER;
    if desc.usage.is_empty() || !known.contains(desc.usage) {
        return Err(Error::Unsupported {
            object: desc.name.clone(),
            problem: format!("a buffer for {:?}", desc.usage),
        });
    }
    let limit = device.physical().max_buffer_bytes();
    if size_bytes > limit {
        let what = "size in bytes of a buffer";
        return Err(Error::Limit { object: desc.name.clone(), what, wanted: size_bytes, limit });
    }
    Ok(())
}
