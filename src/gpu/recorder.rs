//! The recorder: command buffer, query pools and lists that frames reuse, and the reading of the queries after them.

use std::ffi::CString;
use std::mem;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use ash::vk;

use super::barrier;
use super::commands::Commands;
use super::device::{Device, c_text};
use super::error::Error;
use super::extensions::Calibration;
use super::frame::{End, Frame};
use super::pass::{Body, Inner, Pass};
use super::pass_info::PassInfo;
use super::performance::PerformancePool;
use super::physical::Feature;
use super::query::{Counter, QueryPool};
use super::sample::{Counts, FrameSample, Mode, Span, Track};
use super::work::{Fetched, Work};

/// Queries of one frame; a pass beyond them is reported as not measured.
const TIMESTAMPS: u32 = 32_768;
const COUNTERS: u32 = 16_384;

/// Records and runs frames, one in flight. Buffers, pools and lists are reused from frame to frame.
pub struct Recorder {
    /// The command buffer with its fence.
    pub(super) commands: Commands,
    /// Queries of time; absent where the device has none.
    pub(super) timestamps: Option<QueryPool>,
    /// Queries of samples that passed; absent without exact counts.
    pub(super) samples_passed: Option<QueryPool>,
    /// Queries of vertices, primitives and invocations; absent without pipeline statistics.
    pub(super) graphics_counts: Option<QueryPool>,
    /// Queries of compute invocations; absent without pipeline statistics.
    pub(super) compute_counts: Option<QueryPool>,
    /// Queries of the device's own counters, while a pass is counted with them.
    pub(super) performance: Option<PerformancePool>,
    /// Bits of a timestamp that are valid.
    pub(super) timestamp_mask: u64,
    /// Nanoseconds of one step of a timestamp.
    pub(super) period_ns: f64,
    calibration: Option<Calibration>,
    /// Frames that were submitted so far.
    pub(super) frames: u64,
    /// The pass, as an index into `sample.passes`, of each timestamped interval.
    pub(super) intervals: Vec<usize>,
    /// Counters of the passes of this submission.
    pub(super) counted: Vec<Counted>,
    /// Passes with calls beyond the queries or the range of timestamps: not measured, rather than in part.
    overrun: Vec<usize>,
    /// Debug labels by the passes' names, made once.
    pub(super) labels: Vec<(&'static str, CString)>,
    /// Times and counters of the frame so far.
    pub(super) sample: FrameSample,
    /// Each pass of a plain frame is a submission of its own.
    pub(super) submits_by_pass: bool,
}

pub(super) struct Counted {
    /// Index into `sample.passes`.
    pass: usize,
    recorded: Pass,
    /// Vertices and indices that its draws fetch, known once they are recorded.
    pub fetched: Fetched,
    samples: Option<u32>,
    graphics: Option<u32>,
    compute: Option<u32>,
}

impl Recorder {
    /// Makes the command buffer, and the query pools that the device can fill.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let physical = device.physical();
        let pool = |feature, counter, capacity| {
            physical.has(feature).then(|| QueryPool::new(device, counter, capacity)).transpose()
        };
        let bits = physical.queue.map_or(0, |q| q.1);
        Ok(Recorder {
            commands: Commands::new(device, "frame")?,
            timestamps: pool(Feature::Timestamps, Counter::Timestamps, TIMESTAMPS)?,
            samples_passed: pool(Feature::PreciseOcclusion, Counter::Samples, COUNTERS)?,
            graphics_counts: pool(Feature::PipelineStatistics, Counter::Graphics, COUNTERS)?,
            compute_counts: pool(Feature::PipelineStatistics, Counter::Compute, COUNTERS)?,
            performance: None,
            timestamp_mask: if bits >= 64 { u64::MAX } else { (1 << bits) - 1 },
            period_ns: f64::from(physical.limits.timestamp_period),
            calibration: Calibration::new(device),
            frames: 0,
            intervals: Vec::new(),
            counted: Vec::new(),
            overrun: Vec::new(),
            labels: Vec::new(),
            sample: FrameSample::default(),
            submits_by_pass: false,
        })
    }

    /// From now on, each pass of a plain frame is a submission of its own or not, and is waited for before the next: another
    /// process that wants the device waits for one pass at most, and the frame takes longer by what lies between. Calls of
    /// one pass that follow each other stay together.
    pub fn submit_by_pass(&mut self, is_wanted: bool) {
        self.submits_by_pass = is_wanted;
    }

