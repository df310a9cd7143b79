//! Plots as SVG text: line charts, bar charts and histograms.
//!
//! Text is laid out from estimated widths and drawn by whoever shows the file, so no font is looked up and none needs
//! to be installed.

mod bars;
mod line;

pub use bars::{BarChart, BarSeries, Histogram};
pub use line::{LineChart, Scale, Series};

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::text::escaped;

/// Width and height of every plot in pixels.
pub const SIZE: (u32, u32) = (960, 540);

/// Reasons why there is no chart.
#[derive(Debug, thiserror::Error)]
pub enum PlotError {
    #[error("cannot draw the plot \"{title}\": it has no point that can be drawn; measure at least one")]
    NoData {
        /// Title of the plot.
        title: String,
    },
    #[error("cannot draw the plot \"{title}\": {message}; write the numbers with --csv instead")]
    Drawing {
        /// Title of the plot.
        title: String,
        /// Message of the plotting library.
        message: String,
    },
}

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn render(title: &str, draw: impl FnOnce(&Canvas) -> Result<(), Box<dyn Error>>) -> Result<String, PlotError> {
    let mut svg = String::new();
    let drawn = {
        let canvas = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        canvas
            .fill(&WHITE)
            .map_err(Into::into)
            .and_then(|()| draw(&canvas))
            .and_then(|()| canvas.present().map_err(Into::into))
    };
    drawn.map_err(|error| PlotError::Drawing { title: title.to_owned(), message: error.to_string() })?;
    // XML has no way to write most control characters.
    Ok(escaped(&svg, false).into_owned())
}

fn chart<'a, 'b>(canvas: &'b Canvas<'a>, title: &str) -> ChartBuilder<'b, 'b, SVGBackend<'a>> {
    let mut builder = ChartBuilder::on(canvas);
    builder.margin(16).caption(title, ("sans-serif", 22)).x_label_area_size(52).y_label_area_size(76);
    builder
}

const LABEL: (&str, u32) = ("sans-serif", 14);
const AXIS: (&str, u32) = ("sans-serif", 15);

/// Sample of a series in a legend.
#[derive(Clone, Copy)]
enum Mark {
    Line,
    Dashes,
    Patch,
}

/// Draws the legend, series by series in the order of their colours, in a column on the right where it covers no data,
/// and returns the rest of the canvas.
fn split_legend<'a>(canvas: &Canvas<'a>, series: &[(&str, Mark)]) -> Result<Canvas<'a>, Box<dyn Error>> {
    const LINE_HEIGHT: i32 = 24;
    // An average letter is about half as wide as high; a name that is too long even so runs out of the picture.
    let longest = series.iter().map(|(name, _)| name.chars().count()).max();
    let width = (64 + 8 * longest.unwrap_or(0)).min(SIZE.0 as usize / 2) as u32;
    let (rest, legend) = canvas.split_horizontally(SIZE.0 - width);
    for (index, (name, mark)) in series.iter().enumerate() {
        let y = 64 + LINE_HEIGHT * index as i32;
        let style = color(index).stroke_width(2);
        let line = [(8, y), (36, y)];
        match mark {
            Mark::Line => legend.draw(&PathElement::new(line, style))?,
            Mark::Dashes => legend.draw(&DashedPathElement::new(line, 8, 4, style))?,
            Mark::Patch => legend.draw(&Rectangle::new([(8, y - 6), (36, y + 6)], color(index).filled()))?,
        }
        legend.draw(&Text::new((*name).to_owned(), (44, y - 7), LABEL))?;
    }
    Ok(rest)
}

/// Okabe and Ito's palette, which people with any colour vision can tell apart; it repeats after seven.
fn color(index: usize) -> RGBColor {
    const PALETTE: [(u8, u8, u8); 7] =
        [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233), (0, 0, 0)];
    let (red, green, blue) = PALETTE[index % PALETTE.len()];
    RGBColor(red, green, blue)
}

/// Smallest and largest of finite values; absent when there are none.
fn extent(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    values.fold(None, |range: Option<Range<f64>>, value| {
        let range = range.unwrap_or(value..value);
        Some(range.start.min(value)..range.end.max(value))
    })
}

