//! The segment of a ray that can meet a map, in the map's frame: `shaders/terrain/base-plane.glsl` and `base-curved.glsl` on
//! the processor. Its ray parameter t is 0 at its near end and 1 at its far one.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::blocks::{PLANE, TerrainBlock};
use super::geodesy::{is_cylinder, map_coordinates};
use super::hit::{NO_DEPTH, Surface};

/// A subsegment in the map's coordinates (eq. 9): u, v and h of its ends, the depth of the near one, and how far the ray may
/// leave the straight line between them.
#[derive(Debug, Clone, Copy)]
pub struct Subsegment {
    /// The near end: u, v and h.
    pub near: Vec3,
    /// The far end: u, v and h.
    pub far: Vec3,
    /// Depth of the near end.
    pub depth_m: f32,
    /// Bound of the ray's distance from the straight line: nodes along u and v, height.
    pub slack: Vec3,
}

/// The range of the fraction of a subsegment that is over the map, and the surface at its near end.
#[derive(Debug, Clone, Copy)]
pub struct Clip {
    /// Its beginning.
    pub near: f32,
    /// Its end; before the beginning where nothing is over the map.
    pub far: f32,
    /// The surface at the beginning.
    pub surface: Surface,
}

/// The segment of a ray that can meet a map.
pub trait RaySegment {
    /// From t = `start`, `size` long.
    fn subsegment(&self, start: f32, size: f32) -> Subsegment;

    /// The depth at t, metres.
    fn depth_m(&self, t: f32) -> f32;

    /// Halvings that come before everything else.
    fn first_depth(&self) -> i32 {
        0
    }

    /// The surface in which the segment begins, `height` being the map's there; none where it begins above it.
    fn entry_surface(&self, height: f32) -> Option<Surface>;

    fn clip_to_map(&self, subsegment: &Subsegment) -> Clip;
}

fn last_node(terrain: &TerrainBlock) -> Vec2 {
    (terrain.size - 1).as_vec2()
}

/// Narrows a range of t to where a coordinate, `from` + t `direction`, lies in a slab.
fn clip_to_slab(range: Vec2, from: f32, direction: f32, low: f32, high: f32) -> Vec2 {
    let inverse = 1.0 / if direction.abs() < 1e-20 { 1e-20 } else { direction };
    let (a, b) = ((low - from) * inverse, (high - from) * inverse);
    Vec2::new(range.x.max(a.min(b)), range.y.min(a.max(b)))
}

/// The wall that is met first by a line that comes in at `u` or `v` along `direction`.
fn wall(u: Vec2, v: Vec2, direction: Vec2) -> Surface {
    match () {
        () if v.x > u.x && direction.y > 0.0 => Surface::WallNorth,
        () if v.x > u.x => Surface::WallSouth,
        () if direction.x > 0.0 => Surface::WallWest,
        () => Surface::WallEast,
    }
}

/// The depth at which a ray meets the base, the length after which it is below it without doubt, and the place in nodes.
pub fn base_of(terrain: &TerrainBlock, direction: Vec3) -> (f32, f32, Vec2) {
    if terrain.base_kind != PLANE {
        return CurvedSegment::base_of(terrain, direction);
    }
    let above = terrain.eye.z - terrain.base_height;
    let depth_m = match above {
        above if above <= 0.0 => 0.0,
        above if direction.z < 0.0 => above / -direction.z,
        _ => NO_DEPTH,
    };
    let slack_m = if above <= 0.0 { 0.0 } else { 2.0 * terrain.rounding_height / (-direction.z).max(1e-20) };
    (depth_m, slack_m, terrain.eye.xy() + depth_m * direction.xy())
}

/// Straight in the map's frame, and so are its halves.
pub struct StraightSegment {
    near_m: f32,
    far_m: f32,
    side: Surface,
    from: Vec3,
    whole: Vec3,
}