    /// Records a frame with `record`, submits it and waits for it.
    ///
    /// # Errors
    /// The first error of `record` or of Vulkan. A submission that failed leaves the tracked states of its resources as
    /// they were before it; what a frame that was given up half-way had submitted before is done.
    pub fn run<E: From<Error>>(
        &mut self,
        mode: Mode,
        record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>,
    ) -> Result<&FrameSample, E> {
        self.run_to(mode, End::Open, None, record)
    }

    /// As [`Recorder::run`], of a frame that is given up between two of its submissions once `interrupted` is set.
    ///
    /// # Errors
    /// As [`Recorder::run`]; [`Error::Interrupted`].
    pub fn run_unless<E: From<Error>>(
        &mut self,
        interrupted: &AtomicBool,
        mode: Mode,
        record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>,
    ) -> Result<&FrameSample, E> {
        self.run_to(mode, End::Open, Some(interrupted), record)
    }

    /// As [`Recorder::run`], of a frame that ends where the next pass after its first `passes` would begin; a pass of many
    /// calls between others may then have only some of them. `record` is told of the end by an error, with which it returns;
    /// what it keeps of the frame's state is then that of a frame that was begun and not finished.
    ///
    /// # Errors
    /// As [`Recorder::run`].
    pub fn run_first<E: From<Error>>(
        &mut self,
        mode: Mode,
        passes: usize,
        record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>,
    ) -> Result<&FrameSample, E> {
        self.run_to(mode, End::After(passes), None, record)
    }

    fn run_to<E: From<Error>>(
        &mut self,
        mode: Mode,
        end: End,
        interrupted: Option<&AtomicBool>,
        record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>,
    ) -> Result<&FrameSample, E> {
        self.sample.passes.clear();
        self.sample.spans.clear();
        self.sample.bracket_ms = None;
        self.overrun.clear();
        let started = Instant::now();
        let mut frame = Frame {
            recorder: self,
            mode,
            submission: 0,
            started,
            failed: None,
            end,
            recording_ms: 0.0,
            interrupted,
            work: 0.0,
            last: None,
        };
        frame.begin()?;
        match record(&mut frame) {
            // The error told of the end.
            Err(_) if frame.end == End::Reached && frame.failed.is_none() => {}
            other => other?,
        }
        frame.finish()?;
        drop(frame);
        self.sample.bracket_ms = self.sample.bracket_ms.filter(|ms| ms.is_finite());
        for &pass in &self.overrun {
            let sample = &mut self.sample.passes[pass];
            (sample.gpu_ms, sample.counts, sample.work, sample.is_overrun) = (None, None, None, true);
        }
        Ok(&self.sample)
    }

    /// Time in milliseconds that two neighbouring timestamps of the scheme show with nothing between them: the median of
    /// 101, or `None` without timestamps.
    ///
    /// # Errors
    /// Any error of Vulkan.
    pub fn timestamp_floor_ms(&mut self) -> Result<Option<f64>, Error> {
        let info = PassInfo::host("empty", "", &[], &[]);
        let mut floors = Vec::new();
        self.run(Mode::Timestamped, |frame| {
            for _ in 0..101 {
                let at = frame.sample_of(&info);
                frame.recorder.timestamp(at);
            }
            Ok::<(), Error>(())
        })?;
        let is_in_range = !self.comes_round(self.sample.frame_ms);
        if let Some(pool) = self.timestamps.as_mut().filter(|_| is_in_range) {
            let timestamps = pool.read()?;
            floors.extend(
                timestamps
                    .windows(2)
                    .map(|w| (w[1].wrapping_sub(w[0]) & self.timestamp_mask) as f64 * self.period_ns * 1e-6),
            );
        }
        floors.sort_by(f64::total_cmp);
        Ok(floors.get(floors.len() / 2).copied())
    }

    /// True where timestamps may have come back to their start in this time, by the clock of the host: their differences mean
    /// nothing then.
    fn comes_round(&self, duration_ms: f64) -> bool {
        duration_ms >= (self.timestamp_mask as f64 + 1.0) * self.period_ns * 1e-6
    }

    /// `full, timestamp, full` after a pass.
    pub(super) fn timestamp(&mut self, pass: usize) {
        let Some(pool) = &mut self.timestamps else { return };
        match pool.take() {
            Some(query) => {
                self.write_timestamp(query);
                self.intervals.push(pass);
            }
            None => self.overrun.push(pass),
        }
    }

