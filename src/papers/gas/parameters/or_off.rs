//! A number, or nothing of it: `off`.

use std::ffi::OsStr;

use serde_json::{Value as Json, json};

use crate::measure::parameter::{Range, Shape, Value, one};

/// `off`, or a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrOff<T>(pub Option<T>);

macro_rules! or_off {
    ($($type:ty, $placeholder:literal);+) => { $(
        impl Value for OrOff<$type> {
            const SHAPE: Shape = Shape { joins: true, is_signed: true, ..Shape::single($placeholder) };

            fn parse(texts: &[&OsStr]) -> Result<Self, String> {
                match one(texts)? {
                    "off" => Ok(OrOff(None)),
                    _ => <$type>::parse(texts).map(Some).map(OrOff).map_err(|error| format!("{error}, or off")),
                }
            }

            fn text(&self) -> String {
                self.0.map_or_else(|| "off".to_owned(), |number| number.text())
            }

            fn json(&self) -> Json {
                self.0.map_or(Json::Null, |number| json!(number))
            }

            fn lies_in(&self, range: &Range) -> bool {
                self.0.is_none_or(|number| number.lies_in(range))
            }
        }
    )+ };
}

or_off!(u32, "off|N"; f32, "off|F");

impl<T: Copy> OrOff<T> {
    /// The first of several, as of one that is made without a choice.
    pub fn first(several: &[Self]) -> Option<T> {
        several.first().and_then(|one| one.0)
    }
}
