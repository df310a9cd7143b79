//! Chapter 4: the adaptive refinement pattern as a recursion from the finest triangles up, its statuses, and the
//! triangles that are drawn.

use std::collections::HashMap;

use super::boundary::area;
use super::model::Model;
use super::{State, Tick};

/// Table 4.1. Processed (2) is passed through within a tick.
pub mod status {
    pub const INACTIVE: i32 = -1;
    pub const INITIAL: i32 = 0;
    pub const ACTIVE: i32 = 1;
}

/// The order of the barycentric point set of section 4.4.2: 45 points.
const POINT_LEVEL: u32 = 3;

/// The nodes that are cut into four.
pub struct Pattern<'a> {
    model: &'a Model,
    /// Nodes on each edge, by the edge's sorted vertices.
    on_edge: HashMap<(usize, usize), Vec<usize>>,
    /// Nodes that are divided.
    pub is_split: Vec<bool>,
}

impl<'a> Pattern<'a> {
    /// The pattern with the nodes cut that a tick before has cut.
    pub fn new(model: &'a Model, statuses: &[i32]) -> Self {
        let mut on_edge: HashMap<_, Vec<usize>> = HashMap::new();
        for (n, node) in model.nodes.iter().enumerate() {
            for edge in edges(node.vertices) {
                on_edge.entry(edge).or_default().push(n);
            }
        }
        Pattern { model, on_edge, is_split: statuses.iter().map(|s| *s == status::INACTIVE).collect() }
    }

    fn parts(&self, node: usize) -> (usize, u32, usize) {
        let within = node % self.model.nodes_each();
        let level =
            (0..=self.model.levels).rev().find(|l| Model::level_start(*l) <= within).expect("level 0 starts at 0");
        (node - within, level, within - Model::level_start(level))
    }

    fn level(&self, node: usize) -> u32 {
        self.parts(node).1
    }

    pub fn parent(&self, node: usize) -> Option<usize> {
        let (root, level, index) = self.parts(node);
        (level > 0).then(|| root + Model::level_start(level - 1) + index / 4)
    }

    pub fn children(&self, node: usize) -> Option<[usize; 4]> {
        let (root, level, index) = self.parts(node);
        (level < self.model.levels).then(|| [0, 1, 2, 3].map(|k| root + Model::level_start(level + 1) + 4 * index + k))
    }

    /// The midpoints of a node's edges from corner 0, 1 and 2 on.
    fn midpoints(&self, node: usize) -> Option<[usize; 3]> {
        self.children(node).map(|children| self.model.nodes[children[3]].vertices)
    }

    /// Cuts a node and all that must be cut for it: its parent, and every triangle on an edge that the cut would halve
    /// for the second time, across the edges of coarse triangles too.
    pub fn split(&mut self, node: usize) {
        if self.is_split[node] {
            return;
        }
        self.is_split[node] = true;
        let Some(parent) = self.parent(node) else { return };
        self.split(parent);
        let model = self.model;
        let corner = self.parts(node).2 % 4;
        // The middle child has no edge on its parent's.
        if corner < 3 {
            let [before, after] = [2, 1].map(|step| model.nodes[parent].vertices[(corner + step) % 3]);
            for end in [before, after] {
                let whole = sorted(model.nodes[parent].vertices[corner], end);
                for other in self.on_edge[&whole].clone() {
                    self.split(other);
                }
            }
        }
    }

    /// True for a node that is drawn as a whole or with a transition, not by its children.
    pub fn is_leaf(&self, node: usize) -> bool {
        !self.is_split[node] && self.parent(node).is_none_or(|p| self.is_split[p])
    }

