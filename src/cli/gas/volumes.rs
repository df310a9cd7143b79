//! The options of the gases: where there are some, their density functions, and what they do to light.

use clap::{Args, ValueEnum};
use glam::Vec3;

use crate::cli::failure::Failure;
use crate::cli::options::{parse_finite, parse_numbers, set};
use crate::papers::gas::model::{DensityFunction, Front, HenyeyGreenstein, Shape, Swirl, Volume};
use crate::papers::gas::parameters::default_volume;
use crate::papers::gas::scenes;

/// Density functions, with the numbers of the figures that they come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DensityWord {
    /// The same everywhere
    Constant,
    /// Turbulence (1985)
    Turbulence,
    /// A sine wave through the turbulent space
    Clouds,
    /// Figure 7's fog behind its front, moved along a helix as the frames go on
    Fog,
    /// Figures 6 and 8's steam, which rises and thins with its height
    Steam,
    /// A soft ball whose surface the turbulence moves
    Hypertexture,
}

/// A solid that bounds a gas.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    shape: Shape,
    center: Vec3,
    half_extent_m: Vec3,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Gases")]
pub struct VolumeArgs {
    /// One more volume beside the scene's: box, sphere, cylinder or frustum, its centre and half extents in metres (0.0001 to
    /// 1000000), and of a frustum the radii at the bottom and at the top as shares of the half extents, 0 to 1; filled as the
    /// scene's first volume, or with turbulence; repeatable, up to 8 volumes
    #[arg(long, value_name = "SHAPE,X,Y,Z,X,Y,Z[,B,T]", value_parser = parse_place, allow_hyphen_values = true)]
    volume: Vec<Place>,
    /// Density function of all volumes [default: the scene's]
    #[arg(long, value_enum)]
    density: Option<DensityWord>,
    /// Factor of all volumes' density (the paper's opaque), 0 to 1000000 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    opaque: Option<f32>,
    /// Exponent of all volumes' density, above 0 and at most 100 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    power: Option<f32>,
    /// Texture units a metre of all volumes, 0.0001 to 10000 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    texture_scale: Option<f32>,
    /// Of clouds: frequency of the sine wave, -10000 to 10000 [default: 4]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    frequency: Option<f32>,
    /// Of fog and steam: texture units that the gas moves a frame, -10000 to 10000 (DOWN) [default: the figure's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    down: Option<f32>,
    /// Of fog and steam: frames of a turn of the helix, 0 (no turns) to 10000 (SWIRL_FRAMES) [default: the figure's]
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_negative_numbers = true)]
    swirl_frames: Option<f32>,
    /// Of fog and steam: diameters of the helix, texture units, -10000 to 10000 (ELLIPSE1, ELLIPSE2) [default: the figure's]
    #[arg(long, value_name = "F,F", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    ellipse: Option<[f32; 2]>,
    /// Of fog: frames until it is at its thickest, 0 (at once) to 1000000 (FULL_FOG) [default: 0]
    #[arg(long, value_name = "N", value_parser = parse_finite, allow_negative_numbers = true)]
    full_fog: Option<f32>,
    /// Of fog: the front's x in metres at frame 0, metres a frame, metres behind it until the fog is thickest (above 0), metres
    /// by which a turbulence of 1 moves it, and a random number of 1; each -1000000 to 1000000 [default: figure 7's]
    #[arg(long, value_name = "X,STEP,DEPTH,T,R", value_parser = parse_numbers::<5>, allow_hyphen_values = true)]
    front: Option<[f32; 5]>,
    /// Of hypertexture: share of the radius by which turbulence moves the surface, 0 to 100, and over which it turns dense,
    /// above 0 and at most 1 [default: 1.4,0.16]
    #[arg(long, value_name = "NOISE,SOFTNESS", value_parser = parse_numbers::<2>, allow_hyphen_values = true)]
    hypertexture: Option<[f32; 2]>,
    /// Optical depth of density 1, per metre, of all volumes, 0 to 1000000 [default: the scene's]
    #[arg(long, value_name = "TAU", value_parser = parse_finite, allow_negative_numbers = true)]
    tau: Option<f32>,
    /// Albedo of all volumes, 0 to 1 [default: the scene's]
    #[arg(long, value_name = "A", value_parser = parse_finite, allow_negative_numbers = true)]
    albedo: Option<f32>,
    /// Two Henyey-Greenstein functions of all gases: weight,g,weight,g; weights add up to 1, g between -1 and 1
    /// [default: 0.8,0.5,0.2,-0.3]
    #[arg(long, value_name = "W,G,W,G", value_parser = parse_numbers::<4>, allow_hyphen_values = true)]
    phase: Option<[f32; 4]>,
    /// Share of the way from the boundary to the middle over which all volumes fade, 0 to 1 [default: the scene's]
    #[arg(long, value_name = "F", value_parser = parse_finite, allow_negative_numbers = true)]
    falloff: Option<f32>,
}

