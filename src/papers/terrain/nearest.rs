//! The nearest point of a map's solid, in double precision, through the same altitude map as the rays.
//!
//! Blocks of cells are boxes between the base and the level's maximum; a block farther away than what was found is left out,
//! any other is quartered, nearer quarters first, down to the cells. A cell's surface is cut into squares in the same way: it
//! leaves its tangent by no more than its second derivatives allow, so that the nearest point of the tangent bounds it. The
//! walls are found without a search.

use glam::{DVec2, DVec3, IVec2};

use super::height_field::{Field, FieldWork};
use super::hit::Surface;
use super::interpolation::Patch;
use super::pyramid::Texel;
use super::solid::Solid;

/// The precision of distances, as a fraction of a cell.
const TOLERANCE_CELLS: f64 = 1e-7;
/// Halvings of a cell after which a square is a point.
const DEEPEST: u32 = 40;
/// The rounding of a level's maximum in single precision, as a fraction of the height.
const ROUNDING: f64 = 1e-6;

/// The nearest point so far.
#[derive(Debug, Clone, Copy)]
pub struct Nearest {
    /// From the centre.
    pub distance_m: f64,
    /// In the map's frame.
    pub point: DVec3,
    /// The surface that it lies on.
    pub surface: Surface,
    /// Blocks and squares that were tried.
    pub steps: u32,
}

/// Looks for what is nearer than `best`.
pub struct Search<'a> {
    /// The map's solid.
    pub solid: Solid<'a>,
    /// In the map's frame.
    pub center: DVec3,
    /// The nearest point that is known.
    pub best: Nearest,
}

/// A block of cells: number (x, y) of those of 2^shift cells a side.
struct Block {
    shift: i32,
    number: IVec2,
    at_least_m: f64,
}

/// A part of a cell, 0 to 1.
struct Square {
    middle: DVec2,
    halvings: u32,
}

impl FieldWork for Search<'_> {
    type Output = Nearest;

    fn run<T: Texel>(mut self, field: Field<'_, T>) -> Nearest {
        let (place, height_m) = self.solid.place(self.center);
        if self.height_at(&field, place).is_some_and(|ground_m| height_m <= ground_m) {
            return Nearest { distance_m: 0.0, point: self.center, surface: Surface::Inside, ..self.best };
        }
        self.walls(&field);
        let root = Block { shift: field.shape().top as i32, number: IVec2::ZERO, at_least_m: 0.0 };
        let mut stack = vec![root];
        while let Some(Block { shift, number, at_least_m }) = stack.pop() {
            if at_least_m >= self.enough_m() {
                continue;
            }
            if shift == 0 {
                self.cell(&field, number);
                continue;
            }
            let quarters = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|quarter| 2 * number + IVec2::from(quarter));
            let mut nearer: Vec<Block> =
                quarters.into_iter().filter_map(|q| self.block(&field, shift - 1, q)).collect();
            nearer.sort_by(|a, b| b.at_least_m.total_cmp(&a.at_least_m));
            stack.extend(nearer);
        }
        self.best
    }
}

