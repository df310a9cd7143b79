//! The experiment `strip`: a contact sheet of a flow over time, as chapter 3 tells of its kinds.

use super::super::setup::Setup;
use crate::image::Rgba8;
use crate::image::contact_sheet::side_by_side;
use crate::measure::Error;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::papers::lava::Variant;

/// Pictures of a sheet.
const PICTURES: u32 = 5;
/// Its last frame without `frame`.
pub const LAST_FRAME: u32 = 239;

/// Frames of a sheet, evenly up to its last; fewer where that is an early one.
fn frames(last: u32) -> impl Iterator<Item = u32> {
    let count = PICTURES.min(last + 1);
    (1..=count).map(move |at| ((u64::from(last) + 1) * u64::from(at) / u64::from(count)) as u32 - 1)
}

/// Draws it up to a last frame.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn draw(machine: &mut Machine, setup: &Setup, last: u32) -> Result<Rgba8, Error> {
    let scene = setup.load()?;
    let mut paper = build(machine, setup, &scene, Variant::GpuDriven)?.paper;
    let pictures = frames(last).map(|frame| picture::render(machine, &mut paper, frame));
    Ok(side_by_side(&pictures.collect::<Result<Vec<_>, _>>()?)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_spread_evenly_up_to_the_last() {
        assert_eq!(frames(239).collect::<Vec<_>>(), [47, 95, 143, 191, 239]);
        assert_eq!(frames(2).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(frames(0).collect::<Vec<_>>(), [0]);
    }
}
