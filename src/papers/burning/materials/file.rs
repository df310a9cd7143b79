//! A file of materials: a table `[[material]]` for each, in TOML.

use std::collections::HashMap;
use std::path::Path;

use glam::{Vec2, Vec3};
use serde::Deserialize;
use toml::Spanned;

use super::super::texture::LARGEST_SIDE;
use super::{Kind, Materials, Substance};
use crate::image::{Rgba8, read_png_within};
use crate::measure::Error;
use crate::report::text;
use crate::scene::Mesh;
use crate::{content, file};

/// Largest file that is read, bytes: what is parsed of `a.a.a.a = 0` takes 600 times as much.
const MOST_BYTES: u64 = 96 << 10;
/// Most materials of one.
const MOST_MATERIALS: usize = 256;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    /// A PNG of colours, by the texture coordinates of the vertices, in place of their own; in this file's folder or below.
    texture: Option<Spanned<String>>,
    #[serde(default)]
    material: Vec<Entry>,
}

/// A material of the file. What is not given is the kind's own.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    kind: Spanned<Kind>,
    /// Names of OBJ objects, groups and materials, of glTF meshes and materials.
    #[serde(default)]
    parts: Vec<Spanned<String>>,
    /// The colour of its vertices, of which those are its own that no other colour is nearer to.
    color: Option<Spanned<[f32; 3]>>,
    flammability: Option<Spanned<u32>>,
    epsilon: Option<Spanned<f32>>,
    beta: Option<Spanned<f32>>,
    rho: Option<Spanned<f32>>,
    phi: Option<Spanned<f32>>,
    conductivity: Option<Spanned<f32>>,
    albedo: Option<Spanned<[f32; 3]>>,
}

/// A place in the text, bytes from its start, and what is wrong there.
type Wrong = (Option<usize>, String);

/// Reads the materials of a mesh that was loaded with its tags.
///
/// # Errors
/// A file that cannot be read, is no such TOML, or names what the mesh has not: with the file and its line.
pub fn load(path: &Path, mesh: &Mesh) -> Result<Materials, Error> {
    let cannot = |reason: String| Error::Input(format!("cannot use the materials {}: {reason}", path.display()));
    let text = file::read_text(path, MOST_BYTES);
    let text = text.map_err(|error| cannot(format!("{error}; name a TOML file that can be read")))?;
    let parsed = parse(&text).and_then(|document| {
        let Some(texture) = &document.texture else {
            return assigned(&document.material, mesh, &mesh.tags.colors, text.as_bytes());
        };
        // Before the picture takes its memory.
        let rules = Rules::of(&document.material, mesh, true)?;
        let wrong = |reason: String| (Some(texture.span().start), reason);
        let folder = path.parent().unwrap_or(Path::new(""));
        let picture = file::below(folder, Path::new(texture.get_ref())).map_err(|error| {
            let shown: String = texture.get_ref().chars().take(40).collect();
            wrong(format!("texture {shown:?}: {error}"))
        })?;
        if mesh.texture_coordinates.is_empty() {
            return Err(wrong(format!("the mesh {} has no texture coordinates; name its parts", mesh.name)));
        }
        let picture = read_png_within(&picture, LARGEST_SIDE).map_err(|error| wrong(error.to_string()))?;
        Ok(rules.assign(mesh, &colors_of(&picture, mesh), &[text.as_bytes(), picture.pixels()].concat()))
    });
    parsed.map_err(|(at, reason)| match at {
        None => cannot(reason),
        Some(at) => {
            let line = 1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count();
            cannot(format!("line {line}: {reason}"))
        }
    })
}

/// The colour of a picture's texel at each vertex, as the file has it, 0 to 1; the picture repeats.
fn colors_of(picture: &Rgba8, mesh: &Mesh) -> Vec<Vec3> {
    let at = |share: f32, count: u32| ((share - share.floor()) * count as f32) as usize % count as usize;
    let color = |coordinates: &Vec2| {
        // (0, 0) is the lower left corner, the top row comes first.
        let (column, row) = (at(coordinates.x, picture.width()), at(1.0 - coordinates.y, picture.height()));
        let first = 4 * (row * picture.width() as usize + column);
        Vec3::from([0, 1, 2].map(|channel| f32::from(picture.pixels()[first + channel]) / 255.0))
    };
    mesh.texture_coordinates.iter().map(color).collect()
}

