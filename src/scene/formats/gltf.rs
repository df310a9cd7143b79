use super::gltf_accessor;
use super::gltf_buffer::Buffers;
use super::gltf_document::{foreign, read_document};
use super::gltf_scene::{PlacedMesh, note_what_is_left, placed_meshes};
use super::stream::{Stop, Stream};
use crate::scene::error::{Fault, Place};
use crate::scene::mesh::{Parts, Placement};
use crate::scene::normals::double_area_vector;
use crate::scene::notes;
use ::gltf::Glb;
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::mesh::Mode;
use ::gltf::{Primitive, Semantic};
use glam::{DVec3, Mat4, Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// Most vertices and most triangle corners of any scene.
const MAX_CORNERS: usize = 1 << 28;
/// As many as a small file may make by naming the same data from any number of primitives and nodes; a larger one may
/// make one for each of its bytes.
const MAX_SHARED_CORNERS: usize = 1 << 24;
/// Most primitives, each as often as nodes place it.
const MAX_PARTS: usize = 1 << 20;
/// Bytes before the document of a GLB file.
const GLB_START: usize = 20;
/// Longest document that is looked at before the file is read, bytes.
const MOST_PROMISING: u64 = 16 << 20;

const POSITION_TYPES: [(Dimensions, DataType); 1] = [(Dimensions::Vec3, DataType::F32)];
const TEXTURE_COORDINATE_TYPES: [(Dimensions, DataType); 3] =
    [(Dimensions::Vec2, DataType::F32), (Dimensions::Vec2, DataType::U8), (Dimensions::Vec2, DataType::U16)];
const COLOR_TYPES: [(Dimensions, DataType); 6] = [
    (Dimensions::Vec3, DataType::F32),
    (Dimensions::Vec3, DataType::U8),
    (Dimensions::Vec3, DataType::U16),
    (Dimensions::Vec4, DataType::F32),
    (Dimensions::Vec4, DataType::U8),
    (Dimensions::Vec4, DataType::U16),
];
const INDEX_TYPES: [(Dimensions, DataType); 3] =
    [(Dimensions::Scalar, DataType::U8), (Dimensions::Scalar, DataType::U16), (Dimensions::Scalar, DataType::U32)];

/// Reads the triangles (lists, strips and fans) of the default scene of a glTF 2.0 file, text or
/// binary, in world space.
///
/// The first scene serves where none is the default. Buffers may be embedded or lie in files
/// below `directory`. Texture coordinates are the first set. Skins, morph targets, points and
/// lines are left out, which a note says, and so are the names of meshes and materials and the colours unless they are asked for.
pub(super) fn read(stream: &mut Stream<'_>, directory: &Path) -> Result<Parts, Stop> {
    let bytes = stream.rest()?;
    let parts = parse(&bytes, directory, stream.keeps_tags)?;
    Ok(parts)
}

/// Triangles of the scene, where the document tells before the data: that of a GLB file, or one that is little itself. None where
/// it is wrong or claims what is not there, which its reader says.
pub(super) fn promised_triangles(stream: &mut Stream<'_>) -> Result<Option<u64>, Stop> {
    let mut text = Vec::new();
    stream.append(&mut text, GLB_START)?;
    let length = match text.strip_prefix(b"glTF") {
        Some(rest) => rest.get(8..12).and_then(|length| length.try_into().ok()).map_or(0, u32::from_le_bytes).into(),
        None => stream.size_bytes(),
    };
    if length > MOST_PROMISING {
        return Ok(None);
    }
    if text.starts_with(b"glTF") {
        text.clear();
    }
    let left = (length as usize).saturating_sub(text.len());
    stream.append(&mut text, left)?;
    Ok(scene_triangles(&text, stream.size_bytes()).ok().flatten())
}

/// Triangles of a document's scene; none where a list of them is not in its buffer, or where there are more than the reader takes.
fn scene_triangles(text: &[u8], file_bytes: u64) -> Result<Option<u64>, Fault> {
    let document = read_document(text)?;
    let is_there = |accessor: &::gltf::Accessor<'_>| {
        accessor.view().is_some_and(|view| {
            let is_elsewhere = matches!(view.buffer().source(), ::gltf::buffer::Source::Uri(_));
            accessor.count().saturating_mul(accessor.size()) <= view.length()
                && (is_elsewhere || view.buffer().length() as u64 <= file_bytes)
        })
    };
    let mut triangles = 0_u64;
    let meshes = placed_meshes(&document)?;
    let parts = meshes.iter().flat_map(|placed| placed.mesh.primitives());
    for (number, part) in parts.enumerate() {
        if number >= MAX_PARTS {
            return Ok(None);
        }
        let Some(list) = part.indices().or_else(|| part.get(&Semantic::Positions)).filter(is_there) else {
            return Ok(None);
        };
        let corners = list.count() as u64;
        triangles = triangles.saturating_add(match part.mode() {
            Mode::Triangles => corners / 3,
            Mode::TriangleStrip | Mode::TriangleFan => corners.saturating_sub(2),
            _ => 0,
        });
    }
    Ok(Some(triangles).filter(|triangles| *triangles <= MAX_CORNERS as u64 / 3))
}

