//! `falling`: parts that nothing holds fall and topple as rigid bodies. Ours: the dissertation's fall apart in place.

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::model::Model;
use super::parts::{MOST_PARTS, Parts};
use super::ping_pong::{PingPong, build, new};
use crate::gpu::{Buffer, BufferDesc, Error, Pass, ShaderLibrary};

/// Words of a part's contacts (`burning/contacts.glsl`).
const WORDS: u32 = 48;
/// Entries of the table of vertices that lie still, and meetings of a part (`burning/meeting.glsl`).
const ENTRIES: u32 = 65536;
const MEETINGS: u32 = 8;

/// Of the buffers.
pub(super) const BYTES: u32 = 4 * WORDS * MOST_PARTS + 4 * ENTRIES + 16 * MEETINGS * MOST_PARTS;

/// Makes the pass.
///
/// # Errors
/// Those of the Vulkan layer.
pub fn falling(
    shaders: &ShaderLibrary,
    label: &str,
    buffers: &Buffers,
    parts: &Parts,
    model: &Model,
) -> Result<PingPong<6>, Error> {
    let empty = |name: &str, bytes: u32| -> Result<Arc<Buffer>, Error> {
        let desc = BufferDesc::new(format!("{label}/{name}"), u64::from(bytes));
        Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
    };
    let contacts = empty("contacts", 4 * WORDS * MOST_PARTS)?;
    let lying = empty("lying", 4 * ENTRIES)?;
    let met = empty("met", 16 * MEETINGS * MOST_PARTS)?;
    let step = |shader: &str| Pass::compute("falling", "", &format!("burning/{shader}.comp"));
    let placed = |shader: &str| {
        step(shader).with("constants", &buffers.constants).with("Cells", &buffers.cells).with("Parts", &parts.parts)
    };
    let newest = [new("NewState", &buffers.states), new("NewRotations", &buffers.rotations)];
    let found = |shader: &str| placed(shader).with("PartOf", &parts.part_of).with("Lying", &lying);
    let touched = |shader: &str| build(shaders, found(shader).with("Contacts", &contacts), &newest);
    let clear = step("falling-clear").with("Contacts", &contacts).with("Lying", &lying);
    let meet = found("falling-meetings").with("Contacts", &contacts).with("Met", &met);
    let known = placed("falling").with("Searching", &parts.progress).with("Sums", &parts.sums);
    let fall = known.with("Contacts", &contacts).with("Met", &met);
    Ok(PingPong::new([
        (build(shaders, clear, &[])?, ENTRIES.max(WORDS * MOST_PARTS)),
        (build(shaders, found("falling-lying"), &newest)?, model.vertex_count()),
        (touched("falling-contacts-heights")?, model.vertex_count()),
        (touched("falling-contacts-vertices")?, model.vertex_count()),
        (build(shaders, meet, &newest)?, MOST_PARTS * MEETINGS),
        (build(shaders, fall, &newest)?, MOST_PARTS),
    ]))
}