impl VolumeArgs {
    /// Adds the volumes that were typed, and puts what was typed over the numbers of all.
    pub fn over(&self, volumes: &mut Vec<Volume>) {
        let first = volumes.first().copied().unwrap_or_else(default_volume);
        volumes.extend(self.volume.iter().map(|&Place { shape, center, half_extent_m }| Volume {
            shape,
            center,
            half_extent_m,
            ..first
        }));
        for volume in volumes {
            set(&mut volume.texture.function, self.density.map(function));
            set(&mut volume.texture.opaque, self.opaque);
            set(&mut volume.texture.power, self.power);
            set(&mut volume.texture.scale_per_m, self.texture_scale);
            self.over_function(&mut volume.texture.function);
            set(&mut volume.tau_per_m, self.tau);
            set(&mut volume.albedo, self.albedo.map(Vec3::splat));
            set(&mut volume.falloff, self.falloff);
            if let Some([w0, g0, w1, g1]) = self.phase {
                volume.phase = [HenyeyGreenstein { weight: w0, g: g0 }, HenyeyGreenstein { weight: w1, g: g1 }];
            }
        }
    }

    fn over_function(&self, function: &mut DensityFunction) {
        match function {
            DensityFunction::Constant | DensityFunction::Turbulence => {}
            DensityFunction::Clouds { frequency } => set(frequency, self.frequency),
            DensityFunction::Fog { swirl, front } => {
                self.over_swirl(swirl);
                if let Some([x_m, per_frame_m, depth_m, turbulence_m, table_m]) = self.front {
                    *front = Front { x_m, per_frame_m, depth_m, turbulence_m, table_m, ..*front };
                }
                set(&mut front.full_frames, self.full_fog);
            }
            DensityFunction::Steam { swirl } => self.over_swirl(swirl),
            DensityFunction::Hypertexture { amplitude, softness } => {
                set(amplitude, self.hypertexture.map(|[noise, _]| noise));
                set(softness, self.hypertexture.map(|[_, soft]| soft));
            }
        }
    }

    fn over_swirl(&self, swirl: &mut Swirl) {
        set(&mut swirl.along_per_frame, self.down);
        set(&mut swirl.frames, self.swirl_frames);
        set(&mut swirl.ellipse, self.ellipse);
    }

