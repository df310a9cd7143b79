use super::gltf_accessor;
use crate::scene::Mesh;
use crate::scene::error::{Fault, Place};
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::mesh::Mode;
use ::gltf::{Document, Gltf, Primitive, Semantic};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use glam::{Mat4, Vec2, Vec3};
use std::path::Path;

/// Most triangle corners after instancing; a small file can name one mesh from any number of nodes.
const MAX_CORNERS: usize = 1 << 28;

/// Some exporters leave the padding out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

const POSITION_TYPES: [(Dimensions, DataType); 1] = [(Dimensions::Vec3, DataType::F32)];
const TEXTURE_COORDINATE_TYPES: [(Dimensions, DataType); 3] =
    [(Dimensions::Vec2, DataType::F32), (Dimensions::Vec2, DataType::U8), (Dimensions::Vec2, DataType::U16)];
const INDEX_TYPES: [(Dimensions, DataType); 3] =
    [(Dimensions::Scalar, DataType::U8), (Dimensions::Scalar, DataType::U16), (Dimensions::Scalar, DataType::U32)];

/// Reads the triangles (lists, strips and fans) of the default scene of a glTF 2.0 file, text or
/// binary, in world space.
///
/// The first scene serves where none is the default. Buffers may be embedded or lie in files
/// relative to `directory`. Texture coordinates are the first set. Skins, morph targets, points,
/// lines and materials are left out.
pub(super) fn parse(bytes: &[u8], directory: &Path) -> Result<Mesh, Fault> {
    check_container(bytes)?;
    let (document, blob) = read_document(bytes)?;
    let buffers = read_buffers(&document, blob, directory)?;
    let mut merged = Merged::default();
    for (mesh, transform) in placed_meshes(&document)? {
        for primitive in mesh.primitives() {
            let named = |reason| {
                let (mesh, primitive) = (mesh.index(), primitive.index());
                Fault::new(Place::Part(format!("mesh {mesh}, primitive {primitive}")), reason)
            };
            if let Some(part) = read_primitive(&primitive, &buffers).map_err(named)? {
                merged.append(part.transformed(&transform)).map_err(named)?;
            }
        }
    }
    merged.into_mesh()
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
        _ => Ok(()),
    }
}

fn read_document(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Fault> {
    let foreign = |error: ::gltf::Error| Fault::foreign(Place::Whole, &format!("it is no valid glTF: {error}"));
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(foreign)?;
    let json = document.into_json();
    // The validation that follows looks at the accessor of the positions before it looks whether
    // there is one.
    let accessor_count = json.accessors.len();
    for (number, mesh) in json.meshes.iter().enumerate() {
        let mut accessors = mesh.primitives.iter().flat_map(|p| p.attributes.values());
        if let Some(index) = accessors.find(|index| index.value() >= accessor_count) {
            let reason = format!("it names accessor {index}, but there are {accessor_count}");
            return Err(Fault::new(Place::Part(format!("mesh {number}")), reason));
        }
    }
    Ok((Document::from_json(json).map_err(foreign)?, blob))
}

fn read_buffers(document: &Document, mut blob: Option<Vec<u8>>, directory: &Path) -> Result<Vec<Vec<u8>>, Fault> {
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let fault = |reason| Fault::new(Place::Part(format!("buffer {}", buffer.index())), reason);
        let mut bytes = match buffer.source() {
            Source::Bin => blob.take().ok_or_else(|| fault("the file has no binary chunk for it".to_owned()))?,
            Source::Uri(uri) => read_uri(uri, directory).map_err(fault)?,
        };
        if bytes.len() < buffer.length() {
            return Err(fault(format!("it claims {} bytes, but there are {}", buffer.length(), bytes.len())));
        }
        bytes.truncate(buffer.length());
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn read_uri(uri: &str, directory: &Path) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, encoded) = data.split_once(";base64,").ok_or("its data URI is not encoded as base64")?;
        return BASE64.decode(encoded).map_err(|error| Fault::foreign(Place::Whole, &error).reason);
    }
    if uri.contains(':') {
        return Err("only data URIs and relative paths are supported".to_owned());
    }
    let path = percent_decoded(uri).ok_or("its path is not valid percent-encoded UTF-8")?;
    super::read(&directory.join(path)).map_err(|error| Fault::foreign(Place::Whole, &error).reason)
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        rest = after;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let (digits, after) = rest.split_at_checked(2)?;
        bytes.push(u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?);
        rest = after;
    }
    String::from_utf8(bytes).ok()
}

