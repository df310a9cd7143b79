//! Times of all passes as particles, splats and grid grow, and the exponent with which each
//! grows.

use serde_json::json;

use super::super::setup::Setup;
use crate::measure::Error;
use crate::measure::result_table::ResultTable;
use crate::measure::stress::scaling as fitted;
use crate::measure::sweep::{Point, Row};
use crate::papers::lava::Variant;
use crate::report::plot::{LineChart, Scale, Series};

/// A quantity that grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    Particles,
    Splats,
    Grid,
}

impl Axis {
    pub const ALL: [Axis; 3] = [Axis::Particles, Axis::Splats, Axis::Grid];

    pub fn as_str(self) -> &'static str {
        match self {
            Axis::Particles => "particles",
            Axis::Splats => "splats",
            Axis::Grid => "grid points",
        }
    }

    /// The setups of this axis, the rest as in `setup`: 10^4 to 10^6 particles, 1/9 to 4 times the splats, 1/8 to 8
    /// times the grid points. Where particles are added, their radius shrinks so that as many overlap as before.
    pub fn points(self, setup: &Setup) -> Vec<Point<Setup>> {
        let p = &setup.parameters;
        let point = |count: f64, change: &dyn Fn(&mut Setup)| {
            let mut study = setup.clone();
            change(&mut study);
            Point {
                label: format!("{count} {}", self.as_str()),
                x: count,
                study,
                variants: vec![Variant::Paper],
                left_out: Vec::new(),
            }
        };
        match self {
            Axis::Particles => [10_000, 31_623, 100_000, 316_228, 1_000_000]
                .map(|particles: u32| {
                    point(f64::from(particles), &|study| {
                        let fraction = f64::from(p.particles) / f64::from(particles);
                        study.parameters.particles = particles;
                        study.parameters.radius_m = (f64::from(p.radius_m) * fraction.cbrt()) as f32;
                    })
                })
                .into(),
            Axis::Splats => [1.0 / 3.0, 2.0 / 3.0, 1.0, 2.0]
                .map(|scale: f64| {
                    let splats = p.splats.map(|n| ((f64::from(n) * scale).round() as u32).max(1));
                    point(f64::from(splats[0]) * f64::from(splats[1]), &|study| {
                        study.parameters.splats = splats;
                        study.parameters.splat_radius_m = (f64::from(p.splat_radius_m) / scale) as f32;
                    })
                })
                .into(),
            Axis::Grid => [0.5, 1.0, 1.5, 2.0]
                .map(|scale: f64| {
                    let density = p.density.map(|n| ((f64::from(n) * scale).round() as u32).max(1));
                    point(density.iter().map(|&n| f64::from(n)).product(), &|study| {
                        study.parameters.density = density;
                    })
                })
                .into(),
        }
    }
}

/// One pass's time along an axis.
struct Curve {
    pass: String,
    clock: &'static str,
    /// Count and milliseconds.
    points: Vec<(f64, f64)>,
}

fn curves(rows: &[&Row]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut add = |pass: &str, clock, x: f64, ms: Option<f64>| {
        let Some(ms) = ms else { return };
        match curves.iter_mut().find(|c| c.pass == pass && c.clock == clock) {
            Some(curve) => curve.points.push((x, ms)),
            None => curves.push(Curve { pass: pass.to_owned(), clock, points: vec![(x, ms)] }),
        }
    };
    for row in rows {
        for pass in &row.run.passes {
            add(&pass.name, "gpu", row.x, pass.gpu_ms.as_ref().map(|s| s.median));
            add(&pass.name, "host", row.x, pass.host_ms.as_ref().map(|s| s.median));
            add(&pass.name, "wait", row.x, pass.wait_ms.as_ref().map(|s| s.median));
        }
        add("frame", "host", row.x, row.run.median_frame_ms());
    }
    curves
}

/// The axis that a row lies on.
fn rows_of(rows: &[Row], axis: Axis) -> Vec<&Row> {
    rows.iter().filter(|row| row.label.ends_with(&format!(" {}", axis.as_str()))).collect()
}