    /// Checks that some volume of the scenes, as [`VolumeArgs::over`] left them, heeds each option.
    ///
    /// # Errors
    /// [`Failure::Input`], naming the first option that nothing heeds.
    pub fn check<'a>(&self, volumes: impl Iterator<Item = &'a Volume>) -> Result<(), Failure> {
        let volumes: Vec<&Volume> = volumes.collect();
        let functions: Vec<DensityFunction> = volumes.iter().map(|v| v.texture.function).collect();
        let has_gas = volumes.iter().any(|v| !v.is_solid);
        let has_clouds = functions.iter().any(|f| matches!(f, DensityFunction::Clouds { .. }));
        let has_fog = functions.iter().any(|f| matches!(f, DensityFunction::Fog { .. }));
        let has_steam = functions.iter().any(|f| matches!(f, DensityFunction::Steam { .. }));
        let has_hypertexture = functions.iter().any(|f| matches!(f, DensityFunction::Hypertexture { .. }));
        let given = [
            (self.density.is_some(), "--density"),
            (self.opaque.is_some(), "--opaque"),
            (self.power.is_some(), "--power"),
            (self.texture_scale.is_some(), "--texture-scale"),
            (self.tau.is_some(), "--tau"),
            (self.albedo.is_some(), "--albedo"),
            (self.falloff.is_some(), "--falloff"),
        ];
        let unheeded =
            given.map(|(is_given, option)| (is_given && volumes.is_empty(), option, "volume: give --volume"));
        let moving = "fog or steam: give --density fog or steam";
        let of_functions = [
            (self.phase.is_some() && !has_gas, "--phase", "volume of gas, and solids have normals instead"),
            (self.frequency.is_some() && !has_clouds, "--frequency", "clouds: give --density clouds"),
            (self.down.is_some() && !has_fog && !has_steam, "--down", moving),
            (self.swirl_frames.is_some() && !has_fog && !has_steam, "--swirl-frames", moving),
            (self.ellipse.is_some() && !has_fog && !has_steam, "--ellipse", moving),
            (self.full_fog.is_some() && !has_fog, "--full-fog", "fog: give --density fog"),
            (self.front.is_some() && !has_fog, "--front", "fog: give --density fog"),
            (
                self.hypertexture.is_some() && !has_hypertexture,
                "--hypertexture",
                "hypertexture: give --density hypertexture",
            ),
        ];
        match unheeded.into_iter().chain(of_functions).find(|(is_unheeded, ..)| *is_unheeded) {
            Some((_, option, lacks)) => Err(Failure::Input(format!("{option}: the scene has no {lacks}"))),
            None => Ok(()),
        }
    }

    /// Whether [`VolumeArgs::over`] adds volumes.
    pub fn adds_volumes(&self) -> bool {
        !self.volume.is_empty()
    }

    /// Whether [`VolumeArgs::over`] changes the density function.
    pub fn names_density(&self) -> bool {
        self.density.is_some()
    }
}

fn function(word: DensityWord) -> DensityFunction {
    match word {
        DensityWord::Constant => DensityFunction::Constant,
        DensityWord::Turbulence => DensityFunction::Turbulence,
        DensityWord::Clouds => DensityFunction::Clouds { frequency: 4.0 },
        DensityWord::Fog => scenes::FOG,
        DensityWord::Steam => scenes::STEAM,
        DensityWord::Hypertexture => scenes::HYPERTEXTURE,
    }
}

/// `frustum,0,1,0,0.5,1,0.5,0.6,1` and its like.
fn parse_place(text: &str) -> Result<Place, String> {
    let (word, numbers) = text.split_once(',').ok_or("give a shape and its numbers, as box,0,1,0,0.5,1,0.5")?;
    let (shape, [x, y, z, half_x, half_y, half_z]) = match word {
        "box" => (Shape::Box, parse_numbers(numbers)?),
        "sphere" => (Shape::Sphere, parse_numbers(numbers)?),
        "cylinder" => (Shape::Cylinder, parse_numbers(numbers)?),
        "frustum" => {
            let [x, y, z, half_x, half_y, half_z, bottom, top] = parse_numbers(numbers)?;
            (Shape::Frustum { bottom, top }, [x, y, z, half_x, half_y, half_z])
        }
        _ => return Err(format!("{word:?} is no shape: give box, sphere, cylinder or frustum")),
    };
    Ok(Place { shape, center: Vec3::new(x, y, z), half_extent_m: Vec3::new(half_x, half_y, half_z) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_a_shape_and_its_numbers() {
        let place = |shape| Place { shape, center: Vec3::new(0.0, 1.0, -2.0), half_extent_m: Vec3::new(0.5, 1.0, 2.0) };
        assert_eq!(parse_place("box,0,1,-2,0.5,1,2"), Ok(place(Shape::Box)));
        assert_eq!(parse_place("sphere,0,1,-2,0.5,1,2"), Ok(place(Shape::Sphere)));
        assert_eq!(parse_place("cylinder,0,1,-2,0.5,1,2"), Ok(place(Shape::Cylinder)));
        let frustum = Shape::Frustum { bottom: 0.6, top: 1.0 };
        assert_eq!(parse_place("frustum,0,1,-2,0.5,1,2,0.6,1"), Ok(place(frustum)));
        for text in ["", "box", "ball,0,0,0,1,1,1", "box,0,0,0,1,1", "frustum,0,0,0,1,1,1", "box,0,0,0,1,1,nan"] {
            assert!(parse_place(text).is_err(), "{text}");
        }
    }
}
