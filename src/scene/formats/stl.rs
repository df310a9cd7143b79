use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;

use super::stream::{Stop, Stream};
use crate::scene::error::{Fault, Place};
use crate::scene::loading::LoadParts;
use crate::scene::mesh::Parts;
use crate::scene::notes;
use crate::scene::numbering::Numbering;

/// Header and triangle count of a binary file.
const PREFIX_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;
/// Triangles that are read, and then welded, at once.
const BLOCK_TRIANGLES: usize = 1 << 17;
/// Longest line of a text file: one has five words, or a name.
const MAX_LINE_BYTES: usize = 1 << 10;

/// Reads an STL file, binary or text. Vertices at the same position become one; normals are
/// computed anew, since an STL file has only those of its facets.
///
/// The size and the bytes at the start tell the kinds apart, because many binary files start with `solid` as well. Triangles
/// that a binary file has beyond those that it counts are a fault; a note says where anything else follows.
pub(super) fn read(stream: &mut Stream<'_>) -> Result<Parts, Stop> {
    let mut start = Vec::new();
    stream.append(&mut start, PREFIX_BYTES)?;
    let claimed_bytes = claimed_bytes(&start);
    let size_bytes = stream.size_bytes();
    if is_text(&start) && claimed_bytes != Some(size_bytes) {
        return read_text(start, stream);
    }
    match claimed_bytes {
        None => {
            let reason = "it neither starts with \"solid\" nor is long enough for a binary STL file";
            Err(Fault::new(Place::Whole, reason).into())
        }
        Some(claimed_bytes) if claimed_bytes > size_bytes => {
            let reason = format!(
                "its header claims triangles up to byte {claimed_bytes}, but the file has {size_bytes} bytes; it is \
                 cut off or not an STL file"
            );
            Err(Fault::new(Place::Byte(PREFIX_BYTES - 4), reason).into())
        }
        Some(claimed_bytes) => {
            let count = (claimed_bytes as usize - PREFIX_BYTES) / TRIANGLE_BYTES;
            check_rest(count, size_bytes - claimed_bytes)?;
            read_binary(count, stream)
        }
    }
}

/// Refuses a binary file whose bytes behind the triangles that it counts are triangles by their number, and tells of others.
fn check_rest(count: usize, rest_bytes: u64) -> Result<(), Fault> {
    if rest_bytes == 0 {
        return Ok(());
    }
    if rest_bytes.is_multiple_of(TRIANGLE_BYTES as u64) {
        let more = rest_bytes / TRIANGLE_BYTES as u64;
        let reason = format!(
            "its header counts {count} triangles, and the file has room for {more} more; it was not finished or is damaged: \
             write it anew"
        );
        return Err(Fault::new(Place::Byte(PREFIX_BYTES - 4), reason));
    }
    notes::add(format!("{rest_bytes} bytes behind the {count} triangles that its header counts are left out"));
    Ok(())
}

/// Triangles that a file of `size_bytes` with this start has, where the start tells.
pub(super) fn triangles(start: &[u8], size_bytes: u64) -> Option<u64> {
    let claimed = claimed_bytes(start).filter(|&claimed| claimed <= size_bytes);
    let claimed = claimed.filter(|&claimed| claimed == size_bytes || !is_text(start))?;
    Some((claimed - PREFIX_BYTES as u64) / TRIANGLE_BYTES as u64)
}

/// The size of the binary file that the triangle count stands for; absent in a file too short to
/// have one.
fn claimed_bytes(start: &[u8]) -> Option<u64> {
    let count = start.get(PREFIX_BYTES - 4..PREFIX_BYTES)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    Some(PREFIX_BYTES as u64 + u64::from(count) * TRIANGLE_BYTES as u64)
}

/// True for a start of words: binary files that begin with one have a zero in the header, or in the highest byte of the count.
fn is_text(start: &[u8]) -> bool {
    starts_with_keyword(start.trim_ascii_start(), b"solid") && !start.contains(&0)
}

fn starts_with_keyword(text: &[u8], keyword: &[u8]) -> bool {
    text.get(..keyword.len()).is_some_and(|start| start.eq_ignore_ascii_case(keyword))
}

/// Corners are joined as they come.
#[derive(Default)]
struct Welding {
    numbering: Numbering,
    indices: Vec<u32>,
}

impl Welding {
    fn add(&mut self, corner: Vec3) {
        self.indices.push(self.numbering.number(Numbering::key_of(corner)));
    }

    fn into_parts(self) -> Parts {
        Parts { positions: self.numbering.into_positions(), indices: self.indices, ..Parts::default() }
    }
}

/// Reads so many triangles, which the file has.
fn read_binary(count: usize, stream: &mut Stream<'_>) -> Result<Parts, Stop> {
    let mut welding = Welding { indices: Vec::with_capacity(3 * count), ..Welding::default() };
    let (mut bytes, mut corners) = (Vec::new(), Vec::new());
    let mut left = count;
    while left > 0 {
        let triangles = left.min(BLOCK_TRIANGLES);
        left -= triangles;
        bytes.clear();
        if stream.append(&mut bytes, triangles * TRIANGLE_BYTES)? < triangles * TRIANGLE_BYTES {
            let reason = "it was cut off while it was read";
            return Err(Fault::new(Place::Byte(stream.done_bytes() as usize), reason).into());
        }
        let corner = |bytes: &[u8]| Vec3::from_array([0, 4, 8].map(|at| float(&bytes[at..])));
        let facet = |bytes: &[u8]| [12, 24, 36].map(|at| corner(&bytes[at..]));
        bytes.par_chunks_exact(TRIANGLE_BYTES).with_min_len(1 << 13).map(facet).collect_into_vec(&mut corners);
        let started = Instant::now();
        corners.as_flattened().iter().for_each(|&corner| welding.add(corner));
        LoadParts::welded_since(started);
    }
    Ok(welding.into_parts())
}

