//! The option `voids`.

use std::ffi::OsStr;

use serde_json::{Value as Json, json};

use crate::measure::parameter::{Shape, Value, one, parse_finite};
use crate::scene::Voids;

impl Value for Voids {
    const SHAPE: Shape = Shape::single("fill|level:M|hole");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match one(texts)? {
            "fill" => Ok(Voids::Fill),
            "hole" => Ok(Voids::Hole),
            text => match text.split_once(':') {
                Some(("level", metres)) => parse_finite(metres).map(Voids::Level),
                _ => Err("give fill, level:M or hole".to_owned()),
            },
        }
    }

    fn text(&self) -> String {
        match self {
            Voids::Fill => "fill".to_owned(),
            Voids::Level(level_m) => format!("level:{level_m}"),
            Voids::Hole => "hole".to_owned(),
        }
    }

    fn json(&self) -> Json {
        match self {
            Voids::Fill | Voids::Hole => json!(self.text()),
            Voids::Level(level_m) => json!({"level": level_m}),
        }
    }
}
