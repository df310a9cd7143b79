//! `render`: the picture of a frame or of a range of frames, and intermediate targets at full precision.

use std::collections::{BTreeSet, HashSet};
use std::ffi::OsStr;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};

use super::failure::Failure;
use super::film;
use super::options::{MachineArgs, OutputArgs, split};
use super::outcome;
use super::part::{self, Part, parse_rows};
use super::reading;
use super::watch::{ProgressLines, interrupted, patiently, progress_bar};
use crate::gpu;
use crate::image::{self, Rgba8, y4m};
use crate::measure::bench::{Loaded, build, load_for};
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::shard::Shard;
use crate::measure::study::Study;
use crate::measure::{Error, Paper, Variant};

/// Frames to draw, and their files.
#[derive(Debug, Clone, Args)]
pub struct PictureArgs {
    /// Frame N, or the frames A..B from A up to but not including B
    #[arg(long, value_name = "N|A..B", default_value = "0", value_parser = parse_frames)]
    frame: Frames,
    /// Of the frames, or of one frame's rows, the part I of N, from 0 to N - 1; what is finished is not drawn again
    #[arg(long, value_name = "I/N", conflicts_with_all = ["rows", "film", "dump"])]
    shard: Option<Shard>,
    /// Keep the rows A..B alone, from A up to but not including B, the first being 0; what is finished is not drawn again
    #[arg(long, value_name = "A..B", value_parser = parse_rows, conflicts_with_all = ["film", "dump"])]
    rows: Option<Range<u32>>,
    /// Write a target of the frame, by the file's ending: .exr, .npy or .png; `passes` lists the targets; repeatable
    #[arg(long, value_name = "TARGET=FILE", value_parser = OsStringValueParser::new().try_map(|text| parse_dump(&text)))]
    dump: Vec<Dump>,
    #[command(flatten)]
    machine: MachineArgs,
    /// File of the picture; of several frames, the number goes before its ending [default: in --out]
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    image: Option<PathBuf>,
    /// Write the frames as one film, YUV4MPEG2, and no pictures but those of --image
    #[arg(long, value_name = "FILE.y4m", help_heading = "Output")]
    film: Option<PathBuf>,
    /// Frames of the film a second, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = y4m::RATE, requires = "film", help_heading = "Output",
        value_parser = clap::value_parser!(u32).range(1..=1000))]
    film_rate: u32,
    /// Folder of pictures that are not named
    #[arg(long, value_name = "DIR", default_value = "fumarole-out", help_heading = "Output")]
    out: PathBuf,
    /// Print nothing but errors
    #[arg(long, short, help_heading = "Output")]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Frames {
    first: u32,
    end: u32,
}

