//! Froxels against fine quadrature along each pixel's ray, by their number.

use serde_json::{Value, json};

use super::savings::GAS_PASSES;
use super::trade::{draw, gas_mask};
use super::{Context, gpu_ms, point};
use crate::image::Rgba8;
use crate::image::compare;
use crate::image::compare::{distances, heat_map};
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::Row;
use crate::measure::{Error, Variant as _};
use crate::papers::gas::setup::Setup;
use crate::papers::gas::{March, Variant};

/// Divisors of the froxels along each axis of a sweep that names none.
const DIVISORS: [u32; 3] = [4, 2, 1];
/// Steps and samples of the fine rays over the scene's.
const FINER: u32 = 4;

/// Measures the paper's table and ever more froxels, and compares their pictures with that of fine rays and traced shadows.
///
/// # Errors
/// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
pub fn run(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.setup.named();
    let given = context.options.counts.as_slice();
    let divisors = if given.is_empty() { &DIVISORS } else { given };
    let with = |divisor: u32| {
        let mut setup = setup.clone();
        setup.parameters.froxels = setup.parameters.froxels.map(|count| (count / divisor.max(1)).max(1));
        setup
    };
    let mut points = vec![point(Variant::Table.as_str(), 0.0, setup.clone(), Variant::Table)];
    let of_froxels = |&divisor: &u32| point(&divisor.to_string(), f64::from(divisor), with(divisor), Variant::Froxel);
    points.extend(divisors.iter().map(of_froxels));
    let (mut machine, swept) = context.sweep_loaded(&points)?;

    let fine = draw(&mut machine, &fine(&setup), Variant::Traced)?;
    context.picture("-fine.png", &fine)?;
    let mask = gas_mask(&mut machine, &setup)?;
    let mut rows = Vec::new();
    for (point, row) in points.iter().zip(&swept.rows) {
        let drawn = draw(&mut machine, &point.study, point.variants[0])?;
        let apart = heat_map(drawn.width(), drawn.height(), &distances(&drawn, &fine)?)?;
        context.picture(&format!("-{}-difference.png", point.label), &apart)?;
        rows.push(cells(&point.study, row, &drawn, &fine, &mask)?);
    }
    let title = "Gas in froxels: cost and Luv difference from fine rays with traced shadows, by froxels";
    let columns = &["variant", "froxels", "frame ms", "gas ms", "Luv mean", "Luv p99", "pixels"];
    context.keep_warnings(swept.rows);
    context.publish_table(&machine, &ResultTable { title, columns, rows })?;
    swept.stopped.map_or(Ok(()), Err)
}

/// The same by rays as fine as they are taken, through all of the gas.
fn fine(setup: &Setup) -> Setup {
    let mut fine = setup.clone();
    let parameters = &mut fine.parameters;
    parameters.steps = (parameters.steps * FINER).min(parameters.steps.max(1000));
    parameters.samples = (parameters.samples * FINER).min(64);
    (parameters.march, parameters.early_end) = (March::Steps, 0.0);
    (parameters.density_cache, parameters.skip_empty) = (None, None);
    fine
}

fn cells(setup: &Setup, row: &Row, drawn: &Rgba8, fine: &Rgba8, mask: &[bool]) -> Result<Vec<Value>, Error> {
    let difference = compare(drawn, fine, Some(mask))?;
    let froxels = setup.parameters.froxels.map(|count| count.to_string()).join("x");
    let is_froxel = row.run.variant == Variant::Froxel.as_str();
    Ok(vec![
        json!(row.run.variant),
        json!(is_froxel.then_some(froxels)),
        json!(row.run.median_frame_ms()),
        json!(gpu_ms(row, &GAS_PASSES)),
        json!(difference.mean),
        json!(difference.p99),
        json!(difference.pixels),
    ])
}
