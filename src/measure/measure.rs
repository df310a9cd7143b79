//! The measured loop: warm up, wait idle, then repetitions of the same frames, plain, timestamped and bracketed in
//! turn, the papers interleaved frame by frame so that drift hits all alike, and so that of several none is always measured
//! behind the same other.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::statistics::median;
use crate::gpu::{Counts, Error, FrameSample, Mode, PassInfo, PassKind, Recorder, Span, Work};
use crate::measure::{self, Paper};

/// Frames and repetitions to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// Frames of each paper before anything counts, at least 1: the first use of a pipeline compiles it.
    pub warmup: u32,
    /// Frames in one repetition, at least 1.
    pub frames: u32,
    /// Repetitions of those frames, at least 1.
    pub repeat: u32,
    /// Repetitions go on until every paper has run plain frames for this long, in seconds.
    pub min_time_s: f64,
}

/// No run repeats its frames more often than this, however long it is asked to take.
const MOST_REPETITIONS: u32 = 10_000;

/// Spans that are kept: more are no help in a viewer, and a long run takes no more memory.
pub const MOST_SPANS: usize = 500_000;

/// A span of time with the frame that it belongs to.
#[derive(Debug, Clone, Copy)]
pub struct FrameSpan {
    /// Kind of measurement of the frame.
    pub mode: Mode,
    /// Number of the repetition, from 0.
    pub repetition: u32,
    /// Number of the frame in it, from 0.
    pub frame: u32,
    /// Start of the frame's recording in milliseconds from the start of the measurement, common to all papers.
    pub frame_start_ms: f64,
    /// The pass and its time within the frame.
    pub span: Span,
}

/// The frame whose work is counted: the one that needs no other before it.
pub const COUNTED: u32 = 0;

/// Measurements of one pass: one sample a frame, repetition after repetition.
#[derive(Debug, Clone)]
pub struct MeasuredPass {
    /// Name, section, kind and shader of the pass.
    pub info: Arc<PassInfo>,
    /// Calls in one frame.
    pub calls: u32,
    /// Index of the queue submission within the frame, from 0.
    pub submission: u32,
    /// Milliseconds between the pass's timestamps, one sample a timestamped frame; no number where they cannot be told.
    pub gpu_ms: Vec<f64>,
    /// Milliseconds of host work without waiting, one sample a frame.
    pub host_ms: Vec<f64>,
    /// Milliseconds that the host waited for the GPU, one sample a frame.
    pub wait_ms: Vec<f64>,
    /// The counted frame had more calls of it than there are counters: its work is not known.
    pub is_uncounted: bool,
    /// Those of [`gpu_ms`](Self::gpu_ms) that are of the counted frame, one sample a repetition.
    pub counted_ms: Vec<f64>,
    /// Pipeline statistics of the first frame; `None` where none were taken.
    pub counts: Option<Counts>,
    /// Bytes, samples and triangles of that frame.
    pub work: Option<Work>,
}

/// Measurements of one paper.
#[derive(Debug, Clone, Default)]
pub struct Measurement {
    /// Whole repetitions that were finished; 0 when even the first was interrupted.
    pub repeat: u32,
    /// Milliseconds of plain frames on the host's clock, one sample a frame.
    pub frame_ms: Vec<f64>,
    /// Milliseconds of host work of all passes, one sample a plain frame.
    pub host_ms: Vec<f64>,
    /// Milliseconds of the GPU in all passes, one sample a timestamped frame; no number where one of them cannot be told.
    pub gpu_ms: Vec<f64>,
    /// Milliseconds of the GPU in whole frames with their overlap, one sample a bracketed frame; no number where they cannot
    /// be told.
    pub bracket_ms: Vec<f64>,
    /// In the order of recording.
    pub passes: Vec<MeasuredPass>,
    /// Milliseconds of the first frame less the median of the plain ones, at least 0: what first use costs.
    pub first_frame_ms: f64,
    /// The spans of time in the measured frames, as long as there are fewer than [`MOST_SPANS`].
    pub spans: Vec<FrameSpan>,
    /// Frames whose spans are left out for that.
    pub frames_without_spans: u64,
}

/// Progress and interruption of the loop.
pub struct Watch<'a> {
    /// Set when the user wants no more; the frames finished so far are kept.
    pub interrupted: &'a AtomicBool,
    /// Called after every frame with the frames done and expected.
    pub progress: &'a mut dyn FnMut(u64, u64),
}

