//! Section 3 on the processor: the same recursive halving of rays as `shaders/terrain/traversal.glsl`, in the same single
//! precision.
//!
//! A ray is a voxel between two points (eq. 8) that is halved (eq. 12), the near half first and then the far one, until it
//! lies above everything that the altitude map has below it or is short enough to be intersected. The ray is [`WHOLE`] units
//! long, and after a segment comes the longest that halving can make begin where it ends.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::blocks::{PLANE, TerrainBlock};
use super::height_field::{Field, shift_for};
use super::hit::{Hit, NO_DEPTH, Surface};
use super::parameters::Lod;
use super::pyramid::{Cover, Texel};
use super::ray_segment::{CurvedSegment, RaySegment, StraightSegment, Subsegment, base_of};

/// A segment of one unit is intersected whatever it touches. Single precision counts them exactly.
const WHOLE: u32 = 1 << 23;
/// The most by which a last subsegment is not straight, in texels of the level that it is met at.
const STRAIGHT: f32 = 2.5e-4;

/// The end of subdivision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Footprint {
    /// At the data, with the exact place.
    Data,
    /// At the level as large as a pixel, which grows with the depth.
    Pixel,
    /// At one level.
    Level(i32),
}

impl From<Lod> for Footprint {
    fn from(lod: Lod) -> Self {
        match lod {
            Lod::Exact => Footprint::Data,
            Lod::Pixel => Footprint::Pixel,
        }
    }
}

/// Casts rays at one map.
pub struct RayCaster<'a, T> {
    /// The map as the camera sees it.
    pub terrain: &'a TerrainBlock,
    /// The map's values.
    pub field: Field<'a, T>,
    /// The end of subdivision.
    pub footprint: Footprint,
}

/// The beginning of a subsegment on its ray and its length, in units.
pub(super) struct Span {
    at: u32,
    units: u32,
}

impl Span {
    /// The first of a ray, after so many halvings.
    pub(super) fn new(first_depth: i32) -> Self {
        Span { at: 0, units: WHOLE >> first_depth }
    }

    pub(super) fn start(&self) -> f32 {
        self.at as f32 / WHOLE as f32
    }

    pub(super) fn size(&self) -> f32 {
        self.units as f32 / WHOLE as f32
    }

    pub(super) fn halve(&mut self) {
        self.units /= 2;
    }

    pub(super) fn advance(&mut self) {
        self.at += self.units;
        self.units = 1 << self.at.trailing_zeros();
    }

    pub(super) fn is_done(&self) -> bool {
        self.at >= WHOLE
    }

    /// True of a subsegment that is halved no further.
    pub(super) fn is_shortest(&self) -> bool {
        self.units == 1
    }
}

