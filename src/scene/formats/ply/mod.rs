//! PLY files. The header is read by a library; the elements, which can be many, by us: a piece at a time, by all threads.

mod binary;
mod header;
mod text;

use glam::{Vec2, Vec3};
use ply_rs_bw::ply::{Encoding, PropertyType, ScalarType};

use self::header::Element;
pub(super) use self::header::Header;
use super::stream::{Stop, Stream};
use crate::scene::error::{Fault, Place};
use crate::scene::loading::timed;
use crate::scene::mesh::Parts;
use crate::scene::polygon::{Arities, PolygonMesh};

const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The number that ends a strip of triangles, -1, among vertex numbers.
const END_OF_STRIP: u32 = u32::MAX;

/// Reads the `vertex`, `face` and `tristrips` elements of a PLY file in any of its three encodings.
///
/// Vertices may carry normals (`nx`, `ny`, `nz`) and texture coordinates (`s`, `t` or `u`, `v` or
/// `texture_u`, `texture_v`), and colours (`red`, `green`, `blue`), which count where they are asked for; all else
/// is left out. Strips are lists of vertices, parted by -1, of which each with the two before it is a triangle. A note says where
/// more follows than the header counts.
pub(super) fn read(stream: &mut Stream<'_>) -> Result<Parts, Stop> {
    let header = Header::read(stream)?;
    let mut mesh = PolygonMesh::default();
    match header.encoding {
        Encoding::Ascii => text::read(header, stream, &mut mesh)?,
        Encoding::BinaryLittleEndian => binary::read::<false>(header, stream, &mut mesh)?,
        Encoding::BinaryBigEndian => binary::read::<true>(header, stream, &mut mesh)?,
    }
    if mesh.corners.is_empty() && mesh.arities == Arities::Triangles {
        return Err(Fault::new(Place::Whole, "it has no faces; a point cloud needs to be meshed first").into());
    }
    let size_bytes = stream.size_bytes();
    Ok(timed(|parts| &mut parts.weld_ms, || mesh.into_parts(size_bytes))?)
}

/// Purpose of an element.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Vertices,
    Faces,
    Strips,
    Nothing,
}

/// Index of each property among a vertex's numbers.
const SLOTS: [(&str, usize); 15] = [
    ("x", 0),
    ("y", 1),
    ("z", 2),
    ("nx", 3),
    ("ny", 4),
    ("nz", 5),
    ("s", 6),
    ("u", 6),
    ("texture_u", 6),
    ("t", 7),
    ("v", 7),
    ("texture_v", 7),
    ("red", 8),
    ("green", 9),
    ("blue", 10),
];

/// The first slot of a colour.
const FIRST_COLOR: usize = 8;

/// Numbers of a vertex, by their [`SLOTS`].
type Vertex = [f32; 11];

/// Attributes of the vertices of a file.
#[derive(Clone, Copy)]
struct Carried {
    normals: bool,
    texture_coordinates: bool,
    /// The largest of a colour's numbers, where colours are wanted.
    full_color: Option<f32>,
}

impl Carried {
    /// # Errors
    /// A vertex without a place; a list where a number is wanted.
    fn by(element: &Element, keeps_tags: bool) -> Result<Self, Fault> {
        let has = |names: &[&str]| names.iter().all(|name| element.properties.iter().any(|p| p.name == *name));
        if !has(&["x", "y", "z"]) {
            return Err(Fault::new(Place::Whole, "its vertices have no properties x, y and z"));
        }
        let list = element.properties.iter().find(|p| p.slot.is_some() && matches!(p.kind, PropertyType::List(..)));
        if let Some(list) = list {
            let reason = format!("property {} of its vertices has a type that cannot be used", list.name);
            return Err(Fault::new(Place::Whole, reason));
        }
        Ok(Carried {
            normals: has(&["nx", "ny", "nz"]),
            texture_coordinates: has(&["s", "t"]) || has(&["u", "v"]) || has(&["texture_u", "texture_v"]),
            full_color: full_color(element).filter(|_| keeps_tags),
        })
    }

    fn add(self, [x, y, z, nx, ny, nz, u, v, red, green, blue]: Vertex, mesh: &mut PolygonMesh) {
        mesh.positions.push(Vec3::new(x, y, z));
        if self.normals {
            mesh.normals.push(Vec3::new(nx, ny, nz));
        }
        if self.texture_coordinates {
            mesh.texture_coordinates.push(Vec2::new(u, v));
        }
        if let Some(full) = self.full_color {
            let color = Vec3::new(red, green, blue) / full;
            mesh.tags.colors.push(if color.is_finite() { color } else { Vec3::ONE });
        }
    }

