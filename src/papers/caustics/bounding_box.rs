//! Pass `bounding-box` (section 4.2.1): each receiver's box, aligned with the light. The planes of smart slicing wait
//! for the depth profile; the other variants slice in the same pass, under its name there.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::receiver::LitReceiver;
use crate::gpu::{Frame, PassInfo};
use crate::scene::Light;

/// The fraction of its diagonal by which a box is higher than its receiver, half of it on either side, so that a flat
/// receiver that faces the light has a height and no surface lies on the near or far plane.
const HEIGHT_PADDING: f64 = 1e-3;
/// A receiver seen edge-on has no width or depth; its map then covers this fraction of the diagonal.
const LEAST_EXTENT: f64 = 1e-3;

/// The pass.
pub struct BoundingBox {
    info: Arc<PassInfo>,
}

impl BoundingBox {
    pub fn new() -> Self {
        BoundingBox { info: PassInfo::host("bounding-box", "4.2.1", &["receiver"], &["planes"]) }
    }

    /// Aligns every box anew.
    pub fn record(&self, frame: &mut Frame<'_>, receivers: &mut [LitReceiver]) {
        frame.host(&self.info, || receivers.iter_mut().for_each(LitReceiver::align));
    }
}
/// The axes that all boxes of one light share: V = -T, against the light refracted at flat water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    /// Unit axis along the maps' columns.
    pub u: DVec3,
    /// Unit axis against the refracted light.
    pub v: DVec3,
    /// Unit axis along the maps' rows.
    pub w: DVec3,
}

impl Axes {
    /// Aligns with `light`; a point light aims at the centre of the world's box (figures 4-5 and 4-7). The thesis takes
    /// a random N for eq. 4-1; it is fixed here, so that runs repeat: U = normalize(N x V), W = U x V.
    pub fn aligned_with(light: &Light, world_center: DVec3, refraction_index: f64) -> Self {
        let incident = match *light {
            Light::Parallel { direction, .. } => direction.as_dvec3().normalize(),
            Light::Point { position, .. } => (world_center - position.as_dvec3()).normalize(),
        };
        // Eq. 2-8 at N = +Y.
        let eta = 1.0 / refraction_index;
        let cos_incident = -incident.y;
        let cos_refracted = (1.0 - eta * eta * (1.0 - cos_incident * cos_incident)).sqrt();
        let refracted = (incident * eta + DVec3::Y * (eta * cos_incident - cos_refracted)).normalize();
        let v = -refracted;
        let n = if v.z.abs() > 0.99 { DVec3::X } else { DVec3::Z };
        let u = n.cross(v).normalize();
        Axes { u, v, w: u.cross(v) }
    }

    /// Coordinates of a point or direction along the axes.
    pub fn along(&self, p: DVec3) -> DVec3 {
        DVec3::new(p.dot(self.u), p.dot(self.v), p.dot(self.w))
    }

    /// The point or direction with these coordinates.
    pub fn world(&self, p: DVec3) -> DVec3 {
        self.u * p.x + self.v * p.y + self.w * p.z
    }
}

/// A receiver's box: its centre P0 along the axes, and its width along U, height along V and depth along W, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverBox {
    /// Shared with all boxes of the light.
    pub axes: Axes,
    /// P0 along the axes, metres.
    pub center: DVec3,
    /// Width along U, height along V, depth along W, metres.
    pub extent: DVec3,
}

impl ReceiverBox {
    /// The tight box of `positions` (eq. 4-2 and 4-3), padded.
    pub fn around(axes: Axes, positions: &[Vec3]) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in positions {
            let p = axes.along(p.as_dvec3());
            low = low.min(p);
            high = high.max(p);
        }
        let tight = high - low;
        let diagonal = tight.length();
        let least = (LEAST_EXTENT * diagonal).max(f64::MIN_POSITIVE);
        ReceiverBox {
            axes,
            center: (low + high) / 2.0,
            extent: DVec3::new(tight.x.max(least), tight.y + HEIGHT_PADDING * diagonal, tight.z.max(least)),
        }
    }

    /// The eight corners in the world.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
            self.axes.world(self.center + self.extent * DVec3::new(side(0), side(1), side(2)))
        })
    }
}
