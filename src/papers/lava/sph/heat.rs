//! Numbers of the lava's heat, and of what it makes of the viscosity (chapter 9, "Temperature variables and heat transfer
//! simulations").

use crate::measure::parameter::{Cost, Parameter, Range};
use crate::{choice, field};

/// Stefan and Boltzmann's constant, watts per square metre and K^4: of the SI's exact values (2019).
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// Least that lies between solidus and liquidus, kelvin.
pub const LEAST_INTERVAL_K: f32 = 1.0;
/// Most of a face's radiance over the heat that reaches it, per K^3: from there on it is as cold as what is around it to all digits, and single
/// precision holds its product with fourth powers of temperatures.
const MOST_RADIANCE: f64 = 1e20;
/// Most viscosity over the melt's that sums of single precision are sure of.
pub const MOST_STIFFER: f64 = 1e30;
/// Most that latent heat is over the heat capacity, kelvin, 14 times as much as of basalt: sums of both are single numbers.
pub const MOST_LATENT_K: f32 = 4000.0;

choice! {
    /// Law that the viscosity follows.
    pub enum Rheology {
        /// One for all.
        Constant = ("constant", "The viscosity is one for all"),
        /// Giordano and Dingwell (2003) by temperature, and a crust below the solidus.
        Basalt = ("basalt", "It grows as a basalt cools, and below the solidus lava is a crust that yields to stress"),
    }
}

/// Heat and rheology, in the ranges of [`Heat::declared`].
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Temperature at the start in kelvin, 700 to 2000.
    pub melt_k: f32,
    /// Temperature around the lava in kelvin, 0 to 2000, at most that at the start.
    pub ambient_k: f32,
    /// Emissivity of the surface, 0 to 1.
    pub emissivity: f32,
    /// Thermal conductivity in watts per metre and kelvin, 0 to 100,000.
    pub conductivity_w_mk: f32,
    /// Heat capacity in joules per kilogram and kelvin, 1 to 100,000.
    pub capacity_j_kgk: f32,
    /// Latent heat of crystallisation in joules per kilogram, 0 to 1,000,000, given off evenly from the liquidus to the solidus.
    pub latent_j_kg: f32,
    /// Temperature above which lava has no crystals, kelvin, 300 to 2500, at least one above the solidus.
    pub liquidus_k: f32,
    /// Law that the viscosity follows.
    pub rheology: Rheology,
    /// Temperature below which lava is a crust and has no melt, kelvin, 300 to 2000.
    pub solidus_k: f32,
    /// Most viscosity that crust and cold lava have, pascal seconds, at least that of the melt and at most 1e9.
    pub crust_pa_s: f32,
    /// Thermal conductivity of the crust that has grown on the outermost particles, watts per metre and kelvin, 0 to 1000; at 0 the surface
    /// glows as they do.
    pub crust_w_mk: f32,
}

impl Default for Heat {
    fn default() -> Self {
        Heat {
            melt_k: 1423.0,
            ambient_k: 300.0,
            emissivity: 0.95,
            conductivity_w_mk: 1.5,
            capacity_j_kgk: 1200.0,
            latent_j_kg: 0.0,
            liquidus_k: 1473.0,
            rheology: Rheology::Constant,
            solidus_k: 1273.0,
            crust_pa_s: 2000.0,
            crust_w_mk: 0.0,
        }
    }
}

