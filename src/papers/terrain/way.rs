//! Rays over a base surface, in the map's frame: `shaders/terrain/base-plane.glsl` and `base-curved.glsl` on the processor.

use glam::{Vec2, Vec3, Vec3Swizzles};

use super::blocks::{CYLINDER, PLANE, TerrainBlock};
use super::hit::{NO_DEPTH, Surface};

/// A piece of a ray in the map's frame (eq. 9): u, v and h of its ends, the depth of the near one, and how far the ray may
/// leave the straight line between them.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    pub near: Vec3,
    pub far: Vec3,
    pub depth_m: f32,
    pub slack: Vec3,
}

/// The part of a segment over the map, and the surface at its near end.
#[derive(Debug, Clone, Copy)]
pub struct Over {
    pub near: f32,
    pub far: f32,
    pub surface: Surface,
}

/// The part of a ray that can meet a map.
pub trait Way {
    fn segment(&self, start: f32, size: f32) -> Segment;

    /// The depth at a part of the way, metres.
    fn depth_m(&self, part: f32) -> f32;

    /// Halvings that come before everything else.
    fn first_depth(&self) -> i32 {
        0
    }

    /// The surface that the way begins in, `height` being the map's there; none where it begins above it.
    fn entered(&self, height: f32) -> Option<Surface>;

    fn over_map(&self, segment: &Segment) -> Over;
}

fn last_node(terrain: &TerrainBlock) -> Vec2 {
    (terrain.size - 1).as_vec2()
}

/// Narrows `range` to where a coordinate that moves from `from` by `way` lies between two bounds.
fn between(range: Vec2, from: f32, way: f32, low: f32, high: f32) -> Vec2 {
    let inverse = 1.0 / if way.abs() < 1e-20 { 1e-20 } else { way };
    let (a, b) = ((low - from) * inverse, (high - from) * inverse);
    Vec2::new(range.x.max(a.min(b)), range.y.min(a.max(b)))
}

/// The wall that is met first by a line that comes in at `u` or `v` and moves along `way`.
fn wall(u: Vec2, v: Vec2, way: Vec2) -> Surface {
    match () {
        () if v.x > u.x && way.y > 0.0 => Surface::WallNorth,
        () if v.x > u.x => Surface::WallSouth,
        () if way.x > 0.0 => Surface::WallWest,
        () => Surface::WallEast,
    }
}