fn parse(bytes: &[u8], directory: &Path, keeps_tags: bool) -> Result<Parts, Fault> {
    let (text, chunk) = open_container(bytes)?;
    let document = read_document(&text)?;
    let buffers = Buffers::read(&document, chunk, directory)?;
    let meshes = placed_meshes(&document)?;
    let parts = || {
        meshes.iter().flat_map(|PlacedMesh { mesh, transform, .. }| {
            mesh.primitives().map(|part| Placed { mesh: mesh.index(), name: mesh.name(), part, transform: *transform })
        })
    };
    let Total { vertices, corners, others } = Total::of(parts(), bytes.len() + buffers.total_bytes())?;
    let placed = || parts().filter(Placed::has_triangles);
    // Nothing is kept before all of it is seen to be good: a small file can make a large mesh.
    let mut has_area = None;
    for part in placed() {
        let found = has_area.unwrap_or(false);
        has_area = Some(found | check_primitive(&part, &buffers, found).map_err(|reason| part.fault(reason))?);
    }
    if has_area == Some(false) {
        return Err(Fault::new(Place::Whole, "none of its triangles has a positive area; a mesh needs at least one"));
    }
    let mut merged = Merged { keeps_tags, ..Merged::default() };
    merged.parts.positions.reserve_exact(vertices);
    merged.parts.normals.reserve_exact(vertices);
    merged.parts.indices.reserve_exact(corners);
    for part in placed() {
        merged.append(&part, &buffers).map_err(|reason| part.fault(reason))?;
        merged.tag(&part, &buffers)?;
    }
    note_what_is_left(&document, &meshes, others);
    merged.finish()
}

/// A primitive of the scene.
struct Placed<'a> {
    /// Number of its mesh.
    mesh: usize,
    /// Its name.
    name: Option<&'a str>,
    part: Primitive<'a>,
    /// To the world.
    transform: Mat4,
}

impl Placed<'_> {
    /// False for points and lines.
    fn has_triangles(&self) -> bool {
        matches!(self.part.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
    }

    fn fault(&self, reason: String) -> Fault {
        Fault::new(Place::Part(format!("mesh {}, primitive {}", self.mesh, self.part.index())), reason)
    }
}

/// The length in a GLB header is subtracted from without a check by the `gltf` crate.
fn check_container(bytes: &[u8]) -> Result<(), Fault> {
    let length = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(4..8)?.try_into().ok()).map(u32::from_le_bytes);
    match length {
        Some(length) if (length as usize) < 12 || length as usize > bytes.len() => {
            let reason = format!(
                "its header claims a length of {length} bytes, but the file has {}; it is cut off or corrupt",
                bytes.len()
            );
            Err(Fault::new(Place::Byte(8), reason))
        }
        Some(length) => {
            let more = bytes.len() - length as usize;
            if more > 0 {
                notes::add(format!("{more} bytes behind the {length} that its header states are left out"));
            }
            Ok(())
        }
        None => Ok(()),
    }
}

/// Sizes of what a scene makes, at most.
#[derive(Default)]
struct Total {
    vertices: usize,
    /// Of triangles.
    corners: usize,
    /// Primitives that are points or lines.
    others: usize,
}

