//! The statements of a piece of an OBJ file that make polygons.

use glam::{Vec2, Vec3};
use std::borrow::Cow;

use crate::scene::polygon::Arities;
use crate::scene::tags::Level;

/// Things that an index can count: positions, texture coordinates and normals, in the order in which a
/// corner names them.
pub const KINDS: [&str; 3] = ["positions", "texture coordinates", "normals"];

/// The colour of a position without one.
pub const WHITE: Vec3 = Vec3::ONE;

/// No index of its kind.
pub const ABSENT: u32 = u32::MAX;

/// A piece of the file as one thread has read it.
#[derive(Default)]
pub struct Piece {
    /// Coordinates of its `v` statements, in the file's unit.
    pub positions: Vec<Vec3>,
    /// Coordinates of its `vt` statements.
    pub texture_coordinates: Vec<Vec2>,
    /// Directions of its `vn` statements, of any length.
    pub normals: Vec<Vec3>,
    /// Indices of each kind at the corners of faces of three corners and more; of texture coordinates and normals only up
    /// to the last corner that has one.
    pub corners: [Vec<Named>; 3],
    /// Number of corners of each face of three corners and more.
    pub arities: Arities,
    /// Faces of three corners and more.
    pub faces: usize,
    /// The first face that another name holds from, of an object, of groups or of a material.
    pub changes: Vec<(usize, Level, String)>,
    /// Of each position, where colours are wanted.
    pub colors: Vec<Vec3>,
    /// It has points, lines, curves or free-form surfaces.
    pub has_others: bool,
    keeps_tags: bool,
    /// Lines of the file.
    pub lines: usize,
    /// The largest index of each kind, from 1, and its line.
    pub largest: [(u64, usize); 3],
    /// The farthest that an index of each kind counts back beyond the piece.
    pub lowest: [Lowest; 3],
    /// Line of the piece, from 1, at which reading stopped, and the reason.
    pub fault: Option<(usize, Reason)>,
}

/// Index of one kind at a corner: none, or a place from the start of the file or of the piece.
#[derive(Clone, Copy)]
pub struct Named(i64);

impl Named {
    /// Offset of places in the piece, which tells them from those in the file: no file has so many.
    const IN_PIECE: i64 = i64::MIN / 2;
    /// Farthest that an index may count back.
    const FARTHEST: i64 = 1 << 60;
    pub const NOTHING: Self = Named(i64::MIN);

    /// From the start of the file, from 0, where so many are before the piece.
    pub fn resolved(self, before: usize) -> Option<u64> {
        match self.0 {
            i64::MIN => None,
            place @ 0.. => Some(place as u64),
            moved => u64::try_from(moved - Self::IN_PIECE + before as i64).ok(),
        }
    }
}

/// An index that counts back from the last.
#[derive(Default, Clone, Copy)]
pub struct Lowest {
    /// From the start of the piece; 0 for none that lies before it.
    pub place: i64,
    /// Line of the piece, from 1.
    pub line: usize,
    /// The index as it stands in the file, below 0.
    pub index: i64,
    /// Number of its kind before it in the piece.
    pub count: usize,
}

/// Fault of a line.
pub enum Reason {
    Text(String),
    /// An index that nothing has.
    Index {
        /// The index as it stands in the file.
        index: i64,
        /// 0 for a position, 1 for texture coordinates, 2 for a normal.
        kind: usize,
        /// Number of its kind before it in the piece.
        count: usize,
    },
}

impl From<String> for Reason {
    fn from(text: String) -> Self {
        Reason::Text(text)
    }
}

/// True for a line that does not go on in the next.
pub fn is_whole(line: &[u8]) -> bool {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    !line.ends_with(b"\\")
}

