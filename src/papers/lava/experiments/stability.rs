//! Stability of the fluid over many steps (chapter 9, "Improved particle simulation"): its laws, held at every frame, and a row
//! of what was found now and then.

use glam::{DVec2, DVec3};
use serde_json::{Value, json};

use super::super::animate::Animate;
use super::super::setup::Setup;
use super::super::sph::Scale;
use super::flow::{self, State, observed};
use crate::gpu::Mode;
use crate::gpu::transfer::read_buffer;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study as _;
use crate::papers::lava::{Bed, Parameters, Sides};

/// Frames without `frames`: ten seconds of the default step.
pub const FRAMES: u32 = 300;
/// Rows of the table, at most, beside that of the first step.
const ROWS: u32 = 60;

/// Greatest density over that at rest.
const DENSEST: f64 = 2.0;
/// Greatest speed over that of a free fall from the highest particle to the lowest place: what nothing slows breaks a dam as fast
/// as the square root of 2 of it.
const FASTEST: f64 = std::f64::consts::SQRT_2;
/// Distances of particles that pressure alone moves one in the first step, at most.
const PRESSED: f64 = 0.25;
/// Distances of particles that one is moved in a step, at most, where lava comes out among others: one that lies on it pushes it off by itself.
const PUSHED: f64 = 1.0;
/// Heat that may come from nothing, and energy, over the most that there is.
const GAINED: f64 = 1e-4;

/// Columns that the plot shows.
pub const SPEEDS: [&str; 2] = ["greatest speed m/s", "mean speed m/s"];
/// Columns that another shows.
pub const COMPRESSIONS: [&str; 2] = ["greatest compression %", "mean compression %"];

const COLUMNS: [&str; 12] = [
    "frame",
    "time s",
    "particles",
    "mass kg",
    "greatest speed m/s",
    "mean speed m/s",
    "greatest compression %",
    "mean compression %",
    "energy J/kg",
    "mean K",
    "front m",
    "greatest thickness m",
];

/// A frame's particles in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Found {
    fastest_m_s: f64,
    mean_m_s: f64,
    /// Over the density at rest.
    densest: f64,
    /// Excess of the particles' density over that at rest, in the mean of all.
    denser: f64,
    /// Kinetic and potential, above that at rest in the space's lowest place.
    energy_j_kg: f64,
    /// Potential of the highest particle, above that.
    highest_j_kg: f64,
    mean_k: f64,
}

/// Bounds of what a fluid may do.
struct Laws {
    space_m: DVec3,
    gravity_m_s2: DVec3,
    lowest_j_kg: f64,
    fastest_m_s: f64,
    /// Beside it, of lava that is pushed aside by what comes out of a vent; 0 without.
    pushed_m_s: f64,
    /// Of the block at the start; none of lava that is pushed out of a vent.
    energy_j_kg: Option<f64>,
    coldest_k: f64,
    hottest_k: f64,
    /// Nothing takes heat away.
    keeps_heat: bool,
}

impl Laws {
    fn of(p: &Parameters, bed: &Bed, places: &[DVec3]) -> Self {
        let space_m = p.space_m.as_dvec3();
        let slope = f64::from(p.flow.slope_deg(bed.is_level())).to_radians();
        let gravity_m_s2 = f64::from(p.flow.gravity_m_s2) * DVec3::new(slope.sin(), -slope.cos(), 0.0);
        // The floor falls along x.
        let lowest_j_kg = -gravity_m_s2.x * space_m.x;
        let highest = places.iter().map(|place| -gravity_m_s2.dot(*place) - lowest_j_kg).fold(0.0, f64::max);
        let all = places.iter().map(|place| -gravity_m_s2.dot(*place) - lowest_j_kg).sum::<f64>() / places.len() as f64;
        let heat = &p.flow.heat;
        let Scale { spacing_m, step_s, .. } = Scale::of(p);
        let is_block = p.flow.vent.effusion_m3_s == 0.0;
        Laws {
            space_m,
            gravity_m_s2,
            lowest_j_kg,
            fastest_m_s: FASTEST * (2.0 * highest).sqrt(),
            pushed_m_s: if is_block { 0.0 } else { PUSHED * spacing_m / step_s },
            energy_j_kg: is_block.then_some(all),
            coldest_k: heat.ambient_k.into(),
            hottest_k: heat.melt_k.into(),
            keeps_heat: heat.emissivity == 0.0,
        }
    }

