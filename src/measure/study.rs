//! A paper as the measured loop and the verbs know it.

use serde_json::{Map, Value};

use super::bench::Built;
use super::error::Error;
use super::estimate::Estimate;
use super::experiment::Experiment;
use super::machine::Machine;
use super::measure::Measurement;
use super::parameter::{Given, Parameter};
use super::stress::Axis;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::{Paper, Variant};

/// Refuses several [alternatives](Study::alternatives) where one is taken.
///
/// # Errors
/// [`Error::Input`] names the parameter that has several values.
pub fn check_one<S: Study>(setup: &S) -> Result<(), Error> {
    let alternatives = setup.alternatives();
    let [one, other, ..] = alternatives.as_slice() else { return Ok(()) };
    let several = S::parameters().into_iter().find(|parameter| parameter.text(one) != parameter.text(other));
    let name = several.map_or_else(|| "an option".to_owned(), |parameter| format!("`{}`", parameter.name));
    Err(Error::Input(format!("{name}: several values in turn are for bench; give one")))
}

/// One paper as a user set it up: it declares its parameters, presets and experiments, from which the command line
/// follows, and makes what is measured.
pub trait Study: Clone + Default + 'static {
    /// The paper's name on the command line and in the record.
    const PAPER: &'static str;
    /// One line on the paper.
    const ABOUT: &'static str;
    /// Variants of a bench that names none.
    const BENCHED: &'static [Self::Variant] = Self::Variant::ALL;
    /// The variant of a picture that names neither one nor a preset.
    const RENDERED: Self::Variant = Self::Variant::ALL[0];
    /// Frames and repetitions at each point of an experiment that names none.
    const EXPERIMENT_FRAMES: (u32, u32) = (3, 3);
    /// Names of the experiments that measure all of their points in one sweep, which several processes can share.
    const SHARED: &'static [&'static str] = &[];
    /// Features that a device must have, beyond the baseline of the Vulkan layer.
    const NEEDS: &'static [Feature] = &[];

    type Variant: Variant;
    /// The input, loaded and placed.
    type Scene;
    type Paper: Paper;
    /// The options of its experiments and own verbs, beside the parameters.
    type Options: Default + 'static;

    /// Checks the parameters and loads the input.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Scene`], [`Error::Input`].
    fn load(&self) -> Result<Self::Scene, Error>;

    /// Makes the resources of a variant; `label` goes before their names.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Self::Scene,
        variant: Self::Variant,
    ) -> Result<Self::Paper, gpu::Error>;

    /// Takes over, into a paper made of another set-up, the parameters that differ, where all of them are constants of the
    /// next frame to it; its state stays. False where it has to be made anew.
    ///
    /// # Errors
    /// As [`Study::load`], for numbers that cannot be together.
    fn reconfigure(&self, _scene: &Self::Scene, _paper: &mut Self::Paper, _changed: &Given) -> Result<bool, Error> {
        Ok(false)
    }

    /// Sizes of a variant, as far as they follow from the parameters; [`Study::make`] is not asked for what is too large.
    fn estimate(&self, _device: &Device, _scene: &Self::Scene, _variant: Self::Variant) -> Estimate {
        Estimate::default()
    }

    /// Triangles of the mesh files that are read, as far as they say so before they come.
    ///
    /// # Errors
    /// As [`Study::load`].
    fn promised_triangles(&self) -> Result<u64, Error> {
        Ok(0)
    }

    /// Least memory of so many triangles of mesh files in a variant: they are not even read where the device cannot hold
    /// it.
    fn foresee(&self, _triangles: u64, _variant: Self::Variant) -> Estimate {
        Estimate::default()
    }

    fn identity(&self) -> Identity;

    /// Every parameter, under the names of the options.
    fn config(&self, scene: &Self::Scene, paper: &Self::Paper) -> Map<String, Value>;

    /// A few words on the configuration, for the trace.
    fn summary(&self) -> String {
        String::new()
    }

    /// The paper's own figures and warnings of each variant, asked after the measured loop.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    fn metrics(
        &self,
        _machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        Ok(measured.iter().map(|_| Metrics::default()).collect())
    }

    /// Every parameter, once, in the order in which values are set.
    fn parameters() -> Vec<Parameter<Self>>;

    /// The options of experiments and own verbs.
    fn options() -> Vec<Parameter<Self::Options>> {
        Vec::new()
    }

    /// The paper's figures and tables whose numbers can be taken.
    fn presets() -> Vec<Preset<Self>> {
        Vec::new()
    }

    /// Axes that `stress` makes larger, the default first.
    fn axes() -> Vec<Axis<Self>> {
        Vec::new()
    }

    /// The tables and figures that are reproduced.
    fn experiments() -> Vec<Experiment<Self>>;

    /// Verbs that no other paper has.
    fn verbs() -> Vec<Experiment<Self>> {
        Vec::new()
    }

    /// The setup that the main job measures, in the variants of [`Study::BENCHED`].
    fn quick() -> Self {
        Self::default()
    }

    /// The name of the preset that it was made of.
    fn preset_mut(&mut self) -> &mut Option<String>;

    /// Follows up what was given: values that depend on several parameters.
    ///
    /// # Errors
    /// [`Error::Input`] for a parameter that would not be heeded; [`Error::Parameter`], [`Error::Scene`].
    fn resolve(&mut self, _given: &Given) -> Result<(), Error> {
        Ok(())
    }

    /// The set-ups that a bench measures in turn, in each variant: several where a parameter was given several values for
    /// that. They share the input.
    fn alternatives(&self) -> Vec<Self> {
        vec![self.clone()]
    }

    /// The variant of a picture that names none.
    fn rendered(&self, preset: Option<Self::Variant>) -> Self::Variant {
        preset.unwrap_or(Self::RENDERED)
    }
}

/// The numbers of one of a paper's figures or tables.
#[derive(Clone)]
pub struct Preset<S: Study> {
    /// Name after `--preset`.
    pub name: &'static str,
    /// One line for help and lists.
    pub help: &'static str,
    /// The variant that it is made for, where it is one alone.
    pub variant: Option<S::Variant>,
    /// Makes the set-up.
    pub setup: fn() -> S,
}

impl<S: Study> Preset<S> {
    /// Its numbers, under its name.
    pub fn setup(&self) -> S {
        let mut setup = (self.setup)();
        *setup.preset_mut() = Some(self.name.to_owned());
        setup
    }
}

/// Is shown every paper, one after the other.
pub trait Visitor {
    type Error;

    /// # Errors
    /// The error that ends the visits.
    fn visit<S: Study>(&mut self) -> Result<(), Self::Error>;
}

/// Parameters that every configuration has.
#[derive(Debug, Clone)]
pub struct Identity {
    /// Name of the preset that the set-up began with; `None` without one.
    pub preset: Option<String>,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Identity {
    /// Of a preset's name, the size of the picture in pixels, and the seed.
    pub fn new(preset: &Option<String>, (width, height): (u32, u32), seed: u64) -> Self {
        Identity { preset: preset.clone(), width, height, seed }
    }
}

/// A paper's own results of a run.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    /// The paper's own figures.
    pub results: Map<String, Value>,
    /// Doubts about the run, one line each.
    pub warnings: Vec<String>,
}
