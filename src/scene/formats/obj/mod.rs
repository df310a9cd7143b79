//! Wavefront OBJ files: pieces of the text are parsed by all threads, and joined in their order.

mod statements;

use std::time::Instant;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use self::statements::{ABSENT, KINDS, Named, Piece, Reason, WHITE, is_whole};
use super::stream::{Lines, Stop, Stream};
use crate::scene::error::{Fault, Place};
use crate::scene::loading::{LoadParts, timed};
use crate::scene::mesh::Parts;
use crate::scene::notes;
use crate::scene::numbering::Numbering;
use crate::scene::polygon::{Arities, PolygonMesh};
use crate::scene::tags::{Runs, Tags};

/// Reads the polygons of a Wavefront OBJ file; points, lines, curves and free-form surfaces are left out, which a note says, and so
/// are objects, groups, materials and colours unless they are asked for.
///
/// Faces may name vertices that follow, or count back from the last with negative numbers. Where
/// only some corners of the file name a normal (or a texture coordinate), none of them counts, which a note says.
/// Each combination of position, texture coordinate and normal is a vertex, in the order of first use.
pub(super) fn read(stream: &mut Stream<'_>) -> Result<Parts, Stop> {
    let mut start = Vec::new();
    stream.append(&mut start, 3)?;
    if start.starts_with(&[0xff, 0xfe]) || start.starts_with(&[0xfe, 0xff]) {
        return Err(Fault::new(Place::Whole, "it is UTF-16 text; convert it to UTF-8").into());
    }
    if start == "\u{feff}".as_bytes() {
        start.clear();
    }
    let (size_bytes, keeps_tags) = (stream.size_bytes(), stream.keeps_tags);
    let mut joined = Joined::new(size_bytes);
    let mut lines = Lines::new(stream, start, is_whole);
    loop {
        let pieces = lines.next()?;
        if pieces.is_empty() {
            break;
        }
        let parsed: Vec<Piece> = pieces.into_par_iter().map(|piece| Piece::parse(piece, keeps_tags)).collect();
        let started = Instant::now();
        parsed.into_iter().try_for_each(|piece| joined.append(piece))?;
        LoadParts::welded_since(started);
    }
    let mesh = joined.finish()?;
    Ok(timed(|parts| &mut parts.weld_ms, || mesh.into_parts(size_bytes))?)
}

/// All pieces read so far, joined.
struct Joined {
    positions: Vec<Vec3>,
    texture_coordinates: Vec<Vec2>,
    normals: Vec<Vec3>,
    lines: usize,
    /// The largest index of each kind and its line.
    largest: [(u64, usize); 3],
    /// The indices that each vertex is made of, from 0.
    vertices: Numbering,
    /// Corners that name no texture coordinate, or no normal.
    are_partial: [bool; 2],
    corners: Vec<u32>,
    arities: Arities,
    /// Of the positions, or empty.
    colors: Vec<Vec3>,
    runs: Runs,
    faces: usize,
    has_faces: bool,
    has_others: bool,
    /// More of any kind than the file can hold.
    beyond: u64,
}

impl Joined {
    fn new(size_bytes: u64) -> Self {
        Joined {
            positions: Vec::new(),
            texture_coordinates: Vec::new(),
            normals: Vec::new(),
            lines: 0,
            largest: [(0, 0); 3],
            vertices: Numbering::default(),
            are_partial: [false; 2],
            corners: Vec::new(),
            arities: Arities::Triangles,
            colors: Vec::new(),
            runs: Runs::default(),
            faces: 0,
            has_faces: false,
            has_others: false,
            beyond: size_bytes.min(u64::from(ABSENT) - 1),
        }
    }

    fn counts(&self) -> [usize; 3] {
        [self.positions.len(), self.texture_coordinates.len(), self.normals.len()]
    }