    /// A frame's particles by its numbers; what is wrong with one of them.
    fn found(&self, bed: &Bed, state: &State, densities: &[f64]) -> Result<Found, String> {
        let count = state.places.len() as f64;
        let mut found = Found {
            fastest_m_s: 0.0,
            mean_m_s: 0.0,
            densest: 0.0,
            denser: 0.0,
            energy_j_kg: 0.0,
            highest_j_kg: 0.0,
            mean_k: 0.0,
        };
        for (at, ((place, velocity), kelvin)) in
            state.places.iter().zip(&state.velocities).zip(&state.kelvin).enumerate()
        {
            if !(place.is_finite() && velocity.is_finite() && kelvin.is_finite()) {
                return Err(format!("particle {at} is nowhere: {place} m, {velocity} m/s, {kelvin} K"));
            }
            let is_inside = place.cmpge(DVec3::ZERO).all() && place.cmple(self.space_m).all();
            if !is_inside || place.y < bed.at(DVec2::new(place.x, place.z)).z {
                return Err(format!("particle {at} has left the space or lies under its bed: {place} m"));
            }
            let speed = velocity.length();
            found.fastest_m_s = found.fastest_m_s.max(speed);
            found.mean_m_s += speed / count;
            let potential_j_kg = -self.gravity_m_s2.dot(*place) - self.lowest_j_kg;
            found.highest_j_kg = found.highest_j_kg.max(potential_j_kg);
            found.energy_j_kg += (0.5 * speed * speed + potential_j_kg) / count;
            found.mean_k += kelvin / count;
            let slack = GAINED * (self.hottest_k - self.coldest_k) + 1e-3;
            if !(self.coldest_k - slack..=self.hottest_k + slack).contains(kelvin) {
                let (coldest, hottest) = (self.coldest_k, self.hottest_k);
                return Err(format!("particle {at} has {kelvin} K, outside of {coldest} to {hottest} K"));
            }
        }
        for density in densities {
            if !density.is_finite() {
                return Err("a particle has a density that is no number".to_owned());
            }
            found.densest = found.densest.max(*density);
            found.denser += (density - 1.0).max(0.0) / count;
        }
        Ok(found)
    }

    /// The first step presses apart what the lattice of the start has laid too close, at walls above all: that energy counts as
    /// the start's, and the speed up to `pressed_m_s`.
    fn settle(&mut self, first: &Found, pressed_m_s: f64) {
        self.energy_j_kg = self.energy_j_kg.map(|start| start.max(first.energy_j_kg));
        self.fastest_m_s = self.fastest_m_s.max(first.fastest_m_s.min(pressed_m_s));
    }

    /// Lava that comes out lifts what lies above it, which falls from there.
    fn lift(&mut self, now: &Found) {
        if self.energy_j_kg.is_none() {
            self.fastest_m_s = self.fastest_m_s.max(FASTEST * (2.0 * now.highest_j_kg).sqrt());
        }
    }

    /// Fails by the first law that a frame breaks after another.
    fn hold(&self, before: &Found, now: &Found) -> Result<(), String> {
        let Found { fastest_m_s, densest, energy_j_kg, mean_k, .. } = *now;
        let bound = self.fastest_m_s + self.pushed_m_s;
        if fastest_m_s > bound {
            return Err(format!(
                "a particle has {fastest_m_s:.2} m/s, more than {bound:.2} m/s that its fall can give it"
            ));
        }
        if densest > DENSEST {
            return Err(format!("a particle is {densest:.2} times as dense as at rest, more than {DENSEST} times"));
        }
        if let Some(most) =
            self.energy_j_kg.filter(|most| energy_j_kg > most * (1.0 + GAINED) + f64::from(f32::EPSILON))
        {
            return Err(format!("the lava has {energy_j_kg:.5} J/kg, more than the {most:.5} J/kg of the start"));
        }
        let slack = GAINED * (self.hottest_k - self.coldest_k) + 1e-3;
        let is_lost = self.keeps_heat && (mean_k - self.hottest_k).abs() > slack;
        // Of a block; what comes out of a vent is as hot as any.
        let is_gained = self.energy_j_kg.is_some() && mean_k > before.mean_k + slack;
        if is_gained || is_lost {
            return Err(format!("the mean temperature goes from {:.4} to {mean_k:.4} K", before.mean_k));
        }
        Ok(())
    }
}

