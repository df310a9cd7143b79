use crate::scene::Mesh;
use crate::scene::error::{Fault, Place};
use crate::scene::polygon::PolygonMesh;
use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the `vertex` and `face` elements of a PLY file in any of its three encodings.
///
/// Vertices may carry normals (`nx`, `ny`, `nz`) and texture coordinates (`s`, `t` or `u`, `v` or
/// `texture_u`, `texture_v`); all else is left out.
pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let mut source = Source { reader: Reader::new(bytes), size: bytes.len(), is_ascii: true };
    let header = Parser::<Ignored>::new().read_header(&mut source.reader).map_err(|error| source.fault(&error))?;
    source.is_ascii = header.encoding == Encoding::Ascii;
    check_sizes(&header, source.reader.get_ref().len())?;
    let mut mesh = PolygonMesh::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => add_vertices(source.read::<Vertex>(element, &header)?, element, &mut mesh)?,
            "face" => add_faces(source.read::<Face>(element, &header)?, element, &mut mesh)?,
            _ => drop(source.read::<Ignored>(element, &header)?),
        }
    }
    if mesh.arities.is_empty() {
        return Err(Fault::new(Place::Whole, "it has no faces; a point cloud needs to be meshed first"));
    }
    mesh.into_mesh(bytes.len())
}

/// The file and how much of it has been read.
struct Source<'a> {
    reader: Reader<&'a [u8]>,
    size: usize,
    is_ascii: bool,
}

impl Source<'_> {
    fn read<E: PropertyAccess>(&mut self, element: &ElementDef, header: &Header) -> Result<Vec<E>, Fault> {
        Parser::<E>::new()
            .read_payload_for_element(&mut self.reader, element, header)
            .map_err(|error| self.fault(&error))
    }

    fn fault(&self, error: &ParseError) -> Fault {
        let text = error.to_string();
        let message = match error.line() {
            Some(line) => text.trim_start_matches(&format!("Line {line}: ")),
            None => &text,
        };
        let place = match error.line() {
            Some(line) if self.is_ascii => Place::Line(line),
            _ => Place::Byte(self.size - self.reader.get_ref().len()),
        };
        Fault::foreign(place, &plain(message))
    }
}

/// The telling part of the library's message, which quotes the line and prints its own structures.
fn plain(message: &str) -> String {
    let is_plain =
        |part: &&str| !(part.contains('{') || part.contains("expected one of") || part.starts_with("String:"));
    let parts = message.lines().map(str::trim).filter(|part| part.len() > 1 && is_plain(part));
    let mut parts = parts.map(|part| part.trim_start_matches("Error: ").trim_end_matches(['.', ':', ',', ' ']));
    let first = parts.next().unwrap_or("it is not understood");
    let part = if first == "Couldn't read element line" { parts.next_back().unwrap_or(first) } else { first };
    if part.starts_with("Expected element of type") {
        return "a value is missing".to_owned();
    }
    match part.split_once(" with declared type ") {
        Some((property, _)) => format!("{property} has a type that cannot be used"),
        None => part.to_owned(),
    }
}

/// Refuses element counts that the rest of the file cannot hold.
fn check_sizes(header: &Header, available_bytes: usize) -> Result<(), Fault> {
    /// Bytes of memory that may be taken for each of the file, and as many more.
    const PER_BYTE: usize = 16;
    const SPARE: usize = 64 << 20;
    let mut needed_bytes = 0_usize;
    for element in header.elements.values() {
        let properties = element.properties.values();
        let smallest_bytes = match header.encoding {
            // At least one digit and one separator each; the last line may lack its end.
            Encoding::Ascii => 2 * element.properties.len(),
            _ => properties.map(|p| smallest_binary_bytes(&p.data_type)).sum(),
        };
        if smallest_bytes == 0 && element.count > 0 {
            let reason = format!("element {} has no properties", element.name);
            return Err(Fault::new(Place::Whole, reason));
        }
        // A list may be empty, and a face in memory is not; twice, as the list of them grows by copying.
        let is_kept = ["vertex", "face"].contains(&element.name.as_str());
        let face_bytes = 2 * size_of::<Face>() + size_of::<u32>();
        if is_kept
            && element.count.saturating_mul(face_bytes) > available_bytes.saturating_mul(PER_BYTE).saturating_add(SPARE)
        {
            let reason = format!(
                "its header claims {} elements {:?} in {available_bytes} bytes, which leaves them empty",
                element.count, element.name
            );
            return Err(Fault::new(Place::Whole, reason));
        }
        needed_bytes = needed_bytes.saturating_add(element.count.saturating_mul(smallest_bytes));
        if needed_bytes > available_bytes.saturating_add(1) {
            let reason = format!(
                "its header claims {} elements {:?}, for which at least {needed_bytes} bytes must follow, but \
                 {available_bytes} do; the file is cut off or corrupt",
                element.count, element.name
            );
            return Err(Fault::new(Place::Whole, reason));
        }
    }
    Ok(())
}