/// Times of all passes at all points, and the exponents of their growth with 95 % intervals.
pub fn table(rows: &[Row]) -> ResultTable {
    let mut table = Vec::new();
    for axis in Axis::ALL {
        for curve in curves(&rows_of(rows, axis)) {
            // Too few points for a knee.
            let fit = fitted(&curve.points).and_then(|scaling| scaling.segments.into_iter().next());
            let exponent = fit.as_ref().map(|segment| segment.exponent);
            let interval = fit.and_then(|segment| segment.interval);
            for (x, ms) in &curve.points {
                table.push(vec![
                    json!(axis.as_str()),
                    json!(*x as u64),
                    json!(curve.pass),
                    json!(curve.clock),
                    json!(ms),
                    json!(exponent),
                    json!(interval.map(|[low, _]| low)),
                    json!(interval.map(|[_, high]| high)),
                ]);
            }
        }
    }
    ResultTable {
        title: "Scaling: where each pass's time goes",
        columns: &["axis", "count", "pass", "clock", "ms", "exponent", "from", "to"],
        rows: table,
    }
}

/// One chart for an axis, both scales logarithmic; none without a row of the axis.
///
/// # Errors
/// [`Error::Plot`].
pub fn plot(rows: &[Row], axis: Axis) -> Result<Option<String>, Error> {
    let series: Vec<Series> = curves(&rows_of(rows, axis))
        .into_iter()
        .map(|c| Series { name: format!("{} ({})", c.pass, c.clock), points: c.points, reference: false })
        .collect();
    if series.is_empty() {
        return Ok(None);
    }
    let chart = LineChart {
        title: format!("Lava: time of each pass by {}", axis.as_str()),
        x_label: axis.as_str().to_owned(),
        y_label: "ms".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series,
    };
    Ok(Some(chart.to_svg()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::record::PassKind;

    fn rows_of_power(axis: Axis, counts: &[f64], ms: impl Fn(usize, f64) -> f64) -> Vec<Row> {
        let row = |(at, &x): (usize, &f64)| {
            let mut pass = example::pass("density", PassKind::Graphics);
            pass.gpu_ms = summarize(&[ms(at, x)]);
            let mut run = example::run();
            run.passes = vec![pass];
            Row { label: format!("{x} {}", axis.as_str()), x, run }
        };
        counts.iter().enumerate().map(row).collect()
    }

    /// Of a power law with a scatter of a few per cent, and of one without.
    #[test]
    fn exponents_stand_with_their_intervals() {
        let scatter = [1.03, 0.98, 1.01, 0.97, 1.02];
        let counts = [1e4, 3.1623e4, 1e5, 3.16228e5, 1e6];
        let mut rows = rows_of_power(Axis::Particles, &counts, |at, x| 2e-4 * x.powf(0.8) * scatter[at]);
        rows.extend(rows_of_power(Axis::Grid, &counts[..4], |_, x| 1e-3 * x));
        let table = table(&rows);
        assert_eq!(table.rows.len(), 9);
        let value = |row: usize, column: &str| {
            let at = table.columns.iter().position(|name| *name == column).unwrap();
            table.rows[row][at].as_f64().unwrap_or_else(|| panic!("{column}: {:?}", table.rows[row]))
        };
        let (exponent, from, to) = (value(0, "exponent"), value(0, "from"), value(0, "to"));
        assert!(from < 0.8 && 0.8 < to && to - from < 0.1 && (exponent - 0.8).abs() < 0.02, "{exponent} {from} {to}");
        assert!((value(8, "exponent") - 1.0).abs() < 1e-9 && value(8, "to") - value(8, "from") < 1e-6);
        assert!(plot(&rows, Axis::Grid).unwrap().is_some() && plot(&rows, Axis::Splats).unwrap().is_none());
    }

    #[test]
    fn as_many_particles_overlap_at_every_count() {
        let setup = Setup::default();
        for point in Axis::Particles.points(&setup) {
            let p = &point.study.parameters;
            let overlap = f64::from(p.particles) * f64::from(p.radius_m).powi(3);
            assert!(
                (overlap / (40_000.0 * f64::from(setup.parameters.radius_m).powi(3)) - 1.0).abs() < 1e-5,
                "{overlap}"
            );
        }
    }
}
