//! The level of detail: a level, or the one that suits the camera's distance.

use std::ffi::OsStr;

use serde_json::{Value as Json, json};

use crate::measure::parameter::{Range, Shape, Value, one};

/// The finest level that is drawn: a number, or `auto`, by the camera's distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LevelOfDetail(pub Option<u32>);

impl Value for LevelOfDetail {
    const SHAPE: Shape = Shape { placeholder: "auto|N", ..u32::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        let level = text.parse().map(Some).map_err(|_| format!("{text:?} is neither auto nor a level"));
        Ok(LevelOfDetail(if text == "auto" { None } else { level? }))
    }

    fn text(&self) -> String {
        self.0.map_or_else(|| "auto".to_owned(), |level| level.to_string())
    }

    fn json(&self) -> Json {
        json!(self.0)
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.0.lies_in(range)
    }
}