impl Watch<'_> {
    /// # Errors
    /// [`Interrupted`](measure::Error::Interrupted) once the user wants no more.
    pub fn check(&self) -> Result<(), measure::Error> {
        if self.interrupted.load(Ordering::Relaxed) { Err(measure::Error::Interrupted) } else { Ok(()) }
    }
}

/// Measures `papers`, interleaved.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn measure(
    recorder: &mut Recorder,
    papers: &mut [&mut dyn Paper],
    schedule: Schedule,
    watch: &mut Watch<'_>,
) -> Result<Vec<Measurement>, Error> {
    let mut results = vec![Measurement::default(); papers.len()];
    take_frames(recorder, papers, schedule, watch, &mut results)?;
    for result in &mut results {
        result.first_frame_ms = beyond_median_ms(result.first_frame_ms, &result.frame_ms);
    }
    Ok(results)
}

/// Time of the first frame beyond what an ordinary one takes, which is nothing where there is none.
fn beyond_median_ms(first_ms: f64, others_ms: &[f64]) -> f64 {
    (first_ms - median(others_ms).unwrap_or(0.0)).max(0.0)
}

/// The loop itself, until all is measured or the user wants no more.
fn take_frames(
    recorder: &mut Recorder,
    papers: &mut [&mut dyn Paper],
    schedule: Schedule,
    watch: &mut Watch<'_>,
    results: &mut [Measurement],
) -> Result<(), Error> {
    const MODES: [Mode; 3] = [Mode::Plain, Mode::Timestamped, Mode::Bracketed];
    let count = papers.len() as u64;
    let a_repetition = MODES.len() as u64 * u64::from(schedule.frames) * count;
    let mut expected = u64::from(schedule.warmup) * count + a_repetition * u64::from(schedule.repeat) + count;
    let mut done = 0;
    let mut tick = |expected: u64| {
        done += 1;
        (watch.progress)(done, expected.max(done));
    };
    let stopped = || watch.interrupted.load(Ordering::Relaxed);

    let origin = Instant::now();
    restart(papers)?;
    for number in 0..schedule.warmup.max(1) {
        for (paper, result) in papers.iter_mut().zip(&mut *results) {
            if stopped() {
                return Ok(());
            }
            // The counters compile nothing new, but a driver may make its timestamps' first use slow.
            let mode = if number == 0 { Mode::Plain } else { MODES[number as usize % MODES.len()] };
            let sample = recorder.run_unless(watch.interrupted, mode, |frame| paper.record(frame, number));
            let Some(sample) = finished(sample)? else { return Ok(()) };
            if number == 0 {
                result.first_frame_ms = sample.frame_ms;
            }
            tick(expected);
        }
    }

    let mut repetition = 0;
    while repetition < schedule.repeat || (repetition < MOST_REPETITIONS && is_short(results, schedule.min_time_s)) {
        if repetition >= schedule.repeat {
            expected += a_repetition;
        }
        for mode in MODES {
            restart(papers)?;
            for number in 0..schedule.frames {
                for place in 0..papers.len() {
                    if stopped() {
                        return Ok(());
                    }
                    let at = turn(papers.len(), number, place);
                    let (paper, result) = (&mut papers[at], &mut results[at]);
                    let frame_start_ms = origin.elapsed().as_secs_f64() * 1e3;
                    let sample = recorder.run_unless(watch.interrupted, mode, |frame| paper.record(frame, number));
                    let Some(sample) = finished(sample)? else { return Ok(()) };
                    result.take(mode, number, sample);
                    if result.spans.len() + sample.spans.len() < MOST_SPANS {
                        let of_frame = |&span| FrameSpan { mode, repetition, frame: number, frame_start_ms, span };
                        result.spans.extend(sample.spans.iter().map(of_frame));
                    } else {
                        result.frames_without_spans += 1;
                    }
                    tick(expected);
                }
            }
        }
        repetition += 1;
        results.iter_mut().for_each(|r| r.repeat = repetition);
    }

    restart(papers)?;
    for (paper, result) in papers.iter_mut().zip(results) {
        let sample = recorder.run_unless(watch.interrupted, Mode::Counted, |frame| paper.record(frame, COUNTED));
        let Some(sample) = finished(sample)? else { return Ok(()) };
        for pass in &sample.passes {
            let measured = result.pass(pass);
            (measured.counts, measured.work) = (pass.counts, pass.work.clone());
            measured.is_uncounted = pass.is_overrun;
        }
        tick(expected);
    }
    Ok(())
}

