//! Section 6.3: the fractional folding method and the movement of base points.

use glam::DVec3;

use super::boundary::{RATE, area};
use super::displacement::GRAVITY;
use super::{State, Tick};

/// Least height by which a lower base point draws another, in diagonals (ours): next to the same height is the same.
const LEVEL: f64 = 1e-4;

/// Ticks for which the same end of an edge between equal heights gives way (ours; at random in the text).
const PERIOD: u32 = 8;

/// Sweeps of the folding in a tick in which wax sets, and the share of its step that each end of an edge then takes (ours).
const SWEEPS: u32 = 7;
const SHARE: f64 = 0.75;

/// One edge of a triangle that a flow-true vertex is the source, the upper end, of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// The upper end.
    pub source: DVec3,
    /// The lower end.
    pub destination: DVec3,
    /// Corners of the triangle that do not flow.
    pub fixed: usize,
}

/// The effect of folding on an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fold {
    /// Of the source; `None` when the edge's length is in range.
    pub step: Option<DVec3>,
    /// Distance of the length from the nearer end of the range.
    pub margin: f64,
}

/// Section 6.3.3 on one edge: an edge longer than `longest` (omega Dist) pulls its source in x and z, one shorter than
/// `shortest` (omega Dist / chi) pushes it away; no step leads past the end of the range.
pub fn fold(edge: &Edge, longest: f64, shortest: f64, velocity: f64) -> Fold {
    let along = edge.source - edge.destination;
    let length = along.length();
    let margin = (length - longest).abs().min((length - shortest).abs());
    let speed = velocity / (edge.fixed + 1) as f64;
    let step = if length > longest {
        let level = along.with_y(0.0);
        // Drawn in by a fraction t the edge has the length sqrt(h^2 + (1 - t)^2 q^2).
        let wanted = (longest * longest - along.y * along.y).max(0.0).sqrt();
        let exact = 1.0 - wanted / level.length().max(f64::MIN_POSITIVE);
        Some(-level * speed.min(exact))
    } else if length < shortest && length > 0.0 {
        Some(along * speed.min(shortest / length - 1.0))
    } else {
        None
    };
    Fold { step, margin }
}

/// A step or position with its distance from being decided otherwise, in lengths.
pub type Decided = (DVec3, f64);

