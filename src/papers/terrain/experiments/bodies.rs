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
/// that begin with `#`, and a heading in the first are passed over; fields may stand in quotes.
///
/// # Errors
/// [`Error::Input`] for a file that cannot be read and for the first line that is no body, with its number.
pub fn read(path: &Path, all: &mut Vec<Body>) -> Result<(), Error> {
    let failed = |reason: String| Error::Input(format!("`bodies` {}: {reason}", path.display()));
    let text = file::read_text(path, MOST_BYTES).map_err(|error| failed(error.to_string()))?;
    // Some editors put a mark of UTF-8 before a text.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let pieces = pieces(text);
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

/// No field is a number, and one is a word: what has digits and separators alone is meant as a body.
fn is_heading(line: &str) -> bool {
    let is_number = |letter: char| letter.is_ascii_digit() || ['+', '-', '.'].contains(&letter);
    let is_word = |field: &str| field.contains(char::is_alphabetic) && !field.starts_with(is_number);
    line.split(',').all(|field| bare(field).parse::<f64>().is_err()) && line.split(',').map(bare).any(is_word)
}

/// A field without blanks and the quotes around it.
fn bare(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).map_or(field, str::trim)
}

fn body(line: &str) -> Result<Body, String> {
    let body = match line.split(',').count() {
        6 => Body::from(&numbers::<6>(line)?),
        4 => Body::from(&numbers::<4>(line)?),
        count => {
            let fields = if count == 1 { "field" } else { "fields" };
            return Err(format!(
                "it has {count} {fields}; a segment has six numbers, a sphere four, with commas between"
            ));
        }
    };
    body.check().map_err(|error| error.to_string())?;
    Ok(body)
}

/// The fields of a line that has so many.
fn numbers<const N: usize>(line: &str) -> Result<[f64; N], String> {
    let mut numbers = [0.0; N];
    for (number, field) in numbers.iter_mut().zip(line.split(',')) {
        *number = f64::parse(&[OsStr::new(bare(field))]).map_err(|reason| shortened(field).unwrap_or(reason))?;
    }
    Ok(numbers)
}

/// The reason why a field too long to be shown is no number.
fn shortened(field: &str) -> Option<String> {
    const LONGEST: usize = 40;
    let shown: String = bare(field).chars().take(LONGEST).collect();
    (shown.len() < bare(field).len()).then(|| format!("{shown:?}... is not a finite number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies of a text, as a file of it is read.
    fn of(text: &str) -> Result<Vec<Body>, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("bodies.csv");
        std::fs::write(&path, text).expect("room for the file");
        let mut all = vec![];
        read(&path, &mut all).map(|()| all).map_err(|error| error.to_string())
    }

    #[test]
    fn a_heading_has_a_word_and_no_number() {
        let spheres = |count: usize| Ok(vec![Body::from(&[0.0, 100.0, 0.0, 5.0]); count]);
        let plain = "0,100,0,5\n";
        for (first, count) in [
            ("", 1),
            (plain, 2),
            ("\"0\",\"100\",\"0\",\"5\"\n", 2),
            (" \"0\" , 100,\" 0 \",5\r\n", 2),
            ("x,y,z,r\n", 1),
            ("\"x\",\"y\",\"z\",\"r\"\r\n", 1),
            ("\"\",y,\"z\",\n", 1),
            ("länge,y,z,r\n", 1),
            ("x;y;z;r\n", 1),
            ("#0;1\n", 1),
        ] {
            for mark in ["", "\u{feff}"] {
                assert_eq!(of(&format!("{mark}{first}{plain}")), spheres(count), "{mark:?}{first:?}");
            }
        }
        let long = format!("{},1,2,3\n", "7x".repeat(1 << 19));
        for (text, parts) in [
            ("0;100;0;5\n0,100,0,5\n", ["line 1: it has 1 field;", "commas"]),
            ("\"0;100;0;5\"\n", ["line 1: it has 1 field;", "commas"]),
            ("1 2 3 4\n", ["line 1: it has 1 field;", "commas"]),
            ("0,,0,5\n", ["line 1: ", "finite number"]),
            ("nan,0,0,5\n", ["line 1: ", "nan"]),
            ("nan,inf,nan,nan\n", ["line 1: ", "nan"]),
            (",,,\n", ["line 1: ", "finite number"]),
            ("0,100,0,5\nx,y,z,r\n", ["line 2: ", "\"x\""]),
            ("x,y,z,r\n", ["it has no body", "X,Y,Z,R"]),
            ("0,1e300,0,5\n", ["line 1: ", "1e300"]),
            (&long, ["line 1: ", "... is not a finite number"]),
        ] {
            let reason = of(text).expect_err("no body");
            let said = reason.split_once("bodies.csv").map_or("", |(_, said)| said);
            assert!(parts.iter().all(|part| said.contains(part)) && said.len() < 160, "{reason}");
        }
    }

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
