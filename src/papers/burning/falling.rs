//! `falling`: parts that nothing holds fall and topple as rigid bodies. Ours: the dissertation's fall apart in place.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::model::Model;
use super::parts::{MOST_PARTS, Parts, SEARCH_TICKS};
use super::ping_pong::{self, PingPong, Work, new};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};

/// Words of a part's contacts (`burning/contacts.glsl`).
const WORDS: u32 = 48;
/// Entries of a layer of the table of vertices, its layers with those of parts, bytes of what is met, and meetings of a part
/// (`burning/meeting.glsl`).
const ENTRIES: u32 = 65536;
const LAYERS: u32 = 5;
const OBSTACLE: u32 = 32;
const MEETINGS: u32 = 8;

/// Vertices of a workgroup (`burning/falling.comp`).
const GROUP: u32 = 64;

/// Of the buffers.
pub(super) const BYTES: u32 = 2 * 4 * WORDS * MOST_PARTS + 4 * LAYERS * ENTRIES + OBSTACLE * MEETINGS * MOST_PARTS;

/// The pass. Whether what lies still still stands is asked in the ticks in which a search for parts ends; in the others
/// contacts are found while a part moves alone, and no thread asks for them otherwise.
pub struct Falling {
    steps: PingPong<6>,
    /// In a tick that asks.
    asking: [Work; 6],
}

impl Falling {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        buffers: &mut Buffers,
        parts: &Parts,
        model: &Model,
    ) -> Result<Self, Error> {
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::INDIRECT_BUFFER;
        let empty = |name: &str, bytes: u32| -> Result<Arc<Buffer>, Error> {
            let desc = BufferDesc::new(format!("{label}/{name}"), u64::from(bytes));
            Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
        };
        let none = vec![0; 4 * (WORDS * MOST_PARTS) as usize];
        let contacts = upload(shaders.device(), &format!("{label}/contacts"), usage, &none)?;
        let balls = empty("balls", 4 * LAYERS * ENTRIES)?;
        let met = empty("met", OBSTACLE * MEETINGS * MOST_PARTS)?;
        let [row, ..] = shaders.device().physical().limits.max_compute_work_group_count;
        let rows = model.vertex_count().div_ceil(GROUP).div_ceil(row).max(1);
        let still = [0, rows, 1];
        let moving =
            upload(shaders.device(), &format!("{label}/moving"), usage, bytemuck::cast_slice::<u32, u8>(&still))?;
        // What stands goes on by the contacts that were found last.
        for buffer in [&moving, &contacts] {
            buffers.keep(shaders, buffer)?;
        }
        let step = |shader: &str| Pass::compute("falling", "", &format!("burning/{shader}.comp"));
        let placed = |shader: &str| {
            let step = step(shader).with("constants", &buffers.constants).with("Cells", &buffers.cells);
            step.with("Parts", &parts.parts).with("Bends", &parts.bends)
        };
        let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
        let found = |shader: &str| placed(shader).with("PartOf", &parts.part_of).with("Balls", &balls);
        let touched = |shader: &str| found(shader).with("Contacts", &contacts);
        let build = |pass, swapped: &[_]| ping_pong::build(shaders, pass, swapped);
        let clear = step("falling-clear").with("Contacts", &contacts).with("Balls", &balls);
        let meet = touched("falling-meetings").with("Met", &met).with("Moving", &moving);
        let known = placed("falling").with("Sums", &parts.sums);
        let fall = known.with("Contacts", &contacts).with("Met", &met).with("Moving", &moving);
        let vertices = Work::Elements(model.vertex_count());
        let steps = PingPong::new([
            (build(clear.indirect(&moving), &[])?, Work::Indirect),
            (build(found("falling-balls").indirect(&moving), &newest)?, Work::Indirect),
            (build(touched("falling-contacts-heights").indirect(&moving), &newest)?, Work::Indirect),
            (build(touched("falling-contacts-vertices").indirect(&moving), &newest)?, Work::Indirect),
            (build(meet.indirect(&moving), &newest)?, Work::Indirect),
            (build(fall, &newest)?, Work::Elements(MOST_PARTS)),
        ]);
        let [clear, meet] = [ENTRIES.max(WORDS * MOST_PARTS), MOST_PARTS * MEETINGS].map(Work::Elements);
        let asking = [clear, Work::Indirect, vertices, Work::Indirect, meet, Work::Elements(MOST_PARTS)];
        Ok(Falling { steps, asking })
    }

    /// Records a tick, of so many ticks since the fire was lit with this one.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: u64) -> Result<(), Error> {
        let newest = (tick % 2) as usize;
        match tick % SEARCH_TICKS {
            0 => self.steps.record_as(frame, newest, self.asking),
            _ => self.steps.record(frame, newest),
        }
    }
}
