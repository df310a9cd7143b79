//! Pass `depth-profile` (section 4.7.2, figure 5-9): the levels of the box that hold the receiver, counted on the host
//! in the position map, and the planes that smart slicing places there.

use std::ops::Range;
use std::sync::Arc;

use super::parameters::{Parameters, SmartParameters};
use super::planes::{Cell, Fit, SmartPlacement, fit_into, slice, threshold};
use super::receiver::LitReceiver;
use crate::gpu::{Buffer, Error, Frame, PassInfo};

/// The pass, with its lists that every frame reuses.
pub struct DepthProfile {
    info: Arc<PassInfo>,
    parameters: SmartParameters,
    planes: u32,
    profile: Profile,
}

impl DepthProfile {
    pub fn new(parameters: &Parameters) -> Self {
        DepthProfile {
            info: PassInfo::host("depth-profile", "4.7.2", &["position-map"], &["planes"]),
            parameters: parameters.smart,
            planes: parameters.planes,
            profile: Profile::default(),
        }
    }

    /// Places the planes of `lit` by the heights that `positions` holds.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>, positions: &Buffer, lit: &mut LitReceiver) -> Result<(), Error> {
        let height = lit.aligned.extent.y;
        let SmartParameters { levels, placement } = self.parameters;
        // Uniform planes are kept or dropped by their own cells.
        let levels = if placement == SmartPlacement::Kept { self.planes } else { levels };
        frame.host(&self.info, || {
            positions.read(positions.size_bytes(), |bytes| {
                self.profile.collect(bytemuck::cast_slice(bytes), height, levels);
                self.profile.place(height, self.planes, placement, &mut lit.cells);
            })
        })
    }

    /// Texels in each level of the last frame, the nearest to the light first.
    pub fn histogram(&self) -> &[u32] {
        &self.profile.histogram
    }
}

/// Levels of a box and the texels in each.
#[derive(Debug, Clone, Default)]
struct Profile {
    levels: Vec<Cell>,
    /// Texels in each level, the nearest to the light first.
    histogram: Vec<u32>,
}

impl Profile {
    /// Counts the texels of a position map in each of `count` equal depth levels of a box of `height`; the background
    /// lies in none (figure 5-9).
    fn collect(&mut self, heights: &[f32], height: f64, count: u32) {
        slice(height, count, &mut self.levels);
        self.histogram.clear();
        self.histogram.resize(count as usize, 0);
        let (top, per_metre) = ((height / 2.0) as f32, (f64::from(count) / height) as f32);
        let last = self.levels.len() - 1;
        for &y in heights {
            let guess = ((top - y) * per_metre).max(0.0);
            if guess >= (last + 2) as f32 {
                continue;
            }
            // The product may round across a boundary; the boundaries decide.
            let mut level = (guess as usize).min(last);
            while level > 0 && y >= self.levels[level].upper {
                level -= 1;
            }
            while level < last && y < self.levels[level].lower {
                level += 1;
            }
            if self.levels[level].lower <= y && y < self.levels[level].upper {
                self.histogram[level] += 1;
            }
        }
    }

    /// Runs of neighbouring valid levels: the sub-boxes.
    fn sub_boxes(&self) -> impl Iterator<Item = Range<usize>> {
        let is_valid = |level: usize| self.histogram.get(level).is_some_and(|&texels| texels > 0);
        let mut next = 0;
        std::iter::from_fn(move || {
            let first = (next..self.histogram.len()).find(|&level| is_valid(level))?;
            next = (first..).find(|&level| !is_valid(level))?;
            Some(first..next)
        })
    }

    /// Places planes in the valid levels alone, `planes` being the count that the user specified for the whole box.
    fn place(&self, height: f64, planes: u32, placement: SmartPlacement, cells: &mut Vec<Cell>) {
        cells.clear();
        let SmartPlacement::Fitted { epsilon_m } = placement else {
            let kept = self.levels.iter().zip(&self.histogram).filter(|(_, texels)| **texels > 0);
            return cells.extend(kept.map(|(cell, _)| *cell));
        };
        let epsilon = threshold(height, planes, epsilon_m);
        for sub_box in self.sub_boxes() {
            let fit = Fit::new(height, self.levels.len() as u32, sub_box.len() as u32, epsilon);
            let on_top = sub_box.start == 0;
            fit_into(&self.levels[sub_box], height, on_top, fit, cells);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_counts_each_texel_in_its_level() {
        let mut profile = Profile::default();
        // Levels of a box of height 1: 0.5..0.25, 0.25..0, 0..-0.25, -0.25..-0.5, each closed below; the top is closed
        // above.
        profile.collect(&[0.5, 0.25, 0.2, 0.0, -0.1, -0.5, -1.0e30, 0.6, -0.6], 1.0, 4);
        assert_eq!(profile.histogram, [2, 2, 1, 1]);
    }

    #[test]
    fn smart_planes_stand_in_valid_levels_alone() {
        let mut profile = Profile::default();
        // Levels 0, 1 and 4 of five hold texels.
        profile.collect(&[0.45, 0.2, -0.4], 1.0, 5);
        assert_eq!(profile.histogram, [1, 1, 0, 0, 1]);
        let mut cells = Vec::new();
        // Eleven planes: epsilon 1/20, so 0.4 of height needs 4 planes and 0.2 needs 2.
        profile.place(1.0, 11, SmartPlacement::Fitted { epsilon_m: None }, &mut cells);
        assert_eq!(cells.len(), 6);
        assert_eq!((cells[0].upper, cells[3].lower), (0.5f32.next_up(), 0.1));
        assert_eq!((cells[4].upper, cells[5].lower), (-0.3, -0.5));
        profile.place(1.0, 5, SmartPlacement::Kept, &mut cells);
        assert_eq!(cells.len(), 3);
        // A single plane a sub-box where one plane was asked for.
        profile.place(1.0, 1, SmartPlacement::Fitted { epsilon_m: None }, &mut cells);
        assert_eq!(cells.len(), 2);
    }

    #[test]
    fn kept_planes_are_the_uniform_ones() {
        let mut profile = Profile::default();
        profile.collect(&[0.45, 0.2, -0.4], 1.0, 31);
        let (mut kept, mut uniform) = (Vec::new(), Vec::new());
        profile.place(1.0, 31, SmartPlacement::Kept, &mut kept);
        slice(1.0, 31, &mut uniform);
        assert_eq!(kept.len(), 3);
        assert!(kept.iter().all(|cell| uniform.contains(cell)));
    }
}
