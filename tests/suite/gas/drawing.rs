//! One frame of the paper on the device, with what it drew read back.

use std::sync::Arc;

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, Error, Mode, Recorder, ShaderLibrary};
use fumarole::image::{Rgba8, Samples};
use fumarole::measure::Paper;
use fumarole::measure::picture::read_target;
use fumarole::papers::gas::model::Object;
use fumarole::papers::gas::{Capacity, Fragment, Gas, Parameters, Variant};
use glam::{DVec3, Vec3};

use crate::common::shaders_by;

pub struct Drawing {
    /// Of each pixel, four floats.
    pub radiance: Vec<f32>,
    /// Of each pixel, sorted.
    pub lists: Vec<Vec<Fragment>>,
    pub demand: Capacity,
    /// Numbers of the triangles of each tile; none without tiles.
    pub tiles: Vec<Vec<u32>>,
    /// Pixels that a k-buffer says it shows less of than there is; nothing without one.
    pub lost_pixels: Option<u32>,
    /// Evaluations of the density along the viewer's rays; 0 of a picture in several bands.
    pub evaluations: u64,
    pub picture: Rgba8,
    /// Times that the frame was recorded until lists and dispatches were enough.
    pub runs: u32,
    targets: Vec<(String, Vec<f32>)>,
}

impl Drawing {
    pub fn of(device: &Arc<Device>, variant: Variant, parameters: &Parameters, objects: &[Object]) -> Self {
        Self::frame(device, Compiler::Glslang, variant, parameters, objects, 0)
    }

    pub fn frame(
        device: &Arc<Device>,
        compiler: Compiler,
        variant: Variant,
        parameters: &Parameters,
        objects: &[Object],
        number: u32,
    ) -> Self {
        Self::tried_frame(&shaders_by(device, compiler), variant, parameters, objects, number).unwrap()
    }

    /// As [`Drawing::of`], or the error of the drawing.
    pub fn tried(
        device: &Arc<Device>,
        variant: Variant,
        parameters: &Parameters,
        objects: &[Object],
    ) -> Result<Self, Error> {
        Self::tried_frame(&shaders_by(device, Compiler::Glslang), variant, parameters, objects, 0)
    }

    /// By these shaders.
    pub fn tried_frame(
        shaders: &ShaderLibrary,
        variant: Variant,
        parameters: &Parameters,
        objects: &[Object],
        number: u32,
    ) -> Result<Self, Error> {
        parameters.validate().unwrap();
        let device = shaders.device();
        let mut gas = Gas::new(shaders, "test", variant, parameters, objects, None).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut runs = 0;
        loop {
            runs += 1;
            recorder.run(Mode::Plain, |frame| gas.record_picture(frame, number))?;
            if gas.settle(shaders)? {
                break;
            }
        }
        let targets: Vec<(String, Vec<f32>)> = gas
            .targets()
            .into_iter()
            .filter(|t| t.name != "picture" && t.name != "light-attenuations")
            .map(|t| match read_target(device, &t).unwrap().samples() {
                Samples::F32(values) => (t.name.clone(), values.clone()),
                _ => panic!("{} holds no floats", t.name),
            })
            .collect();
        let radiance = targets.iter().find(|(n, _)| n == "radiance").unwrap().1.clone();
        let view = gas.picture();
        let picture = Rgba8::new(view.width(), view.height(), read_image(device, view).unwrap()).unwrap();
        Ok(Drawing {
            radiance,
            lists: gas.fragments(shaders).unwrap(),
            demand: gas.demand(shaders).unwrap(),
            tiles: gas.tiles(shaders).unwrap(),
            lost_pixels: gas.lost_pixels(),
            evaluations: gas.evaluations(shaders).unwrap().unwrap_or_default(),
            picture,
            runs,
            targets,
        })
    }

    /// The values of a target of `--dump`.
    pub fn target(&self, name: &str) -> &[f32] {
        &self.targets.iter().find(|(n, _)| n == name).unwrap().1
    }

    /// The entries of a table, beside each of which that stands which is after it in x: of a row's last one the first.
    pub fn entries(&self, name: &str, size: usize) -> Vec<f32> {
        let pairs: Vec<&[f32]> = self.target(name).chunks_exact(2).collect();
        for row in pairs.chunks_exact(size) {
            assert!((0..size).all(|x| row[x][1].to_bits() == row[(x + 1) % size][0].to_bits()), "{name}");
        }
        pairs.iter().map(|pair| pair[0]).collect()
    }

    /// Linear RGB of a pixel.
    pub fn color(&self, pixel: usize) -> DVec3 {
        Vec3::from_slice(&self.radiance[4 * pixel..4 * pixel + 3]).as_dvec3()
    }

    /// Red of a pixel.
    pub fn red(&self, pixel: usize) -> f64 {
        f64::from(self.radiance[4 * pixel])
    }
}