/// Letters of the library's message.
const MOST_QUOTED: usize = 300;

fn parse(text: &str) -> Result<Document, Wrong> {
    let document: Document = toml::from_str(text).map_err(|error| {
        let reason = error.message().split_whitespace().collect::<Vec<_>>().join(" ").replace('`', "\"");
        // It may quote the file.
        let shown = text::one_line(&reason).chars().take(MOST_QUOTED).collect();
        (error.span().map(|span| span.start), shown)
    })?;
    if document.material.is_empty() {
        return Err((None, "it has no [[material]]; add one".to_owned()));
    }
    if document.material.len() > MOST_MATERIALS {
        let count = document.material.len();
        return Err((None, format!("it has {count} materials; {MOST_MATERIALS} are the most")));
    }
    Ok(document)
}

impl Entry {
    fn substance(&self) -> Result<Substance, Wrong> {
        let kind = *self.kind.get_ref();
        let mut substance = Substance::of(kind);
        if let Some(given) = &self.flammability {
            let ticks = *given.get_ref();
            let least = u32::from(kind != Kind::Metal);
            if !(least..=1_000_000).contains(&ticks) || (kind == Kind::Metal && ticks > 0) {
                let range =
                    if kind == Kind::Metal { "0: metal does not burn".to_owned() } else { "1 to 1000000".to_owned() };
                return Err((Some(given.span().start), format!("flammability {ticks} must be {range}")));
            }
            substance.flammability = ticks;
        }
        for (name, given, value) in [
            ("epsilon", &self.epsilon, &mut substance.epsilon),
            ("beta", &self.beta, &mut substance.beta),
            ("rho", &self.rho, &mut substance.rho),
            ("phi", &self.phi, &mut substance.phi),
        ] {
            if let Some(given) = given {
                let number = *given.get_ref();
                if !(number > 0.0 && number < 1.0) {
                    let reason = format!("{name} {number} must be above 0 and below 1");
                    return Err((Some(given.span().start), reason));
                }
                *value = number;
            }
        }
        if let Some(given) = &self.conductivity {
            let number = *given.get_ref();
            if !(1.0..=100.0).contains(&number) {
                return Err((Some(given.span().start), format!("conductivity {number} must be 1 to 100")));
            }
            substance.conductivity = number;
        }
        if let Some(given) = &self.albedo {
            substance.albedo = fractions("albedo", given)?;
        }
        Ok(substance)
    }
}

fn fractions(name: &str, given: &Spanned<[f32; 3]>) -> Result<Vec3, Wrong> {
    let color = *given.get_ref();
    if color.iter().all(|value| (0.0..=1.0).contains(value)) {
        return Ok(Vec3::from(color));
    }
    Err((Some(given.span().start), format!("the numbers of {name} must be 0 to 1")))
}

/// The materials of the vertices, whose colours are `colors`; `content` is all that was read.
fn assigned(entries: &[Entry], mesh: &Mesh, colors_of_vertices: &[Vec3], content: &[u8]) -> Result<Materials, Wrong> {
    let rules = Rules::of(entries, mesh, !colors_of_vertices.is_empty())?;
    Ok(rules.assign(mesh, colors_of_vertices, content))
}

/// The materials, and which vertices they take.
struct Rules {
    substances: Vec<Substance>,
    /// Of each part of the mesh.
    of_part: Vec<Option<u32>>,
    colors: Vec<(Vec3, u32)>,
    /// Of all that no other takes.
    rest: Option<u32>,
}

