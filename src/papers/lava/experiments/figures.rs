//! The thesis's figures: textures of one frame, and pictures of it by other colours, cameras and splats.

use super::super::setup::Setup;
use crate::image::{Raster, Rgba8, Samples, Shape};
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Given;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::papers::lava::{CAMERAS, Parameters, Shading, Variant};

/// A part of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// A texture of the frame, by its target's name.
    Texture(&'static str),
    /// The picture, coloured by one thing.
    Shaded(Shading),
    /// The picture with splats of this radius in metres.
    Splats(f32),
    /// The heights of the normal/height texture as grey, the height of the space white.
    Heights,
    /// The rock texture itself.
    Rock,
}

/// A figure of the thesis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// Name on the command line.
    pub name: &'static str,
    /// One line on it.
    pub help: &'static str,
    /// Each with what its file is called after the figure; nothing for a figure of one part.
    parts: &'static [(&'static str, Part)],
}

const fn figure(name: &'static str, help: &'static str, parts: &'static [(&'static str, Part)]) -> Figure {
    Figure { name, help, parts }
}

/// In the thesis's order.
pub const FIGURES: [Figure; 16] = {
    use Part::{Heights, Rock, Shaded, Splats, Texture};
    const PICTURE: &[(&str, Part)] = &[("", Shaded(Shading::Lava))];
    [
        figure(
            "fig-4.1",
            "Figure 4.1: the position and the velocity texture",
            &[("-position", Texture("positions")), ("-velocity", Texture("velocities"))],
        ),
        figure(
            "fig-4.2",
            "Figure 4.2: the density texture, the normal/height texture, the heights as colour",
            &[("a-density", Texture("density")), ("b-normal-height", Texture("normal-height")), ("c-heights", Heights)],
        ),
        figure(
            "fig-4.3",
            "Figure 4.3: the depth texture, the calculated colour and the rock, the lava",
            &[
                ("a-depth", Texture("visibility")),
                ("b-color", Shaded(Shading::Color)),
                ("b-rock", Rock),
                ("c-lava", Shaded(Shading::Lava)),
            ],
        ),
        figure("fig-5.1", "Figure 5.1: the texture of 65,536 particles", &[("", Texture("positions"))]),
        figure("fig-5.2", "Figure 5.2: the particles as points", &[("", Shaded(Shading::Particles))]),
        figure("fig-6.2", "Figure 6.2: a density texture", &[("", Texture("density"))]),
        figure(
            "fig-6.3",
            "Figure 6.3: the normal/height texture, and its heights as colour",
            &[("-normal-height", Texture("normal-height")), ("-heights", Heights)],
        ),
        figure(
            "fig-6.4",
            "Figure 6.4: normals and heights on the lava's surface",
            &[("-normals", Shaded(Shading::Normals)), ("-heights", Shaded(Shading::Heights))],
        ),
        figure("fig-7.1", "Figure 7.1: the depth texture of the visibility pass", &[("", Texture("visibility"))]),
        figure("fig-7.2", "Figure 7.2: the rock texture", &[("", Rock)]),
        figure(
            "fig-7.3",
            "Figure 7.3: the calculated colours, and with the rock",
            &[("-color", Shaded(Shading::Color)), ("-lava", Shaded(Shading::Lava))],
        ),
        figure("fig-8.1", "Figure 8.1: the lava from the side", PICTURE),
        figure("fig-8.2", "Figure 8.2: the lava, second camera", PICTURE),
        figure("fig-8.3", "Figure 8.3: the lava, third camera", PICTURE),
        figure("fig-8.4", "Figure 8.4: the lava, fourth camera", PICTURE),
        figure(
            "fig-8.5",
            "Figure 8.5: four splat sizes",
            &[
                ("-0.001875", Splats(0.001875)),
                ("-0.004375", Splats(0.004375)),
                ("-0.008125", Splats(0.008125)),
                ("-0.020625", Splats(0.020625)),
            ],
        ),
    ]
};

/// A drawn part.
pub enum Drawn {
    Picture(Rgba8),
    /// A texture, scaled to be looked at.
    Texture(Raster),
}

