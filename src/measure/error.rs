//! Failures of a command; the command line maps each kind to its exit code.

use crate::file::OutputError;
use crate::report::plot::PlotError;
use crate::{gpu, image, scene};

/// An error of an experiment.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Gpu(#[from] gpu::Error),
    #[error(transparent)]
    Scene(#[from] scene::Error),
    #[error(transparent)]
    Parameter(#[from] crate::measure::ParameterError),
    #[error(transparent)]
    Image(#[from] image::Error),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error("{0}")]
    Input(String),
    /// A law is broken by a simulation that is held against it.
    #[error("{0}")]
    Law(String),
    #[error("interrupted before anything was measured")]
    Interrupted,
    /// Not a failure: the process has done what was its of a sweep.
    #[error("the part of the sweep is written")]
    Shared,
}

impl Error {
    /// The end of work whose finished part is published: an interruption is none of its errors.
    ///
    /// # Errors
    /// Any other.
    pub fn unless_interrupted(self) -> Result<(), Self> {
        if matches!(self, Error::Interrupted) { Ok(()) } else { Err(self) }
    }
}
