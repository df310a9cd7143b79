//! Recording a frame: the one envelope around every pass opens the debug label, places the barriers and takes the
//! stamps, so that no pass can be unnamed, untimed or unsynchronised.

use std::ffi::CString;
use std::sync::Arc;
use std::time::Instant;

use ash::vk;
use bytemuck::Pod;

use super::access::Access;
use super::barrier::{self, Barriers};
use super::bindings::Use;
use super::commands::Commands;
use super::device::Device;
use super::error::Error;
use super::pass::{Body, Inner, Pass, PassInfo};
use super::physical::Feature;
use super::query::{Counter, QueryPool};
use super::transfer;

/// How a frame is observed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Not at all: the host's clock alone.
    Plain,
    /// One pair of stamps round each submission: the GPU's time with its overlap between passes.
    Bracketed,
    /// A stamp between full barriers after every pass: each pass's own time, without overlap.
    Stamped,
    /// Counters round every pass.
    Counted,
}

/// What the counters saw of one pass in one frame, summed over its calls; `None` where the device cannot count.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Vertex-stage invocations.
    pub vertices: Option<u64>,
    /// Primitives assembled.
    pub primitives: Option<u64>,
    /// Fragment-stage invocations; some devices count whole blocks.
    pub fragments: Option<u64>,
    pub compute_invocations: Option<u64>,
    /// Samples that passed every test, discards included.
    pub samples_passed: Option<u64>,
}

/// What was observed of one pass in one frame, summed over its calls.
#[derive(Debug, Clone)]
pub struct PassSample {
    pub info: Arc<PassInfo>,
    /// Draws or dispatches; for host work, executions.
    pub calls: u32,
    /// The submission of the frame that it was first part of.
    pub submission: u32,
    /// GPU time in milliseconds, in a stamped frame.
    pub gpu_ms: Option<f64>,
    /// Host time in milliseconds, of host work.
    pub host_ms: Option<f64>,
    /// Time in milliseconds that the host waited for the pass's results.
    pub wait_ms: Option<f64>,
    /// In a counted frame.
    pub counts: Option<Counts>,
}

/// A stretch of time that a pass took, in milliseconds from the start of recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Index into [`FrameSample::passes`].
    pub pass: usize,
    pub start_ms: f64,
    pub duration_ms: f64,
    /// On the GPU: its clock is laid so that the first stamp of a submission falls on the host's moment of submitting.
    pub on_gpu: bool,
}

/// What was observed of a frame.
#[derive(Debug, Clone, Default)]
pub struct FrameSample {
    /// The host's clock from the start of recording to the last fence, in milliseconds.
    pub frame_ms: f64,
    /// GPU time between the outer stamps, summed over the submissions, in a bracketed frame.
    pub bracket_ms: Option<f64>,
    /// In the order of first recording.
    pub passes: Vec<PassSample>,
    /// Each call's stretch of time: host work always, GPU work in a stamped frame.
    pub spans: Vec<Span>,
}

/// Queries of one frame; a pass beyond them is reported as not measured.
const STAMPS: u32 = 32_768;
const COUNTERS: u32 = 16_384;

/// Records and runs frames, one in flight. Buffers, pools and lists are reused from frame to frame.
pub struct Recorder {
    commands: Commands,
    stamps: Option<QueryPool>,
    samples_passed: Option<QueryPool>,
    graphics_counts: Option<QueryPool>,
    compute_counts: Option<QueryPool>,
    stamp_mask: u64,
    period_ns: f64,
    barriers: Barriers,
    keep: Vec<Pass>,
    /// The pass, as an index into `sample.passes`, of each stamped interval and of each counter.
    intervals: Vec<usize>,
    counted: Vec<Counted>,
    labels: Vec<(&'static str, CString)>,
    sample: FrameSample,
}

struct Counted {
    pass: usize,
    samples: Option<u32>,
    graphics: Option<u32>,
    compute: Option<u32>,
}

impl Recorder {
    /// Makes the command buffer, and the query pools that the device can fill.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let physical = device.physical();
        let pool = |feature, counter, capacity| {
            physical.has(feature).then(|| QueryPool::new(device, counter, capacity)).transpose()
        };
        let bits = physical.queue.map_or(0, |q| q.1);
        Ok(Recorder {
            commands: Commands::new(device, "frame")?,
            stamps: pool(Feature::Timestamps, Counter::Timestamps, STAMPS)?,
            samples_passed: pool(Feature::PreciseOcclusion, Counter::Samples, COUNTERS)?,
            graphics_counts: pool(Feature::PipelineStatistics, Counter::Graphics, COUNTERS)?,
            compute_counts: pool(Feature::PipelineStatistics, Counter::Compute, COUNTERS)?,
            stamp_mask: if bits >= 64 { u64::MAX } else { (1 << bits) - 1 },
            period_ns: f64::from(physical.limits.timestamp_period),
            barriers: Barriers::default(),
            keep: Vec::new(),
            intervals: Vec::new(),
            counted: Vec::new(),
            labels: Vec::new(),
            sample: FrameSample::default(),
        })
    }