/// Index of the paper that stands in a place of a frame of that number. Of three and more, each frame begins with the next,
/// and every other round of them runs backwards, so that none follows the same other throughout. The number alone decides:
/// in all modes and repetitions a frame of one paper stands behind the same ones.
fn turn(papers: usize, number: u32, place: usize) -> usize {
    // Of two, each follows the other; were they turned about, each would follow itself in every other frame.
    if papers < 3 {
        return place;
    }
    let number = number as usize;
    let forwards = (number + place) % papers;
    if (number / papers).is_multiple_of(2) { forwards } else { (papers - forwards) % papers }
}

/// None of a frame that was given up half-way.
fn finished(sample: Result<&FrameSample, Error>) -> Result<Option<&FrameSample>, Error> {
    match sample {
        Err(Error::Interrupted) => Ok(None),
        other => other.map(Some),
    }
}

/// Every repetition replays the same frames.
fn restart(papers: &mut [&mut dyn Paper]) -> Result<(), Error> {
    papers.iter_mut().try_for_each(|paper| paper.restart())
}

fn is_short(results: &[Measurement], min_time_s: f64) -> bool {
    results.iter().any(|r| r.frame_ms.iter().sum::<f64>() < min_time_s * 1e3)
}

impl Measurement {
    /// Milliseconds that the passes of a frame take one by one beyond what the frame takes as a whole on the GPU, the median of
    /// all frames; absent where they cannot be told.
    pub fn overlap_ms(&self) -> Option<f64> {
        let pairs = self.gpu_ms.iter().zip(&self.bracket_ms);
        median_of_told(pairs.map(|(gpu, bracket)| gpu - bracket))
    }

    /// Milliseconds of a frame that are neither GPU time nor host work of its passes, the median of all frames; absent where
    /// they cannot be told.
    pub fn unaccounted_ms(&self) -> Option<f64> {
        let frames = self.frame_ms.iter().zip(&self.gpu_ms).zip(&self.host_ms);
        median_of_told(frames.map(|((frame, gpu), host)| frame - gpu - host))
    }

    fn pass(&mut self, sample: &crate::gpu::PassSample) -> &mut MeasuredPass {
        let at = self.passes.iter().position(|p| p.info.name == sample.info.name).unwrap_or_else(|| {
            self.passes.push(MeasuredPass {
                info: sample.info.clone(),
                calls: sample.calls,
                submission: sample.submission,
                gpu_ms: Vec::new(),
                is_uncounted: false,
                host_ms: Vec::new(),
                wait_ms: Vec::new(),
                counted_ms: Vec::new(),
                counts: None,
                work: None,
            });
            self.passes.len() - 1
        });
        &mut self.passes[at]
    }

    fn take(&mut self, mode: Mode, frame: u32, sample: &FrameSample) {
        match mode {
            Mode::Plain => {
                self.frame_ms.push(sample.frame_ms);
                self.host_ms.push(sample.passes.iter().filter_map(|pass| pass.host_ms).sum());
                // Host work and waits are timed where nothing disturbs them.
                for pass in &sample.passes {
                    let measured = self.pass(pass);
                    measured.host_ms.extend(pass.host_ms);
                    measured.wait_ms.extend(pass.wait_ms);
                }
            }
            // The frames of all modes are told apart by their places: each has one.
            Mode::Bracketed => self.bracket_ms.push(sample.bracket_ms.unwrap_or(f64::NAN)),
            Mode::Timestamped => {
                let on_device = sample.passes.iter().filter(|pass| pass.info.kind != PassKind::Host);
                self.gpu_ms.push(on_device.map(|pass| pass.gpu_ms.unwrap_or(f64::NAN)).sum());
                for pass in &sample.passes {
                    let measured = self.pass(pass);
                    let gpu_ms = if pass.is_overrun { Some(f64::NAN) } else { pass.gpu_ms };
                    measured.gpu_ms.extend(gpu_ms);
                    measured.counted_ms.extend(gpu_ms.filter(|_| frame == COUNTED));
                }
            }
            Mode::Counted => {}
        }
    }
}

