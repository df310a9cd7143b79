//! The cameras of the figures, and those that are given.

use std::ffi::OsStr;

use glam::Vec3;
use serde_json::Value as Json;

use super::parameters::Parameters;
use crate::measure::config;
use crate::measure::parameter::{EyeAndTarget, Field, Shape, Value, one};
use crate::scene::Camera;

/// Our cameras for the four views of chapter 8; the thesis prints no positions.
pub const CAMERAS: [(&str, Camera); 4] = [
    ("fig-8.1", camera(Vec3::new(-0.7, 3.1, 2.4), Vec3::new(1.65, 0.05, 0.5))),
    ("fig-8.2", camera(Vec3::new(2.0, 3.9, 2.2), Vec3::new(2.0, 0.2, 0.6))),
    ("fig-8.3", camera(Vec3::new(5.0, 2.2, 0.5), Vec3::new(3.0, 0.1, 0.5))),
    ("fig-8.4", camera(Vec3::new(1.4, 1.9, 1.2), Vec3::new(1.9, 0.3, 0.5))),
];

const fn camera(eye: Vec3, target: Vec3) -> Camera {
    Camera { eye, target, up: Vec3::Y, vertical_fov_rad: 0.75, near_m: 0.05, far_m: 20.0 }
}

/// A camera by the name of its figure, or by eye and target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View(Camera);

impl Value for View {
    const SHAPE: Shape = Shape { placeholder: "FIGURE|EYE,TARGET", ..EyeAndTarget::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        if let Some((_, camera)) = CAMERAS.iter().find(|(name, _)| *name == text) {
            return Ok(View(*camera));
        }
        let figures = CAMERAS.map(|(name, _)| name).join(", ");
        let place = EyeAndTarget::parse(texts).map_err(|e| format!("{figures}, or eye and target: {e}"))?;
        Ok(View(Camera { eye: place.eye, target: place.target, ..CAMERAS[0].1 }))
    }

    fn text(&self) -> String {
        let Camera { eye, target, .. } = self.0;
        let figure = CAMERAS.iter().find(|(_, camera)| *camera == self.0);
        figure.map_or_else(|| EyeAndTarget { eye, target }.text(), |(name, _)| (*name).to_owned())
    }

    fn json(&self) -> Json {
        config::camera(&self.0)
    }
}

/// The viewer.
pub(super) const FIELD: Field<Parameters, View> = Field { get: |p| View(p.camera), set: |p, view| p.camera = view.0 };
