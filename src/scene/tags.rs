//! Tags of a mesh file's vertices beside their positions: the named parts that they belong to, and their colours.

use std::collections::HashMap;

use glam::Vec3;

use super::error::{Fault, Place};
use super::polygon::{Arities, PolygonMesh};

/// Most parts of a file.
const MOST_PARTS: usize = 1 << 16;

/// Parts and colours of the vertices of a mesh that was loaded with them
/// ([`MeshOptions::keeps_tags`](super::MeshOptions::keeps_tags)); empty of any other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tags {
    /// The names of each part: of its object, of its groups and of its material.
    pub names: Vec<Vec<String>>,
    /// The part of each vertex; empty where the file knows no parts.
    pub part_of: Vec<u32>,
    /// Red, green and blue of each vertex as the file has them, 0 to 1; empty without.
    pub colors: Vec<Vec3>,
}

impl Tags {
    /// Those of one more vertex, which is that of number `vertex` again.
    pub(crate) fn double(&mut self, vertex: usize) {
        self.part_of.extend(self.part_of.get(vertex).copied());
        self.colors.extend(self.colors.get(vertex).copied());
    }

    /// Those of one more vertex, between three vertices of another mesh; it is of the part of the first.
    pub(super) fn add_between(&mut self, from: &Tags, corners: [usize; 3], weights: [f32; 3]) {
        self.part_of.extend(from.part_of.get(corners[0]).copied());
        if !from.colors.is_empty() {
            self.colors.push(corners.iter().zip(weights).map(|(&corner, weight)| from.colors[corner] * weight).sum());
        }
    }

    /// The part of these names, which may be new.
    ///
    /// # Errors
    /// More parts than [`MOST_PARTS`].
    pub(super) fn part(&mut self, names: Vec<String>) -> Result<u32, Fault> {
        if self.names.len() >= MOST_PARTS {
            let reason = format!("it has more than {MOST_PARTS} groups with names of their own; join some");
            return Err(Fault::new(Place::Whole, reason));
        }
        self.names.push(names);
        Ok(self.names.len() as u32 - 1)
    }
}

/// Statement that names a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Level {
    Object,
    Group,
    Material,
}

/// The names of parts along the faces of a file.
#[derive(Debug, Default)]
pub(super) struct Runs {
    /// The first face of each run, with the numbers of the names of its object, its groups and its material.
    runs: Vec<(usize, [Option<u32>; 3])>,
    names: Vec<String>,
    numbers: HashMap<String, u32>,
}