    /// Makes room for so many more vertices.
    fn reserve(self, count: usize, mesh: &mut PolygonMesh) {
        mesh.positions.reserve_exact(count);
        mesh.normals.reserve_exact(if self.normals { count } else { 0 });
        mesh.texture_coordinates.reserve_exact(if self.texture_coordinates { count } else { 0 });
    }
}

/// The largest of the numbers of a colour; none where a vertex has no colour.
fn full_color(element: &Element) -> Option<f32> {
    let kind = |name: &str| element.properties.iter().find(|property| property.name == name).map(|p| &p.kind);
    let (PropertyType::Scalar(red), true) = (kind("red")?, kind("green").is_some() && kind("blue").is_some()) else {
        return None;
    };
    Some(match red {
        ScalarType::Float | ScalarType::Double => 1.0,
        ScalarType::Short | ScalarType::UShort => 65535.0,
        ScalarType::Char | ScalarType::UChar | ScalarType::Int | ScalarType::UInt => 255.0,
    })
}

/// Checks that faces have corners.
///
/// # Errors
/// No list of corners, or one of another kind.
fn check_faces(element: &Element) -> Result<(), Fault> {
    use ScalarType::{Double, Float};
    let name = if element.purpose == Purpose::Strips { "tristrips" } else { "faces" };
    match element.properties.iter().find(|property| property.is_corners).map(|property| &property.kind) {
        None => {
            let reason = format!("its {name} have no property vertex_indices or vertex_index");
            Err(Fault::new(Place::Whole, reason))
        }
        Some(PropertyType::Scalar(_) | PropertyType::List(_, Float | Double)) => {
            let reason = format!("the property vertex_indices of its {name} has a type that cannot be used");
            Err(Fault::new(Place::Whole, reason))
        }
        Some(PropertyType::List(..)) => Ok(()),
    }
}

fn add_face(corners: impl ExactSizeIterator<Item = u32>, mesh: &mut PolygonMesh) {
    // A list is no longer than the file, whose size is limited to 32 bits.
    mesh.arities.push(corners.len() as u32, mesh.corners.len());
    mesh.corners.extend(corners);
}

/// A strip of triangles, as far as it is read.
#[derive(Default)]
struct Strip {
    /// Its last two corners.
    last: [u32; 2],
    /// Number of its corners.
    length: usize,
}

impl Strip {
    /// Adds the triangles of a list of strips.
    fn add_all(corners: impl Iterator<Item = u32>, mesh: &mut PolygonMesh) {
        let mut strip = Strip::default();
        corners.for_each(|corner| strip.add(corner, mesh));
    }

    /// Adds the triangle of the next corner, every other of which turns about, unless two of its corners are one: so strips
    /// go around a corner.
    fn add(&mut self, corner: u32, mesh: &mut PolygonMesh) {
        if corner == END_OF_STRIP {
            *self = Strip::default();
            return;
        }
        let [a, b] = self.last;
        if self.length >= 2 && a != b && b != corner && corner != a {
            let triangle = if self.length.is_multiple_of(2) { [a, b, corner] } else { [b, a, corner] };
            mesh.arities.push(3, mesh.corners.len());
            mesh.corners.extend(triangle);
        }
        self.last = [b, corner];
        self.length += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::scene::formats::tests::read_with;
    use crate::scene::notes;

    fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
        read_with(read, bytes)
    }

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\n\
                          element face 1\nproperty list uchar int vertex_index\nend_header\n";

    fn ascii(body: &str) -> Vec<u8> {
        format!("ply\nformat ascii 1.0\n{HEADER}{body}").into_bytes()
    }

    fn binary(encoding: &str, number: fn(f64, usize) -> Vec<u8>) -> Vec<u8> {
        let mut bytes = format!("ply\nformat {encoding} 1.0\n{HEADER}").into_bytes();
        for [x, y] in [[0., 0.], [1., 0.], [1., 1.], [0., 1.]] {
            for (value, width) in [(x, 4), (y, 8), (0., 4)] {
                bytes.extend(number(value, width));
            }
            bytes.push(7);
        }
        bytes.push(4);
        for index in 0..4_i32 {
            bytes.extend(number(f64::from(index), 0));
        }
        bytes
    }

    fn little(value: f64, width: usize) -> Vec<u8> {
        match width {
            0 => (value as i32).to_le_bytes().to_vec(),
            4 => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        }
    }

