//! Writing what a measurement leaves behind.

use std::io::IsTerminal;
use std::path::Path;

use super::failure::Failure;
use super::options::OutputArgs;
use crate::report::output::{check_writable, write};
use crate::report::record::Record;
use crate::report::table::Style;
use crate::report::trace::TraceRun;
use crate::report::{console, csv, json, trace};

/// How standard output may be coloured.
pub fn style() -> Style {
    Style::detect(std::io::stdout().is_terminal())
}

/// Fails before long work if a file could not be written after it.
pub fn check(output: &OutputArgs) -> Result<(), Failure> {
    output.files().try_for_each(|path| Ok(check_writable(path)?))
}

/// Writes record, rows and trace where the options say, and prints the table.
pub fn publish(output: &OutputArgs, record: &Record, traces: &[TraceRun]) -> Result<(), Failure> {
    if output.json_to_stdout() {
        print!("{}", text(record)?);
    } else if !output.quiet {
        print!("{}", console::record(record, style()));
    }
    if let Some(path) = output.json.as_deref().filter(|_| !output.json_to_stdout()) {
        save(output, path, text(record)?.as_bytes())?;
    }
    if let Some(path) = &output.csv {
        save(output, path, csv::to_string(record).as_bytes())?;
    }
    if let Some(path) = &output.trace {
        save(output, path, trace::to_string(traces).as_bytes())?;
    }
    Ok(())
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

/// Says on standard error that a file was written.
pub fn wrote(output: &OutputArgs, path: &Path) {
    if !output.quiet {
        eprintln!("wrote {}", path.display());
    }
}
