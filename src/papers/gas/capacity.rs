//! How much of the picture is done at once, and the room of its lists.

use super::blocks::{LinkBlock, PixelBlock, SectionBlock};
use super::parameters::Parameters;
use crate::gpu::{Device, Error};
use crate::host_block;

/// Bytes of each list's widest buffer: of a fragment, of a section, of a pixel.
const LINK_BYTES: u64 = size_of::<LinkBlock>() as u64;
const SECTION_BYTES: u64 = size_of::<SectionBlock>() as u64;
const PIXEL_BYTES: u64 = size_of::<PixelBlock>() as u64;

/// Rows of a dispatch: a slow variant's picture is made of many short dispatches, which no watchdog ends.
const DISPATCH_ROWS: u32 = 32;

/// The share of the largest memory heap that one buffer of the lists may take: there are six of them, and the picture.
const HEAP_SHARE: u64 = 16;

host_block! {
    /// Rows of the picture: those whose lists are held, or a part of them.
    pub struct Band {
        list_row: u32,
        pub first_row: u32,
        pub end_row: u32,
    }
}

impl Band {
    /// All bands of a picture of that height.
    pub fn all(height: u32, rows: u32) -> impl Iterator<Item = Band> {
        let band = move |first_row: u32| {
            let end_row = height.min(first_row.saturating_add(rows));
            Band { list_row: first_row, first_row, end_row }
        };
        (0..height).step_by(rows.max(1) as usize).map(band)
    }

    pub fn rows(self) -> u32 {
        self.end_row - self.first_row
    }

    /// The band in dispatches that take a short time each.
    pub fn parts(self) -> impl Iterator<Item = Band> {
        let part = move |first_row: u32| {
            let end_row = self.end_row.min(first_row.saturating_add(DISPATCH_ROWS));
            Band { first_row, end_row, ..self }
        };
        (self.first_row..self.end_row).step_by(DISPATCH_ROWS as usize).map(part)
    }
}

/// Rows that are done at once (the paper does one), and the slots of their fragments and sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Capacity {
    pub rows: u32,
    pub fragments: u32,
    pub sections: u32,
}

/// Most slots of each kind that a buffer holds.
#[derive(Debug, Clone, Copy)]
pub struct Most {
    bytes: u64,
    /// What a user changes where one row is too much: the option to lower, perhaps one to raise.
    option: &'static str,
}

impl Most {
    /// What the device binds and holds, or what the user allows.
    pub fn of(device: &Device, parameters: &Parameters) -> Self {
        let physical = device.physical();
        let heaps = &physical.memory.memory_heaps[..physical.memory.memory_heap_count as usize];
        let heap_bytes = heaps.iter().map(|heap| heap.size).max().unwrap_or(0);
        let bytes = u64::from(physical.limits.max_storage_buffer_range).min(heap_bytes / HEAP_SHARE);
        match parameters.list_bytes {
            Some(allowed) if allowed < bytes => Most { bytes: allowed, option: "--size; or raise --list-bytes" },
            _ => Most { bytes, option: "--size" },
        }
    }

    /// Node numbers have 31 bits.
    fn slots(self, slot_bytes: u64) -> u32 {
        (self.bytes / slot_bytes).min((1 << 31) - 2) as u32
    }
}

impl Capacity {
    /// Four fragments and two sections a pixel, of as many rows as there is room for.
    pub fn usual(parameters: &Parameters, most: Most) -> Self {
        let width = parameters.width.max(1);
        let rows = [most.slots(PIXEL_BYTES), most.slots(4 * LINK_BYTES), most.slots(2 * SECTION_BYTES)]
            .into_iter()
            .fold(parameters.height, |rows, pixels| rows.min(pixels / width))
            .max(1);
        let pixels = rows.saturating_mul(width);
        Capacity {
            rows,
            fragments: pixels.saturating_mul(4).min(most.slots(LINK_BYTES)),
            sections: pixels.saturating_mul(2).min(most.slots(SECTION_BYTES)),
        }
    }

