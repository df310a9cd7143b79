//! A paper's experiments: one table or figure each, ours beside the paper's, with what they run in.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::bench::load;
use super::error::Error;
use super::limits;
use super::machine::{Drawn, Machine, MachineOptions};
use super::measure::{Schedule, Watch};
use super::parameter::Given;
use super::result_table::ResultTable;
use super::shard::Shard;
use super::shared_sweep::Assembled;
use super::study::{Preset, Study};
use super::sweep::{Plan, Point, Row, Swept};
use crate::file::{check_writable, destination, write};
use crate::gpu::Instance;
use crate::image::{self, Raster, Rgba8};
use crate::report::plot::PlotError;
use crate::report::record::Run;
use crate::report::table::Style;
use crate::report::tables::{self, Tables};
use crate::report::{Record, console, csv, environment, json as writer};

/// One table or figure of a paper.
pub struct Experiment<S: Study> {
    /// The paper's own name for it: `5-1`.
    pub name: &'static str,
    /// One line for help and lists.
    pub help: &'static str,
    /// Names among [`Study::options`] that it heeds; the others are refused.
    pub options: &'static [&'static str],
    /// Names of parameters and options that it does not heed, each with the reason. Names in backticks are options.
    pub refuses: &'static [(&'static str, &'static str)],
    /// Reproduces it.
    pub run: fn(&mut Context<'_, S>) -> Result<(), Error>,
}

