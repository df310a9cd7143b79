//! Bending of parts that hang by little (ours, not the dissertation's): the joints that bear all that lies beyond them, by
//! taking each away in turn, and how far they turn, in `f64` from the curvature of a thin tube. The sections are taken as
//! they are.

use glam::{DQuat, DVec3};

use super::super::bending::Load;
use super::super::model::{LENGTH_UNIT, Sections};
use super::super::parts::MOST_PARTS;

/// Curvature under a moment of 1 of a joint of length 1 (`COMPLIANCE`), radians a diagonal.
pub const COMPLIANCE: f64 = 3.0;
/// Of a joint, radians.
pub const MOST_ANGLE: f64 = 0.8;
/// Of what is left to turn by, in a tick.
pub const SHARE: f64 = 0.1;
/// That a tick moves anything at most, diagonals.
pub const FARTHEST: f64 = 0.004;
/// Parts of a joint's length that L is counted in.
const STEPS: f64 = 256.0;

/// A bend of a section: its places p are at `turn * p + offset`.
pub type Bent = (DQuat, DVec3);

/// A joint that bears all that lies beyond it alone.
#[derive(Debug, Clone)]
pub struct Bearing {
    /// Its number.
    pub joint: u32,
    /// Sections beyond it; the first is the one at the joint.
    pub beyond: Vec<usize>,
    /// About which it turns, unit length, horizontal.
    pub axis: DVec3,
    /// Through which, a place in the object.
    pub pivot: DVec3,
    /// Radians that a tick turns it by where nothing comes too far for a tick.
    pub asked: f64,
    /// From the pivot to the farthest middle of a section beyond.
    pub reach: f64,
}

/// State of an object of sections in a tick.
pub struct Bending<'a> {
    /// Its sections.
    pub divided: &'a Sections,
    /// Of each.
    pub loads: &'a [Load],
    /// Left of each joint.
    pub strengths: &'a [u32],
    /// Of each section before the tick.
    pub bends: &'a [Bent],
    /// Radians that each joint has turned by before the tick.
    pub angles: &'a [f64],
    /// Square diagonals of a weight of 1.
    pub area: f64,
    /// True of a part that lies still.
    pub rests: &'a dyn Fn(u32) -> bool,
    /// The direction of gravity in the axes of a part.
    pub down: &'a dyn Fn(u32) -> DVec3,
}

impl Bending<'_> {
    fn holds(&self, joint: usize) -> bool {
        let [a, b] = self.divided.joints[joint].ends.map(|end| self.loads[end as usize].part);
        self.strengths[joint] > 0 && a == b && a < MOST_PARTS
    }

    /// Sections that hang together with the ground without one of the joints.
    fn held(&self, without: Option<usize>) -> Vec<bool> {
        let is_foot = |load: &Load| load.is_foot != 0 && load.part < MOST_PARTS && (self.rests)(load.part);
        let mut held: Vec<bool> = self.loads.iter().map(is_foot).collect();
        loop {
            let mut grows = false;
            for (number, joint) in self.divided.joints.iter().enumerate() {
                let [a, b] = joint.ends.map(|end| end as usize);
                if Some(number) != without && self.holds(number) && held[a] != held[b] {
                    (held[a], held[b], grows) = (true, true, true);
                }
            }
            if !grows {
                return held;
            }
        }
    }

    /// The joints that bear all that lies beyond them, with what a tick asks of them.
    pub fn bearings(&self) -> Vec<Bearing> {
        let all = self.held(None);
        let place = |section: usize, at: DVec3| self.bends[section].0 * at + self.bends[section].1;
        let mut bearings = Vec::new();
        for (number, joint) in self.divided.joints.iter().enumerate() {
            if !self.holds(number) {
                continue;
            }
            let held = self.held(Some(number));
            let mut beyond: Vec<usize> = (0..held.len()).filter(|s| all[*s] && !held[*s]).collect();
            let Some(at) = joint.ends.map(|end| end as usize).into_iter().find(|end| beyond.contains(end)) else {
                continue;
            };
            beyond.sort_by_key(|section| *section != at);
            let ends = joint.ends.map(|end| place(end as usize, joint.place.as_dvec3()));
            let pivot = (ends[0] + ends[1]) / 2.0;
            let weight: f64 = beyond.iter().map(|s| f64::from(self.loads[*s].weight)).sum();
            let middle = |s: usize| place(s, self.divided.sections[s].place.as_dvec3());
            let center = beyond.iter().map(|s| f64::from(self.loads[*s].weight) * middle(*s)).sum::<DVec3>() / weight;
            let arm = center - pivot;
            let moment = arm.cross((self.down)(self.loads[at].part));
            let whole = f64::from(joint.units) * LENGTH_UNIT;
            let left = (f64::from(self.strengths[number]) * LENGTH_UNIT / STEPS).min(whole);
            let curvature =
                COMPLIANCE * self.area * weight * moment.length() * (1.0 / left - 1.0 / whole) / whole.powi(2);
            let goal = (curvature * self.divided.width).min(MOST_ANGLE);
            let asked = (SHARE * (goal - self.angles[number])).min(0.5 * moment.length() / arm.length()).max(0.0);
            let reach = beyond.iter().map(|s| middle(*s).distance(pivot)).fold(0.0, f64::max);
            let axis = moment.normalize_or_zero();
            bearings.push(Bearing { joint: number as u32, beyond, axis, pivot, asked, reach });
        }
        bearings
    }
}

/// The bends after joints have turned by angles: all beyond each turns about it, nearest joints first.
pub fn turned(bends: &[Bent], bearings: &[(Bearing, f64)]) -> Vec<Bent> {
    let mut nearest: Vec<&(Bearing, f64)> = bearings.iter().collect();
    nearest.sort_by_key(|(bearing, _)| bearing.beyond.len());
    let mut bends = bends.to_vec();
    for (bearing, angle) in nearest {
        let turn = DQuat::from_axis_angle(bearing.axis, *angle);
        for &section in &bearing.beyond {
            let (before, offset) = bends[section];
            bends[section] = (turn * before, turn * (offset - bearing.pivot) + bearing.pivot);
        }
    }
    bends
}
