use crate::scene::Error;
use glam::camera::rh;
use glam::{Mat4, Vec3};

/// A pinhole camera in a right-handed world with +Y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position, metres.
    pub eye: Vec3,
    /// The point that appears in the middle of the picture, metres.
    pub target: Vec3,
    /// The direction that points up in the picture; it need not be perpendicular to the view.
    pub up: Vec3,
    /// Opening angle from the bottom to the top edge of the picture, in (0, pi).
    pub vertical_fov_rad: f32,
    /// Distance of the near plane, positive.
    pub near_m: f32,
    /// Distance of the far plane, greater than `near_m`.
    pub far_m: f32,
}

impl Camera {
    /// World to view: the camera at the origin, looking along -Z, +Y up.
    ///
    /// -Z or else +Y stands in for an `up` parallel to the view, as when looking straight down.
    pub fn view(&self) -> Mat4 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let up = [self.up.normalize_or_zero(), Vec3::NEG_Z, Vec3::Y]
            .into_iter()
            .find(|up| forward.cross(*up).length_squared() > 1e-8)
            .unwrap_or(Vec3::Y);
        rh::view::look_to_mat4(self.eye, forward, up)
    }

    /// View to Vulkan clip space: +Y down, depth 0 at the near plane and 1 at the far plane.
    ///
    /// `aspect` is width over height, positive.
    pub fn projection(&self, aspect: f32) -> Mat4 {
        rh::proj::vulkan::perspective(self.vertical_fov_rad, aspect, self.near_m, self.far_m)
    }

    /// Checks the ranges given at the fields.
    ///
    /// # Errors
    /// [`Error::Camera`] names the first value outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        let fault = |reason: String| Err(Error::Camera { reason });
        if !(self.eye.is_finite() && self.target.is_finite() && self.up.is_finite()) {
            return fault("eye, target and up must be finite numbers".to_owned());
        }
        if (self.target - self.eye).normalize_or_zero() == Vec3::ZERO {
            return fault(format!("eye and target are both {}; move one of them", self.eye));
        }
        if !(self.vertical_fov_rad > 0.0 && self.vertical_fov_rad < std::f32::consts::PI) {
            let fov_deg = self.vertical_fov_rad.to_degrees();
            return fault(format!("the vertical field of view is {fov_deg} degrees; it must lie between 0 and 180"));
        }
        if !(self.near_m > 0.0 && self.far_m > self.near_m && self.far_m.is_finite()) {
            return fault(format!(
                "near is {} m and far {} m; they must satisfy 0 < near < far",
                self.near_m, self.far_m
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_rad: std::f32::consts::FRAC_PI_2,
            near_m: 1.0,
            far_m: 101.0,
        }
    }

    #[test]
    fn clip_space_is_that_of_vulkan() {
        let clip = |point: Vec3| (camera().projection(2.0) * camera().view()).project_point3(point);
        // At a field of view of 90 degrees the half height equals the distance, and the half width
        // twice that.
        assert!(clip(Vec3::new(0.0, 5.0, 0.0)).abs_diff_eq(clip(Vec3::Y * 5.0), 1e-6));
        assert!((clip(Vec3::new(0.0, 5.0, 0.0)).y + 1.0).abs() < 1e-6);
        assert!((clip(Vec3::new(10.0, 0.0, 0.0)).x - 1.0).abs() < 1e-6);
        assert!(clip(Vec3::new(0.0, 0.0, 4.0)).z.abs() < 1e-6);
        assert!((clip(Vec3::new(0.0, 0.0, -96.0)).z - 1.0).abs() < 1e-6);
    }

    #[test]
    fn looking_along_up_gives_a_usable_view() {
        let down = Camera { eye: Vec3::Y * 3.0, ..camera() };
        let view = down.view();
        assert!(view.is_finite());
        assert!((view.transform_point3(Vec3::ZERO) - Vec3::new(0.0, 0.0, -3.0)).length() < 1e-6);
        assert!((view.transform_vector3(Vec3::NEG_Z) - Vec3::Y).length() < 1e-6);
    }

    #[test]
    fn values_out_of_range_are_named() {
        assert!(camera().validate().is_ok());
        let cases = [
            (Camera { target: camera().eye, ..camera() }, "target"),
            (Camera { eye: Vec3::NAN, ..camera() }, "finite"),
            (Camera { vertical_fov_rad: 0.0, ..camera() }, "field of view"),
            (Camera { vertical_fov_rad: f32::NAN, ..camera() }, "field of view"),
            (Camera { near_m: 0.0, ..camera() }, "near"),
            (Camera { far_m: 0.5, ..camera() }, "far"),
        ];
        for (camera, word) in cases {
            let message = camera.validate().expect_err(word).to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
