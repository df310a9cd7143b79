//! Volumes of files, as a user names and places them.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};

use crate::measure::parameter::{Choice, Shape, Value, one, with_place};
use crate::measure::{Error, components};
use crate::papers::gas::grid::Grid;
use crate::papers::gas::model::Volume;
use crate::scene::load_voxels;

/// A file with its place. As text: the file, then nothing, or `@` and 3 to 5 numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeFile {
    /// The file.
    pub path: PathBuf,
    /// Place of its box; without, in that of the scene's first volume.
    pub stand: Option<Stand>,
}

/// Place of a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Middle of its box's lower side, metres.
    pub base_m: Vec3,
    /// Turn about the vertical, degrees, from x towards -z.
    pub yaw_deg: f32,
    /// Longest side of its box before it is turned, metres; without, such that it fits into the scene's first volume.
    pub longest_m: Option<f32>,
}

/// The axis of a file that is upright.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Upright {
    Z,
    Y,
}

impl Choice for Upright {
    const ALL: &'static [Self] = &[Upright::Z, Upright::Y];
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("z", "As scanners have it, and y from the front to the back"), ("y", "As most that is modelled")];
}

/// Treatment of a sample that is no density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unfit {
    Refuse,
    Clamp,
}

impl Choice for Unfit {
    const ALL: &'static [Self] = &[Unfit::Refuse, Unfit::Clamp];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("refuse", "The file is refused"),
        ("clamp", "NaN and what is below the range is density 0, infinity density 1"),
    ];
}

/// Rules by which densities are made of a file's samples.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// Component of samples of several values, from 0.
    pub component: u32,
    /// Values of density 0 and 1.
    pub range: Option<[f32; 2]>,
    /// Treatment of samples that are no number or lie outside the range.
    pub unfit: Unfit,
    /// The file's upright axis.
    pub upright: Upright,
}

/// A file's volume: its densities, and the middle of its box.
#[derive(Debug, Clone)]
pub struct Placed {
    /// Densities.
    pub grid: Arc<Grid>,
    /// Metres.
    pub center: Vec3,
}

impl VolumeFile {
    /// Reads the file and places it; `first` is the scene's first volume.
    ///
    /// # Errors
    /// Those of [`load_voxels`]; [`Error::Input`] for samples that are no densities.
    pub fn load(&self, reading: &Reading, first: &Volume) -> Result<Placed, Error> {
        let voxels = load_voxels(&self.path, reading.component)?;
        let (size, steps) = (voxels.size(), voxels.steps());
        let samples = reading
            .densities(size, voxels.into_samples())
            .map_err(|reason| Error::Input(format!("`volume-file` {}: {reason}", self.path.display())))?;
        // The world's up is y, and its z comes towards the one who looks at the front.
        let to_world = match reading.upright {
            Upright::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            Upright::Y => DMat3::IDENTITY,
        };
        let plain = Grid { size, steps_m: steps.map(|step| to_world * step), samples };
        let half = plain.half_extent_m();
        let room = first.half_extent_m.as_dvec3();
        let longest_m = self.stand.and_then(|stand| stand.longest_m);
        let scale = longest_m.map_or((room / half).min_element(), |side| f64::from(side) / (2.0 * half.max_element()));
        let turn = DMat3::from_rotation_y(f64::from(self.stand.map_or(0.0, |stand| stand.yaw_deg)).to_radians());
        let grid = Grid { steps_m: plain.steps_m.map(|step| turn * step * scale), ..plain };
        let base = self.stand.map_or(first.center - Vec3::Y * first.half_extent_m.y, |stand| stand.base_m);
        let center = base + Vec3::Y * grid.half_extent_m().y as f32;
        Ok(Placed { grid: Arc::new(grid), center })
    }
}

impl Reading {
    /// The samples as parts of the way from density 0 to density 1.
    fn densities(&self, size: [u32; 3], mut values: Vec<f32>) -> Result<Vec<f32>, String> {
        let is_clamped = self.unfit == Unfit::Clamp;
        let place = |index: usize| {
            let [columns, rows, _] = size.map(|count| count as usize);
            format!("sample ({}, {}, {})", index % columns, index / columns % rows, index / columns / rows)
        };
        if let Some(index) = values.iter().position(|value| !value.is_finite()).filter(|_| !is_clamped) {
            return Err(format!("{} is {}, no density; give `volume-unfit` clamp", place(index), values[index]));
        }
        let [low, high] = match self.range {
            Some(range) => range,
            None => {
                if let Some(index) = values.iter().position(|value| *value < 0.0).filter(|_| !is_clamped) {
                    let value = values[index];
                    return Err(format!(
                        "{} is {value}, below density 0; give the values of density 0 and 1 by `volume-range`, or \
                         `volume-unfit` clamp",
                        place(index)
                    ));
                }
                [0.0, values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f32::max)]
            }
        };
        if low == high {
            let found =
                if self.range.is_some() { "`volume-range` has no width" } else { "none of its values is above 0" };
            return Err(format!("{found}; give two values, of density 0 and of density 1, by `volume-range`"));
        }
        // What lies far out of the range would take the precision of what lies in it.
        const MOST: f64 = 1e6;
        let [low, width] = [f64::from(low), f64::from(high) - f64::from(low)];
        for value in &mut values {
            let density = ((f64::from(*value) - low) / width).clamp(-MOST, MOST);
            *value = if density.is_nan() { 0.0 } else { density as f32 };
        }
        Ok(values)
    }
}

impl Value for VolumeFile {
    const SHAPE: Shape = Shape::single("FILE[@PLACE]");

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let [text] = texts else {
            return one(texts).map(|_| VolumeFile { path: PathBuf::new(), stand: None });
        };
        Ok(match with_place(text)? {
            Some((name, numbers)) => VolumeFile { path: name.into(), stand: Some(Stand::of(&numbers)?) },
            None => VolumeFile { path: text.into(), stand: None },
        })
    }

    fn text(&self) -> String {
        let path = self.path.display();
        let Some(Stand { base_m, yaw_deg, longest_m }) = self.stand else { return path.to_string() };
        let longest = longest_m.map_or(String::new(), |side| format!(",{side}"));
        format!("{path}@{},{yaw_deg}{longest}", components(base_m))
    }

    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }
}

impl Stand {
    fn of(numbers: &[f32]) -> Result<Self, String> {
        let (yaw_deg, longest_m) = match *numbers {
            [_, _, _] => (0.0, None),
            [_, _, _, yaw_deg] => (yaw_deg, None),
            [_, _, _, yaw_deg, side] => (yaw_deg, Some(side)),
            _ => return Err(format!("a place is X,Y,Z[,DEGREES[,SIDE]]; {} numbers are given", numbers.len())),
        };
        if longest_m.is_some_and(|side| side <= 0.0) {
            return Err("the longest side of the place must be above 0".to_owned());
        }
        Ok(Stand { base_m: Vec3::new(numbers[0], numbers[1], numbers[2]), yaw_deg, longest_m })
    }
}
