use crate::scene::Mesh;
use crate::scene::error::{Fault, Place};
use crate::scene::polygon::PolygonMesh;
use glam::{Vec2, Vec3};

/// Reads the polygons of a Wavefront OBJ file; groups, materials, colours, lines and points are
/// left out.
///
/// Faces may name vertices that follow, or count back from the last with negative numbers. Where
/// only some corners of the file name a normal (or a texture coordinate), none of them counts.
pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let statements = Statements::extract(decode(bytes)?)?;
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let (models, _) = tobj::load_obj_buf(&mut statements.text.as_bytes(), &options, |_| Ok(Default::default()))
        .map_err(|error| Fault::foreign(Place::Whole, &error))?;
    // Without group statements there is exactly one model.
    let mesh = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();
    if mesh.indices.is_empty() {
        return Err(Fault::new(Place::Whole, "it has no faces"));
    }
    // tobj leaves the list of arities empty where every face is a triangle.
    let arities = if mesh.face_arities.is_empty() { vec![3; mesh.indices.len() / 3] } else { mesh.face_arities };
    let vectors = |values: &[f32]| values.chunks_exact(3).map(Vec3::from_slice).collect();
    let positions: Vec<Vec3> = vectors(&mesh.positions);
    let mut normals: Vec<Vec3> = vectors(&mesh.normals);
    let mut texture_coordinates: Vec<Vec2> = mesh.texcoords.chunks_exact(2).map(Vec2::from_slice).collect();
    // tobj gives nothing, not a gap, for a corner without normal: shorter lists cannot be told
    // apart.
    if normals.len() != positions.len() {
        normals.clear();
    }
    if texture_coordinates.len() != positions.len() {
        texture_coordinates.clear();
    }
    PolygonMesh { positions, normals, texture_coordinates, corners: mesh.indices, arities }.into_mesh(bytes.len())
}

fn decode(bytes: &[u8]) -> Result<&str, Fault> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let reason = "it is UTF-16 text; convert it to UTF-8";
        return Err(Fault::new(Place::Whole, reason));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        Fault::new(Place::Line(line), "it is not UTF-8 text; convert the file to UTF-8")
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Things that an index can count: positions, texture coordinates and normals, in the order in which a
/// corner names them.
const KINDS: [&str; 3] = ["positions", "texture coordinates", "normals"];

/// The statements that make polygons, checked and one a line, as `tobj` takes them without
/// surprises.
///
/// The check is here because `tobj` tells no line numbers, lets NaN pass and computes with indices
/// that overflow.
#[derive(Default)]
struct Statements {
    text: String,
    counts: [usize; 3],
    /// The largest index of each kind and its line.
    largest: [(usize, usize); 3],
}

impl Statements {
    fn extract(source: &str) -> Result<Self, Fault> {
        let mut statements = Self::default();
        for (line, statement) in logical_lines(source) {
            statements.add(line, &statement).map_err(|reason| Fault::new(Place::Line(line), reason))?;
        }
        for ((index, line), (count, kind)) in
            statements.largest.into_iter().zip(statements.counts.into_iter().zip(KINDS))
        {
            if index > count {
                let reason = format!("index {index} is out of range; the file has {count} {kind}");
                return Err(Fault::new(Place::Line(line), reason));
            }
        }
        Ok(statements)
    }

    fn add(&mut self, line: usize, statement: &str) -> Result<(), String> {
        let mut tokens = statement.split_whitespace();
        let keyword = tokens.next().unwrap_or_default();
        let tokens: Vec<&str> = tokens.take_while(|token| !token.starts_with('#')).collect();
        let kind = match keyword {
            "v" => 0,
            "vt" => 1,
            "vn" => 2,
            "f" => return self.add_face(line, &tokens),
            _ => return Ok(()),
        };
        // A fourth coordinate divides a position; six numbers are a position and a colour.
        let kept = match (kind, tokens.len()) {
            (0, 4) => 4,
            (1, 1) => 1,
            (1, _) => 2,
            _ => 3,
        };
        let numbers = tokens
            .get(..kept)
            .ok_or_else(|| format!("{keyword} needs {kept} numbers, but there are {}", tokens.len()))?;
        for (place, token) in numbers.iter().enumerate() {
            let number: f32 = token.parse().map_err(|_| format!("{:?} is not a number", shortened(token)))?;
            if !number.is_finite() || (place == 3 && number == 0.0) {
                return Err(format!("{keyword} must not contain {number}"));
            }
        }
        self.counts[kind] += 1;
        self.push(keyword, numbers);
        if (kind, kept) == (1, 1) {
            self.text.push_str(" 0");
        }
        Ok(())
    }

    fn add_face(&mut self, line: usize, corners: &[&str]) -> Result<(), String> {
        for corner in corners {
            let mut parts = corner.split('/');
            for kind in 0..KINDS.len() {
                match parts.next() {
                    Some("") | None if kind == 0 => {
                        return Err(format!("corner {:?} names no position", shortened(corner)));
                    }
                    Some("") | None => {}
                    Some(part) => self.check_index(kind, part, line)?,
                }
            }
            if parts.next().is_some() {
                return Err(format!("corner {:?} has too many parts", shortened(corner)));
            }
        }
        if corners.len() >= 3 {
            self.push("f", corners);
        }
        Ok(())
    }

    fn check_index(&mut self, kind: usize, part: &str, line: usize) -> Result<(), String> {
        let index: isize = part.parse().map_err(|_| format!("{:?} is not an index", shortened(part)))?;
        let magnitude = index.unsigned_abs();
        if index == 0 || (index < 0 && magnitude > self.counts[kind]) {
            let (count, kind) = (self.counts[kind], KINDS[kind]);
            return Err(format!("index {index} is out of range; {count} {kind} precede it and counting starts at 1"));
        }
        if index > 0 && magnitude > self.largest[kind].0 {
            self.largest[kind] = (magnitude, line);
        }
        Ok(())
    }

    fn push(&mut self, keyword: &str, tokens: &[&str]) {
        if !self.text.is_empty() {
            self.text.push('\n');
        }
        self.text.push_str(keyword);
        for token in tokens {
            self.text.push(' ');
            self.text.push_str(token);
        }
    }
}

/// Lines with their numbers, from 1; one that ends in a backslash goes on in the next.
fn logical_lines(source: &str) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let mut lines = (1..).zip(source.lines());
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let Some(start) = line.strip_suffix('\\') else {
            return Some((number, line.into()));
        };
        let mut joined = start.to_owned();
        for (_, line) in lines.by_ref() {
            joined.push(' ');
            match line.strip_suffix('\\') {
                Some(start) => joined.push_str(start),
                None => {
                    joined.push_str(line);
                    break;
                }
            }
        }
        Some((number, joined.into()))
    })
}

/// A token of the file for a message.
fn shortened(token: &str) -> String {
    token.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn other_encodings_and_missing_faces_are_refused() {
        let latin = [SQUARE.as_bytes(), b"# caf\xe9\nf 1 2 3\n"].concat();
        assert_eq!(parse(&latin).unwrap_err().place, Place::Line(5));
        let wide: Vec<u8> = "\u{feff}v 0 0 0".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(parse(&wide).unwrap_err().reason.contains("UTF-16"));
        assert!(square_with("").unwrap_err().reason.contains("no faces"));
        assert!(parse(b"").unwrap_err().reason.contains("no faces"));
    }
}
