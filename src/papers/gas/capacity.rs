//! The rows of the picture that are done at once, and the slots of their lists.

use super::blocks::{LinkBlock, SectionBlock};
use super::parameters::{Lists, Parameters};
use super::progress::StateBlock;
use super::tiles::{CHUNK_BYTES, TILE};
use crate::gpu::{Device, Error};

/// Bytes of each list's widest buffer: of a fragment, of a section, of a pixel.
const LINK_BYTES: u64 = size_of::<LinkBlock>() as u64;
const SECTION_BYTES: u64 = size_of::<SectionBlock>() as u64;
const PIXEL_BYTES: u64 = size_of::<StateBlock>() as u64;

/// The fraction of the largest memory heap that one buffer of the lists may take: there are six of them, and the
/// picture.
const HEAP_DIVISOR: u64 = 16;

/// Rows that are done at once (the paper does one), and the slots of their fragments and sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Capacity {
    /// Rows of the picture.
    pub rows: u32,
    /// Slots of fragments.
    pub fragments: u32,
    /// Slots of sections.
    pub sections: u32,
    /// Chunks of the triangles of tiles; 0 without tiles.
    pub chunks: u32,
}

/// The most bytes of a buffer of the lists.
#[derive(Debug, Clone, Copy)]
pub struct BufferLimit {
    bytes: u64,
    /// True where the user has set it, below the device's.
    is_own: bool,
}

impl BufferLimit {
    /// The limit that the device has or the user sets, the lower one.
    pub fn new(device: &Device, parameters: &Parameters) -> Self {
        let physical = device.physical();
        let heaps = &physical.memory.memory_heaps[..physical.memory.memory_heap_count as usize];
        let heap_bytes = heaps.iter().map(|heap| heap.size).max().unwrap_or(0);
        let bytes = u64::from(physical.limits.max_storage_buffer_range).min(heap_bytes / HEAP_DIVISOR);
        match parameters.list_bytes {
            Some(allowed) if allowed < bytes => BufferLimit { bytes: allowed, is_own: true },
            _ => BufferLimit { bytes, is_own: false },
        }
    }

    /// The parameter to lower where the picture is too much, perhaps with one to raise.
    pub fn parameters(self) -> &'static str {
        if self.is_own { "size`; or raise `list-bytes" } else { "size" }
    }

    /// The error of a list of which one row of pixels wants more slots.
    fn refused(self, name: &str, wanted: u32, slot_bytes: u64) -> Error {
        let object = format!("list of the {name} of a row of pixels");
        if !self.is_own {
            let (wanted, limit) = (wanted.into(), self.slots(slot_bytes).into());
            return Error::Limit { object, what: "count", wanted, limit }.set_by("size");
        }
        let (bytes, allowed) = (u64::from(wanted) * slot_bytes, self.bytes);
        let reason = format!(
            "its {wanted} entries take {bytes} bytes, and `list-bytes` allows {allowed}; raise `list-bytes` or lower `size`"
        );
        Error::Filling { object, reason }
    }

    /// Slots of that size. Node numbers have 31 bits.
    fn slots(self, slot_bytes: u64) -> u32 {
        (self.bytes / slot_bytes).min((1 << 31) - 2) as u32
    }
}

impl Capacity {
    /// Four fragments, or all that are kept, and two sections a pixel, of as many rows as the buffers hold; of tiles a
    /// chunk each, and four places a triangle.
    pub fn initial(parameters: &Parameters, triangles: usize, limit: BufferLimit) -> Self {
        let width = parameters.width.max(1);
        let of_pixel = parameters.lists.nearest().unwrap_or(4);
        let rows = [PIXEL_BYTES, u64::from(of_pixel) * LINK_BYTES, 2 * SECTION_BYTES]
            .into_iter()
            .map(|bytes| limit.slots(bytes))
            .fold(parameters.height, |rows, pixels| rows.min(pixels / width))
            .max(1);
        let pixels = rows.saturating_mul(width);
        let tiles = u64::from(width.div_ceil(TILE)) * u64::from(rows.div_ceil(TILE));
        let chunks = (tiles + triangles as u64 / 8).min(limit.slots(CHUNK_BYTES).into()) as u32;
        Capacity {
            rows,
            fragments: pixels.saturating_mul(of_pixel).min(limit.slots(LINK_BYTES)),
            sections: pixels.saturating_mul(2).min(limit.slots(SECTION_BYTES)),
            chunks: if parameters.lists == Lists::Linked { 0 } else { chunks },
        }
    }

