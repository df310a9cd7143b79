//! Whole pictures by each method against the one whose light is the photons': what of an error is seen.

use super::super::super::Caustics;
use super::judge::filled;
use super::truth::{FRAME, Truth};
use crate::gpu::transfer::read_image;
use crate::gpu::{self, Frame, Mode};
use crate::image::{Difference, Rgba8, compare};
use crate::measure::machine::Machine;
use crate::measure::{Error, Paper};

/// The picture of the true light, and where it is lit.
pub struct TruePicture {
    picture: Rgba8,
    /// Pixels that show caustics: without any they are darker.
    lit: Vec<bool>,
}

impl TruePicture {
    /// Drawn by a method's own combination, cast and view, of which other tests know that they show what rays meet, from the photons'
    /// maps in place of its own; `heights` are its position maps, of the truths' size. None where no light is seen.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Image`].
    pub fn of(
        machine: &mut Machine,
        paper: &mut Caustics,
        heights: &[&[f32]],
        truths: &[Truth],
    ) -> Result<Option<Self>, Error> {
        draw(machine, paper, |paper, frame| paper.record_picture(frame, FRAME))?;
        let light: Vec<Vec<f32>> = truths.iter().zip(heights).map(|(truth, heights)| shown(truth, heights)).collect();
        paper.set_light(&machine.device, &light)?;
        let picture = draw(machine, paper, Caustics::record_lit_picture)?;
        let dark: Vec<Vec<f32>> = light.iter().map(|map| vec![0.0; map.len()]).collect();
        paper.set_light(&machine.device, &dark)?;
        let unlit = draw(machine, paper, Caustics::record_lit_picture)?;
        let pixels = picture.pixels().chunks_exact(4).zip(unlit.pixels().chunks_exact(4));
        let lit: Vec<bool> = pixels.map(|(lit, unlit)| lit != unlit).collect();
        Ok(lit.contains(&true).then_some(TruePicture { picture, lit }))
    }

    /// Luv difference (eq. 2-9) of a method's picture over the pixels that show caustics.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Image`].
    pub fn difference(&self, machine: &mut Machine, paper: &mut Caustics) -> Result<Difference, Error> {
        let picture = draw(machine, paper, |paper, frame| paper.record_picture(frame, FRAME))?;
        paper.settle(&machine.shaders)?;
        Ok(compare(&self.picture, &picture, Some(&self.lit))?)
    }
}

fn draw(
    machine: &mut Machine,
    paper: &mut Caustics,
    record: impl Fn(&mut Caustics, &mut Frame<'_>) -> Result<(), gpu::Error>,
) -> Result<Rgba8, Error> {
    machine.recorder.run(Mode::Plain, |frame| record(paper, frame))?;
    let view = paper.picture();
    Ok(Rgba8::new(view.width(), view.height(), read_image(&machine.device, view)?)?)
}

/// The mean of both halves. A texel at the receiver's edge has photons on a part of it alone: it takes the light of the filled texels
/// around it, where there are any.
fn shown(truth: &Truth, heights: &[f32]) -> Vec<f32> {
    let size = heights.len().isqrt();
    let [one, other] = &truth.halves;
    let mean: Vec<f32> = one.iter().zip(other).map(|(a, b)| ((a + b) / 2.0) as f32).collect();
    let mut is_filled = vec![false; heights.len()];
    filled(heights).into_iter().for_each(|texel| is_filled[texel] = true);
    let of_texel = |texel: usize| {
        if is_filled[texel] {
            return mean[texel];
        }
        let (x, y) = ((texel % size) as isize, (texel / size) as isize);
        let (mut sum, mut count) = (0.0, 0.0);
        for (column, row) in (y - 1..=y + 1).flat_map(|row| (x - 1..=x + 1).map(move |column| (column, row))) {
            let inside = (0..size as isize).contains(&column) && (0..size as isize).contains(&row);
            let beside = row * size as isize + column;
            if inside && is_filled[beside as usize] {
                (sum, count) = (sum + mean[beside as usize], count + 1.0);
            }
        }
        if count > 0.0 { sum / count } else { mean[texel] }
    };
    (0..heights.len()).map(of_texel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_take_the_light_beside_them() {
        let mut heights = vec![0.0; 36];
        heights[..6].fill(-1e30);
        let light = |texel: usize| if texel / 6 == 2 { 4.0 } else { 1.0 };
        let half: Vec<f64> = (0..36).map(light).collect();
        let shown = shown(&Truth { halves: [half.clone(), half] }, &heights);
        // The first row that the receiver fills with all around it is the third, of which the second is the edge.
        assert_eq!(shown[2 * 6 + 2], 4.0);
        assert_eq!((shown[6 + 2], shown[2]), (4.0, 1.0));
    }
}
