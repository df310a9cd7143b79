//! Levels of division of a mesh. Chapters 5 and 6 divide large triangles only: where few are large, their edges are split
//! before the fire, on both sides at once so that no crack opens, and all triangles have fewer levels.

use std::borrow::Cow;

use super::count::Splitting;
use super::weld::Welded;
use crate::papers::burning::parameters::{Parameters, Variant};
use crate::scene::{Bounds, Mesh};

/// A mesh, with the levels that each of its triangles is divided to.
pub struct Division<'a> {
    /// As it was, or with edges split: new vertices come after those that were there.
    pub mesh: Cow<'a, Mesh>,
    /// Of that mesh.
    pub welded: Welded,
    /// Subdivisions of each triangle.
    pub levels: u32,
    /// The ends of the edge that each new vertex is in the middle of.
    pub ends: Vec<[u32; 2]>,
}

/// Times fewer triangles that splitting must make than more levels for all: a level's. Levels are taken as the fire comes.
const GAIN: u64 = 4;

impl<'a> Division<'a> {
    /// The levels that are asked for, or the variant's own; else those with which no edge is longer than
    /// [`Parameters::edge`].
    pub fn new(mesh: &'a Mesh, variant: Variant, parameters: &Parameters) -> Self {
        let welded = Welded::new(mesh);
        let given = parameters.levels.or(variant.own_levels());
        let levels = given.unwrap_or_else(|| levels_of(&welded, parameters.edge));
        let split = if given.is_none() && levels > 0 { split(mesh, &welded, levels, parameters.edge) } else { None };
        match split {
            None => Division { mesh: Cow::Borrowed(mesh), welded, levels, ends: Vec::new() },
            Some((splitting, levels)) => {
                let (mesh, ends) = splitting.into_mesh();
                Division { welded: Welded::new(&mesh), mesh: Cow::Owned(mesh), levels, ends }
            }
        }
    }

    /// A value of each vertex of the mesh, of those that were there; new ones have the lower of their edge's ends.
    pub fn with_new(&self, values: &[u32]) -> Vec<u32> {
        let mut values = values.to_vec();
        for [a, b] in &self.ends {
            values.push(values[*a as usize].min(values[*b as usize]));
        }
        values
    }
}

/// Levels after which no edge is longer, at most 5.
fn levels_of(welded: &Welded, edge: f32) -> u32 {
    let position = |corner: u32| welded.positions[corner as usize];
    let lengths = welded.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let longest = lengths.map(|(a, b)| position(a).distance(position(b))).fold(0.0, f32::max);
    (0..5).find(|&level| longest / (1 << level) as f32 <= edge).unwrap_or(5)
}

