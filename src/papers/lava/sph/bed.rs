//! The ground under the lava (chapter 9, "Improved particle simulation"): level, or a height map's.

use std::sync::Arc;

use ash::vk;
use glam::{DVec2, DVec3, Vec2, Vec3};

use super::super::targets::{Context, FLOATS};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Error, Image, ImageDesc, ImageView};
use crate::scene::{HeightMap, Mesh};

/// Most nodes along a side.
const MOST_NODES: u32 = 1024;
/// Nodes along a side of a level floor as it is drawn: light falls on them.
const FLOOR_NODES: u32 = 33;
/// Most samples of a node along each side of its square.
const MOST_TAPS: u32 = 16;

/// Nodes over all of the space, between which slopes and heights are linear.
#[derive(Debug, Clone, PartialEq)]
pub struct Bed {
    columns: u32,
    rows: u32,
    /// Sides of the space along x and z, metres.
    sides_m: DVec2,
    /// Slopes along x and z, height in metres, and 0: row by row.
    nodes: Arc<[[f32; 4]]>,
    is_level: bool,
}

impl Bed {
    /// The floor of the space.
    pub fn level() -> Self {
        Bed { columns: 2, rows: 2, sides_m: DVec2::ONE, nodes: Arc::new([[0.0; 4]; 4]), is_level: true }
    }