    fn big(value: f64, width: usize) -> Vec<u8> {
        little(value, width).into_iter().rev().collect()
    }

    #[test]
    fn the_three_encodings_give_the_same_mesh() {
        let mesh = parse(&ascii("0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3")).unwrap();
        assert_eq!(mesh.indices, [0, 1, 2, 0, 2, 3]);
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        assert_eq!(parse(&binary("binary_little_endian", little)).unwrap(), mesh);
        assert_eq!(parse(&binary("binary_big_endian", big)).unwrap(), mesh);
    }

    #[test]
    fn attributes_are_read_and_other_elements_skipped() {
        let text = "ply\r\nformat ascii 1.0\r\ncomment a\r\nelement camera 2\r\nproperty list uchar float a\r\n\
                    element vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n\
                    property float nx\r\nproperty float ny\r\nproperty float nz\r\n\
                    property float s\r\nproperty float t\r\nelement face 1\r\nproperty uchar flag\r\n\
                    property list uchar uint vertex_indices\r\nend_header\r\n\
                    1 2.5\r\n0\r\n0 0 0 0 3 0 0.25 0.5\r\n1 0 0 0 3 0 0 1\r\n0 1 0 0 0 0 1 1\r\n9 3 0 1 2\r\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.normals, [Vec3::Y, Vec3::Y, Vec3::Z]);
        assert_eq!(mesh.texture_coordinates[0], Vec2::new(0.25, 0.5));
    }

