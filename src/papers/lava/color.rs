//! A colour: the thesis's constant orange, or that of a black body.

use std::ffi::OsStr;

use glam::Vec3;
use serde_json::{Value as Json, json};

use super::parameters::Parameters;
use crate::measure::parameter::{Field, Range, Shape, Value, one};

/// Colour of the lava.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Color {
    /// Section 7.2's: RGB of the display.
    Constant(Vec3),
    /// By temperature (chapter 9).
    Blackbody,
}

/// Typed as one word for a black body, and for the default constant.
const BLACKBODY: &str = "blackbody";
const CONSTANT: &str = "constant";

impl Value for Color {
    const SHAPE: Shape = Shape { placeholder: "R,G,B|blackbody", ..Vec3::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match one(texts)? {
            BLACKBODY => Ok(Color::Blackbody),
            CONSTANT => Ok(Color::Constant(Parameters::default().color)),
            _ => Vec3::parse(texts).map(Color::Constant).map_err(|e| format!("{BLACKBODY}, {CONSTANT}, or R,G,B: {e}")),
        }
    }

    fn text(&self) -> String {
        match self {
            Color::Blackbody => BLACKBODY.to_owned(),
            Color::Constant(color) => color.text(),
        }
    }

    fn json(&self) -> Json {
        match self {
            Color::Blackbody => json!(BLACKBODY),
            Color::Constant(color) => color.json(),
        }
    }

    fn lies_in(&self, range: &Range) -> bool {
        match self {
            Color::Blackbody => true,
            Color::Constant(color) => color.lies_in(range),
        }
    }
}

/// Both of its parameters as one.
pub const FIELD: Field<Parameters, Color> = Field {
    get: |p| if p.is_blackbody { Color::Blackbody } else { Color::Constant(p.color) },
    set: |p, color| {
        p.is_blackbody = color == Color::Blackbody;
        if let Color::Constant(color) = color {
            p.color = color;
        }
    },
};
