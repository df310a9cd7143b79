//! The layout of the window, remembered from one time to the next in the user's state folder.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::file;

/// A file that is larger holds something else.
const MOST_BYTES: u64 = 1 << 16;

/// The layout that is remembered from window to window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// Width and height of the window in points of the display.
    pub window_size: (f32, f32),
    /// Light or dark colours.
    pub theme: Theme,
    /// The panel of passes is open.
    pub has_passes: bool,
    /// The panel of parameters is open.
    pub has_parameters: bool,
    /// The drawer below the picture is open.
    pub has_drawer: bool,
    /// Widths of the panels at the sides and height of the drawer, points.
    pub passes_width: f32,
    /// Width of the panel of parameters, points.
    pub parameters_width: f32,
    /// Height of the drawer, points.
    pub drawer_height: f32,
    /// Tab of the drawer that is in front.
    pub tab: Tab,
    /// Way to show two sides.
    pub comparison: Comparison,
    /// Samples that medians of times are taken of.
    pub samples: u32,
}

/// Colours of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// As the display says.
    System,
    Light,
    Dark,
}

/// Tab of the drawer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tab {
    Times,
    Memory,
    Device,
    Messages,
    Keep,
    Bench,
}

/// Way to show two sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Comparison {
    /// One left of the other.
    Beside,
    /// One over the other, up to a divider.
    Divider,
    /// Their difference in CIE L*u*v*.
    Difference,
}

impl Default for Layout {
    fn default() -> Self {
        Layout {
            window_size: (1280.0, 800.0),
            theme: Theme::System,
            has_passes: true,
            has_parameters: true,
            has_drawer: true,
            passes_width: 400.0,
            parameters_width: 270.0,
            drawer_height: 150.0,
            tab: Tab::Times,
            comparison: Comparison::Beside,
            samples: 9,
        }
    }
}

impl Layout {
    /// The remembered layout, or the default where there is none, or none that makes sense.
    pub fn load() -> Self {
        let text = path().and_then(|path| file::read_text(&path, MOST_BYTES).ok());
        text.map(|text| Self::parsed(&text)).unwrap_or_default()
    }

    /// The layout that the text has, within its bounds, or the default.
    pub fn parsed(text: &str) -> Self {
        serde_json::from_str::<Layout>(text).unwrap_or_default().bounded()
    }

    /// Sizes that a window can have, whatever the file says.
    fn bounded(self) -> Self {
        let default = Layout::default();
        let bound = |size: f32, default: f32, low, high| if size.is_finite() { size.clamp(low, high) } else { default };
        Layout {
            window_size: (
                bound(self.window_size.0, default.window_size.0, 320.0, 16_384.0),
                bound(self.window_size.1, default.window_size.1, 240.0, 16_384.0),
            ),
            passes_width: bound(self.passes_width, default.passes_width, 160.0, 2_000.0),
            parameters_width: bound(self.parameters_width, default.parameters_width, 160.0, 2_000.0),
            drawer_height: bound(self.drawer_height, default.drawer_height, 60.0, 2_000.0),
            samples: self.samples.clamp(1, 100),
            ..self
        }
    }

    /// Remembers it. A folder that cannot be written costs the memory, and nothing else.
    pub fn save(&self) {
        let Some(path) = path() else { return };
        if let (Some(folder), Ok(text)) = (path.parent(), serde_json::to_vec_pretty(self)) {
            let _ = std::fs::create_dir_all(folder).map(|()| file::write(&path, &text));
        }
    }
}

/// The file of the layout, in the folder where the system keeps such state.
fn path() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || folder("HOME");
    let state = if cfg!(target_os = "windows") {
        folder("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home().map(|home| home.join("Library/Application Support"))
    } else {
        folder("XDG_STATE_HOME").or_else(|| home().map(|home| home.join(".local/state")))
    };
    Some(state?.join("fumarole").join("window.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_comes_back_as_it_was() {
        let layout = Layout { tab: Tab::Bench, passes_width: 333.0, ..Layout::default() };
        let text = serde_json::to_string(&layout).expect("JSON");
        assert_eq!(Layout::parsed(&text), layout);
    }

    #[test]
    fn a_damaged_file_gives_the_default() {
        for text in ["", "{", "[]", "\u{0}\u{1}", r#"{"tab": "Nowhere"}"#, r#"{"passes_width": "wide"}"#] {
            assert_eq!(Layout::parsed(text), Layout::default(), "{text:?}");
        }
    }

    #[test]
    fn sizes_that_no_window_has_are_bounded() {
        let layout = Layout::parsed(r#"{"window_size": [1e30, -5], "samples": 4000000000, "drawer_height": 0}"#);
        assert_eq!(layout.window_size, (16_384.0, 240.0));
        assert_eq!((layout.samples, layout.drawer_height), (100, 60.0));
    }
}
