//! Recording a frame: the one envelope around every pass opens the debug label, places the barriers and takes the
//! timestamps, so that no pass can be unnamed, untimed or unsynchronised.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use ash::vk;

use super::access::Access;
use super::bindings::Use;
use super::device::Device;
use super::draw::{Dispatch, Draw};
use super::error::Error;
use super::pass::{Body, Pass};
use super::pass_info::PassInfo;
use super::query::QueryPool;
use super::recorder::Recorder;
use super::sample::{Mode, PassSample, Span, Track};
use super::transfer;
use super::work::Fetched;

/// A frame being recorded.
pub struct Frame<'a> {
    /// The recorder that runs it.
    pub(super) recorder: &'a mut Recorder,
    /// Kind of what is measured of it: times, counters or nothing.
    pub(super) mode: Mode,
    /// Number of this submission in the frame, from 0 on.
    pub(super) submission: u32,
    /// Moment at which recording began.
    pub(super) started: Instant,
    /// The pass whose recording failed: the frame is not submitted then.
    pub(super) failed: Option<&'static str>,
    /// Pass behind which it ends.
    pub(super) end: End,
    /// Milliseconds from the frame's start to that of this submission's recording.
    pub(super) recording_ms: f64,
    /// Set when the frame is to be given up after the submission that executes.
    pub(super) interrupted: Option<&'a AtomicBool>,
    /// Work of this submission, as [`Frame::reserve_work`] was told.
    pub(super) work: f64,
    /// The pass that was recorded last in this submission, as an index into the sample's passes.
    pub(super) last: Option<usize>,
}

/// End of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// Behind its last pass.
    Open,
    /// Behind its first so many passes.
    After(usize),
    /// A pass behind that was met: what comes now is left out.
    Reached,
}

/// Records the commands of a pass, and tells their number and what they fetch.
type PassBody<'a> = dyn FnMut(&Device, vk::CommandBuffer) -> Result<(u32, Fetched), Error> + 'a;

