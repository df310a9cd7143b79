//! One frame of the paper on the device, with everything it drew read back.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::bindings::Resource;
use fumarole::gpu::transfer::{read_buffer, read_image};
use fumarole::gpu::{Compiler, Device, Error, Mode, PassSample, Recorder, ShaderLibrary};
use fumarole::image::Rgba8;
use fumarole::papers::Paper;
use fumarole::papers::caustics::water::Grid;
use fumarole::papers::caustics::{Caustics, Parameters, ReceiverInput, Variant};
use half::f16;

/// The frame that is drawn: not the first, so that the water has moved.
pub const FRAME: u32 = 3;

pub struct Drawing {
    pub grid: Grid,
    pub picture: Rgba8,
    pub passes: Vec<PassSample>,
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
        parameters.validate().unwrap();
        let shaders = ShaderLibrary::new(device, compiler, None).unwrap();
        let mut paper = Caustics::new(&shaders, "test", variant, parameters, receivers).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let sample = recorder.run(Mode::Plain, |frame| paper.record_picture(frame, FRAME)).unwrap();
        let passes = sample.passes.clone();
        let targets = paper.targets().into_iter().filter(|target| target.name != "picture");
        let picture = paper.picture();
        let pixels = read_image(device, picture).unwrap();
        Drawing {
            grid: paper.grid(),
            picture: Rgba8::new(picture.width(), picture.height(), pixels).unwrap(),
            passes,
            targets: targets.map(|target| (target.name, read(device, &target.resource).unwrap())).collect(),
        }
    }

    /// The values of a target of `--dump`.
    pub fn target(&self, name: &str) -> &[f32] {
        let (_, values) = self.targets.iter().find(|(n, _)| n == name).unwrap();
        values
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

fn read(device: &Arc<Device>, target: &Resource) -> Result<Vec<f32>, Error> {
    match target {
        Resource::Buffer(view) => Ok(bytemuck::pod_collect_to_vec(&read_buffer(device, view.buffer())?)),
        Resource::Image(view) => {
            let texels = read_image(device, view)?;
            Ok(match view.image().desc().format {
                vk::Format::R16G16B16A16_SFLOAT => {
                    bytemuck::pod_collect_to_vec::<u8, f16>(&texels).into_iter().map(f16::to_f32).collect()
                }
                vk::Format::R32_SFLOAT | vk::Format::D32_SFLOAT => bytemuck::pod_collect_to_vec(&texels),
                other => panic!("{}: {other:?} is no format of a map", target.name()),
            })
        }
        Resource::Sampler(_) => panic!("a sampler is no target"),
    }
}
