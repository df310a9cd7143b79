//! Records as one page that opens from disk, without a network: for each run its passes as bars and as a table, the
//! paper's rows beside ours, memory, limits, environment and the command of every number; pictures under a divider; the
//! tables and plots of experiments; verdicts first where two sides are compared.
//!
//! Everything that comes from a record is escaped by the template, and characters that hide or turn text about are shown as
//! escapes; pictures and plots are images, which run nothing; the
//! page's policy lets no script run but its own.

mod bars;
mod configurations;
mod page;
mod profile;
mod run;
mod tables;
#[cfg(test)]
mod tests;

pub use page::page;

use super::record::{Record, Run};
use super::table::Table;
use super::tables::Tables;

/// All that a page shows.
#[derive(Default)]
pub struct Contents {
    /// Above all else.
    pub title: String,
    /// Verdicts on two sides, first on the page.
    pub verdicts: Vec<Section>,
    /// Pictures of what both sides have drawn, below the verdicts.
    pub pairs: Vec<Pair>,
    /// Records in the order in which they are shown.
    pub records: Vec<Source>,
    /// Tables of experiments without runs, after the records.
    pub tables: Vec<TableSource>,
    /// Plots of experiments.
    pub plots: Vec<Plot>,
    /// Files that could not be shown, one line each.
    pub warnings: Vec<String>,
}

/// A heading with lines and a table below it.
pub struct Section {
    /// Heading.
    pub title: String,
    /// Commands that its numbers come from, each with what it did.
    pub commands: Vec<(String, Vec<String>)>,
    /// Lines of text.
    pub lines: Vec<String>,
    /// A table, where there is one.
    pub table: Option<Table>,
}

/// A record with the file that it came from.
pub struct Source {
    /// Path of the file.
    pub name: String,
    /// Its contents.
    pub record: Record,
    /// The runs' pictures, as far as they are there unchanged.
    pub pictures: Vec<Picture>,
}

/// Tables of an experiment with the file that they came from.
pub struct TableSource {
    /// Path of the file.
    pub name: String,
    /// Its contents.
    pub document: Tables,
}

/// A run's picture.
pub struct Picture {
    /// Index of the run in its record.
    pub run: usize,
    /// The PNG file's bytes.
    pub png: Vec<u8>,
    /// Difference to the paper's first picture of the same size in the record; absent for that one.
    pub difference: Option<PictureDifference>,
}

/// CIE Luv difference of two pictures.
#[derive(Clone, Copy)]
pub struct PictureDifference {
    /// Index of the run that it is compared with.
    pub base: usize,
    /// Mean over the pixels.
    pub mean: f64,
    /// 99th percentile over the pixels.
    pub p99: f64,
}

/// The pictures of one run by both sides of a comparison.
pub struct Pair {
    /// The run's name.
    pub title: String,
    /// The PNG files' bytes, A's and B's.
    pub pngs: [Vec<u8>; 2],
    /// Mean CIE Luv difference over the pixels.
    pub mean: f64,
    /// Its 99th percentile.
    pub p99: f64,
}

/// A plot of an experiment.
pub struct Plot {
    /// Name of its file.
    pub name: String,
    /// The SVG file's bytes.
    pub svg: Vec<u8>,
    /// The command line that it comes from; empty where that is not known.
    pub command: Vec<String>,
}

/// Paper, variant, preset, and the [`alternative`](super::alternative) that tells a run from others of these.
fn method(run: &Run, alternative: &str) -> String {
    let preset = run.preset.as_ref().map_or_else(String::new, |preset| format!(", {preset}"));
    format!("{} {}{preset}{alternative}", run.paper, run.variant)
}

/// A run's name: its method and size.
pub fn name(run: &Run, alternative: &str) -> String {
    format!("{}: {} × {}", method(run, alternative), run.width, run.height)
}
