//! The multilevel altitude map (section 3): its shape, and its levels on the CPU.

use rayon::prelude::*;

use super::parameters::Interpolation;
use crate::scene::{HeightMap, Rows, Samples};

/// Sizes of the levels of a map. The paper counts levels from the coarsest, 0, to the data, n; a shift counts from the data,
/// 0, to the single texel, `top`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shape {
    /// Columns of the data.
    pub width: u32,
    /// Rows of the data.
    pub height: u32,
    /// The shift of the level of one texel: n.
    pub top: u32,
}

impl Shape {
    /// Of a map of `width` x `height` samples, at least 1 each.
    pub fn new(width: u32, height: u32) -> Self {
        Shape { width, height, top: width.max(height).next_power_of_two().trailing_zeros() }
    }

    /// The samples a side that a map of 2^n x 2^n has: the smallest that holds this one.
    pub fn side(self) -> u32 {
        1 << self.top
    }

    /// Columns and rows of a level.
    pub fn level(self, shift: u32) -> (u32, u32) {
        let half = |samples: u32| ((samples - 1) >> shift) + 1;
        (half(self.width), half(self.height))
    }

    /// The axis along which the coarser levels lie one after another in their layer: that of the longer side.
    pub fn axis(self) -> (u32, u32) {
        if self.width >= self.height { (1, 0) } else { (0, 1) }
    }

    /// The first texel of a coarser level, `shift` at least 1, in its layer: at its own padded width, so that none overlap and
    /// a shader finds it by shifting.
    pub fn origin(self, shift: u32) -> (u32, u32) {
        let (x, y) = self.axis();
        let offset = self.side() >> shift;
        (x * offset, y * offset)
    }

    /// Columns and rows that the data and the layer of coarser levels need.
    pub fn extent(self) -> (u32, u32) {
        let (width, height) = self.coarser_extent();
        (width.max(self.width), height.max(self.height))
    }

    /// Columns and rows that the layer of coarser levels needs.
    pub fn coarser_extent(self) -> (u32, u32) {
        (1..=self.top).fold((1, 1), |(width, height), shift| {
            let ((x, y), (columns, rows)) = (self.origin(shift), self.level(shift));
            (width.max(x + columns), height.max(y + rows))
        })
    }

    /// Columns and rows of an image that has the data and, beside them, the coarser levels: below where those lie along the rows.
    pub fn corners_extent(self) -> (u32, u32) {
        let (width, height) = self.coarser_extent();
        match self.axis() {
            (1, _) => (width.max(self.width), self.height + height),
            _ => (self.width + width, height.max(self.height)),
        }
    }
}

/// The choice of a coarser texel among its four finer ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bound {
    Highest,
    Lowest,
}

/// Nodes that a texel of the first level above the data covers; each coarser one covers four of those.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cover {
    /// 2 x 2 nodes: the paper's.
    Nodes,
    /// All nodes that the surface over 2 x 2 cells reads.
    Cells(Interpolation),
}

impl Cover {
    /// Nodes before and after 2 x 2.
    pub fn more(self) -> [u32; 2] {
        match self {
            Cover::Nodes => [0, 0],
            Cover::Cells(Interpolation::Bilinear) => [0, 1],
            Cover::Cells(Interpolation::Bicubic) => [1, 2],
        }
    }
}

/// A number that a texel holds.
pub trait Texel: bytemuck::Pod + PartialOrd + Send + Sync {
    fn to_f32(self) -> f32;

    /// The samples of a map that holds this kind; none of another's.
    fn samples_of(map: &HeightMap) -> &[Self];

    /// Rows of this kind; none of another's.
    fn rows_of(rows: Rows<'_>) -> &[Self];
}

impl Texel for u16 {
    fn to_f32(self) -> f32 {
        f32::from(self)
    }

    fn samples_of(map: &HeightMap) -> &[Self] {
        if let Samples::Steps { values, .. } = map.samples() { values } else { &[] }
    }

    fn rows_of(rows: Rows<'_>) -> &[Self] {
        if let Rows::Steps(values) = rows { values } else { &[] }
    }
}

impl Texel for f32 {
    fn to_f32(self) -> f32 {
        self
    }

    fn samples_of(map: &HeightMap) -> &[Self] {
        if let Samples::Float(values) = map.samples() { values } else { &[] }
    }

    fn rows_of(rows: Rows<'_>) -> &[Self] {
        if let Rows::Float(values) = rows { values } else { &[] }
    }
}

/// The levels above the data, by shift from 1 on, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Pyramid<T> {
    /// Sizes of the levels.
    pub shape: Shape,
    coarser: Vec<Vec<T>>,
}

