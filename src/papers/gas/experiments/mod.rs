//! The tables and figures of the `gas` paper, with the paper's own numbers.

mod froxel;
mod lists;
mod reference;
mod savings;
mod tables;
mod trade;

use serde_json::{Value, json};

use self::tables::{TABLE_1, TABLE_2};
use self::trade::{STEPS, TABLE_SIZE};
use super::Variant;
use super::scenes::Preset;
use super::setup::Setup;
use crate::field;
use crate::image::contact_sheet::{below_each_other, side_by_side};
use crate::measure::bench::build;
use crate::measure::experiment::{self, Experiment};
use crate::measure::parameter::{Parameter, Range};
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::{Point, Row};
use crate::measure::{Error, picture};

type Context<'a> = experiment::Context<'a, Setup>;

/// Options of the experiments.
#[derive(Debug, Clone)]
pub struct Options {
    /// Table sizes, steps, sheets, entries or divisors of a sweep.
    counts: Vec<u32>,
    /// Paths of a pixel in each half of the reference, 1 to 1,000,000.
    paths: u32,
}

impl Default for Options {
    fn default() -> Self {
        Options { counts: Vec::new(), paths: 32 }
    }
}

/// The options of the experiments.
pub fn options() -> Vec<Parameter<Options>> {
    vec![
        Parameter::new("counts", field!(Options.counts))
            .placeholder("N,N,..")
            .help("Table sizes, steps, sheets, entries, divisors or scales of a sweep, comma-separated")
            .default_text("16,32,64,96,128, or 10,20,40,80,160, or 2,8,32,128, or 24,32,48,64, or 4,2,1, or 2,4,8"),
        Parameter::new("paths", field!(Options.paths))
            .range(Range::from(1.0).to(1e6))
            .help("Paths of a pixel in each of the reference's two halves, whose difference is its noise"),
    ]
}

const OWN_SCENES: (&str, &str) = ("preset", "this experiment has its own scenes");

/// Every experiment, the paper's tables first.
pub fn all() -> Vec<Experiment<Setup>> {
    vec![
        Experiment {
            name: "1",
            help: "Table 1: times of figures 3 to 7, with and without the volume",
            options: &[],
            refuses: &[OWN_SCENES],
            run: |context| TABLE_1.run(context),
        },
        Experiment {
            name: "2",
            help: "Table 2: times of figure 8 by shadowing",
            options: &[],
            refuses: &[OWN_SCENES],
            run: |context| TABLE_2.run(context),
        },
        Experiment {
            name: "table-size",
            help: "Shadow table of 16 to 128 entries a side: cost against the difference from tracing",
            options: &["counts"],
            refuses: &[("table", "this experiment sweeps it; give `counts`")],
            run: |context| TABLE_SIZE.run(context),
        },
        Experiment {
            name: "steps",
            help: "Steps along a volume: cost against the difference from the most",
            options: &["counts"],
            refuses: &[("steps", "this experiment sweeps them; give `counts`")],
            run: |context| STEPS.run(context),
        },
        Experiment {
            name: "noise",
            help: "The fraction of the volume's time that turbulence takes",
            options: &[],
            refuses: &[("density", "this experiment compares two")],
            run: noise,
        },
        Experiment {
            name: "lists",
            help: "Linked lists, lists by tiles and a k-buffer behind 2 to 128 sheets: cost, and their pictures' difference",
            options: &["counts"],
            refuses: &[("lists", "this experiment compares three")],
            run: lists::run,
        },
        Experiment {
            name: "density-cache",
            help: "Tables of 24 to 64 densities a side that rays read: cost against the difference from the functions",
            options: &["counts"],
            refuses: &[("density-cache", "this experiment sweeps it; give `counts`")],
            run: savings::cache,
        },
        Experiment {
            name: "skipping",
            help: "Bricks that rays skip: cost, and the difference that it makes",
            options: &[],
            refuses: &[OWN_SCENES, ("skip-empty", "this experiment compares several")],
            run: savings::skipping,
        },
        Experiment {
            name: "volume-scale",
            help: "Gas that is marched in fewer pixels: cost against the difference from that of all",
            options: &["counts"],
            refuses: &[("volume-scale", "this experiment sweeps it; give `counts`")],
            run: savings::scale,
        },
        Experiment {
            name: "froxel",
            help: "Gas in froxels, divided by 4, 2 and 1 along each axis: cost against the difference from fine rays",
            options: &["counts"],
            refuses: &[("march", "this experiment measures froxels and steps")],
            run: froxel::run,
        },
        Experiment {
            name: "reference",
            help: "The gas of each variant against light that is scattered any number of times, by paths",
            options: &["paths"],
            refuses: &[
                ("lists", "this experiment draws no surfaces"),
                ("object", "this experiment draws no surfaces"),
                ("crease-angle", "this experiment draws no surfaces"),
                ("frames", "this experiment times nothing"),
                ("repeat", "this experiment times nothing"),
            ],
            run: reference::run,
        },
        Experiment {
            name: "sequence",
            help: "Contact sheets of figures 6 and 7",
            options: &[],
            refuses: &[
                OWN_SCENES,
                ("first-frame", "the contact sheets have the paper's frames"),
                ("json", "a contact sheet is pictures; `1` has a record"),
                ("csv", "a contact sheet is pictures; `1` has rows"),
            ],
            run: sequence,
        },
    ]
}

