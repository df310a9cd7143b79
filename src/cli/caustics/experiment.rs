//! `experiment NAME`: one table or figure of the paper, ours beside the paper's.

use clap::{Args, ValueEnum};
use serde_json::json;

use super::CausticsArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::outcome;
use crate::cli::paper::PaperArgs;
use crate::measure::Variant as _;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Error, picture};
use crate::papers::caustics::experiments::slicing;
use crate::papers::caustics::experiments::sweep::{
    ALL_THREE, Comparison, LEVEL_MAP_AGAINST_VOLUMETRIC, NORMAL_AGAINST_SMART, Outcome,
};
use crate::papers::caustics::setup::{NamedMesh, Setup, sample_meshes};
use crate::papers::caustics::{Parameters, Variant};
use crate::report::plot::PlotError;
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
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
    /// Plane counts of a sweep, comma-separated [default: 3,11,31,101]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    /// Sweep 3 to 101 planes by this step instead: 1 is the thesis's full table
    #[arg(long, value_name = "N", conflicts_with = "counts", value_parser = clap::value_parser!(u32).range(1..=98))]
    step: Option<u32>,
    #[command(flatten)]
    scene: CausticsArgs,
    #[command(flatten)]
    common: CommonArgs,
}

/// An experiment with its input resolved and its machine open.
struct Experiment<'a> {
    arguments: &'a Experiments,
    name: Name,
    publication: &'a Publication<'a>,
    setup: Setup,
    meshes: Vec<MeshSource>,
    counts: Vec<u32>,
    machine: Machine,
}

impl ExperimentArgs for Experiments {
    type Study = Setup;
    type Name = Name;

    const FRAMES: u32 = 3;
    const REPEAT: u32 = 3;

    fn asked(&self) -> &NameArgs<Name> {
        &self.asked
    }

    fn common(&self) -> &CommonArgs {
        &self.common
    }

    fn unsuited(&self, name: Name) -> Vec<(bool, &'static str)> {
        let names_counts = !self.counts.is_empty() || self.step.is_some();
        vec![
            (name.sweeps() && self.scene.names_planes(), "--planes: this experiment sweeps them; give --counts"),
            (!name.sweeps() && names_counts, "--counts, --step: this experiment has no sweep; give --planes"),
        ]
    }

    fn perform(&self, name: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        let counts = match self.step {
            Some(step) => (3..=101).step_by(step as usize).collect(),
            None if self.counts.is_empty() => vec![3, 11, 31, 101],
            None => self.counts.clone(),
        };
        let mut setup = self.scene.resolve(self.common.measure.process)?;
        setup.preset = Some(publication.name.clone());
        setup.parameters.validate().map_err(Error::from)?;
        let meshes = if self.scene.names_meshes() { setup.meshes.clone() } else { sample_meshes() };
        check_input(&setup, &meshes, &counts)?;
        let machine = self.open()?;
        let mut experiment = Experiment { arguments: self, name, publication, setup, meshes, counts, machine };
        experiment.run()?;
        experiment.machine.check_validation()?;
        Ok(())
    }
}

/// Looks at every count and every mesh before anything is measured: a sweep takes long to come to the last.
fn check_input(setup: &Setup, meshes: &[MeshSource], counts: &[u32]) -> Result<(), Error> {
    for &planes in counts {
        Parameters { planes, ..setup.parameters.clone() }.validate()?;
    }
    meshes.iter().try_for_each(|mesh| Setup { meshes: vec![mesh.clone()], ..setup.clone() }.load().map(drop))
}

