//! `experiment NAME`: one table or figure of the paper, ours beside the paper's.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::caustics::SceneArgs;
use super::failure::Failure;
use super::options::{MachineArgs, MeasureArgs, OutputArgs};
use super::outcome;
use super::watch::{interrupted, progress_bar};
use crate::experiment::caustics::slicing::{self, Facts};
use crate::experiment::caustics::sweep::{
    ALL_THREE, Comparison, LEVEL_MAP_AGAINST_VOLUMETRIC, NORMAL_AGAINST_SMART, Sweep,
};
use crate::experiment::caustics::{self, PAPER, Setup, mesh_name};
use crate::experiment::machine::Machine;
use crate::experiment::measure::Watch;
use crate::experiment::{self, limits, picture};
use crate::image::write_png;
use crate::papers::caustics::{NEEDS, Parameters, Variant};
use crate::report::output::check_writable;
use crate::report::plot::{BarChart, BarSeries};
use crate::report::{Record, csv};
use crate::scene::MeshSource;

/// The tables and figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Table 5-1 and figure 5-10: level map against volumetric by number of planes
    #[value(name = "5-1")]
    Table51,
    /// Table 5-2: polygons of the models
    #[value(name = "5-2")]
    Table52,
    /// Table 5-3 and figure 5-11: normal against smart slicing by number of planes
    #[value(name = "5-3")]
    Table53,
    /// Table 5-4: planes that smart slicing draws of those specified
    #[value(name = "5-4")]
    Table54,
    /// Table 5-5: Luv difference (eq. 2-9) between normal and smart slicing
    #[value(name = "5-5")]
    Table55,
    /// Section 5.1: memory of the methods by number of planes
    Memory,
    /// Figure 5-12 and the appendix's histograms: texels in each depth level
    DepthProfile,
    /// Figure 5-13: the picture by normal and by smart slicing
    #[value(name = "5-13")]
    Figure513,
    /// The appendix: three pictures, the curves and the histogram of every mesh given
    Appendix,
}

impl Name {
    /// Whether it goes through plane counts.
    fn sweeps(self) -> bool {
        !matches!(self, Name::Table52 | Name::DepthProfile | Name::Figure513)
    }

    fn word(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
    }
}

#[derive(Debug, Clone, Args)]
pub struct ExperimentArgs {
    /// Table or figure of the paper
    #[arg(value_enum, required_unless_present = "list")]
    name: Option<Name>,
    /// List the experiments
    #[arg(long)]
    list: bool,
    /// Plane counts of a sweep, comma-separated [default: 3,11,31,101]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    /// Sweep 3 to 101 planes by this step instead: 1 is the thesis's full table
    #[arg(long, value_name = "N", conflicts_with = "counts", value_parser = clap::value_parser!(u32).range(1..=98))]
    step: Option<u32>,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    measure: MeasureArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// Frames and repetitions at each point of a sweep that names none.
const FRAMES: u32 = 3;
const REPEAT: u32 = 3;

/// An experiment with its input resolved and its machine open.
struct Experiment<'a> {
    arguments: &'a ExperimentArgs,
    name: Name,
    setup: Setup,
    meshes: Vec<MeshSource>,
    counts: Vec<u32>,
    machine: Machine,
}

pub fn run(arguments: &ExperimentArgs) -> Result<(), Failure> {
    let (Some(name), false) = (arguments.name, arguments.list) else {
        let line = |name: &Name| {
            let value = name.to_possible_value()?;
            Some(format!("{:14}{}\n", value.get_name(), value.get_help().map(ToString::to_string).unwrap_or_default()))
        };
        return outcome::print(&Name::value_variants().iter().filter_map(line).collect::<String>());
    };
    refuse_unsuited(arguments, name)?;
    outcome::check(&arguments.output)?;
    // One file of the experiment's own stands for all: they go to one folder.
    check_writable(&arguments.output.out.join(format!("{PAPER}-{}.json", name.word())))?;
    let counts = match arguments.step {
        Some(step) => (3..=101).step_by(step as usize).collect(),
        None if arguments.counts.is_empty() => vec![3, 11, 31, 101],
        None => arguments.counts.clone(),
    };
    let mut setup = arguments.scene.resolve(arguments.measure.process)?;
    setup.preset = Some(name.word());
    setup.parameters.validate().map_err(crate::experiment::Error::from)?;
    let meshes = if arguments.scene.names_meshes() { setup.meshes.clone() } else { caustics::sample_meshes() };
    check_input(&setup, &meshes, &counts)?;
    let machine = Machine::open(&arguments.machine.resolve(), &NEEDS)?;
    outcome::say_device(&arguments.output, &machine);
    let mut experiment = Experiment { arguments, name, setup, meshes, counts, machine };
    experiment.run()?;
    experiment.machine.check_validation()?;
    Ok(())
}