impl Frame<'_> {
    pub(super) fn begin(&mut self) -> Result<(), Error> {
        let r = &mut *self.recorder;
        // First: the queries of an earlier submission are in use until it is known to have finished.
        r.commands.begin()?;
        r.intervals.clear();
        r.counted.clear();
        (self.work, self.last) = (0.0, None);
        for pool in [&mut r.timestamps, &mut r.samples_passed, &mut r.graphics_counts, &mut r.compute_counts]
            .into_iter()
            .flatten()
        {
            pool.reset();
        }
        if matches!(self.mode, Mode::Timestamped | Mode::Bracketed)
            && let Some(query) = r.timestamps.as_mut().and_then(QueryPool::take)
        {
            r.write_timestamp(query);
        }
        Ok(())
    }

    /// Submits the last of the frame and waits.
    pub(super) fn finish(&mut self) -> Result<(), Error> {
        self.check_open()?;
        self.submit(None)
    }

    /// Submits and waits; `pass` is the one behind which it waits with more of the frame to come, `None` at its end.
    fn submit(&mut self, pass: Option<usize>) -> Result<(), Error> {
        let r = &mut *self.recorder;
        if self.mode == Mode::Bracketed
            && let Some(query) = r.timestamps.as_mut().and_then(QueryPool::take)
        {
            r.write_timestamp(query);
        }
        let submitted_ms = self.started.elapsed().as_secs_f64() * 1e3;
        // Only a wait behind no pass ends the frame.
        r.commands.ends_frame = pass.is_none().then_some(r.frames);
        r.frames += u64::from(pass.is_none());
        let finished = r.commands.submit_and_wait()?;
        r.sample.frame_ms = (finished - self.started).as_secs_f64() * 1e3;
        let spans = [
            (None, Track::Host, self.recording_ms, submitted_ms),
            (pass, Track::Wait, submitted_ms, r.sample.frame_ms),
        ];
        r.sample.spans.extend(spans.map(|(pass, track, start_ms, end_ms)| Span {
            pass,
            start_ms,
            duration_ms: end_ms - start_ms,
            track,
        }));
        self.recording_ms = r.sample.frame_ms;
        match self.mode {
            Mode::Plain => Ok(()),
            Mode::Timestamped | Mode::Bracketed => r.read_timestamps(self.mode, self.started, submitted_ms),
            Mode::Counted => r.read_counts(),
        }
    }

    /// Submits what is recorded and waits for it, so that the host can read what `pass` copied; the rest of the frame is
    /// another submission.
    ///
    /// # Errors
    /// Any error of Vulkan; [`Error::Interrupted`] of a frame that [`Recorder::run_unless`] gives up.
    pub fn wait_for(&mut self, pass: &Pass) -> Result<(), Error> {
        self.check_open()?;
        self.admit(pass.info())?;
        let at = self.sample_of(pass.info());
        let waiting = Instant::now();
        // Until the rest of the frame has begun, nothing may be recorded.
        self.failed = Some(pass.info().name);
        self.submit(Some(at))?;
        let wait_ms = waiting.elapsed().as_secs_f64() * 1e3;
        *self.recorder.sample.passes[at].wait_ms.get_or_insert(0.0) += wait_ms;
        self.go_on()
    }

    /// Reserves `work` of this submission for a dispatch of `pass`: where it would hold more than `most`, what is recorded is
    /// submitted first and waited for, of which nothing is read back. A frame of hours is many submissions then, and can be
    /// given up between them. Both are invocations, or turns of their loops.
    ///
    /// # Errors
    /// Those of [`Frame::wait_for`].
    pub fn reserve_work(&mut self, pass: &Pass, work: f64, most: f64) -> Result<(), Error> {
        if self.work > 0.0 && self.work + work > most {
            self.check_open()?;
            self.admit(pass.info())?;
            if let Some(last) = self.last {
                self.part_behind(last)?;
            }
        }
        self.work += work;
        Ok(())
    }

    pub(super) fn sample_of(&mut self, info: &Arc<PassInfo>) -> usize {
        let passes = &mut self.recorder.sample.passes;
        if let Some(at) = passes.iter().position(|p| p.info.name == info.name) {
            return at;
        }
        passes.push(PassSample {
            info: info.clone(),
            calls: 0,
            recordings: 0,
            submission: self.submission,
            gpu_ms: None,
            host_ms: None,
            wait_ms: None,
            counts: None,
            work: None,
            is_overrun: false,
        });
        passes.len() - 1
    }

    /// Records a pass that draws; `body` issues its draws.
    ///
    /// # Errors
    /// [`Error::Pass`] for a draw beyond what is bound, or with other constants than declared, or none;
    /// [`Error::ReadBeforeWrite`]; [`Error::InUse`] for a resource of another unfinished frame.
    pub fn graphics(&mut self, pass: &Pass, body: impl FnOnce(&mut Draw<'_>)) -> Result<(), Error> {
        let mut body = Some(body);
        self.draw(pass, &mut |draw| {
            if let Some(body) = body.take() {
                body(draw);
            }
        })
    }

    /// As [`Frame::graphics`], compiled once and not for each body.
    fn draw(&mut self, pass: &Pass, body: &mut dyn FnMut(&mut Draw<'_>)) -> Result<(), Error> {
        let Body::Graphics { render_pass, framebuffer, extent, clears, vertices, indices, bounds, .. } =
            &pass.inner.body
        else {
            return Err(not_a(pass, "graphics"));
        };
        self.envelope(pass, &mut |device, commands| {
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
            let mut draw = Draw::new(device, commands, &pass.inner, *bounds);
            body(&mut draw);
            // SAFETY: inside the render pass begun above.
            unsafe { device.raw.cmd_end_render_pass(commands) };
            draw.finish()
        })
    }

    /// Records a pass that dispatches; `body` issues its dispatches.
    ///
    /// # Errors
    /// [`Error::Limit`] for more workgroups than the device takes; otherwise as [`Frame::graphics`].
    pub fn compute(&mut self, pass: &Pass, body: impl FnOnce(&mut Dispatch<'_>)) -> Result<(), Error> {
        let mut body = Some(body);
        self.dispatch(pass, &mut |dispatch| {
            if let Some(body) = body.take() {
                body(dispatch);
            }
        })
    }

    /// As [`Frame::compute`], compiled once and not for each body.
    fn dispatch(&mut self, pass: &Pass, body: &mut dyn FnMut(&mut Dispatch<'_>)) -> Result<(), Error> {
        let Body::Compute { workgroup, .. } = pass.inner.body else { return Err(not_a(pass, "compute")) };
        self.envelope(pass, &mut |device, commands| {
            let mut dispatch = Dispatch::new(device, commands, &pass.inner, workgroup);
            body(&mut dispatch);
            Ok((dispatch.finish()?, Fetched::default()))
        })
    }

    /// Records a copy; what the host is to read is made visible to it.
    ///
    /// # Errors
    /// [`Error::Pass`] for a copy that does not fit; [`Error::ReadBeforeWrite`]; [`Error::InUse`].
    pub fn copy(&mut self, pass: &Pass) -> Result<(), Error> {
        let Body::Copy { from, to } = &pass.inner.body else { return Err(not_a(pass, "copy")) };
        transfer::check_copy(pass.info().name, from, to)?;
        transfer::check_uses(&pass.inner.device, pass.info().name, &pass.inner.uses)?;
        self.envelope(pass, &mut |device, commands| {
            transfer::record_copy(&device.raw, commands, from, to);
            Ok((1, Fetched::default()))
        })?;
        if to.is_readback() {
            let r = &mut *self.recorder;
            // What the copy has written, and no more: nothing else may be there to be read.
            let [_, written] = transfer::copy_uses(from, to);
            r.commands.synchronise(pass.info().name, &[Use { access: Access::HostRead, ..written }])?;
        }
        Ok(())
    }

    /// Runs and times host work that the method needs. Behind the end of the frame it is run, since the caller wants its
    /// result, and counts for nothing: no pass that could hand it to the device follows.
    pub fn host<T>(&mut self, info: &Arc<PassInfo>, work: impl FnOnce() -> T) -> T {
        if self.admit(info).is_err() {
            return work();
        }
        let at = self.sample_of(info);
        let started = Instant::now();
        let result = work();
        let duration_ms = started.elapsed().as_secs_f64() * 1e3;
        let start_ms = (started - self.started).as_secs_f64() * 1e3;
        self.recorder.sample.spans.push(Span { pass: Some(at), start_ms, duration_ms, track: Track::Host });
        let sample = &mut self.recorder.sample.passes[at];
        *sample.host_ms.get_or_insert(0.0) += duration_ms;
        sample.calls += 1;
        result
    }

    /// Meets a pass, which is left out behind the end of the frame, and with it all that follow, those of its first
    /// passes included.
    ///
    /// # Errors
    /// [`Error::BeyondEnd`].
    fn admit(&mut self, info: &Arc<PassInfo>) -> Result<(), Error> {
        let passes = &self.recorder.sample.passes;
        if let End::After(count) = self.end
            && passes.len() >= count
            && !passes.iter().any(|p| p.info.name == info.name)
        {
            self.end = End::Reached;
        }
        match self.end {
            End::Reached => Err(Error::BeyondEnd { pass: info.name.into() }),
            End::Open | End::After(_) => Ok(()),
        }
    }

    /// # Errors
    /// [`Error::Pass`] after an error: what was recorded does not fit the tracked states.
    fn check_open(&self) -> Result<(), Error> {
        match self.failed {
            None => Ok(()),
            Some(name) => Err(Error::Pass {
                pass: name.into(),
                problem: "it failed earlier in this frame, which goes no further".into(),
            }),
        }
    }

    /// Submits what the pass before this one has recorded and waits for it, where passes are submitted one by one.
    fn part_from_last(&mut self, next: &Arc<PassInfo>) -> Result<(), Error> {
        let Some(at) = self.last.filter(|_| self.recorder.submits_by_pass && self.mode == Mode::Plain) else {
            return Ok(());
        };
        if self.recorder.sample.passes[at].info.name == next.name {
            return Ok(());
        }
        self.part_behind(at)
    }

    /// Submits what is recorded, up to the pass at `last`, and waits for it. The method waits for nothing here: no pass is
    /// charged for it.
    fn part_behind(&mut self, last: usize) -> Result<(), Error> {
        // Until the rest of the frame has begun, nothing may be recorded.
        self.failed = Some(self.recorder.sample.passes[last].info.name);
        self.submit(Some(last))?;
        self.go_on()
    }

    /// Begins the rest of the frame, behind a submission that was waited for, unless the frame is to be given up.
    fn go_on(&mut self) -> Result<(), Error> {
        if self.interrupted.is_some_and(|interrupted| interrupted.load(Ordering::Relaxed)) {
            return Err(Error::Interrupted);
        }
        self.submission += 1;
        self.begin()?;
        self.failed = None;
        Ok(())
    }

    fn envelope(&mut self, pass: &Pass, body: &mut PassBody<'_>) -> Result<(), Error> {
        self.check_open()?;
        self.admit(pass.info())?;
        self.part_from_last(pass.info())?;
        let is_counted = self.recorder.performance.as_ref().is_some_and(|pool| pool.counts(pass.info().name));
        if is_counted {
            self.wait_for(pass)?;
            self.recorder.begin_performance();
        }
        self.failed = Some(pass.info().name);
        self.record(pass, body)?;
        self.failed = None;
        if is_counted {
            self.recorder.end_performance();
            self.wait_for(pass)?;
        }
        Ok(())
    }

    fn record(&mut self, pass: &Pass, body: &mut PassBody<'_>) -> Result<(), Error> {
        let name = pass.info().name;
        self.recorder.commands.device.check_own(&pass.inner.device, name, name)?;
        let at = self.sample_of(pass.info());
        self.last = Some(at);
        let mode = self.mode;
        let r = &mut *self.recorder;
        r.commands.keep(pass);
        r.open_label(pass.info());
        let device = r.commands.device.clone();
        let commands = r.commands.buffer;
        for clamp in pass.inner.body.clamps() {
            let kernel = &clamp.pass.inner;
            let Body::Compute { workgroup, .. } = kernel.body else { continue };
            r.commands.synchronise(name, &kernel.uses)?;
            r.bind(kernel);
            let mut dispatch = Dispatch::new(&device, commands, kernel, workgroup);
            clamp.dispatch(&mut dispatch);
            dispatch.finish()?;
        }
        r.commands.synchronise(pass.info().name, &pass.inner.uses)?;
        r.bind(&pass.inner);
        let queries = (mode == Mode::Counted).then(|| r.begin_counters(pass, at));
        let recorded = body(&device, commands);
        if let Some(mut queries) = queries {
            queries.fetched = recorded.as_ref().map_or_else(|_| Fetched::default(), |(_, fetched)| *fetched);
            r.end_counters(queries);
        }
        r.close_label();
        r.sample.passes[at].calls += recorded?.0;
        r.sample.passes[at].recordings += 1;
        if mode == Mode::Timestamped {
            r.timestamp(at);
        }
        Ok(())
    }
}

impl Drop for Frame<'_> {
    fn drop(&mut self) {
        // Nothing to do for a frame that has finished.
        self.recorder.commands.abandon();
    }
}

fn not_a(pass: &Pass, kind: &str) -> Error {
    Error::Pass { pass: pass.info().name.into(), problem: format!("it is not a {kind} pass") }
}
