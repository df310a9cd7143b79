//! The way of `shaders/terrain/walk.glsl` on the processor: blocks of cells, one after the other, from border to border. A texel of
//! a level k above the data bounds the surface over all of its 2^k x 2^k cells, so that one read answers for a step: maximum
//! mipmaps (Tevs, Ihrke, Seidel 2008). Over a curved base a ray is halved until it is straight, and then walked.

use glam::{IVec2, Vec2, Vec3, Vec3Swizzles};

use super::height_field::shift_for;
use super::hit::{Hit, Surface};
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster, Span};
use super::ray_segment::RaySegment;

/// A straight line over the map: nodes along u and v, and height; the depth of its ends in metres.
struct Line {
    from: Vec3,
    whole: Vec3,
    near_m: f32,
    far_m: f32,
}

impl Line {
    fn depth_m(&self, t: f32) -> f32 {
        self.near_m + t * (self.far_m - self.near_m)
    }

    fn place(&self, t: f32) -> Vec2 {
        self.from.xy() + t * self.whole.xy()
    }
}

/// The borders of blocks along a line.
struct Borders {
    from: Vec2,
    inverse: Vec2,
    /// Added where the line runs along the grid and never comes to the borders beside it: beyond its end.
    never: Vec2,
    forward: IVec2,
    last_cell: IVec2,
    top: i32,
}

impl Borders {
    fn new(line: &Line, last_cell: IVec2, top: i32) -> Self {
        let whole = line.whole.xy();
        let along = |whole: f32| if whole.abs() < 1e-6 { (0.0, 2.0) } else { (1.0 / whole, 0.0) };
        let ((u, never_u), (v, never_v)) = (along(whole.x), along(whole.y));
        let forward = IVec2::new(i32::from(whole.x > 0.0), i32::from(whole.y > 0.0));
        let (inverse, never) = (Vec2::new(u, v), Vec2::new(never_u, never_v));
        Borders { from: line.from.xy(), inverse, never, forward, last_cell, top }
    }

    /// The fractions of the line at which it crosses the two borders ahead of a block.
    fn ahead(&self, block: IVec2, level: i32) -> Vec2 {
        (((block + self.forward) << level).as_vec2() - self.from) * self.inverse + self.never
    }

    /// The cell of a block in which a place lies.
    fn cell_in(&self, block: IVec2, level: i32, place: Vec2) -> IVec2 {
        let first = block << level;
        let last = (first + ((1 << level) - 1)).min(self.last_cell);
        place.floor().as_ivec2().min(last).max(first)
    }

    /// The cell and the level at which a line goes on that leaves a block at a place: over the nearer of the two borders ahead,
    /// and a level up where that is a border of the level above as well. None where no map is.
    fn beyond(&self, block: IVec2, level: i32, place: Vec2) -> Option<(IVec2, i32)> {
        let at_border = self.ahead(block, level);
        let border = (block + self.forward) << level;
        let next = border + self.forward - 1;
        let inside = self.cell_in(block, level, place);
        let (cell, crossed) = if at_border.x < at_border.y {
            (IVec2::new(next.x, inside.y), border.x)
        } else {
            (IVec2::new(inside.x, next.y), border.y)
        };
        let up = i32::from((crossed >> level) & 1 == 0);
        let is_over = cell.cmpge(IVec2::ZERO).all() && cell.cmple(self.last_cell).all();
        is_over.then_some((cell, (level + up).min(self.top)))
    }
}

