//! The tables and figures of the `terrain` paper, with the paper's own numbers.

pub mod bodies;
pub mod collisions;
pub(super) mod decimals;
pub mod figures;
mod flight;
pub mod table;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use rayon::prelude::*;

use self::collisions::{Body, Collision, collide, record};
use self::table::{Axis, Outcome};
use super::setup::Setup;
use super::{Variant, View};
use crate::field;
use crate::file::{check_writable, write};
use crate::measure::experiment::Experiment;
use crate::measure::parameter::{Choice, EyeAndTarget, Parameter};
use crate::measure::study::Study;
use crate::measure::sweep::Point;
use crate::measure::{Error, Variant as _, experiment};

type Context<'a> = experiment::Context<'a, Setup>;

/// Options of the experiments and of `collide`.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Samples a side or pixels a row of a sweep.
    counts: Vec<u32>,
    /// Variants of a sweep; all where there are none.
    variants: Vec<Listed>,
    /// From a place to another, metres.
    segments: Vec<[f64; 6]>,
    /// Centre and radius, metres.
    spheres: Vec<[f64; 4]>,
    /// A file of both.
    bodies: Option<PathBuf>,
    /// The last camera of a flight.
    to: Option<EyeAndTarget>,
}

impl Options {
    fn counts(&self, default: &[u32]) -> Vec<u32> {
        if self.counts.is_empty() { default.to_vec() } else { self.counts.clone() }
    }

    /// Each variant that was named, once, in the paper's order; the paper's where none was.
    fn variants(&self) -> Vec<Variant> {
        if self.variants.is_empty() {
            return Variant::PAPER.to_vec();
        }
        let is_all = self.variants.contains(&Listed(None));
        Variant::ALL.iter().copied().filter(|v| is_all || self.variants.contains(&Listed(Some(*v)))).collect()
    }
}

/// A variant in a list, or all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Listed(Option<Variant>);

impl Choice for Listed {
    const ALL: &'static [Self] = &[
        Listed(Some(Variant::Cpu)),
        Listed(Some(Variant::GpuCompute)),
        Listed(Some(Variant::GpuFragment)),
        Listed(Some(Variant::Mesh)),
        Listed(Some(Variant::MeshLod)),
        Listed(Some(Variant::DdaCompute)),
        Listed(Some(Variant::DdaFragment)),
        Listed(Some(Variant::DdaCpu)),
        Listed(Some(Variant::TiledCompute)),
        Listed(None),
    ];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("cpu", ""),
        ("gpu-compute", ""),
        ("gpu-fragment", ""),
        ("mesh", ""),
        ("mesh-lod", ""),
        ("dda-compute", ""),
        ("dda-fragment", ""),
        ("dda-cpu", ""),
        ("tiled-compute", ""),
        ("all", ""),
    ];
}

/// The options of the experiments and of `collide`.
pub fn options() -> Vec<Parameter<Options>> {
    vec![
        Parameter::new("counts", field!(Options.counts))
            .placeholder("N,N,..")
            .help("Samples a side in table 1, or widths of the screen in pixels, comma-separated")
            .default_text("128,256,512,1024,2048,4096,8192,16384, or 200,400,800,1200,1600")
            .everyday(),
        Parameter::new("variant", field!(Options.variants))
            .placeholder("VARIANT,..")
            .help("Variants of a sweep, comma-separated, or all; a figure shows the first")
            .default_text("the paper's, mesh and mesh-lod"),
        Parameter::new("segment", field!(Options.segments))
            .placeholder("X,Y,Z,X,Y,Z")
            .help("From a place to another, metres: east, up from the base, south")
            .everyday(),
        Parameter::new("sphere", field!(Options.spheres))
            .placeholder("X,Y,Z,R")
            .help("Centre, metres as in `segment`, and radius, above 0")
            .everyday(),
        Parameter::new("bodies", field!(Options.bodies))
            .placeholder("FILE.csv")
            .help("Many of both, one a line: six numbers for a segment, four for a sphere")
            .everyday(),
        Parameter::new("to", field!(Options.to))
            .placeholder("EYE,TARGET")
            .help(
                "Last camera of a flight, as `camera` the first: x,y,z,x,y,z in metres: east, up from the base, south",
            )
            .default_text("the first, as far north as the maps reach"),
    ]
}