/// Drawn parts with what their files are called.
pub type Parts = Vec<(&'static str, Drawn)>;

impl Figure {
    /// Takes the figure's numbers where the user gave none; its own camera for the figures of chapter 8.
    pub fn set_up(&self, setup: &mut Setup, given: &Given) {
        let p = &mut setup.parameters;
        if ["fig-5.1", "fig-5.2", "fig-6.2"].contains(&self.name) {
            let figure = Parameters::of_figure_6_2();
            set_unless(given.has("particles"), &mut p.particles, figure.particles);
            set_unless(given.has("radius"), &mut p.radius_m, figure.radius_m);
            set_unless(given.has("density"), &mut p.density, figure.density);
        }
        if let Some((_, camera)) = CAMERAS.iter().find(|(name, _)| *name == self.name) {
            set_unless(given.has("camera"), &mut p.camera, *camera);
        }
    }

    /// The set-up of each part.
    fn setups<'a>(&self, setup: &'a Setup) -> impl Iterator<Item = Setup> + use<'a> {
        self.parts.iter().map(move |(_, part)| {
            let mut setup = setup.clone();
            match *part {
                Part::Texture(_) | Part::Heights | Part::Rock => {}
                Part::Shaded(shading) => setup.parameters.shading = shading,
                Part::Splats(radius_m) => setup.parameters.splat_radius_m = radius_m,
            }
            setup
        })
    }

    /// Checks every part before the first is drawn.
    ///
    /// # Errors
    /// As [`Setup::check`].
    pub fn check(&self, setup: &Setup) -> Result<(), Error> {
        self.setups(setup).try_for_each(|setup| setup.check())
    }

    /// Draws the parts from frame `number` of `setup`, each with what its file is called.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
    pub fn draw(&self, machine: &mut Machine, setup: &Setup, number: u32) -> Result<Parts, Error> {
        let scene = setup.load()?;
        let mut parts = Vec::new();
        for (&(suffix, part), setup) in self.parts.iter().zip(self.setups(setup)) {
            setup.check()?;
            if part == Part::Rock {
                parts.push((suffix, Drawn::Picture(scene.rock.picture()?)));
                continue;
            }
            let mut built = build(machine, &setup, &scene, Variant::Paper)?;
            let picture = picture::render(machine, &mut built.paper, number)?;
            let targets = built.paper.targets();
            let texture = match part {
                Part::Texture(name) => targets.iter().find(|t| t.name == name),
                Part::Heights => targets.iter().find(|t| t.name == "normal-height"),
                _ => None,
            };
            let texture = texture.map(|target| picture::read_target(&machine.device, target)).transpose()?;
            parts.push(match texture {
                Some(texture) if part == Part::Heights => {
                    (suffix, Drawn::Texture(heights(texture, setup.parameters.space_m.y)?))
                }
                Some(texture) => (suffix, Drawn::Texture(visible(texture)?)),
                None => (suffix, Drawn::Picture(picture)),
            });
        }
        Ok(parts)
    }
}

fn set_unless<T>(is_given: bool, value: &mut T, of_figure: T) {
    if !is_given {
        *value = of_figure;
    }
}

/// The last of four channels over `highest`.
fn heights(texture: Raster, highest: f32) -> Result<Raster, Error> {
    match (texture.shape(), texture.samples()) {
        (Shape::Image { layers, height, width, channels: 4 }, Samples::F32(values)) => {
            let shown: Vec<f32> = values.iter().skip(3).step_by(4).map(|height| height / highest).collect();
            Ok(Raster::image(width, height, 1, layers, shown)?)
        }
        _ => Ok(texture),
    }
}

/// A texture with its values where a picture shows them: several channels as fractions of their largest value; of a
/// depth, the background as far as the farthest surface.
fn visible(texture: Raster) -> Result<Raster, Error> {
    let (Shape::Image { layers, height, width, channels }, Samples::F32(values)) = (texture.shape(), texture.samples())
    else {
        return Ok(texture);
    };
    let largest_below = |limit: f32| values.iter().copied().filter(|&v| v < limit).fold(0.0, f32::max);
    let shown: Vec<f32> = if channels == 1 {
        let farthest = largest_below(1.0);
        values.iter().map(|v| v.min(farthest)).collect()
    } else {
        let largest = largest_below(f32::INFINITY).max(f32::MIN_POSITIVE);
        values.iter().map(|v| v / largest).collect()
    };
    Ok(Raster::image(width, height, channels, layers, shown)?)
}