impl Experiment<'_> {
    fn run(&mut self) -> Result<(), Failure> {
        let Experiment { setup, meshes, counts, machine, .. } = self;
        match self.name {
            Name::Table51 => self.sweep(LEVEL_MAP_AGAINST_VOLUMETRIC),
            Name::Table53 => self.sweep(NORMAL_AGAINST_SMART),
            Name::Table52 => {
                let facts = slicing::polygon_counts(setup, meshes)?;
                let plot = facts.bars("triangles", &["triangles", "thesis"]);
                self.publish(&facts, plot)
            }
            Name::Table54 => {
                let facts = slicing::actual_planes(machine, setup, meshes, counts)?;
                let plot = facts.lines("specified", "planes drawn", &["fitted", "kept", "thesis"]);
                self.publish(&facts, plot)
            }
            Name::Table55 => {
                self.look_plainly();
                let Experiment { setup, meshes, counts, machine, .. } = self;
                let facts = slicing::intensity_difference(machine, setup, meshes, counts)?;
                let plot = facts.lines("planes", "mean Luv difference", &["fitted mean", "kept mean", "thesis"]);
                self.publish(&facts, plot)
            }
            Name::Memory => {
                let facts = slicing::memory(machine, setup, meshes, counts)?;
                let plot = facts.lines("planes", "maps, bytes", &["maps, bytes"]);
                self.publish(&facts, plot)
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

    /// A table without times, and its plot.
    fn publish(&self, facts: &ResultTable, plot: Result<String, PlotError>) -> Result<(), Failure> {
        let svg = plot.map_err(Error::from)?;
        self.publication.save(&self.publication.file(".svg"), svg.as_bytes())?;
        self.publication.facts(&self.machine, facts)
    }

    /// Pictures that are compared show the receiver itself, not the water's surface above it.
    fn look_plainly(&mut self) {
        if !self.arguments.scene.names_camera() {
            self.setup.parameters.camera = Parameters::camera_below(self.setup.parameters.water_depth_m);
        }
    }

    fn sweep(&mut self, comparison: Comparison) -> Result<(), Failure> {
        let points = comparison.points(&self.setup, &self.meshes, &self.counts);
        let swept = self.arguments.sweep(self.publication, &mut self.machine, &points)?;
        let outcome = Outcome::new(comparison, &self.meshes, swept.rows);
        let (table, plots) = (outcome.render(outcome::style()), outcome.plots()?);
        self.publication.runs(&self.machine, outcome.into_runs(), table, &plots)?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    fn depth_profiles(&mut self) -> Result<(), Failure> {
        let mut rows = Vec::new();
        for NamedMesh { source, name, .. } in NamedMesh::all(&self.meshes) {
            let setup = Setup { meshes: vec![source], ..self.setup.clone() };
            let scene = setup.load()?;
            let histogram = slicing::depth_profile(&mut self.machine, &setup, &scene)?;
            let levels = histogram.iter().enumerate();
            rows.extend(levels.map(|(level, texels)| vec![json!(name), json!(level + 1), json!(texels)]));
            let svg = slicing::profile_chart(&name, &histogram).to_svg().map_err(Error::from)?;
            self.publication.save(&self.publication.file(&format!("-{name}-profile.svg")), svg.as_bytes())?;
        }
        if self.name == Name::DepthProfile {
            let columns = &["mesh", "level", "texels"];
            self.publication.facts(
                &self.machine,
                &ResultTable { title: "Figure 5-12: texels in each depth level", columns, rows },
            )?;
        }
        Ok(())
    }

    fn picture_pairs(&mut self) -> Result<(), Failure> {
        self.look_plainly();
        let mut rows = Vec::new();
        for NamedMesh { source, name, .. } in NamedMesh::all(&self.meshes) {
            let setup = Setup { meshes: vec![source], ..self.setup.clone() };
            let scene = setup.load()?;
            let pair = slicing::picture_pair(&mut self.machine, &setup, &scene)?;
            for (word, picture) in [("normal", &pair.normal), ("smart", &pair.smart)] {
                self.publication.picture(&format!("-{name}-{word}.png"), picture)?;
            }
            let d = pair.difference;
            rows.push(vec![json!(name), json!(d.mean), json!(d.p99), json!(d.max), json!(d.pixels)]);
        }
        let columns = &["mesh", "mean", "p99", "max", "pixels"];
        let facts = ResultTable { title: "Figure 5-13: Luv difference of the picture pair", columns, rows };
        let plot = facts.bars("Luv difference", &["mean", "p99"]);
        self.publish(&facts, plot)
    }

    fn pictures(&mut self) -> Result<(), Failure> {
        self.look_plainly();
        for NamedMesh { source, name, .. } in NamedMesh::all(&self.meshes) {
            let setup = Setup { meshes: vec![source], ..self.setup.clone() };
            let scene = setup.load()?;
            for variant in [Variant::Volumetric, Variant::LevelMap, Variant::LevelMapSmart] {
                let mut built = build(&self.machine, &setup, &scene, variant)?;
                let rendered = picture::render(&mut self.machine, &mut built.paper, 0)?;
                self.publication.picture(&format!("-{}-{}.png", name, variant.as_str()), &rendered)?;
            }
        }
        Ok(())
    }
}
