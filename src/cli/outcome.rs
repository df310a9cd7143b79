//! Writing what a measurement leaves behind.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::options::OutputArgs;
use super::spelling;
use super::watch::watched;
use crate::file::{Sink, check_writable, destination, write};
use crate::image;
use crate::measure::Error;
use crate::measure::estimate::Estimate;
use crate::measure::experiment::Console;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::report::record::Record;
use crate::report::table::Style;
use crate::report::text::{escaped, one_line};
use crate::report::trace::TraceRun;
use crate::report::{console, csv, json, trace};

/// Style of standard output: colours on a terminal only.
pub fn style() -> Style {
    Style::detect(io::stdout().is_terminal())
}

/// Prints on standard output, which names and files cannot make a terminal obey. A reader that has left, as `head` does, wants no more: that is no failure.
///
/// # Errors
/// [`Failure::Input`] where there is no space; [`Failure::Running`] for an interruption while the reader takes nothing.
pub fn print(text: &str) -> Result<(), Failure> {
    let written = Sink::stream(io::stdout().lock()).write_all(escaped(text, true).as_bytes());
    let failed = |e: io::Error| format!("writing to standard output: {e}");
    match written {
        Err(e) if e.kind() == ErrorKind::TimedOut => Err(Failure::Running(failed(e))),
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Input(format!("{}; send it where there is space", failed(e))))
        }
        _ => Ok(()),
    }
}

/// Says a line on standard error, if anybody listens; its parameters are spelled as options.
pub fn say(line: &str) {
    let _unheard = writeln!(io::stderr(), "{}", one_line(&spelling::options(line)));
}

/// Prints help, or says what the argument parser refuses, and gives the exit code.
pub fn usage(error: &clap::Error) -> u8 {
    let text = error.render();
    if error.use_stderr() {
        let is_coloured = Style::detect(io::stderr().is_terminal()).color;
        let text = if is_coloured { text.ansi().to_string() } else { text.to_string() };
        let _unheard = io::stderr().write_all(escaped(&text, is_coloured).as_bytes());
    } else {
        let is_coloured = style().color;
        let text = if is_coloured { text.ansi().to_string() } else { text.to_string() };
        if let Err(failure) = print(&text) {
            return failure.report();
        }
    }
    u8::try_from(error.exit_code()).unwrap_or(2)
}

/// Says which device was chosen.
pub fn say_device(output: &OutputArgs, machine: &Machine) {
    if !output.quiet {
        say(&format!("device: {}", machine.description()));
    }
}

/// Says that a frame will take long.
pub fn foretell(output: &OutputArgs, estimate: &Estimate, machine: &Machine) {
    let is_made = !output.quiet && estimate.check(&machine.device, "").is_ok();
    if let Some(note) = estimate.patience(&machine.device).filter(|_| is_made) {
        say(&note);
    }
}

/// Says what makes a picture or a trace doubtful.
pub fn warn(output: &OutputArgs, warning: &str) {
    if !output.quiet {
        say(&format!("warning: {warning}"));
    }
}

/// Fails before long work if a file could not be written after it.
pub fn check(output: &OutputArgs) -> Result<(), Failure> {
    output.image.iter().try_for_each(|path| check_picture(path))?;
    output.files().try_for_each(|path| check_file(path))?;
    check_apart(output.files(), &[])
}

/// Fails where two of the files that are `written` are one, or one of them is `read` (see [`reading`](super::reading)):
/// the one would take the other's place without a word. Fails as well where one would lie below another, which is a
/// file and holds none.
pub fn check_apart<'a>(written: impl IntoIterator<Item = &'a PathBuf>, read: &[PathBuf]) -> Result<(), Failure> {
    let read: HashSet<PathBuf> = read.iter().filter_map(|path| destination(path)).collect();
    // By their places, and by those above these: a film has many thousands.
    let (mut before, mut above_before) = (HashMap::<PathBuf, &PathBuf>::new(), HashMap::<PathBuf, &PathBuf>::new());
    for path in written {
        let Some(place) = destination(path) else { continue };
        if read.contains(&place) {
            let message =
                format!("{}: it is read, and what is written there would replace it; name another", path.display());
            return Err(Failure::Input(message));
        }
        if before.contains_key(&place) {
            let message =
                format!("{}: two outputs are to be written there; give each a file of its own", path.display());
            return Err(Failure::Input(message));
        }
        let is_below = place.ancestors().skip(1).find_map(|above| before.get(above)).map(|other| (*other, path));
        if let Some((above, below)) = is_below.or_else(|| above_before.get(&place).map(|other| (path, *other))) {
            let message = format!(
                "{}: one output is to be written there, and another below it, {}; a file has none below it, so name another",
                above.display(),
                below.display()
            );
            return Err(Failure::Input(message));
        }
        for above in place.ancestors().skip(1) {
            if above_before.insert(above.to_owned(), path).is_some() {
                // Those above it are there as well.
                break;
            }
        }
        before.insert(place, path);
    }
    Ok(())
}

