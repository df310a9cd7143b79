//! What the measured loop and the verbs need to know of a paper.

use serde_json::{Map, Value};

use super::bench::Built;
use super::error::Error;
use super::machine::Machine;
use super::measure::Measurement;
use crate::gpu::{self, Feature, ShaderLibrary};
use crate::measure::{Paper, Variant};

/// One paper as a user set it up.
pub trait Study {
    /// The paper's word on the command line and in the record.
    const PAPER: &'static str;
    /// What a device must have, beyond the baseline of the Vulkan layer.
    const NEEDS: &'static [Feature];

    type Variant: Variant;
    /// The input, loaded and placed.
    type Scene;
    type Paper: Paper;

    /// Checks the parameters and loads the input.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Scene`], [`Error::Input`].
    fn load(&self) -> Result<Self::Scene, Error>;

    /// Makes the resources of a variant; `label` goes before their names.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    fn make(
        &self,
        shaders: &ShaderLibrary,
        label: &str,
        scene: &Self::Scene,
        variant: Self::Variant,
    ) -> Result<Self::Paper, gpu::Error>;

    fn identity(&self) -> Identity;

    /// Every parameter, under the names of the options.
    fn config(&self, scene: &Self::Scene, paper: &Self::Paper) -> Map<String, Value>;

    /// A few words on the configuration, for the trace.
    fn summary(&self) -> String;

    /// What the paper itself has to say of each subject, asked after the measured loop.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error>
    where
        Self: Sized;
}

/// What every configuration has.
#[derive(Debug, Clone)]
pub struct Identity {
    pub preset: Option<String>,
    /// Size of the picture in pixels.
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    /// Which of several fresh processes this is.
    pub process: u32,
}

/// What a paper has to say of a run.
#[derive(Debug, Clone, Default)]
pub struct Metrics {
    /// The paper's own figures.
    pub results: Map<String, Value>,
    /// What makes the run doubtful, one line each.
    pub warnings: Vec<String>,
}
