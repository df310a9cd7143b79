//! Section 3 on the processor: the same recursive halving of rays as `shaders/terrain/traversal.glsl`, in the same single
//! precision.
//!
//! A ray is a voxel between two points (eq. 8) that is halved (eq. 12), the near half first and then the far one, until it
//! lies above everything that the altitude map has below it or is short enough to be intersected. The segment at a depth of d
//! is number k of 2^d, and the next one after it is found by counting.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::blocks::LandBlock;
use super::hit::{Hit, NO_DEPTH, Surface};
use super::parameters::Lod;
use super::pyramid::Texel;
use super::relief::{Cell, Field, shift_for};

/// Halvings after which a segment is intersected whatever it touches.
const DEEPEST: i32 = 23;

/// Casts rays at one map.
pub struct Caster<'a, T> {
    pub land: &'a LandBlock,
    pub field: Field<'a, T>,
    pub lod: Lod,
}

/// The part of a ray that can meet the map: depths of its ends in metres, and the surface it comes in through.
struct Span {
    near_m: f32,
    far_m: f32,
    side: Surface,
}

/// A piece of a ray in the map's frame (eq. 9), and the depth of its near end.
struct Segment {
    near: Vec3,
    far: Vec3,
    depth_m: f32,
}

/// Counts the segments before and at the current one.
struct Counter {
    k: u32,
    depth: i32,
}

impl Counter {
    fn size(&self) -> f32 {
        (-self.depth as f32).exp2()
    }

    fn start(&self) -> f32 {
        self.k as f32 * self.size()
    }

    fn halve(&mut self) {
        self.k *= 2;
        self.depth += 1;
    }

    /// The next segment of those that are done whole: up while this was a far half, then the far half beside it.
    fn advance(&mut self) {
        let up = self.k.trailing_ones();
        self.k = (self.k >> up) + 1;
        self.depth -= up as i32;
    }

    fn is_done(&self) -> bool {
        self.k >> self.depth != 0
    }
}

fn between(range: Vec2, eye: f32, direction: f32, low: f32, high: f32) -> Vec2 {
    let inverse = 1.0 / if direction.abs() < 1e-20 { 1e-20 } else { direction };
    let (a, b) = ((low - eye) * inverse, (high - eye) * inverse);
    Vec2::new(range.x.max(a.min(b)), range.y.min(a.max(b)))
}

