//! Sizes of a configuration, known before anything of it is allocated.

use super::error::Error;
use crate::gpu::physical::DeviceType;
use crate::gpu::{self, Device};

/// Most passes of one frame, each with its queries: command buffers of more take gigabytes. It is no limit of a device.
const MOST_PASSES: u64 = 1 << 16;

/// Most draws and dispatches of one frame, for the same reason.
const MOST_DRAWS: u64 = 1 << 20;

/// Invocations of fragment and compute shaders that a CPU finishes in a second, and any other device, roughly.
const PER_SECOND: (f64, f64) = (1e8, 2e10);

/// Time of a submission, by that rate: short for who waits for a frame of hours to be given up.
const SUBMISSION_S: f64 = 1.0;

/// Bytes on the device of a triangle that is drawn, at least: three indices, and half a vertex of position and normal.
pub const DRAWN_BYTES: f64 = 24.0;

/// Memory, passes and shader invocations of a frame, each by the parameter that sets it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Bytes on the device.
    pub bytes: Vec<(&'static str, f64)>,
    /// Bytes of storage buffers that are not cut into pieces.
    pub buffers: Vec<(&'static str, f64)>,
    /// Passes of one frame, with the parameter that they follow.
    pub passes: Option<(&'static str, u64)>,
    /// Draws and dispatches inside the passes, where they are many more, with the parameter that they follow.
    pub draws: Option<(&'static str, u64)>,
    /// Invocations of fragment and compute shaders in one frame and before it.
    pub invocations: Vec<(&'static str, f64)>,
}

impl Estimate {
    /// Several configurations at once: bytes add up, their frames come one after the other.
    pub fn all(estimates: impl IntoIterator<Item = Estimate>) -> Self {
        let bytes = estimates.into_iter().flat_map(|estimate| estimate.bytes).collect();
        Estimate { bytes, ..Estimate::default() }
    }

    /// Passes for a configuration that the device can hold.
    ///
    /// # Errors
    /// [`gpu::Error::Limit`] for more bytes than its largest heap has and a longer buffer than it binds; [`Error::Input`] for more
    /// passes or draws than this program records for a frame.
    pub fn check(&self, device: &Device, label: &str) -> Result<(), Error> {
        let memory = &device.physical().memory;
        let heaps = &memory.memory_heaps[..memory.memory_heap_count as usize];
        let limit = heaps.iter().map(|heap| heap.size).max().unwrap_or(0);
        let refused = |what, wanted, limit, parameter: &str| {
            let error = gpu::Error::Limit { object: label.to_owned(), what, wanted, limit };
            Err(error.set_by(parameter).into())
        };
        let total: f64 = self.bytes.iter().map(|(_, bytes)| bytes).sum();
        if let Some((parameter, _)) = largest(&self.bytes).filter(|_| total > limit as f64) {
            return refused("size in bytes of all buffers and images", total as u64, limit, parameter);
        }
        let longest = u64::from(device.physical().limits.max_storage_buffer_range);
        if let Some((parameter, bytes)) = largest(&self.buffers).filter(|(_, bytes)| *bytes > longest as f64) {
            return refused("size in bytes of a storage buffer", bytes as u64, longest, parameter);
        }
        let recorded = [("passes", self.passes, MOST_PASSES), ("draws and dispatches", self.draws, MOST_DRAWS)];
        for (what, found, most) in recorded {
            if let Some((parameter, wanted)) = found.filter(|(_, wanted)| *wanted > most) {
                let reason =
                    format!("{wanted} {what} in a frame are more than the {most} that this program records for one");
                return Err(Error::Input(format!("{label} (`{parameter}`): {reason}; lower it")));
            }
        }
        Ok(())
    }

    /// A line for whoever waits, where a frame takes long on the device.
    pub fn patience(&self, device: &Device) -> Option<String> {
        /// Seconds.
        const LONG: f64 = 10.0;
        let per_second = per_second(device);
        let total: f64 = self.invocations.iter().map(|(_, count)| count).sum();
        let (parameter, _) = largest(&self.invocations).filter(|_| total > LONG * per_second)?;
        Some(format!(
            "note: the first frame runs some {:.0e} shader invocations and may take {:.0} s here; lower `{parameter}` for less",
            total,
            total / per_second
        ))
    }
}

/// Invocations of shaders, or turns of their loops, that a device finishes in a second, roughly.
fn per_second(device: &Device) -> f64 {
    let is_cpu = device.physical().device_type == DeviceType::Cpu;
    if is_cpu { PER_SECOND.0 } else { PER_SECOND.1 }
}

/// Work of one submission on a device, by that rough rate.
pub fn submission_work(device: &Device) -> f64 {
    SUBMISSION_S * per_second(device)
}

fn largest(items: &[(&'static str, f64)]) -> Option<(&'static str, f64)> {
    items.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))
}
