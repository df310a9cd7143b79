//! A map with its pyramid on the processor.

use std::sync::Arc;

use glam::{IVec2, Vec2};

use super::parameters::Interpolation;
use super::pyramid::{Bound, Cover, Pyramid, Shape, Texel};
use crate::scene::{HeightMap, Samples};

/// The samples of a map and the levels above them.
#[derive(Debug, Clone)]
pub struct HeightField {
    map: Arc<HeightMap>,
    levels: Levels,
    interpolation: Interpolation,
    cover: Cover,
}

#[derive(Debug, Clone)]
enum Levels {
    Steps(Bounds<u16>),
    Float(Bounds<f32>),
}

#[derive(Debug, Clone)]
struct Bounds<T> {
    highest: Pyramid<T>,
    /// For Catmull-Rom surfaces alone.
    lowest: Option<Pyramid<T>>,
}

impl<T: Texel> Bounds<T> {
    fn new(map: &HeightMap, interpolation: Interpolation, cover: Cover) -> Self {
        let shape = Shape::new(map.width(), map.height());
        let build = |bound| Pyramid::covering(shape, T::samples_of(map), (bound, cover));
        let lowest = (interpolation == Interpolation::Bicubic).then(|| build(Bound::Lowest));
        Bounds { highest: build(Bound::Highest), lowest }
    }

    fn field<'a>(&'a self, of: &'a HeightField) -> Field<'a, T> {
        let HeightField { map, interpolation, cover, .. } = of;
        let (data, lowest) = (T::samples_of(map), self.lowest.as_ref());
        Field { data, highest: &self.highest, lowest, interpolation: *interpolation, cover: *cover }
    }
}

/// Work that is compiled for each kind of sample.
pub trait FieldWork {
    type Output;

    fn run<T: Texel>(self, field: Field<'_, T>) -> Self::Output;
}

impl HeightField {
    /// Builds the levels on all cores.
    pub fn new(map: &Arc<HeightMap>, interpolation: Interpolation, cover: Cover) -> Self {
        let levels = match map.samples() {
            Samples::Steps { .. } => Levels::Steps(Bounds::new(map, interpolation, cover)),
            Samples::Float(_) => Levels::Float(Bounds::new(map, interpolation, cover)),
        };
        HeightField { map: map.clone(), levels, interpolation, cover }
    }

    pub fn with<W: FieldWork>(&self, work: W) -> W::Output {
        match &self.levels {
            Levels::Steps(bounds) => work.run(bounds.field(self)),
            Levels::Float(bounds) => work.run(bounds.field(self)),
        }
    }
}

/// The values of one map, and the surface between its samples.
#[derive(Clone, Copy)]
pub struct Field<'a, T> {
    data: &'a [T],
    highest: &'a Pyramid<T>,
    lowest: Option<&'a Pyramid<T>>,
    /// The surface between the samples.
    pub interpolation: Interpolation,
    /// The nodes that texels of the levels bound.
    pub cover: Cover,
}

/// The cell of a level around a place: its north-west corner, and where the place lies in it, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// Column and row of the north-west corner.
    pub corner: IVec2,
    /// The place in the cell, 0 to 1.
    pub uv: Vec2,
}

// Rays ask these at every step, from other files. `#[inline]`, here and there: the compiler splits the library into units of
// a few files each, and inlines across them what is so marked, with or without link-time optimisation.
impl<T: Texel> Field<'_, T> {
    #[inline]
    pub fn shape(&self) -> Shape {
        self.highest.shape
    }

    /// The last column and row of a level.
    #[inline]
    pub fn last(&self, shift: i32) -> IVec2 {
        let shape = self.shape();
        IVec2::new((shape.width as i32 - 1) >> shift, (shape.height as i32 - 1) >> shift)
    }

    /// The highest or lowest values `shift` levels above the data, row by row; the level exists.
    #[inline]
    pub fn level(&self, bound: Bound, shift: u32) -> &[T] {
        match bound {
            _ if shift == 0 => self.data,
            Bound::Highest => self.highest.level(shift).unwrap_or_default(),
            Bound::Lowest => self.lowest.and_then(|lowest| lowest.level(shift)).unwrap_or_default(),
        }
    }

    /// The highest or lowest value of what a texel `shift` levels above the data covers; the texel exists.
    #[inline]
    pub fn value(&self, bound: Bound, shift: i32, texel: IVec2) -> f32 {
        let columns = ((self.shape().width as usize - 1) >> shift) + 1;
        let index = texel.y as usize * columns + texel.x as usize;
        self.level(bound, shift as u32).get(index).map_or(0.0, |value| value.to_f32())
    }

    /// The cell around a place in nodes. A coarser level's texel stands in the middle of the nodes that it covers.
    #[inline]
    pub fn cell(&self, shift: i32, place: Vec2) -> Cell {
        let size = (-shift as f32).exp2();
        let last = self.last(shift);
        let texel = (place * size + (0.5 * size - 0.5)).clamp(Vec2::ZERO, last.as_vec2());
        let corner = texel.as_ivec2().min((last - 1).max(IVec2::ZERO));
        Cell { corner, uv: texel - corner.as_vec2() }
    }
}

/// The smallest number of levels above the data whose texels are as large as an extent in nodes:
/// 1/2^(level + 1) < Lp <= 1/2^level.
#[inline]
pub fn shift_for(extent: f32, top: u32) -> i32 {
    let exponent = ((extent.to_bits() as i32 + 0x7f_ffff) >> 23) - 127;
    exponent.clamp(0, top as i32)
}
