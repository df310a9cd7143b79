//! Section 6.3: the fractional folding method and the movement of base points.

use glam::DVec3;

use super::boundary::{RATE, area};
use super::displacement::GRAVITY;
use super::{State, Tick};

/// One edge of a triangle that a flow-true vertex is the source, the upper end, of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    pub source: DVec3,
    pub destination: DVec3,
    /// Corners of the triangle that do not flow.
    pub fixed: usize,
}

/// What folding does with an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fold {
    /// Of the source; `None` when the edge's length is in range.
    pub step: Option<DVec3>,
    /// How far the length is from the nearer end of the range.
    pub margin: f64,
}

/// Section 6.3.3 on one edge: an edge longer than `longest` (omega Dist) pulls its source in x and z, one shorter than
/// `shortest` (omega Dist / chi) pushes it away; no step leads past the end of the range.
pub fn fold(edge: &Edge, longest: f64, shortest: f64, velocity: f64) -> Fold {
    let way = edge.source - edge.destination;
    let length = way.length();
    let margin = (length - longest).abs().min((length - shortest).abs());
    let speed = velocity / (edge.fixed + 1) as f64;
    let step = if length > longest {
        let level = way.with_y(0.0);
        // Drawn in by a share t the edge has the length sqrt(h^2 + (1 - t)^2 q^2).
        let wanted = (longest * longest - way.y * way.y).max(0.0).sqrt();
        let exact = 1.0 - wanted / level.length().max(f64::MIN_POSITIVE);
        Some(-level * speed.min(exact))
    } else if length < shortest && length > 0.0 {
        Some(way * speed.min(shortest / length - 1.0))
    } else {
        None
    };
    Fold { step, margin }
}

/// What the base points of all blocks do in a tick: the displacement of the active ones, and how close their decisions are.
pub type BaseMoves = Vec<Option<(DVec3, f64)>>;

impl Tick<'_> {
    fn flows(&self, state: &State, v: usize) -> bool {
        state.labels[v] >= area::READY && state.alive[v]
    }

    /// Section 6.3.4.
    pub fn base_moves(&self, before: &State) -> BaseMoves {
        (0..self.model.grid.cells())
            .map(|cell| {
                let v = self.model.base_points[cell]?;
                (before.labels[v] >= area::READY).then(|| self.base_move(before, cell, v))
            })
            .collect()
    }

    fn base_move(&self, before: &State, cell: usize, v: usize) -> (DVec3, f64) {
        let grid = &self.model.grid;
        let p = before.positions[v];
        let steps = || -1..=1isize;
        let around = steps().flat_map(|z| steps().flat_map(move |y| steps().map(move |x| [x, y, z])));
        let lowest = around
            .filter(|steps| *steps != [0; 3])
            .filter_map(|steps| grid.beside(cell, steps))
            .filter_map(|cell| self.model.base_points[cell].map(|q| (before.positions[q], cell)))
            .min_by(|(a, i), (b, k)| a.y.total_cmp(&b.y).then(i.cmp(k)));
        if let Some((q, _)) = lowest.filter(|(q, _)| q.y < p.y) {
            let towards = self.constants.omega * (p - q) + q;
            let margin = grid.margin(towards);
            let ahead = grid.cell(towards);
            let does_not_melt = self.model.base_points[ahead].is_none_or(|b| before.labels[b] < area::READY);
            let is_stopped = ahead != before.cells[v] && before.blocks[ahead].live > 0 && does_not_melt;
            return (if is_stopped { DVec3::ZERO } else { towards - p }, margin);
        }
        let is_empty = |neighbour: Option<usize>| neighbour.is_none_or(|n| before.blocks[n].live == 0);
        let is_edge = grid.free_sides(cell, &before.blocks) > 0;
        if !is_edge || !is_empty(grid.beside(cell, [0, -1, 0])) {
            return (DVec3::ZERO, f64::INFINITY);
        }
        // Below the combustion-ready boundary the fall slows down with the distance.
        let behind = self.radius(before.growth_ticks) - self.constants.width - self.constants.reaches[v];
        let slower = (behind.max(0.0) / grid.size.y).max(1.0);
        let fall = self.constants.omega * GRAVITY / (RATE * RATE) / slower;
        (DVec3::Y * ((p.y - fall).max(self.constants.floor) - p.y), f64::INFINITY)
    }

    /// The mean of the steps over all edges that start at `v` and are out of range, and the closest of its decisions.
    pub fn folding(&self, before: &State, v: usize) -> (DVec3, f64) {
        let longest = self.constants.omega * self.model.mean_edge;
        let (mut sum, mut count, mut margin) = (DVec3::ZERO, 0, f64::INFINITY);
        for [t, _] in &self.model.incidence[v] {
            let mut sorted = self.model.triangles[*t].vertices;
            let height = |v: &usize| (before.positions[*v].y, *v);
            sorted.sort_by(|a, b| height(b).partial_cmp(&height(a)).expect("positions are numbers"));
            let [top, middle, bottom] = sorted;
            let fixed = sorted.iter().filter(|v| before.labels[**v] < area::READY).count();
            for (source, destination) in [(top, bottom), (top, middle), (middle, bottom)] {
                if source != v {
                    continue;
                }
                let [source, destination] = [source, destination].map(|v| before.positions[v]);
                let edge = Edge { source, destination, fixed };
                let folded = fold(&edge, longest, longest / self.constants.chi, self.constants.upsilon);
                margin = margin.min(folded.margin);
                if let Some(step) = folded.step {
                    sum += step;
                    count += 1;
                }
            }
        }
        (sum / f64::from(count.max(1)), margin)
    }

    /// `internal-deformation` of chapter 6: base points first, then every flow-true vertex.
    pub(super) fn melt(&self, state: &mut State) -> Vec<f64> {
        let before = state.clone();
        let base = self.base_moves(&before);
        let mut margins = vec![f64::INFINITY; before.positions.len()];
        for v in 0..before.positions.len() {
            if self.flows(&before, v) {
                let (carried, close) = base[self.model.rest_cells[v]].unwrap_or((DVec3::ZERO, f64::INFINITY));
                // Base points guide the flow and do not fold: so they come to rest.
                let is_base = self.model.base_points[self.model.rest_cells[v]] == Some(v);
                let (folded, margin) = if is_base { (DVec3::ZERO, f64::INFINITY) } else { self.folding(&before, v) };
                let moved = before.positions[v] + carried + folded;
                state.positions[v] = moved.with_y(moved.y.max(self.constants.floor));
                margins[v] = margin.min(close);
            }
            if before.is_active(v) {
                state.left[v] -= 1;
            }
        }
        margins
    }
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
                let way = state.positions[a] - state.positions[b];
                let is_too_short = way.length() < LONGEST / constants.chi - 1e-9;
                assert!(way.with_y(0.0).length() <= LONGEST + 1e-9 && !is_too_short, "{i}: {way}");
            }
        }
    }
}
