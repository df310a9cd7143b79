//! The elements of a binary PLY file of either byte order.

use ply_rs_bw::ply::{PropertyType, ScalarType};
use rayon::prelude::*;

use super::header::{Element, Header, scalar_bytes};
use super::{Carried, Purpose, Strip, Vertex, add_face, check_faces};
use crate::scene::error::{Fault, Place};
use crate::scene::formats::stream::{Stop, Stream};
use crate::scene::notes;
use crate::scene::polygon::{Arities, PolygonMesh};

/// Bytes that are read, and then taken apart, at once.
const BLOCK_BYTES: usize = 6 << 20;
/// Elements that are worth a thread's while.
const LEAST_A_THREAD: usize = 1 << 13;

/// Reads all elements into `mesh`.
pub(super) fn read<const BIG: bool>(
    header: Header,
    stream: &mut Stream<'_>,
    mesh: &mut PolygonMesh,
) -> Result<(), Stop> {
    let mut window = Window { bytes: header.payload, at: 0, stream };
    for element in &header.elements {
        match (element.purpose, element.stride_bytes()) {
            (Purpose::Vertices, Some(stride)) => fixed_vertices::<BIG>(element, stride, &mut window, mesh)?,
            (Purpose::Faces, _) => faces::<BIG>(element, &mut window, mesh)?,
            (Purpose::Strips, _) => strips::<BIG>(element, &mut window, mesh)?,
            _ => others::<BIG>(element, &mut window, mesh)?,
        }
    }
    let more = (window.bytes.len() - window.at) as u64 + window.stream.left_bytes();
    if more > 0 {
        notes::add(format!("{more} bytes behind the elements that its header counts are left out"));
    }
    Ok(())
}

/// The bytes of the file that are looked at.
struct Window<'s, 'a> {
    bytes: Vec<u8>,
    /// First byte that was not used yet.
    at: usize,
    stream: &'s mut Stream<'a>,
}

impl Window<'_, '_> {
    /// Holds at least `wanted` unused bytes, or all that are left.
    fn fill(&mut self, wanted: usize) -> Result<&[u8], Stop> {
        let held = self.bytes.len() - self.at;
        if held < wanted {
            self.bytes.drain(..self.at);
            self.at = 0;
            self.stream.append(&mut self.bytes, wanted - held)?;
        }
        Ok(&self.bytes[self.at..])
    }

    /// The fault of an element that the file does not hold whole.
    fn cut_off(&self, element: &Element) -> Stop {
        let reason = format!("element {:?} is cut off: the file ends in it", element.name);
        Fault::new(Place::Byte(self.stream.size_bytes() as usize), reason).into()
    }
}

/// Vertices without lists.
fn fixed_vertices<const BIG: bool>(
    element: &Element,
    stride: usize,
    window: &mut Window<'_, '_>,
    mesh: &mut PolygonMesh,
) -> Result<(), Stop> {
    let carried = Carried::by(element, window.stream.keeps_tags)?;
    // The file has so many by its header's check.
    carried.reserve(element.count, mesh);
    let mut numbers = Vec::new();
    let mut offset = 0;
    for property in &element.properties {
        if let PropertyType::Scalar(scalar) = &property.kind {
            numbers.extend(property.slot.map(|slot| (offset, scalar, slot)));
            offset += scalar_bytes(scalar);
        }
    }
    let vertex = |bytes: &[u8]| {
        let mut vertex: Vertex = [0.0; 11];
        for &(offset, scalar, slot) in &numbers {
            vertex[slot] = float::<BIG>(scalar, &bytes[offset..]);
        }
        vertex
    };
    let (mut left, mut vertices) = (element.count, Vec::new());
    while left > 0 {
        let count = left.min(BLOCK_BYTES / stride);
        let bytes = window.fill(count * stride)?;
        let Some(bytes) = bytes.get(..count * stride) else { return Err(window.cut_off(element)) };
        bytes.par_chunks_exact(stride).with_min_len(LEAST_A_THREAD).map(vertex).collect_into_vec(&mut vertices);
        vertices.iter().for_each(|&vertex| carried.add(vertex, mesh));
        window.at += count * stride;
        left -= count;
    }
    Ok(())
}

