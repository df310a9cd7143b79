//! The numbers of the gases: their solids, their density functions, their optics. Each is one number for all volumes
//! that have it.

use std::ffi::OsStr;
use std::mem::discriminant;

use glam::Vec3;
use serde_json::{Value as Json, json};

use super::default_volume;
use crate::measure::parameter::{
    self, Choice, Cost, Field, Given, Parameter, Range, Shape as OptionShape, Value, one, parse_numbers,
};
use crate::measure::{Error, ParameterError, components};
use crate::papers::gas::model::{DensityFunction, Front, HenyeyGreenstein, Shape, SolidTexture, Swirl, Volume};
use crate::papers::gas::scenes;

/// The solid of one more volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The solid.
    pub shape: Shape,
    /// Metres.
    pub center: Vec3,
    /// Metres, above 0.
    pub half_extent_m: Vec3,
}

/// `frustum,0,1,0,0.5,1,0.5,0.6,1` and its like.
impl Value for Placement {
    const SHAPE: OptionShape =
        OptionShape { is_several: true, is_signed: true, ..OptionShape::single("SHAPE,X,Y,Z,X,Y,Z[,B,T]") };

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        let text = one(texts)?;
        let (name, numbers) = text.split_once(',').ok_or("give a shape and its numbers, as box,0,1,0,0.5,1,0.5")?;
        let (shape, [x, y, z, half_x, half_y, half_z]) = match name {
            "box" => (Shape::Box, parse_numbers(numbers)?),
            "sphere" => (Shape::Sphere, parse_numbers(numbers)?),
            "cylinder" => (Shape::Cylinder, parse_numbers(numbers)?),
            "frustum" => {
                let [x, y, z, half_x, half_y, half_z, bottom, top] = parse_numbers(numbers)?;
                (Shape::Frustum { bottom, top }, [x, y, z, half_x, half_y, half_z])
            }
            _ => return Err(format!("{name:?} is no shape: give box, sphere, cylinder or frustum")),
        };
        Ok(Placement { shape, center: Vec3::new(x, y, z), half_extent_m: Vec3::new(half_x, half_y, half_z) })
    }

    fn text(&self) -> String {
        let numbers = format!("{},{}", components(self.center), components(self.half_extent_m));
        match self.shape {
            Shape::Box => format!("box,{numbers}"),
            Shape::Sphere => format!("sphere,{numbers}"),
            Shape::Cylinder => format!("cylinder,{numbers}"),
            Shape::Frustum { bottom, top } => format!("frustum,{numbers},{bottom},{top}"),
        }
    }
}

/// Each with the numbers of the figure that it comes from.
impl Choice for DensityFunction {
    const ALL: &'static [Self] = &[
        DensityFunction::Constant,
        DensityFunction::Turbulence,
        DensityFunction::Clouds { frequency: 4.0 },
        scenes::FOG,
        scenes::STEAM,
        scenes::HYPERTEXTURE,
    ];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("constant", "The same everywhere"),
        ("turbulence", "Turbulence (1985)"),
        ("clouds", "A sine wave through the turbulent space"),
        ("fog", "Figure 7's fog behind its front, moved along a helix as the frames go on"),
        ("steam", "Figures 6 and 8's steam, which rises and thins with its height"),
        ("hypertexture", "A soft ball whose surface the turbulence moves"),
    ];

    /// The same with any numbers.
    fn name(self) -> &'static str {
        let is_same = |(choice, _): &(&Self, _)| discriminant(*choice) == discriminant(&self);
        Self::ALL.iter().zip(Self::NAMES).find(is_same).map_or("", |(_, (name, _))| name)
    }
}

/// A volume of each density function: what is set in them is in one of them, whichever function has it.
pub fn templates() -> Vec<Volume> {
    let volume = |&function: &DensityFunction| {
        let texture = SolidTexture { function, ..default_volume().texture };
        Volume { texture, ..default_volume() }
    };
    DensityFunction::ALL.iter().map(volume).collect()
}

/// The values of a number in all volumes that have it; as it is typed, one for all.
#[derive(Debug, Clone)]
struct OfVolumes<T>(Vec<T>);

impl<T: Value> Value for OfVolumes<T> {
    const SHAPE: OptionShape = T::SHAPE;

    fn parse(texts: &[&OsStr]) -> Result<Self, String> {
        T::parse(texts).map(|value| OfVolumes(vec![value]))
    }

    /// Empty where no volume has the number.
    fn text(&self) -> String {
        let mut texts: Vec<String> = self.0.iter().map(T::text).collect();
        texts.dedup();
        texts.join(" ")
    }

    fn json(&self) -> Json {
        self.0.iter().map(T::json).collect()
    }