    pub fn leaves(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.model.nodes.len()).filter(|n| self.is_leaf(*n))
    }

    pub fn statuses(&self) -> Vec<i32> {
        let status = |n: usize| match (self.is_split[n], self.is_leaf(n)) {
            (true, _) => status::INACTIVE,
            (_, true) => status::ACTIVE,
            _ => status::INITIAL,
        };
        (0..self.model.nodes.len()).map(status).collect()
    }

    /// True for each vertex that exists: corners of the mesh, and midpoints of nodes that are cut.
    pub fn alive(&self) -> Vec<bool> {
        let mut alive = vec![false; self.model.rest.len()];
        for (n, node) in self.model.nodes.iter().enumerate() {
            if self.parent(n).is_none() {
                node.vertices.into_iter().for_each(|v| alive[v] = true);
            }
            if self.is_split[n] {
                self.midpoints(n).into_iter().flatten().for_each(|v| alive[v] = true);
            }
        }
        alive
    }

    /// The triangles that draw the mesh with no node below level `finest`, by node: a leaf with neighbours finer by one
    /// level is cut where they halve its edges (the 1-, 2- and 3-split transitions).
    pub fn drawn(&self, finest: u32) -> Vec<(usize, Vec<[usize; 3]>)> {
        let halved = self.alive();
        let is_drawn = |n: &usize| match self.level(*n) {
            level if level > finest => false,
            level if level == finest => self.parent(*n).is_none_or(|p| self.is_split[p]),
            _ => self.is_leaf(*n),
        };
        let cut = |n: usize| {
            let corners = self.model.nodes[n].vertices;
            let midpoints = self.midpoints(n).filter(|_| self.level(n) < finest);
            (n, transition(corners, midpoints.map_or([None; 3], |m| m.map(|v| halved[v].then_some(v)))))
        };
        (0..self.model.nodes.len()).filter(is_drawn).map(cut).collect()
    }

    /// Section 4.5: true for a node that counts as consumed, above the last level when two or more children do.
    pub fn is_consumed(&self, node: usize, is_finest_consumed: &impl Fn(usize) -> bool) -> bool {
        let Some(children) = self.children(node) else {
            let (root, _, index) = self.parts(node);
            return is_finest_consumed(root / self.model.nodes_each() * 4usize.pow(self.model.levels) + index);
        };
        children.into_iter().filter(|child| self.is_consumed(*child, is_finest_consumed)).count() >= 2
    }
}

