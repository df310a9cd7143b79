//! Figures 1 and 2: the volcano from above and from the side, 200 x 200 samples, bilinear. Heat maps of the rays' steps.

use super::Setup;
use crate::experiment::bench::build;
use crate::experiment::error::Error;
use crate::experiment::machine::Machine;
use crate::experiment::picture;
use crate::experiment::study::Study;
use crate::image::{Raster, Rgba8, Samples};
use crate::papers::Paper;
use crate::papers::terrain::{Hit, Surface, Terrain, Variant};

/// Samples a side of the map in figures 1 and 2.
pub const SIDE: u32 = 200;

/// Draws a setup by one variant.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
pub fn draw(machine: &mut Machine, setup: &Setup, variant: Variant) -> Result<Rgba8, Error> {
    let scene = setup.load()?;
    let mut built = build(machine, setup, &scene, variant)?;
    picture::render(machine, &mut built.paper, 0)
}

/// What the rays of a frame met.
pub struct Census {
    /// Row by row.
    pub hits: Vec<Hit>,
}

impl Census {
    /// Share of the rays that met a map's terrain.
    pub fn hit_share(&self) -> f64 {
        let met = self.hits.iter().filter(|hit| !matches!(hit.surface, Surface::Sky | Surface::Base)).count();
        met as f64 / self.hits.len() as f64
    }

    /// Mean number of segments that a ray of the picture looked at; rays that met no map count none.
    pub fn steps_per_ray(&self) -> f64 {
        self.hits.iter().map(|hit| f64::from(hit.steps)).sum::<f64>() / self.hits.len() as f64
    }
}

/// Draws frame 0 and reads what its rays met.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`].
pub fn census(machine: &mut Machine, paper: &mut Terrain) -> Result<Census, Error> {
    picture::render(machine, paper, 0)?;
    let targets = paper.targets();
    let mut hits = Vec::new();
    if let Some(target) = targets.iter().find(|target| target.name == "depth")
        && let Samples::F32(values) = picture::read_target(&machine.device, target)?.samples()
    {
        hits.extend(values.as_chunks().0.iter().map(|&texel| Hit::from_texel(texel)));
    }
    Ok(Census { hits })
}

/// Steps of each ray as a ramp from none to the most.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
pub fn heat_map(machine: &mut Machine, setup: &Setup) -> Result<Raster, Error> {
    let scene = setup.load()?;
    let mut built = build(machine, setup, &scene, Variant::GpuCompute)?;
    let census = census(machine, &mut built.paper)?;
    let (width, height) = (setup.parameters.width, setup.parameters.height);
    let steps: Vec<f32> = census.hits.iter().map(|hit| hit.steps as f32).collect();
    Ok(Raster::image(width, height, 1, 1, steps)?)
}
