//! The order of triangles and vertices in which a device's vertex cache and memory do best.

use super::Mesh;

/// No place yet; a mesh has fewer vertices.
const NOWHERE: u32 = u32::MAX;

impl Mesh {
    /// Puts the triangles into an order in which neighbours follow each other, and the vertices into that of their first
    /// use; the triangles, their windings and their first corners stay what they are. Vertices that no triangle uses go
    /// to the end.
    pub fn optimise_order(&mut self) {
        let count = self.positions.len();
        meshopt::optimize_vertex_cache_in_place(&mut self.indices, count);
        let (mut places, mut next) = (vec![NOWHERE; count], 0);
        let mut place = |place: &mut u32| {
            if *place == NOWHERE {
                *place = next;
                next += 1;
            }
            *place
        };
        self.indices.iter_mut().for_each(|index| *index = place(&mut places[*index as usize]));
        for unused in &mut places {
            place(unused);
        }
        move_to(&places, &mut self.positions);
        move_to(&places, &mut self.normals);
        move_to(&places, &mut self.texture_coordinates);
        move_to(&places, &mut self.tags.part_of);
        move_to(&places, &mut self.tags.colors);
    }
}

/// Moves each value to its place; a list that is empty stays so.
fn move_to<T: Copy + Default>(places: &[u32], values: &mut Vec<T>) {
    let mut moved = vec![T::default(); values.len()];
    for (value, &place) in values.iter().zip(places) {
        moved[place as usize] = *value;
    }
    *values = moved;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shapes;
    use glam::Vec3;

    #[test]
    fn triangles_stay_what_they_are() {
        let corners = |mesh: &Mesh| {
            let corner = |&i: &u32| {
                let i = i as usize;
                let numbers = [mesh.positions[i].to_array(), mesh.normals[i].to_array()];
                let uv = mesh.texture_coordinates.get(i).map(|uv| uv.to_array().map(f32::to_bits));
                (numbers.map(|n| n.map(f32::to_bits)), uv)
            };
            let mut triangles: Vec<Vec<_>> =
                mesh.indices.chunks_exact(3).map(|t| t.iter().map(corner).collect()).collect();
            triangles.sort_unstable();
            triangles
        };
        for mut mesh in [shapes::teapot(), shapes::sphere(32, 32), shapes::cuboid()] {
            mesh.positions.insert(0, Vec3::splat(9.0));
            mesh.normals.insert(0, Vec3::Y);
            if !mesh.texture_coordinates.is_empty() {
                mesh.texture_coordinates.insert(0, glam::Vec2::ONE);
            }
            mesh.indices.iter_mut().for_each(|index| *index += 1);
            let (before, bounds) = (corners(&mesh), mesh.bounds());
            mesh.optimise_order();
            mesh.validate().unwrap();
            assert!(corners(&mesh) == before, "{}", mesh.name);
            assert_eq!(mesh.bounds(), bounds);
            // What no triangle uses is at the end.
            let last_used = mesh.indices.iter().max().copied().unwrap() as usize;
            assert!(mesh.positions[last_used + 1..].contains(&Vec3::splat(9.0)));
        }
    }
}
