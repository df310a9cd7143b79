//! Bodies of a file, one a line.

use std::ffi::OsStr;
use std::path::Path;

use rayon::prelude::*;

use super::collisions::Body;
use crate::file;
use crate::measure::Error;
use crate::measure::parameter::Value;

/// The longest file, bytes: some ten million bodies.
const MOST_BYTES: u64 = 1 << 30;

/// The bodies of a CSV file: six numbers a line for a segment, four for a sphere, as the options have them. Empty lines, those
/// that begin with `#`, and a heading in the first are passed over.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read and for the first line that is no body, with its number.
pub fn read(path: &Path) -> Result<Vec<Body>, Error> {
    let failed = |reason: String| Error::Input(format!("`bodies` {}: {reason}", path.display()));
    let text = file::read_text(path, MOST_BYTES).map_err(|error| failed(error.to_string()))?;
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let bodies: Vec<Option<Result<Body, String>>> = lines.par_iter().map(|line| body(line)).collect();
    let mut read = Vec::new();
    for (number, body) in (1..).zip(bodies) {
        match body {
            Some(Err(_)) if number == 1 && is_heading(lines[0]) => {}
            Some(Err(reason)) => return Err(failed(format!("line {number}: {reason}"))),
            Some(Ok(body)) => read.push(body),
            None => {}
        }
    }
    if read.is_empty() {
        return Err(failed("it has no body; give X,Y,Z,X,Y,Z or X,Y,Z,R a line".into()));
    }
    Ok(read)
}

/// No field is a number.
fn is_heading(line: &str) -> bool {
    line.split(',').all(|field| field.trim().parse::<f64>().is_err())
}

fn body(line: &str) -> Option<Result<Body, String>> {
    if line.is_empty() || line.starts_with('#') {
        return None;
    }
    let body = match line.split(',').count() {
        6 => <[f64; 6]>::parse(&[OsStr::new(line)]).map(|numbers| Body::from(&numbers)),
        4 => <[f64; 4]>::parse(&[OsStr::new(line)]).map(|numbers| Body::from(&numbers)),
        count => Err(format!("it has {count} fields; a segment has six numbers, a sphere four")),
    };
    Some(body.and_then(|body| body.check().map_err(|error| error.to_string()).map(|()| body)))
}
