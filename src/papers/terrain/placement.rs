//! The placement of maps over the base, and the rays of a picture.

use glam::{DMat4, DVec2, DVec3};

use crate::scene::Camera;

/// The box around all maps in the world, metres; y counts from the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// The lowest coordinates.
    pub low: DVec3,
    /// The highest coordinates.
    pub high: DVec3,
}

/// A map's place on the base.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// East and south of the world's origin, along the base, metres. A map that knows its longitude and latitude ignores it on
    /// an ellipsoid.
    pub center_m: DVec2,
    /// About the vertical, counterclockwise seen from above; on a plane alone.
    pub yaw_rad: f64,
}

/// The rays of a picture: pixel (x, y) looks from `eye` along `corner` + x `across` + y `down`, which is 1 m long along the
/// view's axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rays {
    /// The camera, metres.
    pub eye: DVec3,
    /// Direction to the middle of pixel (0, 0).
    pub corner: DVec3,
    /// Change of direction from a pixel to the next on the right.
    pub across: DVec3,
    /// Change of direction from a pixel to the next below.
    pub down: DVec3,
}

impl Extent {
    /// Around points.
    pub fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let start = Extent { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.fold(start, |all, point| Extent { low: all.low.min(point), high: all.high.max(point) })
    }

    pub fn union(self, other: Extent) -> Self {
        Extent { low: self.low.min(other.low), high: self.high.max(other.high) }
    }
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
