//! Reference planes, depth profile and smart slicing (sections 4.2.1, 4.4 and 4.7.2).

use crate::papers::caustics::reference::PositionMap;
use std::ops::Range;

/// Absorbs the rounding of h_i / 2ε where it should be a whole number.
const COUNT_ROUNDING: f64 = 1e-9;

/// A reference plane and the heights it accepts, in metres of box space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Height of the plane, at the centre of its cell.
    pub plane: f64,
    /// Lowest height accepted.
    pub lower: f64,
    /// Highest height; accepted only by the cell on top of the box.
    pub upper: f64,
    /// True where `upper` is the top of the box, and accepted.
    pub is_top: bool,
}

impl Cell {
    /// True for a surface at height `y` that belongs to this plane: lower <= y < upper, on top lower <= y <= upper
    /// (4.4, with ε half a cell, eq. 4-15). Neighbours share one boundary value, so exactly one cell accepts a height.
    pub fn accepts(&self, y: f64) -> bool {
        self.lower <= y && (y < self.upper || (self.is_top && y == self.upper))
    }
}

/// Places `count` planes over a box of `height`, each at the centre of an equal cell; the first is nearest to the light
/// (eq. 4-7 to 4-9 count from h/2 downward; the n pieces' centres are taken instead of their n + 1 boundaries).
pub fn place_planes(height: f64, count: usize) -> Vec<Cell> {
    slice(height / 2.0, -height / 2.0, count, true)
}

/// The acceptance threshold ε = h / (2 (N - 1)) with which Table 5-4 turns N specified planes into smart ones; infinite
/// for a single plane.
pub fn uniform_epsilon(height: f64, specified: usize) -> f64 {
    height / (2.0 * specified.saturating_sub(1) as f64)
}

/// Counts the texels of the position map in each of `levels` equal depth levels of the box's `height`, the first
/// nearest to the light; texels without a surface are not counted (4.7.2, figure 5-9).
pub fn depth_profile(map: &PositionMap, height: f64, levels: usize) -> Vec<u32> {
    let levels = place_planes(height, levels);
    let mut histogram = vec![0; levels.len()];
    for &y in map.y.iter().flatten() {
        // Levels descend, so those entirely above y come first.
        let level = levels.partition_point(|level| y < level.lower);
        if levels.get(level).is_some_and(|level| level.accepts(y)) {
            histogram[level] += 1;
        }
    }
    histogram
}

/// Groups neighbouring valid (not empty) levels into sub-boxes, as ranges of levels from the light downward.
pub fn smart_sub_boxes(histogram: &[u32]) -> Vec<Range<usize>> {
    let mut sub_boxes: Vec<Range<usize>> = Vec::new();
    for (level, _) in histogram.iter().enumerate().filter(|(_, n)| **n > 0) {
        match sub_boxes.last_mut() {
            Some(last) if last.end == level => last.end += 1,
            _ => sub_boxes.push(level..level + 1),
        }
    }
    sub_boxes
}

/// Places planes in the sub-boxes alone, each accepting its own cell: h_i = h r_i (eq. 4-21) with r_i the fraction of the
/// `levels`, and n_i = max(1, ceil(h_i / 2ε)) planes (eq. 4-22, read with the height instead of its ratio and as
/// planes, which is what Table 5-4 shows). `epsilon` is above 0, in metres.
pub fn smart_planes(height: f64, levels: usize, sub_boxes: &[Range<usize>], epsilon: f64) -> Vec<Cell> {
    let place = |sub_box: &Range<usize>| {
        let sub_height = height * sub_box.len() as f64 / levels as f64;
        let count = (sub_height / (2.0 * epsilon) * (1.0 - COUNT_ROUNDING)).ceil();
        let boundary = |level| boundary(height / 2.0, -height / 2.0, levels, level);
        let (top, bottom) = (boundary(sub_box.start), boundary(sub_box.end));
        slice(top, bottom, (count as usize).max(1), sub_box.start == 0)
    };
    sub_boxes.iter().flat_map(place).collect()
}

/// Drops the planes whose cell holds no texel of the position map.
pub fn keep_occupied(cells: &[Cell], map: &PositionMap) -> Vec<Cell> {
    let occupied = |cell: &&Cell| map.y.iter().flatten().any(|&y| cell.accepts(y));
    cells.iter().filter(occupied).copied().collect()
}

fn slice(top: f64, bottom: f64, count: usize, is_top: bool) -> Vec<Cell> {
    (0..count)
        .map(|i| {
            let upper = boundary(top, bottom, count, i);
            let lower = boundary(top, bottom, count, i + 1);
            Cell { plane: (upper + lower) / 2.0, lower, upper, is_top: is_top && i == 0 }
        })
        .collect()
}

