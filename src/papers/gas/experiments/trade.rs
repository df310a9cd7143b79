//! Cost and picture by table size and by steps.

use glam::Vec3;
use serde_json::json;

use super::{Context, gpu_ms, point};
use crate::image::{Rgba8, compare};
use crate::measure::bench::{build, load};
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::sweep::Row;
use crate::measure::{Error, picture};
use crate::papers::gas::Variant;
use crate::papers::gas::setup::Setup;
use crate::report::plot::{LineChart, Scale, Series};
use crate::scene::Light;

/// A linear brightness of 1 % as the picture holds it.
const ONE_PERCENT_SRGB: u8 = 25;

/// A number that is traded against the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Trade {
    /// Entries a side of the shadow table, against tracing.
    TableSize,
    /// Steps along the longest side, against the most.
    Steps,
}

impl Trade {
    /// Counts of a sweep that names none.
    fn counts(self) -> &'static [u32] {
        match self {
            Trade::TableSize => &[16, 32, 64, 96, 128],
            Trade::Steps => &[10, 20, 40, 80, 160],
        }
    }

    fn variant(self) -> Variant {
        match self {
            Trade::TableSize => Variant::Table,
            Trade::Steps => Variant::None,
        }
    }

    fn as_str(self) -> &'static str {
        match self {
            Trade::TableSize => "entries a side",
            Trade::Steps => "steps",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Trade::TableSize => "Shadow table: cost and Luv difference from tracing, by entries a side",
            Trade::Steps => "Volume: cost and Luv difference from the most steps, by steps",
        }
    }

    fn with(self, setup: &Setup, count: u32) -> Setup {
        let mut setup = setup.clone();
        match self {
            Trade::TableSize => setup.parameters.table_size = count,
            Trade::Steps => setup.parameters.steps = count,
        }
        setup
    }

    /// Measures one point a count, and compares their pictures.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Scene`], [`Error::Gpu`], [`Error::Image`], [`Error::Output`].
    pub fn run(self, context: &mut Context<'_>) -> Result<(), Error> {
        let setup = context.setup.named();
        let given = context.options.counts.as_slice();
        let counts = if given.is_empty() { self.counts() } else { given };
        let point =
            |&count: &u32| point(&count.to_string(), f64::from(count), self.with(&setup, count), self.variant());
        let points: Vec<_> = counts.iter().map(point).collect();
        points.iter().try_for_each(|point| load(&point.study).map(drop))?;
        let mut machine = context.open()?;
        let swept = context.sweep(&mut machine, &points)?;
        let table = self.table(&mut machine, &setup, &swept.rows)?;
        context.publish_plotted(&machine, &table, self.chart(&swept.rows).to_svg())?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), Err)
    }

    /// The rows' times beside the Luv difference (eq. 2-9 of the caustics thesis) of their pictures from the reference,
    /// over the pixels in which the gas is denser than 1 % opacity.
    fn table(self, machine: &mut Machine, setup: &Setup, rows: &[Row]) -> Result<ResultTable, Error> {
        let counts: Vec<u32> = rows.iter().map(|row| row.x as u32).collect();
        let reference = match self {
            Trade::TableSize => draw(machine, setup, Variant::Traced)?,
            Trade::Steps => {
                let most = counts.iter().max().map_or_else(|| setup.clone(), |&count| self.with(setup, count));
                draw(machine, &most, self.variant())?
            }
        };
        let mask = gas_mask(machine, setup)?;
        let mut table = Vec::new();
        for (row, &count) in rows.iter().zip(&counts) {
            let drawn = draw(machine, &self.with(setup, count), self.variant())?;
            let difference = compare(&drawn, &reference, Some(&mask))?;
            table.push(vec![
                json!(count),
                json!(row.run.median_frame_ms()),
                json!(gpu_ms(row, &["density-table", "shadow-table"])),
                json!(gpu_ms(row, &["volume"])),
                json!(difference.mean),
                json!(difference.p99),
                json!(difference.pixels),
            ]);
        }
        Ok(ResultTable {
            title: self.title(),
            columns: &["count", "frame ms", "tables ms", "volume ms", "Luv mean", "Luv p99", "pixels"],
            rows: table,
        })
    }

    /// Frame time by count.
    fn chart(self, rows: &[Row]) -> LineChart {
        let points = rows.iter().filter_map(|row| Some((row.x, row.run.median_frame_ms()?))).collect();
        LineChart {
            title: self.title().to_owned(),
            x_label: self.as_str().to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: Scale::Log,
            y_scale: Scale::Log,
            series: vec![Series { name: "frame".to_owned(), points, reference: false }],
        }
    }
}

fn draw(machine: &mut Machine, setup: &Setup, variant: Variant) -> Result<Rgba8, Error> {
    let scene = setup.load()?;
    let mut built = build(machine, setup, &scene, variant)?;
    picture::render(machine, &mut built.paper, 0)
}

/// The pixels in which the gas that is seen has an opacity of more than 1 %: it shines with it, between black surfaces.
fn gas_mask(machine: &mut Machine, setup: &Setup) -> Result<Vec<bool>, Error> {
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