/// Faces; those that are all triangles by all threads.
fn faces<const BIG: bool>(element: &Element, window: &mut Window<'_, '_>, mesh: &mut PolygonMesh) -> Result<(), Stop> {
    check_faces(element)?;
    mesh.corners.reserve_exact(3 * element.count.min(window.stream.size_bytes() as usize / 13));
    let of_triangles = TriangleFaces::new(element);
    let mut left = element.count;
    while left > 0 {
        if let Some(faces) = &of_triangles {
            let count = left.min(BLOCK_BYTES / faces.stride);
            let bytes = window.fill(count * faces.stride)?;
            // Faces of other files, or of the end of this one, are looked at one by one.
            if let Some(bytes) = bytes.get(..count * faces.stride).filter(|bytes| faces.are_all::<BIG>(bytes)) {
                let first = mesh.corners.len();
                mesh.corners.resize(first + 3 * count, 0);
                let into = mesh.corners[first..].par_chunks_exact_mut(3);
                let from = bytes.par_chunks_exact(faces.stride);
                from.zip(into).with_min_len(LEAST_A_THREAD).for_each(|(bytes, into)| {
                    for (k, corner) in into.iter_mut().enumerate() {
                        *corner = index::<BIG>(faces.index, &bytes[faces.first + k * scalar_bytes(faces.index)..]);
                    }
                });
                if let Arities::Each(each) = &mut mesh.arities {
                    each.resize(each.len() + count, 3);
                }
                window.at += count * faces.stride;
                left -= count;
                continue;
            }
        }
        // Not so many that triangles among them are missed for long.
        let count = left.min(1 << 12);
        for _ in 0..count {
            one::<BIG>(element, None, window, mesh)?;
        }
        left -= count;
    }
    Ok(())
}

/// Strips of triangles, one by one: files have few, and long ones.
fn strips<const BIG: bool>(element: &Element, window: &mut Window<'_, '_>, mesh: &mut PolygonMesh) -> Result<(), Stop> {
    check_faces(element)?;
    (0..element.count).try_for_each(|_| one::<BIG>(element, None, window, mesh))
}

/// The layout of faces, if each has three corners.
struct TriangleFaces<'e> {
    stride: usize,
    /// Offset and type of the number of corners.
    count: (usize, &'e ScalarType),
    /// Offset of the first corner.
    first: usize,
    /// Type of a corner.
    index: &'e ScalarType,
}

impl<'e> TriangleFaces<'e> {
    /// None for faces with other lists.
    fn new(element: &'e Element) -> Option<Self> {
        let (mut stride, mut found) = (0, None);
        for property in &element.properties {
            match &property.kind {
                PropertyType::Scalar(scalar) => stride += scalar_bytes(scalar),
                PropertyType::List(count, index) if property.is_corners && found.is_none() => {
                    found = Some((stride, count, index));
                    stride += scalar_bytes(count) + 3 * scalar_bytes(index);
                }
                PropertyType::List(..) => return None,
            }
        }
        found.map(|(at, count, index)| TriangleFaces {
            stride,
            count: (at, count),
            first: at + scalar_bytes(count),
            index,
        })
    }

    fn are_all<const BIG: bool>(&self, bytes: &[u8]) -> bool {
        let (at, scalar) = self.count;
        bytes
            .par_chunks_exact(self.stride)
            .with_min_len(LEAST_A_THREAD)
            .all(|bytes| index::<BIG>(scalar, &bytes[at..]) == 3)
    }
}

/// Elements that are left out, and vertices with lists.
fn others<const BIG: bool>(element: &Element, window: &mut Window<'_, '_>, mesh: &mut PolygonMesh) -> Result<(), Stop> {
    let carried =
        (element.purpose == Purpose::Vertices).then(|| Carried::by(element, window.stream.keeps_tags)).transpose()?;
    (0..element.count).try_for_each(|_| one::<BIG>(element, carried, window, mesh))
}