impl Tick<'_> {
    fn flows(&self, state: &State, v: usize) -> bool {
        state.labels[v] >= area::READY && state.alive[v]
    }

    /// Fraction of its distance to the guides that a vertex covers in a tick: 1 - omega of it in the time in which the
    /// boundary crosses an area (ours; the text lets vertices "follow").
    fn following(&self) -> f64 {
        (1.0 - self.constants.omega) * (self.constants.speed / RATE / self.constants.width).min(1.0)
    }

    /// Seconds since the last vertex has burnt out, below 0 before.
    fn cold_s(&self, state: &State) -> f64 {
        let last = self.constants.reaches.iter().copied().fold(0.0, f64::max);
        let deformed = self.radius(state.growth_ticks) - 2.0 * self.constants.width - last;
        deformed / self.constants.speed - f64::from(self.constants.flammability) / RATE
    }

    /// Share of its motion that wax has left then; ours.
    fn warmth(&self, state: &State) -> f64 {
        let Some(setting_s) = self.constants.setting_s else { return 1.0 };
        (1.0 - self.cold_s(state) / setting_s).clamp(0.0, 1.0)
    }

    fn is_setting(&self, state: &State) -> bool {
        self.constants.setting_s.is_some() && self.cold_s(state) > 0.0
    }

    /// omega Dist and omega Dist / chi.
    fn range(&self) -> [f64; 2] {
        let longest = self.constants.omega * self.model.mean_edge;
        [longest, longest / self.constants.chi]
    }

    /// Position of the guide of a block that has vertices at rest.
    fn guide(&self, state: &State, cell: usize) -> Option<DVec3> {
        self.model.base_points[cell].map(|v| self.model.rest[v] + state.guides[cell])
    }

    fn is_guiding(&self, state: &State, cell: usize) -> bool {
        self.model.base_points[cell].is_some_and(|v| state.labels[v] >= area::READY)
    }

    /// Section 6.3.4: displacement of every guide since rest, after this tick, with its distance from being stopped or
    /// not.
    pub fn guided(&self, before: &State) -> Vec<Decided> {
        (0..self.model.grid.cells())
            .map(|cell| match self.guide(before, cell).filter(|_| self.is_guiding(before, cell)) {
                None => (before.guides[cell], f64::INFINITY),
                Some(p) => {
                    let (step, margin) = self.guide_step(before, cell, p);
                    (before.guides[cell] + step, margin.min(self.choice_margin(before, cell, p)))
                }
            })
            .collect()
    }

    /// By how much the guide is drawn to the lowest one around, and to no other, or else by how much it is not.
    fn choice_margin(&self, before: &State, cell: usize, p: DVec3) -> f64 {
        let grid = &self.model.grid;
        let around = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|steps| *steps != [0; 3]);
        let near = around.filter_map(|steps| grid.beside(cell, steps)).filter_map(|cell| self.guide(before, cell));
        let mut heights: Vec<f64> = near.map(|q| q.y).collect();
        heights.sort_by(f64::total_cmp);
        let [lowest, next] = [0, 1].map(|i| heights.get(i).copied().unwrap_or(f64::INFINITY));
        let drawn = p.y - LEVEL - lowest;
        // Not drawn, it does not matter by which.
        if drawn > 0.0 { drawn.min(next - lowest) } else { -drawn }
    }

    fn guide_step(&self, before: &State, cell: usize, p: DVec3) -> Decided {
        let grid = &self.model.grid;
        let is_missing = |n: Option<usize>| n.is_none_or(|n| self.model.base_points[n].is_none());
        let is_edge = grid.neighbours(cell).into_iter().any(|(axis, n)| axis != 1 && is_missing(n));
        if is_edge && is_missing(grid.beside(cell, [0, -1, 0])) {
            // Below the combustion-ready boundary the fall slows down with the distance.
            let v = self.model.base_points[cell].expect("it guides");
            let behind = self.radius(before.growth_ticks) - self.constants.width - self.constants.reaches[v];
            let slower = (behind.max(0.0) / grid.size.y).max(1.0);
            let fall = self.constants.omega * GRAVITY / (RATE * RATE) / slower;
            return (DVec3::Y * ((p.y - fall).max(self.constants.floor) - p.y), f64::INFINITY);
        }
        let steps = || -1..=1isize;
        let around = steps().flat_map(|z| steps().flat_map(move |y| steps().map(move |x| [x, y, z])));
        let lowest = around
            .filter(|steps| *steps != [0; 3])
            .filter_map(|steps| grid.beside(cell, steps))
            .filter_map(|cell| self.guide(before, cell).map(|q| (q, cell)))
            .min_by(|(a, i), (b, k)| a.y.total_cmp(&b.y).then(i.cmp(k)));
        let Some((q, _)) = lowest.filter(|(q, _)| q.y < p.y - LEVEL) else { return (DVec3::ZERO, f64::INFINITY) };
        let towards = self.constants.omega * (p - q) + q;
        let ahead = grid.cell(towards);
        let does_not_melt = self.model.base_points[ahead].is_some() && !self.is_guiding(before, ahead);
        let is_stopped = ahead != grid.cell(p) && does_not_melt && before.blocks[ahead].live > 0;
        let margin = grid.margin(towards).min(grid.margin(p));
        (if is_stopped { DVec3::ZERO } else { towards - p }, margin)
    }

    /// Displacement of the guides around a vertex's rest position, blended between the middles of their blocks.
    fn guidance(&self, guides: &[Decided], v: usize) -> Decided {
        let grid = &self.model.grid;
        let own = self.model.rest_cells[v];
        let from_middle = (self.model.rest[v] - grid.midpoint(own)) / grid.size;
        let (mut sum, mut weights, mut margin) = (DVec3::ZERO, 0.0, f64::INFINITY);
        for corner in 0..8 {
            let is_beside = [0, 1, 2].map(|k| corner >> k & 1 == 1);
            let steps = [0, 1, 2].map(|k| if is_beside[k] { from_middle[k].signum() as isize } else { 0 });
            let Some(cell) = grid.beside(own, steps).filter(|c| self.model.base_points[*c].is_some()) else { continue };
            let near = |k: usize| if is_beside[k] { from_middle[k].abs() } else { 1.0 - from_middle[k].abs() };
            let weight: f64 = (0..3).map(near).product();
            sum += weight * guides[cell].0;
            weights += weight;
            margin = margin.min(guides[cell].1);
        }
        (sum / weights, margin)
    }

    /// True when `v` is the upper end of an edge to `other`: of about equal heights the higher number for [`PERIOD`]
    /// ticks, then the lower one for as many. With the margin of that.
    fn is_source(&self, before: &State, v: usize, other: usize) -> (bool, f64) {
        let [_, tie] = self.range();
        let above = before.positions[v].y - before.positions[other].y;
        let is_upper =
            if above.abs() <= tie { (v > other) == (before.tick / PERIOD).is_multiple_of(2) } else { above > 0.0 };
        (is_upper, (above.abs() - tie).abs())
    }

    /// Section 6.3.3: the mean of the steps over all edges that start at `v` and are out of range, unless what holds
    /// the vertex would be left farther behind by it. While wax sets edges start at both ends, each of which takes a share.
    pub fn folding(&self, before: &State, v: usize) -> Decided {
        let [longest, shortest] = self.range();
        let sets = self.is_setting(before);
        let p = before.positions[v];
        let (mut sum, mut count, mut margin) = (DVec3::ZERO, 0, f64::INFINITY);
        let mut holders = Vec::new();
        for [t, k] in &self.model.incidence[v] {
            let vertices = self.model.triangles[*t].vertices;
            let fixed = vertices.iter().filter(|v| before.labels[**v] < area::READY).count();
            for other in [vertices[(k + 1) % 3], vertices[(k + 2) % 3]] {
                let position = before.positions[other];
                let above = position.y - p.y;
                let holds = before.labels[other] < area::DEFORMED || (before.left[other] > 0 && above > shortest);
                if holds {
                    holders.push(position);
                }
                let (is_source, close) = if sets { (true, f64::INFINITY) } else { self.is_source(before, v, other) };
                margin = margin.min(close);
                if !is_source {
                    continue;
                }
                let edge = Edge { source: p, destination: position, fixed };
                let folded = fold(&edge, longest, shortest, self.constants.upsilon);
                margin = margin.min(folded.margin);
                if let Some(step) = folded.step {
                    sum += step;
                    count += 1;
                }
            }
        }
        let step = if sets { SHARE } else { 1.0 } * sum / f64::from(count.max(1));
        let strain = |at: DVec3| -> f64 { holders.iter().map(|h| violation(at - h, longest, shortest)).sum() };
        let [now, then] = [p, p + step].map(strain);
        if now != then {
            margin = margin.min((now - then).abs());
        }
        (if then <= now { step } else { DVec3::ZERO }, margin)
    }

    /// `internal-deformation` of chapter 6 once the guides have moved: every flow-true vertex follows and folds.
    /// Answers as [`Tick::deform`].
    pub fn follow(&self, state: &mut State, guides: &[Decided]) -> Vec<f64> {
        let before = state.clone();
        state.guides = guides.iter().map(|g| g.0).collect();
        let mut margins = vec![f64::INFINITY; before.positions.len()];
        let warmth = self.warmth(&before);
        for v in (0..before.positions.len()).filter(|v| self.flows(&before, *v)) {
            let (target, close) = self.guidance(guides, v);
            let step = warmth * self.following() * (target - before.flows[v]);
            let (folded, margin) = self.folding(&before, v);
            let folded = warmth * folded;
            let is_active = self.is_active(&before, v);
            let fall = if is_active { self.fall() } else { 0.0 };
            let moved = before.positions[v] + step + folded - DVec3::Y * fall;
            state.positions[v] = moved.with_y(moved.y.max(self.constants.floor));
            state.flows[v] += step;
            state.left[v] -= u32::from(is_active);
            margins[v] = margin.min(close);
        }
        if self.is_setting(&before) {
            for _ in 1..SWEEPS {
                margins = self.sweep(state, warmth, &margins);
            }
        }
        margins
    }

    /// Another folding of all that flows. A decision that was close bears on those around it in the next sweep.
    fn sweep(&self, state: &mut State, warmth: f64, margins: &[f64]) -> Vec<f64> {
        let before = state.clone();
        let mut closer = margins.to_vec();
        for v in (0..before.positions.len()).filter(|v| self.flows(&before, *v)) {
            let (folded, margin) = self.folding(&before, v);
            let moved = before.positions[v] + warmth * folded;
            state.positions[v] = moved.with_y(moved.y.max(self.constants.floor));
            let around = self.model.incidence[v].iter().flat_map(|[t, _]| self.model.triangles[*t].vertices);
            closer[v] = around.map(|other| margins[other]).fold(margin.min(margins[v]), f64::min);
        }
        closer
    }
}

