//! The dissertation's tables and figures, with its own numbers.

mod active;
mod contact_sheets;
mod laws;
mod pace;
pub mod presets;
mod rates;
mod refining;
mod sweeps;
mod timeline;

use self::contact_sheets::{Figure, FigureName};
use self::rates::{CLAIMS, Claim};
use self::refining::{Measured, is_half_refined};
use self::sweeps::Limited;
pub use self::timeline::snapshot;
use self::timeline::{Snapshot, busiest_tick, follow, reaches};
use super::setup::Setup;
use super::{Look, Parameters, Variant};
use crate::field;
use crate::measure::experiment::{Experiment, NamedTable};
use crate::measure::machine::Machine;
use crate::measure::parameter::{Choice, Parameter, ParameterError, Range};
use crate::measure::sweep::Swept;
use crate::measure::{Error, experiment};

type Context<'a> = experiment::Context<'a, Setup>;

/// Options of the experiments.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Figures of `sequence`; all of them where there are none.
    figures: Vec<FigureName>,
    /// Frames of their contact sheets, rising; each figure's own where there are none.
    moments: Vec<u32>,
    /// Triangles of `scaling`.
    counts: Vec<u32>,
    /// Frames a second that `pace` keeps up.
    frame_rate: Option<f32>,
}

/// The options of the experiments.
pub fn options() -> Vec<Parameter<Options>> {
    vec![
        Parameter::new("figures", field!(Options.figures))
            .placeholder("F,F,..")
            .help("Figures of sequence, comma-separated")
            .default_text("all"),
        Parameter::new("moments", field!(Options.moments))
            .placeholder("N,N,..")
            .range(Range::from(0.0).to(100_000.0))
            .help("Frames of the contact sheets of sequence, comma-separated and rising")
            .default_text("each figure's own"),
        Parameter::new("counts", field!(Options.counts))
            .placeholder("N,N,..")
            .help("Triangles of scaling, comma-separated")
            .default_text("1000 to 1000000, two a decade"),
        Parameter::new("frame-rate", field!(Options.frame_rate))
            .range(Range::above(0.0).to(1000.0))
            .unit("frames a second")
            .help("Rate that pace keeps up")
            .section("3.7.2")
            .default_text("30"),
    ]
}

const OWN_OBJECTS: (&str, &str) = ("preset", "this experiment has its own objects");
const OWN_FRAMES: (&str, &str) = ("first-frame", "this experiment finds its own frames");
const OWN_STEP: (&str, &str) = ("time-step", "this experiment measures a tick a frame");