/// A table beside an experiment's runs, and its name at the end of its files' names.
pub type NamedTable = (&'static str, ResultTable);

/// Output of an experiment to the user, while it runs and after it.
pub trait Console {
    /// Prints on standard output.
    ///
    /// # Errors
    /// [`Error::Input`] for a standard output that cannot be written.
    fn print(&self, text: &str) -> Result<(), Error>;

    /// Prints a line on standard error, unless the user wants quiet.
    fn say(&self, line: &str);

    /// Decoration of text on standard output.
    fn style(&self) -> Style;

    /// Runs measured work under a progress bar.
    fn watch(&self, title: &str, work: &mut dyn FnMut(&mut Watch<'_>));

    /// A message with its parameters named as the user names them.
    fn spell(&self, message: &str) -> String;
}

/// Files that results go to.
#[derive(Debug, Clone)]
pub struct Destinations {
    /// Folder of all files that have no name of their own.
    pub folder: PathBuf,
    /// The record; `-` is standard output, which then holds nothing else.
    pub json: Option<PathBuf>,
    /// The record's rows.
    pub csv: Option<PathBuf>,
    /// True when only errors are said on standard error.
    pub is_quiet: bool,
}

/// Frames, repetitions and limits as they were asked for.
#[derive(Debug, Clone, Copy)]
pub struct MeasureOptions {
    /// Frames before anything counts.
    pub warmup: u32,
    /// Frames in one repetition, at least 1; `None` for the experiment's own number.
    pub frames: Option<u32>,
    /// Repetitions, at least 1; `None` for the experiment's own number.
    pub repeat: Option<u32>,
    /// Seconds of plain frames to reach, 0 to 3600.
    pub min_time_s: f64,
    /// Measure the device's own limits first.
    pub has_limits: bool,
}

impl MeasureOptions {
    /// The schedule asked for, with `frames` and `repeat` for numbers that were not given.
    pub fn schedule(&self, (frames, repeat): (u32, u32)) -> Schedule {
        Schedule {
            warmup: self.warmup,
            frames: self.frames.unwrap_or(frames),
            repeat: self.repeat.unwrap_or(repeat),
            min_time_s: self.min_time_s,
        }
    }
}

/// An experiment that runs: what a user set up, and where its results go.
pub struct Context<'a, S: Study> {
    /// [`Experiment::name`].
    pub name: &'static str,
    /// The preset that was named.
    pub preset: Option<Preset<S>>,
    /// The resolved parameters.
    pub setup: S,
    /// The paper's options of experiments.
    pub options: S::Options,
    /// Names of the parameters and options that were typed.
    pub given: Given,
    /// Device and shaders that were asked for.
    pub machine: MachineOptions,
    /// Frames and repetitions that were asked for.
    pub measure: MeasureOptions,
    /// Files that were asked for.
    pub destinations: Destinations,
    /// The part of a sweep that this process measures, of several.
    pub shard: Option<Shard>,
    /// A record of all parts of the sweep, in place of measuring.
    pub assembled: Option<Assembled>,
    /// Output to the user.
    pub console: &'a dyn Console,
    /// Warnings that are still to be said.
    pub doubts: Doubts,
}

/// Warnings that an experiment has gathered; they are said once, at its end.
#[derive(Default)]
pub struct Doubts {
    of_runs: RefCell<Vec<Vec<String>>>,
    /// Of what is measured without runs.
    of_machine: RefCell<Vec<String>>,
    /// Of pictures.
    drawn: Drawn,
    /// Of the validation layer, where a machine was opened.
    instance: RefCell<Option<Arc<Instance>>>,
}

impl<S: Study> Context<'_, S> {
    /// Runs an experiment once its options and files are checked.
    ///
    /// # Errors
    /// [`Error::Input`] for an option that it does not heed, [`Error::Output`] for a file that cannot be written, what the
    /// experiment answers, and a message of the validation layer.
    pub fn run(&mut self, experiment: &Experiment<S>) -> Result<(), Error> {
        self.refuse(experiment)?;
        check_writable(&self.json_file())?;
        check_writable(&self.csv_file())?;
        // One file of the experiment's own stands for all: they go to one folder.
        check_writable(&self.file(".json"))?;
        let ended = (experiment.run)(self);
        self.say_warnings()?;
        match ended {
            Err(Error::Shared) => Ok(()),
            // Whatever an experiment has drawn, the validation layer must have had nothing to say of it.
            Ok(()) => self.doubts.instance.borrow().as_ref().map_or(Ok(()), |instance| Ok(instance.check_messages()?)),
            failed => failed,
        }
    }

    /// Prints every warning of what was published once, counted over the runs, unless standard output holds a document.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn say_warnings(&self) -> Result<(), Error> {
        let text = console::warning_lines(&self.warnings(), self.console.style());
        if text.is_empty() || self.is_json_printed() { Ok(()) } else { self.print(text) }
    }

    /// Warnings so far, each once: of the runs, or of the machine where there are none; and of pictures.
    fn warnings(&self) -> Vec<String> {
        let (of_runs, of_machine) = (self.doubts.of_runs.borrow(), self.doubts.of_machine.borrow());
        let of_machine = of_runs.is_empty().then_some(of_machine.as_slice());
        let is_told = |warning: &String| of_runs.iter().any(|run| run.contains(warning));
        let mut of_pictures: Vec<String> =
            self.doubts.drawn.warnings().iter().map(|warning| self.console.spell(warning)).collect();
        of_pictures.retain(|warning| !is_told(warning));
        let mut all = console::counted_warnings(of_runs.iter().map(Vec::as_slice).chain(of_machine));
        all.extend(console::counted_warnings([of_pictures.as_slice()]));
        all
    }

    fn refuse(&self, experiment: &Experiment<S>) -> Result<(), Error> {
        let never = [
            ("processes", "an experiment runs in one process; bench takes several"),
            ("trace", "an experiment has no trace; bench writes one"),
            ("image", "an experiment names its own pictures; render writes one"),
        ];
        let refused = never.iter().chain(experiment.refuses).find(|(name, _)| self.given.has(name));
        if let Some((name, reason)) = refused {
            return Err(Error::Input(format!("`{name}`: {reason}")));
        }
        if (self.shard.is_some() || self.assembled.is_some()) && !S::SHARED.contains(&experiment.name) {
            let (name, paper, known) = (experiment.name, S::PAPER, S::SHARED.join(", "));
            let option = if self.assembled.is_some() { "assembled" } else { "shard" };
            return Err(Error::Input(format!("`{option}`: {name} is not shared out; of {paper} these are: {known}")));
        }
        let unheeded =
            S::options().into_iter().find(|o| self.given.has(o.name) && !experiment.options.contains(&o.name));
        unheeded.map_or(Ok(()), |option| Err(Error::Input(format!("`{}`: this experiment has none", option.name))))
    }

    /// The parameters that were given, over the numbers of another set-up.
    ///
    /// # Errors
    /// As [`Study::resolve`].
    pub fn over(&self, mut setup: S) -> Result<S, Error> {
        let parameters = S::parameters();
        let given = parameters.iter().filter(|parameter| self.given.has(parameter.name));
        given.for_each(|parameter| parameter.copy(&self.setup, &mut setup));
        setup.resolve(&self.given)?;
        Ok(setup)
    }

    /// Opens the machine and says which it is.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn open(&self) -> Result<Machine, Error> {
        let mut machine = Machine::open(&self.machine, S::NEEDS)?;
        machine.drawn = self.doubts.drawn.clone();
        self.doubts.instance.replace(Some(machine.device.instance().clone()));
        self.console.say(&format!("device: {}", machine.description()));
        Ok(machine)
    }

    /// The schedule asked for, over the paper's numbers for experiments.
    pub fn schedule(&self) -> Schedule {
        self.measure.schedule(S::EXPERIMENT_FRAMES)
    }

    /// Measures the points under a progress bar, or takes them from what several processes have measured.
    ///
    /// # Errors
    /// As [`Plan::measure`]; [`Error::Shared`] where this process has measured its part of them.
    pub fn sweep(&self, machine: &mut Machine, points: &[Point<S>]) -> Result<Swept, Error> {
        let all: Vec<&Point<S>> = points.iter().collect();
        match (self.shard, &self.assembled) {
            (Some(shard), _) => Err(self.part(machine, &all, shard)?),
            (None, Some(assembled)) => self.of_parts(machine, &all, assembled),
            (None, None) => self.measure(machine, &all),
        }
    }

    /// Opens the machine and measures the points, once the scene of each has been loaded and let go: what cannot be measured is
    /// found before the first.
    ///
    /// # Errors
    /// As [`load`], [`Context::open`] and [`Context::sweep`].
    pub fn sweep_loaded(&self, points: &[Point<S>]) -> Result<(Machine, Swept), Error> {
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = self.open()?;
        let swept = self.sweep(&mut machine, points)?;
        Ok((machine, swept))
    }

    /// Measures the points under a progress bar.
    ///
    /// # Errors
    /// As [`Plan::measure`].
    pub(super) fn measure(&self, machine: &mut Machine, points: &[&Point<S>]) -> Result<Swept, Error> {
        let limits = if self.measure.has_limits { Some(limits::measure(machine)?) } else { None };
        let plan = Plan { schedule: self.schedule(), limits: limits.as_ref() };
        let mut swept = Err(Error::Interrupted);
        let title = format!("{} {}", S::PAPER, self.name);
        let mut keep = |machine: &Machine, rows: &[Row]| self.keep(machine, rows, points.len());
        self.console.watch(&title, &mut |watch| swept = plan.measure(points, machine, watch, &mut keep));
        swept
    }

    /// Writes the rows of a sweep that has begun as CSV, where the finished one will be: whatever ends it, they stay.
    fn keep(&self, machine: &Machine, rows: &[Row], points: usize) -> Result<(), Error> {
        let runs = || rows.iter().map(|row| row.run.clone()).collect();
        let record = || Record::new(machine.environment(), std::env::args().collect(), runs());
        if points < 2 { Ok(()) } else { self.keep_csv(|| csv::to_string(&record())) }
    }

    fn keep_csv(&self, text: impl FnOnce() -> String) -> Result<(), Error> {
        let path = self.csv_file();
        // The reader of a pipe would take it for all that there will be.
        if destination(&path).is_some() { Ok(write(&path, text().as_bytes())?) } else { Ok(()) }
    }

    /// A file of the experiment's own, in the folder for files that are not named.
    pub fn file(&self, suffix: &str) -> PathBuf {
        self.destinations.folder.join(format!("{}-{}{suffix}", S::PAPER, self.name))
    }

    /// Writes a file and says so.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn save(&self, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        write(path, bytes)?;
        self.wrote(path);
        Ok(())
    }

    /// Writes a picture under the experiment's name.
    ///
    /// # Errors
    /// [`Error::Image`].
    pub fn picture(&self, suffix: &str, picture: &Rgba8) -> Result<(), Error> {
        let path = self.file(suffix);
        image::write_png(&path, picture)?;
        self.wrote(&path);
        Ok(())
    }

    /// Writes a target as a drawing for viewers.
    ///
    /// # Errors
    /// [`Error::Image`].
    pub fn drawing(&self, suffix: &str, raster: &Raster) -> Result<(), Error> {
        let path = self.file(suffix);
        image::write(&path, raster)?;
        self.wrote(&path);
        Ok(())
    }

    /// Publishes runs: record, rows, plots, each with its file's suffix, and tables as files; on standard output `text`
    /// and the tables, or the record. Warnings are said at the end. Each is written even when another cannot be.
    ///
    /// # Errors
    /// [`Error::Output`], the first.
    pub fn publish_runs(
        &self,
        machine: &Machine,
        mut runs: Vec<Run>,
        mut text: String,
        plots: &[(String, String)],
        tables: &[NamedTable],
    ) -> Result<(), Error> {
        self.spell_warnings(&mut runs);
        let record = Record::new(machine.environment(), environment::command(), runs);
        let json = json_text(&record)?;
        let mut saved = self.save(&self.json_file(), json.as_bytes());
        saved = saved.and(self.save(&self.csv_file(), csv::to_string(&record).as_bytes()));
        for (suffix, svg) in plots {
            saved = saved.and(self.save(&self.file(suffix), svg.as_bytes()));
        }
        saved = saved.and(self.save_tables(machine, tables));
        let style = self.console.style();
        for (_, table) in tables {
            let space = if text.is_empty() { "" } else { "\n" };
            text.push_str(&format!("{space}{}", table.render(style)));
        }
        self.doubts.of_runs.borrow_mut().extend(record.runs.into_iter().map(|run| run.warnings));
        saved.and(self.print(if self.is_json_printed() { json } else { text }))
    }

    fn spell_warnings(&self, runs: &mut [Run]) {
        for warning in runs.iter_mut().flat_map(|run| &mut run.warnings) {
            *warning = self.console.spell(warning);
        }
    }

    /// Keeps the warnings of measured rows that a table was made of for the end.
    pub fn keep_warnings(&self, rows: Vec<Row>) {
        let mut runs: Vec<Run> = rows.into_iter().map(|row| row.run).collect();
        self.spell_warnings(&mut runs);
        self.doubts.of_runs.borrow_mut().extend(runs.into_iter().map(|run| run.warnings));
    }

    /// Writes tables beside a record: each as CSV, and all of them as one document, which the page of a report shows.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn save_tables(&self, machine: &Machine, tables: &[NamedTable]) -> Result<(), Error> {
        self.save_document(machine, tables).and(self.save_csvs(tables))
    }

    fn save_csvs(&self, tables: &[NamedTable]) -> Result<(), Error> {
        let save = |(name, table): &NamedTable| self.save(&self.file(&format!("-{name}.csv")), table.csv().as_bytes());
        tables.iter().map(save).fold(Ok(()), Result::and)
    }

    fn save_document(&self, machine: &Machine, tables: &[NamedTable]) -> Result<(), Error> {
        let Some(((_, first), more)) = tables.split_first() else { return Ok(()) };
        // The warnings stand with the runs.
        let document = self.document(machine, first, more, vec![]);
        self.save(&self.file("-tables.json"), json_text(&document)?.as_bytes())
    }

    fn document(&self, machine: &Machine, table: &ResultTable, more: &[NamedTable], warnings: Vec<String>) -> Tables {
        Tables {
            schema: tables::SCHEMA.to_owned(),
            paper: S::PAPER.to_owned(),
            experiment: self.name.to_owned(),
            environment: machine.environment(),
            command: environment::command(),
            table: table.document(),
            more: more.iter().map(|(name, table)| ((*name).to_owned(), table.document())).collect(),
            warnings,
        }
    }

    /// Publishes a table: JSON and CSV as files, and the table or the JSON on standard output.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn publish_table(&self, machine: &Machine, table: &ResultTable) -> Result<(), Error> {
        self.publish_tables(machine, table, &[])
    }

    /// The same with more tables after it, each under a name of its own in the document and at the end of its CSV file's name.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn publish_tables(&self, machine: &Machine, table: &ResultTable, more: &[NamedTable]) -> Result<(), Error> {
        let mut printed = table.render(self.console.style());
        for (_, table) in more {
            printed.push_str(&format!("\n{}", table.render(self.console.style())));
        }
        *self.doubts.of_machine.borrow_mut() = machine.warnings().iter().map(|text| self.console.spell(text)).collect();
        let text = json_text(&self.document(machine, table, more, self.warnings()))?;
        let mut saved = self.save(&self.json_file(), text.as_bytes());
        saved = saved.and(self.save(&self.csv_file(), table.csv().as_bytes())).and(self.save_csvs(more));
        saved.and(self.print(if self.is_json_printed() { text } else { printed }))
    }

    /// Publishes one more table after those that were published with the runs: its CSV file, the document of all, and the
    /// table on standard output, unless that holds a record.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn publish_more(&self, machine: &Machine, mut tables: Vec<NamedTable>, more: NamedTable) -> Result<(), Error> {
        tables.push(more);
        let Some((name, table)) = tables.last() else { return Ok(()) };
        self.save(&self.file(&format!("-{name}.csv")), table.csv().as_bytes())?;
        self.save_document(machine, &tables)?;
        if self.is_json_printed() { Ok(()) } else { self.print(format!("\n{}", table.render(self.console.style()))) }
    }

    /// Writes the rows of a table that has begun as CSV, where the finished one will be: whatever ends it, they stay.
    ///
    /// # Errors
    /// [`Error::Output`].
    pub fn keep_table(&self, table: &ResultTable) -> Result<(), Error> {
        self.keep_csv(|| table.csv())
    }

    /// Publishes a table without times and its plot.
    ///
    /// # Errors
    /// [`Error::Plot`], [`Error::Output`].
    pub fn publish_plotted(
        &self,
        machine: &Machine,
        table: &ResultTable,
        plot: Result<String, PlotError>,
    ) -> Result<(), Error> {
        self.save(&self.file(".svg"), plot?.as_bytes())?;
        self.publish_table(machine, table)
    }

    fn is_json_printed(&self) -> bool {
        self.destinations.json.as_deref().is_some_and(|path| path.as_os_str() == "-")
    }

    /// File of the record.
    pub fn json_file(&self) -> PathBuf {
        self.destinations.json.clone().filter(|_| !self.is_json_printed()).unwrap_or_else(|| self.own_file(".json"))
    }

    /// File of the record's rows.
    pub fn csv_file(&self) -> PathBuf {
        self.destinations.csv.clone().unwrap_or_else(|| self.own_file(".csv"))
    }

    /// The file of this process, which may share the folder with those of other shards.
    fn own_file(&self, ending: &str) -> PathBuf {
        let shard = self.shard.map_or_else(String::new, |shard| format!("-{shard}"));
        self.file(&format!("{shard}{ending}"))
    }

    /// Prints after the files: they are kept even when nothing can be printed.
    fn print(&self, text: String) -> Result<(), Error> {
        if self.is_json_printed() || !self.destinations.is_quiet { self.console.print(&text) } else { Ok(()) }
    }

    fn wrote(&self, path: &Path) {
        self.console.say(&format!("wrote {}", path.display()));
    }
}

/// A document as JSON text.
///
/// # Errors
/// [`Error::Input`] where it has none.
pub fn json_text(document: &impl serde::Serialize) -> Result<String, Error> {
    writer::to_string(document).map_err(|e| Error::Input(format!("writing JSON: {e}")))
}
