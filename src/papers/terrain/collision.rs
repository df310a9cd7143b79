//! "Detection of spatial collisions" (section 1): segments and spheres against the terrain, through the same altitude map as
//! the rays.
//!
//! A segment is a ray that ends, followed to the surface of the data: exact to a thousandth of a cell, as `lod` exact is; where its
//! ends are too far away for single precision, the piece around what it meets is followed again. A sphere is measured in double precision: exact to a millionth of a cell. Both hold on every base and interpolation.

use glam::{DVec3, Vec3};

use super::blocks::TerrainBlock;
use super::ground::Ground;
use super::height_field::{Field, FieldWork, HeightField};
use super::hit::{Hit, Surface};
use super::nearest::{Nearest, Search};
use super::normal::normal_of;
use super::parameters::{Normals, Parameters};
use super::placement::Rays;
use super::pyramid::{Cover, Texel};
use super::ray_caster::{Footprint, RayCaster};
use super::scene::{Inputs, Scene};
use super::solid::Solid;

/// The rounding of a place in single precision, as a fraction of its farthest coordinate, and the piece of a segment that is
/// certain to hold what it meets.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;
const PIECE: f64 = 4.0 * ROUNDING;
/// The error of a contact that is not worth another look, as a fraction of a cell.
const HAIR: f64 = 1e-3;

/// The first contact of a body with the ground: of a moving point where it meets it, of a sphere the ground's nearest point
/// to its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The parameter of a segment, 0 to 1; 0 where it begins in the ground; none of a sphere.
    pub t: Option<f64>,
    /// From the start of the segment, or from the centre of the sphere, metres; 0 where that is in the ground.
    pub distance_m: f64,
    /// World, metres; of a sphere the centre itself where that is in the ground.
    pub point: DVec3,
    /// A unit vector of the world: of a segment the surface's, of a sphere from the point to the centre, or away from the base
    /// where that is in the ground.
    pub normal: DVec3,
    /// The surface that is met.
    pub surface: Surface,
    /// Number of the map; the base belongs to the first.
    pub map: u32,
    /// Pieces of the segment that were tried until the map's surface was met, up to 4095, 0 where none was; blocks and pieces of
    /// cells that were tried in all maps.
    pub steps: u32,
}

/// Maps and base with their levels, ready to be asked.
pub struct Collider {
    parameters: Parameters,
    scene: Scene,
    maps: Vec<HeightField>,
}

impl Collider {
    /// Of at least one map; of the parameters the base, its level and the interpolation matter. Objects are no ground.
    pub fn new(parameters: &Parameters, inputs: &Inputs<'_>) -> Self {
        let scene = Scene::new(parameters, inputs);
        let maps = scene.maps.iter().map(|map| HeightField::new(map, parameters.interpolation, Cover::Nodes)).collect();
        let parameters = Parameters { normals: Normals::Surface, ..parameters.clone() };
        Collider { parameters, scene, maps }
    }

    /// The first contact on the way from `a` to `b`, world, metres.
    pub fn segment(&self, a: DVec3, b: DVec3) -> Option<Contact> {
        let farthest_m = a.abs().max(b.abs()).max_element();
        let cell_m =
            self.scene.grounds.iter().map(|ground| ground.spacing_m.min_element()).fold(f64::INFINITY, f64::min);
        if farthest_m * ROUNDING <= HAIR * cell_m {
            return self.traced(a, b);
        }
        if let Some([near, far]) = self.over_maps(a, b)
            && let Some(contact) = self.piece(a, b, near, far)
        {
            return Some(contact);
        }
        let found = self.traced(a, b)?;
        let (t, reach) = (found.t?, farthest_m * PIECE / a.distance(b));
        let again = self.piece(a, b, (t - reach).max(0.0), (t + reach).min(1.0));
        again.filter(|again| t > 0.0 && again.surface != Surface::Inside).or(Some(found))
    }