/// The meshes of the scene's nodes with their transforms to the world.
fn placed_meshes(document: &Document) -> Result<Vec<(::gltf::Mesh<'_>, Mat4)>, Fault> {
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next())
        .ok_or_else(|| Fault::new(Place::Whole, "it has no scene"))?;
    let mut placed = Vec::new();
    let mut is_visited = vec![false; document.nodes().len()];
    let mut open: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    open.reverse();
    while let Some((node, parent)) = open.pop() {
        if std::mem::replace(&mut is_visited[node.index()], true) {
            let reason = "it is reached twice; nodes must form trees";
            return Err(Fault::new(Place::Part(format!("node {}", node.index())), reason));
        }
        let transform = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        placed.extend(node.mesh().map(|mesh| (mesh, transform)));
        let first = open.len();
        open.extend(node.children().map(|child| (child, transform)));
        open[first..].reverse();
    }
    Ok(placed)
}

/// The triangles of a primitive, in its own space, with zero normals where it has none; nothing for
/// points and lines.
fn read_primitive(primitive: &Primitive<'_>, buffers: &[Vec<u8>]) -> Result<Option<Mesh>, String> {
    if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let check = |semantic: Semantic, types: &[_]| match primitive.get(&semantic) {
        Some(accessor) => {
            gltf_accessor::check(&accessor, types, buffers).map_err(|reason| format!("{semantic:?}: {reason}"))
        }
        None => Ok(()),
    };
    check(Semantic::Positions, &POSITION_TYPES)?;
    check(Semantic::Normals, &POSITION_TYPES)?;
    check(Semantic::TexCoords(0), &TEXTURE_COORDINATE_TYPES)?;
    if let Some(accessor) = primitive.indices() {
        gltf_accessor::check(&accessor, &INDEX_TYPES, buffers).map_err(|reason| format!("indices: {reason}"))?;
    }
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let positions: Vec<Vec3> = reader.read_positions().ok_or("it has no positions")?.map(Vec3::from).collect();
    let mut normals: Vec<Vec3> = reader.read_normals().map_or(vec![], |normals| normals.map(Vec3::from).collect());
    normals.resize(positions.len(), Vec3::ZERO);
    let mut texture_coordinates: Vec<Vec2> = reader.read_tex_coords(0).map_or(vec![], |coordinates| {
        // glTF counts from the upper edge of the picture.
        let from_below = |[u, v]: [f32; 2]| Vec2::new(u, 1.0 - v);
        coordinates.into_f32().map(from_below).collect()
    });
    if !texture_coordinates.is_empty() {
        texture_coordinates.resize(positions.len(), Vec2::ZERO);
    }
    let corners: Vec<u32> = match reader.read_indices() {
        Some(indices) => indices.into_u32().collect(),
        None => (0..positions.len() as u32).collect(),
    };
    if let Some(index) = corners.iter().find(|i| **i as usize >= positions.len()) {
        let count = positions.len();
        return Err(format!("an index names vertex {index}, but there are {count}"));
    }
    Ok(Some(Mesh {
        name: String::new(),
        positions,
        normals,
        texture_coordinates,
        indices: triangle_list(primitive.mode(), corners),
    }))
}

/// Corners of a triangle list, strip or fan as a list of the same orientation; loose corners at the
/// end are left out.
fn triangle_list(mode: Mode, mut corners: Vec<u32>) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => corners
            .windows(3)
            .enumerate()
            .flat_map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] })
            .collect(),
        Mode::TriangleFan => {
            corners.get(1..).unwrap_or_default().windows(2).flat_map(|pair| [pair[0], pair[1], corners[0]]).collect()
        }
        _ => {
            corners.truncate(corners.len() / 3 * 3);
            corners
        }
    }
}

/// All primitives seen so far as one mesh.
#[derive(Default)]
struct Merged {
    mesh: Mesh,
    has_texture_coordinates: bool,
}

impl Merged {
    fn append(&mut self, part: Mesh) -> Result<(), String> {
        let mesh = &mut self.mesh;
        let corner_count = mesh.indices.len() + part.indices.len();
        let vertex_count = mesh.positions.len() + part.positions.len();
        if corner_count.max(vertex_count) > MAX_CORNERS {
            return Err(format!(
                "with it the scene has {vertex_count} vertices and {} triangles, more than can be loaded; simplify it",
                corner_count / 3
            ));
        }
        let first = mesh.positions.len() as u32;
        self.has_texture_coordinates |= !part.texture_coordinates.is_empty();
        mesh.positions.extend(part.positions);
        mesh.normals.extend(part.normals);
        mesh.texture_coordinates.extend(part.texture_coordinates);
        mesh.texture_coordinates.resize(vertex_count, Vec2::ZERO);
        mesh.indices.extend(part.indices.iter().map(|index| first + index));
        Ok(())
    }

    fn into_mesh(self) -> Result<Mesh, Fault> {
        let Mesh { positions, normals, mut texture_coordinates, indices, .. } = self.mesh;
        if !self.has_texture_coordinates {
            texture_coordinates.clear();
        }
        if indices.is_empty() {
            return Err(Fault::new(Place::Whole, "its scene has no triangles"));
        }
        Mesh::from_file(positions, normals, texture_coordinates, indices)
    }
}

#[cfg(test)]
mod tests;
