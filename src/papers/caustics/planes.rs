//! Reference planes: the receiver's box aligned with the light, and its cells (section 4.2.1).

use glam::{DVec3, Vec3};

use crate::scene::Light;

/// The share of its diagonal by which a box is higher than its receiver, half of it on either side, so that a flat
/// receiver that faces the light has a height and no surface lies on the near or far plane.
const HEIGHT_PADDING: f64 = 1e-3;
/// A receiver seen edge-on has no width or depth; its map then covers this share of the diagonal.
const LEAST_EXTENT: f64 = 1e-3;

/// The axes that all boxes of one light share: V = -T, against the light refracted at flat water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    pub u: DVec3,
    pub v: DVec3,
    pub w: DVec3,
}

impl Axes {
    /// Aligns with `light`; a point light aims at the centre of the world's box (figures 4-5 and 4-7). The thesis takes
    /// a random N for eq. 4-1; it is fixed here, so that runs repeat: U = normalize(N x V), W = U x V.
    pub fn aligned_with(light: &Light, world_center: DVec3, refraction_index: f64) -> Self {
        let incident = match *light {
            Light::Parallel { direction, .. } => direction.as_dvec3().normalize(),
            Light::Point { position, .. } => (world_center - position.as_dvec3()).normalize(),
        };
        // Eq. 2-8 at N = +Y.
        let eta = 1.0 / refraction_index;
        let cos_incident = -incident.y;
        let cos_refracted = (1.0 - eta * eta * (1.0 - cos_incident * cos_incident)).sqrt();
        let refracted = (incident * eta + DVec3::Y * (eta * cos_incident - cos_refracted)).normalize();
        let v = -refracted;
        let n = if v.z.abs() > 0.99 { DVec3::X } else { DVec3::Z };
        let u = n.cross(v).normalize();
        Axes { u, v, w: u.cross(v) }
    }

    /// Coordinates of a point or direction along the axes.
    pub fn along(&self, p: DVec3) -> DVec3 {
        DVec3::new(p.dot(self.u), p.dot(self.v), p.dot(self.w))
    }

    /// The point or direction with these coordinates.
    pub fn world(&self, p: DVec3) -> DVec3 {
        self.u * p.x + self.v * p.y + self.w * p.z
    }
}

/// A receiver's box: its centre P0 along the axes, and its width along U, height along V and depth along W, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReceiverBox {
    pub axes: Axes,
    pub center: DVec3,
    pub extent: DVec3,
}

impl ReceiverBox {
    /// The tight box of `positions` (eq. 4-2 and 4-3), padded.
    pub fn around(axes: Axes, positions: &[Vec3]) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in positions {
            let p = axes.along(p.as_dvec3());
            low = low.min(p);
            high = high.max(p);
        }
        let tight = high - low;
        let diagonal = tight.length();
        let least = (LEAST_EXTENT * diagonal).max(f64::MIN_POSITIVE);
        ReceiverBox {
            axes,
            center: (low + high) / 2.0,
            extent: DVec3::new(tight.x.max(least), tight.y + HEIGHT_PADDING * diagonal, tight.z.max(least)),
        }
    }

    /// The eight corners in the world.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
            self.axes.world(self.center + self.extent * DVec3::new(side(0), side(1), side(2)))
        })
    }
}

/// A plane and the heights along V from the box's centre that it accepts, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    pub plane: f32,
    /// Lowest height accepted.
    pub lower: f32,
    /// First height no longer accepted.
    pub upper: f32,
}

/// Slices a box of `height` into `count` equal cells with a plane at the centre of each, the nearest to the light
/// first; epsilon of eq. 4-15 is half a cell. Neighbours share one boundary value, so that every height is accepted by
/// exactly one cell; the uppermost is closed.
pub fn slice(height: f64, count: u32, cells: &mut Vec<Cell>) {
    cells.clear();
    slice_between(height / 2.0, -height / 2.0, count, true, cells);
}

/// Adds the cells between two heights; `on_top` says that `top` is the box's own, which belongs to the cell under it.
fn slice_between(top: f64, bottom: f64, count: u32, on_top: bool, cells: &mut Vec<Cell>) {
    // The ends are given, not computed, so that neighbouring pieces share them bit for bit.
    let at = |share: f64| top + (bottom - top) * share;
    let boundary = |i: u32| (if i == count { bottom } else { at(f64::from(i) / f64::from(count)) }) as f32;
    cells.extend((0..count).map(|i| Cell {
        plane: at((f64::from(i) + 0.5) / f64::from(count)) as f32,
        lower: boundary(i + 1),
        upper: if i == 0 && on_top { boundary(0).next_up() } else { boundary(i) },
    }));
}

