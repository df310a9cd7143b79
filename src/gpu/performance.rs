//! The device's own counters, read around one pass of a frame (`VK_KHR_performance_query`).
//!
//! A query that counts a whole command buffer begins with its first command and ends with its last. The profiled pass
//! therefore is a submission of its own, whatever the scopes of the counters are: what they count is the pass with its
//! barriers, and nothing else. Where the device cannot count everything at once, the frame is replayed.

use std::mem;
use std::sync::Arc;

use ash::{khr, vk};

use super::device::Device;
use super::error::{Context, Error};
use super::extensions::Extension;
use super::frame::Frame;
use super::instance::Instance;
use super::live::Kind;
use super::messages::text;
use super::profiling_lock::ProfilingLock;
use super::recorder::Recorder;
use super::sample::Mode;

/// Replays of a frame that are made for the counters; those that take more are left out.
const MOST_REPLAYS: u32 = 64;
/// Recordings of a pass in a frame that get a query each.
const MOST_QUERIES: u32 = 4096;

/// One of the device's counters.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PerformanceCounter {
    /// The driver's name for it.
    pub name: String,
    /// The driver's group of counters.
    pub category: String,
    /// The driver's words on it.
    pub description: String,
    unit: vk::PerformanceCounterUnitKHR,
    scope: vk::PerformanceCounterScopeKHR,
    storage: vk::PerformanceCounterStorageKHR,
}

impl PerformanceCounter {
    /// Unit of the values; `"1"` of plain numbers.
    pub fn unit(&self) -> &'static str {
        use vk::PerformanceCounterUnitKHR as Unit;
        match self.unit {
            Unit::GENERIC => "1",
            Unit::PERCENTAGE => "%",
            Unit::NANOSECONDS => "ns",
            Unit::BYTES => "bytes",
            Unit::BYTES_PER_SECOND => "bytes/s",
            Unit::KELVIN => "K",
            Unit::WATTS => "W",
            Unit::VOLTS => "V",
            Unit::AMPS => "A",
            Unit::HERTZ => "Hz",
            Unit::CYCLES => "cycles",
            _ => "unknown",
        }
    }

    /// Smallest thing that the counter can be told to count.
    pub fn scope(&self) -> &'static str {
        use vk::PerformanceCounterScopeKHR as Scope;
        match self.scope {
            Scope::COMMAND_BUFFER => "command buffer",
            Scope::RENDER_PASS => "render pass",
            Scope::COMMAND => "command",
            _ => "unknown",
        }
    }

    /// True of amounts, which add up over the recordings of a pass; rates, shares and temperatures are averaged.
    pub fn is_amount(&self) -> bool {
        use vk::PerformanceCounterUnitKHR as Unit;
        matches!(self.unit, Unit::GENERIC | Unit::NANOSECONDS | Unit::BYTES | Unit::CYCLES)
    }

    fn value(&self, result: vk::PerformanceCounterResultKHR) -> Option<CounterValue> {
        use vk::PerformanceCounterStorageKHR as Storage;
        // SAFETY: every member is a plain number, and all eight bytes of the union were zeroed before the driver wrote.
        unsafe {
            Some(match self.storage {
                Storage::INT32 => CounterValue::Integer(i128::from(result.int32)),
                Storage::INT64 => CounterValue::Integer(i128::from(result.int64)),
                Storage::UINT32 => CounterValue::Integer(i128::from(result.uint32)),
                Storage::UINT64 => CounterValue::Integer(i128::from(result.uint64)),
                Storage::FLOAT32 => CounterValue::Float(f64::from(result.float32)),
                Storage::FLOAT64 => CounterValue::Float(result.float64),
                _ => return None,
            })
        }
    }
}

/// Value of a counter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CounterValue {
    /// Of a counter that counts in integers.
    Integer(i128),
    /// Of another, and of averages.
    Float(f64),
}

impl CounterValue {
    fn as_f64(self) -> f64 {
        match self {
            CounterValue::Integer(value) => value as f64,
            CounterValue::Float(value) => value,
        }
    }
}

/// A device's own counters of a pass in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct PerformanceReadings {
    /// Times that the frame was replayed.
    pub replays: u32,
    /// Times that the frame records the pass.
    pub recordings: u32,
    /// Counters with their sum, or mean, over the recordings; `None` of a value whose type is not known.
    pub values: Vec<(PerformanceCounter, Option<CounterValue>)>,
    /// Names of the counters that would have taken more replays.
    pub left_out: Vec<String>,
}

