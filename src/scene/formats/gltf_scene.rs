//! The nodes of a glTF's scene: where they place its meshes, and what of them is passed over.

use crate::scene::error::{Fault, Place};
use crate::scene::notes;
use ::gltf::scene::Transform;
use ::gltf::{Document, Mesh, Node};
use glam::{Mat4, Quat, Vec3, Vec4};

/// Farthest that the length of a rotation may be from 1: some write its four numbers with two digits.
const MOST_OFF_UNIT: f32 = 0.01;
/// Rounding of the last row of a matrix.
const MOST_OFF_ROW: f32 = 1e-6;
/// Extensions that a file may do without, and what it then is.
const PASSED_OVER: [(&str, &str); 2] = [
    ("EXT_mesh_gpu_instancing", "a mesh of many instances is placed once"),
    ("KHR_node_visibility", "nodes that it hides are drawn"),
];

/// A mesh of the scene.
pub(super) struct PlacedMesh<'a> {
    /// The node that places it.
    node: Node<'a>,
    /// The mesh itself.
    pub mesh: Mesh<'a>,
    /// To the world.
    pub transform: Mat4,
}

/// The meshes of the scene's nodes with their transforms to the world.
///
/// # Errors
/// No scene; nodes that are no trees, or have a transform that the format rules out.
pub(super) fn placed_meshes(document: &Document) -> Result<Vec<PlacedMesh<'_>>, Fault> {
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next())
        .ok_or_else(|| Fault::new(Place::Whole, "it has no scene"))?;
    let mut placed = Vec::new();
    let mut is_visited = vec![false; document.nodes().len()];
    let mut open: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    open.reverse();
    while let Some((node, parent)) = open.pop() {
        let fault = |reason: String| Fault::new(Place::Part(format!("node {}", node.index())), reason);
        if std::mem::replace(&mut is_visited[node.index()], true) {
            return Err(fault("it is reached twice; nodes must form trees".to_owned()));
        }
        let transform = parent * matrix(node.transform()).map_err(fault)?;
        let first = open.len();
        open.extend(node.children().map(|child| (child, transform)));
        open[first..].reverse();
        if let Some(mesh) = node.mesh() {
            placed.push(PlacedMesh { node, mesh, transform });
        }
    }
    Ok(placed)
}

/// The matrix of a node; a rotation is brought to unit length.
fn matrix(transform: Transform) -> Result<Mat4, String> {
    match transform {
        Transform::Matrix { matrix } => {
            let matrix = Mat4::from_cols_array_2d(&matrix);
            let row = matrix.row(3);
            if !row.abs_diff_eq(Vec4::W, MOST_OFF_ROW) {
                let [x, y, z, w] = row.to_array();
                return Err(format!("the last row of its matrix is {x} {y} {z} {w}; it has to be 0 0 0 1"));
            }
            Ok(matrix)
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = Quat::from_array(rotation);
            let length = rotation.length();
            let is_unit = (length - 1.0).abs() <= MOST_OFF_UNIT;
            if !is_unit {
                return Err(format!(
                    "its rotation has the length {length}; it has to be 1: normalise it where it was made"
                ));
            }
            Ok(Mat4::from_scale_rotation_translation(Vec3::from(scale), rotation / length, Vec3::from(translation)))
        }
    }
}

/// Tells what else the scene has that would change its shape; so many of its primitives are no triangles.
pub(super) fn note_what_is_left(document: &Document, placed: &[PlacedMesh<'_>], other_parts: usize) {
    let is_morphed = |placed: &&PlacedMesh<'_>| {
        let weights = placed.node.weights().or(placed.mesh.weights()).unwrap_or_default();
        weights.iter().any(|weight| *weight != 0.0)
    };
    let (skinned, morphed) =
        (placed.iter().filter(|placed| placed.node.skin().is_some()).count(), placed.iter().filter(is_morphed).count());
    let of = placed.len();
    if skinned > 0 {
        notes::add(format!(
            "the skins of {skinned} of its {of} meshes are left out: they keep the shape that is stored"
        ));
    }
    if morphed > 0 {
        notes::add(format!(
            "the morph targets of {morphed} of its {of} meshes are left out, whose weights are not 0: they keep the shape \
             that is stored"
        ));
    }
    if other_parts > 0 {
        notes::add(format!("{other_parts} primitives of points and lines are left out"));
    }
    for (name, effect) in PASSED_OVER {
        if document.extensions_used().any(|used| used == name) {
            notes::add(format!("its extension {name} is not read: {effect}"));
        }
    }
}
