//! Mesh files of many triangles, in every format.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use fumarole::scene::{Mesh, shapes};

/// Endings with what tells files of one ending apart.
pub const KINDS: [&str; 9] =
    ["obj", "quads.obj", "text.ply", "little.ply", "big.ply", "binary.stl", "text.stl", "glb", "gltf"];

/// A ball of `2 * n * (n - 1)` triangles without normals, welded.
pub fn ball(n: u32) -> Mesh {
    shapes::sphere(n, n)
}

/// Writes a mesh in one of the [`KINDS`].
pub fn write(folder: &Path, kind: &str, mesh: &Mesh) -> PathBuf {
    let path = folder.join(if kind.contains('.') { kind.to_owned() } else { format!("mesh.{kind}") });
    let bytes = match kind {
        "obj" => obj(mesh).into_bytes(),
        "quads.obj" => quads(mesh).into_bytes(),
        "text.ply" => ply_text(mesh),
        "little.ply" => ply(mesh, "little", f32::to_le_bytes, u32::to_le_bytes),
        "big.ply" => ply(mesh, "big", f32::to_be_bytes, u32::to_be_bytes),
        "binary.stl" => stl(mesh),
        "text.stl" => stl_text(mesh).into_bytes(),
        "glb" => glb(mesh),
        "gltf" => {
            fs::write(folder.join("mesh.bin"), chunk(mesh)).unwrap();
            gltf(mesh, r#""uri":"mesh.bin","#).into_bytes()
        }
        other => panic!("{other}"),
    };
    fs::write(&path, bytes).unwrap();
    path
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [u32; 3]> {
    mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
}

fn places(mesh: &Mesh) -> String {
    mesh.positions.iter().fold(String::new(), |mut text, p| {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        text
    })
}

fn obj(mesh: &Mesh) -> String {
    corners(mesh).fold(places(mesh), |mut text, [a, b, c]| {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
        text
    })
}

/// Two triangles at a time, as polygons of four corners where they share an edge.
fn quads(mesh: &Mesh) -> String {
    let triangles: Vec<[u32; 3]> = corners(mesh).collect();
    let mut text = places(mesh);
    for pair in triangles.chunks(2) {
        let _ = match *pair {
            [[a, b, c], [d, e, f]] if (a, c) == (d, e) => writeln!(text, "f {} {} {} {}", a + 1, b + 1, c + 1, f + 1),
            _ => pair.iter().try_for_each(|[a, b, c]| writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1)),
        };
    }
    text
}

fn ply_header(mesh: &Mesh, format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangle_count()
    )
}

fn ply_text(mesh: &Mesh) -> Vec<u8> {
    let mut text = ply_header(mesh, "ascii");
    for p in &mesh.positions {
        let _ = writeln!(text, "{} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in corners(mesh) {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text.into_bytes()
}

fn ply(mesh: &Mesh, order: &str, float: fn(f32) -> [u8; 4], word: fn(u32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = ply_header(mesh, &format!("binary_{order}_endian")).into_bytes();
    bytes.extend(mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(float));
    for triangle in corners(mesh) {
        bytes.push(3);
        bytes.extend(triangle.into_iter().flat_map(word));
    }
    bytes
}

fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangle_count() as u32).to_le_bytes());
    for triangle in corners(mesh) {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|&i| mesh.positions[i as usize].to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_text(mesh: &Mesh) -> String {
    let mut text = "solid ball\n".to_owned();
    for triangle in corners(mesh) {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        for i in triangle {
            let p = mesh.positions[i as usize];
            let _ = writeln!(text, "vertex {} {} {}", p.x, p.y, p.z);
        }
        text.push_str("endloop\nendfacet\n");
    }
    text + "endsolid ball\n"
}

/// Positions, then indices.
fn chunk(mesh: &Mesh) -> Vec<u8> {
    let floats = mesh.positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes);
    floats.chain(mesh.indices.iter().flat_map(|i| i.to_le_bytes())).collect()
}

fn gltf(mesh: &Mesh, uri: &str) -> String {
    let (positions, indices) = (mesh.positions.len(), mesh.indices.len());
    let (first, second) = (12 * positions, 4 * indices);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":
        [{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"buffers":[{{{uri}"byteLength":{}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{first}}},{{"buffer":0,"byteOffset":{first},"byteLength":{second}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{positions},"type":"VEC3","min":[-1,-1,-1],
        "max":[1,1,1]}},{{"bufferView":1,"componentType":5125,"count":{indices},"type":"SCALAR"}}]}}"#,
        first + second
    )
}

fn glb(mesh: &Mesh) -> Vec<u8> {
    let mut json = gltf(mesh, "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let chunk = chunk(mesh);
    let words = |words: &[usize]| words.iter().flat_map(|word| (*word as u32).to_le_bytes()).collect::<Vec<u8>>();
    let total = 28 + json.len() + chunk.len();
    [&b"glTF"[..], &words(&[2, total, json.len()]), b"JSON", &json, &words(&[chunk.len()]), b"BIN\0", &chunk].concat()
}
