//! `compare`: is B faster or slower than A?

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};

use super::failure::Failure;
use super::options::{parse_fraction, split};
use super::outcome;
use crate::file;
use crate::measure::compare::{
    Comparison, Design, Input, MIN_SHARE, Options, Rules, SAME_MARGIN, compare, markdown, render,
};
use crate::report::json;

#[derive(Debug, Clone, Args)]
pub struct CompareArgs {
    /// Records of side A, comma-separated; several processes a side make a verdict possible
    #[arg(value_name = "A.json[,..]", value_parser = OsStringValueParser::new().try_map(|text| parse_side(&text)))]
    a: Side,
    /// Records of side B, comma-separated
    #[arg(value_name = "B.json[,..]", value_parser = OsStringValueParser::new().try_map(|text| parse_side(&text)))]
    b: Side,
    /// The sides are records that ab has left, or assemble of its shards: compare their blocks A B B A
    #[arg(long)]
    blocks: bool,
    #[command(flatten)]
    verdict: VerdictArgs,
}

/// Options of verdicts, whoever measured.
#[derive(Debug, Clone, Args)]
pub struct VerdictArgs {
    /// Ratios within 1 ± this are the same; a smaller --fail-above takes its place
    #[arg(long, value_name = "2%", value_parser = parse_margin, default_value_t = SAME_MARGIN)]
    margin: f64,
    /// Exit with 4 when the frame or a pass of B is slower than A's by more than this, with certainty
    #[arg(long, value_name = "5%", value_parser = parse_fraction)]
    fail_above: Option<f64>,
    /// Passes below this share of the frame never fail
    #[arg(long, value_name = "2%", value_parser = parse_fraction, default_value_t = MIN_SHARE)]
    min_share: f64,
    /// Exit with 4 as well when it is not certain that the frame and every pass that counts keep to --fail-above, or,
    /// without that, when one of their verdicts is UNCLEAR
    #[arg(long)]
    fail_unclear: bool,
    /// Exit with 4 as well when B lacks a run or a pass of A
    #[arg(long)]
    fail_missing: bool,
    /// Print tables of Markdown, as for a pull request
    #[arg(long)]
    markdown: bool,
    /// Write the comparison; to standard output without a file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub(super) json: Option<PathBuf>,
}

/// The records of one side.
#[derive(Debug, Clone)]
pub struct Side(Vec<PathBuf>);

impl Side {
    /// The files of its records.
    pub fn files(&self) -> &[PathBuf] {
        &self.0
    }

    /// Reads its records.
    ///
    /// # Errors
    /// The first that cannot be read.
    pub fn read(&self) -> Result<Vec<Input>, Failure> {
        let input = |path: &PathBuf| Ok(Input { name: path.display().to_string(), record: json::read(path)? });
        self.0.iter().map(input).collect()
    }
}

/// Files, separated by commas.
pub fn parse_side(text: &OsStr) -> Result<Side, String> {
    let files = split(text, b',');
    if files.iter().any(|file| file.is_empty()) {
        return Err("give files, separated by commas".to_owned());
    }
    Ok(Side(files.into_iter().map(PathBuf::from).collect()))
}

fn parse_margin(text: &str) -> Result<f64, String> {
    parse_fraction(text).and_then(|margin| match margin {
        0.0..=1.0 => Ok(margin),
        _ => Err(format!("{text:?} is no margin: give 0 to 100%")),
    })
}

impl VerdictArgs {
    /// The first of these options that was given, but for those that have a value anyway.
    pub fn option_given(&self) -> Option<&'static str> {
        let given = [
            (self.fail_above.is_some(), "--fail-above"),
            (self.fail_unclear, "--fail-unclear"),
            (self.fail_missing, "--fail-missing"),
            (self.markdown, "--markdown"),
            (self.json.is_some(), "--json"),
        ];
        given.into_iter().find_map(|(is_given, option)| is_given.then_some(option))
    }

    /// Rules of the comparison.
    pub fn options(&self, design: Design) -> Options {
        Options {
            rules: Rules { margin: self.margin, ..Rules::default() },
            fail_above: self.fail_above,
            min_share: self.min_share,
            design,
        }
    }

    /// Prints and writes a comparison.
    ///
    /// # Errors
    /// [`Failure::Regression`] for what these options call one.
    pub fn publish(&self, comparison: &Comparison) -> Result<(), Failure> {
        let print = || match self.markdown {
            true => outcome::print(&markdown(comparison)),
            false => outcome::print(&render(comparison, outcome::style())),
        };
        match self.json.as_deref() {
            Some(path) if path == Path::new("-") => outcome::print(&outcome::text(comparison)?)?,
            Some(path) => {
                file::write(path, outcome::text(comparison)?.as_bytes())?;
                print()?;
            }
            None => print()?,
        }
        let fails = comparison.has_regression()
            || self.fail_unclear && comparison.is_unclear()
            || self.fail_missing && comparison.is_missing_any();
        if fails { Err(Failure::Regression) } else { Ok(()) }
    }
}

pub fn run(arguments: &CompareArgs) -> Result<(), Failure> {
    let json = arguments.verdict.json.iter().filter(|path| path.as_os_str() != "-");
    json.clone().try_for_each(|path| file::check_writable(path))?;
    outcome::check_apart(json, &[arguments.a.files(), arguments.b.files()].concat())?;
    let (a, b) = (arguments.a.read()?, arguments.b.read()?);
    let options = match arguments.blocks {
        true => arguments.verdict.options(Design::Blocks).for_blocks(&a, &b),
        false => arguments.verdict.options(Design::Processes),
    };
    arguments.verdict.publish(&compare(&a, &b, &options)?)
}