/// The mesh with its long edges split and the levels that it then needs, where the finest triangles are so much fewer.
fn split(mesh: &Mesh, welded: &Welded, levels: u32, edge: f32) -> Option<(Splitting, u32)> {
    let finest = |count: usize, levels: u32| (count as u64) << (2 * levels);
    let bounds = Bounds::of_points(mesh.indices.iter().map(|&index| mesh.positions[index as usize]));
    let longest = |level: u32| edge * (bounds.max - bounds.min).length() * (1 << level) as f32;
    // Squares of lengths that 32 bits do not hold cannot be compared.
    if !(longest(0) * longest(0)).is_normal() {
        return None;
    }
    // Where most triangles are large, levels divide them as well.
    let most = (4 * mesh.triangle_count()).max(1 << 14);
    let mut splitting = Splitting::new(mesh);
    let mut best = (finest(welded.triangles.len(), levels) / GAIN, None);
    for fewer in (0..levels).rev() {
        if !splitting.until_no_longer(longest(fewer), most) {
            break;
        }
        let count = finest(splitting.triangle_count(), fewer);
        if count <= best.0 {
            best = (count, Some(fewer));
        }
    }
    let fewer = best.1?;
    let mut splitting = Splitting::new(mesh);
    splitting.until_no_longer(longest(fewer), most);
    Some((splitting, fewer))
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::super::{Lattice, enclosed_volume};
    use super::*;
    use crate::scene::shapes;

    /// Both in one mesh.
    fn joined(mut mesh: Mesh, other: &Mesh) -> Mesh {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&other.positions);
        mesh.normals.extend(&other.normals);
        mesh.indices.extend(other.indices.iter().map(|index| first + index));
        mesh.texture_coordinates.clear();
        mesh
    }

    /// A dense ball beside a box whose edges are long, and one with a spike.
    fn uneven() -> [Mesh; 2] {
        let ball = || shapes::sphere(96, 96);
        let beside = shapes::cuboid().placed(&Mat4::from_translation(Vec3::new(2.5, 0.0, 0.0)));
        let mut spiked = ball();
        let top = spiked.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
        spiked.positions.iter_mut().filter(|p| p.y == top).for_each(|p| p.y = 4.0);
        spiked.texture_coordinates.clear();
        [joined(ball(), &beside), spiked]
    }

    #[test]
    fn few_large_triangles_are_divided_alone() {
        for mesh in uneven() {
            let parameters = Parameters { edge: 0.05, ..Parameters::default() };
            let whole = Welded::new(&mesh);
            let (levels, triangles) = (levels_of(&whole, parameters.edge), whole.triangles.len());
            let volume = |welded: Welded, levels: u32| {
                assert!(welded.is_closed());
                let lattice = Lattice::new(welded, &[], levels);
                let finest: Vec<[u32; 3]> =
                    lattice.finest().iter().map(|t| t.map(|corner| lattice.welds[corner as usize])).collect();
                let length = |a: u32, b: u32| lattice.positions[a as usize].distance(lattice.positions[b as usize]);
                let sides = finest.iter().flat_map(|&[a, b, c]| [length(a, b), length(b, c), length(c, a)]);
                (enclosed_volume(&lattice.positions, &finest), sides.fold(0.0, f32::max), finest.len())
            };
            for variant in [Variant::Solid, Variant::Melting] {
                let division = Division::new(&mesh, variant, &parameters);
                assert!(division.levels < levels, "{levels}");
                assert_eq!(division.mesh.positions.len(), mesh.positions.len() + division.ends.len());
                let (found, longest, count) = volume(division.welded, division.levels);
                // Less than half more than the triangles that were there, in place of 4^levels times as many.
                assert!(
                    longest <= 1.0001 * parameters.edge && count < 3 * triangles / 2,
                    "{longest} {count} {triangles}"
                );
                let (expected, ..) = volume(Welded::new(&mesh), 0);
                assert!((found - expected).abs() < 1e-5, "{found} {expected}");
            }
        }
    }

    #[test]
    fn what_is_large_all_over_has_levels_and_others_stay_as_they_are() {
        let parameters = Parameters::default();
        let levels = |mesh: &Mesh, variant, parameters: &Parameters| {
            let division = Division::new(mesh, variant, parameters);
            assert!(division.ends.is_empty() && *division.mesh == *mesh);
            division.levels
        };
        assert_eq!(levels(&shapes::cuboid(), Variant::Solid, &parameters), 4);
        assert_eq!(levels(&shapes::sphere(64, 64), Variant::Melting, &parameters), 0);
        let [uneven, _] = uneven();
        assert_eq!(levels(&uneven, Variant::Shell, &parameters), 0);
        assert_eq!(levels(&uneven, Variant::Solid, &Parameters { levels: Some(2), ..parameters }), 2);
        // What is so small that squares of its lengths vanish is divided by levels as well.
        let tiny = uneven.clone().placed(&Mat4::from_scale(Vec3::splat(1e-25)));
        assert_eq!(levels(&tiny, Variant::Solid, &Parameters { edge: 0.05, ..Parameters::default() }), 4);
        // Edges that no number of levels brings below the limit.
        let fine = Parameters { edge: 1e-6, ..Parameters::default() };
        assert_eq!(levels(&uneven, Variant::Solid, &fine), 5);
    }

    #[test]
    fn new_vertices_are_of_the_lower_material() {
        let [uneven, _] = uneven();
        let division = Division::new(&uneven, Variant::Solid, &Parameters { edge: 0.05, ..Parameters::default() });
        let of_vertex: Vec<u32> = uneven.positions.iter().map(|p| 1 + u32::from(p.x > 1.2)).collect();
        let all = division.with_new(&of_vertex);
        for (position, number) in division.mesh.positions.iter().zip(&all) {
            assert_eq!(*number, 1 + u32::from(position.x > 1.2), "{position}");
        }
    }
}