    fn append(&mut self, piece: Piece) -> Result<(), Fault> {
        let before = self.counts();
        let fault = |line: usize, reason: String| Fault::new(Place::Line(self.lines + line), reason);
        let preceding = |index: i64, kind: usize, count: usize| {
            let (count, kind) = (before[kind] + count, KINDS[kind]);
            format!("index {index} is out of range; {count} {kind} precede it and counting starts at 1")
        };
        // Those that count back beyond the start of the piece, and may count beyond that of the file.
        let lowest = piece.lowest.iter().enumerate().filter(|(kind, lowest)| lowest.place + (before[*kind] as i64) < 0);
        let lowest = lowest.min_by_key(|(_, lowest)| lowest.line);
        let stopped = piece.fault.filter(|(line, _)| lowest.is_none_or(|(_, lowest)| *line < lowest.line));
        match (stopped, lowest) {
            (Some((line, Reason::Text(reason))), _) => return Err(fault(line, reason)),
            (Some((line, Reason::Index { index, kind, count })), _) => {
                return Err(fault(line, preceding(index, kind, count)));
            }
            (None, Some((kind, lowest))) => {
                return Err(fault(lowest.line, preceding(lowest.index, kind, lowest.count)));
            }
            (None, None) => {}
        }
        for (largest, (index, line)) in self.largest.iter_mut().zip(piece.largest) {
            if index > largest.0 {
                *largest = (index, self.lines + line);
            }
        }
        self.lines += piece.lines;
        self.positions.extend(piece.positions);
        self.texture_coordinates.extend(piece.texture_coordinates);
        self.normals.extend(piece.normals);
        for (face, level, name) in piece.changes {
            self.runs.change(self.faces + face, level, name);
        }
        self.faces += piece.faces;
        self.colors.extend(piece.colors);
        let count = piece.corners[0].len();
        self.has_faces |= count > 0;
        self.has_others |= piece.has_others;
        self.arities.append(piece.arities, count, self.corners.len());
        for corner in 0..count {
            let mut key = [ABSENT; 3];
            for ((key, named), before) in key.iter_mut().zip(&piece.corners).zip(before) {
                let place = named.get(corner).copied().unwrap_or(Named::NOTHING);
                // Out of range where it is beyond: the check at the end tells so, and no number is too large meanwhile.
                *key = place.resolved(before).map_or(ABSENT, |place| place.min(self.beyond) as u32);
            }
            self.are_partial[0] |= key[1] == ABSENT;
            self.are_partial[1] |= key[2] == ABSENT;
            self.corners.push(self.vertices.number(key));
        }
        Ok(())
    }