    /// Records a frame with `record`, submits it and waits for it.
    ///
    /// # Errors
    /// The first error of `record` or of Vulkan; what the resources hold is then unknown.
    pub fn run<E: From<Error>>(
        &mut self,
        mode: Mode,
        record: impl FnOnce(&mut Frame<'_>) -> Result<(), E>,
    ) -> Result<&FrameSample, E> {
        self.sample.passes.clear();
        self.sample.spans.clear();
        self.sample.bracket_ms = None;
        let started = Instant::now();
        let mut frame = Frame { recorder: self, mode, submission: 0, started };
        frame.begin()?;
        record(&mut frame)?;
        frame.finish()?;
        Ok(&self.sample)
    }

    /// Time in milliseconds that two neighbouring stamps of the scheme show with nothing between them: the median of
    /// 101, or `None` without stamps.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn stamp_floor_ms(&mut self) -> Result<Option<f64>, Error> {
        let info = PassInfo::host("empty", "", &[], &[]);
        let mut floors = Vec::new();
        self.run(Mode::Stamped, |frame| {
            for _ in 0..101 {
                let at = frame.sample_of(&info);
                frame.recorder.stamp(at);
            }
            Ok::<(), Error>(())
        })?;
        if let Some(pool) = &mut self.stamps {
            let stamps = pool.read()?;
            floors.extend(
                stamps.windows(2).map(|w| (w[1].wrapping_sub(w[0]) & self.stamp_mask) as f64 * self.period_ns * 1e-6),
            );
        }
        floors.sort_by(f64::total_cmp);
        Ok(floors.get(floors.len() / 2).copied())
    }

    /// `full, stamp, full` after a pass.
    fn stamp(&mut self, pass: usize) {
        if let Some(query) = self.stamps.as_mut().and_then(QueryPool::take) {
            self.write_stamp(query);
            self.intervals.push(pass);
        }
    }

    fn write_stamp(&self, query: u32) {
        let Some(pool) = &self.stamps else { return };
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

    fn read_stamps(&mut self, mode: Mode, submitted_ms: f64) -> Result<(), Error> {
        let Some(pool) = &mut self.stamps else { return Ok(()) };
        let (mask, period_ns) = (self.stamp_mask, self.period_ns);
        let difference_ms = |w: &[u64]| (w[1].wrapping_sub(w[0]) & mask) as f64 * period_ns * 1e-6;
        let stamps = pool.read()?;
        if mode == Mode::Bracketed {
            if let [first, last] = stamps {
                *self.sample.bracket_ms.get_or_insert(0.0) += difference_ms(&[*first, *last]);
            }
            return Ok(());
        }
        let mut start_ms = submitted_ms;
        for (window, &pass) in stamps.windows(2).zip(&self.intervals) {
            let duration_ms = difference_ms(window);
            *self.sample.passes[pass].gpu_ms.get_or_insert(0.0) += duration_ms;
            self.sample.spans.push(Span { pass, start_ms, duration_ms, on_gpu: true });
            start_ms += duration_ms;
        }
        Ok(())
    }

    fn read_counts(&mut self) -> Result<(), Error> {
        let read = |pool: &mut Option<QueryPool>| -> Result<Vec<u64>, Error> {
            pool.as_mut().map_or(Ok(Vec::new()), |p| p.read().map(<[u64]>::to_vec))
        };
        let samples = read(&mut self.samples_passed)?;
        let graphics = read(&mut self.graphics_counts)?;
        let compute = read(&mut self.compute_counts)?;
        for one in &self.counted {
            let counts = self.sample.passes[one.pass].counts.get_or_insert_with(Counts::default);
            let add = |total: &mut Option<u64>, value: Option<&u64>| {
                if let Some(value) = value {
                    *total.get_or_insert(0) += value;
                }
            };
            if let Some(query) = one.graphics {
                // Vulkan writes the counters in the order of their bits: primitives, vertices, fragments.
                let at = query as usize * 3;
                add(&mut counts.primitives, graphics.get(at));
                add(&mut counts.vertices, graphics.get(at + 1));
                add(&mut counts.fragments, graphics.get(at + 2));
            }
            add(&mut counts.compute_invocations, one.compute.and_then(|q| compute.get(q as usize)));
            add(&mut counts.samples_passed, one.samples.and_then(|q| samples.get(q as usize)));
        }
        Ok(())
    }
}

/// A frame being recorded.
pub struct Frame<'a> {
    recorder: &'a mut Recorder,
    mode: Mode,
    submission: u32,
    started: Instant,
}