impl Total {
    /// Refuses a scene that is far larger than the file and its buffers, of so many bytes together.
    fn of<'a>(placed: impl Iterator<Item = Placed<'a>>, size_bytes: usize) -> Result<Self, Fault> {
        let most = size_bytes.clamp(MAX_SHARED_CORNERS, MAX_CORNERS);
        let mut total = Self::default();
        for (number, placed) in placed.enumerate() {
            if placed.has_triangles() {
                let count = placed.part.get(&Semantic::Positions).map_or(0, |positions| positions.count());
                let indices = placed.part.indices().map_or(count, |indices| indices.count());
                let per_index = if placed.part.mode() == Mode::Triangles { 1 } else { 3 };
                total.vertices = total.vertices.saturating_add(count);
                total.corners = total.corners.saturating_add(indices.saturating_mul(per_index));
            } else {
                total.others += 1;
            }
            if total.vertices.max(total.corners) > most || number >= MAX_PARTS {
                let reason = format!(
                    "its scene has more than the {most} vertices, {} triangles or {MAX_PARTS} primitives that a file of \
                     its size may make; simplify it",
                    most / 3
                );
                return Err(Fault::new(Place::Whole, reason));
            }
        }
        Ok(total)
    }
}

/// The text of a document, and the binary chunk beside it.
type WithChunk<'a> = (Cow<'a, [u8]>, Option<Cow<'a, [u8]>>);

/// Text and chunk of a binary file; any other is text itself.
fn open_container(bytes: &[u8]) -> Result<WithChunk<'_>, Fault> {
    if !bytes.starts_with(b"glTF") {
        return Ok((Cow::Borrowed(bytes), None));
    }
    check_container(bytes)?;
    let file = Glb::from_slice(bytes).map_err(foreign)?;
    Ok((file.json, file.bin))
}

/// Checks all that [`Merged::append`] reads and all that becomes of it. True for a triangle of positive area, which is
/// looked for unless there `has_area` already.
///
/// No message shows a value: a buffer may be any file beside the document.
fn check_primitive(placed: &Placed<'_>, buffers: &Buffers<'_>, has_area: bool) -> Result<bool, String> {
    let Placed { part, transform, .. } = placed;
    let check = |semantic: Semantic, types: &[_]| match part.get(&semantic) {
        Some(accessor) => {
            gltf_accessor::check(&accessor, types, buffers).map_err(|reason| format!("{semantic:?}: {reason}"))
        }
        None => Ok(()),
    };
    check(Semantic::Positions, &POSITION_TYPES)?;
    check(Semantic::Normals, &POSITION_TYPES)?;
    check(Semantic::TexCoords(0), &TEXTURE_COORDINATE_TYPES)?;
    if let Some(accessor) = part.indices() {
        gltf_accessor::check(&accessor, &INDEX_TYPES, buffers).map_err(|reason| format!("indices: {reason}"))?;
    }
    let reader = part.reader(|buffer| buffers.get(buffer.index()));
    let positions: Vec<Vec3> = reader.read_positions().ok_or("it has no positions")?.map(Vec3::from).collect();
    let count = positions.len();
    if let Some(vertex) = positions.iter().position(|p| !transform.transform_point3(*p).is_finite()) {
        return Err(format!("vertex {vertex}: its position in the scene is not finite"));
    }
    let mut coordinates = reader.read_tex_coords(0).into_iter().flat_map(|read| read.into_f32());
    if let Some(vertex) = coordinates.position(|[u, v]| !(u.is_finite() && (1.0 - v).is_finite())) {
        return Err(format!("vertex {vertex}: its texture coordinate is not finite"));
    }
    let beyond = |index: &u32| *index as usize >= count;
    if let Some(place) = reader.read_indices().and_then(|read| read.into_u32().position(|index| beyond(&index))) {
        return Err(format!("index {place} names a vertex that is not there; there are {count}"));
    }
    if has_area {
        return Ok(true);
    }
    let at = |index: u32| transform.transform_point3(positions[index as usize]);
    let is_wide = |[a, b, c]: [u32; 3]| double_area_vector(at(a), at(b), at(c)) != DVec3::ZERO;
    Ok(match reader.read_indices() {
        Some(indices) => triangles(part.mode(), indices.into_u32()).any(is_wide),
        None => triangles(part.mode(), 0..count as u32).any(is_wide),
    })
}

/// The triangles of a list, strip or fan in the same orientation; loose corners at the end are left out.
fn triangles(mode: Mode, corners: impl Iterator<Item = u32>) -> impl Iterator<Item = [u32; 3]> {
    // The fan's centre or the corner before the last, and the last.
    let mut kept = [0, 0];
    corners.enumerate().filter_map(move |(place, corner)| {
        let [first, last] = kept;
        let triangle = match mode {
            Mode::TriangleFan => (place >= 2).then_some([last, corner, first]),
            Mode::TriangleStrip if place % 2 == 0 => (place >= 2).then_some([first, last, corner]),
            Mode::TriangleStrip => (place >= 2).then_some([first, corner, last]),
            _ => (place % 3 == 2).then_some([first, last, corner]),
        };
        kept = match (mode, place) {
            (_, 0) => [corner, corner],
            (_, 1) | (Mode::TriangleFan, _) => [first, corner],
            (Mode::TriangleStrip, _) => [last, corner],
            (_, place) if place % 3 == 0 => [corner, corner],
            _ => [first, corner],
        };
        triangle
    })
}

