//! Places of the window's controls, for those who drive it from outside.

use std::path::Path;

use egui::accesskit::TreeUpdate;
use serde::Serialize;

use super::error::Error;
use crate::file;

/// A control that has a label or a value.
#[derive(Serialize)]
struct Control<'a> {
    role: String,
    label: Option<&'a str>,
    value: Option<&'a str>,
    is_on: Option<bool>,
    /// It has the keyboard.
    is_focused: bool,
    /// Left, top, right and bottom in pixels of the window.
    rectangle_px: [f64; 4],
}

/// Writes them, whole or not at all.
///
/// # Errors
/// [`Error::Controls`].
pub fn write(path: &Path, update: &TreeUpdate, pixels_per_point: f32) -> Result<(), Error> {
    let scale = f64::from(pixels_per_point);
    let controls: Vec<Control<'_>> = update
        .nodes
        .iter()
        .filter_map(|(id, node)| {
            let bounds = node.bounds()?;
            let (label, value) = (node.label(), node.value());
            (label.is_some() || value.is_some()).then(|| Control {
                role: format!("{:?}", node.role()),
                label,
                value,
                is_on: node.toggled().map(|toggled| toggled == egui::accesskit::Toggled::True),
                is_focused: *id == update.focus,
                rectangle_px: [bounds.x0 * scale, bounds.y0 * scale, bounds.x1 * scale, bounds.y1 * scale],
            })
        })
        .collect();
    let failed = |reason: String| Error::Controls { path: path.display().to_string(), reason };
    let text = serde_json::to_vec(&controls).map_err(|error| failed(error.to_string()))?;
    file::write(path, &text).map_err(|error| failed(error.to_string()))
}
