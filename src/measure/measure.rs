//! The measured loop: warm up, wait idle, then repetitions of the same frames, plain, timestamped and bracketed in
//! turn, the papers interleaved frame by frame so that drift hits all alike. Of three and more the order changes from round to
//! round, and goes on changing from repetition to repetition, so that over some rounds none stands behind the same other alone.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::statistics::median;
use crate::gpu::{Counts, Error, FrameSample, Mode, PassInfo, PassKind, PassSample, Recorder, Span, Work};
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
    /// The pass, as an index into [`Measurement::passes`], and its time within the frame.
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
    /// Milliseconds of the first frame less the median of the plain ones of its number, at least 0: what first use costs.
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
        result.first_frame_ms = first_use_ms(result.first_frame_ms, &result.frame_ms, schedule.frames);
    }
    Ok(results)
}

/// Time of the first frame beyond what the plain frames of its number take, of `frames` in each repetition; all of it where
/// there are none. Later frames may do other work than the first.
fn first_use_ms(first_ms: f64, plain_ms: &[f64], frames: u32) -> f64 {
    let same: Vec<f64> = plain_ms.iter().copied().step_by(frames.max(1) as usize).collect();
    (first_ms - median(&same).unwrap_or(0.0)).max(0.0)
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
                let round = u64::from(repetition) * u64::from(schedule.frames) + u64::from(number);
                for place in 0..papers.len() {
                    if stopped() {
                        return Ok(());
                    }
                    let at = turn(papers.len(), round, place);
                    let (paper, result) = (&mut papers[at], &mut results[at]);
                    let frame_start_ms = origin.elapsed().as_secs_f64() * 1e3;
                    let sample = recorder.run_unless(watch.interrupted, mode, |frame| paper.record(frame, number));
                    let Some(sample) = finished(sample)? else { return Ok(()) };
                    result.take(mode, number, sample);
                    let of_frame = |span| FrameSpan { mode, repetition, frame: number, frame_start_ms, span };
                    result.take_spans(sample, of_frame);
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

/// Index of the paper that stands in a place of a round, which is a frame of every paper; rounds are numbered through all
/// repetitions, and the same in all modes, whose frames are set against each other.
///
/// Of three and more, the first round goes from side to side, as 0, 1, 4, 2, 3, and each round has the next paper for every one
/// of the round before: the steps from place to place differ, so that a paper that moves on comes behind another one. An odd
/// number has only half of all steps, and runs backwards in odd rounds for the other half. Over as many rounds as there are
/// papers, twice as many of an odd number, each has been behind each other one equally often within a round (Williams, 1949).
fn turn(papers: usize, round: u64, place: usize) -> usize {
    // Of two, each follows the other; were they turned about, each would follow itself in every other round.
    if papers < 3 {
        return place;
    }
    let is_backwards = !papers.is_multiple_of(2) && !round.is_multiple_of(2);
    let place = if is_backwards { papers - 1 - place } else { place };
    let from_side_to_side = if place.is_multiple_of(2) { papers - place / 2 } else { place.div_ceil(2) };
    ((round % papers as u64) as usize + from_side_to_side) % papers
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

    fn pass(&mut self, sample: &PassSample) -> &mut MeasuredPass {
        let place = self.place(sample);
        &mut self.passes[place]
    }

    /// Index of the pass among those of all frames, to which it is added where it is new.
    fn place(&mut self, sample: &PassSample) -> usize {
        self.passes.iter().position(|p| p.info.name == sample.info.name).unwrap_or_else(|| {
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
        })
    }

    /// Keeps the spans of a frame, if there is room for all of them.
    fn take_spans(&mut self, sample: &FrameSample, of_frame: impl Fn(Span) -> FrameSpan) {
        if self.spans.len() + sample.spans.len() >= MOST_SPANS {
            self.frames_without_spans += 1;
            return;
        }
        // Frames may differ in their passes: one stands elsewhere among all than among those of its frame.
        let places: Vec<usize> = sample.passes.iter().map(|pass| self.place(pass)).collect();
        let placed = |span: &Span| of_frame(Span { pass: span.pass.map(|pass| places[pass]), ..*span });
        self.spans.extend(sample.spans.iter().map(placed));
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
    use crate::gpu::Track;

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

    /// A pass of the first frame alone comes before the others, whose first place in their frames is another among all.
    #[test]
    fn spans_name_the_passes_of_their_own_frames() {
        let mut measurement = Measurement::default();
        for frame in 0..2 {
            let mut passes = vec![pass("plan", PassKind::Host, 0.5), pass("draw", PassKind::Graphics, 2.0)];
            if frame == 0 {
                passes.insert(0, pass("boundary", PassKind::Compute, 8.0));
            }
            let of_pass = |pass| Span { pass, start_ms: 0.0, duration_ms: 1.0, track: Track::Gpu };
            let spans = (0..passes.len()).map(Some).chain([None]).map(of_pass).collect();
            let sample = FrameSample { frame_ms: 9.0, bracket_ms: None, passes, spans };
            measurement.take(Mode::Timestamped, frame, &sample);
            let of_frame =
                |span| FrameSpan { mode: Mode::Timestamped, repetition: 0, frame, frame_start_ms: 0.0, span };
            measurement.take_spans(&sample, of_frame);
        }
        let name = |span: &FrameSpan| Some(measurement.passes[span.span.pass?].info.name);
        let names: Vec<_> = measurement.spans.iter().map(name).collect();
        let expected = [Some("boundary"), Some("plan"), Some("draw"), None, Some("plan"), Some("draw"), None];
        assert_eq!(names, expected);
    }

    #[test]
    fn first_use_costs_what_the_same_frame_does_not_cost_again() {
        assert_eq!(first_use_ms(90.0, &[20.0, 40.0, 30.0], 1), 60.0);
        assert_eq!(first_use_ms(10.0, &[20.0, 40.0, 30.0], 1), 0.0);
        assert_eq!(first_use_ms(90.0, &[], 2), 90.0);
        // Frames that grow, and a repetition that ends half-way.
        assert_eq!(first_use_ms(90.0, &[20.0, 70.0, 200.0, 30.0, 80.0, 300.0, 40.0], 3), 60.0);
    }

    /// As the loop takes them: in every repetition each mode has the same rounds.
    #[test]
    fn none_stands_behind_the_same_other_alone() {
        for (papers, frames) in (3..=9).flat_map(|papers| (1..=3).map(move |frames| (papers, frames))) {
            let case = format!("{papers} papers, {frames} frames");
            let rounds = (0..3).flat_map(|repetition| (0..frames).map(move |number| repetition * frames + number));
            let rounds: Vec<Vec<usize>> =
                rounds.map(|round| (0..papers).map(|place| turn(papers, round, place)).collect()).collect();
            for round in &rounds {
                let all: BTreeSet<usize> = round.iter().copied().collect();
                assert_eq!(all, (0..papers).collect::<BTreeSet<_>>(), "{case}: each once");
            }
            let modes = rounds.chunks(frames as usize).flat_map(|repetition| repetition.concat().repeat(3));
            let order: Vec<usize> = modes.collect();
            for paper in 0..papers {
                let pairs = order.windows(2).filter(|pair| pair[1] == paper && pair[0] != paper);
                let before: BTreeSet<usize> = pairs.map(|pair| pair[0]).collect();
                assert!(before.len() > 1, "{case}: {paper} follows {before:?} alone");
            }
        }
    }

    #[test]
    fn each_stands_behind_each_other_one_equally_often() {
        for papers in 1..=9 {
            let count = if papers % 2 == 1 { 2 * papers } else { papers };
            let rounds: Vec<Vec<usize>> =
                (0..count as u64).map(|round| (0..papers).map(|place| turn(papers, round, place)).collect()).collect();
            assert_eq!(turn(papers, 0, 0), 0, "the first round begins with the first");
            let order = rounds.concat();
            assert!(papers == 1 || order.windows(2).all(|pair| pair[0] != pair[1]), "{papers}: one follows itself");
            if papers < 3 {
                continue;
            }
            for pair in (0..papers * papers).map(|at| [at / papers, at % papers]).filter(|pair| pair[0] != pair[1]) {
                let times = rounds.iter().flat_map(|round| round.windows(2)).filter(|two| *two == pair).count();
                assert_eq!(times, count / papers, "{pair:?} of {papers}");
            }
        }
    }
}
