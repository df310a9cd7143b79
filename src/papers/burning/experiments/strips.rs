//! Picture strips: objects at several moments, as most figures of the dissertation show them.

use glam::Vec3;

use super::super::setup::Setup;
use super::presets::Preset;
use crate::image::Rgba8;
use crate::image::contact_sheet::{below_each_other, side_by_side};
use crate::measure::Error;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::papers::burning::{Parameters, Shading, Variant};
use crate::scene::MeshSource;

/// A row of pictures: one object by one method.
#[derive(Debug, Clone)]
pub struct Strip {
    pub setup: Setup,
    pub variant: Variant,
}

/// A figure of the dissertation: strips below each other, all at the same frames.
#[derive(Debug, Clone)]
pub struct Figure {
    pub name: &'static str,
    pub frames: Vec<u32>,
    pub strips: Vec<Strip>,
}

/// Figures in the dissertation's order.
pub const FIGURES: [&str; 11] = ["3.1", "3.2", "3.6", "3.8", "4.4", "4.5", "5.1", "5.2", "5.6", "6.1", "6.5"];

fn strip(setup: &Setup, variant: Variant, change: impl FnOnce(&mut Parameters)) -> Strip {
    let mut setup = setup.clone();
    setup.preset = None;
    // A strip holds several pictures.
    (setup.parameters.width, setup.parameters.height) = (320, 240);
    change(&mut setup.parameters);
    Strip { setup, variant }
}

impl Figure {
    /// The figure of that name.
    pub fn named(name: &str) -> Option<Figure> {
        let name = FIGURES.into_iter().find(|figure| *figure == name)?;
        let as_it_is = |_: &mut Parameters| {};
        let shell = Preset::Results38.setup();
        let of_mesh = |mesh: MeshSource| Setup { mesh, ..shell.clone() };
        let level = |level: u32| move |p: &mut Parameters| p.level_of_detail = Some(level);
        let (frames, strips) = match name {
            "3.1" => (vec![200, 340, 450, 560, 680], vec![strip(&shell, Variant::Shell, as_it_is)]),
            // One source, and three.
            "3.2" => {
                let areas = |sources: &[Vec3]| {
                    strip(&shell, Variant::Shell, |p| {
                        p.shading = Shading::Areas;
                        p.sources = sources.to_vec();
                        (p.fire, p.smoke) = (0, 0);
                    })
                };
                let three = [Vec3::new(-0.3, 0.0, 0.0), Vec3::new(0.3, 0.2, 0.0), Vec3::new(0.0, 0.6, 0.0)];
                (vec![60, 120, 240, 360, 480], vec![areas(&[]), areas(&three)])
            }
            // Without and with structural deformation.
            "3.6" => {
                let still = strip(&shell, Variant::Shell, |p| p.gamma = f32::MIN_POSITIVE);
                (vec![200, 340, 450, 560, 680], vec![still, strip(&shell, Variant::Shell, as_it_is)])
            }
            "3.8" => {
                let objects = [MeshSource::Teapot, MeshSource::Sphere, MeshSource::Bunny];
                let strips = objects.map(|mesh| strip(&of_mesh(mesh), Variant::Shell, as_it_is));
                (vec![200, 340, 450, 560, 680], strips.into())
            }
            // The hierarchy, and what it looks like.
            "4.4" => {
                let setup = Preset::Box.setup();
                let wire = strip(&setup, Variant::LowPoly, |p| {
                    p.shading = Shading::Wire;
                    (p.fire, p.smoke) = (0, 0);
                });
                (vec![60, 240, 420, 720, 1080], vec![wire, strip(&setup, Variant::LowPoly, as_it_is)])
            }
            // Finer to coarser.
            "4.5" => {
                let setup = Preset::Box.setup();
                let strips = [5, 3, 2].map(|l| strip(&setup, Variant::LowPoly, level(l)));
                (vec![240, 420, 720, 900], strips.into())
            }
            "5.1" => {
                let shell = strip(&shell, Variant::Shell, as_it_is);
                let solid = strip(&shell.setup, Variant::Solid, as_it_is);
                (vec![240, 420, 520, 640], vec![shell, solid])
            }
            "5.2" => (vec![60, 240, 420, 720, 1080], vec![strip(&Preset::Solid45k.setup(), Variant::Solid, as_it_is)]),
            // A block of wood of few triangles, divided as far as its level of detail.
            "5.6" => {
                let mut setup = Preset::Solid45k.setup();
                setup.triangles = None;
                setup.parameters.edge = 0.04;
                let strips = [5, 4, 3].map(|l| strip(&setup, Variant::Solid, level(l)));
                (vec![240, 420, 720, 1080], strips.into())
            }
            "6.1" => (vec![0, 600], vec![strip(&Preset::Melt40k.setup(), Variant::Melting, as_it_is)]),
            _ => {
                let wax = strip(&Preset::Melt40k.setup(), Variant::Melting, as_it_is);
                (vec![120, 360, 540, 660, 780], vec![wax])
            }
        };
        Some(Figure { name, frames, strips })
    }

    /// Draws the figure.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
    pub fn draw(&self, machine: &mut Machine) -> Result<Rgba8, Error> {
        let mut rows = Vec::new();
        for Strip { setup, variant } in &self.strips {
            let scene = setup.load()?;
            let mut paper = build(machine, setup, &scene, *variant)?.paper;
            let pictures = self.frames.iter().map(|&frame| picture::render(machine, &mut paper, frame));
            rows.push(side_by_side(&pictures.collect::<Result<Vec<_>, _>>()?)?);
        }
        Ok(below_each_other(&rows)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_its_strips() {
        for name in FIGURES {
            let figure = Figure::named(name).unwrap();
            assert_eq!(figure.name, name);
            assert!(figure.frames.is_sorted_by(|a, b| a < b) && !figure.strips.is_empty(), "{name}");
            for strip in &figure.strips {
                strip.setup.check().unwrap();
            }
        }
        assert!(Figure::named("3.3").is_none());
    }
}
