//! One frame of the paper on the device, with what it drew read back.

use std::sync::Arc;

use fumarole::experiment::picture::read_target;
use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, Mode, Recorder, ShaderLibrary};
use fumarole::image::{Rgba8, Samples};
use fumarole::papers::Paper;
use fumarole::papers::terrain::{Hit, Inputs, MapInput, Parameters, Terrain, Variant};

pub struct Drawing {
    pub picture: Rgba8,
    /// Names of the passes, in order.
    pub passes: Vec<&'static str>,
    pub hits: Vec<Hit>,
    /// x, y, z, and the height above the base in metres.
    pub normals: Vec<[f32; 4]>,
}

impl Drawing {
    pub fn of(device: &Arc<Device>, variant: Variant, parameters: &Parameters, maps: &[MapInput]) -> Self {
        Self::with(device, variant, parameters, &Inputs { maps, ..Inputs::default() })
    }

    pub fn with(device: &Arc<Device>, variant: Variant, parameters: &Parameters, inputs: &Inputs<'_>) -> Self {
        Self::compiled_by(Compiler::Glslang, device, variant, parameters, inputs)
    }

    pub fn compiled_by(
        compiler: Compiler,
        device: &Arc<Device>,
        variant: Variant,
        parameters: &Parameters,
        inputs: &Inputs<'_>,
    ) -> Self {
        parameters.validate().unwrap();
        let shaders = ShaderLibrary::new(device, compiler, None).unwrap();
        let mut paper = Terrain::new(&shaders, "test", variant, parameters, inputs).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        let sample = recorder.run(Mode::Plain, |frame| paper.record_picture(frame, 0)).unwrap();
        let passes = sample.passes.iter().map(|pass| pass.info.name).collect();
        let picture = paper.picture();
        let pixels = read_image(device, picture).unwrap();
        let texels = |name: &str| {
            let target = paper.targets().into_iter().find(|target| target.name == name).unwrap();
            match read_target(device, &target).unwrap().samples() {
                Samples::F32(values) => values.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect::<Vec<_>>(),
                _ => panic!("{name} holds no floats"),
            }
        };
        Drawing {
            picture: Rgba8::new(picture.width(), picture.height(), pixels).unwrap(),
            passes,
            hits: texels("depth").into_iter().map(Hit::from_texel).collect(),
            normals: texels("normal"),
        }
    }
}

/// Pixels that saw different things: another surface, another depth by more than a thousandth, or another normal.
pub fn differing(a: &Drawing, b: &Drawing) -> usize {
    let pixels = a.hits.iter().zip(&b.hits).zip(a.normals.iter().zip(&b.normals));
    let differ = pixels.filter(|((a, b), (n, m))| {
        let is_same_depth = (a.depth_m - b.depth_m).abs() <= 1e-3 * a.depth_m.abs();
        let is_same_normal = (0..3).all(|i| (n[i] - m[i]).abs() < 0.02);
        a.surface != b.surface || !is_same_depth || !is_same_normal
    });
    differ.count()
}
