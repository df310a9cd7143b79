//! Parameters outside their range, and the ranges that all papers share.

use glam::Vec3;

use crate::scene::Camera;

/// A parameter outside its range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{name} {value}: {range}")]
pub struct ParameterError {
    /// Its name, without the spelling of an option.
    pub name: &'static str,
    /// As it was typed.
    pub value: String,
    /// The range, as it follows the value in the message.
    pub range: String,
}

impl ParameterError {
    /// Passes when `is_good`.
    ///
    /// # Errors
    /// When it is not.
    pub fn check(is_good: bool, name: &'static str, value: impl ToString, range: &str) -> Result<(), Self> {
        if is_good {
            return Ok(());
        }
        Err(ParameterError { name, value: value.to_string(), range: range.to_owned() })
    }

    /// Passes for a picture of at least one pixel.
    ///
    /// # Errors
    /// Fails for a side of 0.
    pub fn check_size(width: u32, height: u32) -> Result<(), Self> {
        ParameterError::check(width >= 1 && height >= 1, "size", format!("{width}x{height}"), "has no pixel")
    }

    /// Passes for a camera that sees something.
    ///
    /// # Errors
    /// As [`Camera::validate`].
    pub fn check_camera(camera: &Camera) -> Result<(), Self> {
        let value = [camera.eye, camera.target].map(components).join(",");
        camera.validate().map_err(|e| ParameterError { name: "camera", value, range: e.to_string() })
    }
}

/// A vector as it is typed: `x,y,z`.
pub fn components(vector: Vec3) -> String {
    vector.to_array().map(|c| c.to_string()).join(",")
}
