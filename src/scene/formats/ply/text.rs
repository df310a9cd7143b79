//! The elements of a PLY file of text, a line each.

use ply_rs_bw::ply::{PropertyType, ScalarType};
use rayon::prelude::*;

use super::header::{Element, Header};
use super::{Carried, END_OF_STRIP, Purpose, Strip, Vertex, check_faces};
use crate::scene::error::{Fault, Place};
use crate::scene::formats::stream::{Lines, Stop, Stream};
use crate::scene::notes;
use crate::scene::polygon::PolygonMesh;

/// Reads all elements into `mesh`.
pub(super) fn read(header: Header, stream: &mut Stream<'_>, mesh: &mut PolygonMesh) -> Result<(), Stop> {
    let mut carried = None;
    for element in &header.elements {
        match element.purpose {
            Purpose::Vertices => carried = Some(Carried::by(element, stream.keeps_tags)?),
            Purpose::Faces | Purpose::Strips => check_faces(element)?,
            Purpose::Nothing => {}
        }
    }
    let (elements, first_line) = (&header.elements, header.lines + 1);
    let mut lines = Lines::new(stream, header.payload, |_| true);
    // Lines of elements that were read.
    let (mut done, mut has_more) = (0, false);
    let all: usize = elements.iter().map(|element| element.count).sum();
    while done < all {
        let pieces = lines.next()?;
        if pieces.is_empty() {
            let reason = "the file ends before its elements do; it is cut off";
            return Err(Fault::new(Place::Line(first_line + done), reason).into());
        }
        let counts: Vec<usize> = pieces.par_iter().map(|piece| memchr::memchr_iter(b'\n', piece).count()).collect();
        let starts = counts.iter().scan(done, |at, count| Some(std::mem::replace(at, *at + count)));
        let pieces: Vec<(usize, &[u8])> = starts.zip(pieces).collect();
        let parsed: Vec<_> =
            pieces.into_par_iter().map(|(start, piece)| Piece::parse(elements, carried, start, piece)).collect();
        for piece in parsed {
            let piece = piece.map_err(|(line, reason)| Fault::new(Place::Line(first_line + line), reason))?;
            done += piece.lines;
            has_more |= piece.has_more;
            let PolygonMesh { positions, normals, texture_coordinates, corners, arities, tags } = piece.mesh;
            mesh.positions.extend(positions);
            mesh.normals.extend(normals);
            mesh.texture_coordinates.extend(texture_coordinates);
            mesh.tags.colors.extend(tags.colors);
            mesh.arities.append(arities, corners.len(), mesh.corners.len());
            mesh.corners.extend(corners);
        }
    }
    has_more |= !lines.rest().trim_ascii().is_empty();
    if has_more || stream.left_bytes() > 0 {
        notes::add("lines behind the elements that its header counts are left out");
    }
    Ok(())
}

/// A piece of the file as one thread has read it.
#[derive(Default)]
struct Piece {
    mesh: PolygonMesh,
    /// Lines of elements.
    lines: usize,
    /// Something follows the last element.
    has_more: bool,
}

impl Piece {
    /// Parses lines, of which `start` come before them; the error is the number of one and what is wrong with it.
    fn parse(
        elements: &[Element],
        carried: Option<Carried>,
        start: usize,
        text: &[u8],
    ) -> Result<Self, (usize, String)> {
        let mut piece = Piece::default();
        let mut at = 0;
        // The element of the next line, and those of it that follow.
        let (mut kinds, mut skipped) = (elements.iter(), start);
        let (mut element, mut left) = (None, 0);
        while at < text.len() {
            while left == 0 {
                let Some(next) = kinds.next() else {
                    piece.has_more = !text[at..].trim_ascii().is_empty();
                    return Ok(piece);
                };
                let passed = skipped.min(next.count);
                skipped -= passed;
                (element, left) = (Some(next), next.count - passed);
            }
            let end = memchr::memchr(b'\n', &text[at..]).map_or(text.len(), |end| at + end);
            if let Some(element) = element {
                let line = &text[at..end];
                piece.add(element, carried, line).map_err(|reason| (start + piece.lines, reason))?;
            }
            piece.lines += 1;
            left -= 1;
            at = end + 1;
        }
        Ok(piece)
    }

    fn add(&mut self, element: &Element, carried: Option<Carried>, line: &[u8]) -> Result<(), String> {
        if element.purpose == Purpose::Nothing {
            return Ok(());
        }
        let line = std::str::from_utf8(line).map_err(|_| "it is not text".to_owned())?;
        let mut tokens = line.split_ascii_whitespace();
        let mut vertex: Vertex = [0.0; 11];
        for property in &element.properties {
            let token = tokens.next().ok_or("a value is missing")?;
            match &property.kind {
                PropertyType::Scalar(scalar) => {
                    if let Some(slot) = property.slot {
                        vertex[slot] = float(scalar, token)?;
                    }
                }
                PropertyType::List(..) => {
                    let count: usize = token.parse().map_err(|_| unreadable(token))?;
                    let first = self.mesh.corners.len();
                    let mut strip = Strip::default();
                    for found in 0..count {
                        let Some(token) = tokens.next() else {
                            return Err(format!("expected {count} list elements, but found only {found}"));
                        };
                        if property.is_corners {
                            let corner = index(token)?;
                            match element.purpose {
                                Purpose::Strips => strip.add(corner, &mut self.mesh),
                                _ => self.mesh.corners.push(corner),
                            }
                        }
                    }
                    if property.is_corners && element.purpose == Purpose::Faces {
                        self.mesh.arities.push(count as u32, first);
                    }
                }
            }
        }
        if let Some(carried) = carried.filter(|_| element.purpose == Purpose::Vertices) {
            carried.add(vertex, &mut self.mesh);
        }
        Ok(())
    }
}

/// A number of a vertex.
fn float(scalar: &ScalarType, token: &str) -> Result<f32, String> {
    match scalar {
        ScalarType::Float => token.parse().map_err(|_| unreadable(token)),
        _ => token.parse::<f64>().map(|number| number as f32).map_err(|_| unreadable(token)),
    }
}

/// The number of a vertex; any other negative number is out of range in any mesh.
fn index(token: &str) -> Result<u32, String> {
    let index: i64 = token.parse().map_err(|_| unreadable(token))?;
    Ok(if index == -1 { END_OF_STRIP } else { u32::try_from(index).unwrap_or(END_OF_STRIP - 1).min(END_OF_STRIP - 1) })
}

fn unreadable(token: &str) -> String {
    format!("{:?} is not a number", token.chars().take(40).collect::<String>())
}