/// The counters of the queue family that is used, `None` for a device without the extension.
pub(super) fn counters(
    instance: &Instance,
    raw: vk::PhysicalDevice,
    extensions: &[Extension],
    queue: Option<(u32, u32)>,
) -> Result<Option<Vec<PerformanceCounter>>, Error> {
    let (true, Some((family, _))) = (extensions.contains(&Extension::PerformanceQuery), queue) else {
        return Ok(None);
    };
    let calls = khr::performance_query::Instance::new(&instance.entry, &instance.raw);
    let listing = "listing the performance counters of";
    // SAFETY: `raw` comes from this instance and offers the extension; the family is one of its own.
    let count = unsafe { calls.enumerate_physical_device_queue_family_performance_query_counters_len(raw, family) }
        .before_a_device(listing, "a device")?;
    let mut counters = vec![vk::PerformanceCounterKHR::default(); count];
    let mut descriptions = vec![vk::PerformanceCounterDescriptionKHR::default(); count];
    if count > 0 {
        // SAFETY: as above, with room for as many as there are.
        unsafe {
            calls.enumerate_physical_device_queue_family_performance_query_counters(
                raw,
                family,
                &mut counters,
                &mut descriptions,
            )
        }
        .before_a_device(listing, "a device")?;
    }
    let described = counters.iter().zip(&descriptions).map(|(counter, words)| PerformanceCounter {
        name: text(&words.name),
        category: text(&words.category),
        description: text(&words.description),
        unit: counter.unit,
        scope: counter.scope,
        storage: counter.storage,
    });
    Ok(Some(described.collect()))
}

/// A pool of queries that count, reset once: each replay adds what it counts to the same queries.
pub(super) struct PerformancePool {
    raw: vk::QueryPool,
    device: Arc<Device>,
    /// Name of the pass that is counted.
    pass: String,
    capacity: u32,
    /// Queries that this replay has begun.
    used: u32,
    /// The query that is open.
    open: Option<u32>,
    /// Set when the pass was recorded more often than there are queries.
    is_overrun: bool,
    /// Number of the replay, from 0.
    replay: u32,
}

impl PerformancePool {
    fn new(device: &Arc<Device>, pass: &str, counters: &[u32], capacity: u32) -> Result<Self, Error> {
        let mut chosen = vk::QueryPoolPerformanceCreateInfoKHR::default()
            .queue_family_index(device.queue_family)
            .counter_indices(counters);
        let info = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::PERFORMANCE_QUERY_KHR)
            .query_count(capacity)
            .push_next(&mut chosen);
        // SAFETY: the device was opened with the extension and its feature; the indices are below the number of counters
        // of this family, and there is at least one.
        let raw = unsafe { device.raw.create_query_pool(&info, None) }
            .context("creating", "a pool of performance queries")?;
        device.live().add(Kind::QueryPool);
        // SAFETY: nothing was recorded with it yet, and host resets are part of the baseline.
        unsafe { device.raw.reset_query_pool(raw, 0, capacity) };
        let (pass, device) = (pass.to_owned(), device.clone());
        Ok(PerformancePool { raw, device, pass, capacity, used: 0, open: None, is_overrun: false, replay: 0 })
    }

    /// True where the pass of that name is counted.
    pub fn counts(&self, pass: &str) -> bool {
        self.pass == pass
    }

    /// Begins the next query, as the first command of `commands`, and gives the number of the replay for its submission.
    pub fn begin(&mut self, commands: vk::CommandBuffer) -> Option<u32> {
        if self.used == self.capacity {
            self.is_overrun = true;
            return None;
        }
        // SAFETY: recording, with nothing recorded yet: the frame has just begun a submission; the lock is held since
        // before that (`Counting` owns it beside this pool); the query was reset, and is begun once a replay.
        unsafe { self.device.raw.cmd_begin_query(commands, self.raw, self.used, vk::QueryControlFlags::empty()) };
        self.open = Some(self.used);
        self.used += 1;
        Some(self.replay)
    }

    /// Ends it, as the last command of `commands`.
    pub fn end(&mut self, commands: vk::CommandBuffer) {
        let Some(query) = self.open.take() else { return };
        // SAFETY: the query was begun in this command buffer, outside a render pass, and the frame submits it next.
        unsafe { self.device.raw.cmd_end_query(commands, self.raw, query) };
    }

    /// The results of one query, one value a counter.
    fn read(&self, query: u32, counters: usize) -> Result<Vec<vk::PerformanceCounterResultKHR>, Error> {
        let mut results = vec![vk::PerformanceCounterResultKHR::default(); counters];
        let bytes = mem::size_of_val(results.as_slice());
        // SAFETY: every replay has recorded the query (`Counting::finish` compares), and its submissions have finished; the
        // values have room for one result a counter, at the alignment of one.
        unsafe {
            (self.device.raw.fp_v1_0().get_query_pool_results)(
                self.device.raw.handle(),
                self.raw,
                query,
                1,
                bytes,
                results.as_mut_ptr().cast(),
                bytes as vk::DeviceSize,
                vk::QueryResultFlags::WAIT,
            )
        }
        .result()
        .context("reading", "a pool of performance queries")?;
        Ok(results)
    }
}