impl Search<'_> {
    /// The distance from which on nothing matters.
    fn enough_m(&self) -> f64 {
        self.best.distance_m - TOLERANCE_CELLS * self.solid.cell_m()
    }

    fn offer(&mut self, point: DVec3, surface: Surface) {
        let distance_m = point.distance(self.center);
        if distance_m < self.best.distance_m {
            self.best = Nearest { distance_m, point, surface, ..self.best };
        }
    }

    /// The surface above the base at a place; none outside the map.
    fn height_at<T: Texel>(&self, field: &Field<'_, T>, place: DVec2) -> Option<f64> {
        let last = self.solid.last_node();
        if place.cmplt(DVec2::ZERO).any() || place.cmpgt(last).any() {
            return None;
        }
        let cell = place.min(last - 1.0).as_ivec2();
        Some(self.patch(field, cell).at(place - cell.as_dvec2()).height_m)
    }

    fn patch<T: Texel>(&self, field: &Field<'_, T>, cell: IVec2) -> Patch {
        Patch::new(field, cell, |number| self.solid.above_base_m(number))
    }

    /// The sides of the solid: the feet on them of the centre, and the edges between them.
    fn walls<T: Texel>(&mut self, field: &Field<'_, T>) {
        let last = self.solid.last_node();
        let sides = [
            (0, 0.0, Surface::WallWest),
            (0, last.x, Surface::WallEast),
            (1, 0.0, Surface::WallNorth),
            (1, last.y, Surface::WallSouth),
        ];
        let closes = self.solid.closes();
        for (axis, node, side) in sides.into_iter().filter(|(axis, ..)| *axis == 1 || !closes) {
            let foot = self.solid.foot_on_edge(axis, node, self.center);
            let (mut place, height_m) = self.solid.place(foot);
            place[axis] = node;
            if self.height_at(field, place).is_some_and(|ground_m| (0.0..=ground_m).contains(&height_m)) {
                self.offer(foot, side);
            }
        }
        if closes {
            return;
        }
        for (column, row) in [(0.0, 0.0), (last.x, 0.0), (0.0, last.y), (last.x, last.y)] {
            let corner = DVec2::new(column, row);
            let ground_m = self.height_at(field, corner).unwrap_or(0.0);
            let foot = self.solid.point(corner, 0.0);
            let [_, _, up] = self.solid.axes(corner, 0.0);
            if ground_m > 0.0 {
                let height_m = (self.center - foot).dot(up).clamp(0.0, ground_m);
                let side = if column == 0.0 { Surface::WallWest } else { Surface::WallEast };
                self.offer(foot + up * height_m, side);
            }
        }
    }

    /// A block, if it may hold something nearer. What lies below the base is no nearer than the base itself.
    fn block<T: Texel>(&mut self, field: &Field<'_, T>, shift: i32, number: IVec2) -> Option<Block> {
        let [first, last] = self.solid.span();
        let low = (number << shift).as_dvec2().max(first);
        let high = ((number + 1) << shift).as_dvec2().min(last);
        if low.cmpge(high).any() {
            return None;
        }
        self.best.steps += 1;
        let highest = field.highest_below(low.as_vec2(), high.as_vec2(), shift)?;
        let top_m = self.solid.above_base_m(highest.into());
        let top_m = top_m + ROUNDING * (top_m.abs() + self.solid.above_base_m(0.0).abs());
        if top_m < 0.0 {
            return None;
        }
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let apart = self.center - self.solid.point(middle, top_m / 2.0);
        let axes = self.solid.axes(middle, top_m / 2.0);
        // The distance to the box that the tangents span.
        let beyond = [half.x, half.y, top_m / 2.0].into_iter().zip(axes).map(|(reach, axis)| {
            let length = axis.length();
            let along = if length > 0.0 { apart.dot(axis).abs() / length } else { 0.0 };
            (along - reach * length).max(0.0)
        });
        let box_m = beyond.map(|beyond| beyond * beyond).sum::<f64>().sqrt();
        let at_least_m = box_m - self.solid.bend_m(half, top_m / 2.0, top_m);
        (at_least_m < self.enough_m()).then_some(Block { shift, number, at_least_m })
    }

    fn cell<T: Texel>(&mut self, field: &Field<'_, T>, cell: IVec2) {
        let patch = self.patch(field, cell);
        let bends = patch.bends();
        let mut stack = vec![Square { middle: DVec2::splat(0.5), halvings: 1 }];
        while let Some(Square { middle, halvings }) = stack.pop() {
            self.best.steps += 1;
            let half = 0.5_f64.powi(halvings as i32);
            let place = cell.as_dvec2() + middle;
            let sample = patch.at(middle);
            let [east, south, up] = self.solid.axes(place, sample.height_m);
            let apart = self.solid.point(place, sample.height_m) - self.center;
            let along = [east + up * sample.slope.x, south + up * sample.slope.y].map(|axis| axis * half);
            let (tangent_m, toward) = nearest_on_parallelogram(apart, along);
            let bend_m = half * half * (bends.x + 2.0 * bends.y + bends.z);
            let rise_m = half * sample.slope.abs().element_sum() + bend_m;
            let height_m = sample.height_m.abs() + rise_m;
            let at_least_m = tangent_m - 0.5 * bend_m - self.solid.bend_m(DVec2::splat(half), rise_m, height_m);
            if at_least_m >= self.enough_m() {
                continue;
            }
            let nearest = middle + half * toward;
            let foot = self.solid.point(cell.as_dvec2() + nearest, patch.at(nearest).height_m);
            self.offer(foot, Surface::Terrain);
            if halvings < DEEPEST {
                let quarters = [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)];
                let quarters = quarters.map(|quarter| middle + half * DVec2::from(quarter));
                stack.extend(quarters.map(|middle| Square { middle, halvings: halvings + 1 }));
            }
        }
    }
}

/// The least length of `from` + x `along[0]` + y `along[1]` for x and y of -1 to 1, and that x and y.
fn nearest_on_parallelogram(from: DVec3, along: [DVec3; 2]) -> (f64, DVec2) {
    let [a, b] = along;
    let (aa, ab, bb) = (a.length_squared(), a.dot(b), b.length_squared());
    let (fa, fb) = (from.dot(a), from.dot(b));
    let determinant = aa * bb - ab * ab;
    let free = DVec2::new(ab * fb - bb * fa, ab * fa - aa * fb) / determinant;
    let length = |at: DVec2| (from + at.x * a + at.y * b).length();
    if free.abs().max_element() <= 1.0 {
        return (length(free), free);
    }
    // A convex function is least on the border where it is not inside.
    let part = |along: f64, square: f64| if square > 0.0 { (-along / square).clamp(-1.0, 1.0) } else { 0.0 };
    let borders = [
        DVec2::new(-1.0, part(fb - ab, bb)),
        DVec2::new(1.0, part(fb + ab, bb)),
        DVec2::new(part(fa - ab, aa), -1.0),
        DVec2::new(part(fa + ab, aa), 1.0),
    ];
    borders
        .map(|at| (length(at), at))
        .into_iter()
        .fold((f64::INFINITY, DVec2::ZERO), |least, found| if found.0 < least.0 { found } else { least })
}