/// The first four bytes as a float; there are as many.
fn float(bytes: &[u8]) -> f32 {
    f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn read_text(start: Vec<u8>, stream: &mut Stream<'_>) -> Result<Parts, Stop> {
    let mut stop = None;
    let rest = Rest { stream, stop: &mut stop };
    let mut text = Text::new(BufReader::with_capacity(1 << 20, Cursor::new(start).chain(rest)));
    let mut welding = Welding::default();
    let mut read = || -> io::Result<()> {
        for triangle in stl_io::create_stl_reader(&mut text)? {
            triangle?.vertices.iter().for_each(|vertex| welding.add(Vec3::from(vertex.0)));
        }
        Ok(())
    };
    let result = read();
    let line = text.line;
    drop(text);
    match (result, stop) {
        (_, Some(stop)) => Err(stop),
        (Err(error), None) => Err(Fault::foreign(Place::Line(line), &error).into()),
        (Ok(()), None) => Ok(welding.into_parts()),
    }
}

/// The rest of a stream, as a reader.
struct Rest<'s, 'a> {
    stream: &'s mut Stream<'a>,
    /// Why it stopped.
    stop: &'s mut Option<Stop>,
}

impl Read for Rest<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut bytes = Vec::new();
        match self.stream.append(&mut bytes, buffer.len()) {
            Ok(count) => {
                buffer[..count].copy_from_slice(&bytes);
                Ok(count)
            }
            Err(stop) => {
                *self.stop = Some(stop);
                Err(io::Error::other("it is not read on"))
            }
        }
    }
}

/// The facets of a text file as one lower-case solid, which is what `stl_io` reads; the format
/// allows several solids and any case. One line at a time, so that `line` is where a fault lies.
struct Text<R> {
    rest: R,
    /// That line as it stands in the file.
    raw: Vec<u8>,
    /// Number of the last line given, from 1.
    line: usize,
    /// The rest of that line, not read yet.
    pending: Cursor<Vec<u8>>,
    /// True after `endsolid`, where the file may end.
    is_complete: bool,
}

impl<R: BufRead> Text<R> {
    fn new(rest: R) -> Self {
        let pending = Cursor::new(b"solid all\n".to_vec());
        Self { rest, raw: Vec::new(), line: 0, pending, is_complete: false }
    }

    /// The next line that belongs to a facet, or the end of the solid.
    fn next_line(&mut self) -> io::Result<Option<Vec<u8>>> {
        loop {
            self.raw.clear();
            // One byte more tells a line that is too long, of which `stl_io` would keep and show every word.
            let count = (&mut self.rest).take(MAX_LINE_BYTES as u64 + 1).read_until(b'\n', &mut self.raw)?;
            if count == 0 {
                return Ok(std::mem::take(&mut self.is_complete).then(|| b"endsolid\n".to_vec()));
            }
            self.line += 1;
            if count > MAX_LINE_BYTES {
                let reason = format!("it has more than {MAX_LINE_BYTES} bytes; no line of an STL file has as many");
                return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
            }
            let line = self.raw.trim_ascii();
            if starts_with_keyword(line, b"endsolid") {
                self.is_complete = true;
            } else if starts_with_keyword(line, b"solid") {
                self.is_complete = false;
            } else if !line.is_empty() {
                self.is_complete = false;
                let mut line = line.to_ascii_lowercase();
                line.push(b'\n');
                return Ok(Some(line));
            }
        }
    }
}

impl<R: BufRead> Read for Text<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.pending.read(buffer)?;
        if count > 0 || buffer.is_empty() {
            return Ok(count);
        }
        match self.next_line()? {
            Some(line) => {
                self.pending = Cursor::new(line);
                self.pending.read(buffer)
            }
            None => Ok(0),
        }
    }
}

impl<R: BufRead> Seek for Text<R> {
    /// `stl_io` looks at the first line, which is pending then, and goes back to the start.
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.pending.seek(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::scene::formats::tests::read_with;

    fn parse(bytes: Vec<u8>) -> Result<Mesh, Fault> {
        read_with(read, &bytes)
    }

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
        for header in [&b"exported"[..], b"solid by an exporter\n"] {
            let padded = [binary(header), vec![0; 7]].concat();
            assert_eq!(parse(padded).unwrap(), mesh);
        }
    }

    #[test]
    fn what_follows_the_triangles_is_told_and_more_of_them_are_a_fault() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        let read = |rest: usize| {
            std::fs::write(&path, [binary(b""), vec![0; rest]].concat()).unwrap();
            notes::take();
            let mesh = crate::scene::MeshSource::File(path.clone()).load().map_err(|error| error.to_string());
            mesh.map(|mesh| (mesh.triangle_count(), notes::take().join(" ")))
        };
        assert_eq!(read(0), Ok((2, String::new())));
        for rest in [1, 49, 51, 120] {
            let (count, told) = read(rest).unwrap();
            let part = format!("a.stl: {rest} bytes behind the 2 triangles that its header counts are left out");
            assert!(count == 2 && told.contains(&part), "{rest}: {told}");
        }
        for (rest, more) in [(50, "1 more"), (500, "10 more")] {
            let fault = read(rest).unwrap_err();
            let is_told = fault.contains("byte 80: its header counts 2 triangles") && fault.contains(more);
            assert!(is_told, "{rest}: {fault}");
        }
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
            ("vertex 1 0 0", &format!("vertex 1 0 {}", "0 ".repeat(1 << 20)), 5),
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
