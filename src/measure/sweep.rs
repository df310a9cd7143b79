//! Sweeps: a paper measured at several points, every point's variants interleaved.

use std::sync::atomic::Ordering;

use super::bench::{Bench, load};
use super::error::Error;
use super::machine::Machine;
use super::measure::{Schedule, Watch};
use super::study::Study;
use crate::measure::Variant;
use crate::report::record::{Limits, Memory, Run};

/// One configuration of a sweep.
pub struct Point<S: Study> {
    /// Label of its rows.
    pub label: String,
    /// Its place on the plot's axis.
    pub x: f64,
    /// The configuration.
    pub study: S,
    /// Variants to measure, at least one.
    pub variants: Vec<S::Variant>,
    /// Variants that this point leaves out, and why.
    pub left_out: Vec<(S::Variant, String)>,
}

impl<S: Study> Point<S> {
    /// A sweep of one point, in all variants.
    pub fn single(label: &str, study: S) -> Self {
        Point { label: label.to_owned(), x: 0.0, study, variants: S::Variant::ALL.to_vec(), left_out: Vec::new() }
    }
}

/// One variant at one point.
pub struct Row {
    /// [`Point::label`].
    pub label: String,
    /// [`Point::x`].
    pub x: f64,
    /// Without times where the variant was left out; a warning then says why.
    pub run: Run,
}

/// Results of a sweep.
pub struct Swept {
    /// Finished rows, point after point.
    pub rows: Vec<Row>,
    /// The error that ended it before its last point.
    pub stopped: Option<Error>,
}

/// Schedule and limits of a sweep.
pub struct Plan<'a> {
    /// Frames and repetitions at each point.
    pub schedule: Schedule,
    /// The device's own limits, where they were measured.
    pub limits: Option<&'a Limits>,
}

impl Plan<'_> {
    /// Measures the points one after the other. What fails after the first point ends the sweep, which keeps its
    /// finished rows; so does Ctrl-C. `keep` takes the rows after each point: they are there whatever ends the program.
    ///
    /// # Errors
    /// The error of the first point, and those of `keep`.
    pub fn measure<S: Study>(
        &self,
        points: &[&Point<S>],
        machine: &mut Machine,
        watch: &mut Watch<'_>,
        mut keep: impl FnMut(&Machine, &[Row]) -> Result<(), Error>,
    ) -> Result<Swept, Error> {
        let mut swept = Swept { rows: Vec::new(), stopped: None };
        let total = points.len() as u64;
        let mut finished = 0;
        for (index, point) in (0..).zip(points) {
            let progress = &mut *watch.progress;
            let mut of_all = |done: u64, expected: u64| progress(index * expected + done, total * expected);
            let mut watch = Watch { interrupted: watch.interrupted, progress: &mut of_all };
            match self.measure_point(point, machine, &mut watch) {
                Ok(rows) => {
                    finished += 1;
                    swept.rows.extend(rows);
                    keep(machine, &swept.rows)?;
                }
                Err(error) if swept.rows.is_empty() => return Err(error),
                Err(Error::Interrupted) => break,
                Err(error) => {
                    swept.stopped = Some(error);
                    break;
                }
            }
            if watch.interrupted.load(Ordering::Relaxed) {
                break;
            }
        }
        if finished < total
            && swept.stopped.is_none()
            && let Some(last) = swept.rows.last_mut()
        {
            last.run.warnings.push(format!("the sweep was interrupted after {finished} of {total} points"));
        }
        Ok(swept)
    }

    fn measure_point<S: Study>(
        &self,
        point: &Point<S>,
        machine: &mut Machine,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Row>, Error> {
        let Point { study, variants, .. } = point;
        let loaded = load(study)?;
        let bench = Bench { study, loaded: &loaded, variants, schedule: self.schedule, limits: self.limits };
        let mut runs: Vec<Run> = bench.measure(machine, watch)?.into_iter().map(|m| m.run).collect();
        if let Some(sibling) = runs.first().cloned() {
            runs.extend(point.left_out.iter().map(|(variant, reason)| left_out(&sibling, *variant, reason)));
        }
        Ok(runs.into_iter().map(|run| Row { label: point.label.clone(), x: point.x, run }).collect())
    }
}

/// The row of a variant that was not measured, in the configuration of one that was.
fn left_out(sibling: &Run, variant: impl Variant, reason: &str) -> Run {
    Run {
        variant: variant.as_str().to_owned(),
        frame_ms: None,
        passes: Vec::new(),
        overlap_ms: None,
        unaccounted_ms: None,
        pipeline_ms: None,
        memory: Memory { device_bytes: None, host_bytes: None, peak_bytes: None, by_resource: Vec::new() },
        results: serde_json::Map::new(),
        warnings: vec![format!("not measured: {reason}")],
        ..sibling.clone()
    }
}
