//! Volumes of files, as a user names and places them.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use glam::{DMat3, DVec3, Vec3};

use crate::measure::parameter::{Cost, Parameter, Range, Shape, Value, one, with_place};
use crate::measure::{Error, components};
use crate::papers::gas::grid::Grid;
use crate::papers::gas::model::Volume;
use crate::papers::lava::blackbody;
use crate::scene::load_voxels;
use crate::{choice, field};

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

choice! {
    /// The axis of a file that is upright.
    pub enum Upright {
        Z = ("z", "As scanners have it, and y from the front to the back"),
        Y = ("y", "As most that is modelled"),
    }
}

choice! {
    /// Treatment of a sample that is no density.
    pub enum Unfit {
        Refuse = ("refuse", "The file is refused"),
        Clamp = ("clamp", "NaN and what is below the range is density 0, infinity density 1"),
    }
}

/// Hottest temperature that is told from others, kelvin.
const MOST_K: f32 = 1e5;

/// Rules by which densities are made of a file's samples.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// Component of samples of several values, from 0.
    pub component: u32,
    /// Component whose samples are temperatures, kelvin, from 0.
    pub temperature: Option<u32>,
    /// Temperature at which the brightest primary of a black body is 1, kelvin, above 0.
    pub white_k: f32,
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
        let refused = |reason: String| Error::Input(format!("`volume-file` {}: {reason}", self.path.display()));
        let samples = reading.densities(size, voxels.into_samples()).map_err(refused)?;
        let mut glow = Vec::new();
        if let Some(component) = reading.temperature {
            let voxels = load_voxels(&self.path, component)?;
            if (voxels.size(), voxels.steps()) != (size, steps) {
                let reason = "its temperatures lie on another grid than its densities; write both on one";
                return Err(refused(reason.to_owned()));
            }
            glow = reading.glow(size, voxels.samples()).map_err(refused)?;
        }
        // The world's up is y, and its z comes towards the one who looks at the front.
        let to_world = match reading.upright {
            Upright::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
            Upright::Y => DMat3::IDENTITY,
        };
        let plain = Grid { size, steps_m: steps.map(|step| to_world * step), samples, glow };
        let half = plain.half_extent_m();
        let room = first.half_extent_m.as_dvec3();
        let longest_m = self.stand.and_then(|stand| stand.longest_m);
        let scale = longest_m.map_or((room / half).min_element(), |side| f64::from(side) / (2.0 * half.max_element()));
        let turn = DMat3::from_rotation_y(f64::from(self.stand.map_or(0.0, |stand| stand.yaw_deg)).to_radians());
        let grid = Grid { steps_m: plain.steps_m.map(|step| turn * step * scale), ..plain };
        let half = grid.half_extent_m();
        if !half.to_array().iter().all(|half_m| (1e-4..=1e6).contains(half_m)) {
            let sides = (2.0 * half).to_array().map(|side| format!("{side:.3e}")).join(" x ");
            return Err(refused(format!(
                "its box has {sides} metres, and a side is 0.0002 to 2000000; place it otherwise"
            )));
        }
        let base = self.stand.map_or(first.center - Vec3::Y * first.half_extent_m.y, |stand| stand.base_m);
        let center = base + Vec3::Y * half.y as f32;
        Ok(Placed { grid: Arc::new(grid), center })
    }
}

/// A sample of a grid in words.
fn place(size: [u32; 3], index: usize) -> String {
    let [columns, rows, _] = size.map(|count| count as usize);
    format!("sample ({}, {}, {})", index % columns, index / columns % rows, index / columns / rows)
}

/// Densities from 0 to the largest value, as scanners have them upright.
impl Default for Reading {
    fn default() -> Self {
        Reading {
            component: 0,
            temperature: None,
            white_k: 2000.0,
            range: None,
            unfit: Unfit::Refuse,
            upright: Upright::Z,
        }
    }
}

