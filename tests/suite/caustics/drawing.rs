//! One frame of the paper on the device, with everything it drew read back.

use std::ops::RangeInclusive;
use std::sync::Arc;

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, Mode, PassSample, Recorder};
use fumarole::image::{Rgba8, Samples};
use fumarole::measure::picture::read_target;
use fumarole::measure::{Paper, Target};
use fumarole::papers::caustics::water::Grid;
use fumarole::papers::caustics::{Caustics, Parameters, ReceiverInput, Variant};

use crate::common::shaders_by;

/// The frame that is drawn: not the first, so that the water has moved.
pub const FRAME: u32 = 3;

pub struct Drawing {
    pub grid: Grid,
    pub picture: Rgba8,
    pub passes: Vec<PassSample>,
    /// Of each receiver under each light.
    pub plane_counts: Vec<usize>,
    /// Of the first receiver under the first light, by smart slicing alone.
    pub depth_profile: Option<Vec<u32>>,
    targets: Vec<(String, Vec<f32>)>,
}

impl Drawing {
    pub fn of(device: &Arc<Device>, variant: Variant, parameters: &Parameters, receivers: &[ReceiverInput]) -> Self {
        Self::compiled_by(Compiler::Glslang, device, variant, parameters, receivers)
    }

    pub fn compiled_by(
        compiler: Compiler,
        device: &Arc<Device>,
        variant: Variant,
        parameters: &Parameters,
        receivers: &[ReceiverInput],
    ) -> Self {
        Self::after(FRAME..=FRAME, compiler, device, variant, parameters, receivers)
    }

    /// The last of some frames, drawn one after the other.
    pub fn after(
        frames: RangeInclusive<u32>,
        compiler: Compiler,
        device: &Arc<Device>,
        variant: Variant,
        parameters: &Parameters,
        receivers: &[ReceiverInput],
    ) -> Self {
        parameters.validate().unwrap();
        let shaders = shaders_by(device, compiler);
        let mut paper = Caustics::new(&shaders, "test", variant, parameters, receivers).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let mut passes = Vec::new();
        for number in frames {
            let sample = recorder.run(Mode::Plain, |frame| paper.record_picture(frame, number)).unwrap();
            passes = sample.passes.clone();
        }
        let targets = paper.targets().into_iter().filter(|target| target.name != "picture");
        let picture = paper.picture();
        let pixels = read_image(device, picture).unwrap();
        Drawing {
            grid: paper.grid(),
            picture: Rgba8::new(picture.width(), picture.height(), pixels).unwrap(),
            passes,
            plane_counts: paper.plane_counts(),
            depth_profile: paper.depth_profile().map(<[u32]>::to_vec),
            targets: targets.map(|target| (target.name.clone(), read(device, &target))).collect(),
        }
    }

    /// Of its targets, but for the picture.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.targets.iter().map(|(name, _)| name.as_str())
    }

    /// The values of a target of `--dump`.
    pub fn target(&self, name: &str) -> &[f32] {
        let (_, values) = self.targets.iter().find(|(n, _)| n == name).unwrap();
        values
    }

    /// A map of one receiver under one light.
    pub fn map(&self, name: &str, light: usize, receiver: usize) -> &[f32] {
        match (light, receiver) {
            (0, 0) => self.target(name),
            _ => self.target(&format!("{name}.{light}.{receiver}")),
        }
    }

    /// # Panics
    /// When a target holds NaN or infinity.
    pub fn assert_finite(&self) {
        for (name, values) in &self.targets {
            let bad = values.iter().filter(|value| !value.is_finite()).count();
            assert_eq!(bad, 0, "{name}: values that are not finite");
        }
    }
}

/// The planes that smart slicing draws for each receiver under each light.
pub fn planes_drawn(device: &Arc<Device>, parameters: &Parameters, receivers: &[ReceiverInput]) -> Vec<usize> {
    let shaders = shaders_by(device, Compiler::Glslang);
    let mut paper = Caustics::new(&shaders, "test", Variant::LevelMapSmart, parameters, receivers).unwrap();
    Recorder::new(device).unwrap().run(Mode::Plain, |frame| paper.record(frame, FRAME)).unwrap();
    paper.plane_counts()
}

/// The values of a target, those of 8-bit ones as fractions of 1.
fn read(device: &Arc<Device>, target: &Target) -> Vec<f32> {
    match read_target(device, target).unwrap().samples() {
        Samples::F32(values) => values.clone(),
        Samples::U8(values) => values.iter().map(|&value| f32::from(value) / 255.0).collect(),
        _ => panic!("{} holds neither floats nor bytes", target.name),
    }
}
