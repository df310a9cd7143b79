//! The one declaration of a parameter: name, unit, range, default, help, section, and what a change of it costs. The
//! command line's option, its help and messages, the check, the record's `config` and the page's table come from it. The
//! default is what the field has in the set-up's own default, where every one of them reads it.
//!
//! ```text
//! Parameter::new("absorption", field!(Parameters.absorption_per_m))
//!     .range(Range::from(0.0).to(1e6)).unit("per metre")
//!     .help("Absorption K of the water").section("eq. 4-17").cost(Cost::Constants)
//! ```

mod common;
mod error;
mod range;
mod value;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::PathBuf;

use serde_json::{Map, Value as Json};

pub use common::{crease_angle, size};
pub use error::{ParameterError, components};
pub use range::Range;
pub use value::{
    Choice, Extents, EyeAndTarget, Shape, Size, Value, one, parse_extents, parse_finite, parse_numbers, with_place,
};

/// Reads and writes a value of type `T` in a set-up `S`.
pub struct Field<S, T> {
    /// Copies the value out of the set-up.
    pub get: fn(&S) -> T,
    /// Puts a value into the set-up.
    pub set: fn(&mut S, T),
}

/// The [`Field`] of a path of fields from a type, as `field!(Parameters.smart.levels)`.
#[macro_export]
macro_rules! field {
    ($setup:ident . $($path:ident).+) => {
        $crate::measure::parameter::Field {
            get: |setup: &$setup| setup.$($path).+.clone(),
            set: |setup: &mut $setup, value| setup.$($path).+ = value,
        }
    };
}

/// Cost of a change of a parameter while a paper runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Constants and uniform blocks of the next frame.
    Constants,
    /// Buffers, images and all that names them are made anew.
    Buffers,
    /// Pipelines are built anew as well.
    Pipelines,
}

/// One parameter of the set-up `S`.
pub struct Parameter<S> {
    /// The paper's own term, kebab-case; the record's key has underscores in place of hyphens.
    pub name: &'static str,
    /// Heading that help lists it under.
    pub group: &'static str,
    /// One line, without range, unit and default.
    pub help: &'static str,
    /// Section or equation of the paper; empty for what is ours.
    pub section: &'static str,
    /// In words, as they follow a number: `metres`, `per metre`; empty for plain numbers.
    pub unit: &'static str,
    /// Of each number of the value.
    pub range: Range,
    /// Cost of a change.
    pub cost: Cost,
    /// The short help lists it.
    pub is_everyday: bool,
    /// Form of the value in help: `N`, `X,Y,Z`, `FILE`.
    pub placeholder: &'static str,
    /// Names that it must not be given with.
    pub excludes: &'static [&'static str],
    /// Name that it must be given with.
    pub requires: Option<&'static str>,
    default_text: Option<&'static str>,
    is_recorded: bool,
    access: Box<dyn Access<S>>,
}

impl<S: 'static> Parameter<S> {
    /// A parameter of any numbers, that costs constants.
    pub fn new<T: Value>(name: &'static str, field: Field<S, T>) -> Self {
        Parameter {
            name,
            group: "Scene",
            help: "",
            section: "",
            unit: "",
            range: Range::ANY,
            cost: Cost::Constants,
            is_everyday: false,
            placeholder: T::SHAPE.placeholder,
            excludes: &[],
            requires: None,
            default_text: None,
            is_recorded: true,
            access: Box::new(field),
        }
    }

    pub fn help(self, help: &'static str) -> Self {
        Parameter { help, ..self }
    }

    pub fn section(self, section: &'static str) -> Self {
        Parameter { section, ..self }
    }

    pub fn group(self, group: &'static str) -> Self {
        Parameter { group, ..self }
    }

    pub fn range(self, range: Range) -> Self {
        Parameter { range, ..self }
    }

    pub fn unit(self, unit: &'static str) -> Self {
        Parameter { unit, ..self }
    }

    pub fn cost(self, cost: Cost) -> Self {
        Parameter { cost, ..self }
    }

    pub fn placeholder(self, placeholder: &'static str) -> Self {
        Parameter { placeholder, ..self }
    }

    /// Text for help in place of the default value, where that is empty or says less.
    pub fn default_text(self, text: &'static str) -> Self {
        Parameter { default_text: Some(text), ..self }
    }

    /// Names that it must not be given with.
    pub fn excludes(self, names: &'static [&'static str]) -> Self {
        Parameter { excludes: names, ..self }
    }

    /// The name that it must be given with.
    pub fn requires(self, name: &'static str) -> Self {
        Parameter { requires: Some(name), ..self }
    }

    /// Listed by the short help.
    pub fn everyday(self) -> Self {
        Parameter { is_everyday: true, ..self }
    }

    /// Left out of `config`, which has what follows from it.
    pub fn unrecorded(self) -> Self {
        Parameter { is_recorded: false, ..self }
    }

    /// The same parameter of a set-up that has an `S` as its part.
    pub fn inside<W: 'static>(self, part: fn(&W) -> &S, part_mut: fn(&mut W) -> &mut S) -> Parameter<W> {
        Parameter {
            access: Box::new(Inside { part, part_mut, access: self.access }),
            name: self.name,
            group: self.group,
            help: self.help,
            section: self.section,
            unit: self.unit,
            range: self.range,
            cost: self.cost,
            is_everyday: self.is_everyday,
            placeholder: self.placeholder,
            excludes: self.excludes,
            requires: self.requires,
            default_text: self.default_text,
            is_recorded: self.is_recorded,
        }
    }

    /// Properties of the option that follow from the type of the value.
    pub fn shape(&self) -> Shape {
        self.access.shape()
    }

    /// The value as it is typed.
    pub fn text(&self, setup: &S) -> String {
        self.access.text(setup)
    }

    /// Default as help shows it; empty for none.
    pub fn default_of(&self, default: &S) -> String {
        self.default_text.map_or_else(|| self.text(default), str::to_owned)
    }

    /// Range and unit as they follow the help: `0 to 10 metres`; empty where any value will do.
    pub fn bounds(&self) -> String {
        match (self.range.text().as_str(), self.unit) {
            ("", unit) => unit.to_owned(),
            (range, "") => range.to_owned(),
            (range, unit) => format!("{range} {unit}"),
        }
    }

    /// Checks the form of one value as it was typed, without its range.
    pub fn parser(&self) -> fn(&[&OsStr]) -> Result<(), String> {
        self.access.parser()
    }

    /// Sets the value that was typed; its range is [checked](check) with that of all others.
    ///
    /// # Errors
    /// The form that is expected.
    pub fn set(&self, setup: &mut S, texts: &[&OsStr]) -> Result<(), String> {
        self.access.set(setup, texts)
    }

    /// Files that the value names.
    pub fn files(&self, setup: &S) -> Vec<PathBuf> {
        self.access.files(setup)
    }

    /// Gives `to` the value of `from`.
    pub fn copy(&self, from: &S, to: &mut S) {
        self.access.copy(from, to);
    }

    fn check(&self, setup: &S) -> Result<(), ParameterError> {
        let each = if self.shape().is_several { "each must be" } else { "must be" };
        let range = format!("{each} {}", self.bounds());
        ParameterError::check(self.access.lies_in(setup, &self.range), self.name, self.text(setup), &range)
    }
}

