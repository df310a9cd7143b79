//! Heat of the fluid, and what it makes of the viscosity (chapter 9), each particle against every other.

use glam::{DMat3, DVec3};

use super::fluid::{Fluid, Wall, integral, wendland, wendland_slope};

/// Of the SI, W / (m^2 K^4).
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;

/// The lava's heat, in metres, seconds, watts and kelvin.
pub struct Heat {
    /// Conductivity over density and heat capacity.
    pub diffusivity: f64,
    /// Density times heat capacity.
    pub capacity: f64,
    /// Emissivity of the surface, 0 to 1.
    pub emissivity: f64,
    /// Temperature around the lava.
    pub ambient: f64,
    /// Latent heat over heat capacity, and the temperatures between which it is given off.
    pub latent: f64,
    /// Lava below has crystallised.
    pub solidus: f64,
    /// Lava above has no crystals.
    pub liquidus: f64,
}

impl Heat {
    /// Heat at a temperature over the heat capacity, the latent one included.
    pub fn enthalpy(&self, kelvin: f64) -> f64 {
        let melt = if kelvin <= self.solidus {
            0.0
        } else if kelvin >= self.liquidus {
            1.0
        } else {
            (kelvin - self.solidus) / (self.liquidus - self.solidus)
        };
        kelvin + melt * self.latent
    }

