use crate::scene::error::{Fault, Place};
use crate::scene::mesh::{self, Parts};
use crate::scene::tags::Tags;
use earcut::Earcut;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Squares of corners, summed over all polygons that are clipped, that any file may have: ear clipping takes quadratic
/// time on hostile input, some 10 ns for each. A file may have one more for each of its bytes.
const CLIPPED_SQUARES: u64 = 100_000_000;

/// Polygons as OBJ and PLY files give them.
#[derive(Debug, Default)]
pub(super) struct PolygonMesh {
    /// In the file's order and unit.
    pub positions: Vec<Vec3>,
    /// As many as positions, or empty.
    pub normals: Vec<Vec3>,
    /// As many as positions, or empty.
    pub texture_coordinates: Vec<Vec2>,
    /// Vertex numbers of all polygons, one after the other.
    pub corners: Vec<u32>,
    /// Number of corners of each polygon.
    pub arities: Arities,
    /// Of the vertices, where they are asked for.
    pub tags: Tags,
}

impl PolygonMesh {
    /// Cuts every polygon of a file of `size_bytes` into triangles. Polygons of fewer than three
    /// corners (points and lines) are left out.
    pub fn into_parts(self, size_bytes: u64) -> Result<Parts, Fault> {
        mesh::check_positions(&self.positions)?;
        let PolygonMesh { positions, normals, texture_coordinates, corners, arities, tags } = self;
        let indices = match arities {
            Arities::Triangles => corners,
            Arities::Each(arities) => {
                let mut cutter = Cutter { squares_left: CLIPPED_SQUARES + size_bytes, ..Cutter::default() };
                let triangles = arities.iter().map(|&arity| (arity as usize).saturating_sub(2)).sum::<usize>();
                // What a hostile file claims is no reason to allocate: it has so many corners at most.
                let mut indices = Vec::with_capacity(3 * triangles.min(corners.len()));
                let mut rest = &corners[..];
                for (face, &arity) in arities.iter().enumerate() {
                    let Some((polygon, after)) = rest.split_at_checked(arity as usize) else {
                        let reason = format!("{} corners are missing", arity as usize - rest.len());
                        return Err(Fault::new(Place::Face(face), reason));
                    };
                    rest = after;
                    let cut = cutter.cut(&positions, polygon, &mut indices);
                    cut.map_err(|reason| Fault::new(Place::Face(face), reason))?;
                }
                indices
            }
        };
        Ok(Parts { positions, normals, texture_coordinates, indices, tags })
    }
}

/// Corners of each polygon.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) enum Arities {
    /// Each has three.
    #[default]
    Triangles,
    /// As many as there are polygons.
    Each(Vec<u32>),
}

impl Arities {
    /// Counts one more polygon; the others have `before` corners.
    pub fn push(&mut self, arity: u32, before: usize) {
        match self {
            Arities::Triangles if arity == 3 => {}
            Arities::Triangles => {
                let mut each = vec![3; before / 3];
                each.push(arity);
                *self = Arities::Each(each);
            }
            Arities::Each(each) => each.push(arity),
        }
    }

    /// Adds those of polygons that have `corners` together; the others have `before` corners.
    pub fn append(&mut self, more: Arities, corners: usize, before: usize) {
        if matches!((&*self, &more), (Arities::Triangles, Arities::Triangles)) {
            return;
        }
        let each = |arities: Arities, corners: usize| match arities {
            Arities::Triangles => vec![3; corners / 3],
            Arities::Each(each) => each,
        };
        let mut all = each(std::mem::take(self), before);
        all.extend(each(more, corners));
        *self = Arities::Each(all);
    }
}

/// Triangulates polygons in space; keeps its buffers from one polygon to the next.
#[derive(Default)]
struct Cutter {
    earcut: Earcut<f64>,
    /// The corners of a polygon that is clipped, and its triangles.
    points: Vec<DVec3>,
    triangles: Vec<u32>,
    /// Squares of corners that may still be clipped.
    squares_left: u64,
}

