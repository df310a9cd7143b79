//! Values of parameters: how they are typed, shown, recorded and held against a range.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::Vec3;
use serde_json::{Value as Json, json};

use super::Range;
use crate::scene::{HeightMapSource, MeshSource};

/// Properties of an option that follow from the type of its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Form of the value: `N`, `X,Y,Z`.
    pub placeholder: &'static str,
    /// On or off: its option has no value.
    pub is_flag: bool,
    /// Its option may be repeated.
    pub is_list: bool,
    /// Items of a list may stand between commas.
    pub joins: bool,
    /// Several numbers, so that messages speak of each.
    pub is_several: bool,
    /// It may begin with a minus.
    pub is_signed: bool,
    /// Names of the values with their help, where they are few.
    pub choices: &'static [(&'static str, &'static str)],
}

impl Shape {
    /// A single value without any of the rest.
    pub const fn single(placeholder: &'static str) -> Self {
        Shape {
            placeholder,
            is_flag: false,
            is_list: false,
            joins: false,
            is_several: false,
            is_signed: false,
            choices: &[],
        }
    }
}

/// A value that a parameter can have.
pub trait Value: Clone + 'static {
    const SHAPE: Shape;

    /// Reads what was typed: one text, of a list any number.
    ///
    /// # Errors
    /// The form that is expected.
    fn parse(texts: &[&OsStr]) -> Result<Self, String>;

    /// As it is typed; empty for none.
    fn text(&self) -> String;

    /// As the record has it.
    fn json(&self) -> Json {
        json!(self.text())
    }

    /// Files that it names.
    fn files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Holds each of its numbers against a range.
    fn lies_in(&self, _range: &Range) -> bool {
        true
    }
}

/// The one text that was typed.
///
/// # Errors
/// Fails for several texts, or one that is not UTF-8.
pub fn one<'a>(texts: &[&'a OsStr]) -> Result<&'a str, String> {
    match texts {
        [text] => text.to_str().ok_or_else(|| format!("{} is not UTF-8", text.display())),
        _ => Err(format!("one value is needed, {} are given", texts.len())),
    }
}

/// A text and the numbers after its last `@`; `None` where what follows looks like no numbers, since a file's name may hold
/// an `@` itself.
///
/// # Errors
/// The part of the text that ought to be a number and is none.
pub fn with_place(text: &OsStr) -> Result<Option<(&str, Vec<f32>)>, String> {
    let is_number = |c: char| c.is_ascii_digit() || "+-.,eE ".contains(c);
    match text.to_str().and_then(|text| text.rsplit_once('@')) {
        Some((name, place)) if !place.is_empty() && place.chars().all(is_number) => {
            let numbers = place.split(',').map(|part| parse_finite(part.trim())).collect::<Result<_, _>>()?;
            Ok(Some((name, numbers)))
        }
        _ => Ok(None),
    }
}

/// A number that is neither NaN nor infinite.
///
/// # Errors
/// For other text.
pub fn parse_finite(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{text:?} is not a finite number")),
    }
}

/// Comma-separated numbers, exactly `N` of them.
///
/// # Errors
/// For other text.
pub fn parse_numbers<const N: usize>(text: &str) -> Result<[f32; N], String> {
    <[f32; N]>::parse(&[OsStr::new(text)])
}

fn parse_array<T: Value, const N: usize>(text: &str) -> Result<[T; N], String> {
    let values = text.split(',').map(|part| T::parse(&[OsStr::new(part.trim())])).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{N} comma-separated numbers are needed, {count} are given"))
}

/// `100x24x24` and its like: exactly `N` numbers.
///
/// # Errors
/// For other text.
pub fn parse_extents<T: FromStr, const N: usize>(text: &str) -> Result<[T; N], String> {
    let number = |part: &str| part.trim().parse::<T>().map_err(|_| format!("{part:?} is not such a number"));
    let values = text.split(['x', 'X']).map(number).collect::<Result<Vec<_>, _>>()?;
    let count = values.len();
    values.try_into().map_err(|_| format!("{N} numbers with an x between them are needed, {count} are given"))
}

fn joined<T: ToString>(values: &[T], separator: &str) -> String {
    values.iter().map(T::to_string).collect::<Vec<_>>().join(separator)
}