    /// The capacity for what the fullest band wanted; nothing where it was enough. An eighth more where it lacked,
    /// since the frames to come may want a little more; fewer rows where no buffer holds so much.
    ///
    /// # Errors
    /// [`Error::Limit`] of the device, or [`Error::Filling`] of what the user allows, for a row of the picture that wants more
    /// than a buffer holds.
    pub fn grown(self, demand: Capacity, limit: BufferLimit) -> Result<Option<Self>, Error> {
        let mut grown = self;
        for (name, slots, wanted, slot_bytes) in [
            ("fragments", &mut grown.fragments, demand.fragments, LINK_BYTES),
            ("sections", &mut grown.sections, demand.sections, SECTION_BYTES),
            ("triangles of tiles", &mut grown.chunks, demand.chunks, CHUNK_BYTES),
        ] {
            if wanted <= *slots {
                continue;
            }
            let most = limit.slots(slot_bytes);
            if wanted > most {
                if self.rows == 1 {
                    return Err(limit.refused(name, wanted, slot_bytes));
                }
                // Rows differ: not quite as many as would fit if they were all alike.
                let fraction = f64::from(most) / f64::from(wanted);
                grown.rows = grown.rows.min((f64::from(self.rows) * fraction * 0.75) as u32).max(1);
            }
            *slots = wanted.saturating_add(wanted / 8).min(most);
        }
        Ok(Some(grown).filter(|grown| *grown != self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(width: u32, height: u32) -> Parameters {
        Parameters { width, height, ..Parameters::default() }
    }

    const LAVAPIPE: BufferLimit = BufferLimit { bytes: 128 << 20, is_own: false };

    #[test]
    fn a_large_picture_is_done_in_bands_whose_lists_fit() {
        for (width, height) in [(1, 1), (1024, 768), (4096, 4096), (16384, 16384), (16384, 1)] {
            let capacity = Capacity::initial(&parameters(width, height), 12, LAVAPIPE);
            assert!(u64::from(capacity.fragments) * LINK_BYTES <= LAVAPIPE.bytes);
            assert!(u64::from(capacity.sections) * SECTION_BYTES <= LAVAPIPE.bytes);
            assert!(u64::from(capacity.rows * width) * PIXEL_BYTES <= LAVAPIPE.bytes);
            assert_eq!(capacity.fragments, 4 * capacity.rows * width);
        }
        assert_eq!(Capacity::initial(&parameters(1024, 768), 12, LAVAPIPE).rows, 768);
        assert_eq!(Capacity::initial(&parameters(4096, 4096), 12, LAVAPIPE).rows, 512);
    }

    /// Lists grow as far as a buffer goes, then the bands shrink, down to one row and no further.
    #[test]
    fn lists_grow_and_bands_shrink() {
        let limit = BufferLimit { bytes: 16_000, is_own: false };
        let capacity = Capacity { rows: 40, fragments: 100, sections: 50, chunks: 0 };
        assert_eq!(capacity.grown(capacity, limit).unwrap(), None);
        let demand = Capacity { fragments: 160, ..capacity };
        assert_eq!(capacity.grown(demand, limit).unwrap(), Some(Capacity { fragments: 180, ..capacity }));
        let demand = Capacity { fragments: 990, ..capacity };
        assert_eq!(capacity.grown(demand, limit).unwrap(), Some(Capacity { fragments: 1000, ..capacity }));
        let demand = Capacity { fragments: 3000, sections: 5000, ..capacity };
        let shrunk = Capacity { rows: 3, fragments: 1000, sections: 500, chunks: 0 };
        assert_eq!(capacity.grown(demand, limit).unwrap(), Some(shrunk));
        let row = Capacity { rows: 1, ..capacity };
        let error = row.grown(demand, limit).unwrap_err().to_string();
        assert!(error.contains("fragments") && error.contains("`size`") && error.contains("3000"), "{error}");
        assert!(error.contains("device's limit of 1000") && !error.contains("list-bytes"), "{error}");
    }

    /// A device that would hold more is not blamed for what the user allows.
    #[test]
    fn the_users_own_limit_is_told_as_theirs() {
        let limit = BufferLimit { bytes: 16_000, is_own: true };
        let row = Capacity { rows: 1, fragments: 100, sections: 50, chunks: 0 };
        let error = row.grown(Capacity { fragments: 3000, ..row }, limit).unwrap_err().to_string();
        let expected = "filling list of the fragments of a row of pixels: its 3000 entries take 48000 bytes, and `list-bytes` \
                        allows 16000; raise `list-bytes` or lower `size`";
        assert_eq!(error, expected);
    }
}