/// A point of one variant.
fn point(label: &str, x: f64, study: Setup, variant: Variant) -> Point<Setup> {
    Point { label: label.to_owned(), x, study, variants: vec![variant], left_out: Vec::new() }
}

/// GPU time of passes of a row, their medians summed, milliseconds.
fn gpu_ms(row: &Row, names: &[&str]) -> f64 {
    let passes = row.run.passes.iter().filter(|pass| names.contains(&pass.name.as_str()));
    // What sums up nothing is 0, not -0.
    passes.filter_map(|pass| pass.gpu_ms.as_ref().map(|summary| summary.median)).fold(0.0, |sum, ms| sum + ms)
}

/// Evaluations of the density along the viewer's rays in the last frame; null of several bands.
fn samples(row: &Row) -> Value {
    row.run.results.get("samples").cloned().unwrap_or_default()
}

/// The volume's time with the scene's density function, and with a constant one: the difference is turbulence.
fn noise(context: &mut Context<'_>) -> Result<(), Error> {
    let turbulent = context.setup.named();
    let constant = turbulent.with_constant_density();
    let points = [("turbulent", turbulent), ("constant", constant)]
        .map(|(label, setup)| point(label, 0.0, setup, Variant::None));
    let (machine, swept) = context.sweep_loaded(&points)?;
    let row = |label: &str| swept.rows.iter().find(|row| row.label == label);
    let volume_ms = |row: &Row| row.run.passes.iter().find(|p| p.name == "volume")?.gpu_ms.as_ref().map(|s| s.median);
    let rows = ["turbulent", "constant"].map(row);
    let [turbulent, constant] = rows.map(|row| row.and_then(volume_ms));
    let [turbulent_samples, constant_samples] = rows.map(|row| row.map(samples));
    let fraction = turbulent.zip(constant).map(|(t, c)| (t - c) / t);
    let table = ResultTable {
        title: "The share of turbulence in the volume's time",
        columns: &["turbulent ms", "constant ms", "share", "paper", "turbulent samples", "constant samples"],
        rows: vec![vec![
            json!(turbulent),
            json!(constant),
            json!(fraction),
            json!(0.65),
            json!(turbulent_samples),
            json!(constant_samples),
        ]],
    };
    context.keep_warnings(swept.rows);
    context.publish_table(&machine, &table)?;
    swept.stopped.map_or(Ok(()), Err)
}

/// Pictures in a row of a contact sheet: of the six of figure 6 and the nine of figure 7.
const PICTURES_A_ROW: usize = 3;

fn sequence(context: &mut Context<'_>) -> Result<(), Error> {
    let setups = context.setup.in_scenes(&[Preset::Fig6, Preset::Fig7])?;
    let mut machine = context.open()?;
    for mut setup in setups {
        let scene = setup.scene;
        let surfaces = setup.load()?;
        let mut pictures = Vec::new();
        for frame in scene.frames() {
            setup.parameters.first_frame = frame;
            let mut built = build(&machine, &setup, &surfaces, scene.variant())?;
            let drawn = picture::render(&mut machine, &mut built.paper, 0)?;
            context.picture(&format!("-{}-{frame:04}.png", scene.as_str()), &drawn)?;
            pictures.push(drawn);
        }
        let rows = pictures.chunks(PICTURES_A_ROW).map(side_by_side).collect::<Result<Vec<_>, _>>()?;
        context.picture(&format!("-{}.png", scene.as_str()), &below_each_other(&rows)?)?;
    }
    Ok(())
}