/// Looks at every count and every mesh before anything is measured: a sweep takes long to come to the last.
fn check_input(setup: &Setup, meshes: &[MeshSource], counts: &[u32]) -> Result<(), experiment::Error> {
    for &planes in counts {
        Parameters { planes, ..setup.parameters.clone() }.validate()?;
    }
    meshes.iter().try_for_each(|mesh| Setup { meshes: vec![mesh.clone()], ..setup.clone() }.load().map(drop))
}

/// Options that other verbs know and this experiment would not heed.
fn refuse_unsuited(arguments: &ExperimentArgs, name: Name) -> Result<(), Failure> {
    let names_counts = !arguments.counts.is_empty() || arguments.step.is_some();
    let unsuited = [
        (arguments.measure.processes > 1, "--processes: an experiment runs in one process; bench takes several"),
        (arguments.output.trace.is_some(), "--trace: an experiment has no trace; bench writes one"),
        (arguments.output.image.is_some(), "--image: an experiment names its own pictures; render writes one"),
        (name.sweeps() && arguments.scene.names_planes(), "--planes: this experiment sweeps them; give --counts"),
        (!name.sweeps() && names_counts, "--counts, --step: this experiment has no sweep; give --planes"),
    ];
    match unsuited.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, message)) => Err(Failure::Input(message.to_owned())),
        None => Ok(()),
    }
}