impl Drop for PerformancePool {
    fn drop(&mut self) {
        // SAFETY: `Counting` drops it when nothing is in flight, and leaks it otherwise.
        unsafe { self.device.raw.destroy_query_pool(self.raw, None) };
        self.device.live().remove(Kind::QueryPool);
    }
}

/// The counting of one pass, replay after replay, under the profiling lock.
pub struct Counting<'a> {
    recorder: &'a mut Recorder,
    /// Taken before any command buffer with a query of it begins, and given back after the pool is gone.
    lock: Option<ProfilingLock>,
    /// Those that are counted, of the device's.
    chosen: Vec<PerformanceCounter>,
    left_out: Vec<String>,
    replays: u32,
    /// Number of the replay that comes next; none after one that failed, since its queries may have been used.
    next: Option<u32>,
    recordings: u32,
}

impl<'a> Counting<'a> {
    /// Takes the device's profiling lock and makes the queries for the pass of that name, which a frame records so many
    /// times. `None` for a device without the extension or without counters.
    ///
    /// # Errors
    /// [`Error::Unsupported`] where another process holds the lock, or where the frame records the pass too often; any
    /// error of Vulkan.
    pub fn begin(recorder: &'a mut Recorder, pass: &str, recordings: u32) -> Result<Option<Self>, Error> {
        let device = recorder.commands.device.clone();
        let counters = device.physical().performance_counters().unwrap_or_default();
        if counters.is_empty() {
            return Ok(None);
        }
        if recordings > MOST_QUERIES {
            let problem = format!("queries for {recordings} recordings a frame: {MOST_QUERIES} are the most");
            return Err(Error::Unsupported { object: format!("pass {pass}"), problem });
        }
        let (count, replays) = fitting(counters.len() as u32, |count| replays(&device, count));
        if count == 0 {
            return Ok(None);
        }
        let (chosen, left_out) = counters.split_at(count as usize);
        let indices: Vec<u32> = (0..count).collect();
        let lock = ProfilingLock::take(&device)?;
        recorder.performance = Some(PerformancePool::new(&device, pass, &indices, recordings.max(1))?);
        Ok(Some(Counting {
            lock: Some(lock),
            chosen: chosen.to_vec(),
            left_out: left_out.iter().map(|counter| counter.name.clone()).collect(),
            replays,
            next: Some(0),
            recordings,
            recorder,
        }))
    }

    /// Times that the frame has to be replayed.
    pub fn replays(&self) -> u32 {
        self.replays
    }

    /// Records the frame once more, submits it and waits for it; each replay must do the same work.
    ///
    /// # Errors
    /// The first error of `record` or of Vulkan; [`Error::Pass`] where the frame records the pass another number of times,
    /// after a replay that failed, and after the last.
    pub fn replay<E: From<Error>>(&mut self, record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>) -> Result<(), E> {
        let number = self.next.take().filter(|&number| number < self.replays);
        let (Some(number), Some(pool)) = (number, &mut self.recorder.performance) else {
            return Err(self.refused("it has no replay left").into());
        };
        (pool.replay, pool.used, pool.open) = (number, 0, None);
        self.recorder.run(Mode::Plain, record)?;
        match &self.recorder.performance {
            Some(pool) if pool.used == self.recordings && !pool.is_overrun => {
                self.next = Some(number + 1);
                Ok(())
            }
            _ => Err(self.refused("its frame differs from replay to replay, so that it cannot be counted").into()),
        }
    }

    fn refused(&self, problem: &str) -> Error {
        let pass = self.recorder.performance.as_ref().map_or_else(String::new, |pool| pool.pass.clone());
        Error::Pass { pass, problem: problem.to_owned() }
    }