    /// Room for what the fullest band wanted; nothing where there was room. An eighth more where it lacked, since the frames to
    /// come may want a little more; fewer rows where no buffer holds so much.
    ///
    /// # Errors
    /// [`Error::Limit`] where one row of the picture wants more than a buffer holds.
    pub fn grown(self, demand: Capacity, most: Most) -> Result<Option<Self>, Error> {
        let fragments = Slots { what: "fragments", has: self.fragments, wants: demand.fragments };
        let sections = Slots { what: "sections", has: self.sections, wants: demand.sections };
        if fragments.is_enough() && sections.is_enough() {
            return Ok(None);
        }
        let limits = [most.slots(LINK_BYTES), most.slots(SECTION_BYTES)];
        let mut rows = self.rows;
        for (slots, limit) in [fragments, sections].into_iter().zip(limits) {
            if slots.wants > limit {
                if self.rows == 1 {
                    let object = format!("list of the {} of a row of pixels", slots.what);
                    let (wanted, limit) = (slots.wants.into(), limit.into());
                    return Err(Error::Limit { object, what: "count", wanted, limit }.set_by(most.option));
                }
                // Rows differ: not quite as many as would fit if they were all alike.
                let share = f64::from(limit) / f64::from(slots.wants);
                rows = rows.min((f64::from(self.rows) * share * 0.75) as u32).max(1);
            }
        }
        Ok(Some(Capacity { rows, fragments: fragments.grown(limits[0]), sections: sections.grown(limits[1]) }))
    }
}

/// Slots of one kind.
#[derive(Clone, Copy)]
struct Slots {
    what: &'static str,
    has: u32,
    wants: u32,
}

impl Slots {
    fn is_enough(self) -> bool {
        self.wants <= self.has
    }

    fn grown(self, limit: u32) -> u32 {
        if self.is_enough() { self.has } else { self.wants.saturating_add(self.wants / 8).min(limit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(width: u32, height: u32) -> Parameters {
        Parameters { width, height, ..Parameters::default() }
    }

    const LAVAPIPE: Most = Most { bytes: 128 << 20, option: "--size" };

    #[test]
    fn a_large_picture_is_done_in_bands_whose_lists_fit() {
        for (width, height) in [(1, 1), (1024, 768), (4096, 4096), (16384, 16384), (16384, 1)] {
            let capacity = Capacity::usual(&parameters(width, height), LAVAPIPE);
            assert!(u64::from(capacity.fragments) * LINK_BYTES <= LAVAPIPE.bytes);
            assert!(u64::from(capacity.sections) * SECTION_BYTES <= LAVAPIPE.bytes);
            assert!(u64::from(capacity.rows * width) * PIXEL_BYTES <= LAVAPIPE.bytes);
            assert_eq!(capacity.fragments, 4 * capacity.rows * width);
            let bands: Vec<Band> = Band::all(height, capacity.rows).collect();
            let rows: Vec<u32> = bands.iter().flat_map(|b| b.parts()).flat_map(|p| p.first_row..p.end_row).collect();
            assert!(rows.into_iter().eq(0..height));
        }
        assert_eq!(Capacity::usual(&parameters(1024, 768), LAVAPIPE).rows, 768);
        assert_eq!(Capacity::usual(&parameters(4096, 4096), LAVAPIPE).rows, 512);
    }

    /// Lists grow as far as a buffer goes, then the bands shrink, down to one row and no further.
    #[test]
    fn lists_grow_and_bands_shrink() {
        let most = Most { bytes: 16_000, option: "--list-bytes" };
        let capacity = Capacity { rows: 40, fragments: 100, sections: 50 };
        assert_eq!(capacity.grown(capacity, most).unwrap(), None);
        let demand = Capacity { fragments: 160, ..capacity };
        assert_eq!(capacity.grown(demand, most).unwrap(), Some(Capacity { fragments: 180, ..capacity }));
        let demand = Capacity { fragments: 990, ..capacity };
        assert_eq!(capacity.grown(demand, most).unwrap(), Some(Capacity { fragments: 1000, ..capacity }));
        let demand = Capacity { fragments: 3000, sections: 5000, ..capacity };
        assert_eq!(capacity.grown(demand, most).unwrap(), Some(Capacity { rows: 3, fragments: 1000, sections: 500 }));
        let row = Capacity { rows: 1, ..capacity };
        let error = row.grown(demand, most).unwrap_err().to_string();
        assert!(error.contains("fragments") && error.contains("--list-bytes") && error.contains("3000"), "{error}");
    }
}
