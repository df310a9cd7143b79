//! Lines over common axes.

use std::error::Error;
use std::ops::Range;

use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::{
    AXIS, Canvas, LABEL, Mark, PlotError, chart, color, extent, from_zero, padded, render, split_legend, tick,
};

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    #[default]
    Linear,
    /// Base 10, whole decades; points that are not positive are left out.
    Log,
}

/// The points of a line with more lie too close to be told apart by dots.
const MOST_DOTS: usize = 20;

/// One line of a [`LineChart`].
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Drawn in this order; points that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// Dashed: numbers to compare with, such as the paper's.
    pub reference: bool,
}

/// Lines over common axes, with a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// Line above the chart.
    pub title: String,
    /// Quantity and unit of the horizontal axis.
    pub x_label: String,
    /// Quantity and unit of the vertical axis.
    pub y_label: String,
    /// Scale of the horizontal axis.
    pub x_scale: Scale,
    /// Scale of the vertical axis.
    pub y_scale: Scale,
    /// At least one with a point that can be drawn.
    pub series: Vec<Series>,
}

impl LineChart {
    /// The chart as the text of an SVG file.
    ///
    /// # Errors
    /// No series has a point that can be drawn, or drawing failed.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let lines: Vec<Vec<(f64, f64)>> = self
            .series
            .iter()
            .map(|series| {
                let points = series.points.iter().copied();
                points.filter(|&(x, y)| fits(x, self.x_scale) && fits(y, self.y_scale)).collect()
            })
            .collect();
        let points = || lines.iter().flatten();
        let (Some(x), Some(y)) = (extent(points().map(|point| point.0)), extent(points().map(|point| point.1))) else {
            return Err(PlotError::NoData { title: self.title.clone() });
        };
        render(&self.title, |canvas| match (self.x_scale, self.y_scale) {
            (Scale::Linear, Scale::Linear) => self.draw(canvas, &lines, padded(x), from_zero(y)),
            (Scale::Linear, Scale::Log) => self.draw(canvas, &lines, padded(x), decades(y).log_scale()),
            (Scale::Log, Scale::Linear) => self.draw(canvas, &lines, decades(x).log_scale(), from_zero(y)),
            (Scale::Log, Scale::Log) => {
                let (x, y) = (decades(x).log_scale(), decades(y).log_scale());
                self.draw(canvas, &lines, x, y)
            }
        })
    }

    fn draw<X, Y>(&self, canvas: &Canvas, lines: &[Vec<(f64, f64)>], x: X, y: Y) -> Result<(), Box<dyn Error>>
    where
        X: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: AsRangedCoord<Value = f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let marks = self.series.iter().map(|series| match series.reference {
            true => (series.name.as_str(), Mark::Dashes),
            false => (series.name.as_str(), Mark::Line),
        });
        let canvas = split_legend(canvas, &marks.collect::<Vec<_>>())?;
        let mut chart = chart(&canvas, &self.title).build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .label_style(LABEL)
            .axis_desc_style(AXIS)
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .x_label_formatter(&|value| tick(*value))
            .y_label_formatter(&|value| tick(*value))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for (index, (series, points)) in self.series.iter().zip(lines).enumerate() {
            let style = color(index).stroke_width(2);
            let points = points.iter().copied();
            if series.reference {
                chart.draw_series(DashedLineSeries::new(points.clone(), 8, 6, style))?;
            } else {
                chart.draw_series(LineSeries::new(points.clone(), style))?;
            }
            if points.len() <= MOST_DOTS {
                chart.draw_series(points.map(|point| Circle::new(point, 3, color(index).filled())))?;
            }
        }
        Ok(())
    }
}

fn fits(value: f64, scale: Scale) -> bool {
    value.is_finite() && (scale == Scale::Linear || value > 0.0)
}

/// The whole decades around a positive range, at least one, so that the axis always has a labelled tick.
fn decades(range: Range<f64>) -> Range<f64> {
    let low = range.start.log10().floor().max(-300.0);
    let high = range.end.log10().ceil().max(low + 1.0).min(300.0);
    10_f64.powf(low)..10_f64.powf(high)
}

#[cfg(test)]
mod tests {
    use super::super::texts;
    use super::*;

    fn line_chart(y_scale: Scale, points: Vec<(f64, f64)>) -> LineChart {
        let series = |name: &str, factor: f64, reference| Series {
            name: name.to_owned(),
            points: points.iter().map(|&(x, y)| (x, factor * y)).collect(),
            reference,
        };
        LineChart {
            title: "Frame time <gas> & \"splats\"".to_owned(),
            x_label: "splats".to_owned(),
            y_label: "frame (ms)".to_owned(),
            x_scale: Scale::Linear,
            y_scale,
            series: vec![series("ours", 1.0, false), series("paper", 2.0, true)],
        }
    }

    #[test]
    fn line_charts_name_series_axes_and_title() {
        let points = vec![(100.0, 2.0), (1000.0, 25.0), (f64::NAN, 1.0)];
        let mut chart = line_chart(Scale::Linear, points);
        for (x_scale, y_scale) in [
            (Scale::Linear, Scale::Linear),
            (Scale::Linear, Scale::Log),
            (Scale::Log, Scale::Linear),
            (Scale::Log, Scale::Log),
        ] {
            (chart.x_scale, chart.y_scale) = (x_scale, y_scale);
            let texts = texts(&chart.to_svg().unwrap());
            for expected in ["ours", "paper", "splats", "frame (ms)", &chart.title] {
                assert!(texts.iter().any(|text| text == expected), "{expected}");
            }
        }
    }

    #[test]
    fn references_are_dashed() {
        let polylines = |chart: &LineChart| {
            let svg = chart.to_svg().unwrap();
            svg.matches("<polyline").count()
        };
        let mut chart = line_chart(Scale::Linear, vec![(0.0, 1.0), (1.0, 2.0)]);
        let dashed = polylines(&chart);
        chart.series[1].reference = false;
        assert!(dashed > polylines(&chart) + 10);
    }

    #[test]
    fn log_axes_drop_what_is_not_positive_and_label_decades() {
        let chart = line_chart(Scale::Log, vec![(1.0, 0.0), (2.0, -1.0), (3.0, 30.0)]);
        let texts = texts(&chart.to_svg().unwrap());
        assert!(texts.iter().any(|text| text == "10"), "{texts:?}");
        assert!(texts.iter().any(|text| text == "100"), "{texts:?}");
        assert_eq!(decades(0.5..0.5), 0.1..1.0);
        assert_eq!(decades(10.0..10.0), 10.0..100.0);
    }

    #[test]
    fn nothing_to_draw_is_an_error_that_names_the_plot() {
        for points in [vec![], vec![(1.0, 0.0)], vec![(f64::INFINITY, 1.0)]] {
            let error = line_chart(Scale::Log, points).to_svg().unwrap_err();
            assert!(matches!(error, PlotError::NoData { .. }));
            assert!(error.to_string().contains("Frame time"), "{error}");
        }
    }

    #[test]
    fn extreme_numbers_can_be_drawn() {
        for scale in [Scale::Linear, Scale::Log] {
            for value in [1e-300, 1e-9, 1e15, 1e300] {
                let chart = line_chart(scale, vec![(0.0, value), (1.0, value)]);
                texts(&chart.to_svg().unwrap());
            }
        }
    }
}