fn smallest_binary_bytes(data_type: &PropertyType) -> usize {
    match data_type {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => match scalar {
            ScalarType::Char | ScalarType::UChar => 1,
            ScalarType::Short | ScalarType::UShort => 2,
            ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
            ScalarType::Double => 8,
        },
    }
}

fn add_vertices(vertices: Vec<Vertex>, element: &ElementDef, mesh: &mut PolygonMesh) -> Result<(), Fault> {
    let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
    if !has(&["x", "y", "z"]) {
        let reason = "its vertices have no properties x, y and z";
        return Err(Fault::new(Place::Whole, reason));
    }
    mesh.positions = vertices.iter().map(|vertex| vertex.position).collect();
    if has(&["nx", "ny", "nz"]) {
        mesh.normals = vertices.iter().map(|vertex| vertex.normal).collect();
    }
    if has(&["s", "t"]) || has(&["u", "v"]) || has(&["texture_u", "texture_v"]) {
        mesh.texture_coordinates = vertices.iter().map(|v| v.texture_coordinate).collect();
    }
    Ok(())
}

fn add_faces(faces: Vec<Face>, element: &ElementDef, mesh: &mut PolygonMesh) -> Result<(), Fault> {
    if !CORNER_LISTS.iter().any(|name| element.properties.contains_key(*name)) {
        let reason = "its faces have no property vertex_indices or vertex_index";
        return Err(Fault::new(Place::Whole, reason));
    }
    for face in faces {
        // A list is no longer than the file, whose size is limited to 32 bits.
        mesh.arities.push(face.corners.len() as u32);
        mesh.corners.extend(face.corners);
    }
    Ok(())
}

#[derive(Default)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    texture_coordinate: Vec2,
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let target = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "s" | "u" | "texture_u" => &mut self.texture_coordinate.x,
            "t" | "v" | "texture_v" => &mut self.texture_coordinate.y,
            _ => return PropertyAccessResult::Ignored,
        };
        match property.to_f32_lossy() {
            Some(value) => {
                *target = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNER_LISTS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        // A negative number is out of range in any mesh, and is reported as such.
        fn unsigned<T: TryInto<u32>>(list: Vec<T>) -> Vec<u32> {
            list.into_iter().map(|index| index.try_into().unwrap_or(u32::MAX)).collect()
        }
        self.corners = match property {
            Property::ListChar(list) => unsigned(list),
            Property::ListUChar(list) => unsigned(list),
            Property::ListShort(list) => unsigned(list),
            Property::ListUShort(list) => unsigned(list),
            Property::ListInt(list) => unsigned(list),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// An element whose properties are read over.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
            ("element vertex x\nend_header\n", 3, "Couldn't parse line"),
            ("element vertex 3\nproperty foo x\nend_header\n", 4, "Couldn't parse line"),
            ("format binary_little_endian 1.0\n", 3, "Found contradicting format definition"),
            ("property float x\n", 3, "it is not understood"),
            (&format!("{cut}\n3 0 1 2\n\n"), 12, "a value is missing"),
            (&format!("{cut}x\n3 0 1 2\n"), 12, "Couldn't parse element line"),
            (&format!("{cut}0\n3 0 1\n\n"), 13, "Expected 3 list elements, but found only 2"),
            (
                &format!("{}0\n3 0 1 2\n", cut.replace("float x", "list uchar int x")),
                10,
                "has a type that cannot be used",
            ),
        ] {
            let fault = parse(format!("ply\nformat ascii 1.0\n{rest}").as_bytes()).expect_err(rest).to_string();
            assert!(fault.starts_with(&format!("line {line}: ")) && fault.ends_with(reason), "{fault}");
        }
        let fault = parse(b"plx\n").unwrap_err().to_string();
        assert_eq!(fault, "line 1: Expected magic number 'ply'");
    }

    #[test]
    fn empty_faces_make_no_vast_list() {
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\n\
                      property uchar z\nelement face 9000000\nproperty list uchar uchar vertex_indices\nend_header\n";
        let fault = parse(&[header.as_bytes(), &[0; 9_000_003]].concat()).unwrap_err().to_string();
        assert!(fault.contains("claims 9000000 elements \"face\"") && fault.ends_with("leaves them empty"), "{fault}");
    }
}
