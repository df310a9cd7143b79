//! Numbers of the lava that flows (chapter 9, "Improved particle simulation").

use glam::Vec3;

use super::crust::Crust;
use super::heat::Heat;
use super::substeps;
use super::vent::Vent;
use crate::measure::parameter::{Cost, Extents, Field, Parameter, Range, Value as _};
use crate::{choice, field};

choice! {
    /// Motion of the particles.
    pub enum Simulation {
        /// Section 5.1.
        Free = ("free", "The thesis's: each particle by itself"),
        /// Smoothed particle hydrodynamics.
        Sph = ("sph", "A viscous fluid on a slope: smoothed particle hydrodynamics"),
    }
}

choice! {
    /// Bounds of the fluid along x and z.
    pub enum Sides {
        /// Walls that the lava sticks to.
        Walls = ("walls", "Walls that the lava sticks to, as it does to the floor"),
        /// The space repeats.
        Periodic = ("periodic", "The space repeats"),
    }
}

/// The fluid, in the ranges of [`Flow::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// Sides of the block of lava at the start along x, y and z in metres, from the corner at the origin on; each above 0
    /// and no longer than the space.
    pub block_m: Vec3,
    /// Dynamic viscosity in pascal seconds, 0 to 1,000,000.
    pub viscosity_pa_s: f32,
    /// Density in kilograms per cubic metre, 100 to 10,000.
    pub melt_kg_m3: f32,
    /// Gravity in metres per second squared, 0 to 100.
    pub gravity_m_s2: f32,
    /// Slope of the floor down along x in degrees, 0 to 80; without one, that of [`Flow::slope_deg`].
    pub slope_deg: Option<f32>,
    /// Bounds of the fluid along x and z.
    pub sides: Sides,
    /// Most corrections of the density in a step, 1 to 100.
    pub corrections: u32,
    /// Steps in the time of a frame, 1 to 100; without it as many as the lava's depth needs.
    pub substeps: Option<u32>,
    /// Time in seconds after which each of two layings of the rock is renewed, 0.1 to 1000.
    pub renewal_s: f32,
    /// Heat, and what it makes of the viscosity.
    pub heat: Heat,
    /// Relief of its crust.
    pub crust: Crust,
    /// Vent that it comes out of, if it does not stand there at the start.
    pub vent: Vent,
}

impl Default for Flow {
    fn default() -> Self {
        Flow {
            block_m: Vec3::new(1.2, 0.6, 1.0),
            viscosity_pa_s: 100.0,
            melt_kg_m3: 2700.0,
            gravity_m_s2: 9.81,
            slope_deg: None,
            sides: Sides::Walls,
            corrections: 12,
            substeps: None,
            renewal_s: 4.0,
            heat: Heat::default(),
            crust: Crust::default(),
            vent: Vent::default(),
        }
    }
}

const BLOCK: Field<Flow, Extents<f32, 3>> =
    Field { get: |f| Extents(f.block_m.to_array()), set: |f, block| f.block_m = Vec3::from(block.0) };

impl Flow {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Flow>> {
        let heat = Heat::declared().into_iter().map(|p| p.inside(|s: &Self| &s.heat, |s| &mut s.heat));
        let motion = vec![
            Parameter::new("block", BLOCK)
                .placeholder("XxYxZ")
                .range(Range::above(0.0).to(1000.0))
                .unit("metres")
                .help("With sph: sides of the block of lava at the start, in the corner at the origin, no larger than the space; with an effusion rate the volume that comes out")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("viscosity", field!(Flow.viscosity_pa_s))
                .range(Range::from(0.0).to(1e6))
                .unit("pascal seconds")
                .help("With sph: viscosity of the lava, at its temperature at the start")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("melt-density", field!(Flow.melt_kg_m3))
                .range(Range::from(100.0).to(10_000.0))
                .unit("kilograms per cubic metre")
                .help("With sph: density of the lava")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("gravity", field!(Flow.gravity_m_s2))
                .range(Range::from(0.0).to(100.0))
                .unit("metres per second squared")
                .help("With sph: gravity")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("slope", field!(Flow.slope_deg))
                .range(Range::from(0.0).to(80.0))
                .unit("degrees")
                .help("With sph: slope of the floor, down along x; the space is drawn level")
                .section("9")
                .default_text("10; on a bed 0")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("sides", field!(Flow.sides))
                .help("With sph: what bounds the lava along x and z")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("corrections", field!(Flow.corrections))
                .range(Range::from(1.0).to(100.0))
                .help("With sph: most corrections of the density in a step")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("substeps", field!(Flow.substeps))
                .range(Range::from(1.0).to(f64::from(substeps::MOST)))
                .help("With sph: steps in the time of a frame; finer particles and deeper lava need more of them")
                .section("9")
                .default_text("as many as the lava needs")
                .cost(Cost::Buffers)
                .unrecorded(),
            Parameter::new("rock-renewal", field!(Flow.renewal_s))
                .range(Range::from(0.1).to(1000.0))
                .unit("seconds")
                .help("With sph: time that the lava carries the rock before it is laid anew; two layings take turns")
                .section("9")
                .cost(Cost::Buffers),
        ];
        let vent = Vent::declared().into_iter().map(|p| p.inside(|s: &Self| &s.vent, |s| &mut s.vent));
        let crust = Crust::declared().into_iter().map(|p| p.inside(|s: &Self| &s.crust, |s| &mut s.crust));
        motion.into_iter().chain(heat).chain(crust).chain(vent).collect()
    }

    /// Name and value of the first number that is not the default's.
    pub fn first_set(&self) -> Option<(&'static str, String)> {
        let default = Flow::default();
        let of = |p: &Parameter<Flow>| (p.text(self) != p.text(&default)).then(|| (p.name, p.text(self)));
        Flow::declared().iter().find_map(of)
    }

    /// Slope of the floor in degrees, of a level bed or of a map's.
    pub fn slope_deg(&self, is_level: bool) -> f32 {
        self.slope_deg.unwrap_or(if is_level { 10.0 } else { 0.0 })
    }

    /// Distance of the particles at rest, metres: the cube root of their volume.
    pub fn spacing_m(&self, particles: u32) -> f64 {
        let [x, y, z] = self.block_m.as_dvec3().to_array();
        (x * y * z / f64::from(particles)).cbrt()
    }

    /// The block as it is typed.
    pub fn block_text(&self) -> String {
        Extents(self.block_m.to_array()).text()
    }
}
