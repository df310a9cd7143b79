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
/// Bytes of the pieces, or a little more, that are read at once.
const PIECE_BYTES: usize = 1 << 16;
/// Bytes of the shortest body, `1,2,3,4`, with the end of its line.
const LEAST_BYTES: usize = 8;

/// A line that is no body: its number in its piece, from 1 on, and the reason.
type Refused = (usize, String);

/// Adds the bodies of a CSV file: six numbers a line for a segment, four for a sphere, as the options have them. Empty lines, those
/// that begin with `#`, and a heading in the first are passed over.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read and for the first line that is no body, with its number.
pub fn read(path: &Path, all: &mut Vec<Body>) -> Result<(), Error> {
    let failed = |reason: String| Error::Input(format!("`bodies` {}: {reason}", path.display()));
    let text = file::read_text(path, MOST_BYTES).map_err(|error| failed(error.to_string()))?;
    let pieces = pieces(&text);
    let ends: usize = pieces.par_iter().map(|piece| piece.bytes().filter(|&byte| byte == b'\n').count()).sum();
    // A body takes seven times the bytes of the shortest line: room for no more than there can be, and a few pieces at once
    // beside it.
    all.reserve_exact((ends + 1).min(text.len().div_ceil(LEAST_BYTES)));
    let before = all.len();
    let at_once = 4 * rayon::current_num_threads();
    for (wave, pieces_of_wave) in pieces.chunks(at_once).enumerate() {
        let first = wave * at_once;
        let numbered = pieces_of_wave.par_iter().enumerate();
        let read: Vec<Result<Vec<Body>, Refused>> =
            numbered.map(|(number, piece)| bodies(piece, first + number == 0)).collect();
        for (number, bodies) in (first..).zip(read) {
            all.append(&mut bodies.map_err(|(line, reason)| {
                let before: usize = pieces[..number].iter().map(|piece| piece.lines().count()).sum();
                failed(format!("line {}: {reason}", before + line))
            })?);
        }
    }
    if all.len() == before {
        return Err(failed("it has no body; give X,Y,Z,X,Y,Z or X,Y,Z,R a line".into()));
    }
    Ok(())
}

/// A text in pieces of whole lines.
fn pieces(text: &str) -> Vec<&str> {
    let mut pieces = Vec::with_capacity(text.len() / PIECE_BYTES + 1);
    let mut rest = text;
    while !rest.is_empty() {
        let more = rest.as_bytes().iter().skip(PIECE_BYTES).position(|&byte| byte == b'\n');
        let (piece, after) = rest.split_at(more.map_or(rest.len(), |more| PIECE_BYTES + more + 1));
        pieces.push(piece);
        rest = after;
    }
    pieces
}

/// The bodies of a piece, whose first line may be a heading if it is the file's.
fn bodies(piece: &str, is_first: bool) -> Result<Vec<Body>, Refused> {
    let mut bodies = vec![];
    for (number, line) in (1..).zip(piece.lines().map(str::trim)) {
        let is_passed_over = line.is_empty() || line.starts_with('#') || (is_first && number == 1 && is_heading(line));
        if !is_passed_over {
            bodies.push(body(line).map_err(|reason| (number, reason))?);
        }
    }
    Ok(bodies)
}

/// No field is a number.
fn is_heading(line: &str) -> bool {
    line.split(',').all(|field| field.trim().parse::<f64>().is_err())
}

fn body(line: &str) -> Result<Body, String> {
    let body = match line.split(',').count() {
        6 => Body::from(&numbers::<6>(line)?),
        4 => Body::from(&numbers::<4>(line)?),
        count => return Err(format!("it has {count} fields; a segment has six numbers, a sphere four")),
    };
    body.check().map_err(|error| error.to_string())?;
    Ok(body)
}

/// The fields of a line that has so many.
fn numbers<const N: usize>(line: &str) -> Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    for (number, field) in numbers.iter_mut().zip(line.split(',')) {
        *number = f64::parse(&[OsStr::new(field.trim())])?;
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a file of several pieces every line comes once, and one that is no body has its number in the file.
    #[test]
    fn pieces_are_read_as_the_whole() {
        let count = 3 * PIECE_BYTES / "1234,2,3,4\n".len();
        let lines: Vec<String> = (1..=count).map(|x| format!("{x},2,3,4")).collect();
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("bodies.csv");
        std::fs::write(&path, lines.join("\r\n")).expect("room for the file");
        assert!(pieces(&lines.join("\n")).len() > 2);
        let first = Body::from(&[9.0, 2.0, 3.0, 4.0]);
        let mut all = vec![first];
        read(&path, &mut all).expect("bodies");
        assert_eq!((all.len(), all.capacity()), (1 + count, 1 + count));
        assert_eq!(all.remove(0), first);
        for (x, body) in (1..).zip(all) {
            assert_eq!(body, Body::from(&[f64::from(x), 2.0, 3.0, 4.0]));
        }
        for wrong in [1, count / 2, count] {
            let mut lines = lines.clone();
            lines[wrong - 1] = "1,2,x,4".to_owned();
            std::fs::write(&path, lines.join("\n")).expect("room for the file");
            let reason = read(&path, &mut vec![]).expect_err("no body").to_string();
            assert!(reason.contains(&format!("line {wrong}: ")), "{reason}");
        }
    }
}
