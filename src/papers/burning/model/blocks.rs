//! The blocks of 3.5.1: the object's box in a grid of smaller ones.

use glam::{UVec3, Vec3};

use crate::scene::Bounds;

/// A grid of blocks over the object at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Blocks along x, y and z.
    pub counts: [u32; 3],
    /// Its lowest corner.
    pub origin: Vec3,
    /// Sides of a block.
    pub cell_size: Vec3,
}

/// The box is enlarged by it, a fraction of the diagonal, so that no vertex at rest lies on its sides.
const MARGIN: f32 = 1e-4;

impl Grid {
    /// A grid over `bounds` of diagonal 1.
    pub fn new(bounds: &Bounds, counts: [u32; 3]) -> Self {
        let origin = bounds.min - Vec3::splat(MARGIN);
        let extent = bounds.max + Vec3::splat(MARGIN) - origin;
        Grid { counts, origin, cell_size: extent / UVec3::from(counts).as_vec3() }
    }

    /// Blocks in all.
    pub fn cell_count(&self) -> u32 {
        self.counts.iter().product()
    }

    /// The block of a position; the nearest one for a position outside.
    pub fn cell(&self, position: Vec3) -> u32 {
        let counts = UVec3::from(self.counts);
        let at = ((position - self.origin) / self.cell_size).floor();
        let at = at.clamp(Vec3::ZERO, (counts - 1).as_vec3()).as_uvec3();
        (at.z * counts.y + at.y) * counts.x + at.x
    }

    /// The middle of a block.
    pub fn midpoint(&self, cell: u32) -> Vec3 {
        let [columns, rows, _] = self.counts;
        let at = UVec3::new(cell % columns, cell / columns % rows, cell / (columns * rows));
        self.origin + (at.as_vec3() + 0.5) * self.cell_size
    }
}
