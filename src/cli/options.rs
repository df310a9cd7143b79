//! Options that every paper has, as they were typed.

use std::ffi::{OsStr, OsString};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::{Args, Parser, ValueEnum};

use super::failure::Failure;
use crate::gpu::Compiler;
use crate::measure::experiment::{Destinations, MeasureOptions};
use crate::measure::limits;
use crate::measure::machine::{Machine, MachineOptions};
use crate::measure::measure::Schedule;
use crate::report::record::Limits;

/// The options of a verb that measures.
#[derive(Debug, Clone, Args)]
pub struct CommonArgs {
    /// The device and its shaders.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Frames, repetitions, processes.
    #[command(flatten)]
    pub measure: MeasureArgs,
    /// Files, and what is printed.
    #[command(flatten)]
    pub output: OutputArgs,
}

impl CommonArgs {
    /// Those of a command without options.
    pub fn defaults() -> Self {
        #[derive(Parser)]
        struct Plain {
            #[command(flatten)]
            arguments: CommonArgs,
        }
        Plain::parse_from(["fumarole"]).arguments
    }
}

/// The pieces of a text between separators; a name that is not UTF-8 can only be taken apart on Unix.
pub fn split(text: &OsStr, separator: u8) -> Vec<OsString> {
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let pieces = text.as_bytes().split(|byte| *byte == separator);
        pieces.map(|piece| OsStr::from_bytes(piece).to_owned()).collect()
    }
    #[cfg(not(unix))]
    text.to_str()
        .map_or_else(|| vec![text.to_owned()], |text| text.split(char::from(separator)).map(OsString::from).collect())
}

/// Parses a number of a range; `what` tells of it where the text is none.
pub fn number_in<T: FromStr + PartialOrd>(text: &str, range: RangeInclusive<T>, what: &str) -> Result<T, String> {
    let number = text.parse::<T>().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("{text:?} is not {what}"))
}

/// Parses `5%` or `0.05` as a fraction.
pub fn parse_fraction(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(number) => (number, 0.01),
        None => (text, 1.0),
    };
    match number.trim().parse::<f64>() {
        // A number of percent without its sign would be a hundred times as much, in silence.
        Ok(value) if value.is_finite() && value >= 0.0 && (scale < 1.0 || value <= 1.0) => Ok(value * scale),
        _ => Err(format!("{text:?} is not a share: give 5% or 0.05")),
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum CompilerArg {
    Glslang,
    Naga,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Device")]
pub struct MachineArgs {
    /// Device to use: an index, a part of its name, or its UUID [default: the best capable one]
    #[arg(long, value_name = "INDEX|NAME|UUID")]
    device: Option<String>,
    /// Run under the validation layer with synchronization validation; any message is a failure
    #[arg(long)]
    validate: bool,
    /// Whose SPIR-V to run, wherever it has a binary
    #[arg(long, value_enum, default_value = "glslang")]
    shader_compiler: CompilerArg,
    /// Compile the shaders under DIR (laid out as shaders/) and use them instead of the built-in ones
    #[arg(long, value_name = "DIR")]
    shader_dir: Option<PathBuf>,
}

impl MachineArgs {
    /// Folder of the shaders that stand in for the built-in ones.
    pub fn shader_dir(&self) -> Option<&Path> {
        self.shader_dir.as_deref()
    }

    /// The same on another device.
    pub fn on(&self, device: &str) -> Self {
        MachineArgs { device: Some(device.to_owned()), ..self.clone() }
    }

    /// The option of the device as it would be typed.
    pub fn device_arguments(&self) -> Vec<OsString> {
        self.device.iter().flat_map(|device| ["--device".into(), device.into()]).collect()
    }

    /// As they would be typed.
    pub fn arguments(&self) -> Vec<OsString> {
        let compiler = if self.shader_compiler == CompilerArg::Naga { "naga" } else { "glslang" };
        let mut arguments: Vec<OsString> = vec!["--shader-compiler".into(), compiler.into()];
        arguments.extend(self.device_arguments());
        if let Some(folder) = &self.shader_dir {
            arguments.extend(["--shader-dir".into(), folder.into()]);
        }
        arguments.extend(self.validate.then(|| "--validate".into()));
        arguments
    }

    /// `process` is which of several fresh processes this is.
    pub fn resolve(&self, process: u32) -> MachineOptions {
        MachineOptions {
            process,
            is_profiled: false,
            device: self.device.clone(),
            validate: self.validate,
            compiler: match self.shader_compiler {
                CompilerArg::Glslang => Compiler::Glslang,
                CompilerArg::Naga => Compiler::Naga,
            },
            shader_dir: self.shader_dir.clone(),
        }
    }
}

/// Help of `--frames`, without its default.
pub const FRAMES_HELP: &str = "Frames in one repetition, 1 to 100000";
/// Help of `--repeat`, without its default.
pub const REPEAT_HELP: &str = "Repetitions of those frames, 1 to 10000";
/// Frames of a repetition of `bench`.
pub const FRAMES: u32 = 10;
/// Repetitions of `bench`.
pub const REPEAT: u32 = 3;

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Measuring")]
pub struct MeasureArgs {
    /// Frames before anything counts, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub warmup: u32,
    /// Frames in one repetition.
    #[arg(long, value_name = "N", help = format!("{FRAMES_HELP} [default: {FRAMES}]"))]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Repetitions of those frames.
    #[arg(long, value_name = "R", help = format!("{REPEAT_HELP} [default: {REPEAT}]"))]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub repeat: Option<u32>,
    /// Repeat until plain frames took this many seconds, 0 to 3600
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = parse_seconds, allow_negative_numbers = true)]
    pub min_time: f64,
    /// Measure in this many fresh processes, 1 to 100
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub processes: u32,
    /// Number of this process: set for the fresh ones
    #[arg(long, hide = true, default_value_t = 0)]
    pub process: u32,
    /// Leave the device's own limits unmeasured
    #[arg(long)]
    no_limits: bool,
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    number_in(text, 0.0..=3600.0, "a time of 0 to 3600 seconds")
}