fn parse_frames(text: &str) -> Result<Frames, String> {
    let number = |part: &str| part.parse::<u32>().map_err(|_| format!("{part:?} is not a frame number"));
    let frames = match text.split_once("..") {
        None => {
            let first = number(text)?;
            Frames { first, end: first.checked_add(1).ok_or("the frame number is too large")? }
        }
        Some((first, end)) => Frames { first: number(first)?, end: number(end)? },
    };
    if frames.first < frames.end { Ok(frames) } else { Err(format!("{text} holds no frame")) }
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Dump {
    target: String,
    file: PathBuf,
}

fn parse_dump(text: &OsStr) -> Result<Dump, String> {
    match split(text, b'=').as_slice() {
        [target, file @ ..] if !target.is_empty() && file.iter().any(|part| !part.is_empty()) => {
            // Only the first separates.
            Ok(Dump { target: target.to_string_lossy().into_owned(), file: file.join(OsStr::new("=")).into() })
        }
        _ => Err("give a target and a file, as caustics-map=map.exr".to_owned()),
    }
}

/// Draws the frames, and writes their pictures and targets.
pub fn draw<S: Study>(
    variant: S::Variant,
    arguments: &PictureArgs,
    resolve: impl FnOnce() -> Result<S, Failure>,
) -> Result<(), Failure> {
    let output = OutputArgs {
        out: arguments.out.clone(),
        json: None,
        csv: None,
        trace: None,
        image: None,
        quiet: arguments.quiet,
    };
    let frames = arguments.frame;
    let is_range = frames.end - frames.first > 1;
    if is_range && !arguments.dump.is_empty() {
        return Err(Failure::Input("--dump writes one frame: give --frame one number".into()));
    }
    let picture_path = |number: u32| match &arguments.image {
        Some(path) if is_range => image::numbered(path, number),
        Some(path) => path.clone(),
        None => arguments.out.join(format!("{}-{}-{number:04}.png", S::PAPER, variant.as_str())),
    };
    for dump in &arguments.dump {
        image::Format::of(&dump.file)?;
        outcome::check_file(&dump.file)?;
    }
    let has_pictures = arguments.film.is_none() || arguments.image.is_some();
    if has_pictures {
        outcome::check_picture(&picture_path(frames.first))?;
        outcome::check_file(&picture_path(frames.first))?;
    }
    if let Some(film) = &arguments.film {
        film::check(film)?;
    }

    let study = resolve()?;
    let (whole, height) = (frames.first..frames.end, study.identity().height);
    let (numbers, rows) = arguments.share(height)?;
    if numbers.is_empty() || rows.is_empty() {
        // More processes than there is work for.
        if !arguments.quiet {
            outcome::say("nothing to draw: there are more shards than frames or rows");
        }
        return Ok(());
    }
    let is_cut = rows != (0..height);
    let picture_path = |number: u32| match is_cut {
        true => part::of_rows(&picture_path(number), [rows.start, rows.end]),
        false => picture_path(number),
    };
    let read = reading::by_study(&study, &arguments.machine);
    // Of all frames those whose pictures have names that are read.
    let names: HashSet<&OsStr> = read.iter().filter_map(|path| path.file_name()).collect();
    let is_read = |number: &u32| picture_path(*number).file_name().is_some_and(|name| names.contains(name));
    let numbered = read.iter().filter_map(|path| number_in_name(path)).filter(|number| whole.contains(number));
    let numbered: BTreeSet<u32> = numbered.collect();
    let ends = [frames.first, frames.end - 1];
    let drawn: BTreeSet<u32> = ends.into_iter().chain(numbered.into_iter().filter(is_read)).collect();
    let mut pictures: Vec<PathBuf> = drawn.into_iter().filter(|_| has_pictures).map(picture_path).collect();
    if arguments.shard.is_some() || arguments.rows.is_some() {
        pictures.extend(pictures.clone().iter().map(|picture| part::beside(picture)));
    }
    let dumps = arguments.dump.iter().map(|dump| &dump.file);
    outcome::check_apart(dumps.chain(&pictures).chain(&arguments.film), &read)?;
    pictures.iter().try_for_each(|picture| outcome::check_file(picture))?;
    let open = || Machine::open(&arguments.machine.resolve(0), S::NEEDS);
    let loaded = patiently(arguments.quiet, "loading the scene", || load_for(&study, &[variant], open))?;
    let (Loaded { scene, notes, .. }, mut machine) = loaded;
    outcome::say_device(&output, &machine);
    notes.iter().for_each(|note| outcome::warn(&output, note));
    let mut part = match arguments.shard.is_some() || arguments.rows.is_some() {
        true => Some(Part::of(&study, variant, &arguments.machine, &machine, whole)?),
        false => None,
    };
    let numbers: Vec<u32> = match &mut part {
        Some(part) => numbers.filter(|number| !part.at(*number, &rows).is_finished(&picture_path(*number))).collect(),
        None => numbers.collect(),
    };
    if numbers.is_empty() {
        if !arguments.quiet {
            outcome::say("nothing to draw: every part is finished");
        }
        return Ok(());
    }
    outcome::foretell(&output, &study.estimate(&machine.device, &scene, variant), &machine);
    let mut built = patiently(arguments.quiet, "making the first frame", || build(&machine, &study, &scene, variant))?;
    built.paper.keep_rows(rows.clone());
    let targets = built.paper.targets();
    for dump in &arguments.dump {
        if !targets.iter().any(|t| t.name == dump.target) {
            let known: Vec<&str> = targets.iter().map(|t| t.name.as_str()).collect();
            let message = format!("--dump {}: no such target; there are {}", dump.target, known.join(", "));
            return Err(Failure::Input(message));
        }
    }
    let bar = progress_bar(arguments.quiet, S::PAPER);
    let wanted = numbers.len();
    bar.set_length(wanted as u64);
    let mut lines = ProgressLines::new(arguments.quiet);
    let mut written = Vec::new();
    let mut next = |number: u32| -> Result<Option<Rgba8>, Failure> {
        let is_wanted = |left: u32| {
            let told = || format!("{}: {left} steps to frame {number}", S::PAPER);
            bar.set_message(told());
            lines.tell(|| format!("note: {}", told()));
            !interrupted().load(Ordering::Relaxed)
        };
        if interrupted().load(Ordering::Relaxed)
            || !picture::advance(interrupted(), &mut machine, &mut built.paper, number, is_wanted)?
        {
            return Ok(None);
        }
        bar.set_message(S::PAPER);
        // The first compiles what it draws with; on a terminal the bar shows that it goes on.
        let is_silent = arguments.quiet || !bar.is_hidden() || bar.position() > 0;
        let render = || picture::render_unless(interrupted(), &mut machine, &mut built.paper, number);
        let rendered = match patiently(is_silent, &format!("drawing frame {number}"), render) {
            Err(Error::Gpu(gpu::Error::Interrupted)) => return Ok(None),
            other => other?,
        };
        if has_pictures {
            let path = picture_path(number);
            // A link may lead to what is read.
            if path.is_symlink() {
                outcome::check_apart([&path], &read)?;
            }
            let kept = if is_cut { &rendered.rows(rows.clone())? } else { &rendered };
            image::write_png(&path, kept)?;
            if let Some(part) = &mut part {
                part.at(number, &rows).write(&path, kept)?;
            }
            written.push(path);
        }
        bar.inc(1);
        lines.tell(|| format!("note: {}: {} of {wanted} frames", S::PAPER, bar.position()));
        Ok(Some(rendered))
    };
    let numbers = numbers.into_iter();
    let filmed: usize = match &arguments.film {
        Some(path) => film::shoot(path, arguments.film_rate, numbers.map(&mut next).map_while(Result::transpose))?,
        None => {
            numbers.map(&mut next).map_while(Result::transpose).try_fold(0, |count, drawn| drawn.map(|_| count + 1))?
        }
    };
    bar.finish_and_clear();
    if filmed == 0 {
        return Err(Failure::Running("interrupted before a picture was written".into()));
    }
    if filmed < wanted {
        outcome::warn(&output, &format!("interrupted after {filmed} of {wanted} frames"));
    }
    written.extend(arguments.film.clone());
    built.paper.warnings().iter().for_each(|warning| outcome::warn(&output, warning));
    written.iter().for_each(|path| outcome::wrote(&output, path));
    // Asked again: a paper may alternate its targets from frame to frame.
    let targets = built.paper.targets();
    for dump in &arguments.dump {
        for target in targets.iter().filter(|t| t.name == dump.target) {
            match image::write(&dump.file, &picture::read_target(&machine.device, target)?)? {
                Some(ramp) => outcome::wrote_with(&output, &dump.file, &ramp.to_string()),
                None => outcome::wrote(&output, &dump.file),
            }
        }
    }
    machine.check_validation()?;
    Ok(())
}

/// The last number in a file's name, as that of a frame stands there.
fn number_in_name(path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?;
    let is_no_digit = |letter: char| !letter.is_ascii_digit();
    // Behind it come rows, and the ending.
    let name = name
        .split_once(".rows-")
        .map_or_else(|| name.rsplit_once('.').map_or(name, |(stem, _)| stem), |(stem, _)| stem);
    name.rsplit(is_no_digit).next()?.parse().ok()
}

impl PictureArgs {
    /// The frames and rows that this process draws of a picture so high.
    fn share(&self, height: u32) -> Result<(Range<u32>, Range<u32>), Failure> {
        let frames = self.frame.first..self.frame.end;
        match (self.shard, &self.rows) {
            (_, Some(rows)) if rows.end > height => {
                let message = format!("--rows {}..{}: the picture has the rows 0..{height}", rows.start, rows.end);
                Err(Failure::Input(message))
            }
            (_, Some(rows)) => Ok((frames, rows.clone())),
            (Some(shard), None) if frames.len() > 1 => Ok((shard.of(frames), 0..height)),
            (Some(shard), None) => Ok((frames, shard.of(0..height))),
            (None, None) => Ok((frames, 0..height)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_one_number_or_a_half_open_range() {
        assert_eq!(parse_frames("7"), Ok(Frames { first: 7, end: 8 }));
        assert_eq!(parse_frames("2..5"), Ok(Frames { first: 2, end: 5 }));
        for text in ["", "x", "5..5", "6..2", "-1", "1..", "4294967295"] {
            assert!(parse_frames(text).is_err(), "{text}");
        }
    }
}