impl StraightSegment {
    pub fn new(terrain: &TerrainBlock, eye: Vec3, direction: Vec3, limit_m: f32) -> Option<Self> {
        let (all, last) = (Vec2::new(0.0, limit_m), last_node(terrain));
        let margin = terrain.rounding_height;
        let u = clip_to_slab(all, eye.x, direction.x, 0.0, last.x);
        let v = clip_to_slab(all, eye.y, direction.y, 0.0, last.y);
        let h = clip_to_slab(all, eye.z, direction.z, terrain.lowest - margin, terrain.highest + margin);
        let near_m = u.x.max(v.x).max(h.x);
        let far_m = u.y.min(v.y).min(h.y);
        let side = match () {
            () if near_m <= 0.0 => Surface::Inside,
            () if h.x >= u.x.max(v.x) => Surface::Terrain,
            () => wall(u, v, direction.xy()),
        };
        let (from, whole) = (eye + near_m * direction, (far_m - near_m) * direction);
        (near_m < far_m).then_some(StraightSegment { near_m, far_m, side, from, whole })
    }
}

// Once a step: see `Field`.
impl RaySegment for StraightSegment {
    #[inline]
    fn subsegment(&self, start: f32, size: f32) -> Subsegment {
        let near = self.from + start * self.whole;
        let far = self.from + (start + size) * self.whole;
        Subsegment { near, far, depth_m: self.depth_m(start), slack: Vec3::ZERO }
    }

    #[inline]
    fn depth_m(&self, t: f32) -> f32 {
        self.near_m + t * (self.far_m - self.near_m)
    }

    #[inline]
    fn entry_surface(&self, height: f32) -> Option<Surface> {
        (self.from.z <= height).then_some(self.side)
    }

    #[inline]
    fn clip_to_map(&self, _: &Subsegment) -> Clip {
        Clip { near: 0.0, far: 1.0, surface: Surface::Terrain }
    }
}

/// Bent in the map's frame, over a cylinder or an ellipsoid of revolution.
pub struct CurvedSegment<'a> {
    terrain: &'a TerrainBlock,
    near_m: f32,
    far_m: f32,
    from: Vec3,
    whole: Vec3,
    /// The t at which it passes behind the axis, where longitudes end.
    cut: Option<f32>,
}

/// A quadric along a ray, a t^2 + 2 b t + c, and the root of b^2 - a c where there is one.
struct AlongRay {
    a: f32,
    b: f32,
    c: f32,
    root: Option<f32>,
}

impl AlongRay {
    fn new(eye: Vec3, direction: Vec3, squares: Vec2, linear: Vec2, constant: f32) -> Self {
        let a = squares.x * direction.xy().length_squared() + squares.y * direction.z * direction.z;
        let b = squares.x * eye.xy().dot(direction.xy()) + squares.y * eye.z * direction.z + linear.dot(direction.yz());
        let bent = squares.x * eye.xy().length_squared() + squares.y * eye.z * eye.z;
        let c = bent + 2.0 * linear.dot(eye.yz()) + constant;
        let a = a.max(1e-30);
        let discriminant = b * b - a * c;
        AlongRay { a, b, c, root: (discriminant > 0.0).then(|| discriminant.sqrt()) }
    }
}

impl<'a> CurvedSegment<'a> {
    fn base_of(terrain: &TerrainBlock, direction: Vec3) -> (f32, f32, Vec2) {
        let quadric = |from: Vec3| AlongRay::new(from, direction, terrain.base_squares, terrain.base_linear, 0.0);
        let q = quadric(terrain.eye);
        let place = |depth_m: f32| {
            let point = terrain.eye + depth_m * direction;
            map_coordinates(terrain, point, point.x).xy()
        };
        if q.c <= 0.0 {
            return (0.0, 0.0, place(0.0));
        }
        match q.root {
            Some(root) if q.b < 0.0 => {
                let far_m = q.c / (root - q.b);
                // Once more from there, where numbers are small: from afar the root loses its last digits.
                let there = quadric(terrain.eye + far_m * direction);
                let depth_m = far_m - if there.b.abs() > 0.1 * root { 0.5 * there.c / there.b } else { 0.0 };
                (depth_m, terrain.rounding_height * terrain.height_unit_m / root.max(1e-20), place(depth_m))
            }
            _ => (NO_DEPTH, 0.0, Vec2::ZERO),
        }
    }

