use super::placement::{MapCoordinates, Unit};
use crate::scene::HeightMap;
use crate::scene::binary::allocate;
use crate::scene::error::{Fault, Place};
use crate::scene::height_map::grid::{Grid, Placement};
use crate::scene::height_map::map::check_size;
use crate::scene::height_map::shown;
use glam::DVec2;
use std::io::BufRead;

/// The longest number that a program would write is some 30 characters.
const LONGEST_TOKEN: usize = 64;

/// Reads an Esri ASCII grid: lines of a keyword and a number, then the heights, row by row from the north.
pub(super) fn parse(
    size_bytes: u64,
    input: impl BufRead,
    unit: Option<Unit>,
    has_own_spacing: bool,
) -> Result<HeightMap, Fault> {
    let mut tokens = Tokens { input, line: 1, is_first: true };
    let mut header = Header::default();
    let first = loop {
        let Some(token) = tokens.next()? else {
            // A header that names no samples is wrong itself.
            if header.columns.is_some() && header.rows.is_some() {
                header.size(size_bytes)?;
            }
            return Err(
                tokens.fault("the file ends before its first height; it is cut off or something else".to_owned())
            );
        };
        // "nan" can be a height.
        if token.starts_with(|first: char| first.is_ascii_alphabetic()) && !token.eq_ignore_ascii_case("nan") {
            header.set(&token, &mut tokens)?;
        } else {
            break token;
        }
    };
    let (width, height) = header.size(size_bytes)?;
    let placement = match header.coordinates(width, height) {
        Some(coordinates) => coordinates.placed_or_spaced(unit, has_own_spacing)?,
        None => Placement::Unknown,
    };
    let count = width as usize * height as usize;
    let mut values = allocate::<f32>(count)?;
    let no_data = header.no_data;
    let mut integral = true;
    let mut token = Some(first);
    for (index, sample) in values.iter_mut().enumerate() {
        let Some(text) = token else {
            let reason =
                format!("{index} heights for ncols x nrows = {width} x {height}, which makes {count}; it is cut off");
            return Err(tokens.fault(reason));
        };
        let value = tokens.number(&text, "height")?;
        integral &= value.fract() == 0.0 || no_data == Some(value);
        *sample = value as f32;
        token = tokens.next()?;
    }
    if token.is_some() {
        return Err(
            tokens.fault(format!("more than the {count} heights that ncols x nrows = {width} x {height} makes"))
        );
    }
    Grid { width, height, values, integral, no_data, placement }.into_map()
}

/// The numbers above the heights, as far as the file gives them.
#[derive(Default)]
struct Header {
    columns: Option<f64>,
    rows: Option<f64>,
    /// Coordinate of the west edge and of the first column's centre.
    west: [Option<f64>; 2],
    /// Coordinate of the south edge and of the last row's centre.
    south: [Option<f64>; 2],
    step: [Option<f64>; 2],
    no_data: Option<f64>,
}

impl Header {
    fn set(&mut self, key: &str, tokens: &mut Tokens<impl BufRead>) -> Result<(), Fault> {
        let key = key.to_ascii_lowercase();
        let field = match key.as_str() {
            "ncols" => &mut self.columns,
            "nrows" => &mut self.rows,
            "xllcorner" => &mut self.west[0],
            "xllcenter" => &mut self.west[1],
            "yllcorner" => &mut self.south[0],
            "yllcenter" => &mut self.south[1],
            "cellsize" | "dx" => &mut self.step[0],
            "dy" => &mut self.step[1],
            "nodata_value" => &mut self.no_data,
            _ => {
                let known = "ncols, nrows, xllcorner, yllcorner, xllcenter, yllcenter, cellsize, dx, dy, nodata_value";
                return Err(tokens.fault(format!("the word {key:?} is none of {known}")));
            }
        };
        let Some(value) = tokens.next()? else { return Err(tokens.fault(format!("the file ends after {key:?}"))) };
        let value = tokens.number(&value, &key)?;
        if field.replace(value).is_some() {
            return Err(tokens.fault(format!("{key} is given twice")));
        }
        if matches!(key.as_str(), "cellsize" | "dx" | "dy") && !(value.is_finite() && value > 0.0) {
            return Err(tokens.fault(format!("{key} is {}; it has to be positive", shown(value))));
        }
        Ok(())
    }

