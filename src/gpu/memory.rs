//! Memory of buffers and images.

use std::sync::Arc;

use ash::vk;
use gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme, Allocator};
use gpu_allocator::{AllocationSizes, MemoryLocation};

use super::buffer::Location;
use super::device::Device;
use super::error::Error;
use super::live::Kind;

/// Allocates memory for a buffer (`linear`) or an image.
///
/// # Errors
/// [`Error::Limit`] for more than the heap holds, or than the device allocates at once; [`Error::OutOfMemory`].
pub(super) fn allocate(
    device: &Arc<Device>,
    name: &str,
    requirements: vk::MemoryRequirements,
    location: Location,
    linear: bool,
) -> Result<Allocation, Error> {
    let out_of_memory = || Error::OutOfMemory { object: name.to_owned(), bytes: requirements.size };
    let memory = &device.physical().memory;
    let all: u64 = memory.memory_heaps[..memory.memory_heap_count as usize].iter().map(|heap| heap.size).sum();
    // Some drivers promise more than there is, and fail where it is written to.
    let total = device.live().total_bytes().saturating_add(requirements.size);
    let checks = [
        ("size in bytes", requirements.size, heap_bytes(memory, requirements.memory_type_bits, location)),
        ("size in bytes, together with all that is allocated already,", total, all),
    ];
    if let Some((what, wanted, limit)) = checks.into_iter().find(|(_, wanted, limit)| wanted > limit) {
        return Err(Error::Limit { object: name.to_owned(), what, wanted, limit });
    }
    let mut allocator = device.allocator();
    check_blocks(device, name, &allocator)?;
    allocator
        .allocate(&AllocationCreateDesc {
            name,
            requirements,
            location: match location {
                Location::Device => MemoryLocation::GpuOnly,
                Location::Upload => MemoryLocation::CpuToGpu,
                Location::Readback => MemoryLocation::GpuToCpu,
            },
            linear,
            allocation_scheme: AllocationScheme::GpuAllocatorManaged,
        })
        .map_err(|error| match error {
            gpu_allocator::AllocationError::OutOfMemory => out_of_memory(),
            other => Error::Allocation { object: name.to_owned(), reason: other.to_string() },
        })
}

/// Bytes of the blocks that the allocator asks for, of the device's own memory and of memory that the host sees: none is
/// larger than the smallest heap that it may come from.
fn block_bytes(memory: &vk::PhysicalDeviceMemoryProperties) -> [u64; 2] {
    /// Multiples of this are all that the allocator takes, from one on.
    const STEP: u64 = 4 << 20;
    let host_visible = vk::MemoryPropertyFlags::HOST_VISIBLE;
    [(false, 256 << 20), (true, 64 << 20)].map(|(is_host, most)| {
        let types = memory.memory_types[..memory.memory_type_count as usize].iter();
        let ours = types.filter(|one| one.property_flags.contains(host_visible) == is_host);
        let smallest = ours.map(|one| memory.memory_heaps[one.heap_index as usize].size).min().unwrap_or(most);
        (smallest.min(most) / STEP).max(1) * STEP
    })
}

/// The sizes of the allocator's blocks on a device of this memory.
pub(super) fn block_sizes(memory: &vk::PhysicalDeviceMemoryProperties) -> AllocationSizes {
    let [device, host] = block_bytes(memory);
    AllocationSizes::new(device, host)
}

/// Bytes of the heap behind the first memory type that suits, which is the one that the allocator falls back on.
fn heap_bytes(memory: &vk::PhysicalDeviceMemoryProperties, type_bits: u32, location: Location) -> u64 {
    use vk::MemoryPropertyFlags as P;
    let needed = match location {
        Location::Device => P::DEVICE_LOCAL,
        Location::Upload | Location::Readback => P::HOST_VISIBLE | P::HOST_COHERENT,
    };
    let types = memory.memory_types[..memory.memory_type_count as usize].iter().enumerate();
    let mut fitting = types.filter(|(i, one)| type_bits & (1 << i) != 0 && one.property_flags.contains(needed));
    // Without any, the allocator says so.
    fitting.next().map_or(u64::MAX, |(_, one)| memory.memory_heaps[one.heap_index as usize].size)
}