    /// The piece of a segment in the box around maps on a plane; none where it does not come there, or begins in the base or meets
    /// it before.
    fn over_maps(&self, a: DVec3, b: DVec3) -> Option<[f64; 2]> {
        if self.scene.grounds.iter().any(|ground| ground.curve.is_some()) {
            return None;
        }
        let (low, high) = (self.scene.extent.low, self.scene.extent.high);
        let margin = 0.3 * (high - low) + DVec3::ONE;
        let (low, high, whole) = (low - margin, high + margin, b - a);
        let (mut near, mut far) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            if whole[axis] != 0.0 {
                let [one, other] = [low, high].map(|side| (side[axis] - a[axis]) / whole[axis]);
                (near, far) = (near.max(one.min(other)), far.min(one.max(other)));
            } else if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
        }
        let is_before = near == 0.0 || (a.y > 0.0 && a.lerp(b, near).y > 0.0);
        (near < far && is_before).then_some([near, far])
    }

    /// The first contact of a piece of a segment.
    fn piece(&self, a: DVec3, b: DVec3, near: f64, far: f64) -> Option<Contact> {
        let contact = self.traced(a.lerp(b, near), a.lerp(b, far))?;
        let t = near + contact.t? * (far - near);
        Some(Contact { t: Some(t), distance_m: t * a.distance(b), ..contact })
    }

    fn traced(&self, a: DVec3, b: DVec3) -> Option<Contact> {
        let rays = Rays { eye: a, corner: b - a, across: DVec3::ZERO, down: DVec3::ZERO };
        let mut hit = Hit { depth_m: 1.0, ..Hit::SKY };
        let mut normal = Vec3::Y;
        for (map, terrain) in self.maps.iter().zip(self.scene.terrain_blocks(&self.parameters, &rays, 1.0)) {
            let found = map.with(Find { terrain: &terrain, hit });
            // Land in the base is looked for a hair farther than the base, which may lie beyond the segment's end.
            if found.0 != hit && found.0.depth_m <= 1.0 {
                (hit, normal) = found;
            }
        }
        let t = f64::from(hit.depth_m);
        (hit.surface != Surface::Sky).then(|| Contact {
            t: Some(t),
            distance_m: t * a.distance(b),
            point: a.lerp(b, t),
            normal: normal.as_dvec3(),
            surface: hit.surface,
            map: hit.map,
            steps: hit.steps,
        })
    }

    /// The height of the ground, world, metres, straight below the sky at a place east and south of the origin; 0 where there is
    /// none.
    pub fn ground_m(&self, east_m: f64, south_m: f64) -> f64 {
        let (low, high) = (self.scene.extent.low.y, self.scene.extent.high.y);
        let margin_m = 1.0 + 0.3 * (high - low);
        let ends = [high + margin_m, low - margin_m].map(|y| DVec3::new(east_m, y, south_m));
        self.segment(ends[0], ends[1]).map_or(0.0, |contact| contact.point.y)
    }

    /// The contact of a sphere, world, metres, with the ground; none where the ground is farther from its centre than its radius.
    pub fn sphere(&self, center: DVec3, radius_m: f64) -> Option<Contact> {
        let mut contact = Contact {
            t: None,
            distance_m: radius_m.next_up(),
            point: center,
            normal: DVec3::Y,
            surface: Surface::Sky,
            map: 0,
            steps: 0,
        };
        for (number, (ground, map)) in (0..).zip(self.scene.grounds.iter().zip(&self.maps)) {
            contact = nearest(center, ground, map, number, contact);
        }
        (contact.surface != Surface::Sky).then_some(contact)
    }
}

/// The nearer of `contact` and what one map, or the base below it, has.
fn nearest(center: DVec3, ground: &Ground, map: &HeightField, number: u32, contact: Contact) -> Contact {
    let solid = Solid::new(ground);
    let framed = solid.framed(center);
    let (place, height_m) = solid.place(framed);
    let foot = solid.point(place, 0.0);
    let start = Nearest { distance_m: contact.distance_m, point: framed, surface: Surface::Sky, steps: contact.steps };
    let best = match height_m {
        height_m if height_m <= 0.0 => Nearest { distance_m: 0.0, surface: Surface::Inside, ..start },
        height_m if height_m < start.distance_m => {
            Nearest { distance_m: height_m, point: foot, surface: Surface::Base, ..start }
        }
        _ => start,
    };
    let found = map.with(Search { solid, center: framed, best });
    if found.surface == Surface::Sky {
        return Contact { steps: found.steps, ..contact };
    }
    let point = solid.world(found.point);
    let apart = center - point;
    let [_, _, up] = solid.axes(place, height_m);
    let up = (solid.world(framed + up) - center).normalize();
    let is_apart = found.distance_m > 0.0;
    Contact {
        t: None,
        distance_m: found.distance_m,
        point: if is_apart { point } else { center },
        normal: if is_apart { apart.normalize() } else { up },
        surface: found.surface,
        map: if found.surface == Surface::Base { 0 } else { number },
        steps: found.steps,
    }
}

struct Find<'a> {
    terrain: &'a TerrainBlock,
    hit: Hit,
}

impl FieldWork for Find<'_> {
    type Output = (Hit, Vec3);

    fn run<T: Texel>(self, field: Field<'_, T>) -> (Hit, Vec3) {
        let caster = RayCaster { terrain: self.terrain, field, footprint: Footprint::Data };
        let direction = caster.direction(0, 0);
        let hit = caster.find(direction, self.hit);
        (hit, normal_of(&caster, direction, &hit).truncate())
    }
}
