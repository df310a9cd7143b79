//! The way to the lists of fragments.

use std::ffi::OsStr;

use crate::measure::parameter::{Shape, Value, one};

/// Most fragments of a pixel in a k-buffer: each new one goes past them, one after the other.
const MOST_NEAREST: u32 = 32;

/// The way to the lists of fragments (section "Combining A-buffer and volume rendering techniques").
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Lists {
    /// The rasteriser draws boxes around the triangles; fragments are linked as they come.
    Linked,
    /// Triangles are put into tiles, whose pixels go through them.
    Tiles,
    /// As by tiles, but of each pixel only so many of the nearest fragments are kept, 1 to 32: a k-buffer.
    Nearest(u32),
}

impl Lists {
    /// Fragments that are kept of a pixel, where not all are.
    pub fn nearest(self) -> Option<u32> {
        match self {
            Lists::Nearest(count) => Some(count),
            Lists::Linked | Lists::Tiles => None,
        }
    }
}

/// `linked`, `tiles`, `k:8`.
impl Value for Lists {
    const SHAPE: Shape = Shape { joins: true, ..Shape::single("linked|tiles|k:N") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        match (text, text.strip_prefix("k:")) {
            ("linked", _) => Ok(Lists::Linked),
            ("tiles", _) => Ok(Lists::Tiles),
            (_, Some(count)) => match count.parse() {
                Ok(count) if (1..=MOST_NEAREST).contains(&count) => Ok(Lists::Nearest(count)),
                _ => Err(format!("{count:?} is no number of fragments; give k:1 to k:{MOST_NEAREST}")),
            },
            _ => Err(format!("{text:?} is none of linked, tiles, k:N")),
        }
    }

    fn text(&self) -> String {
        match self {
            Lists::Linked => "linked".to_owned(),
            Lists::Tiles => "tiles".to_owned(),
            Lists::Nearest(count) => format!("k:{count}"),
        }
    }
}