impl Cutter {
    /// Appends the triangles of one polygon, which keep its orientation.
    ///
    /// A fan around the first corner serves where no triangle of it turns over, which keeps every
    /// corner on a straight edge connected; other polygons are clipped ear by ear in the plane of
    /// their normal.
    fn cut(&mut self, positions: &[Vec3], polygon: &[u32], indices: &mut Vec<u32>) -> Result<(), String> {
        if let Some(&index) = polygon.iter().find(|&&i| i as usize >= positions.len()) {
            return Err(format!("it names vertex {index}, but there are {}", positions.len()));
        }
        if polygon.len() <= 3 {
            indices.extend(polygon.chunks_exact(3).flatten());
            return Ok(());
        }
        // Relative to the first corner, so that a polygon far from the origin keeps its precision.
        let origin = positions[polygon[0] as usize].as_dvec3();
        let point = |index: &u32| positions[*index as usize].as_dvec3() - origin;
        // A corner is two bytes of a file at least, and its point takes 24: only what is clipped is kept, which is short.
        let normal = newell_normal(polygon.iter().map(point));
        let turns_over = |pair: &[u32]| point(&pair[0]).cross(point(&pair[1])).dot(normal) < 0.0;
        self.triangles.clear();
        if polygon[1..].windows(2).any(turns_over) {
            let squares = (polygon.len() as u64).pow(2);
            self.squares_left = self.squares_left.checked_sub(squares).ok_or_else(|| {
                format!(
                    "with its {} corners the concave polygons so far are too long to be cut; cut them into triangles \
                     where they were made",
                    polygon.len()
                )
            })?;
            self.points.clear();
            self.points.extend(polygon.iter().map(point));
            self.clip(normal);
        }
        if self.triangles.is_empty() {
            indices.extend(polygon[1..].windows(2).flat_map(|pair| [polygon[0], pair[0], pair[1]]));
        } else {
            indices.extend(self.triangles.iter().map(|&corner| polygon[corner as usize]));
        }
        Ok(())
    }

    fn clip(&mut self, normal: DVec3) {
        let (x, y) = normal.normalize().any_orthonormal_pair();
        let plane = |point: &DVec3| DVec2::new(point.dot(x), point.dot(y));
        self.earcut.earcut(self.points.iter().map(|point| plane(point).to_array()), &[], &mut self.triangles);
        for corners in self.triangles.chunks_exact_mut(3) {
            let [a, b, c] = [0, 1, 2].map(|i| plane(&self.points[corners[i] as usize]));
            if (b - a).perp_dot(c - a) < 0.0 {
                corners.swap(1, 2);
            }
        }
    }
}

