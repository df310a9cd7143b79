//! Stages one and two behind `animate`, by variant.

use std::sync::Arc;

use super::animate::Animate;
use super::extract::Accepted;
use super::gpu_driven::GpuDriven;
use super::parameters::Variant;
use super::read_back::ReadBack;
use super::targets::Context;
use crate::gpu::{Device, Error, Frame, ImageView};

/// The way from positions to the sums of eq. 6.3.
pub enum Method {
    /// The thesis's.
    Paper(Box<ReadBack>),
    /// Ours, without readbacks.
    GpuDriven(Box<GpuDriven>),
}

impl Method {
    /// `instanced` splats are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        variant: Variant,
        animate: &Animate,
        particle_count: u32,
        instanced: bool,
    ) -> Result<Self, Error> {
        Ok(match variant {
            Variant::Paper => Method::Paper(Box::new(ReadBack::new(context, animate, particle_count, instanced)?)),
            Variant::GpuDriven => Method::GpuDriven(Box::new(GpuDriven::new(context, animate, particle_count)?)),
        })
    }

    /// The first `particles` of the state with this index by their places: clusters, or sorted cells.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn cluster(&mut self, frame: &mut Frame<'_>, state: usize, particles: u32) -> Result<(), Error> {
        match self {
            Method::Paper(read_back) => read_back.cluster(frame, state, particles),
            Method::GpuDriven(driven) => driven.cluster(frame, state, particles),
        }
    }

    /// Densities, accepted points and the sums of eq. 6.3.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn accumulate(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        match self {
            Method::Paper(read_back) => read_back.accumulate(frame),
            Method::GpuDriven(driven) => driven.accumulate(frame),
        }
    }

    /// Densities: a layer for each four grid planes, a component for each of them.
    pub fn density(&self) -> &Arc<ImageView> {
        match self {
            Method::Paper(read_back) => &read_back.density.density,
            Method::GpuDriven(driven) => &driven.density.density,
        }
    }

    /// Sum of weighted heights in red, metres; sum of weights in alpha.
    pub fn sums(&self) -> &Arc<ImageView> {
        match self {
            Method::Paper(read_back) => read_back.sums(),
            Method::GpuDriven(driven) => &driven.sums,
        }
    }

    /// Grid points that the last frame accepted; the device is asked where the host does not know.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn accepted(&self, device: &Arc<Device>) -> Result<Accepted, Error> {
        match self {
            Method::Paper(read_back) => Ok(read_back.accepted()),
            Method::GpuDriven(driven) => driven.accepted(device),
        }
    }
}