/// Every experiment, in the paper's order.
pub fn all() -> Vec<Experiment<Setup>> {
    let by_map = |name, help, options, run| Experiment {
        name,
        help,
        options,
        refuses: &[
            ("map", "table 1 takes the synthetic volcano, which has any size"),
            ("resolution", "table 1 sweeps it; give `counts`"),
        ],
        run,
    };
    let figure = |name, help, run| Experiment {
        name,
        help,
        options: &["variant"],
        refuses: &[("json", "a figure is a picture; `1` has a record"), ("csv", "a figure is a picture; `1` has rows")],
        run,
    };
    vec![
        by_map("1", "Table 1: time by samples a side of the map, all variants", &["counts", "variant"], |context| {
            tabulate(context, Axis::Map, &context.options.variants()).map(drop)
        }),
        figure("figure-1", "Figure 1: the volcano from above", |context| draw(context, View::Top)),
        figure("figure-2", "Figure 2: the volcano from the side", |context| draw(context, View::Side)),
        Experiment {
            name: "screen",
            help: "Section 5's claim: time by the screen's size",
            options: &["counts", "variant"],
            refuses: &[("size", "this experiment sweeps it; give `counts`")],
            run: |context| tabulate(context, Axis::Screen, &context.options.variants()).map(drop),
        },
        // Every variant takes the same steps; the paper's second application stands for all.
        by_map("steps", "Steps of each ray by samples a side of the map; a heat map of each", &["counts"], |context| {
            let points = tabulate(context, Axis::Map, &[Variant::GpuCompute])?;
            heat_maps(context, &points)
        }),
        Experiment {
            name: "interpolation",
            help: "Bilinear and bicubic interpolation at both levels of detail: time, and the pictures",
            options: &["variant"],
            refuses: &[],
            run: |context| tabulate(context, Axis::Interpolation, &context.options.variants()).map(drop),
        },
        Experiment {
            name: "flight",
            help: "A straight flight over maps in tiles: frames, stalls, tiles that came and were missing",
            options: &["to"],
            refuses: &[],
            run: fly,
        },
    ]
}

/// The verb `collide`.
pub fn verbs() -> Vec<Experiment<Setup>> {
    const NO_PICTURE: &str = "nothing is drawn";
    vec![Experiment {
        name: "collide",
        help: "The first contacts of segments and spheres with the terrain: section 1's detection of spatial collisions",
        options: &["segment", "sphere", "bodies"],
        refuses: &[
            ("object", NO_PICTURE),
            ("crease-angle", NO_PICTURE),
            ("drape", NO_PICTURE),
            ("normals", NO_PICTURE),
            ("shadows", NO_PICTURE),
            ("lod", NO_PICTURE),
            ("start", NO_PICTURE),
            ("corners", NO_PICTURE),
            ("mesh-error", NO_PICTURE),
            ("tile-memory", NO_PICTURE),
            ("sun", NO_PICTURE),
            ("haze", NO_PICTURE),
            ("camera", NO_PICTURE),
            ("size", NO_PICTURE),
            ("stream", "a collision needs the samples in memory"),
        ],
        run: collisions,
    }]
}

fn draw(context: &mut Context<'_>, view: View) -> Result<(), Error> {
    let setup = &mut context.setup;
    if !context.given.has("resolution") {
        setup.resolution = figures::SIDE;
    }
    if !context.given.has("camera") {
        setup.parameters.view = view;
    }
    // All variants show one surface; of all, the paper's second application stands for them.
    let first = context.options.variants.first().and_then(|Listed(first)| *first);
    let variant = first.unwrap_or(Variant::GpuCompute);
    setup.load()?;
    let mut machine = context.open()?;
    let picture = figures::draw(&mut machine, &context.setup, variant)?;
    if !context.given.has("map") {
        let name = context.name;
        context.console.say(&format!("{name}: the synthetic volcano stands for Bandai; `map` names another"));
    }
    context.picture(".png", &picture)
}