/// Every particle once.
fn counted(items: &[[u32; 2]]) -> Result<(), String> {
    let mut is_there = vec![false; items.len()];
    for [_, number] in items {
        match is_there.get_mut(*number as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(format!("particle {number} is there twice, and another is lost")),
        }
    }
    Ok(())
}

/// The fluid of the set-up must end somewhere.
///
/// # Errors
/// [`Error::Input`] for particles that are none, and for lava that falls for ever.
pub fn check(setup: &Setup) -> Result<(), Error> {
    flow::check(setup)?;
    match setup.parameters.flow.sides {
        Sides::Walls => Ok(()),
        Sides::Periodic => Err(Error::Input(
            "`sides` periodic: such lava falls for ever, and no speed is too high; give walls".to_owned(),
        )),
    }
}

/// The table of these rows.
pub fn table(rows: Vec<Vec<Value>>) -> ResultTable {
    ResultTable { title: "A fluid over many steps: what its laws bound", columns: &COLUMNS, rows }
}

/// Keeps the rows that are there so far.
pub type Keep<'a> = dyn FnMut(&[Vec<Value>]) -> Result<(), Error> + 'a;

/// Follows a fluid over so many frames; `keep` is given the rows whenever there is one more.
///
/// # Errors
/// [`Error::Law`] for a frame that breaks one, behind the rows before it; [`Error::Gpu`], [`Error::Interrupted`], and what
/// `keep` answers.
pub fn follow(
    machine: &mut Machine,
    setup: &Setup,
    frames: u32,
    watch: &mut Watch<'_>,
    rows: &mut Vec<Vec<Value>>,
    keep: &mut Keep<'_>,
) -> Result<(), Error> {
    let p = &setup.parameters;
    let scene = setup.load()?;
    let bed = &scene.particles.bed;
    let mut animate = Animate::new(&machine.shaders, "stability", p, &scene.particles)?;
    let Scale { spacing_m, step_s, .. } = Scale::of(p);
    let start: Vec<DVec3> = scene.particles.positions.iter().map(|place| place.as_dvec3()).collect();
    let mut laws = Laws::of(p, bed, &start);
    let vent = p.flow.vent;
    let vent_m = (vent.effusion_m3_s > 0.0).then(|| DVec2::from(vent.middle_m.map(f64::from)));
    let every = frames.div_ceil(ROWS).max(1);
    let mut before: Option<Found> = None;
    for frame in 1..=frames {
        watch.check()?;
        machine.recorder.run(Mode::Plain, |frame| animate.record(frame))?;
        let Some(sph) = animate.sph() else { break };
        sph.check(&machine.device)?;
        let out = animate.out() as usize;
        let state = flow::state(machine, &animate)?;
        let factors = bytemuck::pod_collect_to_vec::<u8, [f32; 2]>(&read_buffer(&machine.device, &sph.factors)?);
        let densities: Vec<f64> = factors.iter().take(out).map(|[_, density]| f64::from(*density)).collect();
        let items = bytemuck::pod_collect_to_vec::<u8, [u32; 2]>(&read_buffer(&machine.device, &sph.sort.items)?);
        let held = counted(&items[..out.min(items.len())]).and_then(|()| {
            let found = laws.found(bed, &state, &densities)?;
            if before.is_none() {
                laws.settle(&found, PRESSED * spacing_m / step_s);
            }
            laws.lift(&found);
            laws.hold(before.as_ref().unwrap_or(&found), &found)?;
            Ok(found)
        });
        let found = held.map_err(|broken| Error::Law(format!("frame {}: {broken}", frame - 1)))?;
        before = Some(found);
        if frame == 1 || frame == frames || frame % every == 0 {
            let seen = observed(p.space_m, spacing_m, (bed, vent_m), &state.places, &state.kelvin);
            rows.push(vec![
                json!(frame - 1),
                json!(f64::from(frame) * f64::from(p.time_step_s)),
                json!(out),
                json!(out as f64 * spacing_m.powi(3) * f64::from(p.flow.melt_kg_m3)),
                json!(found.fastest_m_s),
                json!(found.mean_m_s),
                json!(100.0 * (found.densest - 1.0)),
                json!(100.0 * found.denser),
                json!(found.energy_j_kg),
                json!(found.mean_k),
                json!(seen.front_m),
                json!(seen.highest_m),
            ]);
            keep(rows)?;
        }
        (watch.progress)(u64::from(frame), u64::from(frames));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::lava::{Flow, Vent};

    fn laws() -> (Laws, State) {
        laws_of(&Parameters::default())
    }

    fn laws_of(p: &Parameters) -> (Laws, State) {
        let places = vec![DVec3::new(0.5, 0.4, 0.5), DVec3::new(0.6, 0.1, 0.5)];
        let state = State { velocities: vec![DVec3::ZERO; 2], kelvin: vec![1423.0, 1400.0], places };
        (Laws::of(p, &Bed::level(), &state.places), state)
    }

    /// Each law, by a state that breaks it alone.
    #[test]
    fn every_law_is_one_that_can_be_broken() {
        let (laws, state) = laws();
        let of = |state: &State| laws.found(&Bed::level(), state, &[1.0, 1.1]);
        let found = of(&state).unwrap();
        assert_eq!(laws.hold(&found, &found), Ok(()));
        assert!((found.denser - 0.05).abs() < 1e-9 && (found.mean_k - 1411.5).abs() < 1e-9, "{found:?}");
        let broken = |change: &dyn Fn(&mut State)| {
            let mut other = State {
                places: state.places.clone(),
                velocities: state.velocities.clone(),
                kelvin: state.kelvin.clone(),
            };
            change(&mut other);
            of(&other).unwrap_err()
        };
        assert!(broken(&|state| state.velocities[1].x = f64::NAN).contains("nowhere"));
        assert!(broken(&|state| state.places[1].y = -0.01).contains("under its bed"));
        assert!(broken(&|state| state.kelvin[0] = 1424.0).contains("1424"));
        let held = |now: Found| laws.hold(&found, &now).unwrap_err();
        assert!(held(Found { fastest_m_s: laws.fastest_m_s + 0.1, ..found }).contains("m/s"));
        assert!(held(Found { densest: 2.1, ..found }).contains("dense"));
        assert!(held(Found { energy_j_kg: found.energy_j_kg * 1.01, ..found }).contains("J/kg"));
        assert!(held(Found { mean_k: 1412.0, ..found }).contains("temperature"));
        assert_eq!(counted(&[[5, 1], [7, 0]]), Ok(()));
        assert!(counted(&[[5, 1], [7, 1]]).is_err() && counted(&[[5, 2], [7, 1]]).is_err());
    }

    /// Lava that comes out is hot, lifts what is there and pushes it aside; it is as dense, as cold and as hot as other lava may be.
    #[test]
    fn what_comes_out_of_a_vent_heats_lifts_and_pushes() {
        let vent = Vent { effusion_m3_s: 0.01, ..Vent::default() };
        let p = Parameters { flow: Flow { vent, ..Flow::default() }, ..Parameters::default() };
        let ((block, state), (mut laws, _)) = (laws(), laws_of(&p));
        let found = block.found(&Bed::level(), &state, &[1.0, 1.1]).unwrap();
        let hotter = Found { mean_k: found.mean_k + 1.0, ..found };
        assert!(block.hold(&found, &hotter).is_err());
        assert_eq!(laws.hold(&found, &hotter), Ok(()));
        let pushed = Found { fastest_m_s: block.fastest_m_s + 0.9 * laws.pushed_m_s, ..found };
        assert!(block.hold(&found, &pushed).is_err() && laws.pushed_m_s > 0.1);
        assert_eq!(laws.hold(&found, &pushed), Ok(()));
        let falling = Found { fastest_m_s: 1.5 * block.fastest_m_s + laws.pushed_m_s, ..found };
        assert!(laws.hold(&found, &falling).is_err());
        laws.lift(&Found { highest_j_kg: 4.0 * found.highest_j_kg, ..found });
        assert_eq!(laws.hold(&found, &falling), Ok(()));
        assert!(laws.hold(&found, &Found { densest: 2.1, ..found }).is_err());
    }
}