impl MeasureArgs {
    /// As an experiment takes them.
    pub fn options(&self) -> MeasureOptions {
        MeasureOptions {
            warmup: self.warmup,
            frames: self.frames,
            repeat: self.repeat,
            min_time_s: self.min_time,
            has_limits: !self.no_limits,
        }
    }

    pub fn schedule(&self, frames: u32, repeat: u32) -> Schedule {
        Schedule {
            warmup: self.warmup,
            frames: self.frames.unwrap_or(frames),
            repeat: self.repeat.unwrap_or(repeat),
            min_time_s: self.min_time,
        }
    }

    /// Measures the device's own limits, unless they are to be left out.
    pub fn limits(&self, machine: &mut Machine) -> Result<Option<Limits>, Failure> {
        if self.no_limits { Ok(None) } else { Ok(Some(limits::measure(machine)?)) }
    }
}

/// Options of `bench` alone.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "In depth")]
pub struct DepthArgs {
    /// Look at one pass: distribution of its times, counters, bytes, floor, both compilers' binaries
    #[arg(long, value_name = "PASS")]
    pub profile: Option<String>,
    /// Capture frame 0 of each variant after it was measured, by a RenderDoc that the program was started from
    #[arg(long, value_enum, value_name = "TOOL")]
    pub capture: Option<CaptureTool>,
}

/// Who captures a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum CaptureTool {
    Renderdoc,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Folder for everything whose file is not named
    #[arg(long, value_name = "DIR", default_value = "fumarole-out")]
    pub out: PathBuf,
    /// Write the result record; to standard output without a file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub json: Option<PathBuf>,
    /// Write one row for each run and pass
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write a trace of every frame for chrome://tracing and Perfetto; with --processes of the first process alone
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Write the last frame's picture; of several variants the first one's, the others' beside it as FILE-VARIANT.png
    #[arg(long, value_name = "FILE.png")]
    pub image: Option<PathBuf>,
    /// Print nothing but errors and what was asked for on standard output
    #[arg(long, short)]
    pub quiet: bool,
}

impl OutputArgs {
    /// As an experiment takes them.
    pub fn destinations(&self) -> Destinations {
        Destinations { folder: self.out.clone(), json: self.json.clone(), csv: self.csv.clone(), is_quiet: self.quiet }
    }

    /// True when the record goes to standard output, which then holds nothing else.
    pub fn json_to_stdout(&self) -> bool {
        self.json.as_deref().is_some_and(|path| path.as_os_str() == "-")
    }

    /// The files that will be written, to be checked before long work.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let json = self.json.as_ref().filter(|_| !self.json_to_stdout());
        json.into_iter().chain(&self.csv).chain(&self.trace).chain(&self.image)
    }
}
