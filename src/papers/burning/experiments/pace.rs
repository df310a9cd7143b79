//! A fire whose rate follows the frame rate (3.7.2): where frames take longer than they should, each is due a smaller share
//! of a tick. The state then depends on the clock on the wall, so that the record has every frame's share, and nothing
//! else is measured this way.

use std::sync::atomic::Ordering;
use std::time::Instant;

use serde_json::json;

use super::super::setup::Setup;
use super::timeline::at_rest;
use crate::gpu::Mode;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::result_table::ResultTable;
use crate::measure::{Error, Paper as _};
use crate::papers::burning::Variant;

/// Parts of a tick that shares are counted in.
const WHOLE: u32 = 64;
/// Weight of the shares before in the next one, beside one of what the last frame asks for.
const INERTIA: u32 = 3;

/// The share of a tick that the next frame is due, after one of `share` that took `frame_s`.
fn next_share(share: u32, frame_s: f64, wanted_s: f64) -> u32 {
    let asked = (f64::from(WHOLE) * wanted_s / frame_s.max(f64::MIN_POSITIVE)).round() as u32;
    let asked = asked.clamp(1, WHOLE);
    // Rounded towards what is asked for, or it would never be reached.
    let up = if asked > share { INERTIA } else { 0 };
    (INERTIA * share + asked + up) / (INERTIA + 1)
}

/// Burns `frames` frames of a shell from ignition, which are to come `frame_rate` times a second.
///
/// # Errors
/// [`Error::Interrupted`]; those of loading and of the Vulkan layer.
pub fn table(
    machine: &mut Machine,
    setup: &Setup,
    frame_rate: f64,
    frames: u32,
    watch: &mut Watch<'_>,
) -> Result<ResultTable, Error> {
    let mut paper = at_rest(machine, setup, Variant::Shell)?;
    let (mut share, mut due, mut shown) = (WHOLE, 0, None);
    let mut rows = Vec::new();
    for frame in 0..frames {
        if watch.interrupted.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        due += u64::from(share);
        let last = u32::try_from(due / u64::from(WHOLE)).unwrap_or(u32::MAX).saturating_sub(1);
        if shown == Some(last) {
            paper.repeat();
        }
        shown = Some(last);
        let start = Instant::now();
        machine.recorder.run(Mode::Plain, |frame| paper.record(frame, last))?;
        let frame_s = start.elapsed().as_secs_f64();
        rows.push(vec![json!(frame), json!(1e3 * frame_s), json!(share), json!(paper.ticks())]);
        share = next_share(share, frame_s, 1.0 / frame_rate);
        (watch.progress)(u64::from(frame) + 1, u64::from(frames));
    }
    Ok(ResultTable {
        title: "Section 3.7.2: the fire's rate by the frame rate",
        columns: &["frame", "ms", "share of a tick, 64ths", "ticks"],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_what_frames_take_and_come_back() {
        let settled = |from: u32, frame_s: f64| (0..40).fold(from, |share, _| next_share(share, frame_s, 0.02));
        assert_eq!(settled(WHOLE, 0.02), WHOLE);
        assert_eq!(settled(WHOLE, 0.04), WHOLE / 2);
        assert_eq!(settled(WHOLE, 1e3), 1);
        assert_eq!(settled(1, 0.01), WHOLE);
        assert_eq!(settled(1, 0.08), WHOLE / 4);
    }
}