    fn lies_in(&self, range: &Range) -> bool {
        self.0.iter().all(|value| value.lies_in(range))
    }
}

/// The field of what one function reads from some volumes and another writes to all.
macro_rules! of_volumes {
    ($get:expr, $set:expr) => {
        Field {
            get: |volumes: &Vec<Volume>| OfVolumes(volumes.iter().filter_map($get).collect()),
            set: |volumes, OfVolumes(values)| {
                let set: fn(&mut Volume, _) = $set;
                values.first().into_iter().for_each(|value| volumes.iter_mut().for_each(|v| set(v, *value)));
            },
        }
    };
}

/// The field of a number that a function finds in some volumes.
macro_rules! number {
    ($find:expr) => {
        of_volumes!(
            |volume| {
                let find: fn(&mut Volume) -> Option<&mut _> = $find;
                find(&mut volume.clone()).copied()
            },
            |volume, value| {
                let find: fn(&mut Volume) -> Option<&mut _> = $find;
                find(volume).into_iter().for_each(|number| *number = value);
            }
        )
    };
}

/// Grids are given by their files.
fn function(volume: &mut Volume) -> Option<&mut DensityFunction> {
    Some(&mut volume.texture.function).filter(|function| !matches!(function, DensityFunction::Grid(_)))
}

fn scale(volume: &mut Volume) -> Option<&mut f32> {
    let is_function = function(volume).is_some();
    is_function.then_some(&mut volume.texture.scale_per_m)
}

fn clouds(volume: &mut Volume) -> Option<&mut f32> {
    match &mut volume.texture.function {
        DensityFunction::Clouds { frequency } => Some(frequency),
        _ => None,
    }
}

fn swirl(volume: &mut Volume) -> Option<&mut Swirl> {
    match &mut volume.texture.function {
        DensityFunction::Fog { swirl, .. } | DensityFunction::Steam { swirl } => Some(swirl),
        _ => None,
    }
}

fn front(volume: &mut Volume) -> Option<&mut Front> {
    match &mut volume.texture.function {
        DensityFunction::Fog { front, .. } => Some(front),
        _ => None,
    }
}

const FRONT: Field<Vec<Volume>, OfVolumes<[f32; 5]>> = of_volumes!(
    |volume| front(&mut volume.clone()).map(|f| [f.x_m, f.per_frame_m, f.depth_m, f.turbulence_m, f.table_m]),
    |volume, [x_m, per_frame_m, depth_m, turbulence_m, table_m]: [f32; 5]| {
        if let Some(front) = front(volume) {
            *front = Front { x_m, per_frame_m, depth_m, turbulence_m, table_m, ..*front };
        }
    }
);

const HYPERTEXTURE: Field<Vec<Volume>, OfVolumes<[f32; 2]>> = of_volumes!(
    |volume| match volume.texture.function {
        DensityFunction::Hypertexture { amplitude, softness } => Some([amplitude, softness]),
        _ => None,
    },
    |volume, [amplitude, softness]: [f32; 2]| {
        if matches!(volume.texture.function, DensityFunction::Hypertexture { .. }) {
            volume.texture.function = DensityFunction::Hypertexture { amplitude, softness };
        }
    }
);

const ALBEDO: Field<Vec<Volume>, OfVolumes<f32>> = Field {
    get: |volumes| OfVolumes(volumes.iter().flat_map(|volume| volume.albedo.to_array()).collect()),
    ..of_volumes!(|_| None, |volume, albedo| volume.albedo = Vec3::splat(albedo))
};

/// Solids have normals instead.
const PHASE: Field<Vec<Volume>, OfVolumes<[f32; 4]>> = of_volumes!(
    |volume| {
        let [first, second] = volume.phase;
        (!volume.is_solid).then_some([first.weight, first.g, second.weight, second.g])
    },
    |volume, [w0, g0, w1, g1]: [f32; 4]| {
        volume.phase = [HenyeyGreenstein { weight: w0, g: g0 }, HenyeyGreenstein { weight: w1, g: g1 }];
    }
);

