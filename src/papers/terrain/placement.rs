//! The geometric transformation (eq. 10 and 11): which way a ray of the picture takes through a map. The base surface alone
//! is transformed; heights never are.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::pyramid::Shape;
use crate::scene::{Camera, HeightMap, Samples};

/// The box around all maps in the world, metres; y counts from the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    pub low: DVec3,
    pub high: DVec3,
}

/// A map's place on the plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// East and south of the world's origin, metres.
    pub center_m: DVec2,
    /// About the vertical, counterclockwise seen from above.
    pub turn_rad: f64,
}

/// Rows of eq. 10 with the one that the print lost: u = x, v = z, h = y.
const T: DMat4 = DMat4::from_cols(DVec4::X, DVec4::Z, DVec4::Y, DVec4::W);

/// One map as the rays see it.
#[derive(Debug, Clone)]
pub struct Ground {
    pub shape: Shape,
    /// World to map: u and v in nodes from the first sample, h in the map's own numbers; G = T M.
    pub to_map: DMat4,
    /// Metres between columns and rows.
    pub spacing_m: DVec2,
    /// Metres for a unit of h.
    pub unit_m: f64,
    /// Lowest and highest h, and that of the base.
    pub lowest: f64,
    pub highest: f64,
    pub base: f64,
    pub turn_rad: f64,
}

impl Ground {
    /// `base_level_m` is the map's height at which the base lies.
    pub fn new(map: &HeightMap, placement: Placement, base_level_m: f64) -> Self {
        let (origin_m, unit_m) = match map.samples() {
            Samples::Steps { origin_m, step_m, .. } => (f64::from(*origin_m), f64::from(*step_m)),
            Samples::Float(_) => (0.0, 1.0),
        };
        let spacing_m = map.spacing_m();
        let shape = Shape::new(map.width(), map.height());
        let middle = DVec2::new(f64::from(shape.width - 1), f64::from(shape.height - 1)) / 2.0;
        let model = DMat4::from_translation(DVec3::new(middle.x, (base_level_m - origin_m) / unit_m, middle.y))
            * DMat4::from_scale(DVec3::new(1.0 / spacing_m.x, 1.0 / unit_m, 1.0 / spacing_m.y))
            * DMat4::from_rotation_y(-placement.turn_rad)
            * DMat4::from_translation(DVec3::new(-placement.center_m.x, 0.0, -placement.center_m.y));
        let (low_m, high_m) = map.range_m();
        let value = |height_m: f64| (height_m - origin_m) / unit_m;
        Ground {
            shape,
            to_map: T * model,
            spacing_m,
            unit_m,
            lowest: value(low_m.into()),
            highest: value(high_m.into()),
            base: value(base_level_m),
            turn_rad: placement.turn_rad,
        }
    }

    /// The box around the map in the world.
    pub fn extent(&self) -> Extent {
        let to_world = self.to_map.inverse();
        let last = DVec2::new(f64::from(self.shape.width - 1), f64::from(self.shape.height - 1));
        let corners = [0.0, last.x].into_iter().flat_map(|u| {
            let heights = [self.lowest, self.highest];
            [0.0, last.y].into_iter().flat_map(move |v| heights.map(|h| DVec3::new(u, v, h)))
        });
        let points = corners.map(|corner| to_world.project_point3(corner));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            low = low.min(point);
            high = high.max(point);
        }
        Extent { low: low.with_y(low.y.min(0.0)), high: high.with_y(high.y.max(0.0)) }
    }
}

/// The rays of a picture: pixel (x, y) looks from `eye` along `corner` + x `across` + y `down`, which is 1 m long along the
/// view's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rays {
    pub eye: DVec3,
    pub corner: DVec3,
    pub across: DVec3,
    pub down: DVec3,
}

impl Rays {
    /// Through the middles of the pixels of a picture of `width` x `height`.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        // In the frame of the camera's own view, which knows what to do where up is along the view.
        let to_world = camera.view().as_dmat4().inverse();
        let half_height = (f64::from(camera.vertical_fov_rad) / 2.0).tan();
        let pixel = 2.0 * half_height / f64::from(height);
        let left = -pixel * (f64::from(width) - 1.0) / 2.0;
        let top = pixel * (f64::from(height) - 1.0) / 2.0;
        let vector = |x, y, z| to_world.transform_vector3(DVec3::new(x, y, z));
        Rays {
            eye: camera.eye.as_dvec3(),
            corner: vector(left, top, -1.0),
            across: vector(pixel, 0.0, 0.0),
            down: vector(0.0, -pixel, 0.0),
        }
    }

    /// The same rays in a map's frame.
    pub fn in_map(&self, to_map: &DMat4) -> Self {
        let vector = |v: DVec3| (*to_map * v.extend(0.0)).truncate();
        let eye = *to_map * self.eye.extend(1.0);
        Rays {
            // Eq. 11: divided by a, which is 1 for maps on a plane.
            eye: eye.truncate() / eye.w,
            corner: vector(self.corner),
            across: vector(self.across),
            down: vector(self.down),
        }
    }

    /// Metres that a pixel covers at a depth of 1 m.
    pub fn pixel_m(&self) -> f64 {
        self.across.length().max(self.down.length())
    }
}