    pub(super) fn write_timestamp(&self, query: u32) {
        let Some(pool) = &self.timestamps else { return };
        let device = &self.commands.device;
        barrier::full(device, self.commands.buffer);
        // SAFETY: recording outside a render pass; the query was reset and is used once.
        unsafe {
            device.raw.cmd_write_timestamp2(
                self.commands.buffer,
                vk::PipelineStageFlags2::ALL_COMMANDS,
                pool.raw,
                query,
            );
        }
        barrier::full(device, self.commands.buffer);
    }

    /// Gives the timestamps' differences to their passes. `started` is the frame's start, `submitted_ms` after which its work
    /// was handed in.
    pub(super) fn read_timestamps(&mut self, mode: Mode, started: Instant, submitted_ms: f64) -> Result<(), Error> {
        if self.comes_round(started.elapsed().as_secs_f64() * 1e3 - submitted_ms) {
            self.overrun.extend(&self.intervals);
            self.sample.bracket_ms = Some(f64::NAN);
            return Ok(());
        }
        let Some(pool) = &mut self.timestamps else { return Ok(()) };
        let (mask, period_ns) = (self.timestamp_mask, self.period_ns);
        let difference_ms = |w: &[u64]| (w[1].wrapping_sub(w[0]) & mask) as f64 * period_ns * 1e-6;
        let timestamps = pool.read()?;
        let mut start_ms = submitted_ms;
        // The device's clock runs on: the first timestamp lies as long before this reading as the ticks between them.
        let now = self.calibration.as_ref().map(Calibration::now).transpose()?;
        if let (Some((ticks, moment)), Some(first)) = (now, timestamps.first()) {
            start_ms = (moment - started).as_secs_f64() * 1e3 - difference_ms(&[*first, ticks]);
        }
        if mode == Mode::Bracketed {
            if let [first, last] = timestamps {
                let duration_ms = difference_ms(&[*first, *last]);
                *self.sample.bracket_ms.get_or_insert(0.0) += duration_ms;
                self.sample.spans.push(Span { pass: None, start_ms, duration_ms, track: Track::Gpu });
            }
            return Ok(());
        }
        for (window, &pass) in timestamps.windows(2).zip(&self.intervals) {
            let duration_ms = difference_ms(window);
            *self.sample.passes[pass].gpu_ms.get_or_insert(0.0) += duration_ms;
            self.sample.spans.push(Span { pass: Some(pass), start_ms, duration_ms, track: Track::Gpu });
            start_ms += duration_ms;
        }
        Ok(())
    }

    pub(super) fn read_counts(&mut self) -> Result<(), Error> {
        let read = |pool: &mut Option<QueryPool>| -> Result<Vec<u64>, Error> {
            pool.as_mut().map_or(Ok(Vec::new()), |p| p.read().map(<[u64]>::to_vec))
        };
        let samples = read(&mut self.samples_passed)?;
        let graphics = read(&mut self.graphics_counts)?;
        let compute = read(&mut self.compute_counts)?;
        for one in &self.counted {
            let at = |values: &[u64], query: Option<u32>, stride: usize, offset: usize| {
                values.get(query? as usize * stride + offset).copied()
            };
            // Vulkan writes the counters in the order of their bits: primitives, vertices, clipped primitives, fragments.
            let counts = Counts {
                primitives: at(&graphics, one.graphics, 4, 0),
                vertices: at(&graphics, one.graphics, 4, 1),
                clipped_primitives: at(&graphics, one.graphics, 4, 2),
                fragments: at(&graphics, one.graphics, 4, 3),
                compute_invocations: at(&compute, one.compute, 1, 0),
                samples_passed: at(&samples, one.samples, 1, 0),
            };
            let inner = &one.recorded.inner;
            let sample = &mut self.sample.passes[one.pass];
            sample.counts.get_or_insert_with(Counts::default).add(&counts);
            let work = inner.declared.work(&inner.desc, one.fetched, &counts);
            sample.work.get_or_insert_with(Work::default).add(work);
        }
        Ok(())
    }

