//! "Detection of spatial collisions" (section 1): segments and spheres against the terrain, through the same altitude map as
//! the rays.
//!
//! A segment is a ray that ends, followed to the surface of the data: exact to a thousandth of a cell, as `--lod exact` is. A
//! sphere is measured in double precision: exact to a millionth of a cell. Both hold on every base and interpolation.

use glam::{DVec3, Vec3};

use super::blocks::TerrainBlock;
use super::caster::{Caster, Footprint};
use super::ground::Ground;
use super::hit::{Hit, Surface};
use super::nearest::{Nearest, Search};
use super::parameters::Parameters;
use super::placement::Rays;
use super::pyramid::Texel;
use super::relief::{Field, FieldWork, Relief};
use super::scene::{Inputs, Scene};
use super::shading::normal_of;
use super::solid::Solid;

/// Where a moving point first touches the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The part of the segment before it, 0 to 1; 0 where it begins in the ground.
    pub part: f64,
    /// World, metres.
    pub point: DVec3,
    /// Of the surface there, a unit vector of the world.
    pub normal: DVec3,
    pub surface: Surface,
    /// Which of the maps; the base belongs to the first.
    pub map: u32,
    /// Pieces of the segment that were looked at until the map's surface was met, up to 4095; 0 where none was.
    pub steps: u32,
}

/// Where a sphere touches the ground: the ground's nearest point to its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// From the centre, metres; 0 where the centre is in the ground.
    pub distance_m: f64,
    /// World, metres; the centre itself where it is in the ground.
    pub point: DVec3,
    /// From the point to the centre, a unit vector of the world; away from the base where the centre is in the ground.
    pub normal: DVec3,
    pub surface: Surface,
    /// Which of the maps; the base belongs to the first.
    pub map: u32,
    /// Blocks and pieces of cells that were looked at in all maps.
    pub steps: u32,
}

/// Maps and base with their levels, ready to be asked.
pub struct Collider {
    parameters: Parameters,
    scene: Scene,
    reliefs: Vec<Relief>,
}

impl Collider {
    /// Of at least one map; of the parameters the base, its level and the interpolation matter. Objects are no ground.
    pub fn new(parameters: &Parameters, inputs: &Inputs<'_>) -> Self {
        let scene = Scene::new(parameters, inputs);
        let reliefs = scene.maps.iter().map(|map| Relief::new(map, parameters.interpolation)).collect();
        Collider { parameters: parameters.clone(), scene, reliefs }
    }

    /// The first contact on the way from `a` to `b`, world, metres.
    pub fn segment(&self, a: DVec3, b: DVec3) -> Option<Contact> {
        let way = Rays { eye: a, corner: b - a, across: DVec3::ZERO, down: DVec3::ZERO };
        let mut hit = Hit { depth_m: 1.0, place: [0.0; 2], surface: Surface::Sky, shift: 0, map: 0, steps: 0 };
        let mut normal = Vec3::Y;
        for (relief, terrain) in self.reliefs.iter().zip(self.scene.terrains(&self.parameters, &way, 1.0)) {
            let found = relief.with(Find { terrain: &terrain, parameters: &self.parameters, hit });
            if found.0 != hit {
                (hit, normal) = found;
            }
        }
        let part = f64::from(hit.depth_m);
        (hit.surface != Surface::Sky).then(|| Contact {
            part,
            point: a.lerp(b, part),
            normal: normal.as_dvec3(),
            surface: hit.surface,
            map: hit.map,
            steps: hit.steps,
        })
    }

    /// Where a sphere, world, metres, touches the ground; none where the ground is farther from its centre than its radius.
    pub fn sphere(&self, center: DVec3, radius_m: f64) -> Option<Touch> {
        let mut touch = Touch {
            distance_m: radius_m.next_up(),
            point: center,
            normal: DVec3::Y,
            surface: Surface::Sky,
            map: 0,
            steps: 0,
        };
        for (map, (ground, relief)) in (0..).zip(self.scene.grounds.iter().zip(&self.reliefs)) {
            touch = self.nearest(center, ground, relief, map, touch);
        }
        (touch.surface != Surface::Sky).then_some(touch)
    }

    /// The nearer of `touch` and what one map, or the base below it, has.
    fn nearest(&self, center: DVec3, ground: &Ground, relief: &Relief, map: u32, touch: Touch) -> Touch {
        let solid = Solid::new(ground);
        let framed = solid.framed(center);
        let (place, height_m) = solid.place(framed);
        let foot = solid.point(place, 0.0);
        let start = Nearest { distance_m: touch.distance_m, point: framed, surface: Surface::Sky, steps: touch.steps };
        let best = match height_m {
            height_m if height_m <= 0.0 => Nearest { distance_m: 0.0, surface: Surface::Inside, ..start },
            height_m if height_m < start.distance_m => {
                Nearest { distance_m: height_m, point: foot, surface: Surface::Base, ..start }
            }
            _ => start,
        };
        let interpolation = self.parameters.interpolation;
        let found = relief.with(Search { solid, interpolation, center: framed, best });
        if found.surface == Surface::Sky {
            return Touch { steps: found.steps, ..touch };
        }
        let point = solid.world(found.point);
        let apart = center - point;
        let [_, _, up] = solid.axes(place, height_m);
        let up = (solid.world(framed + up) - center).normalize();
        let is_apart = found.distance_m > 0.0;
        Touch {
            distance_m: found.distance_m,
            point: if is_apart { point } else { center },
            normal: if is_apart { apart.normalize() } else { up },
            surface: found.surface,
            map: if found.surface == Surface::Base { 0 } else { map },
            steps: found.steps,
        }
    }
}

struct Find<'a> {
    terrain: &'a TerrainBlock,
    parameters: &'a Parameters,
    hit: Hit,
}

impl FieldWork for Find<'_> {
    type Output = (Hit, Vec3);

    fn run<T: Texel>(self, field: Field<'_, T>) -> (Hit, Vec3) {
        let interpolation = self.parameters.interpolation;
        let caster = Caster { terrain: self.terrain, field, footprint: Footprint::Data, interpolation };
        let direction = caster.direction(0, 0);
        let hit = caster.find(direction, self.hit);
        (hit, normal_of(&caster, direction, &hit).truncate())
    }
}