    #[test]
    fn strips_are_triangles_of_one_orientation() {
        // A square, and after the end of its strip another, around a corner that is named twice.
        let strips = [0, 1, 3, 2, -1, 4, 5, 4, 6, 7];
        let expected = [[0, 1, 3], [3, 1, 2], [4, 5, 6], [4, 6, 7]].as_flattened().to_vec();
        let places = [[0, 0], [1, 0], [1, 1], [0, 1], [5, 0], [6, 0], [6, 1], [5, 1]];
        let header = |format: &str, kind: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex 8\nproperty uchar x\nproperty uchar y\nproperty uchar z\n\
                 element tristrips 1\nproperty list uchar {kind} vertex_indices\nend_header\n"
            )
        };
        let lines = places.map(|[x, y]| format!("{x} {y} 0\n")).concat();
        let list = strips.map(|index: i32| format!(" {index}")).concat();
        let text = |list: &str| parse(format!("{}{lines}{list}\n", header("ascii", "int")).as_bytes());
        let mesh = text(&format!("{}{list}", strips.len())).unwrap();
        assert_eq!((&mesh.indices, &mesh.normals), (&expected, &vec![Vec3::Z; 8]));
        let bytes = |format: &str, kind: &str, number: fn(i32) -> Vec<u8>| {
            let mut bytes = header(format, kind).into_bytes();
            bytes.extend(places.iter().flat_map(|[x, y]| [*x, *y, 0]));
            bytes.push(strips.len() as u8);
            bytes.extend(strips.into_iter().flat_map(number));
            parse(&bytes).unwrap()
        };
        assert_eq!(bytes("binary_little_endian", "int", |index| index.to_le_bytes().to_vec()), mesh);
        assert_eq!(bytes("binary_big_endian", "short", |index| (index as i16).to_be_bytes().to_vec()), mesh);
        assert_eq!(bytes("binary_little_endian", "char", |index| vec![index as u8]), mesh);
        for index in [-2, -5, 8] {
            assert_eq!(text(&format!("4 0 1 2 {index}")).unwrap_err().place, Place::Face(1));
        }
        let named = header("ascii", "float") + &lines + "3 0 1 2\n";
        assert!(parse(named.as_bytes()).unwrap_err().reason.contains("of its tristrips has a type"));
    }

    #[test]
    fn what_follows_the_elements_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        let told = |bytes: Vec<u8>| {
            std::fs::write(&path, bytes).unwrap();
            notes::take();
            assert_eq!(crate::scene::MeshSource::File(path.clone()).load().unwrap().triangle_count(), 2);
            notes::take().join(" ")
        };
        let body = "0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n";
        let whole = binary("binary_little_endian", little);
        assert_eq!([told(ascii(body)), told(ascii(&format!("{body} \n\n"))), told(whole.clone())], [""; 3]);
        let lines = told(ascii(&format!("{body}3 0 1 2\n")));
        assert!(lines.contains("a.ply: lines behind the elements that its header counts are left out"), "{lines}");
        for count in [1, 9_000_000] {
            let bytes = told([whole.clone(), vec![0; count]].concat());
            assert!(bytes.contains(&format!("a.ply: {count} bytes behind the elements")), "{bytes}");
            assert!(!told([ascii(body), vec![b'x'; count]].concat()).is_empty());
        }
    }

    #[test]
    fn counts_beyond_the_file_are_refused_before_reading() {
        let header = |format: &str, count: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
                 property float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n"
            )
        };
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for count in ["4000000000", "18446744073709551615"] {
                let fault = parse(header(format, count).as_bytes()).unwrap_err();
                assert!(fault.reason.contains("claims"), "{fault}");
            }
            assert!(parse(header(format, "99999999999999999999").as_bytes()).is_err());
        }
        let empty = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nend_header\n";
        let fault = parse(empty.as_bytes()).unwrap_err();
        assert!(fault.reason.contains("no properties"), "{fault}");
        let mut long_list = binary("binary_little_endian", little);
        let count = long_list.len() - 17;
        long_list[count] = 255;
        assert!(matches!(parse(&long_list).unwrap_err().place, Place::Byte(_)));
    }

    #[test]
    fn faults_are_located_and_on_one_line() {
        let good = "0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n";
        let header_lines = 10;
        for (body, place) in [
            ("0 0 0 7\n1 0 x 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n", Place::Line(header_lines + 2)),
            ("0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2\n", Place::Line(header_lines + 5)),
            (&format!("{good}4 0 1 2 -3"), Place::Face(0)),
            (&format!("{good}4 0 1 2 4"), Place::Face(0)),
            ("1e99 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n", Place::Vertex(0)),
        ] {
            let fault = parse(&ascii(body)).expect_err(body);
            assert_eq!(fault.place, place, "{fault}");
            assert!(!fault.to_string().contains('\n'), "{fault}");
        }
    }

    #[test]
    fn missing_properties_are_named() {
        let text = String::from_utf8(ascii("0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3")).unwrap();
        for (from, to, word) in [
            ("float z", "float w", "x, y and z"),
            ("vertex_index", "corners", "vertex_index"),
            ("element face 1", "element face 0", "no faces"),
            ("property list uchar int", "property int", "cannot be used"),
        ] {
            let fault = parse(text.replace(from, to).as_bytes()).expect_err(from);
            assert!(fault.reason.contains(word), "{fault}");
        }
    }

    #[test]
    fn messages_are_words() {
        let cut = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                   property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 ";
        for (rest, line, reason) in [
            ("element vertex x\nend_header\n", 3, "it is no comment, obj_info, element or property of a PLY header"),
            ("Made by hand\n", 3, "it is no comment, obj_info, element or property of a PLY header"),
            (
                "element vertex 3\nproperty foo x\nend_header\n",
                4,
                "it is no comment, obj_info, element or property of a PLY header",
            ),
            ("format binary_little_endian 1.0\n", 3, "Found contradicting format definition"),
            ("property float x\n", 3, "it is not understood"),
            (&format!("{cut}\n3 0 1 2\n\n"), 12, "a value is missing"),
            (&format!("{cut}x\n3 0 1 2\n"), 12, "\"x\" is not a number"),
            (&format!("{cut}0\n3 0 1\n\n"), 13, "expected 3 list elements, but found only 2"),
        ] {
            let fault = parse(format!("ply\nformat ascii 1.0\n{rest}").as_bytes()).expect_err(rest).to_string();
            assert!(fault.starts_with(&format!("line {line}: ")) && fault.ends_with(reason), "{fault}");
        }
        let list = format!("ply\nformat ascii 1.0\n{}0\n3 0 1 2\n", cut.replace("float x", "list uchar int x"));
        let fault = parse(list.as_bytes()).unwrap_err().to_string();
        assert_eq!(fault, "property x of its vertices has a type that cannot be used");
        let fault = parse(b"plx\n").unwrap_err().to_string();
        assert_eq!(fault, "line 1: its first line is not `ply`; it is something else, or damaged");
    }

    #[test]
    fn empty_faces_make_no_vast_list() {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\n\
                      property uchar z\nelement face 9000000\nproperty list uchar uchar vertex_indices\nend_header\n";
        let fault = parse(&[header.as_bytes(), &[0; 9_000_003]].concat()).unwrap_err().to_string();
        assert!(fault.contains("claims 9000000 elements \"face\"") && fault.ends_with("leaves them empty"), "{fault}");
    }
}