    /// A map that covers the space, middle on middle, in its own proportions: columns along x, rows along z, its lowest place in
    /// the space at the floor. Nodes lie `step_m` apart or a little less, and each is the mean of its square.
    pub fn of(map: &HeightMap, space_m: Vec3, step_m: f64) -> Self {
        let sides_m = DVec2::new(space_m.x.into(), space_m.z.into());
        let cells = DVec2::new(f64::from(map.width() - 1), f64::from(map.height() - 1));
        let extent_m = cells * map.spacing_m();
        let scale = (sides_m / extent_m).max_element();
        let counts = (sides_m / step_m).ceil().clamp(DVec2::ONE, DVec2::splat(f64::from(MOST_NODES - 1)));
        let (columns, rows) = (counts.x as u32 + 1, counts.y as u32 + 1);
        let node_m = sides_m / counts;
        // Samples of the map in a node's square.
        let samples = node_m / (scale * map.spacing_m());
        let taps = samples.ceil().clamp(DVec2::ONE, DVec2::splat(f64::from(MOST_TAPS)));
        let height = |column: u32, row: u32| {
            let mut sum = 0.0;
            for y in 0..taps.y as u32 {
                for x in 0..taps.x as u32 {
                    let tap = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / taps - 0.5;
                    let place_m = (DVec2::new(f64::from(column), f64::from(row)) + tap) * node_m;
                    let on_map_m = 0.5 * extent_m + (place_m - 0.5 * sides_m) / scale;
                    sum += sample(map, on_map_m / map.spacing_m());
                }
            }
            scale * sum / (taps.x * taps.y)
        };
        let heights: Vec<f64> = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (column, row)))
            .map(|(column, row)| height(column, row))
            .collect();
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let at = |column: u32, row: u32| heights[(row * columns + column) as usize] - lowest;
        let node = |column: u32, row: u32| {
            let (west, east) = (column.saturating_sub(1), (column + 1).min(columns - 1));
            let (north, south) = (row.saturating_sub(1), (row + 1).min(rows - 1));
            let along_x = (at(east, row) - at(west, row)) / (f64::from(east - west) * node_m.x);
            let along_z = (at(column, south) - at(column, north)) / (f64::from(south - north) * node_m.y);
            [along_x as f32, along_z as f32, at(column, row) as f32, 0.0]
        };
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let nodes = nodes.map(|(column, row)| node(column, row)).collect();
        Bed { columns, rows, sides_m, nodes, is_level: false }
    }

    /// True of the space's floor.
    pub fn is_level(&self) -> bool {
        self.is_level
    }

    /// Device memory of texture and mesh.
    pub(in super::super) fn bytes(&self) -> f64 {
        const NODE: f64 = 16.0 + 24.0 + 24.0;
        NODE * self.nodes.len() as f64
    }

    /// Slopes along x and z, and the height in metres, at a place in metres along x and z.
    pub fn at(&self, place_m: DVec2) -> DVec3 {
        let counts = DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1));
        let place = (place_m / self.sides_m).clamp(DVec2::ZERO, DVec2::ONE) * counts;
        let base = place.floor().min(counts - 1.0);
        let fraction = place - base;
        let node = |x: u32, z: u32| {
            let [along_x, along_z, height, _] =
                self.nodes[((base.y as u32 + z) * self.columns + base.x as u32 + x) as usize];
            Vec3::new(along_x, along_z, height).as_dvec3()
        };
        let north = node(0, 0).lerp(node(1, 0), fraction.x);
        let south = node(0, 1).lerp(node(1, 1), fraction.x);
        north.lerp(south, fraction.y)
    }

    /// The highest node, metres along x and z, and its height.
    pub fn highest(&self) -> (DVec2, f64) {
        let higher =
            |found: (usize, f32), (at, node): (usize, &[f32; 4])| if node[2] > found.1 { (at, node[2]) } else { found };
        let (at, height) = self.nodes.iter().enumerate().fold((0, 0.0), higher);
        (self.place_m(at), height.into())
    }

    fn place_m(&self, node: usize) -> DVec2 {
        let (column, row) = (node as u32 % self.columns, node as u32 / self.columns);
        DVec2::new(f64::from(column), f64::from(row))
            / DVec2::new(f64::from(self.columns - 1), f64::from(self.rows - 1))
            * self.sides_m
    }

    /// A texel for each node.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub(in super::super) fn texture(&self, context: Context<'_>) -> Result<Arc<ImageView>, Error> {
        let desc = ImageDesc::new_2d(context.name("bed"), FLOATS, self.columns, self.rows);
        let view = Image::new(context.device(), desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
        let bytes: &[u8] = bytemuck::cast_slice(&self.nodes);
        upload_rows(context.device(), &view, (self.columns, self.rows), |first_row, rows| {
            let first = first_row as usize * 16 * self.columns as usize;
            rows.copy_from_slice(&bytes[first..first + rows.len()]);
        })?;
        Ok(view)
    }

    /// The ground as it is drawn in a space, closed at its sides down to the floor.
    pub fn mesh(&self, space_m: Vec3) -> Mesh {
        let (columns, rows) = if self.is_level { (FLOOR_NODES, FLOOR_NODES) } else { (self.columns, self.rows) };
        let share = |node: u32| {
            DVec2::new(f64::from(node % columns), f64::from(node / columns))
                / DVec2::new(f64::from(columns - 1), f64::from(rows - 1))
        };
        let ground = |node: u32| self.at(share(node) * self.sides_m).as_vec3();
        let top = |node: u32| {
            let place_m = share(node).as_vec2() * Vec2::new(space_m.x, space_m.z);
            Vec3::new(place_m.x, ground(node).z, place_m.y)
        };
        let normal = |node: u32| {
            let Vec3 { x: along_x, y: along_z, .. } = ground(node);
            Vec3::new(-along_x, 1.0, -along_z).normalize()
        };
        let mut positions: Vec<Vec3> = (0..columns * rows).map(top).collect();
        let mut normals: Vec<Vec3> = (0..columns * rows).map(normal).collect();
        let mut indices = Vec::new();
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let first = row * columns + column;
                let [a, b, c, d] = [first, first + 1, first + columns, first + columns + 1];
                indices.extend([a, c, b, b, c, d]);
            }
        }
        let north: Vec<u32> = (0..columns).rev().collect();
        let south: Vec<u32> = (0..columns).map(|column| (rows - 1) * columns + column).collect();
        let west: Vec<u32> = (0..rows).map(|row| row * columns).collect();
        let east: Vec<u32> = (0..rows).rev().map(|row| row * columns + columns - 1).collect();
        for (side, outwards) in [(north, Vec3::NEG_Z), (south, Vec3::Z), (west, Vec3::NEG_X), (east, Vec3::X)] {
            let first = positions.len() as u32;
            for &node in &side {
                let upper = positions[node as usize];
                positions.extend([upper, upper.with_y(0.0)]);
                normals.extend([outwards; 2]);
            }
            for at in 0..side.len() as u32 - 1 {
                let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + 2 * at + corner);
                indices.extend([a, b, c, c, b, d]);
            }
        }
        Mesh { name: "bed".to_owned(), positions, normals, texture_coordinates: Vec::new(), indices, ..Mesh::default() }
    }
}

