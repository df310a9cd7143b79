//! The dissertation's frame rates, ours beside them (3.8, 5.5, 6.5), at the frame of a fire with most particles.

use super::super::setup::Setup;
use super::presets;
use super::sweeps::{at_tick, point};
use crate::measure::Error;
use crate::measure::study::Preset;
use crate::measure::sweep::Point;
use crate::papers::burning::Variant;
use crate::report::plot::{BarChart, BarSeries};
use crate::report::record::{ExperimentRow, Run, Summary};
use crate::report::table::{Align, Style, Table, number};

/// A frame rate that the dissertation reports, by a GeForce 9800 GTS.
pub struct Claim {
    section: &'static str,
    /// The model and its constants.
    pub preset: Preset<Setup>,
    frames_per_s: f64,
}

/// Sections 3.8, 5.5 and 6.5.
pub const CLAIMS: [Claim; 3] = [
    Claim { section: "3.8", preset: presets::RESULTS_3_8, frames_per_s: 70.0 },
    Claim { section: "5.5", preset: presets::SOLID_45K, frames_per_s: 60.0 },
    Claim { section: "6.5", preset: presets::MELT_40K, frames_per_s: 60.0 },
];

impl Claim {
    /// The method of its chapter.
    pub fn variant(&self) -> Variant {
        self.preset.variant.unwrap_or(Variant::Shell)
    }

    /// The point to measure: the fire at `tick`.
    pub fn point(&self, setup: &Setup, tick: u32) -> Point<Setup> {
        let study = at_tick(setup, tick, |_| ());
        Point { variants: vec![self.variant()], ..point(format!("tick {tick}"), f64::from(tick), study) }
    }

    /// Notes the dissertation's figure beside ours.
    pub fn note(&self, run: &mut Run) {
        let ours = run.median_frame_ms().map(|ms| 1e3 / ms);
        let row = format!("{}: frames per second", self.section);
        run.experiment = Some(ExperimentRow::new(row, self.frames_per_s, ours, None));
    }

    /// The table: passes with their times, what is burning, the frame rate beside the dissertation's.
    pub fn render(&self, label: &str, run: &Run, style: Style) -> String {
        let mut table = Table::new(&[
            ("pass", Align::Left),
            ("section", Align::Left),
            ("calls", Align::Right),
            ("gpu ms", Align::Right),
        ]);
        for pass in &run.passes {
            let section = pass.section.clone().unwrap_or_default();
            table.push(vec![pass.name.clone(), section, pass.calls.to_string(), number(median(&pass.gpu_ms), 2)]);
        }
        let title = format!("Section {}: {}, {label}", self.section, self.preset.name);
        let count = |name: &str| run.results.get(name).map(ToString::to_string).unwrap_or_default();
        format!(
            "{}\n{}{} of {} triangles active, {} drawn, {} removed, {} fire and {} smoke particles\n\
             frame {} ms, {} frames a second; the dissertation: {} (GeForce 9800 GTS)\n",
            style.bold(&title),
            table.render(style),
            count("active_triangles"),
            count("finest_triangles"),
            count("drawn_triangles"),
            count("removed_triangles"),
            count("fire_particles"),
            count("smoke_particles"),
            number(run.median_frame_ms(), 1),
            number(run.experiment.as_ref().and_then(|row| row.ours), 1),
            self.frames_per_s,
        )
    }

    /// Milliseconds of every pass.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plot(&self, run: &Run) -> Result<String, Error> {
        let chart = BarChart {
            title: format!("{}: where a frame's time goes", self.preset.name),
            y_label: "ms".to_owned(),
            groups: run.passes.iter().map(|p| p.name.clone()).collect(),
            series: vec![BarSeries {
                name: "gpu".to_owned(),
                values: run.passes.iter().map(|p| median(&p.gpu_ms)).collect(),
            }],
        };
        Ok(chart.to_svg()?)
    }
}

fn median(summary: &Option<Summary>) -> Option<f64> {
    summary.as_ref().map(|s| s.median)
}
