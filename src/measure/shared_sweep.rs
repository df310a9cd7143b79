//! Sweeps that several processes share: each measures its points and leaves a record of them, and the experiment is
//! published from the record of all.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::bench::inputs;
use super::compare::difference_of_machines;
use super::error::Error;
use super::experiment::{Context, json_text};
use super::machine::Machine;
use super::shard::Shard;
use super::study::Study;
use super::sweep::{Point, Row, Swept};
use crate::content;
use crate::report::record::{Environment, Run, Share};
use crate::report::{Record, environment, json as reader};

/// Measurements of several processes, put together by `fumarole assemble`.
pub struct Assembled {
    path: PathBuf,
    environment: Environment,
    runs: Vec<Run>,
    share: Share,
}

impl Assembled {
    /// Reads it.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is no record, of one process, or of a part alone.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let failed = |reason: &str| assembled_error(path, reason);
        let Record { environment, runs, share, .. } = reader::read(path).map_err(|e| failed(&e.to_string()))?;
        let share = share.ok_or_else(|| failed("it is of one process; name what `fumarole assemble` has written"))?;
        if share.shard.is_some() {
            return Err(failed("it is one part alone; put all together with `fumarole assemble`"));
        }
        Ok(Assembled { path: path.into(), environment, runs, share })
    }
}

fn assembled_error(path: &Path, reason: &str) -> Error {
    Error::Input(format!("`assembled` {}: {reason}", path.display()))
}

impl<S: Study> Context<'_, S> {
    /// Measures the shard's points, dealt out one by one, unless it has done so before. What it gives ends the experiment.
    ///
    /// # Errors
    /// As [`Context::measure`]; a part that was ended before its last point is none.
    pub(super) fn part(&self, machine: &mut Machine, points: &[&Point<S>], shard: Shard) -> Result<Error, Error> {
        let (path, identity) = (self.json_file(), self.identity()?);
        let of_shard = Some([shard.number, shard.count]);
        let is_same = |share: &Share| share.identity == identity && share.shard == of_shard;
        if reader::read(&path).is_ok_and(|record| record.share.as_ref().is_some_and(is_same)) {
            self.console.say("nothing to measure: this part is finished");
            return Ok(Error::Shared);
        }
        let own: Vec<(u32, &Point<S>)> =
            (0..).zip(points.iter().copied()).filter(|(number, _)| shard.has(*number as usize)).collect();
        let rows = match own.is_empty() {
            // More processes than there are points.
            true => Vec::new(),
            false => {
                let swept = self.measure(machine, &own.iter().map(|(_, point)| *point).collect::<Vec<_>>())?;
                if let Some(error) = swept.stopped {
                    return Err(error);
                }
                swept.rows
            }
        };
        let rows_of = |point: &Point<S>| point.variants.len() + point.left_out.len();
        let items: Vec<u32> =
            own.iter().flat_map(|(number, point)| std::iter::repeat_n(*number, rows_of(point))).collect();
        if items.len() != rows.len() {
            return Err(Error::Interrupted);
        }
        let mut record =
            Record::new(machine.environment(), environment::command(), rows.into_iter().map(|row| row.run).collect());
        for warning in record.runs.iter_mut().flat_map(|run| &mut run.warnings) {
            *warning = self.console.spell(warning);
        }
        record.share = Some(Share { identity, shard: of_shard, items });
        machine.check_validation()?;
        self.save(&path, json_text(&record)?.as_bytes())?;
        Ok(Error::Shared)
    }

    /// The rows of the points as other processes have measured them.
    ///
    /// # Errors
    /// [`Error::Input`] for a record of another sweep or of another machine.
    pub(super) fn of_parts(
        &self,
        machine: &Machine,
        points: &[&Point<S>],
        assembled: &Assembled,
    ) -> Result<Swept, Error> {
        let Assembled { path, environment, runs, share } = assembled;
        let failed = |reason: &str| assembled_error(path, reason);
        if share.identity != self.identity()? {
            return Err(failed("its points were measured with other options or files; give the same ones"));
        }
        if let Some([what, here, there]) = difference_of_machines(&machine.environment(), environment) {
            return Err(failed(&format!(
                "its {what} is {there}, and here {here}; publish it on a machine of that kind"
            )));
        }
        let row = |(run, item): (&Run, &u32)| {
            let point = points.get(*item as usize)?;
            Some(Row { label: point.label.clone(), x: point.x, run: run.clone() })
        };
        let items = &share.items;
        let is_whole = runs.len() == items.len() && items.is_sorted() && !items.is_empty();
        let rows: Option<Vec<Row>> = runs.iter().zip(items).map(row).collect();
        let rows = rows.filter(|_| is_whole);
        Ok(Swept { rows: rows.ok_or_else(|| failed("its runs are not those of the points"))?, stopped: None })
    }

    /// SHA-256 of everything that fixes the sweep's points and how they are measured, but the machine.
    fn identity(&self) -> Result<String, Error> {
        let schedule = self.schedule();
        let parameters: Vec<(&str, String)> =
            S::parameters().iter().map(|parameter| (parameter.name, parameter.text(&self.setup))).collect();
        let options: Vec<(&str, String)> =
            S::options().iter().map(|option| (option.name, option.text(&self.options))).collect();
        let given: Vec<&str> = parameters.iter().map(|(name, _)| *name).filter(|name| self.given.has(name)).collect();
        let files: Vec<String> = inputs(&self.setup)?.into_iter().map(|input| input.sha256).collect();
        let fixed = json!([
            S::PAPER,
            self.name,
            parameters,
            options,
            given,
            files,
            [schedule.warmup, schedule.frames, schedule.repeat],
            schedule.min_time_s,
            self.machine.validate,
            self.machine.compiler.to_string(),
            self.machine.shaders_sha256()?,
        ]);
        Ok(content::sha256(fixed.to_string().as_bytes()))
    }
}
