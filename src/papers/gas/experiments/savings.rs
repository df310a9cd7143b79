//! Time that tables of densities and skipped bricks save, and their error in the picture.

use serde_json::json;

use super::trade::{draw, gas_mask};
use super::{Context, gpu_ms, point, samples};
use crate::image::compare;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::Row;
use crate::papers::gas::Variant;
use crate::papers::gas::parameters::or_off::OrOff;
use crate::papers::gas::scenes::Preset;
use crate::papers::gas::setup::Setup;

/// Entries a side of a sweep that names none.
const ENTRIES: [u32; 4] = [24, 32, 48, 64];
/// Optical depths that skipped bricks may have.
const DEPTHS: [f32; 3] = [0.0, 0.01, 0.05];
/// Columns and rows from one pixel whose gas is marched to the next, of a sweep that names none.
const SCALES: [u32; 3] = [2, 4, 8];
/// Scenes of which skipping is tried: fog behind its front, steam, a ball in its box.
const SCENES: [Preset; 3] = [Preset::Fig7, Preset::Fig8, Preset::Solid];

/// Passes whose time follows from the densities.
pub(super) const GAS_PASSES: [&str; 8] = [
    "density-cache",
    "bricks",
    "density-table",
    "shadow-table",
    "froxel-inject",
    "froxel-integrate",
    "volume",
    "light-attenuation",
];

/// Rays that ask the density's function, and those that read tables of it, in turn.
///
/// # Errors
/// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
pub fn cache(context: &mut Context<'_>) -> Result<(), Error> {
    let given = context.options.counts.as_slice();
    let counts = if given.is_empty() { &ENTRIES } else { given };
    let mut setup = context.setup.named();
    setup.alternatives.density_caches = [None].into_iter().chain(counts.iter().copied().map(Some)).map(OrOff).collect();
    let title = "Table of densities: cost and Luv difference from their functions, by entries a side";
    run(context, &[setup], &[Variant::None, Variant::Traced, Variant::Table], title)
}

/// Rays through all bricks, and those that skip the empty ones, in turn.
///
/// # Errors
/// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
pub fn skipping(context: &mut Context<'_>) -> Result<(), Error> {
    let mut setups = context.setup.in_scenes(&SCENES)?;
    for setup in &mut setups {
        setup.alternatives.skips = [None].into_iter().chain(DEPTHS.map(Some)).map(OrOff).collect();
    }
    let title = "Skipped bricks: cost and Luv difference from all, by the optical depth that a ray may lose";
    run(context, &setups, &[Variant::None, Variant::Traced], title)
}

/// Gas that is marched in every pixel, and in ever fewer ones, in turn.
///
/// # Errors
/// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
pub fn scale(context: &mut Context<'_>) -> Result<(), Error> {
    let given = context.options.counts.as_slice();
    let counts = if given.is_empty() { &SCALES } else { given };
    let mut setup = context.setup.named();
    setup.alternatives.scales = [1].into_iter().chain(counts.iter().copied().filter(|&count| count != 1)).collect();
    let title = "Gas of fewer pixels: cost and Luv difference from that of all, by columns and rows between them";
    run(context, &[setup], &[Variant::None], title)
}

fn run(context: &mut Context<'_>, setups: &[Setup], variants: &[Variant], title: &'static str) -> Result<(), Error> {
    let mut points = Vec::new();
    for setup in setups {
        points.extend(variants.iter().map(|&variant| point(setup.scene.as_str(), 0.0, setup.clone(), variant)));
    }
    let (mut machine, swept) = context.sweep_loaded(&points)?;
    let mut rows = swept.rows.as_slice();
    let mut cells = Vec::new();
    for point in &points {
        let alternatives = point.study.alternatives();
        let (of_point, others) = rows.split_at(alternatives.len().min(rows.len()));
        for &variant in &point.variants {
            cells.extend(compared(&mut machine, &alternatives, variant, of_point)?);
        }
        rows = others;
    }
    let columns = &[
        "scene",
        "variant",
        "density-cache",
        "skip-empty",
        "volume-scale",
        "frame ms",
        "gas ms",
        "of the first",
        "samples",
        "Luv mean",
        "Luv p99",
    ];
    context.keep_warnings(swept.rows);
    context.publish_table(&machine, &ResultTable { title, columns, rows: cells })?;
    swept.stopped.map_or(Ok(()), Err)
}

/// A row for each alternative; the first is what the others are set against.
fn compared(
    machine: &mut Machine,
    alternatives: &[Setup],
    variant: Variant,
    rows: &[Row],
) -> Result<Vec<Vec<serde_json::Value>>, Error> {
    let (Some(first), Some(first_row)) = (alternatives.first(), rows.first()) else { return Ok(Vec::new()) };
    let mask = gas_mask(machine, first)?;
    let (reference, all_ms) = (draw(machine, first, variant)?, gpu_ms(first_row, &GAS_PASSES));
    let mut cells = Vec::new();
    for (alternative, row) in alternatives.iter().zip(rows) {
        let difference = compare(&draw(machine, alternative, variant)?, &reference, Some(&mask))?;
        let (parameters, ms) = (&alternative.parameters, gpu_ms(row, &GAS_PASSES));
        cells.push(vec![
            json!(alternative.scene.as_str()),
            json!(row.run.variant),
            json!(parameters.density_cache),
            json!(parameters.skip_empty),
            json!(parameters.volume_scale),
            json!(row.run.median_frame_ms()),
            json!(ms),
            json!(Some(ms / all_ms).filter(|ratio| ratio.is_finite())),
            samples(row),
            json!(difference.mean),
            json!(difference.p99),
        ]);
    }
    Ok(cells)
}