impl Runs {
    /// From `face` on, faces have another object, other groups or another material.
    pub fn change(&mut self, face: usize, level: Level, name: String) {
        let next = self.names.len() as u32;
        let number = *self.numbers.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            next
        });
        let mut names = self.runs.last().map_or([None; 3], |(_, names)| *names);
        names[level as usize] = Some(number);
        match self.runs.last_mut() {
            Some((first, last)) if *first == face => *last = names,
            _ => self.runs.push((face, names)),
        }
    }

    /// The single names of a part: that of groups may be several.
    fn names_of(&self, numbers: [Option<u32>; 3]) -> Vec<String> {
        let texts = numbers.into_iter().flatten().map(|number| &self.names[number as usize]);
        let mut names: Vec<String> = Vec::new();
        for text in texts {
            let words = text.split_ascii_whitespace().map(str::to_owned);
            for name in std::iter::once(text.clone()).chain(words) {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        names
    }
}

impl PolygonMesh {
    /// Gives each vertex the part of its faces; one that faces of several parts share becomes as many.
    ///
    /// # Errors
    /// Too many parts.
    pub fn tag(&mut self, runs: &Runs) -> Result<(), Fault> {
        const NONE: u32 = u32::MAX;
        if runs.runs.is_empty() {
            return Ok(());
        }
        let PolygonMesh { positions, normals, texture_coordinates, corners, arities, tags } = self;
        let mut parts: HashMap<[Option<u32>; 3], u32> = HashMap::new();
        let mut twins: HashMap<(u32, u32), u32> = HashMap::new();
        tags.part_of = vec![NONE; positions.len()];
        let mut part = tags.part(Vec::new())?;
        let (mut runs_left, mut rest) = (runs.runs.iter().peekable(), &mut corners[..]);
        let faces = match arities {
            Arities::Triangles => rest.len() / 3,
            Arities::Each(each) => each.len(),
        };
        for face in 0..faces {
            while let Some((_, numbers)) = runs_left.next_if(|(first, _)| *first <= face) {
                part = match parts.get(numbers) {
                    Some(part) => *part,
                    None => tags.part(runs.names_of(*numbers))?,
                };
                parts.insert(*numbers, part);
            }
            let arity = match arities {
                Arities::Triangles => 3,
                Arities::Each(each) => each[face] as usize,
            };
            let (own, after) = std::mem::take(&mut rest).split_at_mut_checked(arity).unwrap_or_default();
            rest = after;
            for corner in own {
                let vertex = *corner as usize;
                match tags.part_of.get(vertex) {
                    Some(&NONE) => tags.part_of[vertex] = part,
                    Some(&other) if other != part => {
                        *corner = *twins.entry((*corner, part)).or_insert_with(|| {
                            positions.push(positions[vertex]);
                            normals.extend(normals.get(vertex).copied());
                            texture_coordinates.extend(texture_coordinates.get(vertex).copied());
                            tags.double(vertex);
                            let twin = positions.len() - 1;
                            tags.part_of[twin] = part;
                            twin as u32
                        });
                    }
                    _ => {}
                }
            }
        }
        // Vertices that no face uses.
        tags.part_of.iter_mut().filter(|part| **part == NONE).for_each(|part| *part = 0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::scene::loading::Conditions;
    use crate::scene::{Mesh, MeshOptions, MeshSource};

    fn load(name: &str, bytes: &[u8], keeps_tags: bool) -> Mesh {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let options = MeshOptions { keeps_tags, is_optimised: true, ..MeshOptions::default() };
        MeshSource::File(path).load_under(&options, &Conditions::plain()).unwrap()
    }

    /// The names of the triangles' parts, each with the positions of its corners; every corner is of one part.
    fn triangles(mesh: &Mesh) -> Vec<(Vec<String>, Vec<[i32; 3]>)> {
        let corners = mesh.indices.chunks_exact(3).map(|corners| {
            let parts: Vec<u32> = corners.iter().map(|corner| mesh.tags.part_of[*corner as usize]).collect();
            assert!(parts.iter().all(|part| *part == parts[0]), "{parts:?}");
            let mut places: Vec<[i32; 3]> =
                corners.iter().map(|corner| mesh.positions[*corner as usize].as_ivec3().to_array()).collect();
            places.sort_unstable();
            (mesh.tags.names[parts[0] as usize].clone(), places)
        });
        let mut all: Vec<_> = corners.collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn faces_of_several_parts_share_no_vertex() {
        let text =
            "v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\no a\ng never\ng b c\nusemtl d e\nf 1 3 4\ng\nf 4 3 1\n";
        let mesh = load("square.obj", text.as_bytes(), true);
        let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let [lower, upper] = [[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [0, 1, 0], [1, 1, 0]]].map(Vec::from);
        let expected = [
            (named(&[]), lower),
            (named(&["a", "", "d e", "d", "e"]), upper.clone()),
            (named(&["a", "b c", "b", "c", "d e", "d", "e"]), upper),
        ];
        assert_eq!(triangles(&mesh), expected);
        let red = |(place, color): (&Vec3, &Vec3)| (*color == Vec3::X) == (*place == Vec3::X);
        assert!(mesh.positions.iter().zip(&mesh.tags.colors).all(red));
        // Who does not ask gets the mesh as it was.
        let plain = load("square.obj", text.as_bytes(), false);
        assert_eq!(plain.tags, Tags::default());
    }

    #[test]
    fn colours_of_ply_files_are_fractions() {
        let header = |kind: &str| {
            format!(
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 property {kind} red\nproperty {kind} green\nproperty {kind} blue\nelement face 1\n\
                 property list uchar int vertex_indices\nend_header\n"
            )
        };
        for (kind, full) in [("uchar", "255"), ("ushort", "65535"), ("float", "1")] {
            let body = format!("0 0 0 {full} 0 0\n1 0 0 0 {full} 0\n0 1 0 0 0 {full}\n3 0 1 2\n");
            let mesh = load("three.ply", format!("{}{body}", header(kind)).as_bytes(), true);
            assert_eq!(mesh.tags.colors, [Vec3::X, Vec3::Y, Vec3::Z], "{kind}");
            assert!(mesh.tags.part_of.is_empty());
        }
    }

    #[test]
    fn meshes_and_materials_of_gltf_are_parts() {
        let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0}},{{"mesh":0}}],
            "materials":[{{"name":"tin"}}],
            "meshes":[{{"name":"pot","primitives":[{{"attributes":{{"POSITION":0}},"material":0}},
                {{"attributes":{{"POSITION":0,"COLOR_0":0}}}}]}}],
            "buffers":[{{"uri":"data:;base64,{data}","byteLength":36}}],
            "bufferViews":[{{"buffer":0,"byteLength":36,"byteStride":12}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}]}}"#
        );
        let mesh = load("pot.gltf", text.as_bytes(), true);
        let names = [["pot", "tin"].map(str::to_owned).to_vec(), vec!["pot".to_owned()]];
        assert_eq!(mesh.tags.names, names);
        assert_eq!((mesh.positions.len(), mesh.tags.part_of.len()), (12, 12));
        assert_eq!(mesh.tags.part_of.iter().filter(|part| **part == 1).count(), 6);
        let mut own = mesh.positions.iter().zip(&mesh.tags.colors).zip(&mesh.tags.part_of);
        assert!(own.all(|((place, color), part)| *color == if *part == 1 { *place } else { Vec3::ONE }));
    }
}
