//! A ray against the height field: by many small steps and bisection.

use glam::DVec3;

use super::surface::Surface;

impl Surface {
    /// Depth at which the ray `eye` + depth `direction` meets the sheet, from either side, or a wall between the sheet's
    /// edge and the floor at the sides of the space; within `depths`, none without.
    pub fn cast(&self, eye: DVec3, direction: DVec3, depths: [f64; 2]) -> Option<f64> {
        let [mut first, mut last] = depths;
        let (mut entry_is_side, mut exit_is_side) = (false, false);
        for axis in [0, 2, 1] {
            let slack = if axis == 1 { 1e-3 * self.space.y } else { 0.0 };
            let ends = [-slack, self.space[axis] + slack].map(|side| (side - eye[axis]) / direction[axis]);
            let (enters, leaves) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            if enters > first {
                (first, entry_is_side) = (enters, axis != 1);
            }
            if leaves < last {
                (last, exit_is_side) = (leaves, axis != 1);
            }
        }
        if first >= last {
            return None;
        }
        let above = |depth: f64| {
            let place = eye + direction * depth;
            place.y - self.at(place.x, place.z).0
        };
        let is_in_wall = |depth: f64| above(depth) < 0.0 && eye.y + direction.y * depth >= 0.0;
        if entry_is_side && is_in_wall(first) {
            return Some(first);
        }
        let begins_above = above(first) >= 0.0;
        let steps = 2000;
        let at = |step: i32| first + (last - first) * f64::from(step) / f64::from(steps);
        if let Some(step) = (1..=steps).find(|&step| (above(at(step)) >= 0.0) != begins_above) {
            let (mut low, mut high) = (at(step - 1), at(step));
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if (above(middle) >= 0.0) == begins_above { low = middle } else { high = middle }
            }
            return Some(high);
        }
        (exit_is_side && is_in_wall(last)).then_some(last)
    }
}