impl<T: Texel> Pyramid<T> {
    /// Builds every level from `data`, which has the samples of `shape`; texels cover their nodes.
    pub fn build(shape: Shape, data: &[T], bound: Bound) -> Self {
        Self::covering(shape, data, (bound, Cover::Nodes))
    }

    /// As [`Pyramid::build`], of texels that cover more.
    pub fn covering(shape: Shape, data: &[T], (bound, cover): (Bound, Cover)) -> Self {
        let mut coarser: Vec<Vec<T>> = Vec::new();
        for shift in 1..=shape.top {
            let sizes = (shape.level(shift - 1), shape.level(shift));
            let level = match coarser.last() {
                None if cover != Cover::Nodes => coarsen_more(data, sizes, bound, cover.more()),
                finer => coarsen(finer.map_or(data, |level| level), sizes, bound),
            };
            coarser.push(level);
        }
        Pyramid { shape, coarser }
    }

    /// The texels of a level above the data.
    #[inline]
    pub fn level(&self, shift: u32) -> Option<&[T]> {
        self.coarser.get((shift as usize).checked_sub(1)?).map(Vec::as_slice)
    }
}

/// Columns and rows of a level and of the next coarser one.
pub type Sizes = ((u32, u32), (u32, u32));

fn higher<T: Texel>(a: T, b: T) -> T {
    if a < b { b } else { a }
}

fn lower<T: Texel>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The next coarser level, of texels that cover so many of the finer ones before and after their four as well.
fn coarsen_more<T: Texel>(finer: &[T], sizes: Sizes, bound: Bound, more: [u32; 2]) -> Vec<T> {
    match bound {
        Bound::Highest => choose_more(finer, sizes, more, higher),
        Bound::Lowest => choose_more(finer, sizes, more, lower),
    }
}

/// Columns first, then along the row: whole rows of texels are compared at once.
fn choose_more<T: Texel>(
    finer: &[T],
    ((columns, rows), (width, height)): Sizes,
    [before, after]: [u32; 2],
    choose: impl Fn(T, T) -> T + Sync,
) -> Vec<T> {
    let covered = |at: usize, count: u32| {
        let first = (2 * at).saturating_sub(before as usize);
        first..(2 * at + 2 + after as usize).min(count as usize)
    };
    let mut level = bytemuck::allocation::zeroed_vec::<T>(width as usize * height as usize);
    level.par_chunks_mut(width as usize).enumerate().for_each_init(Vec::new, |line, (row, coarse)| {
        let mut texels = covered(row, rows).map(|row| &finer[row * columns as usize..][..columns as usize]);
        line.clear();
        line.extend_from_slice(texels.next().unwrap_or_default());
        for texels in texels {
            line.iter_mut().zip(texels).for_each(|(chosen, &texel)| *chosen = choose(*chosen, texel));
        }
        for (column, texel) in coarse.iter_mut().enumerate() {
            let texels = &line[covered(column, columns)];
            *texel = texels.iter().skip(1).fold(texels[0], |chosen, &texel| choose(chosen, texel));
        }
    });
    level
}

/// The next coarser level, each texel chosen among its four finer ones.
pub fn coarsen<T: Texel>(finer: &[T], sizes: Sizes, bound: Bound) -> Vec<T> {
    match bound {
        Bound::Highest => choose_of_four(finer, sizes, higher),
        Bound::Lowest => choose_of_four(finer, sizes, lower),
    }
}