impl Rules {
    /// Those of a file, for a mesh whose vertices have colours or not.
    fn of(entries: &[Entry], mesh: &Mesh, has_colors: bool) -> Result<Self, Wrong> {
        let tags = &mesh.tags;
        // Of each name the first material that asks for it, and true where a part has it.
        let mut asked: HashMap<&str, (u32, bool)> = HashMap::new();
        for (number, entry) in (1..).zip(entries) {
            for name in &entry.parts {
                asked.entry(name.get_ref()).or_insert((number, false));
            }
        }
        let mut asks_for = |name: &String| {
            let (number, is_found) = asked.get_mut(name.as_str())?;
            *is_found = true;
            Some(*number)
        };
        let of_part: Vec<Option<u32>> =
            tags.names.iter().map(|names| names.iter().filter_map(&mut asks_for).min()).collect();
        let mut rest: Option<u32> = None;
        let mut colors: Vec<(Vec3, u32)> = Vec::new();
        let mut substances = Vec::new();
        for (number, entry) in (1..).zip(entries) {
            substances.push(entry.substance()?);
            for name in &entry.parts {
                if asked.get(name.get_ref().as_str()).is_none_or(|(_, is_found)| !is_found) {
                    return Err((Some(name.span().start), unknown(name.get_ref(), mesh)));
                }
            }
            if let Some(color) = &entry.color {
                if !has_colors {
                    let reason =
                        format!("the mesh {} has no colours of vertices; name its parts or a texture", mesh.name);
                    return Err((Some(color.span().start), reason));
                }
                colors.push((fractions("color", color)?, number));
            }
            if entry.parts.is_empty() && entry.color.is_none() {
                if rest.is_some() {
                    let reason =
                        "a second material without parts and color; one takes all that no other names".to_owned();
                    return Err((Some(entry.kind.span().start), reason));
                }
                rest = Some(number);
            }
        }
        Ok(Rules { substances, of_part, colors, rest })
    }

    fn assign(self, mesh: &Mesh, colors_of_vertices: &[Vec3], content: &[u8]) -> Materials {
        let Rules { substances, of_part, colors, rest } = self;
        let tags = &mesh.tags;
        let nearest = |color: Vec3| {
            let distance = |of: &&(Vec3, u32)| of.0.distance_squared(color);
            colors.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|(_, number)| *number)
        };
        let of_vertex = |vertex: usize| {
            let by_part = || of_part[*tags.part_of.get(vertex)? as usize];
            let by_color = || nearest(*colors_of_vertices.get(vertex)?);
            by_part().or_else(by_color).or(rest).unwrap_or(0)
        };
        let of_vertex = (0..mesh.positions.len()).map(of_vertex).collect();
        Materials { substances, of_vertex, sha256: content::sha256(content) }
    }
}