/// The i-th of `count` + 1 boundaries; both ends exact, so that sub-boxes meet the levels they are made of.
fn boundary(top: f64, bottom: f64, count: usize, i: usize) -> f64 {
    if i == count { bottom } else { top + (bottom - top) * i as f64 / count as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{OVERHEAD, WATER, horizontal, sphere, tilted};
    use crate::papers::caustics::reference::{align_box, position_map};
    use std::slice::from_ref;

    fn accepting(cells: &[Cell], y: f64) -> usize {
        cells.iter().filter(|cell| cell.accepts(y)).count()
    }

    #[test]
    fn planes_stand_at_the_centres_of_equal_cells_from_the_light_downward() {
        let cells = place_planes(3.0, 3);
        let planes: Vec<f64> = cells.iter().map(|cell| cell.plane).collect();
        assert_eq!(planes, [1.0, 0.0, -1.0]);
        assert_eq!(place_planes(2.0, 1)[0].plane, 0.0);
        assert!(place_planes(2.0, 0).is_empty());
    }

    #[test]
    fn every_height_of_the_box_is_accepted_exactly_once() {
        for (height, count) in [(1.0, 1), (0.7, 9), (std::f64::consts::PI, 101)] {
            let cells = place_planes(height, count);
            for cell in &cells {
                for y in [cell.lower, cell.plane, cell.upper, cell.upper.next_down()] {
                    assert_eq!(accepting(&cells, y), 1, "height {y}");
                }
            }
            assert_eq!(accepting(&cells, (height / 2.0).next_up()), 0);
            assert_eq!(accepting(&cells, (-height / 2.0).next_down()), 0);
        }
    }

    #[test]
    fn a_tilted_plane_is_accepted_exactly_once_everywhere() {
        let floor = tilted();
        let receiver = floor.aligned(OVERHEAD);
        let map = position_map(&receiver, &floor.triangles, 64);
        let cells = place_planes(receiver.height, 9);
        assert!(map.y.iter().all(|y| y.is_some_and(|y| accepting(&cells, y) == 1)));
        assert_eq!(keep_occupied(&cells, &map), cells);

        let histogram = depth_profile(&map, receiver.height, 100);
        assert_eq!(histogram.iter().sum::<u32>(), 64 * 64);
        let epsilon = uniform_epsilon(receiver.height, 9);
        let smart = smart_planes(receiver.height, 100, &smart_sub_boxes(&histogram), epsilon);
        assert!(map.y.iter().flatten().all(|&y| accepting(&smart, y) == 1));
    }

    #[test]
    fn a_sphere_hides_its_lower_half_and_needs_half_the_planes() {
        let ball = sphere(48, 1.0);
        let receiver = align_box(OVERHEAD, &ball.positions(), glam::DVec3::ZERO, WATER).unwrap();
        let map = position_map(&receiver, &ball.triangles, 128);
        let histogram = depth_profile(&map, receiver.height, 10);
        let covered = map.y.iter().flatten().count() as u32;
        assert_eq!(histogram.iter().sum::<u32>(), covered);
        assert_eq!(smart_sub_boxes(&histogram), *from_ref(&(0..5)));
        let kept = keep_occupied(&place_planes(receiver.height, 10), &map);
        assert_eq!(kept, place_planes(receiver.height, 10)[..5]);
    }

    #[test]
    fn a_flat_receiver_fills_one_level() {
        let floor = horizontal(1.0, -2.0);
        let receiver = floor.aligned(OVERHEAD);
        let map = position_map(&receiver, &floor.triangles, 16);
        assert_eq!(depth_profile(&map, receiver.height, 3), [0, 256, 0]);
    }

    #[test]
    fn sub_boxes_are_the_runs_of_valid_levels() {
        assert_eq!(smart_sub_boxes(&[4, 1, 0, 0, 7, 0, 2]), [0..2, 4..5, 6..7]);
        assert!(smart_sub_boxes(&[0, 0]).is_empty());
        assert_eq!(smart_sub_boxes(&[3; 5]), *from_ref(&(0..5)));
    }

    #[test]
    fn smart_planes_fill_each_sub_box_and_meet_its_levels() {
        let levels = place_planes(2.0, 7);
        let cells = smart_planes(2.0, 7, &[0..2, 4..5], 0.1);
        // h_0 = 4/7 needs ceil(2.86) planes, h_1 = 2/7 needs ceil(1.43).
        assert_eq!(cells.len(), 3 + 2);
        assert_eq!((cells[0].upper, cells[0].is_top), (1.0, true));
        assert_eq!(cells[2].lower, levels[1].lower);
        assert_eq!(cells[3].upper, levels[4].upper);
        assert_eq!(cells[4].lower, levels[4].lower);
        assert!(!cells[3].is_top);
    }

    /// Number of planes that one run of `valid` of 100 levels gets.
    fn smart_count(valid: usize, specified: usize) -> usize {
        let epsilon = uniform_epsilon(1.0, specified);
        smart_planes(1.0, 100, from_ref(&(0..valid)), epsilon).len()
    }

    #[test]
    fn table_5_4_is_reproduced_by_one_run_of_valid_levels() {
        // The dolphin has one empty level (figure 5-12): its column is N - 1 after the first row throughout.
        for specified in 3..=100 {
            assert_eq!(smart_count(99, specified), specified - 1);
        }
        assert_eq!(smart_count(99, 101), 99);
        // The sphere's upper half. Where (N - 1) / 2 is whole the thesis sometimes rounds up once more: not at these.
        for (specified, actual) in [(3, 1), (4, 2), (10, 5), (18, 9), (50, 25), (101, 50)] {
            assert_eq!(smart_count(50, specified), actual);
        }
        // The teapot's runs are not printed: one run of 60 levels is within a plane of its column.
        for (specified, actual) in [(3, 2), (11, 7), (20, 11), (50, 30), (75, 45), (101, 61)] {
            assert!(smart_count(60, specified).abs_diff(actual) <= 1);
        }
    }

    #[test]
    fn a_single_plane_and_an_infinite_threshold_still_give_a_plane() {
        assert_eq!(smart_count(10, 1), 1);
        assert_eq!(smart_planes(1.0, 100, &[0..1, 5..6], 0.5).len(), 2);
    }
}