impl Experiment<'_> {
    fn run(&mut self) -> Result<(), Failure> {
        let Experiment { setup, meshes, counts, machine, .. } = self;
        match self.name {
            Name::Table51 => self.sweep(LEVEL_MAP_AGAINST_VOLUMETRIC),
            Name::Table53 => self.sweep(NORMAL_AGAINST_SMART),
            Name::Table52 => {
                let facts = slicing::polygon_counts(setup, meshes)?;
                self.publish(&facts)
            }
            Name::Table54 => {
                let facts = slicing::actual_planes(machine, setup, meshes, counts)?;
                self.publish(&facts)
            }
            Name::Table55 => {
                self.look_plainly();
                let Experiment { setup, meshes, counts, machine, .. } = self;
                let facts = slicing::intensity_difference(machine, setup, meshes, counts)?;
                self.publish(&facts)
            }
            Name::Memory => {
                let facts = slicing::memory(machine, setup, meshes, counts)?;
                self.publish(&facts)
            }
            Name::DepthProfile => self.depth_profiles(),
            Name::Figure513 => self.picture_pairs(),
            Name::Appendix => {
                self.sweep(ALL_THREE)?;
                self.depth_profiles()?;
                self.pictures()
            }
        }
    }

    fn file(&self, suffix: &str) -> PathBuf {
        self.arguments.output.out.join(format!("{PAPER}-{}{suffix}", self.name.word()))
    }

    fn save(&self, path: &std::path::Path, bytes: &[u8]) -> Result<(), Failure> {
        outcome::save(&self.arguments.output, path, bytes)
    }

    /// Pictures that are compared show the receiver itself, not the water's surface above it.
    fn look_plainly(&mut self) {
        if !self.arguments.scene.names_camera() {
            self.setup.parameters.camera = Parameters::camera_below(self.setup.parameters.water_depth_m);
        }
    }

    fn sweep(&mut self, comparison: Comparison) -> Result<(), Failure> {
        let ExperimentArgs { output, measure, .. } = self.arguments;
        let limits = if measure.no_limits { None } else { Some(limits::measure(&mut self.machine)?) };
        let bar = progress_bar(output.quiet, &format!("{PAPER} {}", self.name.word()));
        let mut watch = Watch {
            interrupted: interrupted(),
            progress: &mut |done, expected| {
                bar.set_length(expected);
                bar.set_position(done);
            },
        };
        let sweep = Sweep {
            comparison,
            setup: self.setup.clone(),
            meshes: self.meshes.clone(),
            counts: self.counts.clone(),
            schedule: measure.schedule(FRAMES, REPEAT),
            limits,
        };
        let found = sweep.run(&mut self.machine, &mut watch)?;
        bar.finish_and_clear();
        let record = Record::new(self.machine.environment(), std::env::args().collect(), found.runs.clone());
        let text = outcome::text(&record)?;
        let shown = if output.json_to_stdout() { text.clone() } else { found.render(outcome::style()) };
        let json = output.json.clone().filter(|_| !output.json_to_stdout()).unwrap_or_else(|| self.file(".json"));
        self.save(&json, text.as_bytes())?;
        let csv_file = output.csv.clone().unwrap_or_else(|| self.file(".csv"));
        self.save(&csv_file, csv::to_string(&record).as_bytes())?;
        self.save(&self.file(".svg"), found.plot()?.as_bytes())?;
        self.print(&shown)
    }

    /// Prints the record or the table, after the files: they are kept even when nothing can be printed.
    fn print(&self, text: &str) -> Result<(), Failure> {
        let output = &self.arguments.output;
        if output.json_to_stdout() || !output.quiet { outcome::print(text) } else { Ok(()) }
    }

    /// A table without times: console, JSON and CSV.
    fn publish(&self, facts: &Facts) -> Result<(), Failure> {
        let output = &self.arguments.output;
        let document = json!({
            "experiment": self.name.word(), "environment": self.machine.environment(),
            "command": std::env::args().collect::<Vec<_>>(), "table": facts.json(),
        });
        let text = outcome::text(&document)?;
        let table = || format!("{}\n{}", facts.title, facts.table().render(outcome::style()));
        let shown = if output.json_to_stdout() { text.clone() } else { table() };
        let json = output.json.clone().filter(|_| !output.json_to_stdout()).unwrap_or_else(|| self.file(".json"));
        self.save(&json, text.as_bytes())?;
        self.save(&output.csv.clone().unwrap_or_else(|| self.file(".csv")), facts.csv().as_bytes())?;
        self.print(&shown)
    }

    fn depth_profiles(&mut self) -> Result<(), Failure> {
        let mut rows = Vec::new();
        for mesh in self.meshes.clone() {
            let setup = Setup { meshes: vec![mesh.clone()], ..self.setup.clone() };
            let scene = setup.load()?;
            let histogram = slicing::depth_profile(&mut self.machine, &setup, &scene)?;
            let name = mesh_name(&mesh);
            let levels = histogram.iter().enumerate();
            rows.extend(levels.map(|(level, texels)| vec![json!(name), json!(level + 1), json!(texels)]));
            let chart = BarChart {
                title: format!("Figure 5-12: depth profile of {name}"),
                y_label: "texels".to_owned(),
                groups: (1..=histogram.len()).map(|level| level.to_string()).collect(),
                series: vec![BarSeries {
                    name: "texels".to_owned(),
                    values: histogram.iter().map(|&texels| Some(f64::from(texels))).collect(),
                }],
            };
            self.save(
                &self.file(&format!("-{name}-profile.svg")),
                chart.to_svg().map_err(crate::experiment::Error::from)?.as_bytes(),
            )?;
        }
        if self.name == Name::DepthProfile {
            let columns = &["mesh", "level", "texels"];
            self.publish(&Facts { title: "Figure 5-12: texels in each depth level", columns, rows })?;
        }
        Ok(())
    }

    fn picture_pairs(&mut self) -> Result<(), Failure> {
        self.look_plainly();
        let mut rows = Vec::new();
        for mesh in self.meshes.clone() {
            let setup = Setup { meshes: vec![mesh.clone()], ..self.setup.clone() };
            let scene = setup.load()?;
            let pair = slicing::picture_pair(&mut self.machine, &setup, &scene)?;
            let name = mesh_name(&mesh);
            for (word, picture) in [("normal", &pair.normal), ("smart", &pair.smart)] {
                let path = self.file(&format!("-{name}-{word}.png"));
                write_png(&path, picture)?;
                outcome::wrote(&self.arguments.output, &path);
            }
            let d = pair.difference;
            rows.push(vec![json!(name), json!(d.mean), json!(d.p99), json!(d.max), json!(d.pixels)]);
        }
        let columns = &["mesh", "mean", "p99", "max", "pixels"];
        self.publish(&Facts { title: "Figure 5-13: Luv difference of the picture pair", columns, rows })
    }

    fn pictures(&mut self) -> Result<(), Failure> {
        self.look_plainly();
        for mesh in self.meshes.clone() {
            let setup = Setup { meshes: vec![mesh.clone()], ..self.setup.clone() };
            let scene = setup.load()?;
            for variant in [Variant::Volumetric, Variant::LevelMap, Variant::LevelMapSmart] {
                let mut built = caustics::build(&self.machine, &setup, &scene, variant)?;
                let rendered = picture::render(&mut self.machine, &mut built.paper, 0)?;
                let path = self.file(&format!("-{}-{}.png", mesh_name(&mesh), variant.word()));
                write_png(&path, &rendered)?;
                outcome::wrote(&self.arguments.output, &path);
            }
        }
        Ok(())
    }
}