impl<T: Texel> RayCaster<'_, T> {
    /// The direction through the middle of a pixel.
    pub fn direction(&self, x: u32, y: u32) -> Vec3 {
        let TerrainBlock { corner_direction, right_step, down_step, .. } = *self.terrain;
        corner_direction + x as f32 * right_step + y as f32 * down_step
    }

    /// The hit of a ray: the base or the map, the nearer one, if before `prior`, which is of the maps before. Land that lies in the
    /// base is before it, by rounding up to a hair farther.
    pub fn find(&self, direction: Vec3, prior: Hit) -> Hit {
        let (base_m, slack_m, place) = base_of(self.terrain, direction);
        let is_over_base = prior.surface == Surface::Base && prior.depth_m > 0.0;
        let prior_m = if is_over_base { NO_DEPTH } else { prior.depth_m };
        let hit = match prior.surface {
            Surface::Sky if base_m < prior.depth_m => self.hit(base_m, place, Surface::Base, 0, 0),
            _ => prior,
        };
        self.trace(self.terrain.eye, direction, prior_m.min(base_m + slack_m)).unwrap_or(hit)
    }

    /// True where the map stands between a pixel's hit and the sun.
    pub fn is_shadowed(&self, direction: Vec3, hit: &Hit) -> bool {
        let shift = hit.shift.min(self.field.shape().top) as i32;
        let sun = self.terrain.to_sun;
        // A texel away from the surface itself, in the direction of the sun.
        let widest_m = self.terrain.widest_spacing_m;
        let texel_m = match self.terrain.base_kind {
            PLANE => widest_m.min(1.0 / sun.x.abs().max(sun.y.abs()).max(1e-20)),
            _ => widest_m,
        };
        let away_m = texel_m * (shift as f32).exp2() + 1e-5 * hit.depth_m;
        let from = self.terrain.eye + hit.depth_m * direction + away_m * sun;
        let caster = RayCaster { footprint: Footprint::Level(shift), ..*self };
        caster.trace(from, sun, NO_DEPTH).is_some()
    }

    /// The first place where a ray is not above the map's surface, before `limit_m`.
    pub fn trace(&self, eye: Vec3, direction: Vec3, limit_m: f32) -> Option<Hit> {
        if self.terrain.base_kind == PLANE {
            self.first_hit(&StraightSegment::new(self.terrain, eye, direction, limit_m)?)
        } else {
            self.first_hit(&CurvedSegment::new(self.terrain, eye, direction, limit_m)?)
        }
    }

    fn first_hit(&self, ray: &impl RaySegment) -> Option<Hit> {
        match self.field.cover {
            Cover::Nodes => self.follow(ray),
            Cover::Cells(_) => self.walk(ray),
        }
    }

    pub(super) fn hit(&self, depth_m: f32, place: Vec2, surface: Surface, shift: i32, steps: u32) -> Hit {
        let map = self.terrain.map_index as u32;
        Hit { depth_m, place: place.to_array(), surface, shift: shift as u32, map, steps }
    }

    /// The hit of a segment that begins below the surface.
    pub(super) fn entry(&self, ray: &impl RaySegment) -> Option<Hit> {
        let near_m = ray.depth_m(0.0);
        let first = ray.subsegment(0.0, 0.0).near.xy();
        let shift = self.finest_shift(near_m);
        let surface = ray.entry_surface(self.field.height(shift, first))?;
        Some(self.hit(near_m, first, surface, shift, 1))
    }

    /// True where a ray leaves its straight line by so little that a level's cells do not show it.
    #[inline]
    pub(super) fn is_straight(&self, slack: Vec3, shift: i32) -> bool {
        let straight = STRAIGHT * (shift as f32).exp2();
        let terrain = self.terrain;
        slack.x.max(slack.y) <= straight && slack.z * terrain.height_unit_m <= straight * terrain.spacing_m.x
    }

    fn follow(&self, ray: &impl RaySegment) -> Option<Hit> {
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
            let shift = shift_for((high - low).max_element(), top);
            let finest = self.finest_shift(segment.depth_m);
            let lowest = segment.near.z.min(segment.far.z) - slack.z - terrain.rounding_height;
            steps += 1;
            if lowest > self.highest_below(low - terrain.rounding_nodes, high + terrain.rounding_nodes, shift) {
                span.advance();
            } else if (shift <= finest && self.is_straight(slack, finest)) || span.is_shortest() {
                if let Some((fraction, surface)) = self.intersect(ray, &segment) {
                    let depth_m = ray.depth_m(start + fraction * size);
                    let place = near.lerp(far, fraction);
                    return Some(self.hit(depth_m, place, surface, self.finest_shift(depth_m), steps));
                }
                span.advance();
            } else {
                span.halve();
            }
        }
        None
    }

    fn highest_below(&self, low: Vec2, high: Vec2, shift: i32) -> f32 {
        self.field.highest_below(low, high, shift).unwrap_or(f32::NEG_INFINITY)
    }

    /// The level at which subdivision ends at a depth: the data's, or that of a pixel's footprint.
    #[inline]
    pub(super) fn finest_shift(&self, depth_m: f32) -> i32 {
        match self.footprint {
            Footprint::Data => 0,
            Footprint::Level(shift) => shift,
            Footprint::Pixel => {
                let exponent = ((depth_m * self.terrain.pixel_nodes).to_bits() as i32 >> 23) - 127;
                exponent.clamp(0, self.field.shape().top as i32)
            }
        }
    }

    /// The fraction of a last subsegment at which it meets a surface, and which.
    fn intersect(&self, ray: &impl RaySegment, segment: &Subsegment) -> Option<(f32, Surface)> {
        let clip = ray.clip_to_map(segment);
        if clip.near > clip.far {
            return None;
        }
        let near = segment.near.lerp(segment.far, clip.near);
        let far = segment.near.lerp(segment.far, clip.far);
        let shift = self.finest_shift(segment.depth_m);
        let t = self.field.intersect(shift, near, far, self.terrain.height_tolerance)?;
        let surface = if t > 0.0 { Surface::Terrain } else { clip.surface };
        Some((clip.near + t * (clip.far - clip.near), surface))
    }
}
