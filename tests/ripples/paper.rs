//! `ripples`: a wave over a line of columns; the smallest paper that has all that a paper has.

use std::f64::consts::TAU;
use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    self, Blend, Buffer, BufferDesc, Frame, Image, ImageDesc, ImageView, Load, Mode, Pass, ShaderLibrary,
};
use fumarole::measure::experiment::{Context, Experiment};
use fumarole::measure::parameter::{self, Parameter, Range};
use fumarole::measure::study::{Identity, Study};
use fumarole::measure::{Error, Paper, Target, Variant, bench, result_table::ResultTable};
use fumarole::{field, host_block};
use serde_json::{Map, Value, json};

const COLUMNS: u32 = 64;

#[derive(Clone)]
pub struct Setup {
    preset: Option<String>,
    wavelength_px: f32,
}

impl Default for Setup {
    fn default() -> Self {
        Setup { preset: None, wavelength_px: 16.0 }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sine;

impl Variant for Sine {
    const ALL: &'static [Self] = &[Sine];

    fn as_str(self) -> &'static str {
        "sine"
    }
}

host_block! {
    /// `test/ripples.comp`
    pub struct Wave {
        pub wavelength_px: f32,
        pub phase_turns: f32,
    }
}

pub struct Ripples {
    wavelength_px: f32,
    heights: Arc<Buffer>,
    picture: Arc<ImageView>,
    propagate: Pass,
    shade: Pass,
}

impl Paper for Ripples {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), gpu::Error> {
        let wave = Wave { wavelength_px: self.wavelength_px, phase_turns: number as f32 / 8.0 };
        frame.compute(&self.propagate, |dispatch| dispatch.constants(&wave).threads(COLUMNS, 1, 1))?;
        frame.graphics(&self.shade, |draw| draw.vertices(3))
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.picture
    }

    fn targets(&self) -> Vec<Target> {
        vec![Target::table("heights", &self.heights, COLUMNS)]
    }
}

impl Study for Setup {
    const PAPER: &'static str = "ripples";
    type Variant = Sine;
    type Scene = ();
    type Paper = Ripples;

    fn load(&self) -> Result<(), Error> {
        Ok(parameter::check(&Self::parameters(), self)?)
    }

    fn make(&self, shaders: &ShaderLibrary, label: &str, _: &(), _: Sine) -> Result<Ripples, gpu::Error> {
        let device = shaders.device();
        let desc = BufferDesc::new(format!("{label}/heights"), u64::from(COLUMNS) * 4);
        let heights = Buffer::new(device, desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))?;
        let desc = ImageDesc::new_2d(format!("{label}/picture"), vk::Format::R8G8B8A8_UNORM, COLUMNS, 16);
        let picture = Image::new(device, desc.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT))?.view()?;
        let propagate = Pass::compute("propagate", "eq. 1", "test/ripples.comp").with("Heights", &heights);
        let shade = Pass::graphics("shade", "2", "common/fullscreen.vert", "test/ripples.frag")
            .with("Heights", &heights)
            .color(&picture, Load::Discard, Blend::Replace);
        let (propagate, shade) = (propagate.constants::<Wave>().build(shaders)?, shade.build(shaders)?);
        Ok(Ripples { wavelength_px: self.wavelength_px, heights, picture, propagate, shade })
    }

    fn config(&self, _: &(), _: &Ripples) -> Map<String, Value> {
        parameter::config(&Self::parameters(), self)
    }

    fn identity(&self) -> Identity {
        Identity { preset: self.preset.clone(), width: COLUMNS, height: 16, seed: 1 }
    }

    const ABOUT: &'static str = "Ripples on a line of columns";
    type Options = ();

    fn parameters() -> Vec<Parameter<Self>> {
        vec![
            Parameter::new("wavelength", field!(Setup.wavelength_px))
                .range(Range::from(2.0).to(1e4))
                .unit("pixels")
                .help("Length of a wave, L")
                .section("eq. 1"),
        ]
    }

    fn experiments() -> Vec<Experiment<Self>> {
        let help = "Table 1: greatest difference from equation 1 by frame";
        vec![Experiment { name: "1", help, options: &[], refuses: &[], run: table_1 }]
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }
}

/// The oracle: equation 1.
pub fn height(column: u32, wavelength_px: f64, phase_turns: f64) -> f64 {
    0.5 + 0.5 * (TAU * (f64::from(column) / wavelength_px - phase_turns)).sin()
}

fn table_1(context: &mut Context<'_, Setup>) -> Result<(), Error> {
    let mut machine = context.open()?;
    let mut paper = bench::build(&machine, &context.setup, &(), Sine)?.paper;
    let mut rows = Vec::new();
    for number in 0..4 {
        machine.recorder.run(Mode::Plain, |frame| paper.record(frame, number))?;
        let ours: Vec<f32> =
            bytemuck::pod_collect_to_vec(&gpu::transfer::read_buffer(&machine.device, &paper.heights)?);
        let truth = |column| height(column, f64::from(paper.wavelength_px), f64::from(number) / 8.0);
        let worst = (0..).zip(&ours).map(|(column, &ours)| (f64::from(ours) - truth(column)).abs()).fold(0.0, f64::max);
        rows.push(vec![json!(number), json!(worst)]);
    }
    context.publish_table(&machine, &ResultTable { title: "Table 1", columns: &["frame", "difference"], rows })
}