/// Every experiment, in the dissertation's order.
pub fn all() -> Vec<Experiment<Setup>> {
    let rate =
        |name, help, run| Experiment { name, help, options: &[], refuses: &[OWN_OBJECTS, OWN_FRAMES, OWN_STEP], run };
    vec![
        rate(
            "3.8",
            "Section 3.8: frames a second of a shell at its busiest, beside the dissertation's 70",
            |context| frame_rate(context, &CLAIMS[0]),
        ),
        Experiment {
            name: "4.2",
            help: "Table 4.2: refining where it burns against subdividing everything, until half is refined",
            options: &[],
            refuses: &[
                OWN_OBJECTS,
                OWN_FRAMES,
                OWN_STEP,
                ("frames", "this experiment measures all until half is refined"),
                ("time-division", "this experiment measures a tick a frame"),
                ("triangles", "this experiment has its own counts"),
            ],
            run: refined_against_subdivided,
        },
        rate("5.5", "Section 5.5: frames a second of a solid of 45,000 triangles, beside 60", |context| {
            frame_rate(context, &CLAIMS[1])
        }),
        rate("6.5", "Section 6.5: frames a second of 40,000 melting triangles, beside 60", |context| {
            frame_rate(context, &CLAIMS[2])
        }),
        Experiment {
            name: "blocks",
            help: "Section 3.7.3: blocks from 1 to 27,000",
            options: &[],
            refuses: &[OWN_FRAMES, OWN_STEP, ("blocks", "this experiment sweeps them")],
            run: blocks,
        },
        Experiment {
            name: "limits",
            help: "Sections 3.7.1 and 3.7.2: limits of the active vertices, and ticks spread over frames",
            options: &[],
            refuses: &[
                OWN_FRAMES,
                OWN_STEP,
                ("active-limit", "this experiment sweeps it"),
                ("time-division", "this experiment sweeps it"),
                ("preload", "this experiment measures both; leave it and `no-preload` out"),
            ],
            run: limits,
        },
        Experiment {
            name: "pace",
            help: "Section 3.7.2: a fire that slows down where frames come too slowly, with every frame's share",
            options: &["frame-rate"],
            refuses: &[
                OWN_FRAMES,
                OWN_STEP,
                ("time-division", "this experiment divides ticks by the frame rate"),
                ("repeat", "no fire goes by the clock twice alike"),
            ],
            run: paced,
        },
        Experiment {
            name: "sequence",
            help: "The contact sheets of figures 3.1 to 6.5",
            options: &["figures", "moments"],
            refuses: &[
                OWN_OBJECTS,
                ("json", "a sequence is pictures; `3.8` has a record"),
                ("csv", "a sequence is pictures; `3.8` has rows"),
            ],
            run: sequence,
        },
        Experiment {
            name: "scaling",
            help: "1,000 to 1,000,000 triangles: active triangles a second of each simulation pass",
            options: &["counts"],
            refuses: &[OWN_OBJECTS, ("triangles", "this experiment sweeps them; give `counts`")],
            run: scaling,
        },
        Experiment {
            name: "active",
            help: "1 to 70 % of the vertices active, of 1,000,000 triangles: times of each simulation pass",
            options: &[],
            refuses: &[
                OWN_OBJECTS,
                OWN_FRAMES,
                OWN_STEP,
                ("flammability", "this experiment sweeps it"),
                ("active-limit", "this experiment has its own boundary"),
            ],
            run: active_fractions,
        },
        Experiment {
            name: "laws",
            help: "Laws of a fire on any mesh: what nothing holds falls, wax keeps its volume and comes to rest",
            options: &[],
            refuses: &[
                OWN_OBJECTS,
                OWN_FRAMES,
                OWN_STEP,
                ("time-division", "this experiment looks at every tick"),
                ("look", "the laws are of the natural look"),
                ("collapse", "the laws are of parts that fall"),
                ("frames", "this experiment follows the whole fire"),
                ("repeat", "this experiment times nothing"),
            ],
            run: whole_laws,
        },
    ]
}

/// Ticks between two snapshots of a fire that is followed.
const STEP: u32 = 10;

/// Follows a fire under a progress bar until it has burnt out or `is_enough` of a snapshot.
fn watch_fire(
    context: &Context<'_>,
    machine: &mut Machine,
    setup: &Setup,
    variant: Variant,
    step: u32,
    is_enough: impl Fn(&Snapshot) -> bool,
) -> Result<Vec<Snapshot>, Error> {
    let mut snapshots = Err(Error::Interrupted);
    context.console.watch("following the fire", &mut |watch| {
        snapshots = follow(machine, setup, variant, step, watch, &is_enough);
    });
    snapshots
}

/// Follows a fire until it has burnt out.
fn whole_fire(
    context: &Context<'_>,
    machine: &mut Machine,
    setup: &Setup,
    variant: Variant,
) -> Result<Vec<Snapshot>, Error> {
    watch_fire(context, machine, setup, variant, STEP, |_| false)
}

/// Publishes measured rows with what is said of them, plots and tables, and ends as the sweep did.
fn publish(
    context: &Context<'_>,
    machine: &Machine,
    Swept { rows, stopped }: Swept,
    text: String,
    plots: &[(String, String)],
    tables: &[NamedTable],
) -> Result<(), Error> {
    context.publish_runs(machine, rows.into_iter().map(|row| row.run).collect(), text, plots, tables)?;
    stopped.map_or(Ok(()), Err)
}

