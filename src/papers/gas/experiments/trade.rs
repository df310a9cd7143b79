//! Cost and picture by table size and by steps.

use glam::Vec3;
use serde_json::json;

use super::{Context, gpu_ms, point, samples};
use crate::image::{Rgba8, compare};
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::Row;
use crate::measure::{Error, picture};
use crate::papers::gas::setup::Setup;
use crate::papers::gas::{Parameters, Variant};
use crate::report::plot::{LineChart, Scale, Series};
use crate::scene::Light;

/// A linear brightness of 1 % as the picture holds it.
const ONE_PERCENT_SRGB: u8 = 25;

/// A number that is traded against the picture.
pub struct Trade {
    title: &'static str,
    x_label: &'static str,
    /// Counts of a sweep that names none.
    counts: &'static [u32],
    variant: Variant,
    set: fn(&mut Parameters, u32),
    /// The variant whose picture is the reference; without, the picture of the highest count is.
    reference: Option<Variant>,
}

/// Entries a side of the shadow table, against tracing.
pub static TABLE_SIZE: Trade = Trade {
    title: "Shadow table: cost and Luv difference from tracing, by entries a side",
    x_label: "entries a side",
    counts: &[16, 32, 64, 96, 128],
    variant: Variant::Table,
    set: |parameters, count| parameters.table_size = count,
    reference: Some(Variant::Traced),
};

/// Steps along the longest side, against the most.
pub static STEPS: Trade = Trade {
    title: "Volume: cost and Luv difference from the most steps, by steps",
    x_label: "steps",
    counts: &[10, 20, 40, 80, 160],
    variant: Variant::None,
    set: |parameters, count| parameters.steps = count,
    reference: None,
};

impl Trade {
    fn with(&self, setup: &Setup, count: u32) -> Setup {
        let mut setup = setup.clone();
        (self.set)(&mut setup.parameters, count);
        setup
    }

    /// Measures one point a count, and compares their pictures.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
    pub fn run(&self, context: &mut Context<'_>) -> Result<(), Error> {
        let setup = context.setup.named();
        let given = context.options.counts.as_slice();
        let counts = if given.is_empty() { self.counts } else { given };
        let point = |&count: &u32| point(&count.to_string(), f64::from(count), self.with(&setup, count), self.variant);
        let points: Vec<_> = counts.iter().map(point).collect();
        let (mut machine, swept) = context.sweep_loaded(&points)?;
        let table = self.table(&mut machine, &setup, &swept.rows)?;
        let points = swept.rows.iter().filter_map(|row| Some((row.x, row.run.median_frame_ms()?))).collect();
        let chart = LineChart {
            title: self.title.to_owned(),
            x_label: self.x_label.to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: Scale::Log,
            y_scale: Scale::Log,
            series: vec![Series { name: "frame".to_owned(), points, reference: false }],
        };
        context.keep_warnings(swept.rows);
        context.publish_plotted(&machine, &table, chart.to_svg())?;
        swept.stopped.map_or(Ok(()), Err)
    }

    /// The rows' times beside the Luv difference (eq. 2-9 of the caustics thesis) of their pictures from the reference,
    /// over the pixels in which the gas is denser than 1 % opacity.
    fn table(&self, machine: &mut Machine, setup: &Setup, rows: &[Row]) -> Result<ResultTable, Error> {
        let most =
            rows.iter().map(|row| row.x as u32).max().map_or_else(|| setup.clone(), |most| self.with(setup, most));
        let reference = match self.reference {
            Some(variant) => draw(machine, setup, variant)?,
            None => draw(machine, &most, self.variant)?,
        };
        let mask = gas_mask(machine, setup)?;
        let mut table = Vec::new();
        for row in rows {
            let count = row.x as u32;
            let drawn = draw(machine, &self.with(setup, count), self.variant)?;
            let difference = compare(&drawn, &reference, Some(&mask))?;
            table.push(vec![
                json!(count),
                json!(row.run.median_frame_ms()),
                json!(gpu_ms(row, &["density-table", "shadow-table"])),
                json!(gpu_ms(row, &["volume"])),
                samples(row),
                json!(difference.mean),
                json!(difference.p99),
                json!(difference.pixels),
            ]);
        }
        Ok(ResultTable {
            title: self.title,
            columns: &["count", "frame ms", "tables ms", "volume ms", "samples", "Luv mean", "Luv p99", "pixels"],
            rows: table,
        })
    }
}

pub(super) fn draw(machine: &mut Machine, setup: &Setup, variant: Variant) -> Result<Rgba8, Error> {
    let scene = setup.load()?;
    let mut built = build(machine, setup, &scene, variant)?;
    picture::render(machine, &mut built.paper, 0)
}

/// The pixels in which the gas that is seen has an opacity of more than 1 %: it shines with it, between black surfaces.
pub(super) fn gas_mask(machine: &mut Machine, setup: &Setup) -> Result<Vec<bool>, Error> {
    let mut study = setup.clone();
    let parameters = &mut study.parameters;
    parameters.volumes.iter_mut().for_each(|volume| volume.albedo = Vec3::ONE);
    parameters.lights = vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }];
    (parameters.ambient, parameters.background) = (Vec3::ONE, Vec3::ZERO);
    let mut scene = study.load()?;
    for object in &mut scene.objects {
        (object.color, object.checker, object.highlight.strength) = (Vec3::ZERO, None, 0.0);
    }
    let mut built = build(machine, &study, &scene, Variant::None)?;
    let opacity = picture::render(machine, &mut built.paper, 0)?;
    Ok(opacity.pixels().chunks_exact(4).map(|texel| texel[0] > ONE_PERCENT_SRGB).collect())
}
