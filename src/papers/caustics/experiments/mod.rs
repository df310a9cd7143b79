//! The thesis's tables and figures, with its own numbers.

mod accuracy;
mod culling;
mod drawn;
mod points;
mod ratios;
mod slicing;
mod sweep;
mod thesis;

use serde_json::json;

use self::sweep::{
    ALL_THREE, CHAPTER_6, CHAPTER_6_SMART, Comparison, LEVEL_MAP_AGAINST_VOLUMETRIC, NORMAL_AGAINST_SMART, Outcome,
};
use super::named_mesh::NamedMesh;
use super::setup::{Setup, sample_meshes};
use super::{Parameters, Variant};
use crate::field;
use crate::measure::bench::build;
use crate::measure::experiment::{Experiment, NamedTable};
use crate::measure::machine::Machine;
use crate::measure::parameter::{Parameter, Range};
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Error, Variant as _, experiment, picture};
use crate::scene::MeshSource;

type Context<'a> = experiment::Context<'a, Setup>;

/// Options of the experiments.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Plane counts of a sweep.
    counts: Vec<u32>,
    /// Step from 3 to 101 planes in place of the counts.
    step: Option<u32>,
    /// Sides of maps whose accuracy is measured.
    sizes: Vec<u32>,
    /// Photons of each half of the truth, a texel of the greatest map.
    photons: Option<u32>,
    /// Errors to be reached, percent.
    errors: Vec<u32>,
    /// Every case on every mesh.
    cross: bool,
}

const SIZES: [u32; 2] = [64, 128];
const PHOTONS: u32 = 100;

impl Options {
    fn counts(&self) -> Vec<u32> {
        match self.step {
            Some(step) => (3..=101).step_by(step.clamp(1, 98) as usize).collect(),
            None if self.counts.is_empty() => vec![3, 11, 31, 101],
            None => self.counts.clone(),
        }
    }

    fn sizes(&self) -> Vec<u32> {
        if self.sizes.is_empty() { SIZES.to_vec() } else { self.sizes.clone() }
    }

    /// Those to begin with, where none are given.
    fn photons(&self) -> u32 {
        self.photons.unwrap_or(PHOTONS)
    }

    fn has_photons(&self) -> bool {
        self.photons.is_some()
    }

    /// The errors given, of `accuracy` its own without any.
    fn errors(&self, own: &[u32]) -> Vec<u32> {
        if self.errors.is_empty() { own.to_vec() } else { self.errors.clone() }
    }
}

/// The options of the experiments.
pub fn options() -> Vec<Parameter<Options>> {
    vec![
        Parameter::new("counts", field!(Options.counts))
            .placeholder("N,N,..")
            .range(Range::from(1.0).to(4096.0))
            .help("Plane counts of a sweep, comma-separated")
            .default_text("3,11,31,101"),
        Parameter::new("step", field!(Options.step))
            .range(Range::from(1.0).to(98.0))
            .help("Sweep 3 to 101 planes by this step instead: 1 is the thesis's full table")
            .excludes(&["counts"]),
        Parameter::new("sizes", field!(Options.sizes))
            .placeholder("N,N,..")
            .range(Range::from(1.0))
            .unit("texels a side")
            .help("Sizes of maps whose accuracy is measured, comma-separated; each divides the greatest")
            .default_text("64,128"),
        Parameter::new("photons", field!(Options.photons))
            .range(Range::from(1.0).to(f64::from(accuracy::MOST_PHOTONS)))
            .help("Photons of each half of the truth for a texel of the greatest map")
            .default_text("100, and more until the halves correlate 0.999"),
        Parameter::new("errors", field!(Options.errors))
            .placeholder("N,N,..")
            .range(Range::from(1.0).to(1000.0))
            .unit("percent of the mean light")
            .help(
                "Errors (`rms seen` of accuracy) to which the smallest map and plane count are sought, comma-separated",
            )
            .default_text("20,10,5,2; of 6.1 and 6.3 none"),
        Parameter::new("cross", field!(Options.cross))
            .help("Every light and water on every mesh, not on the first alone"),
    ]
}

/// Options of the experiments of chapter 6; with errors they seek the smallest map and plane count that reaches each.
const CHAPTER_6_OPTIONS: &[&str] = &["counts", "step", "sizes", "photons", "errors"];
const SWEPT: (&str, &str) = ("planes", "this experiment sweeps them; give `counts`");

