//! Sections 5.3.3 and 5.3.4: inward contraction, in the vector form of the printed angles.

use glam::DVec3;

use super::Tick;

impl Tick<'_> {
    /// The displaced corner `moved` drawn on towards the point inward of its triangle, by `fraction` of the side B A.
    pub(super) fn contract(&self, moved: DVec3, [a, b, c]: [DVec3; 3], fraction: f64) -> DVec3 {
        let side = a.distance(b);
        // A, B, C run against the winding: C is the corner after B.
        let normal = (c - b).cross(a - b).normalize_or_zero() * self.model.outward;
        let inward = (a + b + c) / 3.0 - side * normal;
        let towards = inward - moved;
        moved + towards.normalize_or_zero() * (fraction * side).min(towards.length() / 2.0)
    }

    /// The position that a vertex with `left` of its flammability moved to, no farther from its position at rest, which
    /// sinks with it, than three quarters of the solid's volume over its surface.
    pub(super) fn charred(&self, vertex: usize, position: DVec3, left: u32) -> DVec3 {
        let sunk = f64::from(self.constants.flammability - left) * self.fall();
        let from = self.model.rest[vertex] - DVec3::Y * sunk;
        from + (position - from).clamp_length_max(self.model.char_depth)
    }
}

/// Area of the triangles.
pub fn area(positions: &[DVec3], triangles: impl IntoIterator<Item = [usize; 3]>) -> f64 {
    let of = |[a, b, c]: [usize; 3]| (positions[b] - positions[a]).cross(positions[c] - positions[a]).length() / 2.0;
    triangles.into_iter().map(of).sum()
}

/// Six times the enclosed volume is the sum of the triangles' triple products.
pub fn volume(positions: &[DVec3], triangles: impl IntoIterator<Item = [usize; 3]>) -> f64 {
    triangles.into_iter().map(|t| positions[t[0]].dot(positions[t[1]].cross(positions[t[2]]))).sum::<f64>() / 6.0
}
