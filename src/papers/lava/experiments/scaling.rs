//! Times of all passes as particles, splats and grid grow, and the exponent with which each
//! grows.

use serde_json::json;

use super::super::setup::Setup;
use crate::measure::Error;
use crate::measure::result_table::ResultTable;
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

/// The exponent of growth: the slope of time over count in logarithms, by least squares. Absent with fewer than two
/// points.
fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let (mean_x, mean_y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let spread: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let slope = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum::<f64>() / spread;
    Some(slope).filter(|s| s.is_finite())
}

/// The axis that a row lies on.
fn rows_of(rows: &[Row], axis: Axis) -> Vec<&Row> {
    rows.iter().filter(|row| row.label.ends_with(&format!(" {}", axis.as_str()))).collect()
}

/// Times of all passes at all points, and their exponents.
pub fn table(rows: &[Row]) -> ResultTable {
    let mut table = Vec::new();
    for axis in Axis::ALL {
        for curve in curves(&rows_of(rows, axis)) {
            let growth = exponent(&curve.points);
            for (x, ms) in &curve.points {
                table.push(vec![
                    json!(axis.as_str()),
                    json!(*x as u64),
                    json!(curve.pass),
                    json!(curve.clock),
                    json!(ms),
                    json!(growth),
                ]);
            }
        }
    }
    ResultTable {
        title: "Scaling: where each pass's time goes",
        columns: &["axis", "count", "pass", "clock", "ms", "exponent"],
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
    use super::exponent;

    #[test]
    fn the_exponent_is_the_slope_in_logarithms() {
        let power = |k: f64| [1.0, 10.0, 300.0].map(|x: f64| (x, 2.5 * x.powf(k)));
        for k in [0.0, 0.5, 1.0, 2.0] {
            assert!((exponent(&power(k)).unwrap() - k).abs() < 1e-12);
        }
        assert_eq!(exponent(&[(1.0, 2.0)]), None);
        assert_eq!(exponent(&[]), None);
    }
}