/// Every experiment, in the thesis's order.
pub fn all() -> Vec<Experiment<Setup>> {
    let sweep = |name, help, run| Experiment {
        name,
        help,
        options: &["counts", "step"],
        refuses: &[("planes", "this experiment sweeps them; give `counts`")],
        run,
    };
    let single = |name, help, run| Experiment {
        name,
        help,
        options: &[],
        refuses: &[
            ("counts", "this experiment has no sweep; give `planes`"),
            ("step", "this experiment has no sweep; give `planes`"),
        ],
        run,
    };
    vec![
        sweep("5-1", "Table 5-1 and figure 5-10: level map against volumetric by number of planes", |context| {
            compare(context, LEVEL_MAP_AGAINST_VOLUMETRIC).map(drop)
        }),
        single("5-2", "Table 5-2: polygons of the models", polygons),
        sweep("5-3", "Table 5-3 and figure 5-11: normal against smart slicing by number of planes", |context| {
            compare(context, NORMAL_AGAINST_SMART).map(drop)
        }),
        sweep("5-4", "Table 5-4: planes that smart slicing draws of those specified", planes),
        sweep("5-5", "Table 5-5: Luv difference (eq. 2-9) between normal and smart slicing", differences),
        sweep("memory", "Section 5.1: memory of the methods by number of planes", memory),
        single("depth-profile", "Figure 5-12 and the appendix's histograms: texels in each depth level", |context| {
            let (meshes, mut machine) = open(context)?;
            let columns = &["mesh", "level", "texels"];
            let rows = depth_profiles(context, &mut machine, &meshes)?;
            let table = ResultTable { title: "Figure 5-12: texels in each depth level", columns, rows };
            context.publish_table(&machine, &table)
        }),
        single("5-13", "Figure 5-13: the picture by normal and by smart slicing", picture_pairs),
        Experiment {
            name: "6.1",
            help: "Section 6.1: what each step of culling drops, and what it costs, by number of planes",
            options: CHAPTER_6_OPTIONS,
            refuses: &[SWEPT, ("cull", "this experiment measures every choice")],
            run: culling::run,
        },
        Experiment {
            refuses: &[
                SWEPT,
                ("planes-within", "this experiment sets it by each receiver's distance"),
                ("smart", "the planes of smart slicing do not go by the distance"),
            ],
            ..sweep(
                "6.1-far",
                "Section 6.1: Luv difference of fewer planes for receivers that are far away",
                fewer_planes,
            )
        },
        Experiment {
            name: "6.3",
            help: "Sections 6.1 and 6.3: level map against culled and hit by number of planes",
            options: CHAPTER_6_OPTIONS,
            refuses: &[SWEPT],
            run: |context| {
                let comparison = if context.setup.parameters.culled_smart { CHAPTER_6_SMART } else { CHAPTER_6 };
                let Compared { meshes, mut machine, tables } = compare(context, comparison)?;
                let smallest = accuracy::smallest(context, &mut machine, &meshes, &comparison.variants())?;
                smallest.map_or(Ok(()), |table| context.publish_more(&machine, tables, ("smallest", table)))
            },
        },
        Experiment {
            name: "accuracy",
            help: "Every method's maps against photons in double precision, beside their time",
            options: &["counts", "step", "sizes", "photons", "errors", "cross"],
            refuses: &[
                ("planes", "this experiment sweeps them; give `counts`"),
                ("map-size", "this experiment sweeps it; give `sizes`"),
                ("coverage", "this experiment measures with it and without"),
                ("intensity", "this experiment measures both"),
            ],
            run: accuracy::run,
        },
        sweep("appendix", "The appendix: three pictures, the curves and the histogram of every mesh given", appendix),
    ]
}

/// The meshes that were named or the thesis's, after a look at every one and every count, and the machine: a sweep takes
/// long to come to the last.
fn open(context: &Context<'_>) -> Result<(Vec<MeshSource>, Machine), Error> {
    let setup = &context.setup;
    let meshes = if context.given.has("mesh") { setup.meshes.clone() } else { sample_meshes() };
    for planes in context.options.counts() {
        Parameters { planes, ..setup.parameters.clone() }.validate()?;
    }
    meshes.iter().try_for_each(|mesh| Setup { meshes: vec![mesh.clone()], ..setup.clone() }.load().map(drop))?;
    Ok((meshes, context.open()?))
}

/// Pictures that are compared show the receiver itself, not the water's surface above it.
fn look_from_below(context: &mut Context<'_>) {
    if !context.given.has("camera") {
        context.setup.parameters.camera = Parameters::camera_below(context.setup.parameters.water_depth_m);
    }
}

/// The meshes that methods were compared on, and the tables that are published.
struct Compared {
    meshes: Vec<MeshSource>,
    machine: Machine,
    tables: Vec<NamedTable>,
}

