//! Lines of the text that a file of samples begins with.

use std::io::{BufRead, Read};

use crate::scene::error::{Fault, Place};

/// Headers are a few lines.
const MOST_BYTES: u64 = 1 << 20;

/// The lines of a header, from 1, up to the first of which `is_last` says so, or the end; what follows is left.
///
/// # Errors
/// A header of more than a megabyte; what the system answers.
pub(super) fn read(input: &mut impl BufRead, is_last: impl Fn(&str) -> bool) -> Result<Vec<(usize, String)>, Fault> {
    let mut lines = Vec::new();
    let mut left = MOST_BYTES;
    for number in 1.. {
        let mut bytes = Vec::new();
        let read = input.by_ref().take(left).read_until(b'\n', &mut bytes);
        let read = read.map_err(|error| Fault::foreign(Place::Line(number), &error))? as u64;
        if read == 0 {
            break;
        }
        left -= read;
        if left == 0 {
            return Err(Fault::new(Place::Whole, "its header takes more than 1 MiB; it is damaged or something else"));
        }
        let line = String::from_utf8_lossy(&bytes).trim_end_matches(['\r', '\n']).to_owned();
        let is_end = is_last(&line);
        lines.push((number, line));
        if is_end {
            break;
        }
    }
    Ok(lines)
}

/// A text of the file, short enough for a message.
pub(super) fn shown(text: &str) -> String {
    format!("{:?}", text.chars().take(40).collect::<String>())
}