    /// The polygons, once all that they name is known.
    fn finish(self) -> Result<PolygonMesh, Fault> {
        let counts = self.counts();
        for (((index, line), count), kind) in self.largest.into_iter().zip(counts).zip(KINDS) {
            if index > count as u64 {
                let reason = format!("index {index} is out of range; the file has {count} {kind}");
                return Err(Fault::new(Place::Line(line), reason));
            }
        }
        if !self.has_faces {
            return Err(Fault::new(Place::Whole, "it has no faces"));
        }
        if self.has_others {
            notes::add("its points, lines, curves and free-form surfaces are left out");
        }
        let Joined {
            positions,
            texture_coordinates,
            normals,
            vertices,
            are_partial,
            corners,
            arities,
            colors,
            runs,
            ..
        } = self;
        let vertices = vertices.into_keys();
        for (kind, is_partial) in (1..).zip(are_partial) {
            if is_partial && vertices.iter().any(|key| key[kind] != ABSENT) {
                let kind = KINDS[kind];
                notes::add(format!(
                    "some corners of its faces have no {kind}, so that those of the others are left out"
                ));
            }
        }
        let gathered = |kind: usize| vertices.iter().map(move |key| key[kind] as usize);
        let positions: Vec<Vec3> = gathered(0).map(|at| positions[at]).collect();
        let texture_coordinates =
            if are_partial[0] { Vec::new() } else { gathered(1).map(|at| texture_coordinates[at]).collect() };
        let normals = if are_partial[1] { Vec::new() } else { gathered(2).map(|at| normals[at]).collect() };
        // Colours that no vertex of the file has would be all white.
        let has_colors = colors.iter().any(|color| *color != WHITE);
        let colors = if has_colors { gathered(0).map(|at| colors[at]).collect() } else { Vec::new() };
        let tags = Tags { colors, ..Tags::default() };
        let mut mesh = PolygonMesh { positions, normals, texture_coordinates, corners, arities, tags };
        mesh.tag(&runs)?;
        Ok(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::scene::formats::tests::read_with;

    fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
        read_with(read, bytes)
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn square_with(rest: &str) -> Result<Mesh, Fault> {
        parse(format!("{SQUARE}{rest}").as_bytes())
    }

    #[test]
    fn relative_forward_and_continued_faces_are_equal() {
        let plain = square_with("f 1 2 3 4\n").unwrap();
        assert_eq!(plain.indices, [0, 1, 2, 0, 2, 3]);
        assert_eq!(plain.normals, [Vec3::Z; 4]);
        for rest in [
            "f -4 -3 -2 -1",
            "f 1 \\\n 2 3 \\\n4",
            "f 1// 2// 3// 4//",
            "o name\ng\nusemtl\nmtllib none.mtl\ns 1\nf 1 2 3 4 # tail",
            "vp 1\nl 1 2\np 1\nf 1 2\nf 1 2 3 4\r\n",
        ] {
            assert_eq!(square_with(rest).unwrap(), plain, "{rest}");
        }
        let forward = parse(format!("\u{feff}f 1 2 3 4\n{SQUARE}").as_bytes());
        assert_eq!(forward.unwrap(), plain);
        let latin_1 = [SQUARE.as_bytes(), b"# \xa9\nusemtl Terraind\xe6k\nf 1 2 3 4\n"].concat();
        assert_eq!(parse(&latin_1).unwrap(), plain);
    }

    #[test]
    fn colours_and_weights_are_understood() {
        let text = "v 0 0 0 0.5 0.5 0.5\nv 2 0 0 2\nv 0 1 0\nf 1 2 3\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }

    #[test]
    fn normals_and_texture_coordinates_are_kept_only_when_complete() {
        let attributes = "vn 0 0 2\nvt 0 0\nvt 1 0 0\nvt 1\n";
        let whole = square_with(&format!("{attributes}f 1/1/1 2/2/1 3/3/1")).unwrap();
        assert_eq!(whole.normals, [Vec3::Z; 3]);
        assert_eq!(whole.texture_coordinates, [Vec2::ZERO, Vec2::X, Vec2::X]);
        let partial = square_with(&format!("vn 1 0 0\n{attributes}f 1/1/1 2//1 3/3")).unwrap();
        assert_eq!(partial.normals, [Vec3::Z; 3]);
        assert!(partial.texture_coordinates.is_empty());
    }

    #[test]
    fn what_is_left_out_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let told = |rest: &str| {
            std::fs::write(&path, format!("{SQUARE}vn 0 0 1\nvt 0 0\n{rest}\n")).unwrap();
            notes::take();
            crate::scene::MeshSource::File(path.clone()).load().unwrap();
            notes::take().join(" ")
        };
        for rest in ["f 1 2 3 4", "f 1/1/1 2/1/1 3/1/1", "o a\ng b\ns off\nmtllib c\nusemtl d\nvp 1\nf 1 2 3"] {
            assert_eq!(told(rest), "", "{rest}");
        }
        for others in ["l 1 2", "p 1", "f 1 2", "surf 0 1 0 1 1 2 3 4", "curv 0 1 1 2"] {
            let told = told(&format!("f 1 2 3\n{others}"));
            assert!(told.ends_with("a.obj: its points, lines, curves and free-form surfaces are left out"), "{told}");
        }
        let normals = told("f 1//1 2//1 3//1\nf 1 3 4");
        assert!(
            normals.ends_with("some corners of its faces have no normals, so that those of the others are left out")
        );
        assert!(told("f 1/1/1 2/1/1 3//1").contains("have no texture coordinates, so"));
    }

    #[test]
    fn faults_name_their_line() {
        let huge = format!("f 1 2 {}", usize::MAX / 2 + 1);
        let huge_texture = format!("vt 0 0\nf 1/{} 2/1 3/1", isize::MAX);
        let cases = [
            ("f 1 2 5", 5, "4 positions"),
            ("f 1 2 0", 5, "starts at 1"),
            ("f 1 2 -5", 5, "out of range"),
            (huge.as_str(), 5, "not an index"),
            (huge_texture.as_str(), 6, "1 texture coordinates"),
            ("f 1//1 2//1 3//1", 5, "0 normals"),
            ("\nf 1 2 x", 6, "not an index"),
            ("f 1/1/1/1 2 3", 5, "too many parts"),
            ("f /1 2 3", 5, "names no position"),
            ("v 1 nan 0", 5, "NaN"),
            ("v 1 1e99 0", 5, "inf"),
            ("v 1 2 3 0", 5, "0"),
            ("v 1 2", 5, "needs 3 numbers"),
            ("v 1 2 3,5", 5, "not a number"),
            ("vn 0 0", 5, "needs 3 numbers"),
        ];
        for (rest, line, reason) in cases {
            let fault = square_with(rest).expect_err(rest);
            assert_eq!(fault.place, Place::Line(line), "{rest}: {fault}");
            assert!(fault.reason.contains(reason), "{rest}: {fault}");
        }
    }

    #[test]
    fn wide_texts_and_missing_faces_are_refused() {
        let wide: Vec<u8> = "\u{feff}v 0 0 0".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(parse(&wide).unwrap_err().reason.contains("UTF-16"));
        assert!(square_with("").unwrap_err().reason.contains("no faces"));
        assert!(parse(b"").unwrap_err().reason.contains("no faces"));
    }
}