/// The numbers of the gases, once.
pub fn declared() -> Vec<Parameter<Vec<Volume>>> {
    let scene = "the scene's";
    let figure = "the figure's";
    let parameters = vec![
        Parameter::new("density", number!(function)).help("Density function of all volumes").default_text(scene),
        Parameter::new("opaque", number!(|v| Some(&mut v.texture.opaque)))
            .range(Range::from(0.0).to(1e6))
            .help("Factor of all volumes' density (the paper's opaque)")
            .default_text(scene),
        Parameter::new("power", number!(|v| Some(&mut v.texture.power)))
            .range(Range::above(0.0).to(100.0))
            .help("Exponent of all volumes' density")
            .default_text(scene),
        Parameter::new("texture-scale", number!(scale))
            .range(Range::from(1e-4).to(1e4))
            .unit("texture units a metre")
            .help("Scale of all volumes' solid texture")
            .default_text(scene),
        Parameter::new("frequency", number!(clouds))
            .range(Range::from(-1e4).to(1e4))
            .help("Of clouds: frequency of the sine wave")
            .default_text("4"),
        Parameter::new("down", number!(|v| swirl(v).map(|swirl| &mut swirl.along_per_frame)))
            .range(Range::from(-1e4).to(1e4))
            .unit("texture units a frame")
            .help("Of fog and steam: motion along the helix (DOWN)")
            .default_text(figure),
        Parameter::new("swirl-frames", number!(|v| swirl(v).map(|swirl| &mut swirl.frames)))
            .range(Range::from(0.0).to(1e4))
            .help("Of fog and steam: frames of one revolution of the helix (SWIRL_FRAMES), 0 for none")
            .default_text(figure),
        Parameter::new("ellipse", number!(|v| swirl(v).map(|swirl| &mut swirl.ellipse)))
            .range(Range::from(-1e4).to(1e4))
            .unit("texture units")
            .placeholder("F,F")
            .help("Of fog and steam: diameters of the helix (ELLIPSE1, ELLIPSE2)")
            .default_text(figure),
        Parameter::new("front", FRONT)
            .range(Range::from(-1e6).to(1e6))
            .placeholder("X,STEP,DEPTH,T,R")
            .help(
                "Of fog: the front's x in metres at frame 0, metres a frame, metres behind it until the fog is \
                 thickest (above 0), metres by which a turbulence of 1 moves it, and a random number of 1",
            )
            .default_text("figure 7's"),
        Parameter::new("full-fog", number!(|v| front(v).map(|front| &mut front.full_frames)))
            .range(Range::from(0.0).to(1e6))
            .unit("frames")
            .help("Of fog: until it is at its thickest (FULL_FOG); 0 for at once")
            .default_text("0"),
        Parameter::new("hypertexture", HYPERTEXTURE)
            .placeholder("NOISE,SOFTNESS")
            .help(
                "Of hypertexture: fraction of the radius by which turbulence moves the surface, 0 to 100, and over \
                 which it turns dense, above 0 and at most 1",
            )
            .default_text("1.4,0.16"),
        Parameter::new("tau", number!(|v| Some(&mut v.tau_per_m)))
            .range(Range::from(0.0).to(1e6))
            .unit("per metre")
            .help("Optical depth of density 1 of all volumes")
            .default_text(scene),
        Parameter::new("albedo", ALBEDO)
            .range(Range::from(0.0).to(1.0))
            .help("Albedo of all volumes")
            .default_text(scene),
        Parameter::new("falloff", number!(|v| Some(&mut v.falloff)))
            .range(Range::from(0.0).to(1.0))
            .help("Fraction of the distance from the boundary to the middle over which all volumes fade")
            .default_text(scene),
        Parameter::new("phase", PHASE)
            .placeholder("W,G,W,G")
            .help(
                "Two Henyey-Greenstein functions of all gases: weight,g,weight,g; weights add up to 1, g between -1 \
                 and 1",
            )
            .section("Illumination of gaseous phenomena")
            .default_text("0.8,0.5,0.2,-0.3"),
    ];
    parameters.into_iter().map(|p| p.group("Gases").cost(Cost::Buffers).unrecorded()).collect()
}

/// A volume as the record has it.
pub fn recorded(v: &Volume) -> Json {
    json!({
        "shape": format!("{:?}", v.shape), "center": v.center.to_array(), "half_extent": v.half_extent_m.to_array(),
        "falloff": v.falloff, "solid": v.is_solid, "density": format!("{:?}", v.texture.function),
        "opaque": v.texture.opaque, "power": v.texture.power, "texture_scale": v.texture.scale_per_m,
        "tau": v.tau_per_m, "albedo": v.albedo.to_array(), "phase": v.phase.map(|f| [f.weight, f.g]),
    })
}

/// Checks the numbers of all volumes.
///
/// # Errors
/// The first outside its range.
pub fn check(volumes: &Vec<Volume>) -> Result<(), ParameterError> {
    parameter::check(&declared(), volumes)?;
    volumes.iter().try_for_each(check_volume)
}