impl Heat {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Heat>> {
        vec![
            Parameter::new("melt-temperature", field!(Heat.melt_k))
                .range(Range::from(700.0).to(2000.0))
                .unit("kelvin")
                .help("With sph: temperature of the lava at the start, and of what comes out of a vent")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("ambient", field!(Heat.ambient_k))
                .range(Range::from(0.0).to(2000.0))
                .unit("kelvin")
                .help("With sph: temperature that the surface radiates to, at most that at the start")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("emissivity", field!(Heat.emissivity))
                .range(Range::from(0.0).to(1.0))
                .help("With sph: emissivity of the surface; 0 keeps all heat")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("conductivity", field!(Heat.conductivity_w_mk))
                .range(Range::from(0.0).to(1e5))
                .unit("watts per metre and kelvin")
                .help("With sph: thermal conductivity of the lava")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("heat-capacity", field!(Heat.capacity_j_kgk))
                .range(Range::from(1.0).to(1e5))
                .unit("joules per kilogram and kelvin")
                .help("With sph: heat capacity of the lava; a hundredth of it makes heat a hundred times as fast")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("latent-heat", field!(Heat.latent_j_kg))
                .range(Range::from(0.0).to(1e6))
                .unit("joules per kilogram")
                .help("With sph: latent heat of crystallisation, given off evenly from the liquidus down to the solidus; basalt's is 350000")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("liquidus", field!(Heat.liquidus_k))
                .range(Range::from(300.0).to(2500.0))
                .unit("kelvin")
                .help("With latent heat: temperature above which lava has no crystals, at least one kelvin above the solidus")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("rheology", field!(Heat.rheology))
                .help("With sph: what the viscosity follows from")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("solidus", field!(Heat.solidus_k))
                .range(Range::from(300.0).to(2000.0))
                .unit("kelvin")
                .help("With basalt or latent heat: temperature below which lava is a crust, and has crystallised")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("crust-viscosity", field!(Heat.crust_pa_s))
                .range(Range::from(0.0).to(1e9))
                .unit("pascal seconds")
                .help("With basalt: most viscosity that crust and cold lava have, at least the melt's; a step's iterations grow with its root")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("crust-conductivity", field!(Heat.crust_w_mk))
                .range(Range::from(0.0).to(1000.0))
                .unit("watts per metre and kelvin")
                .help("With sph: thermal conductivity of the crust on the outermost particles, whose face is what glows; basalt's is 1.5; at 0 the surface is as hot as they are")
                .section("9")
                .cost(Cost::Buffers),
        ]
    }

    /// Diffusivity of heat, square metres per second, in lava of a density in kilograms per cubic metre.
    pub fn diffusivity_m2_s(&self, melt_kg_m3: f32) -> f64 {
        f64::from(self.conductivity_w_mk) / (f64::from(melt_kg_m3) * f64::from(self.capacity_j_kgk))
    }

    /// Heat that a face radiates over that which reaches it from half a distance of particles away for each kelvin, per K^3. Nothing reaches
    /// the face of what does not conduct, so that it keeps its heat.
    pub fn radiance(&self, spacing_m: f64) -> f64 {
        let conductance_w_m2k = 2.0 * f64::from(self.conductivity_w_mk) / spacing_m;
        let radiance = f64::from(self.emissivity) * STEFAN_BOLTZMANN / conductance_w_m2k;
        if conductance_w_m2k > 0.0 { radiance.min(MOST_RADIANCE) } else { 0.0 }
    }

    /// Radiance of a crust's face over the heat that reaches it, times the crust's thickness squared, for each kelvin that the particle below has lost,
    /// per K^3: a crust through which the temperature changes evenly, and a particle whose loss is the crust's. 0 without a crust.
    pub fn crust_radiance(&self, spacing_m: f64) -> f64 {
        let lost_m2k_w = 2.0 * spacing_m / f64::from(self.crust_w_mk);
        if self.crust_w_mk > 0.0 { f64::from(self.emissivity) * STEFAN_BOLTZMANN * lost_m2k_w } else { 0.0 }
    }

    /// Latent heat over the heat capacity, and what lies between solidus and liquidus, both in kelvin.
    pub fn crystallising_k(&self) -> [f32; 2] {
        [self.latent_j_kg / self.capacity_j_kgk, (self.liquidus_k - self.solidus_k).max(LEAST_INTERVAL_K)]
    }

    /// Most viscosity over the melt's.
    pub fn stiffest(&self, viscosity_pa_s: f32) -> f64 {
        match self.rheology {
            Rheology::Constant => 1.0,
            Rheology::Basalt => f64::from(self.crust_pa_s) / f64::from(viscosity_pa_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newton's step of `face_of` in `lava/sph-heat.comp`, from the hottest lava on.
    #[test]
    fn lava_that_hardly_conducts_has_a_face_of_finite_temperature() {
        for conductivity_w_mk in [f32::from_bits(1), 1e-38, 1e-30, 1e-20, 1.5, 1e5] {
            let radiance = Heat { conductivity_w_mk, ..Heat::default() }.radiance(0.001) as f32;
            let face = 2000.0f32;
            let excess = radiance * (face * face * face * face);
            let step = excess / (1.0 + 4.0 * radiance * face * face * face);
            assert!(
                radiance > 0.0 && excess.is_finite() && (0.0..=500.1).contains(&step),
                "{conductivity_w_mk}: {step}"
            );
        }
        let plain = Heat::default().radiance(0.02);
        assert!((plain / (0.95 * STEFAN_BOLTZMANN * 0.02 / 3.0) - 1.0).abs() < 1e-6, "{plain}");
    }
}
