//! The camera that no one named.

use glam::Vec3;

use super::model::Model;
use super::parameters::Parameters;
use crate::scene::{Bounds, Camera};

/// Fraction of the picture's height that the object fills (preset `3.8`), and at most of its width.
const FILLED: f32 = 0.8;
/// From the object to the eye.
const TO_EYE: Vec3 = Vec3::new(0.45, 0.3, 1.0);

/// A camera with the opening angle and the planes that suit an object of diagonal 1.
pub fn seen_from(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, vertical_fov_rad: 0.6, near_m: 0.01, far_m: 100.0 }
}

/// The camera of the picture: the user's, or one that frames it.
pub fn camera(parameters: &Parameters, model: &Model) -> Camera {
    parameters.camera.unwrap_or_else(|| framing(&model.lattice.positions, &model.bounds, parameters.aspect()))
}

/// A camera from in front and above at the distance from which `positions`, of a diagonal of 1 and with those `bounds`,
/// fill the picture.
fn framing(positions: &[Vec3], bounds: &Bounds, aspect: f32) -> Camera {
    let target = bounds.center();
    let at = |distance: f32| seen_from(target + TO_EYE.normalize() * distance, target);
    let fits = |distance: f32| {
        let camera = at(distance);
        let projection = camera.projection(aspect) * camera.view();
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &position in positions {
            let seen = projection.project_point3(position);
            (low, high) = (low.min(seen), high.max(seen));
        }
        // From -1 to 1.
        let extent = (high - low) / 2.0;
        extent.x <= FILLED && extent.y <= FILLED
    };
    // From 1 on, all of it is in front of the eye.
    let (mut near, mut far) = (1.0, 64.0);
    for _ in 0..24 {
        let middle = 0.5 * (near + far);
        if fits(middle) { far = middle } else { near = middle }
    }
    at(far)
}