/// The sum of the cross products of neighbouring corners (Newell's method): normal to the plane
/// that fits a polygon best, of a length twice the polygon's area. Zero for a polygon without area.
fn newell_normal(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    points.clone().zip(points.cycle().skip(1)).map(|(a, b)| a.cross(b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::normals::double_area_vector;
    use glam::Quat;

    /// Cuts one polygon given in a plane and then placed somewhere in space.
    fn cut(outline: &[[f32; 2]]) -> (Vec<Vec3>, Vec<u32>, Vec3) {
        let rotation = Quat::from_rotation_x(1.1) * Quat::from_rotation_y(0.4);
        let place = |p: &[f32; 2]| rotation * Vec3::new(p[0], p[1], 0.0) + Vec3::new(9.0, -7.0, 3.0);
        let positions: Vec<Vec3> = outline.iter().map(place).collect();
        let polygon: Vec<u32> = (0..outline.len() as u32).collect();
        let mut indices = Vec::new();
        Cutter { squares_left: CLIPPED_SQUARES, ..Cutter::default() }.cut(&positions, &polygon, &mut indices).unwrap();
        (positions, indices, rotation * Vec3::Z)
    }

    /// The sum of signed areas equals the polygon's area only when no triangle overlaps another or
    /// lies outside.
    fn assert_area(outline: &[[f32; 2]], area: f64) {
        let (positions, indices, normal) = cut(outline);
        let areas: Vec<f64> = indices
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [0, 1, 2].map(|i| positions[t[i] as usize]);
                double_area_vector(a, b, c).dot(normal.as_dvec3()) / 2.0
            })
            .collect();
        assert!(areas.iter().all(|a| *a > -1e-5), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - area).abs() < 1e-4, "{areas:?}");
        assert_eq!(areas.len(), outline.len() - 2);
    }

    #[test]
    fn concave_polygons_keep_their_area_and_orientation() {
        let l_shape = [[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 3.], [0., 3.]];
        let arrow = [[0., 0.], [2., -1.], [0.5, 0.], [2., 1.]];
        let comb = [
            [0., 0.],
            [5., 0.],
            [5., 3.],
            [4., 3.],
            [4., 1.],
            [3., 1.],
            [3., 3.],
            [2., 3.],
            [2., 1.],
            [1., 1.],
            [1., 3.],
            [0., 3.],
        ];
        for start in 0..6 {
            let mut turned = l_shape;
            turned.rotate_left(start);
            assert_area(&turned, 5.0);
        }
        for start in 0..4 {
            let mut turned = arrow;
            turned.rotate_left(start);
            assert_area(&turned, 0.5);
        }
        assert_area(&comb, 11.0);
    }

    #[test]
    fn corners_on_a_straight_edge_stay_connected() {
        let (_, indices, _) = cut(&[[0., 0.], [1., 0.], [2., 0.], [2., 2.], [0., 2.]]);
        for corner in 0..5 {
            assert!(indices.contains(&corner), "{indices:?}");
        }
        assert_eq!(indices.len(), 9);
    }

    #[test]
    fn a_polygon_without_area_keeps_its_triangles() {
        let (_, indices, _) = cut(&[[0., 0.], [1., 0.], [2., 0.], [3., 0.]]);
        assert_eq!(indices.len(), 6);
    }

    #[test]
    fn points_and_lines_are_left_out_and_bad_polygons_named() {
        let mesh = |corners: Vec<u32>, arities: Vec<u32>| {
            let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
            let arities = Arities::Each(arities);
            PolygonMesh { positions, corners, arities, ..PolygonMesh::default() }.into_parts(0)
        };
        assert_eq!(mesh(vec![0, 0, 1, 0, 1, 2], vec![1, 2, 3]).unwrap().indices, [0, 1, 2]);
        assert_eq!(mesh(vec![0, 1, 2, 0, 1, 2, 3], vec![3, 4]).unwrap_err().place, Place::Face(1));
        assert_eq!(mesh(vec![0, 1, 2, 0], vec![3, 4]).unwrap_err().place, Place::Face(1));
    }

    /// Teeth on one handle, and a spiral of two arms.
    #[test]
    fn long_concave_polygons_are_cut_or_refused_within_seconds() {
        let comb = |count: usize| -> Vec<Vec3> {
            let tooth = |i: usize| Vec3::new(i as f32, ((i + 1) % 2) as f32, 0.0);
            (1..count).map(tooth).chain([Vec3::new(count as f32 / 2.0, -5.0, 0.0)]).collect()
        };
        let spiral = |count: usize| -> Vec<Vec3> {
            let arm = |i: usize, inner: f32| {
                let turn = i as f32 / count as f32 * 200.0;
                Vec3::new(turn.cos(), turn.sin(), 0.0) * (inner + turn)
            };
            (0..count / 2).map(|i| arm(i, 0.0)).chain((0..count / 2).rev().map(|i| arm(i, 1.0))).collect()
        };
        for make in [comb as fn(usize) -> Vec<Vec3>, spiral] {
            for (count, times, is_cut) in [(10_000, 1, true), (60_000, 1, false), (1_000, 101, false)] {
                let positions = make(count);
                let corners = (0..times).flat_map(|_| 0..count as u32).collect();
                let polygons = PolygonMesh {
                    positions,
                    corners,
                    arities: Arities::Each(vec![count as u32; times]),
                    ..Default::default()
                };
                let started = std::time::Instant::now();
                let cut = polygons.into_parts(0);
                assert_eq!(cut.is_ok(), is_cut, "{count} {:?}", cut.err());
                // Twenty times what it takes on an idle machine, and less than it took.
                assert!(started.elapsed().as_secs_f64() < 10.0, "{count}: {:?}", started.elapsed());
            }
        }
    }
}