/// The allocator may want one more block of memory, of which a device has so many at most.
fn check_blocks(device: &Device, name: &str, allocator: &Allocator) -> Result<(), Error> {
    let limit = device.physical().limits.max_memory_allocation_count;
    let resources = device.live().count(Kind::Buffer) + device.live().count(Kind::Image);
    // A block without a resource is kept for each type of memory. Counting the blocks takes long where there are many.
    if resources + vk::MAX_MEMORY_TYPES < limit as usize {
        return Ok(());
    }
    let wanted = allocator.generate_report().blocks.len() as u64 + 1;
    if wanted <= limit.into() {
        return Ok(());
    }
    Err(Error::Limit { object: name.to_owned(), what: "count of blocks of memory", wanted, limit: limit.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_allocated_fits_the_heap_that_it_goes_to() {
        use vk::MemoryPropertyFlags as P;
        let mut memory = vk::PhysicalDeviceMemoryProperties { memory_type_count: 4, ..Default::default() };
        let types = [
            (P::DEVICE_LOCAL, 0),
            (P::HOST_VISIBLE | P::HOST_COHERENT, 1),
            (P::HOST_VISIBLE | P::HOST_COHERENT | P::HOST_CACHED, 1),
            (P::DEVICE_LOCAL | P::HOST_VISIBLE | P::HOST_COHERENT, 2),
        ];
        for (place, (property_flags, heap_index)) in memory.memory_types.iter_mut().zip(types) {
            *place = vk::MemoryType { property_flags, heap_index };
        }
        for (heap, size) in memory.memory_heaps.iter_mut().zip([800, 300, 20]) {
            heap.size = size;
        }
        assert_eq!(heap_bytes(&memory, 0b1111, Location::Device), 800);
        assert_eq!(heap_bytes(&memory, 0b1110, Location::Device), 20);
        assert_eq!(heap_bytes(&memory, 0b1111, Location::Upload), 300);
        assert_eq!(heap_bytes(&memory, 0b1001, Location::Upload), 20);
        assert_eq!(heap_bytes(&memory, 0b1111, Location::Readback), 300);
        assert_eq!(heap_bytes(&memory, 0b0001, Location::Readback), u64::MAX);
    }

    #[test]
    fn blocks_are_no_larger_than_the_heaps_that_they_come_from() {
        use vk::MemoryPropertyFlags as P;
        let mut memory = vk::PhysicalDeviceMemoryProperties { memory_type_count: 3, ..Default::default() };
        let types = [(P::DEVICE_LOCAL, 0), (P::HOST_VISIBLE, 1), (P::DEVICE_LOCAL | P::HOST_VISIBLE, 2)];
        for (place, (property_flags, heap_index)) in memory.memory_types.iter_mut().zip(types) {
            *place = vk::MemoryType { property_flags, heap_index };
        }
        let mut of_heaps = |sizes_mib: [u64; 3]| {
            for (heap, size) in memory.memory_heaps.iter_mut().zip(sizes_mib) {
                heap.size = size << 20;
            }
            block_bytes(&memory).map(|bytes| bytes >> 20)
        };
        assert_eq!(of_heaps([8192, 16384, 256]), [256, 64]);
        assert_eq!(of_heaps([130, 16384, 33]), [128, 32]);
        assert_eq!(of_heaps([8192, 9, 256]), [256, 8]);
        // Of a device with one heap, all of which the host sees.
        memory.memory_type_count = 1;
        memory.memory_types[0].property_flags |= P::HOST_VISIBLE;
        assert_eq!(block_bytes(&memory), [256 << 20, 64 << 20]);
    }
}