/// The plot of an experiment that has one.
fn plot(svg: String) -> [(String, String); 1] {
    [(".svg".to_owned(), svg)]
}

fn frame_rate(context: &mut Context<'_>, claim: &Claim) -> Result<(), Error> {
    let setup = context.over(of_the_text(claim.preset.setup()))?;
    let mut machine = context.open()?;
    let tick = busiest_tick(&whole_fire(context, &mut machine, &setup, claim.variant())?)?;
    let Swept { mut rows, stopped } = context.sweep(&mut machine, &[claim.point(&setup, tick)])?;
    rows.iter_mut().for_each(|row| claim.note(&mut row.run));
    let table = rows.iter().map(|row| claim.render(&row.label, &row.run, context.console.style())).collect();
    let plots = rows.iter().map(|row| Ok((".svg".to_owned(), claim.plot(&row.run)?)));
    let plots = plots.collect::<Result<Vec<_>, Error>>()?;
    publish(context, &machine, Swept { rows, stopped }, table, &plots, &[])
}

/// Every frame of each box until half of its coarse triangles are refined, once unless more is asked for.
fn refined_against_subdivided(context: &mut Context<'_>) -> Result<(), Error> {
    let setups =
        refining::TABLE.iter().map(|line| context.over(of_the_text(line.setup()))).collect::<Result<Vec<_>, _>>()?;
    let mut machine = context.open()?;
    let mut measured = Vec::new();
    let mut stopped = None;
    context.measure.repeat = context.measure.repeat.or(Some(1));
    for (line, setup) in refining::TABLE.into_iter().zip(&setups) {
        let snapshots = watch_fire(context, &mut machine, setup, Variant::LowPoly, 1, is_half_refined)?;
        context.measure.frames = Some(snapshots.len() as u32);
        let swept = context.sweep(&mut machine, &line.points(setup))?;
        measured.push(Measured::new(line, snapshots, swept.rows));
        stopped = swept.stopped;
        if stopped.is_some() {
            break;
        }
    }
    // Of every pass and every frame: too long for a terminal.
    let tables = [("passes", refining::passes(&measured)), ("curves", refining::curves(&measured))];
    context.save_tables(&machine, &tables)?;
    let (table, svg) = (refining::render(&measured, context.console.style()), refining::plot(&measured)?);
    let rows = measured.into_iter().flat_map(Measured::into_rows).collect();
    publish(context, &machine, Swept { rows, stopped }, table, &plot(svg), &[])
}

/// The setup with the dissertation's look: experiments measure the text's own passes, unless another look is given.
fn of_the_text(setup: Setup) -> Setup {
    let parameters = Parameters { look: Look::Dissertation, ..setup.parameters };
    Setup { parameters, ..setup }
}

/// The preset that was named, or that of section 3.8, with what was given over it.
fn named_or_shell(context: &Context<'_>) -> Result<Setup, Error> {
    context.over(of_the_text(context.preset.as_ref().unwrap_or(&presets::RESULTS_3_8).setup()))
}

fn blocks(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = named_or_shell(context)?;
    let mut machine = context.open()?;
    let tick = busiest_tick(&whole_fire(context, &mut machine, &setup, Variant::Shell)?)?;
    let mut swept = context.sweep(&mut machine, &sweeps::block_points(&setup, tick))?;
    let table = sweeps::block_table(&mut swept.rows);
    let svg = table.bars("ms", &["weights ms", "rotation ms", "mapping ms", "flames ms"])?;
    publish(context, &machine, swept, String::new(), &plot(svg), &[("passes", table)])
}