macro_rules! whole {
    ($($type:ty),+) => { $(
        impl Value for $type {
            const SHAPE: Shape = Shape { joins: true, is_signed: true, ..Shape::single("N") };

            fn parse(texts: &[&OsStr]) -> Result<Self, String> {
                let text = one(texts)?;
                text.parse().map_err(|_| format!("{text:?} is not a whole number from 0 to {}", <$type>::MAX))
            }

            fn text(&self) -> String {
                self.to_string()
            }

            fn json(&self) -> Json {
                json!(self)
            }

            fn lies_in(&self, range: &Range) -> bool {
                range.holds(*self as f64, |end| end)
            }
        }
    )+ };
}

whole!(u32, u64);

macro_rules! real {
    ($($type:ty),+) => { $(
        impl Value for $type {
            const SHAPE: Shape = Shape { is_signed: true, ..Shape::single("F") };

            fn parse(texts: &[&OsStr]) -> Result<Self, String> {
                let text = one(texts)?;
                match text.parse::<$type>() {
                    Ok(value) if value.is_finite() => Ok(value),
                    _ => Err(format!("{text:?} is not a finite number")),
                }
            }

            fn text(&self) -> String {
                self.to_string()
            }

            fn json(&self) -> Json {
                json!(self)
            }

            fn lies_in(&self, range: &Range) -> bool {
                range.holds(f64::from(*self), |end| f64::from(end as $type))
            }
        }

        impl<const N: usize> Value for [$type; N] {
            const SHAPE: Shape = Shape { is_several: true, is_signed: true, ..Shape::single("F,F,..") };

            fn parse(texts: &[&OsStr]) -> Result<Self, String> {
                parse_array(one(texts)?)
            }

            fn text(&self) -> String {
                joined(self, ",")
            }

            fn json(&self) -> Json {
                json!(self.as_slice())
            }

            fn lies_in(&self, range: &Range) -> bool {
                self.iter().all(|value| value.lies_in(range))
            }
        }
    )+ };
}

real!(f32, f64);

/// Without a text it is on; the command line gives `false` for an option that begins with `no-`.
impl Value for bool {
    const SHAPE: Shape = Shape { is_flag: true, ..Shape::single("") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        one(texts)?.parse().map_err(|_| "true or false is needed".to_owned())
    }

    fn text(&self) -> String {
        if *self { "on" } else { "off" }.to_owned()
    }

    fn json(&self) -> Json {
        json!(self)
    }
}

impl Value for Vec3 {
    const SHAPE: Shape = Shape { placeholder: "X,Y,Z", ..<[f32; 3]>::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        <[f32; 3]>::parse(texts).map(Vec3::from)
    }

    fn text(&self) -> String {
        self.to_array().text()
    }

    fn json(&self) -> Json {
        self.to_array().json()
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.to_array().lies_in(range)
    }
}

/// Numbers with an x between them: `100x24x24`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extents<T, const N: usize>(pub [T; N]);

impl<T: Value + FromStr + serde::Serialize, const N: usize> Value for Extents<T, N> {
    const SHAPE: Shape = Shape { is_several: true, is_signed: true, ..Shape::single("NxN") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let extents: Self = Extents(parse_extents(one(texts)?)?);
        // Infinite numbers and NaN are no extents.
        if extents.0.iter().all(|e| T::parse(&[OsStr::new(&e.text())]).is_ok()) {
            Ok(extents)
        } else {
            Err("finite numbers with an x between them are needed".to_owned())
        }
    }

    fn text(&self) -> String {
        self.0.iter().map(T::text).collect::<Vec<_>>().join("x")
    }

    fn json(&self) -> Json {
        json!(self.0.as_slice())
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.0.iter().all(|value| value.lies_in(range))
    }
}

/// Width and height of a picture in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
}

impl Value for Size {
    const SHAPE: Shape = Shape { placeholder: "WxH", ..Extents::<u32, 2>::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let [width, height] =
            parse_extents(one(texts)?).map_err(|e| format!("{e}; give a width and a height, as 800x600"))?;
        Ok(Size { width, height })
    }

    fn text(&self) -> String {
        format!("{}x{}", self.width, self.height)
    }