fn check_volume(volume: &Volume) -> Result<(), ParameterError> {
    let center = volume.center;
    ParameterError::check(center.is_finite(), "volume", components(center), "must have a finite centre")?;
    let half = volume.half_extent_m;
    let is_good = half.to_array().iter().all(|h| (1e-4..=1e6).contains(h));
    ParameterError::check(is_good, "volume", components(half), "must have half extents of 0.0001 to 1000000 metres")?;
    if let Shape::Frustum { bottom, top } = volume.shape {
        let is_good = [bottom, top].iter().all(|r| (0.0..=1.0).contains(r)) && bottom.max(top) > 0.0;
        ParameterError::check(is_good, "volume", format!("{bottom},{top}"), "must have radii of 0 to 1, not both 0")?;
    }
    let [first, second] = volume.phase;
    let is_good = volume.phase.iter().all(|p| p.weight >= 0.0 && p.g.abs() < 1.0)
        && (first.weight + second.weight - 1.0).abs() < 1e-3;
    let text = format!("{},{},{},{}", first.weight, first.g, second.weight, second.g);
    let range = "must be weights of at least 0 that add up to 1, each with a g between -1 and 1";
    ParameterError::check(is_good, "phase", text, range)?;
    let offset = volume.texture.offset;
    let is_good = offset.to_array().iter().all(|o| o.abs() <= 1e4);
    ParameterError::check(is_good, "texture-offset", components(offset), "must be -10000 to 10000")?;
    match volume.texture.function {
        DensityFunction::Fog { front: f, .. } => {
            let text = [f.x_m, f.per_frame_m, f.depth_m, f.turbulence_m, f.table_m].map(|n| n.to_string()).join(",");
            ParameterError::check(f.depth_m > 0.0, "front", text, "must have a depth above 0")
        }
        DensityFunction::Hypertexture { amplitude, softness } => {
            let is_good = (0.0..=100.0).contains(&amplitude);
            ParameterError::check(is_good, "hypertexture", amplitude, "must move the surface by 0 to 100")?;
            let is_good = softness > 0.0 && softness <= 1.0;
            ParameterError::check(is_good, "hypertexture", softness, "must have a softness above 0 and at most 1")
        }
        _ => Ok(()),
    }
}

/// Refuses a number that was given and that none of the volumes has.
///
/// # Errors
/// [`Error::Input`], naming the first.
pub fn check_used(given: &Given, volumes: &Vec<Volume>) -> Result<(), Error> {
    let is_unused = |p: &&Parameter<Vec<Volume>>| given.has(p.name) && p.text(volumes).is_empty();
    let Some(name) = declared().iter().find(is_unused).map(|p| p.name) else { return Ok(()) };
    let missing = match name {
        "phase" => "volume of gas, and solids have normals instead",
        "frequency" => "clouds: give `density` clouds",
        "down" | "swirl-frames" | "ellipse" => "fog or steam: give `density` fog or steam",
        "full-fog" | "front" => "fog: give `density` fog",
        "hypertexture" => "hypertexture: give `density` hypertexture",
        "density" | "texture-scale" if !volumes.is_empty() => "density functions: leave out `volume-file`",
        _ => "volume: give `volume`",
    };
    Err(Error::Input(format!("`{name}`: the scene has no {missing}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_placement_is_a_shape_and_its_numbers() {
        let parse = |text: &str| Placement::parse(&[OsStr::new(text)]);
        let placement =
            |shape| Placement { shape, center: Vec3::new(0.0, 1.0, -2.0), half_extent_m: Vec3::new(0.5, 1.0, 2.0) };
        for (text, shape) in [
            ("box,0,1,-2,0.5,1,2", Shape::Box),
            ("sphere,0,1,-2,0.5,1,2", Shape::Sphere),
            ("cylinder,0,1,-2,0.5,1,2", Shape::Cylinder),
            ("frustum,0,1,-2,0.5,1,2,0.6,1", Shape::Frustum { bottom: 0.6, top: 1.0 }),
        ] {
            assert_eq!(parse(text), Ok(placement(shape)));
            assert_eq!(placement(shape).text(), text);
        }
        for text in ["", "box", "ball,0,0,0,1,1,1", "box,0,0,0,1,1", "frustum,0,0,0,1,1,1", "box,0,0,0,1,1,nan"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn each_number_is_set_and_read_in_the_templates() {
        for parameter in declared() {
            let mut volumes = templates();
            let value = match parameter.name {
                "density" => "fog",
                "ellipse" | "hypertexture" => "0.5,0.25",
                "front" => "1,2,3,4,5",
                "phase" => "0.5,0.25,0.5,0.75",
                _ => "0.375",
            };
            parameter.set(&mut volumes, &[OsStr::new(value)]).unwrap();
            assert_eq!(parameter.text(&volumes), value, "{}", parameter.name);
            let mut copied = templates();
            parameter.copy(&volumes, &mut copied);
            assert_eq!(copied, volumes, "{}", parameter.name);
        }
    }
}
