//! The thesis's stages one and two behind `animate`: clusters and accepted points are found on the host, which reads positions
//! and densities back.

use std::sync::Arc;

use super::accumulate_depths::AccumulateDepths;
use super::animate::Animate;
use super::cluster::Cluster;
use super::density::{Density, GridPlanes};
use super::extract::{Accepted, Extract};
use super::read_density::ReadDensity;
use super::read_positions::ReadPositions;
use super::targets::Context;
use crate::gpu::{Error, Frame, ImageView};

/// Stages one and two behind `animate`.
pub struct ReadBack {
    read_positions: ReadPositions,
    /// The particles of each cluster.
    pub cluster: Cluster,
    /// Of each cluster.
    planes: Vec<GridPlanes>,
    /// Densities at the grid points.
    pub density: Density,
    density_floor: Density,
    read_density: ReadDensity,
    /// The accepted grid points.
    pub extract: Extract,
    /// Sums of eq. 6.3.
    accumulate_depths: AccumulateDepths,
    accumulate_depths_floor: AccumulateDepths,
}

impl ReadBack {
    /// `instanced` splats are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, animate: &Animate, particle_count: u32, instanced: bool) -> Result<Self, Error> {
        let read_positions = ReadPositions::new(context, &animate.states)?;
        let cluster = Cluster::new(context, &read_positions.readback, particle_count as usize)?;
        let density = Density::new(context, &cluster.vertices)?;
        let density_floor = density.floor(context, &cluster.vertices)?;
        let read_density = ReadDensity::new(context, &density.layers)?;
        let extract = Extract::new(context, &read_density.readback)?;
        let accumulate_depths = AccumulateDepths::new(context, &extract.vertices, instanced)?;
        let accumulate_depths_floor = accumulate_depths.floor(context, &extract.vertices)?;
        let planes = GridPlanes::all(context.parameters);
        Ok(ReadBack {
            read_positions,
            cluster,
            planes,
            density,
            density_floor,
            read_density,
            extract,
            accumulate_depths,
            accumulate_depths_floor,
        })
    }

    /// Reads the positions of the state with this index back, and clusters the first `particles`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn cluster(&mut self, frame: &mut Frame<'_>, state: usize, particles: u32) -> Result<(), Error> {
        let positions = self.read_positions.record(frame, state)?;
        self.cluster.record(frame, positions, particles)
    }

    /// Densities and accepted points cluster by cluster, then the sums of eq. 6.3.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn accumulate(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.extract.clear();
        for (k, (particles, planes)) in self.cluster.clusters.particles.iter().zip(&self.planes).enumerate() {
            self.density.record(frame, k, planes, particles)?;
            let densities = self.read_density.record(frame, k)?;
            self.extract.record(frame, densities, planes)?;
        }
        self.accumulate_depths.record(frame, self.extract.points())
    }

    /// Draws the points and splats of the last frame with an empty fragment stage. It changes no texture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record_floors(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        for (k, (particles, planes)) in self.cluster.clusters.particles.iter().zip(&self.planes).enumerate() {
            self.density_floor.record(frame, k, planes, particles)?;
        }
        self.accumulate_depths_floor.record(frame, self.extract.points())
    }

    /// Sum of weighted heights in red, metres; sum of weights in alpha.
    pub fn sums(&self) -> &Arc<ImageView> {
        &self.accumulate_depths.sums
    }

    /// Grid points that the last frame accepted.
    pub fn accepted(&self) -> Accepted {
        Accepted { count: self.extract.accepted.len(), density_range: self.extract.density_range }
    }
}
