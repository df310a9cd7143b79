//! Section 3.5 with 5.4 and 6.4: blocks, their weights and rotations, and the vertices that they rotate.

use glam::{DMat3, DVec3};

use super::boundary::area;
use super::flames::pcg3d;
use super::{State, Tick, Variant};

/// Margin of the grid around the mesh on each side, in diagonals.
const MARGIN: f64 = 1e-4;
/// Degrees: bounds of a block's rotation, and of one with two or more free sides.
const BOUND: f64 = 2.0;
const FREE_BOUND: f64 = 15.0;

/// Blocks of equal size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Corner of the grid with the smallest coordinates.
    pub low: DVec3,
    /// Sides of one block.
    pub size: DVec3,
    /// Blocks along x, y and z.
    pub counts: [usize; 3],
}

/// The counts of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Block {
    /// Vertices with flammability left: the weight.
    pub live: u32,
    /// Live ones in the combustion-ready area.
    pub ready: u32,
    /// Sums of the signs of this tick's events: pitch, yaw, roll.
    pub signs: [i32; 3],
    /// Ticks with active vertices (section 5.4).
    pub burning: u32,
}

/// Direction of a face neighbour: axis and sign.
const FACES: [(usize, isize); 6] = [(0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)];

impl Grid {
    /// The grid around a mesh at rest.
    pub fn around(positions: &[DVec3], counts: [usize; 3]) -> Self {
        let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min) - MARGIN;
        let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) + MARGIN;
        Grid { low, size: (high - low) / DVec3::from_array(counts.map(|n| n as f64)), counts }
    }

    pub fn cells(&self) -> usize {
        self.counts.iter().product()
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn coordinates(&self, cell: usize) -> [usize; 3] {
        let [x, y, _] = self.counts;
        [cell % x, cell / x % y, cell / x / y]
    }

    /// The block of a point, or that nearest to it.
    pub fn cell(&self, point: DVec3) -> usize {
        let at = (point - self.low) / self.size;
        self.number([0, 1, 2].map(|k| at[k].clamp(0.0, self.counts[k] as f64 - 0.5) as usize))
    }

    /// Distance of a point from the nearest wall between two blocks.
    pub fn margin(&self, point: DVec3) -> f64 {
        let walls = |k: usize| (1..self.counts[k]).map(move |i| (k, i as f64));
        let away = |(k, i): (usize, f64)| (self.low[k] + i * self.size[k] - point[k]).abs();
        (0..3).flat_map(walls).map(away).fold(f64::INFINITY, f64::min)
    }

    pub fn midpoint(&self, cell: usize) -> DVec3 {
        let at = DVec3::from_array(self.coordinates(cell).map(|i| i as f64 + 0.5));
        self.low + at * self.size
    }

    /// The block so many steps along each axis, unless it is outside.
    pub fn beside(&self, cell: usize, steps: [isize; 3]) -> Option<usize> {
        let mut at = self.coordinates(cell);
        for k in 0..3 {
            at[k] = at[k].checked_add_signed(steps[k]).filter(|i| *i < self.counts[k])?;
        }
        Some(self.number(at))
    }

    /// Face neighbours with the axis on which they lie; `None` is outside of the grid.
    pub fn neighbours(&self, cell: usize) -> [(usize, Option<usize>); 6] {
        FACES.map(|(axis, step)| {
            let mut steps = [0; 3];
            steps[axis] = step;
            (axis, self.beside(cell, steps))
        })
    }

    /// The neighbours that have weight.
    pub fn weighty(&self, cell: usize, blocks: &[Block]) -> Vec<usize> {
        self.neighbours(cell).into_iter().filter_map(|(_, n)| n.filter(|n| blocks[*n].live > 0)).collect()
    }

    /// Number of the four sides (x and z) without a block with weight.
    pub fn free_sides(&self, cell: usize, blocks: &[Block]) -> usize {
        let sides = self.neighbours(cell).into_iter().filter(|(axis, _)| *axis != 1);
        sides.filter(|(_, n)| n.is_none_or(|n| blocks[n].live == 0)).count()
    }
}

