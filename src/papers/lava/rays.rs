//! The ray of each pixel, for the passes that shade pixels.

use super::parameters::Parameters;
use crate::host_block;

host_block! {
    pub(super) struct RayConstants {
        drift_m: [f32; 2],
        mode: u32,
        near_m: f32,
        eye_m: [f32; 3],
        far_m: f32,
        first: [f32; 3],
        _pad: f32,
        across: [f32; 3],
        _pad_2: f32,
        down: [f32; 3],
    }
}

impl RayConstants {
    /// The same over a rock that has drifted `drift_m` along x.
    pub(super) fn drifted(self, drift_m: f32) -> Self {
        RayConstants { drift_m: [drift_m, 0.0], ..self }
    }
}

/// Directions whose length along the view is 1, so that a factor of one is a depth.
pub(super) fn rays(parameters: &Parameters) -> RayConstants {
    let camera = &parameters.camera;
    let view = camera.view();
    let [right, up, back] = [view.row(0), view.row(1), view.row(2)].map(|row| row.truncate());
    let half = (0.5 * camera.vertical_fov_rad).tan();
    let first = half * up - half * parameters.aspect() * right - back;
    let across = 2.0 * half * parameters.aspect() / parameters.width as f32 * right;
    let down = -2.0 * half / parameters.height as f32 * up;
    RayConstants {
        drift_m: [0.0; 2],
        mode: parameters.shading.mode(),
        near_m: camera.near_m,
        eye_m: camera.eye.to_array(),
        far_m: camera.far_m,
        first: first.to_array(),
        _pad: 0.0,
        across: across.to_array(),
        _pad_2: 0.0,
        down: down.to_array(),
    }
}
