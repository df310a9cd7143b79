//! The names of an experiment's meshes.

use std::path::Path;

use crate::scene::MeshSource;

/// A mesh of an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedMesh {
    /// Its mesh.
    pub source: MeshSource,
    /// Its word, or its file's name without folder and ending: what the thesis's tables may know it by.
    pub model: String,
    /// The same with a number where another mesh before it has that name: rows and files are told apart by it.
    pub name: String,
}

impl NamedMesh {
    /// The meshes in their order.
    pub fn all(meshes: &[MeshSource]) -> Vec<NamedMesh> {
        let mut named: Vec<NamedMesh> = Vec::with_capacity(meshes.len());
        for source in meshes {
            let word = source.to_string();
            let model = match source.path() {
                Some(_) if matches!(source, MeshSource::Divided(..)) => {
                    let (path, count) = word.rsplit_once(':').unwrap_or((&word, ""));
                    format!("{}-{count}", Path::new(path).file_stem().unwrap_or_default().to_string_lossy())
                }
                Some(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
                None => word.replace(':', "-"),
            };
            let is_taken = |name: &str| named.iter().any(|mesh| mesh.name == name);
            let numbered = (2..).map(|number| format!("{model}-{number}"));
            let name = std::iter::once(model.clone()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default();
            named.push(NamedMesh { source: source.clone(), model, name });
        }
        named
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_of_one_name_are_told_apart() {
        let files = ["a/pot.obj", "b/pot.obj", "pot-2.stl", "pot.ply"];
        let sources = files.map(|file| MeshSource::File(file.into()));
        let named = NamedMesh::all(&[&sources[..], &[MeshSource::Teapot]].concat());
        let names: Vec<&str> = named.iter().map(|mesh| mesh.name.as_str()).collect();
        assert_eq!(names, ["pot", "pot-2", "pot-2-2", "pot-3", "teapot"]);
        let models: Vec<&str> = named.iter().map(|mesh| mesh.model.as_str()).collect();
        assert_eq!(models, ["pot", "pot", "pot-2", "pot", "teapot"]);
    }
}
