//! The way of a ray through the gas.

use std::ffi::OsStr;

use crate::measure::parameter::{Shape, Value, one};

/// The estimate of the light of a ray through the gas (section "Volume rendering").
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum March {
    /// The paper's: increments of a step.
    Steps,
    /// Ways to real particles among fictitious ones, and of shadows the fraction that is fictitious: without bias.
    Delta,
}

/// `steps`, `delta`.
impl Value for March {
    const SHAPE: Shape = Shape { joins: true, ..Shape::single("steps|delta") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match one(texts)? {
            "steps" => Ok(March::Steps),
            "delta" => Ok(March::Delta),
            text => Err(format!("{text:?} is none of steps, delta")),
        }
    }

    fn text(&self) -> String {
        match self {
            March::Steps => "steps".to_owned(),
            March::Delta => "delta".to_owned(),
        }
    }
}