impl<T: Texel> RayCaster<'_, T> {
    /// The first place where a ray's segment is not above the map's surface.
    pub(super) fn walk(&self, ray: &impl RaySegment) -> Option<Hit> {
        let (terrain, top) = (self.terrain, self.field.shape().top);
        if let Some(hit) = self.entry(ray) {
            return Some(hit);
        }
        let mut steps = 0;
        let mut span = Span::new(ray.first_depth());
        while !span.is_done() {
            let (start, size) = (span.start(), span.size());
            let segment = ray.subsegment(start, size);
            let (near, far, slack) = (segment.near.xy(), segment.far.xy(), segment.slack);
            let (low, high) = (near.min(far) - slack.xy(), near.max(far) + slack.xy());
            let level = shift_for((high - low).max_element(), top);
            let lowest = segment.near.z.min(segment.far.z) - slack.z - terrain.rounding_height;
            steps += 1;
            let (low, high) = (low - terrain.rounding_nodes, high + terrain.rounding_nodes);
            if lowest > self.field.highest_between(low, high, level).unwrap_or(f32::NEG_INFINITY) {
                span.advance();
            } else if self.is_straight(slack, self.finest_shift(segment.depth_m)) || span.is_shortest() {
                let clip = ray.clip_to_map(&segment);
                if clip.near <= clip.far {
                    let (from, to) =
                        (segment.near.lerp(segment.far, clip.near), segment.near.lerp(segment.far, clip.far));
                    let (near_m, far_m) = (segment.depth_m, ray.depth_m(start + size));
                    let depth_m = |t: f32| near_m + t * (far_m - near_m);
                    let line = Line { from, whole: to - from, near_m: depth_m(clip.near), far_m: depth_m(clip.far) };
                    if let Some(t) = self.walk_line(&line, level.clamp(1, top.max(1) as i32), &mut steps) {
                        let fraction = clip.near + t * (clip.far - clip.near);
                        let depth_m = ray.depth_m(start + fraction * size);
                        let surface = if t > 0.0 { Surface::Terrain } else { clip.surface };
                        let place = near.lerp(far, fraction);
                        return Some(self.hit(depth_m, place, surface, self.finest_shift(depth_m), steps));
                    }
                }
                span.advance();
            } else {
                span.halve();
            }
        }
        None
    }

    /// The fraction of a line at which it first meets the surface.
    fn walk_line(&self, line: &Line, first_level: i32, steps: &mut u32) -> Option<f32> {
        let margin = self.terrain.rounding_height;
        let last_cell = (self.field.last(0) - 1).max(IVec2::ZERO);
        let borders = Borders::new(line, last_cell, self.field.shape().top as i32);
        let falls = line.whole.z < 0.0;
        let mut cell = line.from.xy().floor().as_ivec2().clamp(IVec2::ZERO, last_cell);
        let mut level = first_level;
        // The part of the line that is free.
        let mut t = 0.0_f32;
        loop {
            let block = cell >> level;
            let end = borders.ahead(block, level).min_element().min(1.0).max(t);
            *steps += 1;
            let mut is_free = false;
            if level > 0 {
                let highest = self.field.highest_over(level, block);
                is_free = line.from.z + line.whole.z * if falls { end } else { t } - margin > highest;
                if !is_free {
                    let jump = if falls { ((highest + margin - line.from.z) / line.whole.z).min(end) } else { t };
                    if jump > t {
                        t = jump;
                        cell = borders.cell_in(block, level, line.place(t));
                    }
                    if level > self.finest_shift(line.depth_m(t)) {
                        level -= 1;
                        continue;
                    }
                }
            }
            if !is_free {
                let shift = self.finest_shift(line.depth_m(t)).max(level);
                if let Some(part) = self.part_in(shift, cell, line.from + t * line.whole, (end - t) * line.whole) {
                    return Some(t + part * (end - t));
                }
            }
            t = end;
            (cell, level) = borders.beyond(block, level, line.place(t)).filter(|_| t < 1.0)?;
        }
    }

    /// The part of a line over one block at which it meets the surface of the level that is seen.
    fn part_in(&self, shift: i32, cell: IVec2, from: Vec3, direction: Vec3) -> Option<f32> {
        let tolerance = self.terrain.height_tolerance;
        match self.footprint {
            Footprint::Data => {
                self.field.touch(0, cell, (from.xy() - cell.as_vec2()).extend(from.z), direction, tolerance)
            }
            Footprint::Pixel | Footprint::Level(_) => self.field.intersect(shift, from, from + direction, tolerance),
        }
    }
}