/// Fails for a file that cannot be written, and for `-`, which only `--json` knows.
pub fn check_file(path: &Path) -> Result<(), Failure> {
    if path.as_os_str() == "-" {
        return Err(Failure::Input("-: only --json writes to standard output; name a file, or ./-".into()));
    }
    Ok(check_writable(path)?)
}

/// Fails for a picture whose ending promises another format than it gets.
pub fn check_picture(path: &Path) -> Result<(), Failure> {
    match image::Format::of(path) {
        Ok(image::Format::Png) => Ok(()),
        _ => Err(Failure::Input(format!("--image {}: pictures are PNG; end the name in .png", path.display()))),
    }
}

/// Writes record, rows and trace where the options say, and prints the table. Each is written even when another cannot
/// be.
///
/// # Errors
/// The first that failed.
pub fn publish(output: &OutputArgs, record: &Record, traces: &[TraceRun]) -> Result<(), Failure> {
    let printed = if output.json_to_stdout() {
        text(record).and_then(|text| print(&text))
    } else if !output.quiet {
        print(&console::record(record, style()))
    } else {
        Ok(())
    };
    let json = output.json.as_deref().filter(|_| !output.json_to_stdout());
    let saved = json.map_or(Ok(()), |path| save(output, path, text(record)?.as_bytes()));
    let rows = output.csv.as_deref().map_or(Ok(()), |path| save(output, path, csv::to_string(record).as_bytes()));
    let traced = output.trace.as_deref().map_or(Ok(()), |path| {
        let left_out: u64 = traces.iter().map(|trace| trace.frames_left_out).sum();
        if left_out > 0 {
            warn(output, &format!("{} leaves out {left_out} frames, too many for a viewer", path.display()));
        }
        save(output, path, trace::to_string(traces).as_bytes())
    });
    printed.and(saved).and(rows).and(traced)
}

/// A document as JSON text.
pub fn text(document: &impl serde::Serialize) -> Result<String, Failure> {
    json::to_string(document).map_err(|e| Failure::Running(format!("writing JSON: {e}")))
}

/// Writes a file and says so.
pub fn save(output: &OutputArgs, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write(path, bytes)?;
    wrote(output, path);
    Ok(())
}

/// Entries of a folder, by name.
pub fn listed(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let failed = |e: io::Error| {
        Failure::Input(format!("listing the folder {}: {e}; name a folder that can be read", folder.display()))
    };
    let paths = |entries: fs::ReadDir| entries.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut paths = fs::read_dir(folder).and_then(paths).map_err(failed)?;
    paths.sort();
    Ok(paths)
}

/// Says on standard error that a file was written.
pub fn wrote(output: &OutputArgs, path: &Path) {
    if !output.quiet {
        say(&format!("wrote {}", path.display()));
    }
}

/// Says that a file was written, and what to know of it.
pub fn wrote_with(output: &OutputArgs, path: &Path, remark: &str) {
    if !output.quiet {
        say(&format!("wrote {} ({remark})", path.display()));
    }
}

/// The terminal, or what stands in its place.
pub struct Terminal {
    /// True when only errors are said on standard error.
    pub is_quiet: bool,
}

impl Console for Terminal {
    fn print(&self, text: &str) -> Result<(), Error> {
        print(text).map_err(|failure| Error::Input(failure.to_string()))
    }

    fn say(&self, line: &str) {
        if !self.is_quiet {
            say(line);
        }
    }

    fn style(&self) -> Style {
        style()
    }

    fn watch(&self, title: &str, work: &mut dyn FnMut(&mut Watch<'_>)) {
        watched(self.is_quiet, title, work);
    }

    fn spell(&self, message: &str) -> String {
        spelling::options(message)
    }
}