impl Piece {
    /// Parses whole lines, of UTF-8 or Latin-1.
    ///
    /// Faces that would be beyond the file's end are kept: what they name may follow.
    pub fn parse(bytes: &[u8], keeps_tags: bool) -> Self {
        let mut piece = Piece { keeps_tags, ..Piece::default() };
        // Exporters of older systems write names in Latin-1, of which every byte is a character.
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
        };
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            piece.lines += 1;
            let number = piece.lines;
            let added = match line.strip_suffix('\\') {
                None => piece.add(number, line),
                Some(start) => {
                    let mut joined = start.to_owned();
                    for line in lines.by_ref() {
                        piece.lines += 1;
                        joined.push(' ');
                        match line.strip_suffix('\\') {
                            Some(start) => joined.push_str(start),
                            None => {
                                joined.push_str(line);
                                break;
                            }
                        }
                    }
                    piece.add(number, &joined)
                }
            };
            if let Err(reason) = added {
                piece.fault = Some((number, reason));
                break;
            }
        }
        piece
    }

    fn count(&self, kind: usize) -> usize {
        [self.positions.len(), self.texture_coordinates.len(), self.normals.len()][kind]
    }

    fn add(&mut self, line: usize, statement: &str) -> Result<(), Reason> {
        let mut tokens = statement.split_ascii_whitespace();
        let keyword = tokens.next().unwrap_or_default();
        let mut tokens = tokens.take_while(|token| !token.starts_with('#'));
        match keyword {
            // A fourth coordinate divides a position; six numbers are a position and a colour.
            "v" => {
                if self.keeps_tags {
                    self.colors.push(color(tokens.clone())?);
                }
                let ([x, y, z, w], count) = numbers(keyword, tokens)?;
                let position = Vec3::new(x, y, z);
                self.positions.push(if count == 4 { position / w } else { position });
            }
            "vt" => {
                let ([u, v, ..], count) = numbers(keyword, tokens)?;
                self.texture_coordinates.push(Vec2::new(u, if count == 1 { 0.0 } else { v }));
            }
            "vn" => {
                let ([x, y, z, _], _) = numbers(keyword, tokens)?;
                self.normals.push(Vec3::new(x, y, z));
            }
            "f" => return self.add_face(line, tokens),
            "o" if self.keeps_tags => self.change(Level::Object, &mut tokens),
            "g" if self.keeps_tags => self.change(Level::Group, &mut tokens),
            "p" | "l" | "curv" | "curv2" | "surf" => self.has_others = true,
            "usemtl" if self.keeps_tags => self.change(Level::Material, &mut tokens),
            _ => {}
        }
        Ok(())
    }

    fn change(&mut self, level: Level, words: &mut dyn Iterator<Item = &str>) {
        let name = words.collect::<Vec<_>>().join(" ");
        // What held for no face is forgotten: there are three changes a face at most.
        let mut latest = self.changes.iter_mut().rev().take_while(|(first, ..)| *first == self.faces);
        match latest.find(|(_, other, _)| *other == level) {
            Some((.., last)) => *last = name,
            None => self.changes.push((self.faces, level, name)),
        }
    }

    fn add_face<'t>(&mut self, line: usize, corners: impl Iterator<Item = &'t str>) -> Result<(), Reason> {
        let first = self.corners[0].len();
        for corner in corners {
            let mut parts = corner.split('/');
            let place = self.corners[0].len();
            for kind in 0..KINDS.len() {
                match parts.next() {
                    Some("") | None if kind == 0 => {
                        return Err(format!("corner {:?} names no position", shortened(corner)).into());
                    }
                    Some("") | None => {}
                    Some(part) => {
                        let named = self.named(kind, part, line)?;
                        self.corners[kind].resize(place, Named::NOTHING);
                        self.corners[kind].push(named);
                    }
                }
            }
            if parts.next().is_some() {
                return Err(format!("corner {:?} has too many parts", shortened(corner)).into());
            }
        }
        let count = self.corners[0].len() - first;
        if count < 3 {
            // A point or a line.
            self.has_others = true;
            self.corners.iter_mut().for_each(|named| named.truncate(first));
        } else {
            self.faces += 1;
            self.arities.push(count as u32, first);
        }
        Ok(())
    }

    fn named(&mut self, kind: usize, part: &str, line: usize) -> Result<Named, Reason> {
        let index: i64 = part.parse().map_err(|_| format!("{:?} is not an index", shortened(part)))?;
        let count = self.count(kind);
        if index > 0 {
            let largest = &mut self.largest[kind];
            if index as u64 > largest.0 {
                *largest = (index as u64, line);
            }
            return Ok(Named(index - 1));
        }
        if index == 0 || index < -Named::FARTHEST {
            return Err(Reason::Index { index, kind, count });
        }
        let place = count as i64 + index;
        if place < self.lowest[kind].place {
            self.lowest[kind] = Lowest { place, line, index, count };
        }
        Ok(Named(Named::IN_PIECE + place))
    }
}

/// The first numbers of a statement, up to four, and how many count: what follows them is a
/// colour or nothing that is known.
fn numbers<'t>(keyword: &str, tokens: impl Iterator<Item = &'t str>) -> Result<([f32; 4], usize), Reason> {
    let mut texts = [""; 4];
    let mut found = 0;
    for token in tokens {
        if let Some(text) = texts.get_mut(found) {
            *text = token;
        }
        found += 1;
    }
    let kept = match (keyword, found) {
        ("v", 4) => 4,
        ("vt", 1) => 1,
        ("vt", _) => 2,
        _ => 3,
    };
    if found < kept {
        return Err(format!("{keyword} needs {kept} numbers, but there are {found}").into());
    }
    let mut numbers = [0.0_f32; 4];
    for (place, (number, token)) in numbers.iter_mut().zip(&texts[..kept]).enumerate() {
        *number = token.parse().map_err(|_| format!("{:?} is not a number", shortened(token)))?;
        if !number.is_finite() || (place == 3 && *number == 0.0) {
            return Err(format!("{keyword} must not contain {number}").into());
        }
    }
    Ok((numbers, kept))
}

/// The colour that follows a position, where all three numbers of one do.
fn color<'t>(tokens: impl Iterator<Item = &'t str>) -> Result<Vec3, Reason> {
    let texts: Vec<&str> = tokens.skip(3).take(3).collect();
    let [red, green, blue] = texts[..] else { return Ok(WHITE) };
    let mut color = [0.0_f32; 3];
    for (value, text) in color.iter_mut().zip([red, green, blue]) {
        *value = text.parse().map_err(|_| format!("{:?} is not a number", shortened(text)))?;
    }
    let color = Vec3::from(color);
    if color.is_finite() { Ok(color) } else { Err("the colour of v must be finite".to_owned().into()) }
}

/// A token of the file for a message.
fn shortened(token: &str) -> String {
    token.chars().take(40).collect()
}
