//! Cost of a tick by the fraction of the vertices that are active: its passes follow the fire, not the mesh.

use serde_json::json;

use super::super::setup::Setup;
use super::sweeps::{SIMULATION, at_tick, gpu_ms, passes_plot, point, result};
use crate::measure::Error;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::burning::{Parameters, TICKS_PER_S};
use crate::report::record::Run;

/// Shares of the vertices that are active.
const FRACTIONS: [f64; 7] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7];
/// Of the vertices, those of the deformed area: all points are of one tick, and differ by how long a vertex burns alone.
const REACHED: f64 = 0.75;

/// The numbers without any given: a large object without particles.
pub fn setup() -> Setup {
    let parameters = Parameters { speed_per_s: 0.2, fire: 0, smoke: 0, ..Parameters::default() };
    Setup { parameters, triangles: Some(1_000_000), ..Setup::default() }
}

/// One point a share, of an object whose vertices the boundary reaches at the radii `reaches`.
pub fn points(setup: &Setup, mut reaches: Vec<f64>) -> Vec<Point<Setup>> {
    reaches.sort_by(f64::total_cmp);
    let reach_of = |fraction: f64| {
        let place = (fraction * reaches.len() as f64) as usize;
        reaches.get(place).or(reaches.last()).copied().unwrap_or(0.0)
    };
    let p = &setup.parameters;
    let ticks_to = |radius: f64| radius / f64::from(p.speed_per_s) * TICKS_PER_S;
    let tick = ticks_to(reach_of(REACHED) + 2.0 * f64::from(p.width_of_areas)).ceil() as u32;
    let of = |fraction: f64| {
        let burns = ticks_to(reach_of(REACHED) - reach_of(REACHED - fraction)).round().max(1.0) as u32;
        let study = at_tick(setup, tick, |p| p.flammability = burns);
        point(format!("{} %", 100.0 * fraction), fraction, study)
    };
    FRACTIONS.map(of).into()
}

/// Share of the vertices that were active.
fn active(run: &Run) -> Option<f64> {
    let [active, all] = ["active_vertices", "vertices"].map(|name| result(run, name).as_f64());
    active.zip(all).map(|(active, all)| active / all)
}

/// Times of the passes of a tick, and of the rest of the frame.
pub fn table(rows: &[Row]) -> ResultTable {
    let tick = |run: &Run| gpu_ms(run, &SIMULATION);
    let fullest = rows.last().and_then(|row| tick(&row.run));
    let rows = rows.iter().map(|row| {
        let run = &row.run;
        let of = |pass: &str| json!(gpu_ms(run, &[pass]));
        vec![
            json!(active(run).map(|fraction| 100.0 * fraction)),
            of("heat-boundary"),
            of("internal-deformation"),
            of("block-weights"),
            of("block-rotation"),
            json!(tick(run)),
            json!(tick(run).zip(fullest).map(|(ms, most)| 100.0 * ms / most)),
            of("surface-removal"),
            json!(run.median_frame_ms()),
        ]
    });
    ResultTable {
        title: "A tick by the share of active vertices",
        columns: &[
            "active %",
            "heat-boundary ms",
            "internal-deformation ms",
            "block-weights ms",
            "block-rotation ms",
            "simulation ms",
            "% of the fullest",
            "surface-removal ms",
            "frame ms",
        ],
        rows: rows.collect(),
    }
}

/// Time of each pass by the share.
///
/// # Errors
/// [`Error::Plot`].
pub fn plot(rows: &[Row]) -> Result<String, Error> {
    let percent = |run: &Run| Some(100.0 * active(run)?);
    let labels = ["Burning: time of a tick by active vertices", "active vertices, %"];
    passes_plot(rows, labels, &percent, ("simulation", &|run| gpu_ms(run, &SIMULATION)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_of_one_tick_and_burn_as_long_as_their_share_takes() {
        // A boundary that reaches a hundredth of the vertices in each hundredth of a diagonal.
        let reaches: Vec<f64> = (0..10_000).rev().map(|i| f64::from(i) / 10_000.0).collect();
        let points = points(&setup(), reaches);
        let ticks_to = |radius: f64| radius / 0.2 * 60.0;
        for (point, fraction) in points.iter().zip(FRACTIONS) {
            let p = &point.study.parameters;
            assert_eq!(f64::from(p.first_frame + 1), ticks_to(0.75 + 0.08).ceil());
            assert!((f64::from(p.flammability) - ticks_to(fraction)).abs() <= 0.5, "{fraction}: {}", p.flammability);
        }
    }
}