impl Reading {
    /// Each option once.
    pub fn declared() -> Vec<Parameter<Reading>> {
        vec![
            Parameter::new("volume-range", field!(Reading.range))
                .placeholder("A,B")
                .help(
                    "Of files: values of density 0 and of density 1, between which it is linear and beyond which it is cut \
                     off; `opaque` and `power` go on from there",
                )
                .default_text("0 and the file's largest value")
                .cost(Cost::Buffers)
                .requires("volume-file"),
            Parameter::new("volume-unfit", field!(Reading.unfit))
                .help("Of files: how to treat NaN, infinity and, without a range, negative values")
                .cost(Cost::Buffers)
                .requires("volume-file"),
            Parameter::new("volume-component", field!(Reading.component))
                .help("Of files with several values a sample, or several grids: which of them is the density, from 0")
                .cost(Cost::Buffers)
                .requires("volume-file"),
            Parameter::new("volume-temperature", field!(Reading.temperature))
                .help(
                    "Of files with several values a sample, or several grids: which of them is the temperature in kelvin, \
                     from 0: gas glows as a black body of it does, by the fraction of light that it absorbs",
                )
                .default_text("none")
                .cost(Cost::Buffers)
                .requires("volume-file"),
            Parameter::new("white-temperature", field!(Reading.white_k))
                .range(Range::from(500.0).to(1e5))
                .unit("kelvin")
                .help("Of files with temperatures: that at which gas that absorbs all light shows 1 in its brightest primary")
                .cost(Cost::Buffers)
                .requires("volume-file"),
            Parameter::new("volume-up", field!(Reading.upright))
                .help("Of files: their upright axis")
                .cost(Cost::Buffers)
                .requires("volume-file"),
        ]
    }

    /// The light of each sample's temperature, as a black body of it has it.
    fn glow(&self, size: [u32; 3], kelvins: &[f32]) -> Result<Vec<[f32; 3]>, String> {
        /// Entries from 0 to the hottest: the light between them is on a straight line.
        const ENTRIES: usize = 4096;
        let is_unfit = |kelvin: &f32| !kelvin.is_finite() || *kelvin < 0.0;
        if let Some(index) = kelvins.iter().position(is_unfit).filter(|_| self.unfit == Unfit::Refuse) {
            let value = kelvins[index];
            return Err(format!("{} is {value} K, no temperature; give `volume-unfit` clamp", place(size, index)));
        }
        let fit = |kelvin: f32| if is_unfit(&kelvin) { 0.0 } else { kelvin.min(MOST_K) };
        let hottest = f64::from(kelvins.iter().copied().map(fit).fold(1.0, f32::max));
        let white = blackbody::light(self.white_k.into()).into_iter().fold(0.0, f64::max);
        let entry = |at: usize| blackbody::light(hottest * at as f64 / ENTRIES as f64).map(|light| light / white);
        let table: Vec<[f64; 3]> = (0..=ENTRIES + 1).map(entry).collect();
        let of = |&kelvin: &f32| {
            let at = f64::from(fit(kelvin)) / hottest * ENTRIES as f64;
            let (low, part) = (at as usize, at.fract());
            std::array::from_fn(|channel| {
                (table[low][channel] * (1.0 - part) + table[low + 1][channel] * part).min(1e6) as f32
            })
        };
        Ok(kelvins.iter().map(of).collect())
    }

    /// The samples as parts of the way from density 0 to density 1.
    fn densities(&self, size: [u32; 3], mut values: Vec<f32>) -> Result<Vec<f32>, String> {
        let is_clamped = self.unfit == Unfit::Clamp;
        if let Some(index) = values.iter().position(|value| !value.is_finite()).filter(|_| !is_clamped) {
            let (place, value) = (place(size, index), values[index]);
            return Err(format!("{place} is {value}, no density; give `volume-unfit` clamp"));
        }
        let [low, high] = match self.range {
            Some(range) => range,
            None => {
                if let Some(index) = values.iter().position(|value| *value < 0.0).filter(|_| !is_clamped) {
                    let value = values[index];
                    return Err(format!(
                        "{} is {value}, below density 0; give the values of density 0 and 1 by `volume-range`, or \
                         `volume-unfit` clamp",
                        place(size, index)
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