/// All primitives seen so far as one mesh.
#[derive(Default)]
struct Merged {
    parts: Parts,
    has_texture_coordinates: bool,
    keeps_tags: bool,
    /// The part of each material of a mesh.
    parts_of: HashMap<(usize, Option<usize>), u32>,
}

impl Merged {
    /// Adds a primitive that was checked, with zero normals where it has none.
    fn append(&mut self, placed: &Placed<'_>, buffers: &Buffers<'_>) -> Result<(), String> {
        let Placed { part, transform, .. } = placed;
        let reader = part.reader(|buffer| buffers.get(buffer.index()));
        let placement = Placement::new(transform);
        let Parts { positions, normals, texture_coordinates, indices, .. } = &mut self.parts;
        let first = positions.len() as u32;
        let read = reader.read_positions().ok_or("it has no positions")?;
        positions.extend(read.map(|position| transform.transform_point3(Vec3::from(position))));
        if let Some(read) = reader.read_normals() {
            normals.extend(read.map(|normal| placement.normal(Vec3::from(normal))));
        }
        normals.resize(positions.len(), Vec3::ZERO);
        if let Some(read) = reader.read_tex_coords(0) {
            self.has_texture_coordinates = true;
            texture_coordinates.resize(first as usize, Vec2::ZERO);
            // glTF counts from the upper edge of the picture.
            texture_coordinates.extend(read.into_f32().map(|[u, v]| Vec2::new(u, 1.0 - v)));
        }
        if self.has_texture_coordinates {
            texture_coordinates.resize(positions.len(), Vec2::ZERO);
        }
        let turned = |[a, b, c]: [u32; 3]| {
            let [b, c] = if placement.reflects { [c, b] } else { [b, c] };
            [a, b, c].map(|index| first + index)
        };
        let count = positions.len() as u32 - first;
        match reader.read_indices() {
            Some(read) => indices.extend(triangles(part.mode(), read.into_u32()).flat_map(turned)),
            None => indices.extend(triangles(part.mode(), 0..count).flat_map(turned)),
        }
        Ok(())
    }

    /// Gives the vertices of the primitive that was added last their part and their colours, where they are wanted.
    fn tag(&mut self, placed: &Placed<'_>, buffers: &Buffers<'_>) -> Result<(), Fault> {
        if !self.keeps_tags {
            return Ok(());
        }
        let Placed { mesh, name, part, .. } = placed;
        let Parts { positions, tags, .. } = &mut self.parts;
        let material = part.material();
        let number = match self.parts_of.get(&(*mesh, material.index())) {
            Some(number) => *number,
            None => {
                let names = [*name, material.name()].into_iter().flatten();
                tags.part(names.map(str::to_owned).collect())?
            }
        };
        self.parts_of.insert((*mesh, material.index()), number);
        tags.part_of.resize(positions.len(), number);
        if let Some(accessor) = part.get(&Semantic::Colors(0)) {
            let checked = gltf_accessor::check(&accessor, &COLOR_TYPES, buffers);
            checked.map_err(|reason| placed.fault(format!("COLOR_0: {reason}")))?;
            let read = part.reader(|buffer| buffers.get(buffer.index())).read_colors(0);
            // Those of primitives before it that have none are white.
            tags.colors.resize(positions.len() - accessor.count().min(positions.len()), Vec3::ONE);
            let colors = read.into_iter().flat_map(|read| read.into_rgb_f32()).map(Vec3::from);
            tags.colors.extend(colors.map(|color| if color.is_finite() { color } else { Vec3::ONE }));
        }
        if !tags.colors.is_empty() {
            tags.colors.resize(positions.len(), Vec3::ONE);
        }
        Ok(())
    }

    fn finish(self) -> Result<Parts, Fault> {
        if self.parts.indices.is_empty() {
            return Err(Fault::new(Place::Whole, "its scene has no triangles"));
        }
        Ok(self.parts)
    }
}

#[cfg(test)]
mod tests;