    /// Columns and rows, which the file is large enough for.
    fn size(&self, size_bytes: u64) -> Result<(u32, u32), Fault> {
        let whole = |reason: String| Fault::new(Place::Whole, reason);
        let side = |value: Option<f64>, key: &str| match value {
            Some(side) if side.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&side) => Ok(side as u32),
            Some(side) => Err(whole(format!("{key} is {}; it has to be a whole number of samples", shown(side)))),
            None => Err(whole(format!("the header has no {key}"))),
        };
        let (width, height) = (side(self.columns, "ncols")?, side(self.rows, "nrows")?);
        check_size(width.into(), height.into())
            .map_err(|reason| whole(format!("by ncols and nrows of its header, {reason}")))?;
        // A digit and a blank each.
        let least_bytes = 2 * u64::from(width) * u64::from(height) - 1;
        if size_bytes < least_bytes {
            return Err(whole(format!(
                "its size is {size_bytes} bytes, but the heights of ncols x nrows = {width} x {height} take at least \
                 {least_bytes}; it is cut off"
            )));
        }
        Ok((width, height))
    }

    /// Spacing and place of the samples; none where the file gives no spacing.
    fn coordinates(&self, width: u32, height: u32) -> Option<MapCoordinates> {
        let x = self.step[0].or(self.step[1])?;
        let field = if self.step[1].is_some() { "dx, dy" } else { "cellsize" };
        let step = DVec2::new(x, self.step[1].unwrap_or(x));
        let west = self.west[1].or(self.west[0].map(|edge| edge + step.x / 2.0));
        let south = self.south[1].or(self.south[0].map(|edge| edge + step.y / 2.0));
        let north_west = west.zip(south).map(|(west, south)| DVec2::new(west, south + step.y * f64::from(height - 1)));
        Some(MapCoordinates { north_west, step, width, height, field })
    }
}

/// The tokens of a text, which is never held as a whole.
struct Tokens<R> {
    input: R,
    /// Line of the token read last, from 1.
    line: usize,
    /// No token is read yet.
    is_first: bool,
}

impl<R: BufRead> Tokens<R> {
    fn next(&mut self) -> Result<Option<String>, Fault> {
        let token = self.word()?;
        let is_first = std::mem::take(&mut self.is_first);
        // Some editors put a mark of UTF-8 before a text.
        match token.as_deref().and_then(|token| token.strip_prefix('\u{feff}')).filter(|_| is_first) {
            Some("") => self.word(),
            Some(rest) => Ok(Some(rest.to_owned())),
            None => Ok(token),
        }
    }

    fn word(&mut self) -> Result<Option<String>, Fault> {
        let mut token = Vec::new();
        loop {
            let place = Place::Line(self.line);
            let buffer = self.input.fill_buf().map_err(|error| Fault::foreign(place, &error))?;
            if buffer.is_empty() {
                break;
            }
            let skipped =
                if token.is_empty() { buffer.iter().take_while(|b| b.is_ascii_whitespace()).count() } else { 0 };
            let (blank, rest) = buffer.split_at(skipped);
            self.line += blank.iter().filter(|byte| **byte == b'\n').count();
            let length = rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
            token.extend(&rest[..length.min(LONGEST_TOKEN + 1)]);
            let is_complete = length < rest.len() && !token.is_empty();
            self.input.consume(skipped + length);
            if token.len() > LONGEST_TOKEN {
                return Err(self.fault(format!("a word of more than {LONGEST_TOKEN} bytes; this is no ASCII grid")));
            }
            if is_complete {
                break;
            }
        }
        if token.is_empty() {
            return Ok(None);
        }
        let token = String::from_utf8(token).map_err(|_| self.fault("bytes that are no text".to_owned()))?;
        Ok(Some(token))
    }

    fn number(&self, token: &str, what: &str) -> Result<f64, Fault> {
        token.parse().map_err(|_| self.fault(format!("{what} is {token:?}, not a number")))
    }

