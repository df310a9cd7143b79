//! The steps in their order, and what stops them.

use std::collections::BTreeMap;

use super::super::shard::Shard;
use super::{Ladder, foretell};
use crate::report::stress::{Series, Step, Stop, StopKind};

/// A step that is due.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// Name of the variant.
    pub variant: String,
    /// Value of the second axis, in a matrix.
    pub across: Option<u64>,
    /// Value of the axis.
    pub value: u64,
}

/// End of a step.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    Finished(Box<Step>),
    Stopped(StopKind, String),
}

/// Whoever takes the steps: the clock, the memory and the processes of the machine.
pub trait Climber {
    type Error;

    /// Seconds since the call began.
    fn elapsed_s(&self) -> f64;

    /// Bytes of memory that a process may still take; none where the system does not tell.
    fn available_bytes(&self) -> Option<u64>;

    /// True when the user wants no more.
    fn is_interrupted(&self) -> bool;

    /// Takes a step within so many seconds.
    ///
    /// # Errors
    /// A reason why no step at all can be taken.
    fn take(&mut self, cell: &Cell, left_s: f64) -> Result<Outcome, Self::Error>;

    /// Keeps what there is so far, whatever comes.
    ///
    /// # Errors
    /// Of a record that cannot be written.
    fn keep(&mut self, series: &[Series]) -> Result<(), Self::Error>;
}

/// The series to be measured, and the budget for them.
#[derive(Debug, Clone)]
pub struct Climb {
    /// Values of the axis from step to step.
    pub ladder: Ladder,
    /// Of the second axis, in a matrix.
    pub across: Option<Ladder>,
    /// Names of the variants, each with series of its own.
    pub variants: Vec<String>,
    /// Amounts of steps are values, only rounded up: values that a step has had already are passed over.
    pub counts_values: bool,
    /// Whose series are climbed: they are dealt out one by one, those of a value of the second axis after those before it.
    pub shard: Shard,
    /// Seconds for all steps together.
    pub budget_s: f64,
}

/// Part of the free memory that a step may be foretold to take.
const MEMORY_FRACTION: f64 = 0.9;

/// A series on its way.
struct Track {
    /// Among [`Climb::variants`].
    variant: usize,
    series: Series,
    /// Values of the second axis before this one.
    row: usize,
    /// Steps so far.
    rung: usize,
    /// The next value.
    next: Option<u64>,
    /// Steps of an earlier call.
    known: BTreeMap<u64, Step>,
    /// The final stop of an earlier call.
    known_stop: Option<Stop>,
}

impl Climb {
    /// Takes every step that there is time for: the smallest of all series first, so that what ends one leaves the others
    /// their time. Steps of `known` series are not taken again; what stopped one for good stops it where it did.
    ///
    /// # Errors
    /// Those of the climber.
    pub fn run<C: Climber>(&self, climber: &mut C, known: Vec<Series>) -> Result<Vec<Series>, C::Error> {
        let mut known = known;
        let mut tracks = Vec::new();
        for variant in 0..self.variants.len() {
            tracks.extend(self.row_from(variant, 0).map(|(row, across)| self.track(variant, across, row, &mut known)));
        }
        while let Some(at) = due(&tracks) {
            if climber.is_interrupted() {
                tracks.iter_mut().filter(|track| track.series.stop.is_none()).for_each(Track::interrupt);
                break;
            }
            let (row, variant) = (tracks[at].row, tracks[at].variant);
            let of_variant = |other: &&Track| other.variant == variant;
            let below = tracks.iter().filter(of_variant).filter(|other| other.row < row).max_by_key(|other| other.row);
            let before = below.map(|below| (below.series.clone(), row - below.row));
            self.advance(&mut tracks[at], before.as_ref(), climber)?;
            let is_last = !tracks.iter().filter(of_variant).any(|other| other.row > row);
            if is_last
                && !tracks[at].series.steps.is_empty()
                && let Some((next, across)) = self.row_from(variant, row + 1)
            {
                tracks.push(self.track(variant, across, next, &mut known));
            }
            climber.keep(&all(&tracks, &known))?;
        }
        let all = all(&tracks, &known);
        climber.keep(&all)?;
        Ok(all)
    }

    /// The first row of a variant from one on that is the shard's, with its value of the second axis.
    fn row_from(&self, variant: usize, first: usize) -> Option<(usize, Option<u64>)> {
        let values: Vec<Option<u64>> = match self.across {
            None => vec![None],
            Some(ladder) => std::iter::successors(ladder.first(), |value| ladder.after(*value)).map(Some).collect(),
        };
        let is_own = |(row, _): &(usize, Option<u64>)| self.shard.has(row * self.variants.len() + variant);
        values.into_iter().enumerate().skip(first).find(is_own)
    }

    fn track(&self, number: usize, across: Option<u64>, row: usize, known: &mut Vec<Series>) -> Track {
        let variant = &self.variants[number];
        let found = known.iter().position(|series| series.variant == *variant && series.across == across);
        let found = found.map(|at| known.remove(at));
        let (steps, stop) = found.map_or_else(Default::default, |series| (series.steps, series.stop));
        Track {
            variant: number,
            series: Series { variant: variant.clone(), across, steps: Vec::new(), stop: None, costs: Vec::new() },
            row,
            rung: 0,
            next: self.ladder.first(),
            known: steps.into_iter().map(|step| (step.value, step)).collect(),
            known_stop: stop.filter(|stop| stop.kind.is_final()),
        }
    }

