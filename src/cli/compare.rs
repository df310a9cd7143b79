//! `compare`: is B faster or slower than A?

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::options::parse_share;
use super::outcome;
use crate::measure::compare::{Input, compare, render};
use crate::report::{json, output};

#[derive(Debug, Clone, Args)]
pub struct CompareArgs {
    /// Records of side A, comma-separated; several processes a side make a verdict possible
    #[arg(value_name = "A.json[,..]", value_parser = parse_side)]
    a: Side,
    /// Records of side B, comma-separated
    #[arg(value_name = "B.json[,..]", value_parser = parse_side)]
    b: Side,
    /// Exit with 4 when B is slower than A by more than this, with certainty
    #[arg(long, value_name = "5%", value_parser = parse_share)]
    fail_above: Option<f64>,
    /// Write the comparison; to standard output without a file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
}

/// The records of one side.
#[derive(Debug, Clone)]
struct Side(Vec<PathBuf>);

fn parse_side(text: &str) -> Result<Side, String> {
    if text.split(',').any(str::is_empty) {
        return Err("give files, separated by commas".to_owned());
    }
    Ok(Side(text.split(',').map(PathBuf::from).collect()))
}

pub fn run(arguments: &CompareArgs) -> Result<(), Failure> {
    let read = |side: &Side| -> Result<Vec<Input>, Failure> {
        side.0.iter().map(|path| Ok(Input { name: path.display().to_string(), record: json::read(path)? })).collect()
    };
    let comparison = compare(&read(&arguments.a)?, &read(&arguments.b)?, arguments.fail_above)?;
    match arguments.json.as_deref() {
        Some(path) if path == Path::new("-") => outcome::print(&outcome::text(&comparison)?)?,
        Some(path) => {
            output::write(path, outcome::text(&comparison)?.as_bytes())?;
            outcome::print(&render(&comparison, outcome::style()))?;
        }
        None => outcome::print(&render(&comparison, outcome::style()))?,
    }
    if comparison.has_regression() { Err(Failure::Regression) } else { Ok(()) }
}
