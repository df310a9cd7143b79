//! Lava that comes out of a vent (chapter 9, "Improved particle simulation"), particle by particle from the pool.

use glam::{DVec2, DVec3, Vec3};

use super::super::parameters::Parameters;
use super::Scale;
use super::heat::Rheology;
use super::toes::{LEAST_VOLUME, MOST_TOES, Toe, radius_m, toe_of, toes};
use crate::field;
use crate::measure::ParameterError;
use crate::measure::parameter::{Cost, Parameter, Range};
use crate::scene::random::Random;

/// Largest fraction of the room in which lava comes out that one step fills.
const MOST_FILLED: f64 = 0.1;

/// The vent, in the ranges of [`Vent::declared`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vent {
    /// Lava that comes out, cubic metres per second, 0 to 1,000,000; at 0 all of it stands there at the start.
    pub effusion_m3_s: f32,
    /// Its middle along x and z, metres, in the space.
    pub middle_m: [f32; 2],
    /// Its radius in metres, above 0 and at most 1000.
    pub radius_m: f32,
    /// Mean volume of the toes that lava breaks out as, cubic metres, 0 to 1000; at 0 all of it comes out at the vent.
    pub toe_m3: f32,
}

impl Default for Vent {
    fn default() -> Self {
        Vent { effusion_m3_s: 0.0, middle_m: [0.5, 0.5], radius_m: 0.15, toe_m3: 0.0 }
    }
}

/// Particles that are out after a time: as many as the effusion has filled, to the nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inflow {
    /// Particles in a step; none where all are there at the start.
    per_step: Option<f64>,
    /// Steps of a frame.
    substeps: u32,
    /// The pool.
    particles: u32,
}

impl Inflow {
    /// Of these parameters, with so many particles.
    pub fn of(parameters: &Parameters, particles: u32) -> Self {
        let flow = &parameters.flow;
        let Scale { step_s, substeps, .. } = Scale::of(parameters);
        let step_m3 = step_s * f64::from(flow.vent.effusion_m3_s);
        Inflow { per_step: (step_m3 > 0.0).then(|| step_m3 / flow.spacing_m(particles).powi(3)), substeps, particles }
    }

    /// Particles that are out after so many frames: at least the first.
    pub fn out(&self, frames: u32) -> u32 {
        self.after(frames.saturating_mul(self.substeps))
    }

    /// After so many steps of frames.
    pub fn after(&self, steps: u32) -> u32 {
        match self.per_step {
            None => self.particles,
            Some(per_step) => ((f64::from(steps) * per_step).round() as u32).clamp(1, self.particles),
        }
    }
}

impl Vent {
    /// Every number that a user can set, once.
    pub fn declared() -> Vec<Parameter<Vent>> {
        vec![
            Parameter::new("effusion-rate", field!(Vent.effusion_m3_s))
                .range(Range::from(0.0).to(1e6))
                .unit("cubic metres per second")
                .help("With sph: lava that comes out of a vent, up to the volume of the block; at 0 the block stands there at the start")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("vent", field!(Vent.middle_m))
                .placeholder("X,Z")
                .range(Range::from(0.0).to(1000.0))
                .unit("metres")
                .help("With an effusion rate: middle of the vent on the floor, in the space with all of its radius")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("vent-radius", field!(Vent.radius_m))
                .range(Range::above(0.0).to(1000.0))
                .unit("metres")
                .help("With an effusion rate: radius of the vent, and height of the room above it where lava comes out")
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("toe-volume", field!(Vent.toe_m3))
                .range(Range::from(0.0).to(1000.0))
                .unit("cubic metres")
                .help("With an effusion rate and basalt: mean volume of a toe, whose skin then holds, so that lava breaks out beside it; at 0 all comes out at the vent")
                .section("3.2")
                .cost(Cost::Buffers),
        ]
    }