/// Says which names there are, or the first of them.
fn unknown(name: &str, mesh: &Mesh) -> String {
    const SHOWN: usize = 8;
    let mut names: Vec<&str> = Vec::new();
    for name in mesh.tags.names.iter().flatten() {
        if names.len() <= SHOWN && !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return format!("the mesh {} names no parts; leave parts out", mesh.name);
    }
    let more = if names.len() > SHOWN { ", and more" } else { "" };
    let shown = names.iter().take(SHOWN).map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
    format!("the mesh {} has no part {name:?}; it has {shown}{more}", mesh.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::write_png;
    use crate::scene::{Tags, shapes};

    /// A box of which half of the vertices are of a part "rim" and the others of a group "pot".
    fn tagged() -> Mesh {
        let mut mesh = shapes::cuboid();
        let count = mesh.positions.len();
        let names = vec![vec!["rim".to_owned(), "all".to_owned()], vec!["pot".to_owned(), "all".to_owned()]];
        let part_of = (0..count).map(|vertex| u32::from(vertex >= count / 2)).collect();
        mesh.tags = Tags { names, part_of, colors: vec![Vec3::X; count] };
        mesh
    }

    fn read(text: &str) -> Result<Materials, Wrong> {
        let mesh = tagged();
        parse(text).and_then(|document| assigned(&document.material, &mesh, &mesh.tags.colors, text.as_bytes()))
    }

    #[test]
    fn parts_colours_and_the_rest() {
        let materials =
            read("[[material]]\nkind = \"metal\"\nparts = [\"rim\"]\n[[material]]\nkind = \"paper\"").unwrap();
        let half = materials.of_vertex.len() / 2;
        assert!(materials.of_vertex[..half].iter().all(|number| *number == 1));
        assert!(materials.of_vertex[half..].iter().all(|number| *number == 2));
        assert!(!materials.substances[0].burns() && materials.substances[1].flammability == 15);
        // The first that names a part has it, and a part goes before a colour.
        let text = "[[material]]\nkind=\"wax\"\ncolor=[1,0,0]\nrho = 0.25\n[[material]]\nkind=\"wood\"\nparts=[\"pot\"]\n\
                    [[material]]\nkind=\"metal\"\nparts=[\"all\"]";
        let materials = read(text).unwrap();
        assert_eq!((materials.of_vertex[0], materials.of_vertex[half]), (3, 2));
        assert_eq!(materials.substances[0].rho, 0.25);
        let only =
            read("[[material]]\nkind=\"wax\"\ncolor=[1,0,0]\n[[material]]\nkind=\"wood\"\ncolor=[0,0,1]").unwrap();
        assert!(only.of_vertex.iter().all(|number| *number == 1));
    }

    #[test]
    fn a_texture_gives_the_colours() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("materials.toml");
        // Red to the left, blue to the right.
        let pixels = [[255, 0, 0, 255], [0, 0, 250, 255]].concat();
        write_png(&folder.path().join("map.png"), &Rgba8::new(2, 1, pixels).unwrap()).unwrap();
        let entries =
            "[[material]]\nkind = \"metal\"\ncolor = [1, 0, 0]\n[[material]]\nkind = \"wax\"\ncolor = [0, 0, 1]\n";
        std::fs::write(&path, format!("texture = \"map.png\"\n{entries}")).unwrap();
        let mesh = shapes::sphere(16, 16);
        let materials = load(&path, &mesh).unwrap();
        for (coordinates, number) in mesh.texture_coordinates.iter().zip(&materials.of_vertex) {
            let is_right = coordinates.x - coordinates.x.floor() >= 0.5;
            assert_eq!(*number, 1 + u32::from(is_right), "{coordinates}");
        }
        assert!([1, 2].iter().all(|number| materials.of_vertex.contains(number)));
        // Another picture is another file.
        let pixels = [[255, 0, 0, 255], [0, 0, 255, 255]].concat();
        write_png(&folder.path().join("map.png"), &Rgba8::new(2, 1, pixels).unwrap()).unwrap();
        assert_ne!(load(&path, &mesh).unwrap().sha256, materials.sha256);

        let bare = Mesh { texture_coordinates: Vec::new(), ..mesh.clone() };
        for (mesh, text, part) in [
            (&bare, "texture = \"map.png\"\n", "no texture coordinates"),
            (&mesh, "\ntexture = \"gone.png\"\n", "gone.png"),
            (&mesh, "texture = \"../map.png\"\n", "\"../map.png\": it lies outside the folder"),
            (&mesh, "texture = \"/etc/passwd\"\n", "\"/etc/passwd\": it lies outside the folder"),
        ] {
            std::fs::write(&path, format!("{text}{entries}")).unwrap();
            let error = load(&path, mesh).unwrap_err().to_string();
            let line = if text.starts_with('\n') { "line 2" } else { "line 1" };
            assert!(error.contains(part) && error.contains(line) && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        let wood = "[[material]]\nkind = \"wood\"\n";
        for (text, line, part) in [
            ("", None, "no [[material]]"),
            ("kind = 1", Some(1), "unknown field"),
            ("[[material]]\nkind = \"stone\"", Some(2), "wood"),
            ("[[material]]\nparts = [\"rim\"]", Some(1), "kind"),
            (&format!("{wood}\nrho = 1.5"), Some(4), "rho 1.5"),
            (&format!("{wood}rho = nan"), Some(3), "rho NaN"),
            (&format!("{wood}beta = 0"), Some(3), "beta 0"),
            (&format!("{wood}flammability = 0"), Some(3), "1 to 1000000"),
            (&format!("{wood}flammability = -1"), Some(3), "-1"),
            ("[[material]]\nkind = \"metal\"\nflammability = 5", Some(3), "does not burn"),
            (&format!("{wood}conductivity = 0.5"), Some(3), "conductivity"),
            (&format!("{wood}albedo = [0, 2, 0]"), Some(3), "albedo"),
            (&format!("{wood}albedo = [0, 0]"), Some(3), "3"),
            (&format!("{wood}parts = [\"lid\"]"), Some(3), "\"rim\""),
            (&format!("{wood}{wood}"), Some(4), "second"),
            (&format!("{wood}colour = [1, 0, 0]"), Some(3), "colour"),
            ("[[material", Some(1), ""),
            (&"[".repeat(5000), Some(1), ""),
        ] {
            let Err((at, reason)) = read(text) else { panic!("{text}") };
            let found = at.map(|at| 1 + text.bytes().take(at).filter(|byte| *byte == b'\n').count());
            assert_eq!(found, line, "{text}: {reason}");
            assert!(reason.contains(part) && !reason.contains('\n'), "{text}: {reason}");
        }
        let many = wood.repeat(257);
        assert!(read(&many).is_err_and(|(_, reason)| reason.contains("256")));
    }
}
