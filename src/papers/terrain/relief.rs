//! A map with its pyramid on the CPU.

use std::sync::Arc;

use glam::{IVec2, Vec2, Vec4};

use super::pyramid::{Bound, Pyramid, Shape, Texel};
use crate::scene::{HeightMap, Samples};

/// The samples of a map and the levels above them.
#[derive(Debug, Clone)]
pub struct Relief {
    map: Arc<HeightMap>,
    highest: Levels,
}

#[derive(Debug, Clone)]
enum Levels {
    Steps(Pyramid<u16>),
    Float(Pyramid<f32>),
}

/// Work that is compiled for each kind of sample.
pub trait FieldWork {
    type Output;

    fn run<T: Texel>(self, field: Field<'_, T>) -> Self::Output;
}

impl Relief {
    /// Builds the levels on all cores.
    pub fn new(map: &Arc<HeightMap>) -> Self {
        let shape = Shape::new(map.width(), map.height());
        let highest = match map.samples() {
            Samples::Steps { values, .. } => Levels::Steps(Pyramid::build(shape, values, Bound::Highest)),
            Samples::Float(values) => Levels::Float(Pyramid::build(shape, values, Bound::Highest)),
        };
        Relief { map: map.clone(), highest }
    }

    pub fn map(&self) -> &Arc<HeightMap> {
        &self.map
    }

    pub fn with<W: FieldWork>(&self, work: W) -> W::Output {
        match &self.highest {
            Levels::Steps(highest) => work.run(Field { data: u16::samples_of(&self.map), highest }),
            Levels::Float(highest) => work.run(Field { data: f32::samples_of(&self.map), highest }),
        }
    }
}

/// The values of one map.
#[derive(Clone, Copy)]
pub struct Field<'a, T> {
    data: &'a [T],
    highest: &'a Pyramid<T>,
}

/// A cell of a level: its four corner values (north-west, north-east, south-west, south-east), the north-west corner in
/// texels of the level, and where the place lies in it, 0 to 1.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    pub corners: Vec4,
    pub corner: Vec2,
    pub part: Vec2,
}

impl Cell {
    /// Eq. 7.
    pub fn bilinear(&self) -> f32 {
        let c = self.corners;
        let north = c.x + (c.y - c.x) * self.part.x;
        let south = c.z + (c.w - c.z) * self.part.x;
        north + (south - north) * self.part.y
    }

    /// Change of the value over a texel of the level, along u and v.
    pub fn slope(&self) -> Vec2 {
        let c = self.corners;
        let (north, south) = (c.y - c.x, c.w - c.z);
        let (west, east) = (c.z - c.x, c.w - c.y);
        Vec2::new(north + (south - north) * self.part.y, west + (east - west) * self.part.x)
    }
}

impl<T: Texel> Field<'_, T> {
    pub fn shape(&self) -> Shape {
        self.highest.shape
    }

    /// The last column and row of a level.
    pub fn last(&self, shift: i32) -> IVec2 {
        let shape = self.shape();
        IVec2::new((shape.width as i32 - 1) >> shift, (shape.height as i32 - 1) >> shift)
    }

    /// The highest value of what a texel `shift` levels above the data covers; the texel exists.
    pub fn highest(&self, shift: i32, texel: IVec2) -> f32 {
        let columns = ((self.shape().width as i32 - 1) >> shift) + 1;
        let index = (texel.y * columns + texel.x) as usize;
        let level = if shift == 0 { self.data } else { self.highest.level(shift as u32).unwrap_or_default() };
        level.get(index).map_or(0.0, |value| value.to_f32())
    }

    /// The cell around a place in nodes. A coarser level's texel stands in the middle of the nodes that it covers.
    pub fn cell(&self, shift: i32, place: Vec2) -> Cell {
        let size = (-shift as f32).exp2();
        let last = self.last(shift);
        let texel = (place * size + (0.5 * size - 0.5)).clamp(Vec2::ZERO, last.as_vec2());
        let a = texel.as_ivec2().min((last - 1).max(IVec2::ZERO));
        let b = (a + 1).min(last);
        let corners = [a, IVec2::new(b.x, a.y), IVec2::new(a.x, b.y), b].map(|texel| self.highest(shift, texel));
        Cell { corners: Vec4::from_array(corners), corner: a.as_vec2(), part: texel - a.as_vec2() }
    }

    /// The highest value of every texel that reaches into the rectangle between two places, nodes. Interpolation reads the
    /// node beyond. `shift` is that of [`shift_for`] of the rectangle; a coarser level answers where more than four texels
    /// of it are touched.
    pub fn highest_below(&self, low: Vec2, high: Vec2, shift: i32) -> f32 {
        let last_node = self.last(0);
        let first = low.floor().as_ivec2().clamp(IVec2::ZERO, last_node);
        let last = (high.floor().as_ivec2() + 1).clamp(IVec2::ZERO, last_node);
        let most = ((last >> shift) - (first >> shift)).max_element();
        let level = (shift + i32::from(most > 1) + i32::from(most > 2)).min(self.shape().top as i32);
        let (a, b) = (first >> level, last >> level);
        let north = self.highest(level, a).max(self.highest(level, IVec2::new(b.x, a.y)));
        let south = self.highest(level, IVec2::new(a.x, b.y)).max(self.highest(level, b));
        north.max(south)
    }
}

/// The smallest number of levels above the data whose texels are as large as an extent in nodes:
/// 1/2^(level + 1) < Lp <= 1/2^level.
pub fn shift_for(extent: f32, top: u32) -> i32 {
    let exponent = ((extent.to_bits() as i32 + 0x7f_ffff) >> 23) - 127;
    exponent.clamp(0, top as i32)
}