fn sorted(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

/// Edges from corner 0, 1 and 2 on.
pub fn edges([a, b, c]: [usize; 3]) -> [(usize, usize); 3] {
    [sorted(a, b), sorted(b, c), sorted(c, a)]
}

/// A triangle cut at the given midpoints of its edges: the polygon around it as a fan of ears, or four as for a node.
fn transition(corners: [usize; 3], midpoints: [Option<usize>; 3]) -> Vec<[usize; 3]> {
    if let [Some(ab), Some(bc), Some(ca)] = midpoints {
        let [a, b, c] = corners;
        return vec![[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    }
    let mut around: Vec<usize> = (0..3).flat_map(|k| [Some(corners[k]), midpoints[k]]).flatten().collect();
    let mut triangles = Vec::new();
    while around.len() > 3 {
        // An ear between a corner with a midpoint before it and the vertex after it is never flat.
        let is_midpoint = |v: usize| midpoints.contains(&Some(v));
        let n = around.len();
        let tip =
            (0..n).find(|i| !is_midpoint(around[*i]) && is_midpoint(around[(i + n - 1) % n])).expect("one is halved");
        triangles.push([around[(tip + n - 1) % n], around[tip], around[(tip + 1) % n]]);
        around.remove(tip);
    }
    triangles.push([around[0], around[1], around[2]]);
    triangles
}

impl Tick<'_> {
    /// Section 4.4.2: true when a vertex or a point of the barycentric set of a coarse triangle is inside the virtual
    /// boundary.
    pub fn is_eligible(&self, state: &State, coarse: usize) -> bool {
        let level = self.model.levels.min(POINT_LEVEL);
        let first = coarse * self.model.nodes_each() + Model::level_start(level);
        let points = &self.model.nodes[first..first + 4usize.pow(level)];
        points.iter().flat_map(|n| n.vertices).any(|v| state.labels[v] >= area::VIRTUAL)
    }

    /// Pass `refinement`: triangles of the last level inside the virtual boundary become active with their siblings,
    /// and so on up (4.4.3), in eligible coarse triangles. Far from the source the boundary may reach a vertex before
    /// any point of the barycentric set is in the virtual area; what is in the initial area is refined in any case.
    pub fn refine(&self, state: &mut State) {
        if !self.variant.refines() || self.model.levels == 0 {
            return;
        }
        let mut pattern = Pattern::new(self.model, &state.statuses);
        let each = 4usize.pow(self.model.levels);
        for coarse in 0..self.model.coarse {
            let wanted = if self.is_eligible(state, coarse) { area::VIRTUAL } else { area::INITIAL };
            let first = coarse * self.model.nodes_each() + Model::level_start(self.model.levels);
            for n in first..first + each {
                if self.model.nodes[n].vertices.iter().any(|v| state.labels[*v] >= wanted) {
                    let parent = pattern.parent(n).expect("levels are not 0");
                    pattern.split(parent);
                }
            }
        }
        state.statuses = pattern.statuses();
        state.alive = pattern.alive();
    }
}

#[cfg(test)]
mod tests {
    use super::super::Variant;
    use super::super::fixtures::{Scene, boxed};
    use super::*;

    fn area_at_rest(model: &Model, [a, b, c]: [usize; 3]) -> f64 {
        (model.rest[b] - model.rest[a]).cross(model.rest[c] - model.rest[a]).length() / 2.0
    }

    /// Patterns on the way from the first seed to the whole box.
    fn burn(check: impl Fn(&Tick<'_>, &State, &Pattern<'_>)) {
        let (positions, triangles) = boxed();
        let scene = Scene::refined(&positions, &triangles, Variant::LowPoly, 4);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        let mut partial = 0;
        for growth in (0..1600).step_by(100) {
            state.growth_ticks = growth;
            tick.heat(&mut state);
            tick.refine(&mut state);
            let pattern = Pattern::new(&scene.model, &state.statuses);
            check(&tick, &state, &pattern);
            let leaves = pattern.leaves().count();
            partial += usize::from(leaves > 12 && leaves < scene.model.triangles.len());
        }
        assert!(partial > 5, "{partial}");
        assert_eq!(state.statuses.iter().filter(|s| **s == status::ACTIVE).count(), scene.model.triangles.len());
    }

    #[test]
    fn leaves_partition_every_coarse_triangle() {
        burn(|tick, state, pattern| {
            let model = tick.model;
            let (mut by_leaves, mut by_drawn) = (vec![0.0; model.coarse], vec![0.0; model.coarse]);
            for n in pattern.leaves() {
                assert_eq!(state.statuses[n], status::ACTIVE);
                by_leaves[n / model.nodes_each()] += area_at_rest(model, model.nodes[n].vertices);
            }
            for (n, triangles) in pattern.drawn(model.levels) {
                let areas = triangles.iter().map(|t| area_at_rest(model, *t));
                assert!(areas.clone().all(|a| a > 1e-9), "no flat triangle");
                by_drawn[n / model.nodes_each()] += areas.sum::<f64>();
            }
            for coarse in 0..model.coarse {
                let whole = area_at_rest(model, model.nodes[coarse * model.nodes_each()].vertices);
                assert!((by_leaves[coarse] - whole).abs() < 1e-9 && (by_drawn[coarse] - whole).abs() < 1e-9);
            }
        });
    }

    #[test]
    fn neighbours_differ_by_one_level_across_coarse_edges_too() {
        burn(|_, _, pattern| {
            // An edge of a leaf is halved at most once: no node on one of its halves is cut.
            for n in pattern.leaves() {
                let Some(midpoints) = pattern.midpoints(n) else { continue };
                for (edge, midpoint) in edges(pattern.model.nodes[n].vertices).into_iter().zip(midpoints) {
                    for half in [sorted(edge.0, midpoint), sorted(edge.1, midpoint)] {
                        let on_half = pattern.on_edge.get(&half).into_iter().flatten();
                        assert!(on_half.into_iter().all(|other| !pattern.is_split[*other]));
                    }
                }
            }
        });
    }

    #[test]
    fn the_drawn_surface_has_no_crack_at_any_level_of_detail() {
        burn(|tick, _, pattern| {
            for finest in 0..=tick.model.levels {
                let mut uses: HashMap<_, [i32; 2]> = HashMap::new();
                for (_, triangles) in pattern.drawn(finest) {
                    for [a, b, c] in triangles {
                        for (from, to) in [(a, b), (b, c), (c, a)] {
                            uses.entry(sorted(from, to)).or_default()[usize::from(from < to)] += 1;
                        }
                    }
                }
                assert!(uses.values().all(|ways| *ways == [1, 1]), "each edge once each way");
            }
        });
    }

    #[test]
    fn what_is_heated_has_been_refined() {
        burn(|_, state, _| {
            for v in 0..state.alive.len() {
                assert!(state.alive[v] || state.labels[v] < area::INITIAL);
            }
        });
    }

    #[test]
    fn statuses_follow_those_of_the_children() {
        burn(|_, state, pattern| {
            for n in 0..state.statuses.len() {
                let Some(children) = pattern.children(n) else { continue };
                let is_cut = state.statuses[n] == status::INACTIVE;
                let are_used = children.map(|child| state.statuses[child] != status::INITIAL);
                assert!(are_used == [is_cut; 4], "a parent is inactive once no child is initial");
            }
        });
    }

    #[test]
    fn a_triangle_is_hidden_with_two_of_its_children() {
        let (positions, triangles) = boxed();
        let model = Model::new(&positions, &triangles, 2, [2, 2, 2]);
        let pattern = Pattern::new(&model, &vec![status::INITIAL; model.nodes.len()]);
        // Grandchildren 0 and 1 make child 0 consumed, which alone does not hide the root.
        assert!(!pattern.is_consumed(0, &|t| [0, 1].contains(&t)));
        assert!(pattern.is_consumed(1, &|t| [0, 1].contains(&t)));
        assert!(pattern.is_consumed(0, &|t| [0, 1, 6, 7].contains(&t)));
        assert!(!pattern.is_consumed(0, &|t| [0, 4, 8, 12].contains(&t)));
        assert!(pattern.is_consumed(model.nodes_each(), &|t| (16..24).contains(&t)));
    }
}
