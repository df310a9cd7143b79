//! Section 3.5.4: the triangles that leave the drawn stream.

use super::{State, Tick, Variant};

impl Tick<'_> {
    /// True for a triangle with nothing left at its three corners.
    pub fn is_consumed(&self, state: &State, triangle: usize) -> bool {
        self.model.triangles[triangle].vertices.iter().all(|v| state.left[*v] == 0)
    }

    /// True for a block without which a neighbour with weight would be left alone.
    pub fn is_needed(&self, state: &State, cell: usize) -> bool {
        let grid = &self.model.grid;
        let others = |n: usize| grid.weighty(n, &state.blocks).into_iter().filter(|other| *other != cell).count();
        grid.weighty(cell, &state.blocks).into_iter().any(|n| others(n) == 0)
    }

    /// Pass `surface-removal`. Solid and melting meshes lose nothing.
    pub fn remove(&self, state: &mut State) {
        if !matches!(self.variant, Variant::Solid | Variant::Melting) {
            for t in 0..self.model.triangles.len() {
                let cell = state.cells[self.model.triangles[t].vertices[0]];
                let is_kept = self.constants.keep_connected && self.is_needed(state, cell);
                state.removed[t] |= self.is_consumed(state, t) && !is_kept;
            }
        }
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
        tick.weigh(&state.clone(), &mut state);
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
    fn a_block_stays_as_long_as_another_hangs_on_it() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        let grid = scene.model.grid;
        // A row of three blocks with weight: the middle one holds both others, the ends hold nothing.
        for block in &mut state.blocks {
            block.live = 0;
        }
        let row = [[0, 0, 0], [1, 0, 0], [2, 0, 0]].map(|steps| grid.beside(0, steps).unwrap());
        for cell in row {
            state.blocks[cell].live = 1;
        }
        assert_eq!(row.map(|cell| tick.is_needed(&state, cell)), [false, true, false]);
        state.blocks[row[1]].live = 0;
        assert_eq!(row.map(|cell| tick.is_needed(&state, cell)), [false, true, false]);
        state.blocks[row[0]].live = 0;
        assert!(tick.is_needed(&state, row[1]));
        state.blocks[row[2]].live = 0;
        assert!(!tick.is_needed(&state, row[1]));
    }
}