/// Measures and publishes a sweep along the axis.
fn tabulate(context: &Context<'_>, axis: Axis, variants: &[Variant]) -> Result<Vec<Point<Setup>>, Error> {
    let (setup, options) = (&context.setup, &context.options);
    let points = match axis {
        Axis::Map => table::by_map(setup, &options.counts(&table::SIDES), variants),
        Axis::Screen => table::by_screen(setup, &options.counts(&table::WIDTHS), variants),
        Axis::Interpolation => table::by_interpolation(setup, variants),
    };
    // A map that is larger than the others is made when its point comes; the rest is checked before the first.
    points.iter().try_for_each(|point| point.study.check())?;
    let mut machine = context.open()?;
    let swept = context.sweep(&mut machine, &points)?;
    let outcome = Outcome::new(axis, swept.rows);
    let (text, tables) = (outcome.render(context.console.style()), outcome.tables());
    let plots = [(".svg".to_owned(), outcome.plot()?)];
    context.publish_runs(&machine, outcome.into_runs(), text, &plots, &tables)?;
    if axis == Axis::Interpolation {
        for point in &points {
            let picture = figures::draw(&mut machine, &point.study, Variant::GpuCompute)?;
            context.picture(&format!("-{}.png", point.label.replace(' ', "-")), &picture)?;
        }
    }
    swept.stopped.map_or(Ok(points), Err)
}

fn fly(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let pictures = context.measure.frames.unwrap_or(flight::PICTURES).max(2);
    let table = flight::table(&mut machine, &context.setup, context.options.to, pictures)?;
    context.publish_plotted(&machine, &table, table.lines("picture", "ms", &flight::TIMES))?;
    context.console.say(&flight::summary(&table));
    Ok(())
}

fn heat_maps(context: &Context<'_>, points: &[Point<Setup>]) -> Result<(), Error> {
    let mut machine = context.open()?;
    let (most, pictures) = figures::heat_maps(&mut machine, points.iter().map(|point| &point.study))?;
    for (point, picture) in points.iter().zip(&pictures) {
        context.picture(&format!("-{}.png", point.label), picture)?;
    }
    context.console.say(&format!("heat maps: black is no step, nearly white {most} steps, by logarithm"));
    Ok(())
}

fn collisions(context: &mut Context<'_>) -> Result<(), Error> {
    let Options { segments, spheres, bodies: file_of_bodies, .. } = &context.options;
    let mut bodies: Vec<Body> = segments.iter().map(Body::from).chain(spheres.iter().map(Body::from)).collect();
    let started = Instant::now();
    if let Some(path) = file_of_bodies {
        bodies::read(path, &mut bodies)?;
    }
    let read_s = started.elapsed().as_secs_f64();
    if bodies.is_empty() {
        let reason = "collide: there is nothing to collide; give a `segment`, a `sphere` or a file of `bodies`";
        return Err(Error::Input(reason.into()));
    }
    let json = context.destinations.json.as_deref();
    let file = json.filter(|path| path.as_os_str() != "-");
    file.map_or(Ok(()), check_writable)?;
    let (collisions, warnings, met_s) = collide(&context.setup, &bodies)?;
    warnings.iter().for_each(|warning| context.console.say(&format!("warning: {warning}")));
    let started = Instant::now();
    if json.is_some() {
        let record = record(&collisions, &warnings)?;
        match file {
            Some(path) => write(path, record.as_bytes())?,
            None => context.console.print(&record)?,
        }
    }
    if json.is_none() || file.is_some() {
        print_lines(context, &collisions)?;
    }
    if file_of_bodies.is_some() {
        let (count, written_s) = (bodies.len(), started.elapsed().as_secs_f64());
        let said = format!("{count} bodies read in {read_s:.3} s, met in {met_s:.3} s, written in {written_s:.3} s");
        context.console.say(&said);
    }
    Ok(())
}

/// A line for each, of which some are there at once.
fn print_lines(context: &Context<'_>, collisions: &[Collision]) -> Result<(), Error> {
    /// Lines that one thread makes, and those that are printed together.
    const LINES: usize = 1 << 10;
    const TOGETHER: usize = 1 << 16;
    for together in collisions.chunks(TOGETHER) {
        let lines = together.par_chunks(LINES).map(|collisions| {
            let mut lines = String::new();
            for collision in collisions {
                let _ = write!(lines, "{collision}");
            }
            lines
        });
        context.console.print(&lines.collect::<Vec<String>>().concat())?;
    }
    Ok(())
}