    /// The temperature of so much, by bisection: what is latent makes it lower.
    pub fn kelvin(&self, enthalpy: f64) -> f64 {
        let (mut low, mut high) = (enthalpy - self.latent, enthalpy);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.enthalpy(middle) < enthalpy { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

impl Fluid {
    /// Steepness of the amount of lava around a particle, per radius of the kernel; where it is less than 0.6 the particle is
    /// inside, and has none.
    pub fn steepness(&self, places: &[DVec3], at: usize) -> f64 {
        let (volume, _) = self.volumes();
        let mut gradient = DVec3::ZERO;
        for (i, &other) in places.iter().enumerate() {
            let way = self.apart(places[at], other);
            if i != at && way.length() > 0.0 {
                gradient += volume * wendland_slope(way.length(), self.support) * way.normalize();
            }
        }
        let walls = self.walls(places[at]);
        for &Wall { distance, normal, axis } in &walls {
            // Behind two walls at once lava would be counted twice.
            let along = |other: usize| -> f64 {
                walls.iter().filter(|wall| wall.axis == other).map(|wall| self.beyond(wall.distance)).sum()
            };
            let alone: f64 = (0..3).filter(|other| *other != axis).map(|other| 1.0 - along(other)).product();
            gradient -= self.over_plane(distance) * alone * normal;
        }
        let steepness = self.support * gradient.length();
        if steepness > 0.6 { steepness } else { 0.0 }
    }

    /// Faces, of the size of a particle's, by the steepness: a level lattice has one for each particle of a layer.
    pub fn faces(&self, steepness: f64) -> f64 {
        let layers = (0..4).map(|layer| self.support * self.over_plane((f64::from(layer) + 0.5) * self.spacing));
        steepness / layers.filter(|steep| *steep > 0.6).sum::<f64>()
    }

    /// A particle's temperature after one step, and before radiation.
    pub fn heated(&self, heat: &Heat, places: &[DVec3], kelvin: &[f64], at: usize) -> (f64, f64) {
        let (_, volume) = self.volumes();
        let mut enthalpy = heat.enthalpy(kelvin[at]);
        for (i, &other) in places.iter().enumerate() {
            let distance = self.apart(places[at], other).length();
            if i != at && distance > 0.0 {
                let drag = -wendland_slope(distance, self.support) / distance;
                enthalpy += 2.0 * self.step * heat.diffusivity * volume * drag * (kelvin[i] - kelvin[at]);
            }
        }
        let conducted = heat.kelvin(enthalpy);
        let faces = self.faces(self.steepness(places, at));
        // What comes to the face from the middle, half a distance away, is what leaves it: by bisection.
        let conductivity = heat.diffusivity * heat.capacity;
        let arriving = |face: f64| conductivity * (conducted - face) / (0.5 * self.spacing);
        let leaving = |face: f64| heat.emissivity * STEFAN_BOLTZMANN * (face.powi(4) - heat.ambient.powi(4));
        let (mut low, mut high) = (heat.ambient.min(conducted), heat.ambient.max(conducted));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if leaving(middle) < arriving(middle) { low = middle } else { high = middle }
        }
        let lost = self.step * faces / self.spacing * arriving(low) / heat.capacity;
        (heat.kelvin(enthalpy - lost), conducted)
    }

    /// Rate of strain at a particle per second: exact of a speed that is linear and 0 at walls, where there are particles on all
    /// sides. Also true where a little less or more would leave the sums over few particles as they come.
    pub fn strain_rate(&self, places: &[DVec3], speeds: &[DVec3], at: usize) -> (DMat3, bool) {
        let (_, volume) = self.volumes();
        let (mut gradient, mut unit) = (DMat3::ZERO, DMat3::ZERO);
        for (i, &other) in places.iter().enumerate() {
            let way = self.apart(places[at], other);
            if i != at && way.length() > 0.0 {
                let direction = volume * wendland_slope(way.length(), self.support) * way.normalize();
                gradient += outer(speeds[i] - speeds[at], direction);
                unit += outer(-way, direction);
            }
        }
        for Wall { distance, normal, .. } in self.walls(places[at]) {
            if distance < self.support {
                let moment = integral(distance, self.support, |z| self.drag_of_plane(z) * z * z);
                gradient += outer(speeds[at] * moment / distance, normal);
                unit += outer(moment * normal, normal);
            }
        }
        let mean = (unit.x_axis.x + unit.y_axis.y + unit.z_axis.z) / 3.0;
        let flatness = unit.determinant() / mean.powi(3);
        if mean > 0.1 && flatness > 0.05 {
            gradient *= unit.inverse();
        }
        let is_close_call = (mean - 0.1).abs() < 1e-3 || (flatness - 0.05).abs() < 1e-3;
        (0.5 * (gradient + gradient.transpose()), is_close_call)
    }

    /// The root of twice the sum of the squares of the components of the mean rate of strain around a particle, by the kernel. Also
    /// true where one of them is a close call.
    pub fn strain_around(&self, places: &[DVec3], strains: &[(DMat3, bool)], at: usize) -> (f64, bool) {
        let (mut sum, mut weights, mut is_close_call) = (DMat3::ZERO, 0.0, false);
        for (&place, &(strain, is_close)) in places.iter().zip(strains) {
            let weight = wendland(self.apart(places[at], place).length(), self.support);
            sum += strain * weight;
            weights += weight;
            is_close_call |= is_close && weight > 0.0;
        }
        let squares = sum.to_cols_array().iter().map(|component| component * component).sum::<f64>();
        ((2.0 * squares).sqrt() / weights, is_close_call)
    }
}

fn outer(speed: DVec3, direction: DVec3) -> DMat3 {
    DMat3::from_cols(speed * direction.x, speed * direction.y, speed * direction.z)
}

/// Viscosity of basalt of Etna, pascal seconds (Giordano and Dingwell 2003), with 0.1 % of water.
pub fn melt_viscosity(kelvin: f64) -> f64 {
    const WATER: f64 = 0.1;
    10f64.powf(-4.643 + (5812.44 - 427.04 * WATER) / (kelvin - 499.31 + 28.74 * WATER.ln()))
}

/// Yield stress of basalt, pascals (Ishihara et al. 1990).
pub fn yield_stress(kelvin: f64) -> f64 {
    10f64.powf(13.00997 - 0.0089 * kelvin)
}

/// Mean temperatures of the cells of a slab, the lowest first, after a time: the heat equation in one dimension, insulated
/// below, radiating from its upper face by Stefan and Boltzmann's law.
pub fn cooled_slab(heat: &Heat, depth: f64, cells: usize, kelvin: f64, time: f64) -> Vec<f64> {
    let side = depth / cells as f64;
    // A fifth of what is stable.
    let steps = (time / (0.1 * side * side / heat.diffusivity)).ceil();
    let step = time / steps;
    let mut slab = vec![kelvin; cells];
    let mut enthalpies = vec![heat.enthalpy(kelvin); cells];
    let flow = |low: f64, high: f64| heat.diffusivity / side * (low - high);
    let radiated = |t: f64| heat.emissivity * STEFAN_BOLTZMANN / heat.capacity * (t.powi(4) - heat.ambient.powi(4));
    for _ in 0..steps as u64 {
        // The face is half a cell from the middle of the last one: its temperature, from the balance there by Newton's method.
        let (inner, mut face) = (slab[cells - 1], slab[cells - 1]);
        for _ in 0..8 {
            let excess = radiated(face) - 2.0 * flow(inner, face);
            let slope = radiated(face + 0.5) - radiated(face - 0.5) + 2.0 * heat.diffusivity / side;
            face -= excess / slope;
        }
        let between = slab.windows(2).map(|pair| flow(pair[0], pair[1]));
        let upwards: Vec<f64> = [0.0].into_iter().chain(between).chain([radiated(face)]).collect();
        for ((cell, enthalpy), flows) in slab.iter_mut().zip(&mut enthalpies).zip(upwards.windows(2)) {
            *enthalpy += step / side * (flows[0] - flows[1]);
            *cell = heat.kelvin(*enthalpy);
        }
    }
    slab
}

/// Temperature of the face of a crust that conducts so well, on a particle so long and of that mean temperature: that of the thickness at which the
/// crust has lost what the particle has.
pub fn crust_face(heat: &Heat, conductivity: f64, melt: f64, spacing: f64, kelvin: f64) -> f64 {
    let halved = |mut low: f64, mut high: f64, is_below: &dyn Fn(f64) -> bool| {
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if is_below(middle) { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    // Where what comes through the crust is what its face radiates.
    let face = |thickness: f64| {
        let radiated = |t: f64| heat.emissivity * STEFAN_BOLTZMANN * (t.powi(4) - heat.ambient.powi(4));
        halved(heat.ambient, melt, &|t| radiated(t) < conductivity * (melt - t) / thickness)
    };
    let lost = |thickness: f64| 0.5 * thickness * (melt - face(thickness));
    face(halved(0.0, 1000.0 * spacing, &|thickness| lost(thickness) < spacing * (melt - kelvin))).min(kelvin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half space that gives away a constant flux: Carslaw and Jaeger (1959), 2.9.
    #[test]
    fn a_thick_slab_cools_as_a_half_space_does() {
        // Small losses are nearly constant.
        let heat = Heat {
            diffusivity: 1e-3,
            capacity: 1e6,
            emissivity: 0.2,
            ambient: 300.0,
            latent: 0.0,
            solidus: 1273.0,
            liquidus: 1473.0,
        };
        let (depth, time, start) = (1.0, 10.0, 1400.0);
        let slab = cooled_slab(&heat, depth, 200, start, time);
        let flux = heat.emissivity * STEFAN_BOLTZMANN * (1400f64.powi(4) - 300f64.powi(4));
        // The cell's middle is 2.5 mm below the face: the loss there falls nearly by the flux's gradient.
        let conductivity = heat.diffusivity * heat.capacity;
        let face = 2.0 * flux / conductivity * (heat.diffusivity * time / std::f64::consts::PI).sqrt();
        let lost = start - slab[199];
        let expected = face - flux / conductivity * 0.0025;
        println!("{lost} {expected}");
        assert!((lost / expected - 1.0).abs() < 0.02, "{lost} {expected}");
        assert!((slab[0] - start).abs() < 1e-3);
        let heat_lost = slab.iter().map(|t| (start - t) * depth / 200.0).sum::<f64>() * heat.capacity;
        assert!((heat_lost / (flux * time) - 1.0).abs() < 0.02, "{heat_lost}");
    }
}
