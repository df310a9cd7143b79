//! The thesis's figures, its frame rate, and growth of the method's times.

mod contact_sheet;
mod cooling;
mod culling;
pub mod figures;
mod flow;
mod gaps;
mod motion;
mod normals;
pub mod points;
mod radiance;
mod readback;
mod results;
mod scaling;
mod shading;
mod stability;
mod surface;

use self::figures::{Drawn, FIGURES};
use self::scaling::Axis;
use super::parameters::Variant;
use super::setup::Setup;
use crate::field;
use crate::measure::Error;
use crate::measure::experiment::{self, Experiment, NamedTable};
use crate::measure::machine::Machine;
use crate::measure::parameter::{Parameter, Range};
use crate::measure::sweep::{Point, Row};

type Context<'a> = experiment::Context<'a, Setup>;

/// Options of the experiments.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Frame of a figure.
    frame: Option<u32>,
}

/// The options of the experiments.
pub fn options() -> Vec<Parameter<Options>> {
    vec![
        Parameter::new("frame", field!(Options.frame))
            .range(Range::from(0.0).to(100_000.0))
            .help("Frame of a figure's pictures and textures; the last of a strip, the first of motion")
            .default_text("0; of a strip 239, of motion 29"),
    ]
}

/// Every experiment, in the thesis's order.
pub fn all() -> Vec<Experiment<Setup>> {
    let figures = FIGURES.map(|figure| Experiment {
        name: figure.name,
        help: figure.help,
        options: &["frame"],
        refuses: if figure.name == "fig-8.5" { REFUSED_BY_FIG_8_5 } else { REFUSED_BY_FIGURES },
        run: draw,
    });
    let measured = |name, help, run| Experiment { name, help, options: &[], refuses: REFUSED_BY_MEASURES, run };
    let others = [
        measured("results", "Chapter 8: frames a second, beside the thesis's 20", results as fn(&mut Context<'_>) -> _),
        measured("readback", "Both variants in turn: what readbacks and waits cost, stage by stage", readbacks),
        measured("scaling", "Particles, splats and grid points against each pass's time, host work included", scaling),
    ];
    let surface = Experiment {
        name: "surface",
        help: "The mean, the top and the crossing beside the outermost isosurface of the same densities",
        options: &["frame"],
        refuses: &[("surface", "all three are compared")],
        run: surfaces,
    };
    let flow = Experiment {
        name: "flow",
        help: "Chapter 9, \"Improved particle simulation\": the fluid over time: effusion, front, area, thickness and temperatures",
        options: &[],
        refuses: &[("frame", "this experiment follows frames from 0 on; give `frames`")],
        run: flows,
    };
    let motion = Experiment {
        name: "motion",
        help: "Relief carried along with the particles, beside that of later frames: correlations up to 2 s",
        options: &["frame"],
        refuses: &[],
        run: motions,
    };
    let strip = Experiment {
        name: "strip",
        help: "Five pictures over time, side by side: a flow of one of chapter 3's kinds by its preset",
        options: &["frame"],
        refuses: REFUSED_BY_STRIPS,
        run: strip_of,
    };
    let stability = Experiment {
        name: "stability",
        help: "The fluid over many steps: speeds, compression, energy, heat, mass and front; a law that breaks is a failure",
        options: &[],
        refuses: &[("frame", "this experiment follows frames from 0 on; give `frames`")],
        run: stabilities,
    };
    let of_fluids = [surface, motion, strip, flow, stability];
    figures.into_iter().chain(others).chain(of_fluids).chain(of_chapter_9()).collect()
}

/// An experiment for each heading of chapter 9 behind the first, which is `flow`.
fn of_chapter_9() -> [Experiment<Setup>; 6] {
    let still = |name, help, run, refuses| Experiment { name, help, options: &["frame"], refuses, run };
    [
        Experiment {
            name: "cooling",
            help: "Chapter 9, \"Temperature variables and heat transfer simulations\": a flow that radiates beside one that does not",
            options: &[],
            refuses: REFUSED_BY_MEASURES,
            run: coolings,
        },
        Experiment {
            name: "radiance",
            help: "Chapter 9, \"Convert lava temperature to emitted radiance\": pixels' chromaticities beside Planck's law",
            options: &[],
            refuses: &[("color", "it is a black body's"), ("temperatures", "the experiment has its own")],
            run: radiances,
        },
        Experiment {
            name: "shading",
            help: "Chapter 9, \"Look at other shading techniques\": blended colours, deferred shading and rays: times and contrast",
            options: &[],
            refuses: REFUSED_BY_SHADING,
            run: shadings,
        },
        still(
            "normals",
            "Chapter 9, \"Calculate the surface normals by accumulation\": degrees from the isosurface's, beside differences",
            normals_of as fn(&mut Context<'_>) -> _,
            &[("surface", "the mean and the crossing are compared")],
        ),
        still(
            "gaps",
            "Chapter 9, \"Eliminate large gaps between splats\": pixels that show what lies behind, from 32 cameras",
            gaps_between,
            &[("camera", "the experiment has its own"), ("splat-shape", "all of them are compared")],
        ),
        Experiment {
            name: "culling",
            help: "Chapter 9, \"Culling\": splats and clusters that stay from six cameras, and their times",
            options: &[],
            refuses: REFUSED_BY_CULLING,
            run: cullings,
        },
    ]
}

const REFUSED_BY_MEASURES: &[(&str, &str)] = &[FROM_0_ON];
const REFUSED_BY_SHADING: &[(&str, &str)] = &[
    FROM_0_ON,
    ("surface-draw", "splats and rays are compared"),
    ("splat-shading", "both are compared"),
    ("shading", "the finished pictures are compared"),
];
const REFUSED_BY_CULLING: &[(&str, &str)] =
    &[FROM_0_ON, ("culling", "all ways are compared"), ("surface-draw", "splats are culled, rays are not")];
const FROM_0_ON: (&str, &str) = ("frame", "this experiment measures frames from 0 on; give `frames`");
const REFUSED_BY_STRIPS: &[(&str, &str)] = &[
    ("json", "a strip is a picture; the experiment flow has a table"),
    ("csv", "a strip is a picture; the experiment flow has rows"),
];
const REFUSED_BY_FIGURES: &[(&str, &str)] = &[
    ("json", "a figure is pictures; the experiment results has a record"),
    ("csv", "a figure is pictures; the experiment results has rows"),
    ("shading", "the figure's parts have their own; render takes any"),
];
const REFUSED_BY_FIG_8_5: &[(&str, &str)] = &[
    ("json", "a figure is pictures; the experiment results has a record"),
    ("csv", "a figure is pictures; the experiment results has rows"),
    ("splat-radius", "the figure's parts have their own; render takes any"),
    ("surface-draw", "the figure's parts are splats"),
];

fn draw(context: &mut Context<'_>) -> Result<(), Error> {
    let Some(figure) = FIGURES.iter().find(|figure| figure.name == context.name) else { return Ok(()) };
    figure.set_up(&mut context.setup, &context.given);
    figure.check(&context.setup)?;
    let mut machine = context.open()?;
    let parts = figure.draw(&mut machine, &context.setup, context.options.frame.unwrap_or(0))?;
    for (suffix, drawn) in parts {
        let suffix = format!("{suffix}.png");
        match drawn {
            Drawn::Picture(picture) => context.picture(&suffix, &picture)?,
            Drawn::Texture(texture) => context.drawing(&suffix, &texture)?,
        }
    }
    Ok(())
}

fn results(context: &mut Context<'_>) -> Result<(), Error> {
    let points = [Point { variants: vec![Variant::Paper], ..Point::single(context.name, context.setup.clone()) }];
    let (machine, mut swept) = context.sweep_loaded(&points)?;
    for row in &mut swept.rows {
        results::beside_the_thesis(&mut row.run);
    }
    let runs: Vec<_> = swept.rows.into_iter().map(|row| row.run).collect();
    let table = runs.iter().map(|run| results::render(run, context.console.style())).collect();
    let plot = |run| results::plot(run).map(|svg| (".svg".to_owned(), svg));
    let plots = runs.iter().map(plot).collect::<Result<Vec<_>, _>>()?;
    context.publish_runs(&machine, runs, table, &plots, &[])?;
    swept.stopped.map_or(Ok(()), Err)
}

fn readbacks(context: &mut Context<'_>) -> Result<(), Error> {
    let points = readback::points(&context.setup);
    let (machine, mut swept) = context.sweep_loaded(&points)?;
    for row in &mut swept.rows {
        results::beside_the_thesis(&mut row.run);
    }
    let table = readback::table(&swept.rows);
    let plot = table.bars("ms", &["gpu ms", "host ms"]).map_err(Error::from)?;
    let runs = swept.rows.into_iter().map(|row| row.run).collect();
    context.publish_runs(&machine, runs, String::new(), &[(".svg".to_owned(), plot)], &[("stages", table)])?;
    swept.stopped.map_or(Ok(()), Err)
}

fn scaling(context: &mut Context<'_>) -> Result<(), Error> {
    let points: Vec<_> = Axis::ALL.iter().flat_map(|axis| axis.points(&context.setup)).collect();
    let (machine, swept) = context.sweep_loaded(&points)?;
    let table = scaling::table(&swept.rows);
    let mut plots = Vec::new();
    for axis in Axis::ALL {
        if let Some(svg) = scaling::plot(&swept.rows, axis)? {
            plots.push((format!("-{}.svg", axis.as_str().replace(' ', "-")), svg));
        }
    }
    let runs = swept.rows.into_iter().map(|row| row.run).collect();
    context.publish_runs(&machine, runs, String::new(), &plots, &[("exponents", table)])?;
    swept.stopped.map_or(Ok(()), Err)
}

fn surfaces(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let table = surface::table(&mut machine, &context.setup, context.options.frame.unwrap_or(0))?;
    context.publish_table(&machine, &table)
}

fn flows(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    flow::check(&context.setup)?;
    let mut machine = context.open()?;
    let frames = context.measure.frames.unwrap_or(flow::FRAMES).max(1);
    let table = flow::table(&mut machine, &context.setup, frames)?;
    let temperatures = table.lines("time s", "kelvin", &flow::TEMPERATURES)?;
    context.save(&context.file("-temperatures.svg"), temperatures.as_bytes())?;
    let area = table.lines("time s", "square metres", &["area m2"])?;
    context.save(&context.file("-area.svg"), area.as_bytes())?;
    let effusion = table.lines("time s", "cubic metres per second", &["effusion m3/s"])?;
    context.save(&context.file("-effusion.svg"), effusion.as_bytes())?;
    context.publish_plotted(&machine, &table, table.lines("time s", "metres", &flow::LENGTHS))
}

fn stabilities(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    stability::check(&context.setup)?;
    let mut machine = context.open()?;
    let frames = context.measure.frames.unwrap_or(stability::FRAMES).max(1);
    let (mut rows, mut ended) = (Vec::new(), Ok(()));
    let mut keep = |rows: &[_]| context.keep_table(&stability::table(rows.to_vec()));
    context.console.watch("following the lava", &mut |watch| {
        ended = stability::follow(&mut machine, &context.setup, frames, watch, &mut rows, &mut keep);
    });
    if rows.is_empty() {
        return ended.and(Err(Error::Interrupted));
    }
    let table = stability::table(rows);
    let compressions = table.lines("time s", "% of the density at rest", &stability::COMPRESSIONS)?;
    context.save(&context.file("-compression.svg"), compressions.as_bytes())?;
    context.publish_plotted(&machine, &table, table.lines("time s", "metres per second", &stability::SPEEDS))?;
    ended.or_else(Error::unless_interrupted)
}

fn coolings(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    cooling::check(&context.setup)?;
    let mut machine = context.open()?;
    let frames = context.measure.frames.unwrap_or(flow::FRAMES).max(1);
    let table = cooling::table(&mut machine, &context.setup, frames)?;
    context.publish_table(&machine, &table)
}

fn radiances(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    radiance::check(&context.setup)?;
    let mut machine = context.open()?;
    let table = radiance::table(&mut machine, &context.setup)?;
    context.publish_table(&machine, &table)
}

fn shadings(context: &mut Context<'_>) -> Result<(), Error> {
    let points = shading::points(&context.setup);
    measured(context, &points, |machine, rows| {
        Ok(("shadings", shading::table(rows, &shading::contrasts(machine, &points)?)))
    })
}

fn normals_of(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let table = normals::table(&mut machine, &context.setup, context.options.frame.unwrap_or(0))?;
    context.publish_table(&machine, &table)
}

fn gaps_between(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let table = gaps::table(&mut machine, &context.setup, context.options.frame.unwrap_or(0))?;
    context.publish_table(&machine, &table)
}

fn cullings(context: &mut Context<'_>) -> Result<(), Error> {
    let points = culling::points(&context.setup, context.given.has("camera"));
    measured(context, &points, |_, rows| Ok(("kept", culling::table(rows))))
}

/// Measures the points, and publishes their runs with a named table of them.
fn measured(
    context: &mut Context<'_>,
    points: &[Point<Setup>],
    table: impl FnOnce(&mut Machine, &[Row]) -> Result<NamedTable, Error>,
) -> Result<(), Error> {
    let (mut machine, swept) = context.sweep_loaded(points)?;
    let table = table(&mut machine, &swept.rows)?;
    let runs = swept.rows.into_iter().map(|row| row.run).collect();
    context.publish_runs(&machine, runs, String::new(), &[], &[table])?;
    swept.stopped.map_or(Ok(()), Err)
}

fn motions(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let table = motion::table(&mut machine, &context.setup, context.options.frame.unwrap_or(motion::FRAME))?;
    context.publish_plotted(&machine, &table, table.lines("later s", "correlation", &["correlation"]))
}

fn strip_of(context: &mut Context<'_>) -> Result<(), Error> {
    context.setup.check()?;
    let mut machine = context.open()?;
    let sheet =
        contact_sheet::draw(&mut machine, &context.setup, context.options.frame.unwrap_or(contact_sheet::LAST_FRAME))?;
    context.picture(".png", &sheet)?;
    Ok(())
}
