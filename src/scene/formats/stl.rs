use crate::scene::Mesh;
use crate::scene::error::{Fault, Place};
use crate::scene::normals::Weld;
use glam::Vec3;
use std::io::{self, Cursor, Read, Seek, SeekFrom};

/// Header and triangle count of a binary file.
const PREFIX_BYTES: usize = 84;
const TRIANGLE_BYTES: u64 = 50;

/// Reads an STL file, binary or text. Vertices at the same position become one; normals are
/// computed anew, since an STL file has only those of its facets.
///
/// The size tells the kinds apart, because many binary files start with `solid` as well.
pub(super) fn parse(mut bytes: Vec<u8>) -> Result<Mesh, Fault> {
    let claimed_bytes = claimed_bytes(&bytes);
    let size_bytes = bytes.len() as u64;
    if starts_with_keyword(bytes.trim_ascii_start(), b"solid") && claimed_bytes != Some(size_bytes) {
        let mut text = Text::new(&bytes);
        let triangles = read(&mut text);
        return triangles.map_err(|error| Fault::foreign(Place::Line(text.line), &error))?;
    }
    match claimed_bytes {
        None => {
            Err(Fault::new(Place::Whole, "it neither starts with \"solid\" nor is long enough for a binary STL file"))
        }
        Some(claimed_bytes) if claimed_bytes > size_bytes => {
            let reason = format!(
                "its header claims triangles up to byte {claimed_bytes}, but the file has {size_bytes} bytes; it is \
                 cut off or not an STL file"
            );
            Err(Fault::new(Place::Byte(PREFIX_BYTES - 4), reason))
        }
        Some(_) => {
            // stl_io takes a file that starts with "solid" for text.
            bytes[..5].fill(0);
            read(&mut Cursor::new(bytes)).map_err(|error| Fault::foreign(Place::Whole, &error))?
        }
    }
}

/// The size of the binary file that the triangle count stands for; absent in a file too short to
/// have one.
fn claimed_bytes(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(PREFIX_BYTES - 4..PREFIX_BYTES)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    Some(PREFIX_BYTES as u64 + u64::from(count) * TRIANGLE_BYTES)
}

fn starts_with_keyword(text: &[u8], keyword: &[u8]) -> bool {
    text.get(..keyword.len()).is_some_and(|start| start.eq_ignore_ascii_case(keyword))
}

/// The mesh, or its fault; the outer error is one of syntax.
fn read(source: &mut (impl Read + Seek)) -> io::Result<Result<Mesh, Fault>> {
    let mut weld = Weld::default();
    let mut positions = Vec::new();
    let mut indices = Vec::new();
    for triangle in stl_io::create_stl_reader(source)? {
        for vertex in triangle?.vertices {
            let position = Vec3::from(vertex.0);
            let (number, is_new) = weld.number(position);
            if is_new {
                positions.push(position);
            }
            indices.push(number);
        }
    }
    Ok(Mesh::from_file(positions, vec![], vec![], indices))
}

/// The facets of a text file as one lower-case solid, which is what `stl_io` reads; the format
/// allows several solids and any case. One line at a time, so that `line` is where a fault lies.
struct Text<'a> {
    rest: &'a [u8],
    /// Number of the last line given, from 1.
    line: usize,
    /// The rest of that line, not read yet.
    pending: Cursor<Vec<u8>>,
    /// True after `endsolid`, where the file may end.
    is_complete: bool,
}

impl<'a> Text<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, line: 0, pending: Cursor::new(b"solid all\n".to_vec()), is_complete: false }
    }

    /// The next line that belongs to a facet, or the end of the solid.
    fn next_line(&mut self) -> Option<Vec<u8>> {
        while !self.rest.is_empty() {
            let end = self.rest.iter().position(|byte| *byte == b'\n');
            let (line, rest) = self.rest.split_at(end.map_or(self.rest.len(), |end| end + 1));
            self.rest = rest;
            self.line += 1;
            let line = line.trim_ascii();
            if starts_with_keyword(line, b"endsolid") {
                self.is_complete = true;
            } else if starts_with_keyword(line, b"solid") {
                self.is_complete = false;
            } else if !line.is_empty() {
                self.is_complete = false;
                let mut line = line.to_ascii_lowercase();
                line.push(b'\n');
                return Some(line);
            }
        }
        std::mem::take(&mut self.is_complete).then(|| b"endsolid\n".to_vec())
    }
}

impl Read for Text<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.pending.read(buffer)?;
        if count > 0 || buffer.is_empty() {
            return Ok(count);
        }
        match self.next_line() {
            Some(line) => {
                self.pending = Cursor::new(line);
                self.pending.read(buffer)
            }
            None => Ok(0),
        }
    }
}

impl Seek for Text<'_> {
    /// `stl_io` looks at the first line, which is pending then, and goes back to the start.
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.pending.seek(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACETS: &str = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1 0\n \
                          endloop\nendfacet\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 -0.0\n  \
                          vertex 1 1 0\n  vertex 0 1 0\n endloop\nendfacet\n";

    fn text(text: &str) -> Result<Mesh, Fault> {
        parse(text.as_bytes().to_vec())
    }

    fn binary(header: &[u8]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend(2_u32.to_le_bytes());
        for triangle in [[[0., 0.], [1., 0.], [1., 1.]], [[0., 0.], [1., 1.], [0., 1.]]] {
            let normal = [0.0_f32; 3];
            let corners = triangle.into_iter().flat_map(|[x, y]: [f32; 2]| [x, y, 0.0]);
            bytes.extend(normal.into_iter().chain(corners).flat_map(f32::to_le_bytes));
            bytes.extend([0, 0]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_give_the_same_welded_mesh() {
        let mesh = text(&format!("solid a b\n{FACETS}endsolid a b\n")).unwrap();
        assert_eq!(mesh.indices, [0, 1, 2, 0, 2, 3]);
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        for header in [&b"exported"[..], b"solid by an exporter\n", b"\xff\xfe"] {
            assert_eq!(parse(binary(header)).unwrap(), mesh);
        }
        let padded = [binary(b""), vec![0; 7]].concat();
        assert_eq!(parse(padded).unwrap(), mesh);
    }

    #[test]
    fn solids_in_any_case_and_number_are_joined() {
        let upper = FACETS.to_uppercase().replace('\n', "\r\n");
        let mesh = text(&format!("\n solid\n{upper}ENDSOLID\nSolid b\nendsolid\nsolid c\n{FACETS}endsolid")).unwrap();
        assert_eq!((mesh.triangle_count(), mesh.positions.len()), (4, 4));
    }

    #[test]
    fn faults_in_text_name_their_line() {
        let whole = format!("solid\n{FACETS}endsolid\n");
        for (from, to, line) in [
            ("vertex 1 0 0", "vertex 1 0", 5),
            ("vertex 1 0 0", "vertex 1 nan 0", 5),
            ("vertex 1 0 0", "vertex 1 1e99 0", 5),
            ("-0.0\n", "\n", 11),
            ("endsolid", "", 16),
            ("endsolid", "endfacet", 16),
        ] {
            let fault = text(&whole.replacen(from, to, 1)).expect_err(to);
            assert_eq!(fault.place, Place::Line(line), "{to}: {fault}");
        }
    }

    #[test]
    fn claims_beyond_the_file_are_refused() {
        let mut bytes = binary(b"");
        bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(parse(bytes).unwrap_err().place, Place::Byte(80));
        let mut nan = binary(b"");
        nan[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(parse(nan).unwrap_err().place, Place::Vertex(0));
        assert!(parse(vec![]).is_err() && text("solid\nendsolid\n").is_err());
    }
}