    /// Takes the track's next step, or finds what stops it.
    fn advance<C: Climber>(
        &self,
        track: &mut Track,
        before: Option<&(Series, usize)>,
        climber: &mut C,
    ) -> Result<(), C::Error> {
        let Some(value) = track.next else {
            let value = track.series.steps.last().map_or(self.ladder.from, |step| step.value);
            track.stop(StopKind::End, value, format!("the axis ends at {}", self.ladder.most));
            return Ok(());
        };
        let step = match track.known.remove(&value) {
            Some(step) => step,
            None => match self.take(track, before, value, climber)? {
                Ok(step) => step,
                Err(stop) => {
                    track.series.stop = Some(stop);
                    return Ok(());
                }
            },
        };
        let amount = step.amount;
        let wrong = track.series.steps.first().and_then(|first| wrong(first, &step));
        track.series.steps.push(step);
        track.rung += 1;
        track.next = if self.counts_values { self.ladder.after_above(value, amount) } else { self.ladder.after(value) };
        if let Some(reason) = wrong {
            track.stop(StopKind::Correctness, value, reason);
        }
        Ok(())
    }

    fn take<C: Climber>(
        &self,
        track: &Track,
        before: Option<&(Series, usize)>,
        value: u64,
        climber: &mut C,
    ) -> Result<Result<Step, Stop>, C::Error> {
        let stop = |kind, reason| Ok(Err(Stop { kind, value, reason }));
        if let Some(known) = track.known_stop.as_ref().filter(|stop| stop.value <= value) {
            return Ok(Err(known.clone()));
        }
        let place = |step: &Step| if self.counts_values { step.amount } else { step.value as f64 };
        let foretold = |of: fn(&Step) -> Option<f64>| {
            let own = foretell::cost(&track.series, value as f64, place, of);
            // The first of a series: as the smaller one's, in proportion.
            own.or_else(|| {
                let (series, rows) = before?;
                Some(of(series.steps.first()?)? * self.across.map_or(1.0, |across| across.factor.powi(*rows as i32)))
            })
        };
        let left_s = self.budget_s - climber.elapsed_s();
        if left_s <= 0.0 {
            return stop(StopKind::Time, format!("the budget of {} s is over", self.budget_s));
        }
        if let Some(needed_s) = foretold(|step| Some(step.wall_s)).filter(|needed_s| *needed_s > left_s) {
            return stop(
                StopKind::Time,
                format!("not begun: it would take {needed_s:.1} s, and {left_s:.1} s are left"),
            );
        }
        if let (Some(needed), Some(free)) =
            (foretold(|step| step.peak_bytes.map(|b| b as f64)), climber.available_bytes())
            && needed > MEMORY_FRACTION * free as f64
        {
            let [needed, free] = [needed, free as f64].map(|bytes| bytes / 1e6);
            return stop(
                StopKind::Memory,
                format!("not begun: it would take {needed:.0} MB, and {free:.0} MB are free"),
            );
        }
        let cell = Cell { variant: track.series.variant.clone(), across: track.series.across, value };
        Ok(match climber.take(&cell, left_s)? {
            Outcome::Finished(step) => Ok(*step),
            Outcome::Stopped(kind, reason) => Err(Stop { kind, value, reason }),
        })
    }
}

impl Track {
    fn stop(&mut self, kind: StopKind, value: u64, reason: String) {
        self.series.stop = Some(Stop { kind, value, reason });
    }

    fn interrupt(&mut self) {
        let value = self.next.unwrap_or_default();
        self.stop(StopKind::Interruption, value, "interrupted".to_owned());
    }

    /// The series with the steps of earlier calls that this one has not come to, or passes over.
    fn whole(&self) -> Series {
        let mut series = self.series.clone();
        series.steps.extend(self.known.values().cloned());
        series.steps.sort_by_key(|step| step.value);
        series
    }
}

/// The track whose step is due: the lowest, of these the one of the lowest row.
fn due(tracks: &[Track]) -> Option<usize> {
    let going = tracks.iter().enumerate().filter(|(_, track)| track.series.stop.is_none());
    going.min_by_key(|(_, track)| (track.row + track.rung, track.row)).map(|(at, _)| at)
}

/// Every series, with those of earlier calls that this one has not come to, by variant and second value.
fn all(tracks: &[Track], known: &[Series]) -> Vec<Series> {
    let mut all: Vec<Series> = tracks.iter().map(Track::whole).chain(known.iter().cloned()).collect();
    let variants: Vec<String> = all.iter().map(|series| series.variant.clone()).collect();
    all.sort_by_key(|series| (variants.iter().position(|variant| *variant == series.variant), series.across));
    all
}

/// A fault of a step that the first one did not have: numbers of a target or results that are not finite.
fn wrong(first: &Step, step: &Step) -> Option<String> {
    let target = step.not_finite.iter().find(|(name, count)| **count > 0 && !first.not_finite.contains_key(*name));
    if let Some((name, count)) = target {
        return Some(format!("{count} numbers of the target {name} are not finite"));
    }
    let lost = |(name, value): &(&String, &serde_json::Value)| {
        value.is_number() && step.run.results.get(*name).is_some_and(serde_json::Value::is_null)
    };
    first.run.results.iter().find(lost).map(|(name, _)| format!("the result {name} is no finite number"))
}

#[cfg(test)]
#[path = "climb_tests.rs"]
mod tests;
