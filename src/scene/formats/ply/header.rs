//! The header of a PLY file: its elements and their properties.

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{self, DefaultElement, Encoding, PropertyType, ScalarType};

use super::super::stream::{Stop, Stream};
use super::{CORNER_LISTS, FIRST_COLOR, Purpose, SLOTS};
use crate::scene::error::{Fault, Place};

/// Bytes that are searched for the end of a header.
const LONGEST_BYTES: usize = 1 << 20;
const STEP_BYTES: usize = 1 << 12;

/// A header whose counts the file can hold.
pub struct Header {
    /// ASCII, or binary with its byte order.
    pub(super) encoding: Encoding,
    /// The elements in the file's order.
    pub(super) elements: Vec<Element>,
    /// Bytes behind the header that were read with it.
    pub(super) payload: Vec<u8>,
    /// Its own lines.
    pub(super) lines: usize,
}

pub(super) struct Element {
    /// Name in the header, such as `vertex`.
    pub name: String,
    /// Use of its rows.
    pub purpose: Purpose,
    /// Number of its rows, which the file can hold.
    pub count: usize,
    /// The properties of a row, in their order.
    pub properties: Vec<Property>,
}

pub(super) struct Property {
    /// Name in the header, such as `nx`.
    pub name: String,
    /// Type of its number, or types of its list.
    pub kind: PropertyType,
    /// Index among a vertex's numbers, as in `SLOTS`; none where it is left out.
    pub slot: Option<usize>,
    /// It is the list of a face's corners.
    pub is_corners: bool,
}

impl Header {
    /// # Errors
    /// A fault in it, at its line; counts that the rest of the file cannot hold.
    pub fn read(stream: &mut Stream<'_>) -> Result<Self, Stop> {
        let mut bytes = Vec::new();
        while !has_end(&bytes) && bytes.len() < LONGEST_BYTES && stream.append(&mut bytes, STEP_BYTES)? > 0 {}
        if !(bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace)) {
            let reason = "its first line is not `ply`; it is something else, or damaged";
            return Err(Fault::new(Place::Line(1), reason).into());
        }
        let mut reader = Reader::new(&bytes[..]);
        let parsed = Parser::<DefaultElement>::new().read_header(&mut reader).map_err(|error| fault(&error))?;
        let payload = reader.get_ref().to_vec();
        let header_bytes = bytes.len() - payload.len();
        let lines = memchr::memchr_iter(b'\n', &bytes[..header_bytes]).count();
        check_sizes(&parsed, (stream.size_bytes() as usize).saturating_sub(header_bytes))?;
        let elements = parsed.elements.values().map(Element::new).collect();
        Ok(Header { encoding: parsed.encoding, elements, payload, lines })
    }

    /// Faces, each of which has a triangle as a rule.
    pub fn faces(&self) -> u64 {
        self.elements.iter().filter(|e| e.purpose == Purpose::Faces).map(|e| e.count as u64).sum()
    }
}

impl Element {
    fn new(def: &ply::ElementDef) -> Self {
        let purpose = match def.name.as_str() {
            "vertex" => Purpose::Vertices,
            "face" => Purpose::Faces,
            "tristrips" => Purpose::Strips,
            _ => Purpose::Nothing,
        };
        let property = |(name, property): (&String, &ply::PropertyDef)| Property {
            name: name.clone(),
            kind: property.data_type.clone(),
            slot: slot(name, &property.data_type).filter(|_| purpose == Purpose::Vertices),
            is_corners: matches!(purpose, Purpose::Faces | Purpose::Strips) && CORNER_LISTS.contains(&name.as_str()),
        };
        Element {
            name: def.name.clone(),
            purpose,
            count: def.count,
            properties: def.properties.iter().map(property).collect(),
        }
    }

    /// Bytes of one in a binary file, where all have the same.
    pub fn stride_bytes(&self) -> Option<usize> {
        let scalar = |property: &Property| match &property.kind {
            PropertyType::Scalar(scalar) => Some(scalar_bytes(scalar)),
            PropertyType::List(..) => None,
        };
        self.properties.iter().map(scalar).sum()
    }
}

/// Index of a property among a vertex's numbers; none for colours that are lists.
fn slot(name: &str, kind: &PropertyType) -> Option<usize> {
    let (_, slot) = SLOTS.iter().find(|(known, _)| name == *known)?;
    Some(*slot).filter(|slot| *slot < FIRST_COLOR || matches!(kind, PropertyType::Scalar(_)))
}

/// True where a line says `end_header`.
fn has_end(bytes: &[u8]) -> bool {
    let mut found = memchr::memmem::find_iter(bytes, b"end_header");
    found.any(|at| at > 0 && bytes[at - 1] == b'\n' && bytes[at..].contains(&b'\n'))
}

fn fault(error: &ParseError) -> Fault {
    let text = error.to_string();
    match error.line() {
        Some(line) => Fault::foreign(Place::Line(line), &plain(text.trim_start_matches(&format!("Line {line}: ")))),
        None => Fault::foreign(Place::Whole, &plain(&text)),
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
    if part == "Couldn't parse line" {
        return "it is no comment, obj_info, element or property of a PLY header".to_owned();
    }
    if part.starts_with("Expected element of type") {
        return "a value is missing".to_owned();
    }
    match part.split_once(" with declared type ") {
        Some((property, _)) => format!("{property} has a type that cannot be used"),
        None => part.to_owned(),
    }
}

/// Refuses element counts that the rest of the file cannot hold.
fn check_sizes(header: &ply::Header, available_bytes: usize) -> Result<(), Fault> {
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
        let face_bytes = 13 * size_of::<u32>();
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
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => scalar_bytes(scalar),
    }
}

/// Bytes of a number in a binary file.
pub(super) fn scalar_bytes(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