fn choose_of_four<T: Texel>(
    finer: &[T],
    ((columns, _), (width, height)): Sizes,
    choose: impl Fn(T, T) -> T + Sync,
) -> Vec<T> {
    let columns = columns as usize;
    let mut level = bytemuck::allocation::zeroed_vec::<T>(width as usize * height as usize);
    level.par_chunks_mut(width as usize).zip(finer.par_chunks(2 * columns)).for_each(|(coarse, pair)| {
        let (north, south) = pair.split_at(columns);
        // Of an odd number the last row is alone.
        let south = if south.is_empty() { north } else { south };
        let (north, south) = (north.as_chunks::<2>(), south.as_chunks::<2>());
        for (texel, (north, south)) in coarse.iter_mut().zip(north.0.iter().zip(south.0)) {
            *texel = choose(choose(north[0], north[1]), choose(south[0], south[1]));
        }
        if let (&[north], &[south], [.., texel]) = (north.1, south.1, coarse) {
            *texel = choose(north, south);
        }
    });
    level
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_lie_apart_inside_the_extent() {
        for (width, height) in [(1, 1), (2, 1), (1, 9), (5, 3), (17, 200), (200, 200), (257, 256), (16_384, 16_384)] {
            let shape = Shape::new(width, height);
            assert_eq!(shape.level(shape.top), (1, 1));
            let extent = shape.extent();
            let places: Vec<_> = (1..=shape.top).map(|s| (shape.origin(s), shape.level(s))).collect();
            for (i, ((x, y), (columns, rows))) in places.iter().enumerate() {
                assert!(x + columns <= extent.0 && y + rows <= extent.1);
                for ((a, b), (c, d)) in &places[..i] {
                    assert!(x + columns <= *a || a + c <= *x || y + rows <= *b || b + d <= *y, "{width} x {height}");
                }
            }
        }
        assert_eq!(Shape::new(16_384, 16_384).extent(), (16_384, 16_384));
    }

    #[test]
    fn corners_of_coarser_levels_lie_beside_those_of_the_data() {
        for (width, height) in [(2, 1), (1, 9), (5, 3), (17, 200), (200, 200), (257, 256), (1024, 1024)] {
            let shape = Shape::new(width, height);
            let ((columns, rows), (x, y)) = (shape.corners_extent(), shape.axis());
            let beside = (y * width, x * height);
            for shift in 1..=shape.top {
                let (origin, level) = (shape.origin(shift), shape.level(shift));
                let first = (beside.0 + origin.0, beside.1 + origin.1);
                assert!(first.0 >= width || first.1 >= height, "{width} x {height}: level {shift} over the data");
                assert!(first.0 + level.0 <= columns && first.1 + level.1 <= rows, "{width} x {height}: level {shift}");
            }
        }
        assert_eq!(Shape::new(1024, 1024).corners_extent(), (1024, 1536));
    }

    #[test]
    fn a_texel_bounds_all_samples_below_it() {
        let shape = Shape::new(13, 7);
        let data: Vec<u16> = (0..91u32).map(|i| (i * 7919 % 1009) as u16).collect();
        for bound in [Bound::Highest, Bound::Lowest] {
            let pyramid = Pyramid::build(shape, &data, bound);
            for shift in 1..=shape.top {
                let (columns, rows) = shape.level(shift);
                let level = pyramid.level(shift).expect("the level exists");
                assert_eq!(level.len(), (columns * rows) as usize);
                for (i, &texel) in level.iter().enumerate() {
                    let (column, row) = (i as u32 % columns, i as u32 / columns);
                    let below = (0..91u32).filter(|s| ((s % 13) >> shift, (s / 13) >> shift) == (column, row));
                    let values = below.map(|s| data[s as usize]);
                    let expected = if bound == Bound::Highest { values.max() } else { values.min() };
                    assert_eq!(Some(texel), expected);
                }
            }
        }
    }

    /// Texels that walks read bound all that the surface over their cells reads.
    #[test]
    fn a_texel_of_cells_bounds_what_their_surface_reads() {
        let (width, height) = (13, 7);
        let shape = Shape::new(width, height);
        let data: Vec<u16> = (0..91u32).map(|i| (i * 7919 % 1009) as u16).collect();
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            // Nodes before a cell's own and after, as the interpolation reads them.
            let (before, after) = if interpolation == Interpolation::Bilinear { (0, 1) } else { (1, 2) };
            for bound in [Bound::Highest, Bound::Lowest] {
                let pyramid = Pyramid::covering(shape, &data, (bound, Cover::Cells(interpolation)));
                for shift in 1..=shape.top {
                    let (columns, side) = (shape.level(shift).0, 1_u32 << shift);
                    for (i, &texel) in pyramid.level(shift).expect("the level exists").iter().enumerate() {
                        let (column, row) = (i as u32 % columns, i as u32 / columns);
                        let along = |at: u32, count: u32| {
                            (at * side).saturating_sub(before)..((at + 1) * side + after).min(count)
                        };
                        let read = along(row, height).flat_map(|y| along(column, width).map(move |x| y * width + x));
                        let values = read.map(|sample| data[sample as usize]);
                        let expected = if bound == Bound::Highest { values.max() } else { values.min() };
                        assert_eq!(
                            Some(texel),
                            expected,
                            "{interpolation:?} {bound:?}: level {shift}, {column}, {row}"
                        );
                    }
                }
            }
        }
    }
}
