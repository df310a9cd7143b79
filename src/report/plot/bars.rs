//! Bars: grouped values and histograms.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{AXIS, LABEL, Mark, PlotError, chart, color, extent, from_zero, padded, render, split_legend, tick};

/// Groups of bars from zero, one bar per series in each group, with a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// Line above the chart.
    pub title: String,
    /// Quantity and unit of the vertical axis.
    pub y_label: String,
    /// Names under the groups.
    pub groups: Vec<String>,
    /// At least one with a value that can be drawn.
    pub series: Vec<BarSeries>,
}

/// One bar in each group.
#[derive(Clone, Debug, PartialEq)]
pub struct BarSeries {
    /// Name in the legend.
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
        let values = self.series.iter().flat_map(|series| (0..count).filter_map(|group| series.value(group)));
        let y = from_zero(extent(values).ok_or_else(|| PlotError::NoData { title: self.title.clone() })?);
        render(&self.title, |canvas| {
            let names = self.series.iter().map(|series| series.name.as_str());
            let marks: Vec<_> = names.map(|name| (name, Mark::Patch)).collect();
            let canvas = split_legend(canvas, &marks)?;
            let mut chart = chart(&canvas, &self.title).build_cartesian_2d(0.0..count as f64, y.clone())?;
            chart
                .configure_mesh()
                .label_style(LABEL)
                .axis_desc_style(AXIS)
                .disable_x_mesh()
                .x_labels(0)
                .y_label_formatter(&|value| tick(*value))
                .y_desc(&self.y_label)
                .light_line_style(TRANSPARENT)
                .draw()?;
            let centered = Pos::new(HPos::Center, VPos::Top);
            let name_style = LABEL.into_text_style(&canvas).pos(centered);
            for (group, name) in self.groups.iter().enumerate() {
                let (x, y) = chart.backend_coord(&(group as f64 + 0.5, y.start));
                canvas.draw_text(name, &name_style, (x, y + 8))?;
            }
            // A fifth of each group's width stays free as the gap to the next.
            let width = 0.8 / self.series.len() as f64;
            for (index, series) in self.series.iter().enumerate() {
                let style = color(index).filled();
                let bars = (0..count).filter_map(|group| {
                    let left = group as f64 + 0.1 + index as f64 * width;
                    let top = series.value(group)?;
                    Some(Rectangle::new([(left, 0.0), (left + width, top)], style))
                });
                chart.draw_series(bars)?;
            }
            Ok(())
        })
    }
}

/// Counts of samples in equally wide bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Line above the chart.
    pub title: String,
    /// Quantity and unit of the samples.
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
        let x = padded(extent(finite()).ok_or_else(|| PlotError::NoData { title: self.title.clone() })?);
        let bins = self.bins.clamp(1, 1000);
        let width = (x.end - x.start) / bins as f64;
        let mut counts = vec![0_u32; bins];
        for sample in finite() {
            let bin = ((sample - x.start) / width) as usize;
            counts[bin.min(bins - 1)] += 1;
        }
        let highest = f64::from(counts.iter().copied().max().unwrap_or(0));
        render(&self.title, |canvas| {
            let mut chart = chart(canvas, &self.title).build_cartesian_2d(x.clone(), from_zero(0.0..highest))?;
            chart
                .configure_mesh()
                .label_style(LABEL)
                .axis_desc_style(AXIS)
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
        let series = |name: &str, values: &[Option<f64>]| BarSeries { name: name.to_owned(), values: values.to_vec() };
        let chart = BarChart {
            title: "Table 2".to_owned(),
            y_label: "frame (ms)".to_owned(),
            groups: vec!["teapot".to_owned(), "box & sphere".to_owned()],
            series: vec![series("ours", &[Some(3.0), Some(4.0)]), series("paper", &[Some(30.0), None])],
        };
        let svg = chart.to_svg().unwrap();
        let texts = texts(&svg);
        for expected in ["ours", "paper", "teapot", "box & sphere", "frame (ms)"] {
            assert!(texts.iter().any(|text| text == expected), "{expected}");
        }
        // The legend's own patch is one more.
        assert_eq!((rectangles(&svg, 0), rectangles(&svg, 1)), (3, 2));

        let empty = BarChart { groups: vec![], ..chart };
        assert!(matches!(empty.to_svg(), Err(PlotError::NoData { .. })));
    }

    #[test]
    fn names_stand_under_the_middle_of_their_bars() {
        for count in 1..6 {
            let chart = BarChart {
                title: String::new(),
                y_label: String::new(),
                groups: (0..count).map(|group| format!("group {group}")).collect(),
                series: vec![BarSeries { name: String::new(), values: vec![Some(1.0); count] }],
            };
            let svg = chart.to_svg().unwrap();
            let document = roxmltree::Document::parse(&svg).unwrap();
            let number = |node: roxmltree::Node, name: &str| -> f64 { node.attribute(name).unwrap().parse().unwrap() };
            let middles = document
                .descendants()
                .filter(|node| node.has_tag_name("rect"))
                .filter(|node| node.attribute("fill") == Some("#0072B2"))
                .filter(|node| number(*node, "height") > 50.0)
                .map(|bar| number(bar, "x") + 0.5 * number(bar, "width"));
            let names = document
                .descendants()
                .filter(|node| node.has_tag_name("text"))
                .filter(|node| node.text().is_some_and(|t| t.contains("group")))
                .map(|name| number(name, "x"));
            let distances: Vec<f64> = middles.zip(names).map(|(bar, name)| bar - name).collect();
            assert_eq!(distances.len(), count);
            assert!(distances.iter().all(|d| d.abs() < 2.0), "{distances:?}");
        }
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