    fn fault(&self, reason: String) -> Fault {
        Fault::new(Place::Line(self.line), reason)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Samples;

    fn read(text: &str) -> Result<HeightMap, Fault> {
        // A small buffer, so that tokens are cut by its end.
        parse(text.len() as u64, std::io::BufReader::with_capacity(5, text.as_bytes()), None, false)
    }

    #[test]
    fn whole_heights_become_steps_and_lines_may_break_anywhere() {
        let map = read(
            "NCOLS 3\r\nnrows 2\nxllcorner 100\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n1 -2\n30000 4 -9999\n\n6",
        )
        .unwrap();
        let Samples::Steps { values, origin_m, step_m } = map.samples() else { panic!("{map:?}") };
        assert_eq!((values.as_slice(), *origin_m, *step_m), ([3, 0, 30_002, 6, 5, 8].as_slice(), -2.0, 1.0));
        assert_eq!((map.voids(), map.spacing_m(), map.geographic()), (1, DVec2::splat(10.0), None));
    }

    #[test]
    fn a_mark_of_utf_8_before_the_text_is_passed_over() {
        for mark in ["\u{feff}", "\u{feff}\r\n", "\n\u{feff}"] {
            let map = read(&format!("{mark}ncols 2\nnrows 2\ncellsize 7\n1 2 3 4\n")).unwrap();
            assert_eq!((map.spacing_m(), map.height_m(1, 1)), (DVec2::splat(7.0), 4.0), "{mark:?}");
        }
    }

    #[test]
    fn fractions_and_wide_ranges_stay_float() {
        for heights in ["0.5 1 2 3", "0 1 2 65536"] {
            let map = read(&format!("ncols 2\nnrows 2\ncellsize 1\n{heights}\n")).unwrap();
            assert!(matches!(map.samples(), Samples::Float(_)), "{heights}");
        }
    }

    #[test]
    fn degrees_are_placed_by_centre_or_corner() {
        for (x, y) in [("xllcorner 140", "yllcorner 37"), ("xllcenter 140.05", "yllcenter 37.05")] {
            let step = "cellsize 0.1\n";
            let map = read(&format!("ncols 2\nnrows 3\n{x}\n{y}\n{step}1 2 3 4 5 6"));
            // 0.1 degrees could be metres.
            assert_eq!(map.unwrap().spacing_m(), DVec2::splat(0.1));
            let (x, y) = (x.replace("140.05", "140.025"), y.replace("37.05", "37.02"));
            let place = read(&format!("ncols 2\nnrows 3\n{x}\n{y}\ndx 0.05\ndy 0.04\n1 2 3 4 5 6"))
                .unwrap()
                .geographic()
                .unwrap();
            assert!((place.west_deg - 140.025).abs() < 1e-12 && (place.north_deg - 37.1).abs() < 1e-12, "{place:?}");
            assert_eq!(place.step_deg, DVec2::new(0.05, 0.04));
        }
    }

    #[test]
    fn faults_name_line_and_field() {
        let head = "ncols 2\nnrows 2\n";
        for (text, message) in [
            ("", "line 1: the file ends before its first height"),
            ("ncols", "line 1: the file ends after \"ncols\""),
            ("ncols two\n", "line 1: ncols is \"two\", not a number"),
            ("ncols 2\nncols 2\n", "line 2: ncols is given twice"),
            ("rows 2\n", "line 1: the word \"rows\" is none of ncols, nrows"),
            ("ncols 2\n1 2 3 4", "the header has no nrows"),
            ("ncols 0\nnrows 5\n1", "by ncols and nrows of its header, it has 0 x 5 samples"),
            ("ncols 0\nnrows 5\n", "by ncols and nrows of its header, it has 0 x 5 samples"),
            ("ncols 65537\nnrows 5\n1", "65537 x 5 samples; a map has 2 to 65536 a side"),
            ("ncols 2.5\nnrows 5\n1", "ncols is 2.5; it has to be a whole number"),
            ("ncols 900\nnrows 900\n1 2", "heights of ncols x nrows = 900 x 900 take at least 1619999"),
            (&format!("{head}cellsize -1\n1 2 3 4"), "line 3: cellsize is -1; it has to be positive"),
            (&format!("{head}1 2\n3"), "line 4: 3 heights for ncols x nrows = 2 x 2, which makes 4"),
            (&format!("{head}1 2\n3 4\n5"), "line 5: more than the 4 heights"),
            (&format!("{head}1 2\n3 x"), "line 4: height is \"x\", not a number"),
            (&format!("{head}1 2\n3 nan"), "row 1, column 1: its height is NaN, not a finite number"),
            (&format!("{head}1 2\n3 1e39"), "row 1, column 1: its height is inf"),
            (&format!("{head}1 2\n3 1e30"), "row 1, column 1: its height is 1.0000000150474662e30 m, and heights are"),
            (
                &format!("{head}cellsize 1e-300\n1 2 3 4"),
                "cellsize: it makes samples lie 1e-300 x 1e-300 m apart; they",
            ),
            (&format!("{head}dx 30\ndy 1e300\n1 2 3 4"), "dx, dy: it makes samples lie 30 x 1e300 m apart; they"),
            (&format!("{head}cellsize -1e300\n1 2 3 4"), "line 3: cellsize is -1e300; it has"),
            ("ncols 1e300\nnrows 2\n1 2", "ncols is 1e300; it has to be a whole number"),
            (&format!("{head}nodata_value 7\n7 7\n7 7"), "all its samples are void"),
            (&"x".repeat(1_000), "line 1: a word of more than 64 bytes"),
        ] {
            let fault = read(text).unwrap_err().to_string();
            assert!(fault.contains(message), "{text:?}: {fault}");
        }
    }
}