/// Excess of an edge over its range: too long seen from above, or too short.
fn violation(edge: DVec3, longest: f64, shortest: f64) -> f64 {
    (edge.with_y(0.0).length() - longest).max(0.0) + (shortest - edge.length()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::Variant;
    use super::super::fixtures::{Scene, wave};
    use super::*;

    const LONGEST: f64 = 0.08;

    /// By how much the sides of a triangle are too long seen from above, all that pulling in x and z can mend.
    fn excess(p: &[DVec3]) -> f64 {
        let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (p[a] - p[b]).with_y(0.0).length());
        sides.into_iter().map(|q| (q - LONGEST).max(0.0)).sum()
    }

    #[test]
    fn steps_end_at_the_end_of_the_range() {
        for i in 0..500 {
            let source = DVec3::new(wave(i), wave(i + 1).abs(), wave(i + 2)) * 0.2;
            for fixed in 0..3 {
                let edge = Edge { source, destination: DVec3::ZERO, fixed };
                let Some(step) = fold(&edge, LONGEST, LONGEST / 4.0, 0.9).step else { continue };
                let (was, is) = (source.length(), (source + step).length());
                if was > LONGEST {
                    assert!(is <= was && (is >= LONGEST - 1e-12 || source.y > LONGEST), "{source} {step}");
                    assert_eq!(step.y, 0.0);
                } else {
                    assert!(was < is && is <= LONGEST / 4.0 + 1e-12, "{source} {step}");
                }
            }
        }
        let edge = Edge { source: DVec3::ONE, destination: DVec3::ONE, fixed: 0 };
        assert_eq!(fold(&edge, LONGEST, LONGEST / 4.0, 0.2).step, None);
    }

    #[test]
    fn an_edge_higher_than_the_limit_ends_upright() {
        let mut source = DVec3::new(0.03, 0.2, -0.01);
        for _ in 0..200 {
            let edge = Edge { source, destination: DVec3::ZERO, fixed: 0 };
            source += fold(&edge, LONGEST, LONGEST / 4.0, 0.2).step.unwrap();
        }
        assert!(source.with_y(0.0).length() < 1e-12 && source.y == 0.2);
    }

    #[test]
    fn a_lone_triangles_violation_never_grows() {
        for i in 0..300 {
            let points = [0, 3, 6].map(|k| DVec3::new(wave(9 * i + k), wave(9 * i + k + 1), wave(9 * i + k + 2)) * 0.2);
            let scene = Scene::of(&points, &[[0, 1, 2]], Variant::Melting);
            let tick = scene.tick();
            let mut state = State::at_rest(&tick);
            state.labels.fill(area::DEFORMED);
            // The test sets lengths, not the mesh: omega so that omega Dist is the longest allowed.
            let mut constants = scene.constants.clone();
            constants.omega = LONGEST / scene.model.mean_edge;
            constants.floor = f64::NEG_INFINITY;
            let tick = Tick { constants: &constants, ..tick };
            let mut last = f64::INFINITY;
            for _ in 0..300 {
                let now = excess(&state.positions);
                assert!(now <= last + 1e-12, "{i}: {last} {now}");
                last = now;
                let folds: Vec<DVec3> = (0..3).map(|v| tick.folding(&state, v).0).collect();
                for (p, fold) in state.positions.iter_mut().zip(folds) {
                    *p += fold;
                }
            }
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let edge = state.positions[a] - state.positions[b];
                let is_too_short = edge.length() < LONGEST / constants.chi - 1e-9;
                assert!(edge.with_y(0.0).length() <= LONGEST + 1e-9 && !is_too_short, "{i}: {edge}");
            }
        }
    }
}