    /// The counters of the replays.
    ///
    /// # Errors
    /// [`Error::Pass`] before the last replay has succeeded; any error of Vulkan.
    pub fn finish(self) -> Result<PerformanceReadings, Error> {
        let Some(pool) = self.recorder.performance.as_ref().filter(|_| self.next == Some(self.replays)) else {
            return Err(self.refused("not all of its replays have been made"));
        };
        let mut sums = vec![None; self.chosen.len()];
        for query in 0..self.recordings {
            let results = pool.read(query, self.chosen.len())?;
            for ((sum, counter), result) in sums.iter_mut().zip(&self.chosen).zip(results) {
                *sum = match (*sum, counter.value(result)) {
                    (Some(CounterValue::Integer(a)), Some(CounterValue::Integer(b))) => {
                        Some(CounterValue::Integer(a + b))
                    }
                    (Some(a), Some(b)) => Some(CounterValue::Float(a.as_f64() + b.as_f64())),
                    (_, value) => value,
                };
            }
        }
        let count = f64::from(self.recordings);
        let values = self.chosen.iter().cloned().zip(sums).map(|(counter, sum)| {
            let is_mean = self.recordings > 1 && !counter.is_amount();
            let value = if is_mean { sum.map(|sum| CounterValue::Float(sum.as_f64() / count)) } else { sum };
            (counter, value)
        });
        Ok(PerformanceReadings {
            replays: self.replays,
            recordings: self.recordings,
            values: values.collect(),
            left_out: self.left_out.clone(),
        })
    }
}

impl Drop for Counting<'_> {
    fn drop(&mut self) {
        let pool = self.recorder.performance.take();
        if !self.recorder.commands.is_idle() {
            // What was recorded under the lock may still execute. Leaked on purpose.
            mem::forget(pool);
            mem::forget(self.lock.take());
        }
    }
}

/// Replays of a frame that the device needs for its first `count` counters.
fn replays(device: &Device, count: u32) -> u32 {
    let instance = device.instance();
    let calls = khr::performance_query::Instance::new(&instance.entry, &instance.raw);
    let indices: Vec<u32> = (0..count).collect();
    let info = vk::QueryPoolPerformanceCreateInfoKHR::default()
        .queue_family_index(device.queue_family)
        .counter_indices(&indices);
    // SAFETY: the device's own physical device and family, which offer the extension; the indices are below the number of
    // counters.
    unsafe { calls.get_physical_device_queue_family_performance_query_passes(device.physical().raw, &info) }.max(1)
}

/// The largest number of the first counters that take at most [`MOST_REPLAYS`], and what they take: more counters never
/// take fewer.
fn fitting(all: u32, replays: impl Fn(u32) -> u32) -> (u32, u32) {
    let (mut fit, mut beyond) = (0, all + 1);
    let mut probe = all;
    while fit + 1 < beyond {
        if replays(probe) <= MOST_REPLAYS {
            fit = probe
        } else {
            beyond = probe
        }
        probe = fit + (beyond - fit) / 2;
    }
    (fit, if fit == 0 { 0 } else { replays(fit) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_counters_as_fit_are_taken() {
        assert_eq!(fitting(5, |_| 1), (5, 1));
        assert_eq!(fitting(1000, |count| count.div_ceil(10)), (640, MOST_REPLAYS));
        assert_eq!(fitting(129, |count| count.div_ceil(2)), (128, MOST_REPLAYS));
        assert_eq!(fitting(1, |_| MOST_REPLAYS), (1, MOST_REPLAYS));
        assert_eq!(fitting(3, |_| MOST_REPLAYS + 1), (0, 0));
        assert_eq!(fitting(0, |_| 1), (0, 0));
    }

    #[test]
    fn values_are_read_by_their_storage() {
        use vk::PerformanceCounterStorageKHR as Storage;
        let value = |storage, result| {
            let counter = PerformanceCounter {
                name: String::new(),
                category: String::new(),
                description: String::new(),
                unit: vk::PerformanceCounterUnitKHR::GENERIC,
                scope: vk::PerformanceCounterScopeKHR::COMMAND,
                storage,
            };
            counter.value(result)
        };
        let result = |bits: u64| vk::PerformanceCounterResultKHR { uint64: bits };
        assert_eq!(value(Storage::INT32, result(0xffff_fffb)), Some(CounterValue::Integer(-5)));
        assert_eq!(value(Storage::UINT32, result(0xffff_fffb)), Some(CounterValue::Integer(0xffff_fffb)));
        assert_eq!(value(Storage::INT64, result(u64::MAX)), Some(CounterValue::Integer(-1)));
        assert_eq!(value(Storage::UINT64, result(u64::MAX)), Some(CounterValue::Integer(u64::MAX.into())));
        let single = result(u64::from(1.5f32.to_bits()));
        assert_eq!(value(Storage::FLOAT32, single), Some(CounterValue::Float(1.5)));
        assert_eq!(value(Storage::FLOAT64, result(2.5f64.to_bits())), Some(CounterValue::Float(2.5)));
        assert_eq!(value(Storage::from_raw(99), result(1)), None);
    }
}