impl<T: Texel> Caster<'_, T> {
    fn eye(&self) -> Vec3 {
        Vec3::from_slice(&self.land.eye)
    }

    /// The direction through the middle of a pixel.
    pub fn direction(&self, x: u32, y: u32) -> Vec3 {
        let row = |v: &[f32; 4]| Vec3::from_slice(v);
        row(&self.land.corner) + x as f32 * row(&self.land.across) + y as f32 * row(&self.land.down)
    }

    /// The base or the map, whichever is met first, if before `prior`; and how many segments were looked at.
    pub fn find(&self, direction: Vec3, prior: Hit) -> (Hit, u32) {
        let (mut hit, mut limit_m) = (prior, prior.depth_m);
        let above = self.eye().z - self.land.bounds[2];
        let base_m = match above {
            above if above <= 0.0 => 0.0,
            above if direction.z < 0.0 => above / -direction.z,
            _ => NO_DEPTH,
        };
        if base_m < hit.depth_m {
            hit = self.hit(base_m, self.eye().xy() + base_m * direction.xy(), Surface::Base, 0);
            // Where the map lies in the base, the map is seen.
            let slack_m = 2.0 * self.land.margin[1] / -direction.z;
            limit_m = if above <= 0.0 { 0.0 } else { limit_m.min(base_m + slack_m) };
        }
        let (found, steps) = self.trace(direction, limit_m);
        (found.unwrap_or(hit), steps)
    }

    fn hit(&self, depth_m: f32, place: Vec2, surface: Surface, shift: i32) -> Hit {
        let map = self.land.turn[3] as u32;
        Hit { depth_m, place: place.to_array(), surface, shift: shift as u32, map }
    }

    fn clip(&self, direction: Vec3, limit_m: f32) -> Span {
        let (all, eye, last) = (Vec2::new(0.0, limit_m), self.eye(), self.field.last(0).as_vec2());
        let [low, high, ..] = self.land.bounds;
        let margin = self.land.margin[1];
        let u = between(all, eye.x, direction.x, 0.0, last.x);
        let v = between(all, eye.y, direction.y, 0.0, last.y);
        let h = between(all, eye.z, direction.z, low - margin, high + margin);
        let near_m = u.x.max(v.x).max(h.x);
        let side = match () {
            () if near_m <= 0.0 => Surface::Inside,
            () if h.x >= u.x.max(v.x) => Surface::Terrain,
            () if v.x > u.x && direction.y > 0.0 => Surface::WallNorth,
            () if v.x > u.x => Surface::WallSouth,
            () if direction.x > 0.0 => Surface::WallWest,
            () => Surface::WallEast,
        };
        Span { near_m, far_m: u.y.min(v.y).min(h.y), side }
    }

    /// The first place where the ray is not above the map's surface, before `limit_m`.
    fn trace(&self, direction: Vec3, limit_m: f32) -> (Option<Hit>, u32) {
        let span = self.clip(direction, limit_m);
        if span.near_m >= span.far_m {
            return (None, 0);
        }
        let origin = self.eye() + span.near_m * direction;
        let whole = (span.far_m - span.near_m) * direction;
        let shift = self.finest_shift(span.near_m);
        if origin.z <= self.field.cell(shift, origin.xy()).bilinear() {
            return (Some(self.hit(span.near_m, origin.xy(), span.side, shift)), 1);
        }
        let margin = self.land.margin;
        let mut steps = 0;
        let mut counter = Counter { k: 0, depth: 0 };
        while !counter.is_done() {
            let (start, size) = (counter.start(), counter.size());
            let segment = Segment {
                near: origin + start * whole,
                far: origin + (start + size) * whole,
                depth_m: span.near_m + start * (span.far_m - span.near_m),
            };
            let (near, far) = (segment.near.xy(), segment.far.xy());
            let shift = shift_for((far - near).abs().max_element(), self.field.shape().top);
            steps += 1;
            let highest = self.field.highest_below(near.min(far) - margin[0], near.max(far) + margin[0], shift);
            if segment.near.z.min(segment.far.z) - margin[1] > highest {
                counter.advance();
            } else if shift <= self.finest_shift(segment.depth_m) || counter.depth >= DEEPEST {
                if let Some(part) = self.intersect(&segment) {
                    let depth_m = segment.depth_m + part * size * (span.far_m - span.near_m);
                    let place = segment.near.lerp(segment.far, part).xy();
                    let hit = self.hit(depth_m, place, Surface::Terrain, self.finest_shift(depth_m));
                    return (Some(hit), steps);
                }
                counter.advance();
            } else {
                counter.halve();
            }
        }
        (None, steps)
    }

    /// The level at which subdivision ends at a depth: the data's, or that of a pixel's footprint.
    fn finest_shift(&self, depth_m: f32) -> i32 {
        match self.lod {
            Lod::Exact => 0,
            Lod::Pixel => {
                let exponent = ((depth_m * self.land.eye[3]).to_bits() as i32 >> 23) - 127;
                exponent.clamp(0, self.field.shape().top as i32)
            }
        }
    }

    /// The part of a last segment at which it meets the surface.
    fn intersect(&self, segment: &Segment) -> Option<f32> {
        match self.lod {
            Lod::Exact => self.intersect_cells(segment),
            Lod::Pixel => self.intersect_footprint(segment),
        }
    }

    /// At most three cells; in each the bilinear surface (eq. 7) along the ray is a quadratic.
    fn intersect_cells(&self, segment: &Segment) -> Option<f32> {
        let whole = segment.far - segment.near;
        let u = crossing(segment.near.x, segment.far.x);
        let v = crossing(segment.near.y, segment.far.y);
        let ends = [0.0, u.min(v), u.max(v), 1.0];
        ends.windows(2).find_map(|ends| {
            let size = ends[1] - ends[0];
            if size <= 0.0 {
                return None;
            }
            let from = segment.near + ends[0] * whole;
            let cell = self.field.cell(0, (from + 0.5 * size * whole).xy());
            let inside = Vec3::new(from.x - cell.corner.x, from.y - cell.corner.y, from.z);
            touch(&cell, inside, size * whole).map(|part| ends[0] + part * size)
        })
    }

    fn intersect_footprint(&self, segment: &Segment) -> Option<f32> {
        let shift = self.finest_shift(segment.depth_m);
        let above = |place: Vec3| place.z - self.field.cell(shift, place.xy()).bilinear();
        let near = above(segment.near);
        if near <= 0.0 {
            return Some(0.0);
        }
        let far = above(segment.far);
        if far > 0.0 {
            return None;
        }
        // Regula falsi, twice.
        let guess = near / (near - far);
        let amid = above(segment.near.lerp(segment.far, guess));
        Some(if amid <= 0.0 { guess * near / (near - amid) } else { guess + (1.0 - guess) * amid / (amid - far) })
    }
}

/// The part of the way from one number to another at which it crosses a whole one; 1 where it crosses none.
fn crossing(from: f32, to: f32) -> f32 {
    if from.floor() == to.floor() {
        return 1.0;
    }
    ((from.floor().max(to.floor()) - from) / (to - from)).clamp(0.0, 1.0)
}

/// Where a line that moves by `way` from `from` inside a cell first touches the cell's surface, as a part of `way`.
fn touch(cell: &Cell, from: Vec3, way: Vec3) -> Option<f32> {
    let a = cell.corners.x;
    let (b, c) = (cell.corners.y - a, cell.corners.z - a);
    let e = cell.corners.w - cell.corners.y - c;
    let qa = -e * way.x * way.y;
    let qb = way.z - b * way.x - c * way.y - e * (from.x * way.y + from.y * way.x);
    let qc = from.z - (a + b * from.x + c * from.y + e * from.x * from.y);
    if qc <= 0.0 {
        return Some(0.0);
    }
    // The smaller positive root of a function that begins above zero, without cancellation.
    let discriminant = qb * qb - 4.0 * qa * qc;
    let root = discriminant.max(0.0).sqrt();
    let (numerator, denominator) = if qb < 0.0 { (2.0 * qc, root - qb) } else { (qb + root, -2.0 * qa) };
    if discriminant >= 0.0 && denominator > 0.0 && numerator <= denominator {
        return Some(numerator / denominator);
    }
    (qa + qb + qc <= 0.0).then_some(1.0)
}
