//! Picture strips: one object at several moments, side by side, as most figures of the dissertation show it.

use super::Setup;
use crate::experiment::bench::build;
use crate::experiment::error::Error;
use crate::experiment::machine::Machine;
use crate::experiment::picture;
use crate::experiment::study::Study;
use crate::image::Rgba8;
use crate::papers::burning::Variant;

/// The pictures of `frames`, which rise, and what the paper has to say at the last.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Scene`], [`Error::Image`], [`Error::Parameter`].
pub fn draw(machine: &mut Machine, setup: &Setup, variant: Variant, frames: &[u32]) -> Result<Vec<Rgba8>, Error> {
    let scene = setup.load()?;
    let mut built = build(machine, setup, &scene, variant)?;
    frames.iter().map(|&frame| picture::render(machine, &mut built.paper, frame)).collect()
}

/// Pictures of one size, the first on the left.
///
/// # Errors
/// [`Error::Image`].
pub fn side_by_side(pictures: &[Rgba8]) -> Result<Rgba8, Error> {
    let (width, height) = pictures.first().map_or((0, 0), |p| (p.width(), p.height()));
    let row = 4 * width as usize;
    let rows =
        (0..height as usize).flat_map(|y| pictures.iter().flat_map(move |p| &p.pixels()[y * row..(y + 1) * row]));
    Ok(Rgba8::new(width * pictures.len() as u32, height, rows.copied().collect())?)
}