    fn json(&self) -> Json {
        json!([self.width, self.height])
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.width.lies_in(range) && self.height.lies_in(range)
    }
}

/// A camera's eye and target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeAndTarget {
    /// Position of the camera in the world.
    pub eye: Vec3,
    /// Point of the world that the camera looks at.
    pub target: Vec3,
}

impl Value for EyeAndTarget {
    const SHAPE: Shape = Shape { placeholder: "EYE,TARGET", ..<[f32; 6]>::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let [ex, ey, ez, tx, ty, tz] = parse_numbers(one(texts)?)?;
        Ok(EyeAndTarget { eye: Vec3::new(ex, ey, ez), target: Vec3::new(tx, ty, tz) })
    }

    fn text(&self) -> String {
        format!("{},{}", self.eye.text(), self.target.text())
    }

    fn json(&self) -> Json {
        json!([self.eye.to_array(), self.target.to_array()])
    }
}

impl<T: Value> Value for Option<T> {
    const SHAPE: Shape = T::SHAPE;

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        T::parse(texts).map(Some)
    }

    fn text(&self) -> String {
        self.as_ref().map_or_else(String::new, T::text)
    }

    fn json(&self) -> Json {
        self.as_ref().map_or(Json::Null, T::json)
    }

    fn files(&self) -> Vec<PathBuf> {
        self.as_ref().map_or_else(Vec::new, T::files)
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.as_ref().is_none_or(|value| value.lies_in(range))
    }
}

impl<T: Value> Value for Vec<T> {
    const SHAPE: Shape = Shape { is_list: true, is_several: true, ..T::SHAPE };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        texts.iter().map(|text| T::parse(&[text])).collect()
    }

    fn text(&self) -> String {
        self.iter().map(T::text).collect::<Vec<_>>().join(if T::SHAPE.joins { "," } else { " " })
    }

    fn json(&self) -> Json {
        self.iter().map(T::json).collect()
    }

    fn files(&self) -> Vec<PathBuf> {
        self.iter().flat_map(T::files).collect()
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.iter().all(|value| value.lies_in(range))
    }
}

macro_rules! source {
    ($($type:ty, $placeholder:literal);+) => { $(
        impl Value for $type {
            const SHAPE: Shape = Shape::single($placeholder);

            fn parse(texts: &[&OsStr]) -> Result<Self, String> {
                match texts {
                    // Only a file can have a name that is not UTF-8.
                    [text] => Ok(text.to_str().map_or_else(|| Self::File(text.into()), |text| {
                        let Ok(source) = text.parse();
                        source
                    })),
                    _ => one(texts).map(|_| Self::File(PathBuf::new())),
                }
            }

            fn text(&self) -> String {
                self.to_string()
            }

            fn files(&self) -> Vec<PathBuf> {
                self.path().map(Path::to_path_buf).into_iter().collect()
            }
        }
    )+ };
}

source!(MeshSource, "SHAPE|FILE[:N]"; HeightMapSource, "NAME|FILE");

impl Value for PathBuf {
    const SHAPE: Shape = Shape::single("FILE");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        match texts {
            [text] => Ok(text.into()),
            _ => one(texts).map(PathBuf::from),
        }
    }

    fn text(&self) -> String {
        self.display().to_string()
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.clone()]
    }
}

/// A value that is one of a few with names.
pub trait Choice: Copy + PartialEq + 'static {
    /// Each with its place in [`Choice::NAMES`].
    const ALL: &'static [Self];
    /// Names and help, in the order of [`Choice::ALL`].
    const NAMES: &'static [(&'static str, &'static str)];

    /// The name that the command line and the record know it by.
    fn name(self) -> &'static str {
        let at = Self::ALL.iter().position(|choice| *choice == self);
        at.and_then(|at| Self::NAMES.get(at)).map_or("", |(name, _)| name)
    }
}

impl<T: Choice> Value for T {
    const SHAPE: Shape = Shape { joins: true, choices: T::NAMES, ..Shape::single("NAME") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        let found = T::ALL.iter().find(|choice| choice.name() == text).copied();
        let names = || T::NAMES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        found.ok_or_else(|| format!("{text:?} is none of {}", names()))
    }

    fn text(&self) -> String {
        self.name().to_owned()
    }
}