/// The map's height between its samples, metres; the border's beyond it.
fn sample(map: &HeightMap, place: DVec2) -> f64 {
    let last = DVec2::new(f64::from(map.width() - 1), f64::from(map.height() - 1));
    let place = place.clamp(DVec2::ZERO, last);
    let base = place.floor();
    let fraction = place - base;
    let height = |x: u32, y: u32| f64::from(map.height_m(base.x as u32 + x, base.y as u32 + y));
    let north = height(0, 0) * (1.0 - fraction.x) + height(1, 0) * fraction.x;
    let south = height(0, 1) * (1.0 - fraction.x) + height(1, 1) * fraction.x;
    north * (1.0 - fraction.y) + south * fraction.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Samples;

    /// A ramp of 9 x 5 samples, 10 m x 20 m apart, that rises by 1 m a column and falls by 3 m a row.
    fn ramp() -> HeightMap {
        let heights = (0..45).map(|at| 100.0 + (at % 9) as f32 - 3.0 * (at / 9) as f32).collect();
        HeightMap::new(9, 5, Samples::Float(heights)).unwrap().with_spacing_m(DVec2::new(10.0, 20.0)).unwrap()
    }

    #[test]
    fn a_map_covers_the_space_in_its_own_proportions() {
        // The map is 80 m x 80 m: 8 m x 6 m of it at a tenth, with a tenth left out at the north and at the south.
        let bed = Bed::of(&ramp(), Vec3::new(8.0, 2.0, 6.0), 0.5);
        assert_eq!((bed.columns, bed.rows, bed.is_level()), (17, 13, false));
        for (x, z) in [(1.3, 2.2), (4.0, 3.0), (7.1, 4.9)] {
            let found = bed.at(DVec2::new(x, z));
            // Beyond the borders the map has its border's heights, so that the outermost nodes are a little off.
            let expected = DVec3::new(0.1, -0.15, 0.1 * x + 0.15 * (6.0 - z));
            assert!((found - expected).abs().max_element() < 0.01, "{x} {z}: {found} {expected}");
        }
        let (place, height) = bed.highest();
        assert!((place - DVec2::new(8.0, 0.0)).length() < 1e-6 && (height - 1.7).abs() < 0.03, "{place} {height}");
        let lowest = bed.nodes.iter().map(|node| node[2]).fold(f32::MAX, f32::min);
        assert_eq!(lowest, 0.0);
    }

    #[test]
    fn a_node_of_a_finer_map_is_the_mean_of_its_square() {
        // Stripes of a sample each along x: their mean is half.
        let heights = (0..65 * 65).map(|at| f32::from(u8::from(at % 65 % 2 == 1))).collect();
        let map = HeightMap::new(65, 65, Samples::Float(heights)).unwrap();
        let bed = Bed::of(&map, Vec3::new(64.0, 10.0, 64.0), 8.0);
        let heights = bed.nodes.iter().map(|node| node[2]);
        let (low, high) = heights.fold((f32::MAX, 0.0f32), |(low, high), h| (low.min(h), high.max(h)));
        assert!(high - low < 0.3, "{low} {high}");
    }

    #[test]
    fn what_is_drawn_is_closed_and_faces_outwards() {
        assert!(Bed::level().at(DVec2::new(0.3, 0.4)) == DVec3::ZERO);
        let space = Vec3::new(8.0, 2.0, 8.0);
        let floor = Bed::level().mesh(space).bounds();
        assert_eq!((floor.min, floor.max), (Vec3::ZERO, Vec3::new(8.0, 0.0, 8.0)));
        let mesh = Bed::of(&ramp(), space, 1.0).mesh(space);
        assert_eq!(mesh.triangle_count(), 2 * 64 + 4 * 16);
        for triangle in mesh.indices.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|corner| mesh.positions[triangle[corner] as usize]);
            let face = (b - a).cross(c - a);
            let normal: Vec3 = triangle.iter().map(|&corner| mesh.normals[corner as usize]).sum();
            assert!(face.dot(normal) >= 0.0, "{a} {b} {c}");
        }
    }
}