    /// Checks what ranges of single numbers do not; the caller has checked those.
    ///
    /// # Errors
    /// The first parameter that does not fit the others.
    pub fn check(&self, parameters: &Parameters) -> Result<(), ParameterError> {
        if self.effusion_m3_s == 0.0 {
            let default = Vent::default();
            let [x, z] = self.middle_m;
            let problem = "does nothing without an `effusion-rate`";
            ParameterError::check(self.middle_m == default.middle_m, "vent", format!("{x},{z}"), problem)?;
            ParameterError::check(self.toe_m3 == default.toe_m3, "toe-volume", self.toe_m3, problem)?;
            return ParameterError::check(self.radius_m == default.radius_m, "vent-radius", self.radius_m, problem);
        }
        let space = parameters.space_m;
        let is_inside = |at: f32, side: f32| at >= self.radius_m && at + self.radius_m <= side;
        let [x, z] = self.middle_m;
        ParameterError::check(
            is_inside(x, space.x) && is_inside(z, space.z) && self.radius_m <= space.y,
            "vent",
            format!("{x},{z}"),
            &format!("must lie in the space with all of its radius, {} metres, and that height", self.radius_m),
        )?;
        let is_basalt = self.toe_m3 == 0.0 || parameters.flow.heat.rheology == Rheology::Basalt;
        ParameterError::check(is_basalt, "toe-volume", self.toe_m3, "needs a skin, which only `rheology` basalt has")?;
        let block_m3 = parameters.flow.block_m.as_dvec3().element_product();
        let least_m3 = least_toe_m3(block_m3);
        ParameterError::check(
            self.toe_m3 >= least_m3 || self.toe_m3 == 0.0,
            "toe-volume",
            self.toe_m3,
            &format!("must be at least {least_m3} cubic metres, so that the `block` is no more than {MOST_TOES} toes"),
        )?;
        let step_m3 = Scale::of(parameters).step_s * f64::from(self.effusion_m3_s);
        let (place, wider) = if self.narrowest_m() < f64::from(self.radius_m) {
            ("smallest toe", "toe-volume")
        } else {
            ("vent", "vent-radius")
        };
        ParameterError::check(
            step_m3 <= MOST_FILLED * self.room_m3(),
            "effusion-rate",
            self.effusion_m3_s,
            &format!(
                "would fill more than a tenth of the room above the {place} in a step: widen it by `{wider}`, or take a shorter \
                 `time-step` or more `substeps`"
            ),
        )
    }

    /// Toes of all lava, the first of which stays over the vent; none without a volume of theirs. They know the floor's slope, and no bed.
    pub fn toes(&self, parameters: &Parameters) -> Vec<Toe> {
        let flow = &parameters.flow;
        if self.effusion_m3_s == 0.0 || self.toe_m3 == 0.0 {
            return Vec::new();
        }
        let fall = f64::from(flow.slope_deg(true)).to_radians().tan();
        let sides_m = DVec2::new(parameters.space_m.x.into(), parameters.space_m.z.into());
        toes(self, flow.block_m.as_dvec3().element_product(), fall, sides_m, parameters.seed)
    }

    /// Least radius of the disc over which lava comes out: the vent's, or that of the smallest toe if it is narrower.
    fn narrowest_m(&self) -> f64 {
        let vent_m = f64::from(self.radius_m);
        if self.toe_m3 == 0.0 { vent_m } else { vent_m.min(radius_m(f64::from(LEAST_VOLUME) * f64::from(self.toe_m3))) }
    }

    /// Least room in which lava comes out: a cylinder over that disc, as high as the vent's radius.
    fn room_m3(&self) -> f64 {
        std::f64::consts::PI * f64::from(self.radius_m) * self.narrowest_m().powi(2)
    }

    /// Places in the vent for so many particles, which fill it evenly however many follow each other: an additive sequence by
    /// the plastic number's next of kin (Roberts 2018), from a place that the seed gives. Those of a toe lie around its
    /// middle, which moves as it grows, no farther away than the radius that it has in the end.
    pub fn places(&self, parameters: &Parameters, margin_m: f64) -> Vec<Vec3> {
        /// The root of g^4 = g + 1.
        const G: f64 = 1.220_744_084_605_759_6;
        let mut random = Random::with_stream(parameters.seed, 3);
        let first = DVec3::from_array([(); 3].map(|()| f64::from(random.unit())));
        let step = DVec3::new(1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G));
        let radius_m = f64::from(self.radius_m);
        let toes = self.toes(parameters);
        let vent_m = DVec2::from(self.middle_m.map(f64::from));
        let particle_m3 = parameters.flow.spacing_m(parameters.particles).powi(3);
        let disc = |number: u32| {
            let out_m3 = f64::from(number) * particle_m3;
            let toe = toes.get(toe_of(&toes, out_m3) as usize);
            toe.map_or((vent_m, radius_m), |toe| (toe.middle_m(out_m3 - toe.first_m3), radius_m.min(toe.full().1)))
        };
        let place = |number: u32| {
            let (DVec2 { x, y: z }, wide_m) = disc(number);
            let DVec3 { x: turn, y: height, z: share } = (first + f64::from(number) * step).fract();
            let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
            let aside_m = wide_m * share.sqrt();
            let height_m = margin_m + height * (radius_m - margin_m).max(0.0);
            DVec3::new(x + aside_m * cosine, height_m, z + aside_m * sine).as_vec3()
        };
        (0..parameters.particles).map(place).collect()
    }
}