/// Smart slicing (section 4.7.2): how planes are placed once the depth profile is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SmartPlacement {
    /// Sub-boxes of valid levels, each sliced anew by the acceptance threshold (eq. 4-21 and 4-22).
    Fitted {
        /// Acceptance threshold in metres; without one it is h / (2 (N - 1)) for N planes, as in table 5-4.
        epsilon_m: Option<f32>,
    },
    /// The uniform planes whose cell holds a texel: the caustics map is the level map's, bit for bit.
    Kept,
}

/// Reused lists of the depth profile.
#[derive(Debug, Clone, Default)]
pub struct DepthProfile {
    levels: Vec<Cell>,
    /// Texels in each level, the nearest to the light first.
    pub histogram: Vec<u32>,
}

impl DepthProfile {
    /// Counts the texels of a position map in each of `count` equal depth levels of a box of `height`; the background
    /// lies in none (figure 5-9).
    pub fn collect(&mut self, heights: &[f32], height: f64, count: u32) {
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

    /// Runs of neighbouring valid levels: the sub-boxes, as first level and end.
    fn sub_boxes(&self) -> impl Iterator<Item = (u32, u32)> {
        let is_valid = |level: usize| self.histogram.get(level).is_some_and(|&texels| texels > 0);
        let mut next = 0;
        std::iter::from_fn(move || {
            let first = (next..self.histogram.len()).find(|&level| is_valid(level))?;
            next = (first..).find(|&level| !is_valid(level))?;
            Some((first as u32, next as u32))
        })
    }

    /// Places planes in the valid levels alone, `planes` being the count that the user specified for the whole box.
    pub fn place(&self, height: f64, planes: u32, placement: SmartPlacement, cells: &mut Vec<Cell>) {
        cells.clear();
        let SmartPlacement::Fitted { epsilon_m } = placement else {
            let kept = self.levels.iter().zip(&self.histogram).filter(|(_, texels)| **texels > 0);
            return cells.extend(kept.map(|(cell, _)| *cell));
        };
        let levels = self.histogram.len() as f64;
        let uniform = || height / (2.0 * f64::from(planes.saturating_sub(1)));
        let epsilon = epsilon_m.map_or_else(uniform, f64::from);
        for (first, end) in self.sub_boxes() {
            // Eq. 4-21: h_i = h hr_i. Eq. 4-22 prints the ratio for the height; table 5-4 fits planes, at least one. The
            // last factor absorbs the rounding of a quotient that should be whole.
            let height_i = height * f64::from(end - first) / levels;
            let count = (height_i / (2.0 * epsilon) * (1.0 - 1e-9)).ceil().clamp(1.0, 4096.0);
            let boundary = |level: u32| height / 2.0 - height * f64::from(level) / levels;
            slice_between(boundary(first), boundary(end), count as u32, first == 0, cells);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count_accepting(cells: &[Cell], y: f32) -> usize {
        cells.iter().filter(|cell| cell.lower <= y && y < cell.upper).count()
    }

    #[test]
    fn every_height_of_the_box_is_accepted_by_exactly_one_plane() {
        let mut cells = Vec::new();
        for count in [1, 2, 3, 9, 31, 101, 4096] {
            slice(1.7, count, &mut cells);
            assert_eq!(cells.len(), count as usize);
            let ends = [0.85f32, -0.85];
            let boundaries = cells.iter().flat_map(|c| [c.lower, c.lower.next_up(), c.lower.next_down(), c.plane]);
            for y in boundaries.chain(ends).filter(|y| (-0.85..=0.85).contains(y)) {
                assert_eq!(count_accepting(&cells, y), 1, "{count} planes at {y}");
            }
        }
    }

    #[test]
    fn the_profile_counts_each_texel_in_its_level() {
        let mut profile = DepthProfile::default();
        // Levels of a box of height 1: 0.5..0.25, 0.25..0, 0..-0.25, -0.25..-0.5, each closed below; the top is closed above.
        profile.collect(&[0.5, 0.25, 0.2, 0.0, -0.1, -0.5, -1.0e30, 0.6, -0.6], 1.0, 4);
        assert_eq!(profile.histogram, [2, 2, 1, 1]);
    }

    #[test]
    fn smart_planes_stand_in_valid_levels_alone() {
        let mut profile = DepthProfile::default();
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
        let mut profile = DepthProfile::default();
        profile.collect(&[0.45, 0.2, -0.4], 1.0, 31);
        let (mut kept, mut uniform) = (Vec::new(), Vec::new());
        profile.place(1.0, 31, SmartPlacement::Kept, &mut kept);
        slice(1.0, 31, &mut uniform);
        assert_eq!(kept.len(), 3);
        assert!(kept.iter().all(|cell| uniform.contains(cell)));
    }
}