fn limits(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = named_or_shell(context)?;
    let mut machine = context.open()?;
    let free = whole_fire(context, &mut machine, &setup, Variant::Shell)?;
    let tick = busiest_tick(&free)?;
    let mut fires = Vec::new();
    for limit in sweeps::limits(&free) {
        let limited = sweeps::limited(&setup, limit);
        let snapshots = match limit {
            0 => free.clone(),
            _ => whole_fire(context, &mut machine, &limited, Variant::Shell)?,
        };
        fires.push(Limited { limit, snapshots });
    }
    let limited = context.sweep(&mut machine, &sweeps::limit_points(&setup, &fires))?;
    let asked = context.measure.frames;
    // Whole ticks under every division.
    context.measure.frames = asked.or(sweeps::DIVISIONS.last().map(|most| 2 * most));
    let divided = context.sweep(&mut machine, &sweeps::division_points(&setup, tick))?;
    context.measure.frames = asked;
    let loaded = context.sweep(&mut machine, &sweeps::loading_points(&setup, tick))?;
    let tables = [
        ("active", sweeps::limit_table(&fires, &limited.rows)),
        ("division", sweeps::division_table(&divided.rows)),
        ("loading", sweeps::loading_table(&loaded.rows)),
    ];
    let rows = limited.rows.into_iter().chain(divided.rows).chain(loaded.rows).collect();
    let stopped = limited.stopped.or(divided.stopped).or(loaded.stopped);
    publish(context, &machine, Swept { rows, stopped }, String::new(), &[], &tables)
}

fn paced(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = named_or_shell(context)?;
    let frames = context.measure.frames.unwrap_or(240);
    let frame_rate = f64::from(context.options.frame_rate.unwrap_or(30.0));
    let mut machine = context.open()?;
    let mut table = Err(Error::Interrupted);
    context.console.watch("burning by the clock", &mut |watch| {
        table = pace::table(&mut machine, &setup, frame_rate, frames, watch);
    });
    context.publish_table(&machine, &table?)?;
    Ok(machine.check_validation().map(drop)?)
}

fn sequence(context: &mut Context<'_>) -> Result<(), Error> {
    let Options { figures, moments, .. } = &context.options;
    let is_rising = moments.is_sorted_by(|a, b| a < b);
    let text = || moments.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
    ParameterError::check(is_rising, "moments", text(), "the frames must rise")?;
    let wanted = FigureName::ALL.iter().filter(|name| figures.is_empty() || figures.contains(name));
    let mut drawn: Vec<Figure> = wanted.map(|name| name.figure()).collect();
    for figure in &mut drawn {
        if !moments.is_empty() {
            figure.frames.clone_from(moments);
        }
        for sheet in &mut figure.sheets {
            sheet.setup = context.over(of_the_text(sheet.setup.clone()))?;
        }
    }
    let mut machine = context.open()?;
    for figure in drawn {
        let picture = figure.draw(&mut machine)?;
        context.picture(&format!("-{}.png", figure.name), &picture)?;
    }
    Ok(())
}

fn scaling(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.over(of_the_text(sweeps::scaling_setup()))?;
    let counts = if context.options.counts.is_empty() { &sweeps::COUNTS[..] } else { &context.options.counts };
    let points = sweeps::scaling_points(&setup, counts);
    points.iter().try_for_each(|point| point.study.check())?;
    let mut machine = context.open()?;
    let swept = context.sweep(&mut machine, &points)?;
    let table = sweeps::scaling_table(&swept.rows);
    let svg = sweeps::scaling_plot(&swept.rows)?;
    publish(context, &machine, swept, String::new(), &plot(svg), &[("rates", table)])
}

fn active_fractions(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.over(of_the_text(active::setup()))?;
    let mut machine = context.open()?;
    let reaches = reaches(&mut machine, &setup, Variant::Shell)?;
    let swept = context.sweep(&mut machine, &active::points(&setup, reaches))?;
    let table = active::table(&swept.rows);
    let svg = active::plot(&swept.rows)?;
    publish(context, &machine, swept, String::new(), &plot(svg), &[("passes", table)])
}

fn whole_laws(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.over(laws::setup())?;
    let mut machine = context.open()?;
    let mut found = Err(Error::Interrupted);
    context.console.watch("following the fire", &mut |watch| found = laws::found(&mut machine, &setup, watch));
    context.publish_table(&machine, &laws::table(&found?))
}