    pub fn new(terrain: &'a TerrainBlock, eye: Vec3, direction: Vec3, limit_m: f32) -> Option<Self> {
        let q = AlongRay::new(eye, direction, terrain.shell_squares, terrain.shell_linear, terrain.shell_constant);
        let root = q.root?;
        let sum = if q.b < 0.0 { root - q.b } else { -q.b - root };
        let a = q.c / if sum.abs() < 1e-30 { 1e-30 } else { sum };
        let b = sum / q.a;
        let mut range = Vec2::new(a.min(b).max(0.0), a.max(b).min(limit_m));
        if is_cylinder(terrain) {
            // From a little outside, so that a ray is seen to come in through the wall.
            let outside = terrain.rounding_nodes;
            let low = -(terrain.middle_node.y + outside) / terrain.nodes_per_unit.y;
            let high = (last_node(terrain).y - terrain.middle_node.y + outside) / terrain.nodes_per_unit.y;
            range = clip_to_slab(range, eye.z, direction.z, low, high);
        }
        if range.x >= range.y {
            return None;
        }
        let from = eye + range.x * direction;
        let whole = (range.y - range.x) * direction;
        let cut = if whole.x != 0.0 { -from.x / whole.x } else { 0.0 };
        let is_behind = terrain.axis_distance_m + from.y + cut * whole.y < 0.0;
        let cut = (cut > 0.0 && cut < 1.0 && is_behind).then_some(cut);
        Some(CurvedSegment { terrain, near_m: range.x, far_m: range.y, from, whole, cut })
    }

    /// The fraction of the segment at t: a ray behind the axis is cut there before it is halved.
    fn fraction(&self, t: f32) -> f32 {
        match self.cut {
            None => t,
            Some(cut) if t < 0.5 => 2.0 * t * cut,
            Some(cut) => cut + (2.0 * t - 1.0) * (1.0 - cut),
        }
    }
}

impl RaySegment for CurvedSegment<'_> {
    fn subsegment(&self, start: f32, size: f32) -> Subsegment {
        let terrain = self.terrain;
        let a = self.from + self.fraction(start) * self.whole;
        let b = self.from + self.fraction(start + size) * self.whole;
        let side = match self.cut {
            None => a.x + b.x,
            Some(_) if start < 0.5 => -self.whole.x,
            Some(_) => self.whole.x,
        };
        // The distance from the axis at its smallest.
        let off_m = terrain.axis_distance_m;
        let (from, moved) = (Vec2::new(a.x, off_m + a.y), b.xy() - a.xy());
        let nearest = (-from.dot(moved) / moved.length_squared().max(1e-30)).clamp(0.0, 1.0);
        let radius = (from + nearest * moved).length().max(1e-6 * off_m);
        let angle = moved.length() / radius;
        let mut slack = Vec3::new(
            (0.125 * angle * angle).min(0.5 * angle) * terrain.nodes_per_unit.x,
            0.0,
            0.125 * moved.length() * angle,
        );
        if !is_cylinder(terrain) {
            let smallest = terrain.smallest_radius_m;
            let bend = (b - a).length() / smallest;
            let second = 0.125 * bend * bend * (2.0 + terrain.curvature_change + smallest / radius);
            slack.y = second.min(0.5 * bend) * terrain.nodes_per_unit.y.abs();
            slack.z = 0.125 * (b - a).length() * bend;
        }
        slack.z /= terrain.height_unit_m;
        Subsegment {
            near: map_coordinates(terrain, a, side),
            far: map_coordinates(terrain, b, side),
            depth_m: self.depth_m(start),
            slack,
        }
    }

    fn depth_m(&self, t: f32) -> f32 {
        self.near_m + self.fraction(t) * (self.far_m - self.near_m)
    }

    fn first_depth(&self) -> i32 {
        i32::from(self.cut.is_some())
    }

    fn entry_surface(&self, height: f32) -> Option<Surface> {
        let eye = map_coordinates(self.terrain, self.from, self.from.x);
        let last = last_node(self.terrain);
        let is_over = eye.xy().cmpge(Vec2::ZERO).all() && eye.xy().cmple(last).all();
        (self.near_m <= 0.0 && is_over && eye.z <= height).then_some(Surface::Inside)
    }

    fn clip_to_map(&self, subsegment: &Subsegment) -> Clip {
        let (all, last) = (Vec2::new(0.0, 1.0), last_node(self.terrain));
        let moved = subsegment.far.xy() - subsegment.near.xy();
        let u = clip_to_slab(all, subsegment.near.x, moved.x, 0.0, last.x);
        let v = clip_to_slab(all, subsegment.near.y, moved.y, 0.0, last.y);
        let near = u.x.max(v.x);
        let surface = if near > 0.0 { wall(u, v, moved) } else { Surface::Terrain };
        Clip { near, far: u.y.min(v.y), surface }
    }
}
