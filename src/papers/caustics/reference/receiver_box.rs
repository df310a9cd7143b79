//! The receiver's box, aligned with the light (section 4.2.1).

use crate::papers::caustics::reference::{Medium, ReferenceLight};
use glam::{DVec2, DVec3};

/// The fraction of the diagonal by which the height exceeds the tight box, half of it on either side.
const HEIGHT_PADDING: f64 = 1e-3;
/// Rounding of a single-precision height, relative to the coordinates that it is computed from.
const HEIGHT_ROUNDING: f64 = 1e-6;

/// A box around a receiver whose y axis points against the refracted light; lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverBox {
    /// P0, the centre of the tight box, in the world.
    pub center: DVec3,
    /// Unit axis of width and of map columns.
    pub u: DVec3,
    /// Unit axis of height, V = -T.
    pub v: DVec3,
    /// Unit axis of depth and of map rows, W = U x V.
    pub w: DVec3,
    /// Extent along U of the tight box.
    pub width: f64,
    /// Extent along V of the tight box plus 1e-3 of its diagonal, so that a flat receiver facing the light has a height
    /// and no surface lies on the near or far plane.
    pub height: f64,
    /// Extent along W of the tight box.
    pub depth: f64,
}

/// Aligns the box of a receiver with `light` refracted at flat water (V = -T, eq. 4-1 to 4-3). A point light is aimed
/// at `world_box_center`. The thesis takes a random N: here N is +Z, or +X where |V·Z| > 0.99; U = normalize(N x V), W
/// = U x V.
///
/// `positions` are the receiver's vertices in the world. `None` without positions or with a light that does not come
/// from above.
pub fn align_box(
    light: ReferenceLight,
    positions: &[DVec3],
    world_box_center: DVec3,
    medium: Medium,
) -> Option<ReceiverBox> {
    let v = -light.refracted_at_flat_water(world_box_center, medium)?;
    let fixed = if v.dot(DVec3::Z).abs() > 0.99 { DVec3::X } else { DVec3::Z };
    let u = fixed.cross(v).normalize();
    let w = u.cross(v);
    let local = |p: &DVec3| DVec3::new(p.dot(u), p.dot(v), p.dot(w));
    let low = positions.iter().map(local).reduce(DVec3::min)?;
    let high = positions.iter().map(local).reduce(DVec3::max)?;
    let middle = (low + high) / 2.0;
    let tight = high - low;
    Some(ReceiverBox {
        center: u * middle.x + v * middle.y + w * middle.z,
        u,
        v,
        w,
        width: tight.x,
        height: tight.y + HEIGHT_PADDING * tight.length(),
        depth: tight.z,
    })
}

impl ReceiverBox {
    /// A point of the world in box space.
    pub fn to_box(&self, point: DVec3) -> DVec3 {
        self.direction_to_box(point - self.center)
    }

    /// A direction of the world in box space.
    pub fn direction_to_box(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.u), direction.dot(self.v), direction.dot(self.w))
    }

    /// A point of box space in the world.
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        self.center + self.u * point.x + self.v * point.y + self.w * point.z
    }

    /// A point of box space in texels of a map with `resolution` texels a side: (column, row), 0 at the first texel's
    /// outer edge. Not finite where the box has no width or depth.
    pub fn to_texels(&self, point: DVec3, resolution: usize) -> DVec2 {
        let fraction = DVec2::new(point.x / self.width, point.z / self.depth);
        (fraction + 0.5) * resolution as f64
    }

    /// Area of one texel of a map with `texels` texels in all, in m².
    pub fn texel_area_m2(&self, texels: usize) -> f64 {
        self.width * self.depth / texels as f64
    }

    /// Error bound of a height computed in single precision, metres.
    pub fn height_tolerance_m(&self) -> f64 {
        let size = DVec3::new(self.width, self.height, self.depth).length();
        HEIGHT_ROUNDING * (size + self.center.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{WATER, box_corners};

    fn check(light: ReferenceLight) -> ReceiverBox {
        let corners = box_corners(DVec3::new(1.0, -3.0, -2.0), DVec3::new(3.0, -2.0, 1.0));
        let aligned = align_box(light, &corners, DVec3::new(2.0, -2.5, -0.5), WATER).unwrap();
        assert!((aligned.u.cross(aligned.v) - aligned.w).length() < 1e-14);
        assert!((aligned.u.length() - 1.0).abs() < 1e-14);
        assert!(aligned.u.dot(aligned.v).abs() < 1e-14);
        let half = DVec3::new(aligned.width, aligned.height, aligned.depth) / 2.0;
        let local: Vec<DVec3> = corners.iter().map(|&p| aligned.to_box(p)).collect();
        let high = local.iter().copied().reduce(DVec3::max).unwrap();
        let low = local.iter().copied().reduce(DVec3::min).unwrap();
        assert!((high + low).length() < 1e-12);
        assert!((high.x - half.x).abs() < 1e-12 && (high.z - half.z).abs() < 1e-12);
        let padding = 1e-3 * (high - low).length();
        assert!((aligned.height - (high.y - low.y) - padding).abs() < 1e-12);
        let point = DVec3::new(0.1, 0.2, 0.3);
        assert!((aligned.to_world(aligned.to_box(point)) - point).length() < 1e-12);
        aligned
    }

    #[test]
    fn the_box_is_tight_and_its_height_axis_opposes_the_refracted_light() {
        let overhead = check(ReferenceLight::Parallel { direction: -DVec3::Y });
        assert!((overhead.v - DVec3::Y).length() < 1e-14);
        let oblique = check(ReferenceLight::Parallel { direction: DVec3::new(0.6, -0.8, 0.0) });
        assert!((oblique.v.x + 0.6 * 0.75).abs() < 1e-14);
    }

    #[test]
    fn a_point_light_is_aimed_at_the_centre_of_the_world_box() {
        let target = DVec3::new(2.0, -2.5, -0.5);
        let direction = DVec3::new(0.5, -0.7, 0.1).normalize();
        let point = check(ReferenceLight::Point { position: target - direction * 7.0 });
        let parallel = check(ReferenceLight::Parallel { direction });
        assert!((point.v - parallel.v).length() < 1e-14);
    }

    #[test]
    fn a_flat_receiver_facing_the_light_has_a_height() {
        let light = ReferenceLight::Parallel { direction: -DVec3::Y };
        let corners = box_corners(DVec3::new(-1.0, -2.0, -1.0), DVec3::new(1.0, -2.0, 1.0));
        let aligned = align_box(light, &corners, DVec3::ZERO, WATER).unwrap();
        assert!((aligned.height - 1e-3 * 8.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn nothing_is_aligned_without_vertices_or_with_light_from_below() {
        let up = ReferenceLight::Parallel { direction: DVec3::Y };
        assert_eq!(align_box(up, &[DVec3::ZERO], DVec3::ZERO, WATER), None);
        let down = ReferenceLight::Parallel { direction: -DVec3::Y };
        assert_eq!(align_box(down, &[], DVec3::ZERO, WATER), None);
    }
}