/// Median of the differences that are numbers.
fn median_of_told(differences: impl Iterator<Item = f64>) -> Option<f64> {
    median(&differences.filter(|difference| difference.is_finite()).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::gpu::PassSample;

    fn pass(name: &'static str, kind: PassKind, ms: f64) -> PassSample {
        let is_host = kind == PassKind::Host;
        PassSample {
            info: Arc::new(PassInfo { kind, ..PassInfo::clone(&PassInfo::host(name, "", &[], &[])) }),
            calls: 1,
            recordings: 1,
            submission: 0,
            gpu_ms: (!is_host).then_some(ms),
            host_ms: is_host.then_some(ms),
            wait_ms: None,
            counts: None,
            work: None,
            is_overrun: false,
        }
    }

    /// A pass of every fourth frame is no part of the others, and a frame that cannot be told moves no other from its place.
    #[test]
    fn a_frame_is_set_against_the_passes_that_it_has() {
        let mut measurement = Measurement::default();
        for mode in [Mode::Plain, Mode::Timestamped, Mode::Bracketed] {
            for frame in 0..8 {
                let mut passes = vec![pass("plan", PassKind::Host, 0.5), pass("draw", PassKind::Graphics, 2.0)];
                passes.extend((frame % 4 == 0).then(|| pass("boundary", PassKind::Compute, 8.0)));
                let gpu_ms: f64 = passes.iter().filter_map(|pass| pass.gpu_ms).sum();
                let frame_ms = gpu_ms + 0.5 + 0.25;
                let bracket_ms = (frame != 1).then_some(gpu_ms - 0.125);
                measurement.take(mode, frame, &FrameSample { frame_ms, bracket_ms, passes, spans: Vec::new() });
            }
        }
        assert_eq!(measurement.gpu_ms, [10.0, 2.0, 2.0, 2.0, 10.0, 2.0, 2.0, 2.0]);
        assert_eq!(measurement.host_ms, [0.5; 8]);
        assert_eq!(measurement.overlap_ms(), Some(0.125));
        assert_eq!(measurement.unaccounted_ms(), Some(0.25));
    }

    #[test]
    fn without_timestamps_neither_is_told() {
        let mut measurement = Measurement::default();
        for mode in [Mode::Plain, Mode::Timestamped, Mode::Bracketed] {
            let passes = vec![PassSample { gpu_ms: None, ..pass("draw", PassKind::Graphics, 2.0) }];
            measurement.take(mode, 0, &FrameSample { frame_ms: 3.0, bracket_ms: None, passes, spans: Vec::new() });
        }
        assert_eq!((measurement.overlap_ms(), measurement.unaccounted_ms()), (None, None));
        assert_eq!(measurement.frame_ms, [3.0]);
    }

    #[test]
    fn first_use_costs_what_an_ordinary_frame_does_not() {
        assert_eq!(beyond_median_ms(90.0, &[20.0, 40.0, 30.0]), 60.0);
        assert_eq!(beyond_median_ms(10.0, &[20.0, 40.0, 30.0]), 0.0);
        assert_eq!(beyond_median_ms(90.0, &[]), 90.0);
    }

    #[test]
    fn papers_change_their_places_from_frame_to_frame() {
        for papers in 1..=6 {
            let frame = |number: u32| (0..papers).map(move |place| turn(papers, number, place));
            let order: Vec<usize> = (0..4 * papers as u32).flat_map(frame).collect();
            for frame in order.chunks(papers) {
                let all: BTreeSet<usize> = frame.iter().copied().collect();
                assert_eq!(all, (0..papers).collect::<BTreeSet<_>>(), "{papers}: each once");
            }
            assert_eq!(order[..papers], (0..papers).collect::<Vec<_>>(), "the first frame is in the order of naming");
            for paper in 0..papers {
                let pairs = order.windows(2).filter(|pair| pair[1] == paper);
                let before: BTreeSet<usize> = pairs.map(|pair| pair[0]).collect();
                assert!(papers == 1 || !before.contains(&paper), "{paper} of {papers} follows itself");
                assert!(papers < 3 || before.len() > 1, "{paper} of {papers} follows {before:?} alone");
            }
        }
    }
}