/// Checks every value against its range.
///
/// # Errors
/// The first parameter outside its range.
pub fn check<S: 'static>(parameters: &[Parameter<S>], setup: &S) -> Result<(), ParameterError> {
    parameters.iter().try_for_each(|parameter| parameter.check(setup))
}

/// Every recorded parameter under its key.
pub fn config<S: 'static>(parameters: &[Parameter<S>], setup: &S) -> Map<String, Json> {
    let recorded = parameters.iter().filter(|parameter| parameter.is_recorded);
    recorded.map(|parameter| (parameter.name.replace('-', "_"), parameter.access.json(setup))).collect()
}

/// Names of the parameters and options that a user gave.
#[derive(Debug, Clone, Default)]
pub struct Given(BTreeSet<String>);

impl Given {
    /// True when the parameter or option was typed.
    pub fn has(&self, name: &str) -> bool {
        self.0.contains(name)
    }

    /// True when no other than these was given.
    pub fn is_within(&self, names: &[&str]) -> bool {
        self.0.iter().all(|given| names.contains(&given.as_str()))
    }
}

/// Names of parameters and options as messages have them, in backticks, if there are any.
pub fn listed<'a>(names: impl Iterator<Item = &'a str>) -> Option<String> {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

impl FromIterator<String> for Given {
    fn from_iter<I: IntoIterator<Item = String>>(names: I) -> Self {
        Given(names.into_iter().collect())
    }
}

/// Access to a value of any type in a set-up.
trait Access<S> {
    fn shape(&self) -> Shape;
    fn parser(&self) -> fn(&[&OsStr]) -> Result<(), String>;
    fn set(&self, setup: &mut S, texts: &[&OsStr]) -> Result<(), String>;
    fn copy(&self, from: &S, to: &mut S);
    fn text(&self, setup: &S) -> String;
    fn json(&self, setup: &S) -> Json;
    fn files(&self, setup: &S) -> Vec<PathBuf>;
    fn lies_in(&self, setup: &S, range: &Range) -> bool;
}

impl<S, T: Value> Access<S> for Field<S, T> {
    fn shape(&self) -> Shape {
        T::SHAPE
    }

    fn parser(&self) -> fn(&[&OsStr]) -> Result<(), String> {
        |texts| T::parse(texts).map(drop)
    }

    fn set(&self, setup: &mut S, texts: &[&OsStr]) -> Result<(), String> {
        T::parse(texts).map(|value| (self.set)(setup, value))
    }

    fn copy(&self, from: &S, to: &mut S) {
        (self.set)(to, (self.get)(from));
    }

    fn text(&self, setup: &S) -> String {
        (self.get)(setup).text()
    }

    fn json(&self, setup: &S) -> Json {
        (self.get)(setup).json()
    }

    fn files(&self, setup: &S) -> Vec<PathBuf> {
        (self.get)(setup).files()
    }

    fn lies_in(&self, setup: &S, range: &Range) -> bool {
        (self.get)(setup).lies_in(range)
    }
}

/// Access to a value in a part of a set-up.
struct Inside<W, S> {
    part: fn(&W) -> &S,
    part_mut: fn(&mut W) -> &mut S,
    access: Box<dyn Access<S>>,
}

impl<W, S> Access<W> for Inside<W, S> {
    fn shape(&self) -> Shape {
        self.access.shape()
    }

    fn parser(&self) -> fn(&[&OsStr]) -> Result<(), String> {
        self.access.parser()
    }

    fn set(&self, setup: &mut W, texts: &[&OsStr]) -> Result<(), String> {
        self.access.set((self.part_mut)(setup), texts)
    }

    fn copy(&self, from: &W, to: &mut W) {
        self.access.copy((self.part)(from), (self.part_mut)(to));
    }

    fn text(&self, setup: &W) -> String {
        self.access.text((self.part)(setup))
    }

    fn json(&self, setup: &W) -> Json {
        self.access.json((self.part)(setup))
    }

    fn files(&self, setup: &W) -> Vec<PathBuf> {
        self.access.files((self.part)(setup))
    }

    fn lies_in(&self, setup: &W, range: &Range) -> bool {
        self.access.lies_in((self.part)(setup), range)
    }
}
