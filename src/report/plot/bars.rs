//! Bars: grouped values and histograms.

use plotters::prelude::*;

use super::{PlotError, chart, color, extent, from_zero, padded, render, tick};

/// Groups of bars from zero, one bar per series in each group, with a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    pub title: String,
    pub y_label: String,
    /// Names under the groups.
    pub groups: Vec<String>,
    pub series: Vec<BarSeries>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    pub name: String,
    /// One value per group; absent, missing and not finite ones have no bar.
    pub values: Vec<Option<f64>>,
}

impl BarSeries {
    fn value(&self, group: usize) -> Option<f64> {
        let value = self.values.get(group).copied().flatten();
        value.filter(|value| value.is_finite())
    }
}

impl BarChart {
    /// The chart as the text of an SVG file.
    ///
    /// # Errors
    /// No series has a value that can be drawn, or drawing failed.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let count = self.groups.len();
        let values = self
            .series
            .iter()
            .flat_map(|series| (0..count).filter_map(|group| series.value(group)));
        let y = from_zero(extent(values).ok_or_else(|| PlotError::NoData {
            title: self.title.clone(),
        })?);
        render(&self.title, |canvas| {
            // The first coordinates name the groups, the second place bars inside them.
            let mut chart = chart(canvas, &self.title)
                .build_cartesian_2d((0..count).into_segmented(), y.clone())?
                .set_secondary_coord(0.0..count as f64, y);
            chart
                .configure_mesh()
                .disable_x_mesh()
                .x_labels(count)
                .x_label_formatter(&|segment| match segment {
                    SegmentValue::CenterOf(group) => {
                        self.groups.get(*group).cloned().unwrap_or_default()
                    }
                    SegmentValue::Exact(_) | SegmentValue::Last => String::new(),
                })
                .y_label_formatter(&|value| tick(*value))
                .y_desc(&self.y_label)
                .light_line_style(TRANSPARENT)
                .draw()?;
            // A fifth of each group's width stays free as the gap to the next.
            let width = 0.8 / self.series.len() as f64;
            for (index, series) in self.series.iter().enumerate() {
                let style = color(index).filled();
                let bars = (0..count).filter_map(|group| {
                    let left = group as f64 + 0.1 + index as f64 * width;
                    let top = series.value(group)?;
                    Some(Rectangle::new([(left, 0.0), (left + width, top)], style))
                });
                chart
                    .draw_secondary_series(bars)?
                    .label(&series.name)
                    .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 20, y + 5)], style));
            }
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.8))
                .border_style(BLACK.mix(0.3))
                .draw()?;
            Ok(())
        })
    }
}

/// How often samples fall into equally wide bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    pub title: String,
    pub x_label: String,
    /// Samples that are not finite are left out.
    pub samples: Vec<f64>,
    /// Between 1 and 1000; other numbers are moved into that range.
    pub bins: usize,
}

impl Histogram {
    /// The histogram as the text of an SVG file.
    ///
    /// # Errors
    /// There is no finite sample, or drawing failed.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let finite = || self.samples.iter().copied().filter(|x| x.is_finite());
        let x = padded(extent(finite()).ok_or_else(|| PlotError::NoData {
            title: self.title.clone(),
        })?);
        let bins = self.bins.clamp(1, 1000);
        let width = (x.end - x.start) / bins as f64;
        let mut counts = vec![0_u32; bins];
        for sample in finite() {
            let bin = ((sample - x.start) / width) as usize;
            counts[bin.min(bins - 1)] += 1;
        }
        let highest = f64::from(counts.iter().copied().max().unwrap_or(0));
        render(&self.title, |canvas| {
            let mut chart = chart(canvas, &self.title)
                .build_cartesian_2d(x.clone(), from_zero(0.0..highest))?;
            chart
                .configure_mesh()
                .disable_x_mesh()
                .x_desc(&self.x_label)
                .y_desc("samples")
                .x_label_formatter(&|value| tick(*value))
                .y_label_formatter(&|value| tick(*value))
                .light_line_style(TRANSPARENT)
                .draw()?;
            chart.draw_series(counts.iter().enumerate().map(|(bin, &count)| {
                let left = x.start + bin as f64 * width;
                let corners = [(left, 0.0), (left + width, f64::from(count))];
                Rectangle::new(corners, color(0).filled())
            }))?;
            Ok(())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::texts;
    use super::*;

    fn rectangles(svg: &str, index: usize) -> usize {
        let RGBColor(red, green, blue) = color(index);
        let fill = format!("fill=\"#{red:02X}{green:02X}{blue:02X}\"");
        let bars = svg.lines().filter(|line| line.starts_with("<rect"));
        bars.filter(|line| line.contains(&fill)).count()
    }

    #[test]
    fn bar_charts_name_groups_and_series_and_leave_absent_bars_out() {
        let series = |name: &str, values: &[Option<f64>]| BarSeries {
            name: name.to_owned(),
            values: values.to_vec(),
        };
        let chart = BarChart {
            title: "Table 2".to_owned(),
            y_label: "frame (ms)".to_owned(),
            groups: vec!["teapot".to_owned(), "box & sphere".to_owned()],
            series: vec![
                series("ours", &[Some(3.0), Some(4.0)]),
                series("paper", &[Some(30.0), None]),
            ],
        };
        let svg = chart.to_svg().unwrap();
        let texts = texts(&svg);
        for expected in ["ours", "paper", "teapot", "box & sphere", "frame (ms)"] {
            assert!(texts.iter().any(|text| text == expected), "{expected}");
        }
        // The legend's own patch is one more.
        assert_eq!((rectangles(&svg, 0), rectangles(&svg, 1)), (3, 2));

        let empty = BarChart {
            groups: vec![],
            ..chart
        };
        assert!(matches!(empty.to_svg(), Err(PlotError::NoData { .. })));
    }

    #[test]
    fn histograms_have_a_bar_a_bin() {
        let mut histogram = Histogram {
            title: "frames".to_owned(),
            x_label: "ms".to_owned(),
            samples: vec![1.0, 1.1, 1.2, 5.0, f64::NAN],
            bins: 8,
        };
        let svg = histogram.to_svg().unwrap();
        assert_eq!(rectangles(&svg, 0), 8);
        assert!(texts(&svg).iter().any(|text| text == "ms"));
        histogram.bins = 0;
        assert_eq!(rectangles(&histogram.to_svg().unwrap(), 0), 1);
        histogram.samples.clear();
        assert!(matches!(histogram.to_svg(), Err(PlotError::NoData { .. })));
    }
}
