//! "Detection of spatial collisions" (section 1): segments against the terrain, through the same altitude map as the rays.

use glam::{DVec3, Vec3};

use super::blocks::LandBlock;
use super::caster::{Caster, Footprint};
use super::hit::{Hit, Surface};
use super::parameters::Parameters;
use super::placement::Rays;
use super::pyramid::Texel;
use super::relief::{Field, FieldWork, Relief};
use super::scene::{Inputs, Scene};
use super::shading::normal_of;

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
        let relief = |input: &super::MapInput| Relief::new(&input.map, parameters.interpolation);
        Collider {
            parameters: parameters.clone(),
            scene: Scene::new(parameters, inputs),
            reliefs: inputs.maps.iter().map(relief).collect(),
        }
    }

    /// The first contact on the way from `a` to `b`, world, metres.
    pub fn segment(&self, a: DVec3, b: DVec3) -> Option<Contact> {
        let way = Rays { eye: a, corner: b - a, across: DVec3::ZERO, down: DVec3::ZERO };
        let mut hit = Hit { depth_m: 1.0, place: [0.0; 2], surface: Surface::Sky, shift: 0, map: 0, steps: 0 };
        let mut normal = Vec3::Y;
        for (relief, land) in self.reliefs.iter().zip(self.scene.lands(&self.parameters, &way, 1.0)) {
            let found = relief.with(Find { land: &land, parameters: &self.parameters, hit });
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
        })
    }
}

struct Find<'a> {
    land: &'a LandBlock,
    parameters: &'a Parameters,
    hit: Hit,
}

impl FieldWork for Find<'_> {
    type Output = (Hit, Vec3);

    fn run<T: Texel>(self, field: Field<'_, T>) -> (Hit, Vec3) {
        let interpolation = self.parameters.interpolation;
        let caster = Caster { land: self.land, field, footprint: Footprint::Data, interpolation };
        let direction = caster.direction(0, 0);
        let hit = caster.find(direction, self.hit);
        (hit, normal_of(&caster, direction, &hit).truncate())
    }
}
