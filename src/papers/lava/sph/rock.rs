//! The rock on a fluid, which its particles carry: two layings that take turns (chapter 9, "Improved particle simulation").

use std::sync::Arc;

use ash::vk;

use super::super::targets::{Context, FLOATS};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Buffer, Error, Image, ImageDesc, ImageView};

/// Metres along x and z that each particle has gone since either laying.
pub struct Rock {
    /// Of the fluid's two states and of the start, at the particles' numbers.
    pub states: [Arc<ImageView>; 3],
    /// After the last step, by cells.
    pub by_cells: Arc<Buffer>,
    /// Steps between two renewals of a laying.
    renewal_steps: f64,
}

/// A step's change of the layings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layings {
    /// 1 of a laying that goes on, 0 of one that begins.
    pub kept: [f32; 2],
    /// Share of the first in what is seen after the step.
    pub share: f32,
}

impl Rock {
    /// Of the particles' textures; each laying lasts for so many steps.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        (width, height): (u32, u32),
        by_cells: Arc<Buffer>,
        renewal_steps: f64,
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED;
        let image = |name: &str| {
            Image::new(context.device(), ImageDesc::new_2d(context.name(name), FLOATS, width, height).usage(usage))?
                .view()
        };
        let states = [image("carried-a")?, image("carried-b")?, image("carried-start")?];
        upload_rows(context.device(), &states[2], (width, height), |_, bytes| bytes.fill(0))?;
        Ok(Rock { states, by_cells, renewal_steps })
    }

    /// Of the step with this number.
    pub fn layings(&self, step: u32) -> Layings {
        layings(step, self.renewal_steps)
    }
}

/// The first laying begins with the first step, the second half a renewal later, and either again after a whole one.
fn layings(step: u32, renewal_steps: f64) -> Layings {
    let turns = |step: f64, later: f64| (step / renewal_steps - later).floor();
    let before = f64::from(step) - 1.0;
    let kept = [0.0, 0.5].map(|later| turns(before, later) == turns(f64::from(step), later));
    let part = (f64::from(step) / renewal_steps).fract();
    Layings { kept: kept.map(|kept| f32::from(u8::from(kept))), share: (1.0 - (2.0 * part - 1.0).abs()) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_laying_is_renewed_when_it_is_not_seen() {
        let of = |step| layings(step, 12.0);
        assert_eq!(of(0), Layings { kept: [0.0, 1.0], share: 0.0 });
        assert_eq!(of(6), Layings { kept: [1.0, 0.0], share: 1.0 });
        for step in 1..100 {
            let Layings { kept: [first, second], share } = of(step);
            assert_eq!(first == 0.0, step % 12 == 0, "{step}");
            assert_eq!(second == 0.0, step % 12 == 6, "{step}");
            let seen = [share, 1.0 - share];
            assert!((first == 1.0 || seen[0] < 1e-6) && (second == 1.0 || seen[1] < 1e-6), "{step}: {seen:?}");
        }
        // Renewals between steps begin with the next.
        let begun: Vec<u32> = (1..30).filter(|step| layings(*step, 7.5).kept[0] == 0.0).collect();
        assert_eq!(begun, [8, 15, 23]);
    }
}
