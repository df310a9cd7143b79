//! Figures 1 and 2: the volcano from above and from the side, 200 x 200 samples, bilinear.

use super::Setup;
use crate::experiment::bench::build;
use crate::experiment::error::Error;
use crate::experiment::machine::Machine;
use crate::experiment::picture;
use crate::experiment::study::Study;
use crate::image::Rgba8;
use crate::papers::terrain::Variant;

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