/// A little wider on both sides, and never empty.
fn padded(range: Range<f64>) -> Range<f64> {
    let pad = match range.end - range.start {
        width if width > 0.0 => 0.03 * width,
        _ => (0.5 * range.end.abs()).max(0.5),
    };
    range.start - pad..range.end + pad
}

/// From zero or below to a little above, so that lengths compare as the values do.
fn from_zero(range: Range<f64>) -> Range<f64> {
    let (low, high) = (range.start.min(0.0), range.end.max(0.0));
    let width = if high > low { high - low } else { 1.0 };
    let below = if low < 0.0 { 0.05 * width } else { 0.0 };
    low - below..high + 0.05 * width
}

/// An axis number, in as few digits as tell it from its neighbours.
fn tick(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-3..1e6).contains(&magnitude) {
        return format!("{value:e}");
    }
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Texts of a document, which must parse as any viewer asks.
#[cfg(test)]
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    let elements = document.descendants();
    elements
        .filter(|node| node.has_tag_name("text"))
        .filter_map(|node| node.text())
        .map(|text| text.trim().to_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of meshes, files and devices stand in plots.
    #[test]
    fn no_text_is_markup() {
        let hostile = |place: &str| format!("{place}</text><script>alert(1)</script> ]]> &amp; \" '");
        let named: Vec<String> = ["title", "x", "y", "first", "second"].map(hostile).into();
        let [title, x_label, y_label, first, second] = &named[..] else { unreachable!() };
        let series =
            |name: &String, reference| Series { name: name.clone(), points: vec![(1.0, 2.0), (2.0, 3.0)], reference };
        let line = LineChart {
            title: title.clone(),
            x_label: x_label.clone(),
            y_label: y_label.clone(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series: vec![series(first, false), series(second, true)],
        };
        let bars = BarChart {
            title: title.clone(),
            y_label: y_label.clone(),
            groups: vec![x_label.clone()],
            series: [first, second].map(|name| BarSeries { name: name.clone(), values: vec![Some(1.0)] }).into(),
        };
        for svg in [line.to_svg().unwrap(), bars.to_svg().unwrap()] {
            let document = roxmltree::Document::parse(&svg).unwrap();
            assert!(!document.descendants().any(|node| node.has_tag_name("script")));
            for name in &named {
                assert!(texts(&svg).contains(name), "{name}");
            }
        }
    }

    /// A name with a control character would make a file that no viewer reads.
    #[test]
    fn no_text_hides_or_turns_about() {
        let hostile = |place: &str| format!("{place}\u{1b}[2J\0\u{9b}\u{202e}");
        let bars = BarChart {
            title: hostile("title"),
            y_label: hostile("y"),
            groups: vec![hostile("group")],
            series: vec![BarSeries { name: hostile("series"), values: vec![Some(1.0)] }],
        };
        let svg = bars.to_svg().unwrap();
        assert!(svg.chars().all(|letter| letter == '\n' || !(letter.is_control() || letter == '\u{202e}')), "{svg}");
        let texts = texts(&svg);
        for place in ["title", "y", "group", "series"] {
            assert!(texts.contains(&format!("{place}\\u001b[2J\\u0000\\u009b\\u202e")), "{place} in {texts:?}");
        }
    }

    #[test]
    fn ticks_are_short() {
        let texts = [0.0, 1.0, 0.25, -3.0, 1500.0, 1e-5, 2e7].map(tick);
        assert_eq!(texts, ["0", "1", "0.25", "-3", "1500", "1e-5", "2e7"]);
    }

    #[test]
    fn ranges_are_never_empty() {
        for value in [0.0, 5.0, -5.0, 1e12] {
            assert!(padded(value..value).start < padded(value..value).end);
            assert!(from_zero(value..value).start < from_zero(value..value).end);
            assert!(from_zero(value..value).contains(&0.0));
        }
        assert_eq!(extent([3.0, 1.0, 2.0].into_iter()), Some(1.0..3.0));
        assert_eq!(extent(std::iter::empty()), None);
    }
}