    pub(super) fn bind(&self, inner: &Inner) {
        let point = match inner.body {
            Body::Graphics { .. } => vk::PipelineBindPoint::GRAPHICS,
            Body::Compute { .. } | Body::Copy { .. } => vk::PipelineBindPoint::COMPUTE,
        };
        let Some(pipeline) = &inner.pipeline else { return };
        let raw = &self.commands.device.raw;
        // SAFETY: recording; pipeline, layout and set belong together and are kept by the frame.
        unsafe {
            raw.cmd_bind_pipeline(self.commands.buffer, point, pipeline.raw);
            if let Some(bindings) = &inner.bindings {
                let layout = pipeline.program.layout;
                raw.cmd_bind_descriptor_sets(self.commands.buffer, point, layout, 0, &[bindings.set], &[]);
            }
        }
    }

    pub(super) fn begin_counters(&mut self, recorded: &Pass, pass: usize) -> Counted {
        let inner = &recorded.inner;
        let is_graphics = matches!(inner.body, Body::Graphics { .. });
        let overrun = &mut self.overrun;
        let mut take = |pool: &mut Option<QueryPool>, wanted: bool| {
            let query = pool.as_mut().filter(|_| wanted)?.take();
            if query.is_none() {
                overrun.push(pass);
            }
            query
        };
        let counted = Counted {
            pass,
            recorded: recorded.clone(),
            fetched: Fetched::default(),
            samples: take(&mut self.samples_passed, is_graphics),
            graphics: take(&mut self.graphics_counts, is_graphics),
            compute: take(&mut self.compute_counts, matches!(inner.body, Body::Compute { .. })),
        };
        self.each_counter(&counted, |raw, commands, pool, query| {
            let flags = if pool.1 { vk::QueryControlFlags::PRECISE } else { vk::QueryControlFlags::empty() };
            // SAFETY: recording outside a render pass; the query was reset and is begun once.
            unsafe { raw.cmd_begin_query(commands, pool.0, query, flags) };
        });
        counted
    }

    pub(super) fn end_counters(&mut self, counted: Counted) {
        self.each_counter(&counted, |raw, commands, pool, query| {
            // SAFETY: recording outside a render pass; the query was begun in this command buffer.
            unsafe { raw.cmd_end_query(commands, pool.0, query) };
        });
        self.counted.push(counted);
    }

    /// Visits the queries of one pass with their pool and whether they count precisely.
    pub(super) fn each_counter(
        &self,
        counted: &Counted,
        mut visit: impl FnMut(&ash::Device, vk::CommandBuffer, (vk::QueryPool, bool), u32),
    ) {
        let pools = [
            (&self.samples_passed, counted.samples, true),
            (&self.graphics_counts, counted.graphics, false),
            (&self.compute_counts, counted.compute, false),
        ];
        for (pool, query, precise) in pools {
            if let (Some(pool), Some(query)) = (pool, query) {
                visit(&self.commands.device.raw, self.commands.buffer, (pool.raw, precise), query);
            }
        }
    }

    /// Begins to count the pass of that name with the device's own counters, as the first command of a submission.
    pub(super) fn begin_performance(&mut self) {
        let commands = self.commands.buffer;
        self.commands.counter_pass = self.performance.as_mut().and_then(|pool| pool.begin(commands));
    }

    /// Ends it, as the last command, once all that was recorded before has finished.
    pub(super) fn end_performance(&mut self) {
        let commands = self.commands.buffer;
        if let Some(pool) = &mut self.performance {
            barrier::full(&self.commands.device, commands);
            pool.end(commands);
        }
    }

    pub(super) fn open_label(&mut self, info: &PassInfo) {
        let name = info.name;
        let Some(debug) = &self.commands.device.debug else { return };
        let at = self.labels.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
            self.labels.push((name, c_text(&info.label())));
            self.labels.len() - 1
        });
        let label = vk::DebugUtilsLabelEXT::default().label_name(&self.labels[at].1);
        // SAFETY: recording; the label's text lives in `labels`.
        unsafe { debug.cmd_begin_debug_utils_label(self.commands.buffer, &label) };
    }

    pub(super) fn close_label(&self) {
        if let Some(debug) = &self.commands.device.debug {
            // SAFETY: closes the label that `open_label` opened.
            unsafe { debug.cmd_end_debug_utils_label(self.commands.buffer) };
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if !self.commands.is_idle() {
            // A frame that may still be executing writes its queries.
            let pools =
                [&mut self.timestamps, &mut self.samples_passed, &mut self.graphics_counts, &mut self.compute_counts];
            pools.into_iter().for_each(|pool| mem::forget(pool.take()));
            mem::forget(self.performance.take());
        }
    }
}
