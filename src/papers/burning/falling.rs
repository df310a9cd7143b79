//! `falling`: parts that nothing holds fall and topple as rigid bodies. Ours: the dissertation's fall apart in place.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::model::Model;
use super::parts::{MOST_PARTS, Parts};
use super::ping_pong::{self, PingPong, Work, new};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, Pass, ShaderLibrary};

/// Words of a part's contacts (`burning/contacts.glsl`).
const WORDS: u32 = 48;
/// Entries of a layer of the table of vertices, its layers, bytes of what is met, and meetings of a part
/// (`burning/meeting.glsl`).
const ENTRIES: u32 = 65536;
const LAYERS: u32 = 3;
const OBSTACLE: u32 = 32;
const MEETINGS: u32 = 8;

/// Vertices of a workgroup (`burning/falling.comp`).
const GROUP: u32 = 64;

/// Of the buffers.
pub(super) const BYTES: u32 = 4 * WORDS * MOST_PARTS + 4 * LAYERS * ENTRIES + OBSTACLE * MEETINGS * MOST_PARTS;

/// Makes the pass. Where parts meet is looked for while one of them moves alone.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn falling(
    shaders: &ShaderLibrary,
    label: &str,
    buffers: &mut Buffers,
    parts: &Parts,
    model: &Model,
) -> Result<PingPong<6>, Error> {
    let empty = |name: &str, bytes: u32| -> Result<Arc<Buffer>, Error> {
        let desc = BufferDesc::new(format!("{label}/{name}"), u64::from(bytes));
        Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
    };
    let contacts = empty("contacts", 4 * WORDS * MOST_PARTS)?;
    let balls = empty("balls", 4 * LAYERS * ENTRIES)?;
    let met = empty("met", OBSTACLE * MEETINGS * MOST_PARTS)?;
    let usage = vk::BufferUsageFlags::STORAGE_BUFFER | vk::BufferUsageFlags::INDIRECT_BUFFER;
    let [row, ..] = shaders.device().physical().limits.max_compute_work_group_count;
    let rows = model.vertex_count().div_ceil(GROUP).div_ceil(row).max(1);
    let still = [0, rows, 1];
    let moving = upload(shaders.device(), &format!("{label}/moving"), usage, bytemuck::cast_slice::<u32, u8>(&still))?;
    buffers.keep(shaders, &moving)?;
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
    let known = placed("falling").with("Searching", &parts.progress).with("Sums", &parts.sums);
    let fall = known.with("Contacts", &contacts).with("Met", &met).with("Moving", &moving);
    Ok(PingPong::new([
        (build(clear, &[])?, Work::Elements(ENTRIES.max(WORDS * MOST_PARTS))),
        (build(found("falling-balls").indirect(&moving), &newest)?, Work::Indirect),
        (build(touched("falling-contacts-heights"), &newest)?, Work::Elements(model.vertex_count())),
        (build(touched("falling-contacts-vertices").indirect(&moving), &newest)?, Work::Indirect),
        (build(meet, &newest)?, Work::Elements(MOST_PARTS * MEETINGS)),
        (build(fall, &newest)?, Work::Elements(MOST_PARTS)),
    ]))
}