impl Tick<'_> {
    /// The block that each vertex is in now. Answers for each vertex how far it is from the next one.
    pub fn locate(&self, state: &mut State) -> Vec<f64> {
        let grid = &self.model.grid;
        state.cells = state.positions.iter().map(|p| grid.cell(*p)).collect();
        state.positions.iter().map(|p| grid.margin(*p)).collect()
    }

    /// Pass `block-weights` once every vertex is located; `before` is the state of the last tick. Answers for each
    /// block how close the signs of its events are to changing, in lengths.
    pub fn weigh(&self, before: &State, state: &mut State) -> Vec<f64> {
        let grid = &self.model.grid;
        let mut margins = vec![f64::INFINITY; grid.cells()];
        state.blocks = before.blocks.iter().map(|b| Block { burning: b.burning, ..Block::default() }).collect();
        let mut is_burning = vec![false; grid.cells()];
        let retired = self.constants.retire_at * f64::from(self.constants.flammability);
        let was_active = |v: usize| state.labels[v] == area::DEFORMED && f64::from(before.left[v]) > retired;
        for v in 0..state.positions.len() {
            let (old, new) = (before.cells[v], state.cells[v]);
            let is_live = state.is_live(v);
            // Active at the start of the tick, in the areas of this one.
            is_burning[new] |= was_active(v);
            state.blocks[new].live += u32::from(is_live);
            state.blocks[new].ready += u32::from(is_live && state.labels[v] == area::READY);
            let is_consumed = before.is_live(v) && !is_live;
            if (is_consumed || (is_live && old != new)) && state.labels[v] >= area::INITIAL {
                let offset = state.positions[v] - grid.midpoint(old);
                let sign = |x: f64| if x == 0.0 { 0 } else { x.signum() as i32 };
                let signs = match self.constants.random_rotation {
                    true => pcg3d([self.constants.seed, v as u32, state.tick]).map(|h| 2 * (h >> 31) as i32 - 1),
                    false => [-sign(offset.z), sign(offset.y), sign(offset.x)],
                };
                for (sum, sign) in state.blocks[old].signs.iter_mut().zip(signs) {
                    *sum += sign;
                }
                margins[old] = margins[old].min(offset.abs().min_element());
            }
        }
        if self.variant == Variant::Solid {
            for (block, is_burning) in state.blocks.iter_mut().zip(is_burning) {
                block.burning += u32::from(is_burning);
            }
        }
        margins
    }

    /// Section 6.4: melting blocks rotate only outside of the combustion-ready boundary and above the ignition.
    fn can_rotate(&self, state: &State, cell: usize) -> bool {
        if self.variant != Variant::Melting {
            return true;
        }
        let ignition = self.constants.sources.iter().map(|s| s.y).fold(f64::NEG_INFINITY, f64::max);
        let is_ready = |v: usize| state.cells[v] == cell && state.labels[v] >= area::READY;
        self.model.grid.midpoint(cell).y > ignition && !(0..state.cells.len()).any(is_ready)
    }

    /// Pass `block-rotation`: equations 4 and 5, then the spread to the neighbours.
    pub fn rotate(&self, state: &mut State) {
        let grid = &self.model.grid;
        let own: Vec<DVec3> = (0..grid.cells())
            .map(|cell| {
                let count = self.weight(&state.blocks[cell]).max(1.0);
                let neighbours = grid.weighty(cell, &state.blocks).len().max(1) as f64;
                let step = self.constants.gamma * self.constants.rho * std::f64::consts::PI / (count * neighbours);
                step * DVec3::from_array(state.blocks[cell].signs.map(f64::from))
            })
            .collect();
        for cell in 0..grid.cells() {
            if state.blocks[cell].live == 0 || !self.can_rotate(state, cell) {
                continue;
            }
            let taken = grid.neighbours(cell).into_iter().filter_map(|(axis, neighbour)| {
                let fraction = if axis == 1 { self.constants.spread } else { -self.constants.spread };
                neighbour.map(|n| fraction * own[n])
            });
            let change = own[cell] + taken.sum::<DVec3>();
            let bound = if grid.free_sides(cell, &state.blocks) >= 2 { FREE_BOUND } else { BOUND }.to_radians();
            let rotated = state.rotations[cell] + change;
            state.rotations[cell] = rotated.clamp(DVec3::splat(-bound), DVec3::splat(bound));
        }
    }

    /// The number of vertices N of a block; section 5.4 factors it with the combustion counter.
    fn weight(&self, block: &Block) -> f64 {
        let live = f64::from(block.live);
        if self.variant != Variant::Solid {
            return live;
        }
        live / (1.0 + f64::from(block.burning) / f64::from(self.constants.flammability))
    }

    /// Pass `vertex-mapping` (section 3.5.3): each vertex rotated with its block about the block's middle,
    /// and none below the ground.
    pub fn map(&self, state: &mut State) {
        for v in 0..state.positions.len() {
            let cell = state.cells[v];
            let (middle, [pitch, yaw, roll]) = (self.model.grid.midpoint(cell), state.rotations[cell].to_array());
            let rotation = DMat3::from_rotation_z(roll) * DMat3::from_rotation_y(yaw) * DMat3::from_rotation_x(pitch);
            state.mapped[v] = middle + rotation * (state.positions[v] - middle);
            let ground = self.constants.ground.unwrap_or(f64::NEG_INFINITY);
            state.mapped[v].y = state.mapped[v].y.max(ground);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::Scene;
    use super::*;

    #[test]
    fn cells_partition_the_grid() {
        let grid = Grid::around(&[DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)], [2, 3, 4]);
        for cell in 0..grid.cells() {
            assert_eq!(grid.cell(grid.midpoint(cell)), cell);
            assert!((grid.margin(grid.midpoint(cell)) - grid.size.min_element() / 2.0).abs() < 1e-12);
            for (axis, neighbour) in grid.neighbours(cell) {
                let Some(neighbour) = neighbour else { continue };
                let step = grid.midpoint(neighbour) - grid.midpoint(cell);
                assert!((step.length() - grid.size[axis]).abs() < 1e-12 && step[axis].abs() > 0.0);
            }
        }
        assert_eq!(grid.cell(DVec3::splat(-9.0)), 0);
        assert_eq!(grid.cell(DVec3::splat(99.0)), grid.cells() - 1);
    }

    #[test]
    fn a_vertex_that_leaves_rotates_its_block_away_and_the_neighbours_along() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        let v = 5;
        let (home, grid) = (state.cells[v], scene.model.grid);
        // Consumed in the tick, right of, above and behind the middle.
        let before = state.clone();
        state.left[v] = 0;
        state.labels[v] = area::DEFORMED;
        state.positions[v] = grid.midpoint(home) + grid.size * DVec3::new(0.2, 0.2, -0.2);
        tick.locate(&mut state);
        tick.weigh(&before, &mut state);
        assert_eq!(state.blocks[home].signs, [1, 1, 1]);
        let total: u32 = state.blocks.iter().map(|b| b.live).sum();
        assert_eq!(total as usize, state.positions.len() - 1);
        tick.rotate(&mut state);
        let own = state.rotations[home];
        let [n, m] = [state.blocks[home].live as usize, grid.weighty(home, &state.blocks).len()];
        let expected = scene.constants.gamma * scene.constants.rho * std::f64::consts::PI / (n * m) as f64;
        assert!(own.distance(DVec3::splat(expected)) < 1e-12, "{own} {expected}");
        for (axis, neighbour) in grid.neighbours(home) {
            if let Some(cell) = neighbour.filter(|c| state.blocks[*c].live > 0) {
                let fraction = if axis == 1 { 0.5 } else { -0.5 };
                assert!(state.rotations[cell].distance(fraction * own) < 1e-12);
            }
        }
    }

    #[test]
    fn rotations_stay_small_and_blocks_stay_rigid() {
        let scene = Scene::sphere(Variant::Shell);
        let tick = scene.tick();
        let mut state = State::at_rest(&tick);
        for block in &mut state.blocks {
            block.signs = [500, -500, 500];
        }
        tick.rotate(&mut state);
        let bounds = [2.0f64, 15.0].map(f64::to_radians);
        for (cell, rotation) in state.rotations.iter().enumerate() {
            let highest = rotation.abs().max_element();
            if state.blocks[cell].live == 0 {
                assert_eq!(highest, 0.0);
            } else {
                assert!(bounds.contains(&highest) || highest < bounds[0], "{rotation}");
            }
        }
        tick.map(&mut state);
        for a in 0..state.positions.len() {
            let others = (0..a).filter(|b| state.cells[*b] == state.cells[a]);
            for b in others {
                let [apart, mapped] = [&state.positions, &state.mapped].map(|p| p[a].distance(p[b]));
                assert!((apart - mapped).abs() < 1e-12);
            }
        }
    }
}