/// Where a ray meets the base, how much farther it must go to be below it without doubt, and the place in nodes.
pub fn base_of(terrain: &TerrainBlock, direction: Vec3) -> (f32, f32, Vec2) {
    if terrain.base_kind != PLANE {
        return CurvedWay::base_of(terrain, direction);
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
pub struct PlaneWay {
    near_m: f32,
    far_m: f32,
    side: Surface,
    from: Vec3,
    whole: Vec3,
}

impl PlaneWay {
    pub fn new(terrain: &TerrainBlock, eye: Vec3, direction: Vec3, limit_m: f32) -> Option<Self> {
        let (all, last) = (Vec2::new(0.0, limit_m), last_node(terrain));
        let margin = terrain.rounding_height;
        let u = between(all, eye.x, direction.x, 0.0, last.x);
        let v = between(all, eye.y, direction.y, 0.0, last.y);
        let h = between(all, eye.z, direction.z, terrain.lowest - margin, terrain.highest + margin);
        let near_m = u.x.max(v.x).max(h.x);
        let far_m = u.y.min(v.y).min(h.y);
        let side = match () {
            () if near_m <= 0.0 => Surface::Inside,
            () if h.x >= u.x.max(v.x) => Surface::Terrain,
            () => wall(u, v, direction.xy()),
        };
        let (from, whole) = (eye + near_m * direction, (far_m - near_m) * direction);
        (near_m < far_m).then_some(PlaneWay { near_m, far_m, side, from, whole })
    }
}

impl Way for PlaneWay {
    fn segment(&self, start: f32, size: f32) -> Segment {
        let near = self.from + start * self.whole;
        let far = self.from + (start + size) * self.whole;
        Segment { near, far, depth_m: self.depth_m(start), slack: Vec3::ZERO }
    }

    fn depth_m(&self, part: f32) -> f32 {
        self.near_m + part * (self.far_m - self.near_m)
    }

    fn entered(&self, height: f32) -> Option<Surface> {
        (self.from.z <= height).then_some(self.side)
    }

    fn over_map(&self, _: &Segment) -> Over {
        Over { near: 0.0, far: 1.0, surface: Surface::Terrain }
    }
}

/// Bent in the map's frame, over a cylinder or an ellipsoid of revolution.
pub struct CurvedWay<'a> {
    terrain: &'a TerrainBlock,
    near_m: f32,
    far_m: f32,
    from: Vec3,
    whole: Vec3,
    /// The part at which it passes behind the axis, where longitudes end.
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

impl<'a> CurvedWay<'a> {
    fn base_of(terrain: &TerrainBlock, direction: Vec3) -> (f32, f32, Vec2) {
        let quadric = |from: Vec3| AlongRay::new(from, direction, terrain.base_squares, terrain.base_linear, 0.0);
        let q = quadric(terrain.eye);
        let place = |depth_m: f32| {
            let point = terrain.eye + depth_m * direction;
            on_map(terrain, point, point.x).xy()
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
            range = between(range, eye.z, direction.z, low, high);
        }
        if range.x >= range.y {
            return None;
        }
        let from = eye + range.x * direction;
        let whole = (range.y - range.x) * direction;
        let cut = if whole.x != 0.0 { -from.x / whole.x } else { 0.0 };
        let is_behind = terrain.axis_distance_m + from.y + cut * whole.y < 0.0;
        let cut = (cut > 0.0 && cut < 1.0 && is_behind).then_some(cut);
        Some(CurvedWay { terrain, near_m: range.x, far_m: range.y, from, whole, cut })
    }

    /// A ray behind the axis is cut there before it is halved.
    fn part(&self, start: f32) -> f32 {
        match self.cut {
            None => start,
            Some(cut) if start < 0.5 => 2.0 * start * cut,
            Some(cut) => cut + (2.0 * start - 1.0) * (1.0 - cut),
        }
    }
}

impl Way for CurvedWay<'_> {
    fn segment(&self, start: f32, size: f32) -> Segment {
        let terrain = self.terrain;
        let a = self.from + self.part(start) * self.whole;
        let b = self.from + self.part(start + size) * self.whole;
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
        let turn = moved.length() / radius;
        let mut slack = Vec3::new(
            (0.125 * turn * turn).min(0.5 * turn) * terrain.nodes_per_unit.x,
            0.0,
            0.125 * moved.length() * turn,
        );
        if !is_cylinder(terrain) {
            let smallest = terrain.smallest_radius_m;
            let bend = (b - a).length() / smallest;
            let second = 0.125 * bend * bend * (2.0 + terrain.curvature_change + smallest / radius);
            slack.y = second.min(0.5 * bend) * terrain.nodes_per_unit.y.abs();
            slack.z = 0.125 * (b - a).length() * bend;
        }
        slack.z /= terrain.height_unit_m;
        Segment { near: on_map(terrain, a, side), far: on_map(terrain, b, side), depth_m: self.depth_m(start), slack }
    }

    fn depth_m(&self, part: f32) -> f32 {
        self.near_m + self.part(part) * (self.far_m - self.near_m)
    }

    fn first_depth(&self) -> i32 {
        i32::from(self.cut.is_some())
    }

    fn entered(&self, height: f32) -> Option<Surface> {
        let eye = on_map(self.terrain, self.from, self.from.x);
        let last = last_node(self.terrain);
        let is_over = eye.xy().cmpge(Vec2::ZERO).all() && eye.xy().cmple(last).all();
        (self.near_m <= 0.0 && is_over && eye.z <= height).then_some(Surface::Inside)
    }

    fn over_map(&self, segment: &Segment) -> Over {
        let (all, last) = (Vec2::new(0.0, 1.0), last_node(self.terrain));
        let moved = segment.far.xy() - segment.near.xy();
        let u = between(all, segment.near.x, moved.x, 0.0, last.x);
        let v = between(all, segment.near.y, moved.y, 0.0, last.y);
        let near = u.x.max(v.x);
        let surface = if near > 0.0 { wall(u, v, moved) } else { Surface::Terrain };
        Over { near, far: u.y.min(v.y), surface }
    }
}

fn is_cylinder(terrain: &TerrainBlock) -> bool {
    terrain.base_kind == CYLINDER
}

/// A point in metres from the map's middle on the base in the map's coordinates; `side` is that of the half-plane behind the
/// axis that longitudes are counted to.
pub fn on_map(terrain: &TerrainBlock, point: Vec3, side: f32) -> Vec3 {
    let (off_m, middle) = (terrain.axis_distance_m, terrain.middle_node);
    let off = off_m + point.y;
    let radius = Vec2::new(point.x, off).length();
    let mut longitude = point.x.atan2(off);
    if off < 0.0 {
        longitude = if side < 0.0 { -longitude.abs() } else { longitude.abs() };
    }
    let grown = if off > 0.0 { point.y + point.x * point.x / (radius + off) } else { radius - off_m };
    let (along, height_m) = if is_cylinder(terrain) { (point.z, grown) } else { geodetic(terrain, grown, point.z) };
    Vec3::new(
        middle.x + longitude * terrain.nodes_per_unit.x,
        middle.y + along * terrain.nodes_per_unit.y,
        terrain.base_height + height_m / terrain.height_unit_m,
    )
}

/// An ellipse's point at a latitude that differs by `delta` from the map's middle: sine and cosine of the latitude; how the
/// point lies to the middle's, off and along the axis; radii of curvature across the meridian and along it. Written in
/// differences, so that nothing of a planet's size cancels.
pub struct Meridian {
    pub sine: f32,
    pub cosine: f32,
    off: f32,
    along: f32,
    pub across: f32,
    pub radius: f32,
}

pub fn meridian(terrain: &TerrainBlock, delta: f32) -> Meridian {
    let TerrainBlock { semi_major_m: a, squared_eccentricity: e2, sine_latitude: s0, cosine_latitude: c0, .. } =
        *terrain;
    let (sh, ch) = (0.5 * delta).sin_cos();
    let ds = 2.0 * sh * (c0 * ch - s0 * sh);
    let dc = -2.0 * sh * (s0 * ch + c0 * sh);
    let (s, c) = (s0 + ds, c0 + dc);
    let w0 = (1.0 - e2 * s0 * s0).sqrt();
    let w = (1.0 - e2 * s * s).sqrt();
    let n = a / w;
    let dn = a * e2 * ds * (s + s0) / ((w0 + w) * w * w0);
    Meridian {
        sine: s,
        cosine: c,
        off: n * dc + dn * c0,
        along: (1.0 - e2) * (n * ds + dn * s0),
        across: n,
        radius: a * (1.0 - e2) / (w * w * w),
    }
}

/// Latitude as a difference from the map's middle, and height, of a point in the plane of a meridian: Newton's method for the
/// foot of the normal.
fn geodetic(terrain: &TerrainBlock, off: f32, along: f32) -> (f32, f32) {
    let TerrainBlock { semi_major_m: a, squared_eccentricity: e2, sine_latitude: s0, cosine_latitude: c0, .. } =
        *terrain;
    let n0 = a / (1.0 - e2 * s0 * s0).sqrt();
    let mut delta = (n0 * (1.0 - e2) * s0 + along).atan2((terrain.axis_distance_m + off) * (1.0 - e2)) - s0.atan2(c0);
    let mut height_m = 0.0;
    for _ in 0..4 {
        let foot = meridian(terrain, delta);
        let (r, w) = (off - foot.off, along - foot.along);
        height_m = r * foot.cosine + w * foot.sine;
        delta += (w * foot.cosine - r * foot.sine) / (foot.radius + height_m).max(1e-6 * foot.radius);
    }
    (delta, height_m)
}