impl Frame<'_> {
    fn begin(&mut self) -> Result<(), Error> {
        let r = &mut *self.recorder;
        r.keep.clear();
        r.intervals.clear();
        r.counted.clear();
        for pool in
            [&mut r.stamps, &mut r.samples_passed, &mut r.graphics_counts, &mut r.compute_counts].into_iter().flatten()
        {
            pool.reset();
        }
        r.commands.begin()?;
        if matches!(self.mode, Mode::Stamped | Mode::Bracketed)
            && let Some(query) = r.stamps.as_mut().and_then(QueryPool::take)
        {
            r.write_stamp(query);
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Error> {
        let r = &mut *self.recorder;
        if self.mode == Mode::Bracketed
            && let Some(query) = r.stamps.as_mut().and_then(QueryPool::take)
        {
            r.write_stamp(query);
        }
        let submitted_ms = self.started.elapsed().as_secs_f64() * 1e3;
        let submitted = r.commands.submit_and_wait();
        r.sample.frame_ms = self.started.elapsed().as_secs_f64() * 1e3;
        r.keep.clear();
        submitted?;
        match self.mode {
            Mode::Plain => Ok(()),
            Mode::Stamped | Mode::Bracketed => r.read_stamps(self.mode, submitted_ms),
            Mode::Counted => r.read_counts(),
        }
    }

    /// Submits what is recorded and waits for it, so that the host can read what `pass` copied; the rest of the frame is
    /// another submission.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn wait_for(&mut self, pass: &Pass) -> Result<(), Error> {
        let at = self.sample_of(pass.info());
        let waiting = Instant::now();
        self.finish()?;
        let wait_ms = waiting.elapsed().as_secs_f64() * 1e3;
        *self.recorder.sample.passes[at].wait_ms.get_or_insert(0.0) += wait_ms;
        self.submission += 1;
        self.begin()
    }

    fn sample_of(&mut self, info: &Arc<PassInfo>) -> usize {
        let passes = &mut self.recorder.sample.passes;
        if let Some(at) = passes.iter().position(|p| p.info.name == info.name) {
            return at;
        }
        passes.push(PassSample {
            info: info.clone(),
            calls: 0,
            submission: self.submission,
            gpu_ms: None,
            host_ms: None,
            wait_ms: None,
            counts: None,
        });
        passes.len() - 1
    }

    /// Records a pass that draws; `body` issues its draws.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`].
    pub fn graphics(&mut self, pass: &Pass, body: impl FnOnce(&mut Draw<'_>)) -> Result<(), Error> {
        let Body::Graphics { render_pass, framebuffer, extent, clears, vertices, indices } = &pass.inner.body else {
            return Err(not_a(pass, "graphics"));
        };
        self.envelope(pass, |device, commands| {
            let area = vk::Rect2D::default().extent(*extent);
            let begin = vk::RenderPassBeginInfo::default()
                .render_pass(render_pass.raw)
                .framebuffer(framebuffer.raw)
                .render_area(area)
                .clear_values(clears);
            let viewport = vk::Viewport {
                x: 0.0,
                y: 0.0,
                width: extent.width as f32,
                height: extent.height as f32,
                min_depth: 0.0,
                max_depth: 1.0,
            };
            // SAFETY: recording; the frame keeps the pass and everything it owns until its fence.
            unsafe {
                device.raw.cmd_begin_render_pass(commands, &begin, vk::SubpassContents::INLINE);
                device.raw.cmd_set_viewport(commands, 0, &[viewport]);
                device.raw.cmd_set_scissor(commands, 0, &[area]);
                if let Some(view) = vertices {
                    device.raw.cmd_bind_vertex_buffers(commands, 0, &[view.buffer.raw], &[view.range.start]);
                }
                if let Some(view) = indices {
                    device.raw.cmd_bind_index_buffer(
                        commands,
                        view.buffer.raw,
                        view.range.start,
                        vk::IndexType::UINT32,
                    );
                }
            }
            let mut draw = Draw { device, commands, inner: &pass.inner, calls: 0 };
            body(&mut draw);
            let calls = draw.calls;
            // SAFETY: inside the render pass begun above.
            unsafe { device.raw.cmd_end_render_pass(commands) };
            calls
        })
    }

    /// Records a pass that dispatches; `body` issues its dispatches.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`].
    pub fn compute(&mut self, pass: &Pass, body: impl FnOnce(&mut Dispatch<'_>)) -> Result<(), Error> {
        if !matches!(pass.inner.body, Body::Compute) {
            return Err(not_a(pass, "compute"));
        }
        self.envelope(pass, |device, commands| {
            let mut dispatch =
                Dispatch { device, commands, inner: &pass.inner, local_size: pass.local_size(), calls: 0 };
            body(&mut dispatch);
            dispatch.calls
        })
    }

    /// Records a copy; what the host is to read is made visible to it.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`].
    pub fn copy(&mut self, pass: &Pass) -> Result<(), Error> {
        let Body::Copy { from, to } = &pass.inner.body else { return Err(not_a(pass, "copy")) };
        self.envelope(pass, |device, commands| {
            transfer::record_copy(&device.raw, commands, from, to);
            1
        })?;
        if to.is_readback() {
            let r = &mut *self.recorder;
            let uses = [Use { resource: to.into(), access: Access::HostRead, discard: false }];
            r.barriers.collect(pass.info().name, &uses)?;
            r.barriers.record(&r.commands.device, r.commands.buffer);
        }
        Ok(())
    }

    /// Runs and times host work that the method needs.
    pub fn host<T>(&mut self, info: &Arc<PassInfo>, work: impl FnOnce() -> T) -> T {
        let at = self.sample_of(info);
        let started = Instant::now();
        let result = work();
        let duration_ms = started.elapsed().as_secs_f64() * 1e3;
        let start_ms = (started - self.started).as_secs_f64() * 1e3;
        self.recorder.sample.spans.push(Span { pass: at, start_ms, duration_ms, on_gpu: false });
        let sample = &mut self.recorder.sample.passes[at];
        *sample.host_ms.get_or_insert(0.0) += duration_ms;
        sample.calls += 1;
        result
    }

    fn envelope(&mut self, pass: &Pass, body: impl FnOnce(&Device, vk::CommandBuffer) -> u32) -> Result<(), Error> {
        let at = self.sample_of(pass.info());
        let mode = self.mode;
        let r = &mut *self.recorder;
        r.barriers.collect(pass.info().name, &pass.inner.uses)?;
        r.keep.push(pass.clone());
        r.open_label(pass.info().name);
        let device = r.commands.device.clone();
        let commands = r.commands.buffer;
        r.barriers.record(&device, commands);
        r.bind(&pass.inner);
        let queries = (mode == Mode::Counted).then(|| r.begin_counters(&pass.inner, at));
        let calls = body(&device, commands);
        if let Some(queries) = queries {
            r.end_counters(queries);
        }
        r.close_label();
        r.sample.passes[at].calls += calls;
        if mode == Mode::Stamped {
            r.stamp(at);
        }
        Ok(())
    }
}

fn not_a(pass: &Pass, kind: &str) -> Error {
    Error::Pass { pass: pass.info().name.into(), problem: format!("it is not a {kind} pass") }
}

impl Recorder {
    fn bind(&self, inner: &Inner) {
        let point = match inner.body {
            Body::Graphics { .. } => vk::PipelineBindPoint::GRAPHICS,
            Body::Compute | Body::Copy { .. } => vk::PipelineBindPoint::COMPUTE,
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

    fn begin_counters(&mut self, inner: &Inner, pass: usize) -> Counted {
        let is_graphics = matches!(inner.body, Body::Graphics { .. });
        let take =
            |pool: &mut Option<QueryPool>, wanted: bool| pool.as_mut().filter(|_| wanted).and_then(QueryPool::take);
        let counted = Counted {
            pass,
            samples: take(&mut self.samples_passed, is_graphics),
            graphics: take(&mut self.graphics_counts, is_graphics),
            compute: take(&mut self.compute_counts, matches!(inner.body, Body::Compute)),
        };
        self.each_counter(&counted, |raw, commands, pool, query| {
            let flags = if pool.1 { vk::QueryControlFlags::PRECISE } else { vk::QueryControlFlags::empty() };
            // SAFETY: recording outside a render pass; the query was reset and is begun once.
            unsafe { raw.cmd_begin_query(commands, pool.0, query, flags) };
        });
        counted
    }

    fn end_counters(&mut self, counted: Counted) {
        self.each_counter(&counted, |raw, commands, pool, query| {
            // SAFETY: recording outside a render pass; the query was begun in this command buffer.
            unsafe { raw.cmd_end_query(commands, pool.0, query) };
        });
        self.counted.push(counted);
    }

    /// Visits the queries of one pass with their pool and whether they count precisely.
    fn each_counter(
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

    fn open_label(&mut self, name: &'static str) {
        let Some(debug) = &self.commands.device.debug else { return };
        let at = self.labels.iter().position(|(n, _)| *n == name).or_else(|| {
            self.labels.push((name, CString::new(name).ok()?));
            Some(self.labels.len() - 1)
        });
        let Some(at) = at else { return };
        let label = vk::DebugUtilsLabelEXT::default().label_name(&self.labels[at].1);
        // SAFETY: recording; the label's text lives in `labels`.
        unsafe { debug.cmd_begin_debug_utils_label(self.commands.buffer, &label) };
    }

    fn close_label(&self) {
        if let Some(debug) = &self.commands.device.debug {
            // SAFETY: closes the label that `open_label` opened.
            unsafe { debug.cmd_end_debug_utils_label(self.commands.buffer) };
        }
    }
}

/// The draws of one pass.
pub struct Draw<'a> {
    device: &'a Device,
    commands: vk::CommandBuffer,
    inner: &'a Inner,
    calls: u32,
}

impl Draw<'_> {
    /// Sets the push constants of the draws to come.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        push(self.device, self.commands, self.inner, bytemuck::bytes_of(constants));
        self
    }

    /// Makes the draws to come those of the pass's counting pipeline, or of its own again.
    pub fn counting(&mut self, counting: bool) -> &mut Self {
        let pipeline = if counting { &self.inner.counting } else { &self.inner.pipeline };
        if let Some(pipeline) = pipeline {
            let point = vk::PipelineBindPoint::GRAPHICS;
            // SAFETY: inside the pass's render pass; both pipelines were made for it and share one layout.
            unsafe { self.device.raw.cmd_bind_pipeline(self.commands, point, pipeline.raw) };
        }
        self
    }

    /// Draws `count` vertices from `first` on without indices.
    pub fn vertices_from(&mut self, first: u32, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: as for [`Draw::vertices`].
        unsafe { self.device.raw.cmd_draw(self.commands, count, 1, first, 0) };
        self
    }

    /// Draws `count` vertices without indices.
    pub fn vertices(&mut self, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: inside the pass's render pass, with its pipeline and buffers bound.
        unsafe { self.device.raw.cmd_draw(self.commands, count, 1, 0, 0) };
        self
    }

    /// Draws `count` indices.
    pub fn indices(&mut self, count: u32) -> &mut Self {
        self.calls += 1;
        // SAFETY: as above; the index buffer was checked when it was filled.
        unsafe { self.device.raw.cmd_draw_indexed(self.commands, count, 1, 0, 0, 0) };
        self
    }
}

/// The dispatches of one pass.
pub struct Dispatch<'a> {
    device: &'a Device,
    commands: vk::CommandBuffer,
    inner: &'a Inner,
    local_size: [u32; 3],
    calls: u32,
}

impl Dispatch<'_> {
    /// Sets the push constants of the dispatches to come.
    pub fn constants<T: Pod>(&mut self, constants: &T) -> &mut Self {
        push(self.device, self.commands, self.inner, bytemuck::bytes_of(constants));
        self
    }

    /// Dispatches at least `x` x `y` x `z` threads, in whole workgroups.
    pub fn threads(&mut self, x: u32, y: u32, z: u32) -> &mut Self {
        self.calls += 1;
        let [a, b, c] = self.local_size;
        // SAFETY: recording outside a render pass with the pass's pipeline bound.
        unsafe { self.device.raw.cmd_dispatch(self.commands, x.div_ceil(a), y.div_ceil(b), z.div_ceil(c)) };
        self
    }
}

fn push(device: &Device, commands: vk::CommandBuffer, inner: &Inner, bytes: &[u8]) {
    let Some(pipeline) = &inner.pipeline else { return };
    let program = &pipeline.program;
    // The host struct may carry its alignment's tail; the block's own size is what the layout declares.
    let bytes = &bytes[..bytes.len().min(program.push_bytes as usize)];
    // SAFETY: the build of the pass checked the struct against the block; the range was declared in the layout.
    unsafe { device.raw.cmd_push_constants(commands, program.layout, program.push_stages, 0, bytes) };
}
