//! Figures 1 and 2: the volcano from above and from the side, 200 x 200 samples, bilinear. Heat maps of the rays' steps.

use super::super::setup::Setup;
use crate::image::{Rgba8, Samples};
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::study::Study;
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

/// The share of each in their sum, up to the last that has any.
pub fn fractions(counts: &[u64]) -> Vec<f64> {
    let sum = counts.iter().sum::<u64>() as f64;
    let used = counts.iter().rposition(|count| *count > 0).map_or(0, |last| last + 1);
    counts[..used].iter().map(|count| *count as f64 / sum).collect()
}

/// The hits of a frame's rays.
pub struct Census {
    /// Row by row.
    pub hits: Vec<Hit>,
}

impl Census {
    /// Fraction of the rays that met a map's terrain.
    pub fn hit_fraction(&self) -> f64 {
        let met = self.hits.iter().filter(|hit| !matches!(hit.surface, Surface::Sky | Surface::Base)).count();
        met as f64 / self.hits.len() as f64
    }

    /// The share of the hits on terrain that each level of the map answered for, from the data on.
    pub fn levels(&self) -> Vec<f64> {
        let mut counts = Vec::new();
        for hit in self.hits.iter().filter(|hit| hit.surface == Surface::Terrain) {
            let level = hit.shift as usize;
            counts.resize(counts.len().max(level + 1), 0);
            counts[level] += 1;
        }
        fractions(&counts)
    }

    /// Mean number of segments that a ray of the picture tried; rays that met no map count none.
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

/// Black for no step, by violet, red and yellow to nearly white for the most; sRGB, each as much lighter than the one before.
const HEAT: [[f32; 3]; 6] = [
    [0.0, 0.0, 4.0],
    [59.0, 15.0, 112.0],
    [140.0, 41.0, 129.0],
    [222.0, 73.0, 104.0],
    [254.0, 159.0, 109.0],
    [252.0, 253.0, 191.0],
];

fn heat(fraction: f32) -> [u8; 4] {
    let place = fraction.clamp(0.0, 1.0) * (HEAT.len() - 1) as f32;
    let below = (place as usize).min(HEAT.len() - 2);
    let t = place - below as f32;
    let channel = |i: usize| (HEAT[below][i] + t * (HEAT[below + 1][i] - HEAT[below][i])).round() as u8;
    [channel(0), channel(1), channel(2), 255]
}

/// Steps of each ray by heat, one picture for each setup. All share one ramp, from no step to the most that any ray took, which
/// is given as well. It follows the logarithm: few rays graze the terrain, and those take many times the steps of the others.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
pub fn heat_maps<'a>(
    machine: &mut Machine,
    setups: impl Iterator<Item = &'a Setup>,
) -> Result<(u32, Vec<Rgba8>), Error> {
    let mut pictures = Vec::new();
    let mut most = 1;
    for setup in setups {
        let scene = setup.load()?;
        let mut built = build(machine, setup, &scene, Variant::GpuCompute)?;
        let steps: Vec<u32> = census(machine, &mut built.paper)?.hits.iter().map(|hit| hit.steps).collect();
        most = steps.iter().copied().fold(most, u32::max);
        pictures.push((setup.parameters.width, setup.parameters.height, steps));
    }
    let draw = |(width, height, steps): (u32, u32, Vec<u32>)| {
        let pixels = steps.iter().flat_map(|&steps| heat((steps as f32).ln_1p() / (most as f32).ln_1p())).collect();
        Ok(Rgba8::new(width, height, pixels)?)
    };
    Ok((most, pictures.into_iter().map(draw).collect::<Result<_, Error>>()?))
}