/// One element, property by property.
fn one<const BIG: bool>(
    element: &Element,
    carried: Option<Carried>,
    window: &mut Window<'_, '_>,
    mesh: &mut PolygonMesh,
) -> Result<(), Stop> {
    let mut vertex: Vertex = [0.0; 11];
    for property in &element.properties {
        let (scalar, length) = match &property.kind {
            PropertyType::Scalar(scalar) => (scalar, 1),
            PropertyType::List(count, scalar) => {
                let bytes = take(window, element, scalar_bytes(count))?;
                (scalar, index::<BIG>(count, bytes) as usize)
            }
        };
        let bytes = take(window, element, length.saturating_mul(scalar_bytes(scalar)))?;
        if let Some(slot) = property.slot {
            vertex[slot] = float::<BIG>(scalar, bytes);
        } else if property.is_corners {
            let corners = bytes.chunks_exact(scalar_bytes(scalar)).map(|bytes| index::<BIG>(scalar, bytes));
            match element.purpose {
                Purpose::Strips => Strip::add_all(corners, mesh),
                _ => add_face(corners, mesh),
            }
        }
    }
    if let Some(carried) = carried {
        carried.add(vertex, mesh);
    }
    Ok(())
}

/// The next bytes of an element, which are used then.
fn take<'w>(window: &'w mut Window<'_, '_>, element: &Element, count: usize) -> Result<&'w [u8], Stop> {
    let held = window.bytes.len() - window.at;
    if held < count {
        let block = count.max(BLOCK_BYTES);
        if window.fill(block)?.len() < count {
            return Err(window.cut_off(element));
        }
    }
    let at = window.at;
    window.at += count;
    Ok(&window.bytes[at..at + count])
}

/// A number as a float; `bytes` begin with it.
fn float<const BIG: bool>(scalar: &ScalarType, bytes: &[u8]) -> f32 {
    match scalar {
        ScalarType::Float => f32::from_bits(word::<BIG>(bytes)),
        ScalarType::Double => f64::from_bits(long_word::<BIG>(bytes)) as f32,
        ScalarType::Char => f32::from(bytes[0] as i8),
        ScalarType::UChar => f32::from(bytes[0]),
        ScalarType::Short => f32::from(half_word::<BIG>(bytes) as i16),
        ScalarType::UShort => f32::from(half_word::<BIG>(bytes)),
        ScalarType::Int => word::<BIG>(bytes) as i32 as f32,
        ScalarType::UInt => word::<BIG>(bytes) as f32,
    }
}

/// A number as a vertex number or a count; a negative one, and one that is no integer, is out of range in any mesh, and -1 is
/// [`END_OF_STRIP`](super::END_OF_STRIP).
fn index<const BIG: bool>(scalar: &ScalarType, bytes: &[u8]) -> u32 {
    match scalar {
        ScalarType::UChar => bytes[0].into(),
        ScalarType::UShort => half_word::<BIG>(bytes).into(),
        ScalarType::UInt | ScalarType::Int => word::<BIG>(bytes),
        ScalarType::Char => i32::from(bytes[0] as i8) as u32,
        ScalarType::Short => i32::from(half_word::<BIG>(bytes) as i16) as u32,
        ScalarType::Float | ScalarType::Double => u32::MAX,
    }
}

fn half_word<const BIG: bool>(bytes: &[u8]) -> u16 {
    let bytes = [bytes[0], bytes[1]];
    if BIG { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) }
}

fn word<const BIG: bool>(bytes: &[u8]) -> u32 {
    let bytes = [bytes[0], bytes[1], bytes[2], bytes[3]];
    if BIG { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

fn long_word<const BIG: bool>(bytes: &[u8]) -> u64 {
    let low = u64::from(word::<BIG>(bytes));
    let high = u64::from(word::<BIG>(&bytes[4..]));
    if BIG { low << 32 | high } else { high << 32 | low }
}
