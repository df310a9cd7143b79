//! Contact sheets: objects at several moments, as most figures of the dissertation show them.

use glam::Vec3;

use super::super::setup::Setup;
use super::presets::{BOX, MELT_40K, RESULTS_3_8, SOLID_45K};
use crate::image::Rgba8;
use crate::image::contact_sheet::{below_each_other, side_by_side};
use crate::measure::Error;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Choice;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::papers::burning::{Parameters, Shading, Variant};
use crate::scene::MeshSource;

/// A row of pictures: one object by one method.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// The model and its constants.
    pub setup: Setup,
    /// Variant that is drawn.
    pub variant: Variant,
}

/// A figure of the dissertation: rows below each other, all at the same frames.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name of its file.
    pub name: &'static str,
    /// Frames that are drawn, ascending.
    pub frames: Vec<u32>,
    /// Sheets of one file.
    pub sheets: Vec<Sheet>,
}

/// The number of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureName(&'static str);

impl Choice for FigureName {
    const ALL: &'static [Self] = &[
        FigureName("3.1"),
        FigureName("3.2"),
        FigureName("3.6"),
        FigureName("3.8"),
        FigureName("4.4"),
        FigureName("4.5"),
        FigureName("5.1"),
        FigureName("5.2"),
        FigureName("5.6"),
        FigureName("6.1"),
        FigureName("6.5"),
    ];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("3.1", "A shell that burns"),
        ("3.2", "Heat boundaries of one source and of three"),
        ("3.6", "Without and with structural deformation"),
        ("3.8", "Three shells"),
        ("4.4", "The refinement pattern, and the picture that it makes"),
        ("4.5", "Levels of detail"),
        ("5.1", "A shell and a solid"),
        ("5.2", "A block of wood"),
        ("5.6", "Levels of detail of a solid"),
        ("6.1", "Wax before and after"),
        ("6.5", "Wax that melts"),
    ];
}

fn sheet(setup: &Setup, variant: Variant, change: impl FnOnce(&mut Parameters)) -> Sheet {
    let mut setup = setup.clone();
    setup.preset = None;
    // A sheet holds several pictures.
    (setup.parameters.width, setup.parameters.height) = (320, 240);
    change(&mut setup.parameters);
    Sheet { setup, variant }
}

impl FigureName {
    /// The figure of that number.
    pub fn figure(self) -> Figure {
        let FigureName(name) = self;
        let as_it_is = |_: &mut Parameters| {};
        let shell = RESULTS_3_8.setup();
        let of_mesh = |mesh: MeshSource| Setup { mesh, ..shell.clone() };
        let level = |level: u32| move |p: &mut Parameters| p.level_of_detail = Some(level);
        let (frames, sheets) = match name {
            "3.1" => (vec![200, 340, 450, 560, 680], vec![sheet(&shell, Variant::Shell, as_it_is)]),
            // One source, and three.
            "3.2" => {
                let areas = |sources: &[Vec3]| {
                    sheet(&shell, Variant::Shell, |p| {
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
                let still = sheet(&shell, Variant::Shell, |p| p.gamma = f32::MIN_POSITIVE);
                (vec![200, 340, 450, 560, 680], vec![still, sheet(&shell, Variant::Shell, as_it_is)])
            }
            "3.8" => {
                let objects = [MeshSource::Teapot, MeshSource::Sphere, MeshSource::Bunny];
                let sheets = objects.map(|mesh| sheet(&of_mesh(mesh), Variant::Shell, as_it_is));
                (vec![200, 340, 450, 560, 680], sheets.into())
            }
            // The hierarchy, and what it snapshots like.
            "4.4" => {
                let setup = BOX.setup();
                let wire = sheet(&setup, Variant::LowPoly, |p| {
                    p.shading = Shading::Wire;
                    (p.fire, p.smoke) = (0, 0);
                });
                (vec![60, 240, 420, 720, 1080], vec![wire, sheet(&setup, Variant::LowPoly, as_it_is)])
            }
            // Finer to coarser.
            "4.5" => {
                let setup = BOX.setup();
                let sheets = [5, 3, 2].map(|l| sheet(&setup, Variant::LowPoly, level(l)));
                (vec![240, 420, 720, 900], sheets.into())
            }
            "5.1" => {
                let shell = sheet(&shell, Variant::Shell, as_it_is);
                let solid = sheet(&shell.setup, Variant::Solid, as_it_is);
                (vec![240, 420, 520, 640], vec![shell, solid])
            }
            "5.2" => (vec![60, 240, 420, 720, 1080], vec![sheet(&SOLID_45K.setup(), Variant::Solid, as_it_is)]),
            // A block of wood of few triangles, divided as far as its level of detail.
            "5.6" => {
                let mut setup = SOLID_45K.setup();
                setup.triangles = None;
                setup.parameters.edge = 0.04;
                let sheets = [5, 4, 3].map(|l| sheet(&setup, Variant::Solid, level(l)));
                (vec![240, 420, 720, 1080], sheets.into())
            }
            "6.1" => (vec![0, 600], vec![sheet(&MELT_40K.setup(), Variant::Melting, as_it_is)]),
            _ => {
                let wax = sheet(&MELT_40K.setup(), Variant::Melting, as_it_is);
                (vec![120, 360, 540, 660, 780], vec![wax])
            }
        };
        Figure { name, frames, sheets }
    }
}

impl Figure {
    /// Draws the figure.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
    pub fn draw(&self, machine: &mut Machine) -> Result<Rgba8, Error> {
        let mut rows = Vec::new();
        for Sheet { setup, variant } in &self.sheets {
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
    fn every_figure_has_its_sheets() {
        for (name, (text, _)) in FigureName::ALL.iter().zip(FigureName::NAMES) {
            let figure = name.figure();
            assert_eq!(figure.name, *text);
            assert!(figure.frames.is_sorted_by(|a, b| a < b) && !figure.sheets.is_empty(), "{text}");
            for sheet in &figure.sheets {
                sheet.setup.check().unwrap();
            }
        }
    }
}
