//! Section 3.5.4: the triangles that leave the drawn stream.

use std::collections::BTreeSet;

use super::falling::components;
use super::flames::pcg3d;
use super::{Node, State, Tick, Variant};

/// Ticks that a search for what hangs together takes.
const SEARCH_TICKS: u32 = 4;

impl Tick<'_> {
    /// True for a triangle with nothing left at its three corners.
    pub fn is_consumed(&self, state: &State, triangle: usize) -> bool {
        self.model.triangles[triangle].vertices.iter().all(|v| state.left[*v] == 0)
    }

    /// Pass `surface-removal`. Solid and melting meshes lose nothing.
    pub fn remove(&self, state: &mut State) {
        if matches!(self.variant, Variant::Solid | Variant::Melting) {
            return;
        }
        let consumed: Vec<bool> = (0..self.model.triangles.len()).map(|t| self.is_consumed(state, t)).collect();
        match (self.constants.keep_connected, state.tick % SEARCH_TICKS) {
            (false, _) => state.removed.iter_mut().zip(consumed).for_each(|(removed, consumed)| *removed |= consumed),
            (true, 0) => {
                let search = state.tick / SEARCH_TICKS;
                let share = [u32::MAX, u32::MAX >> 1, u32::MAX, u32::MAX >> 5][search as usize % 4];
                let left_out = |t: usize| {
                    let [chance, ..] = pcg3d([t as u32, search, self.constants.seed]);
                    !state.removed[t] && consumed[t] && chance <= share
                };
                state.left_out = (0..consumed.len()).map(left_out).collect();
            }
            (true, 3) => {
                let removed = self.unneeded(state);
                state.removed.iter_mut().zip(removed).for_each(|(removed, leaves)| *removed |= leaves);
            }
            _ => (),
        }
    }

    /// Triangles among those left out whose corners hang together by the others, but for corners that they alone have;
    /// all of them of a part of the mesh whose others hang together.
    fn unneeded(&self, state: &State) -> Vec<bool> {
        let count = state.positions.len();
        let (mut others, mut left_out) = (vec![0; count], vec![0; count]);
        let mut triangles = Vec::new();
        for (t, node) in self.model.triangles.iter().enumerate().filter(|(t, _)| !state.removed[*t]) {
            let counts = if state.left_out[t] { &mut left_out } else { &mut others };
            node.vertices.iter().for_each(|v| counts[*v] += 1);
            triangles.extend((!state.left_out[t]).then_some(node.vertices));
        }
        let lowest = components(count, &triangles, &[]);
        let origins =
            components(count, &self.model.triangles.iter().map(|node| node.vertices).collect::<Vec<_>>(), &[]);
        let mut pieces = vec![BTreeSet::new(); count];
        for [vertex, ..] in &triangles {
            pieces[origins[*vertex]].insert(lowest[*vertex]);
        }
        let is_unneeded = |(t, node): (usize, &Node)| {
            let held: Vec<usize> = node.vertices.into_iter().filter(|v| others[*v] > 0).map(|v| lowest[v]).collect();
            let is_shared = node.vertices.iter().any(|v| others[*v] == 0 && left_out[*v] > 1);
            let hangs_together = !is_shared && held.windows(2).all(|pair| pair[0] == pair[1]);
            let is_in_one = pieces[origins[node.vertices[0]]].len() <= 1;
            state.left_out[t] && !state.removed[t] && (hangs_together || is_in_one)
        };
        self.model.triangles.iter().enumerate().map(is_unneeded).collect()
    }

    /// The finest triangles that are left, in order.
    pub fn stream(&self, state: &State) -> Vec<[usize; 3]> {
        let left = self.model.triangles.iter().zip(&state.removed).filter(|(_, removed)| !**removed);
        left.map(|(node, _)| node.corners).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::Scene;
    use super::*;

    #[test]
    fn what_is_left_and_what_is_removed_is_the_whole() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        for v in 0..state.left.len() / 2 {
            state.left[v] = 0;
        }
        let mut constants = scene.constants.clone();
        constants.keep_connected = false;
        let tick = Tick { constants: &constants, ..tick };
        tick.remove(&mut state);
        let removed = state.removed.iter().filter(|r| **r).count();
        assert!(removed > 0);
        assert_eq!(tick.stream(&state).len() + removed, scene.model.triangles.len());
        // It never comes back.
        state.left.fill(60);
        tick.remove(&mut state);
        assert_eq!(state.removed.iter().filter(|r| **r).count(), removed);
    }

    #[test]
    fn a_belt_burns_to_a_strand_and_goes_with_what_hangs_on_it() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        let heights: Vec<f64> = scene.model.rest.iter().map(|p| p.y).collect();
        let middle = heights.iter().sum::<f64>() / heights.len() as f64;
        let burn = |state: &mut State, is_burnt: &dyn Fn(f64) -> bool| {
            for (left, height) in state.left.iter_mut().zip(&heights) {
                *left = if is_burnt(height - middle) { 0 } else { *left };
            }
            for _ in 0..800 {
                state.tick += 1;
                tick.remove(state);
            }
            let there = scene.model.triangles.iter().zip(&state.removed).filter(|(_, removed)| !**removed);
            let there: Vec<[usize; 3]> = there.map(|(node, _)| node.vertices).collect();
            let lowest = components(heights.len(), &there, &[]);
            let parts: BTreeSet<usize> = there.iter().map(|t| lowest[t[0]]).collect();
            let consumed = (0..state.removed.len()).filter(|t| tick.is_consumed(state, *t));
            let (mut all, mut kept) = (0, 0);
            consumed.for_each(|t| {
                all += 1;
                kept += usize::from(!state.removed[t]);
            });
            (parts.len(), kept, all)
        };
        let (parts, kept, all) = burn(&mut state, &|height| height.abs() < 0.1);
        assert!(parts == 1 && kept > 0 && kept < all / 4, "{parts} parts, {kept} of {all}");
        let (parts, kept, _) = burn(&mut state, &|height| height > 0.0);
        assert_eq!((parts, kept), (1, 0));
    }
}