fn compare(context: &mut Context<'_>, comparison: Comparison) -> Result<Compared, Error> {
    let (meshes, mut machine) = open(context)?;
    let points = comparison.points(&context.setup, &meshes, &context.options.counts());
    let swept = context.sweep(&mut machine, &points)?;
    let outcome = Outcome::new(comparison, &meshes, swept.rows);
    let (text, plots, tables) = (outcome.render(context.console.style()), outcome.plots()?, outcome.tables());
    context.publish_runs(&machine, outcome.into_runs(), text, &plots, &tables)?;
    swept.stopped.map_or(Ok(Compared { meshes, machine, tables }), Err)
}

fn polygons(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, machine) = open(context)?;
    let table = slicing::polygon_counts(&context.setup, &meshes)?;
    context.publish_plotted(&machine, &table, table.bars("triangles", &["triangles", "thesis"]))
}

fn planes(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    let plot = |table: &ResultTable| table.lines("specified", "planes drawn", &["fitted", "kept", "thesis"]);
    points::publish(context, &mut machine, &meshes, slicing::ACTUAL_PLANES, slicing::actual_planes, plot)
}

fn differences(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    look_from_below(context);
    let plot =
        |table: &ResultTable| table.lines("planes", "mean Luv difference", &["fitted mean", "kept mean", "thesis"]);
    points::publish(context, &mut machine, &meshes, slicing::INTENSITY_DIFFERENCE, slicing::intensity_difference, plot)
}

fn fewer_planes(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    look_from_below(context);
    let plot = |table: &ResultTable| table.lines("planes drawn", "mean Luv difference", &["mean", "p99"]);
    points::publish(context, &mut machine, &meshes, slicing::FEWER_PLANES, slicing::fewer_planes, plot)
}

fn memory(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    let plot = |table: &ResultTable| table.lines("planes", "maps, bytes", &["maps, bytes"]);
    points::publish(context, &mut machine, &meshes, slicing::MEMORY, slicing::memory, plot)
}

/// The histogram of each mesh as a plot; rows of mesh, level and texels.
fn depth_profiles(
    context: &Context<'_>,
    machine: &mut Machine,
    meshes: &[MeshSource],
) -> Result<Vec<Vec<serde_json::Value>>, Error> {
    let mut rows = Vec::new();
    for NamedMesh { source, name, .. } in NamedMesh::all(meshes) {
        let setup = Setup { meshes: vec![source], ..context.setup.clone() };
        let scene = setup.load()?;
        let histogram = slicing::depth_profile(machine, &setup, &scene)?;
        let levels = histogram.iter().enumerate();
        rows.extend(levels.map(|(level, texels)| vec![json!(name), json!(level + 1), json!(texels)]));
        let svg = slicing::profile_chart(&name, &histogram).to_svg()?;
        context.save(&context.file(&format!("-{name}-profile.svg")), svg.as_bytes())?;
    }
    Ok(rows)
}

fn picture_pairs(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    look_from_below(context);
    let mut rows = Vec::new();
    for NamedMesh { source, name, .. } in NamedMesh::all(&meshes) {
        let setup = Setup { meshes: vec![source], ..context.setup.clone() };
        let scene = setup.load()?;
        let pair = slicing::picture_pair(&mut machine, &setup, &scene)?;
        for (slicing, picture) in [("normal", &pair.normal), ("smart", &pair.smart)] {
            context.picture(&format!("-{name}-{slicing}.png"), picture)?;
        }
        let d = pair.difference;
        rows.push(vec![json!(name), json!(d.mean), json!(d.p99), json!(d.max), json!(d.pixels)]);
    }
    let columns = &["mesh", "mean", "p99", "max", "pixels"];
    let table = ResultTable { title: "Figure 5-13: Luv difference of the picture pair", columns, rows };
    context.publish_plotted(&machine, &table, table.bars("Luv difference", &["mean", "p99"]))
}

fn appendix(context: &mut Context<'_>) -> Result<(), Error> {
    let Compared { meshes, mut machine, .. } = compare(context, ALL_THREE)?;
    depth_profiles(context, &mut machine, &meshes)?;
    look_from_below(context);
    for NamedMesh { source, name, .. } in NamedMesh::all(&meshes) {
        let setup = Setup { meshes: vec![source], ..context.setup.clone() };
        let scene = setup.load()?;
        for variant in [Variant::Volumetric, Variant::LevelMap, Variant::LevelMapSmart] {
            let mut built = build(&machine, &setup, &scene, variant)?;
            let rendered = picture::render(&mut machine, &mut built.paper, 0)?;
            context.picture(&format!("-{name}-{}.png", variant.as_str()), &rendered)?;
        }
    }
    Ok(())
}
