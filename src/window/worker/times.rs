//! Times and counters of the passes, as medians of the last frames.

use std::collections::VecDeque;

use crate::gpu::{Counts, FrameSample, Mode, PassKind, Work};
use crate::measure::floor::floor;
use crate::measure::statistics::median;
use crate::report::record::Limits;
use crate::window::protocol::{Counters, PassTimes, SideTimes};

/// Times of a side's passes.
#[derive(Default)]
pub struct Times {
    frames: Last,
    timestamped: u32,
    plain: u32,
    is_counted: bool,
    passes: Vec<Pass>,
}

#[derive(Default)]
struct Pass {
    name: String,
    gpu: Last,
    host: Last,
    wait: Last,
    counts: Option<Counts>,
    kind: Option<PassKind>,
    work: Option<Work>,
}

/// The last samples.
#[derive(Default)]
struct Last(VecDeque<f64>);

impl Last {
    fn push(&mut self, sample: f64, most: u32) {
        self.0.push_back(sample);
        while self.0.len() > most as usize {
            self.0.pop_front();
        }
    }

    fn median(&self) -> Option<f64> {
        median(&self.0.iter().copied().collect::<Vec<_>>())
    }
}

impl Times {
    /// The next mode to record a frame in, of those that still lack samples; `None` when nothing does.
    pub fn wanted(&self, samples: u32, counters: bool) -> Option<Mode> {
        if self.plain < samples && self.plain <= self.timestamped {
            Some(Mode::Plain)
        } else if self.timestamped < samples {
            Some(Mode::Timestamped)
        } else {
            (counters && !self.is_counted).then_some(Mode::Counted)
        }
    }

    /// Frames that were taken.
    pub fn taken(&self) -> u32 {
        self.plain + self.timestamped
    }

    /// The next mode of frames that go on as long as the clock plays.
    pub fn following(&self, counters: bool) -> Mode {
        match self.wanted(u32::MAX, counters) {
            Some(mode) if self.is_counted || !counters || self.plain < 2 => mode,
            _ => Mode::Counted,
        }
    }

    /// Takes the samples of a frame, of which the last `most` count.
    pub fn take(&mut self, mode: Mode, sample: &FrameSample, most: u32) {
        match mode {
            Mode::Plain => {
                self.plain += 1;
                self.frames.push(sample.frame_ms, most);
            }
            Mode::Timestamped => self.timestamped += 1,
            Mode::Counted => self.is_counted = true,
            Mode::Bracketed => {}
        }
        for measured in &sample.passes {
            let name = measured.info.name;
            let at = self.passes.iter().position(|pass| pass.name == name).unwrap_or_else(|| {
                self.passes.push(Pass { name: name.to_owned(), ..Pass::default() });
                self.passes.len() - 1
            });
            let pass = &mut self.passes[at];
            // Host work and waits are timed where nothing disturbs them.
            if mode == Mode::Plain {
                measured.host_ms.into_iter().for_each(|ms| pass.host.push(ms, most));
                measured.wait_ms.into_iter().for_each(|ms| pass.wait.push(ms, most));
            }
            if mode == Mode::Timestamped {
                measured.gpu_ms.into_iter().for_each(|ms| pass.gpu.push(ms, most));
            }
            pass.counts = measured.counts.or(pass.counts);
            pass.kind = Some(measured.info.kind);
            pass.work = measured.work.clone().or(pass.work.take());
        }
    }

    /// The medians, of the passes in the order of `names`, against the limits of the device, which may be a processor.
    pub fn told(&self, names: &[String], most: u32, limits: Option<&Limits>, is_cpu: bool) -> SideTimes {
        let own = |name: &String| {
            let Some(pass) = self.passes.iter().find(|pass| pass.name == *name) else {
                return PassTimes { name: name.clone(), ..PassTimes::default() };
            };
            let least = limits
                .zip(pass.work.as_ref())
                .zip(pass.kind)
                .and_then(|((limits, work), kind)| floor(work, &pass.counts.unwrap_or_default(), kind, limits, is_cpu));
            PassTimes {
                name: name.clone(),
                gpu_ms: pass.gpu.median(),
                host_ms: pass.host.median(),
                wait_ms: pass.wait.median(),
                fraction: None,
                counters: pass.counts.map(counters),
                floor_ms: least.as_ref().map(|least| least.ms),
                bound: least.map(|least| least.bound.to_owned()),
            }
        };
        let mut passes: Vec<PassTimes> = names.iter().map(own).collect();
        let time_ms = |pass: &PassTimes| pass.gpu_ms.unwrap_or(0.0) + pass.host_ms.unwrap_or(0.0);
        let sum_ms: f64 = passes.iter().map(time_ms).sum();
        for pass in &mut passes {
            // Before the first timestamps, host work is not all that there is.
            let is_timed = self.timestamped > 0 && pass.gpu_ms.or(pass.host_ms).is_some() && sum_ms > 0.0;
            pass.fraction = is_timed.then(|| time_ms(pass) / sum_ms);
        }
        SideTimes { samples: self.timestamped.min(most), frame_ms: self.frames.median(), passes }
    }
}

fn counters(counts: Counts) -> Counters {
    Counters {
        vertices: counts.vertices,
        primitives: counts.primitives,
        fragments: counts.fragments,
        compute_invocations: counts.compute_invocations,
        samples_passed: counts.samples_passed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_gets_its_samples_and_then_there_is_peace() {
        let mut times = Times::default();
        let mut modes = Vec::new();
        while let Some(mode) = times.wanted(2, true) {
            modes.push(mode);
            times.take(mode, &FrameSample { frame_ms: modes.len() as f64, ..FrameSample::default() }, 2);
        }
        use Mode::{Counted, Plain, Timestamped};
        assert_eq!(modes, [Plain, Timestamped, Plain, Timestamped, Counted]);
        let told = times.told(&["absent".to_owned()], 2, None, true);
        assert_eq!((told.samples, told.frame_ms, told.passes[0].gpu_ms), (2, Some(2.0), None));
        assert_eq!(Times::default().wanted(0, false), None);
        assert_eq!(Times::default().wanted(0, true), Some(Counted));
    }
}
