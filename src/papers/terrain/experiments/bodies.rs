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
/// Bytes of the shortest line with a body.
const SHORTEST: usize = "0,0,0,1\n".len();
/// Lines that are read at once.
const TOGETHER: usize = 1 << 16;

/// The bodies of a CSV file: six numbers a line for a segment, four for a sphere, as the options have them. Empty lines, those
/// that begin with `#`, and a heading in the first are passed over.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read and for the first line that is no body, with its number.
pub fn read(path: &Path) -> Result<Vec<Body>, Error> {
    let failed = |reason: String| Error::Input(format!("`bodies` {}: {reason}", path.display()));
    let text = file::read_text(path, MOST_BYTES).map_err(|error| failed(error.to_string()))?;
    let is_told = |&(number, line): &(u64, &str)| {
        let is_passed_over = line.is_empty() || line.starts_with('#') || (number == 1 && is_heading(line));
        !is_passed_over
    };
    let mut lines = (1_u64..).zip(text.lines().map(str::trim)).filter(is_told);
    let mut read = Vec::with_capacity(lines.clone().count().min(text.len() / SHORTEST + 1));
    loop {
        let together: Vec<(u64, &str)> = lines.by_ref().take(TOGETHER).collect();
        if together.is_empty() {
            break;
        }
        let bodies: Vec<Result<Body, String>> = together.par_iter().map(|(_, line)| body(line)).collect();
        for ((number, _), body) in together.into_iter().zip(bodies) {
            read.push(body.map_err(|reason| failed(format!("line {number}: {reason}")))?);
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

fn body(line: &str) -> Result<Body, String> {
    let body = match line.split(',').count() {
        6 => <[f64; 6]>::parse(&[OsStr::new(line)]).map(|numbers| Body::from(&numbers)),
        4 => <[f64; 4]>::parse(&[OsStr::new(line)]).map(|numbers| Body::from(&numbers)),
        count => Err(format!("it has {count} fields; a segment has six numbers, a sphere four")),
    };
    body.and_then(|body| body.check().map_err(|error| error.to_string()).map(|()| body))
}
