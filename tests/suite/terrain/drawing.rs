//! One frame of the paper on the device, with what it drew read back.

use std::sync::Arc;

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device, Mode, Recorder, ShaderLibrary};
use fumarole::image::{Rgba8, Samples};
use fumarole::measure::Paper;
use fumarole::measure::picture::read_target;
use fumarole::papers::terrain::{Hit, Inputs, MapInput, Parameters, Terrain, Variant, View};
use fumarole::scene::Camera;

use crate::common::shaders_by;

pub struct Drawing {
    pub picture: Rgba8,
    /// Names of the passes, in order.
    pub passes: Vec<&'static str>,
    pub hits: Vec<Hit>,
    /// x, y, z, and the height above the base in metres.
    pub normals: Vec<[f32; 4]>,
    /// The maps' shadow, 1 in the sunlight; empty where the variant has no such target.
    pub sunlit: Vec<f32>,
    /// Light that objects leave of it on the land, and on objects where `object_hits` has them; empty without.
    pub occlusion: Vec<f32>,
    pub object_hits: Vec<f32>,
    pub object_occlusion: Vec<f32>,
}

impl Drawing {
    pub fn of(device: &Arc<Device>, variant: Variant, parameters: &Parameters, maps: &[MapInput]) -> Self {
        Self::with(device, variant, parameters, &Inputs { maps, ..Inputs::default() })
    }

    pub fn with(device: &Arc<Device>, variant: Variant, parameters: &Parameters, inputs: &Inputs<'_>) -> Self {
        Painter::new(device, Compiler::Glslang, variant, parameters, inputs).draw()
    }
}

/// Draws one terrain from one place after the other.
pub struct Painter {
    device: Arc<Device>,
    shaders: Arc<ShaderLibrary>,
    pub paper: Terrain,
    recorder: Recorder,
}

impl Painter {
    pub fn new(
        device: &Arc<Device>,
        compiler: Compiler,
        variant: Variant,
        parameters: &Parameters,
        inputs: &Inputs<'_>,
    ) -> Self {
        parameters.validate().unwrap();
        let shaders = shaders_by(device, compiler);
        Painter {
            device: device.clone(),
            paper: Terrain::new(&shaders, "test", variant, parameters, inputs).unwrap(),
            shaders,
            recorder: Recorder::new(device).unwrap(),
        }
    }

    pub fn from(&mut self, camera: Camera) -> Drawing {
        self.paper.set_view(View::Camera(camera));
        self.draw()
    }

    pub fn draw(&mut self) -> Drawing {
        let Painter { device, shaders, paper, recorder } = self;
        let mut is_whole = paper.tiles().is_none();
        while !is_whole {
            recorder.run(Mode::Plain, |frame| paper.record(frame, 0)).unwrap();
            is_whole = paper.settle(shaders).unwrap();
        }
        let sample = recorder.run(Mode::Plain, |frame| paper.record_picture(frame, 0)).unwrap();
        let passes = sample.passes.iter().map(|pass| pass.info.name).collect();
        let picture = paper.picture();
        let pixels = read_image(device, picture).unwrap();
        let floats = |name: &str| {
            let target = paper.targets().into_iter().find(|target| target.name == name)?;
            match read_target(device, &target).unwrap().samples() {
                Samples::F32(values) => Some(values.clone()),
                _ => panic!("{name} holds no floats"),
            }
        };
        let texels = |name: &str| floats(name).unwrap().as_chunks::<4>().0.to_vec();
        Drawing {
            picture: Rgba8::new(picture.width(), picture.height(), pixels).unwrap(),
            passes,
            hits: texels("depth").into_iter().map(Hit::from_texel).collect(),
            normals: texels("normal"),
            sunlit: floats("shadow").unwrap_or_default(),
            occlusion: floats("occlusion").unwrap_or_default(),
            object_hits: floats("object-hits").unwrap_or_default(),
            object_occlusion: floats("object-occlusion").unwrap_or_default(),
        }
    }
}

/// Pixels that saw different things: another surface, another depth by more than a thousandth, another normal, or another
/// colour than normals so near can make.
pub fn differing(a: &Drawing, b: &Drawing) -> usize {
    let pixels = a.hits.iter().zip(&b.hits).zip(a.normals.iter().zip(&b.normals));
    let colors = a.picture.pixels().as_chunks::<4>().0.iter().zip(b.picture.pixels().as_chunks::<4>().0);
    let differ = pixels.zip(colors).filter(|(((a, b), (n, m)), (c, d))| {
        let is_same_depth = (a.depth_m - b.depth_m).abs() <= 1e-3 * a.depth_m.abs();
        let is_same_normal = (0..3).all(|i| (n[i] - m[i]).abs() < 0.02);
        let is_same_color = (0..4).all(|i| c[i].abs_diff(d[i]) <= 6);
        a.surface != b.surface || !is_same_depth || !is_same_normal || !is_same_color
    });
    differ.count()
}