/// Least mean volume of the toes of so much lava in cubic metres, as it is typed: the nearest number below may be too small.
fn least_toe_m3(block_m3: f64) -> f32 {
    let nearest = (block_m3 / MOST_TOES) as f32;
    if f64::from(nearest) * MOST_TOES < block_m3 { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::lava::{Flow, Heat, Simulation};

    fn parameters(effusion_m3_s: f32) -> Parameters {
        let vent = Vent { effusion_m3_s, ..Vent::default() };
        Parameters { simulation: Simulation::Sph, flow: Flow { vent, ..Flow::default() }, ..Parameters::default() }
    }

    #[test]
    fn as_many_particles_are_out_as_the_effusion_fills() {
        let still = Inflow::of(&parameters(0.0), 40_000);
        assert_eq!([0, 1, 1000].map(|steps| still.out(steps)), [40_000; 3]);
        // 0.72 m^3 in 40,000 particles: 0.018 m^3/s are 1000 in a second of 30 steps.
        let flowing = Inflow::of(&parameters(0.018), 40_000);
        let found = [0, 1, 3, 30, 300, 1200, 1201, 100_000].map(|steps| flowing.out(steps));
        assert_eq!(found, [1, 33, 100, 1000, 10_000, 40_000, 40_000, 40_000]);
    }

    #[test]
    fn places_fill_the_room_evenly() {
        let parameters = Parameters { particles: 4000, ..parameters(0.01) };
        let vent = parameters.flow.vent;
        let places = vent.places(&parameters, 0.01);
        let mean = places.iter().sum::<Vec3>() / 4000.0;
        assert!((mean - Vec3::new(0.5, 0.08, 0.5)).abs().max_element() < 2e-3, "{mean}");
        for (at, place) in places.iter().enumerate() {
            assert!((place.x - 0.5).hypot(place.z - 0.5) < 0.1501 && (0.0099..0.1501).contains(&place.y), "{place}");
            // Those of one step keep apart.
            assert!(places[at + 1..].iter().take(30).all(|other| other.distance(*place) > 0.01), "{at}");
        }
        assert_ne!(places, vent.places(&Parameters { seed: 2, ..parameters }, 0.01));
    }

    /// Out of a vent that is wider than its toes.
    #[test]
    fn lava_comes_out_no_wider_than_its_toe() {
        let vent = Vent { effusion_m3_s: 0.002, middle_m: [0.3, 0.6], radius_m: 0.07, toe_m3: 0.0001 };
        let block_m = Vec3::new(0.3, 0.1, 0.45);
        let flow = Flow { block_m, vent, ..Flow::default() };
        let parameters = Parameters { particles: 3000, simulation: Simulation::Sph, flow, ..Parameters::default() };
        let toes = vent.toes(&parameters);
        let particle_m3 = parameters.flow.spacing_m(3000).powi(3);
        assert!(radius_m(1.5e-4) < 0.07 && toes.len() > 50);
        for (number, place) in vent.places(&parameters, 0.001).iter().enumerate() {
            let out_m3 = number as f64 * particle_m3;
            let toe = toes.iter().rfind(|toe| toe.first_m3 <= out_m3).unwrap();
            let aside_m = DVec2::new(place.x.into(), place.z.into()).distance(toe.middle_m(out_m3 - toe.first_m3));
            assert!(aside_m <= radius_m(toe.volume_m3) + 1e-6, "{number}: {aside_m}");
        }
    }

    /// A tenth of the vent's room is 1.06e-3 cubic metres, of that of a toe of a litre 3.5e-4; one of 10 litres is wider than the vent. The
    /// smallest toe has half of the mean's volume, and a step brings 6.7e-4.
    #[test]
    fn lava_of_toes_has_no_more_room_than_they_have() {
        let of = |toe_m3: f32| {
            let vent = Vent { effusion_m3_s: 0.08, toe_m3, ..Vent::default() };
            let heat = Heat { rheology: Rheology::Basalt, ..Heat::default() };
            let flow = Flow { vent, heat, substeps: Some(4), ..Flow::default() };
            vent.check(&Parameters { simulation: Simulation::Sph, flow, ..Parameters::default() })
        };
        assert_eq!([of(0.0), of(0.02)], [Ok(()), Ok(())]);
        let error = of(0.002).unwrap_err();
        assert!(error.name == "effusion-rate" && error.range.contains("`toe-volume`"), "{error}");
    }

    /// The bound of a message, typed back.
    #[test]
    fn the_least_toe_is_taken_as_it_is_told() {
        for block_m in [Vec3::new(0.3, 0.2, 0.45), Vec3::new(1.2, 0.6, 1.0), Vec3::new(0.7, 0.1, 0.3)] {
            let of = |toe_m3: f32| {
                let vent = Vent { effusion_m3_s: 0.0005, toe_m3, ..Vent::default() };
                let heat = Heat { rheology: Rheology::Basalt, ..Heat::default() };
                let flow = Flow { block_m, vent, heat, ..Flow::default() };
                let parameters = Parameters { simulation: Simulation::Sph, flow, ..Parameters::default() };
                vent.check(&parameters)
            };
            let told = of(1e-9).unwrap_err().range;
            let bound = told.strip_prefix("must be at least ").unwrap().split(' ').next().unwrap();
            let bound: f32 = bound.parse().unwrap();
            assert_eq!(of(bound), Ok(()), "{told}");
            assert!(of(bound.next_down().next_down()).is_err(), "{told}");
        }
    }
}
