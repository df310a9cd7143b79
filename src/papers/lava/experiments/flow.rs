//! Measurements of one who studies lava flows, over time: effusion, front, area, thickness, temperatures.

use glam::{DVec2, DVec3, Vec3};
use serde_json::{Value, json};

use super::super::animate::Animate;
use super::super::setup::Setup;
use super::super::sph::Scale;
use crate::gpu::Mode;
use crate::gpu::transfer::read_image;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study as _;
use crate::papers::lava::{Bed, Simulation};

/// Frames without `frames`: ten seconds of the default step.
pub const FRAMES: u32 = 300;
/// Rows of the table, at most, beside that of the first step.
const ROWS: u32 = 60;
/// Side of the squares whose cover is counted, in distances of particles at rest: none of them is without a particle where
/// lava lies in a lattice.
const SQUARE: f64 = 1.5;

/// Columns that the plots show, of lengths and of temperatures.
pub const LENGTHS: [&str; 3] = ["front m", "thickness m", "greatest thickness m"];
/// Likewise.
pub const TEMPERATURES: [&str; 3] = ["mean K", "greatest K", "skin K"];

/// The particles that are out, by their numbers.
pub(super) struct State {
    /// Metres.
    pub(super) places: Vec<DVec3>,
    /// Metres per second.
    pub(super) velocities: Vec<DVec3>,
    /// Temperatures.
    pub(super) kelvin: Vec<f64>,
}

/// Those of the last step.
pub(super) fn state(machine: &Machine, animate: &Animate) -> Result<State, Error> {
    let read = |view| -> Result<Vec<[f32; 4]>, Error> {
        let mut texels = bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&read_image(&machine.device, view)?);
        texels.truncate(animate.out() as usize);
        Ok(texels)
    };
    let vectors = |texels: &[[f32; 4]]| texels.iter().map(|&[x, y, z, _]| Vec3::new(x, y, z).as_dvec3()).collect();
    let (positions, velocities) = (read(&animate.state().positions)?, read(&animate.state().velocities)?);
    Ok(State {
        places: vectors(&positions),
        kelvin: velocities.iter().map(|texel| f64::from(texel[3])).collect(),
        velocities: vectors(&velocities),
    })
}

/// Extent and heat of the lava.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Observed {
    /// Along x.
    pub(super) front_m: f64,
    area_m2: f64,
    /// Over the space's floor.
    pub(super) highest_m: f64,
    mean_k: f64,
    greatest_k: f64,
}

/// Of these particles, metres and kelvin, over a bed; at least one. The front is as far along x as a particle is, or from the
/// middle of a vent.
pub(super) fn observed(
    space_m: Vec3,
    spacing_m: f64,
    (bed, vent_m): (&Bed, Option<DVec2>),
    places: &[DVec3],
    kelvin: &[f64],
) -> Observed {
    let sides = [space_m.x, space_m.z].map(f64::from);
    let counts = sides.map(|side| (side / (SQUARE * spacing_m)).round().max(1.0));
    let square = |place: &DVec3| {
        let along = |at: f64, axis: usize| (at / sides[axis] * counts[axis]).clamp(0.0, counts[axis] - 1.0) as usize;
        along(place.z, 1) * counts[0] as usize + along(place.x, 0)
    };
    let mut squares: Vec<usize> = places.iter().map(square).collect();
    squares.sort_unstable();
    squares.dedup();
    // A particle reaches half a distance beyond its middle.
    let reach = |of: &dyn Fn(&DVec3) -> f64| places.iter().map(of).fold(0.0, f64::max) + 0.5 * spacing_m;
    let front = |place: &DVec3| vent_m.map_or(place.x, |vent_m| vent_m.distance(DVec2::new(place.x, place.z)));
    Observed {
        front_m: reach(&front),
        area_m2: squares.len() as f64 * sides[0] * sides[1] / (counts[0] * counts[1]),
        highest_m: reach(&|place| place.y - bed.at(DVec2::new(place.x, place.z)).z),
        mean_k: kelvin.iter().sum::<f64>() / kelvin.len() as f64,
        greatest_k: kelvin.iter().copied().fold(0.0, f64::max),
    }
}

/// Only a fluid flows.
///
/// # Errors
/// [`Error::Input`] for particles that are none.
pub fn check(setup: &Setup) -> Result<(), Error> {
    match setup.parameters.simulation {
        Simulation::Sph => Ok(()),
        Simulation::Free => {
            Err(Error::Input("`simulation` free: what is observed is a fluid; give `simulation` sph".to_owned()))
        }
    }
}

/// Rows over so many frames of a fluid.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Parameter`].
pub fn table(machine: &mut Machine, setup: &Setup, frames: u32) -> Result<ResultTable, Error> {
    let p = &setup.parameters;
    let scene = setup.load()?;
    let scale = Scale::of(p);
    let mut animate = Animate::new(&machine.shaders, "flow", p, &scene.particles)?;
    let particle_m3 = scale.spacing_m.powi(3);
    let vent = p.flow.vent;
    let vent_m = (vent.effusion_m3_s > 0.0).then(|| DVec2::from(vent.middle_m.map(f64::from)));
    let mut rows: Vec<Vec<Value>> = Vec::new();
    let mut before = (0.0, 0.0);
    for row in 0..=ROWS.min(frames - 1) {
        let wanted = 1 + (u64::from(frames - 1) * u64::from(row) / u64::from(ROWS.min(frames - 1).max(1))) as u32;
        while animate.steps() < wanted {
            machine.recorder.run(Mode::Plain, |frame| animate.record(frame))?;
        }
        let Some(sph) = animate.sph() else { break };
        sph.check(&machine.device)?;
        let out = animate.out() as usize;
        let State { places, kelvin, .. } = state(machine, &animate)?;
        let seen = observed(p.space_m, scale.spacing_m, (&scene.particles.bed, vent_m), &places, &kelvin);
        let skin_k = sph.skin_k(&machine.device, out)?;
        let (time_s, volume_m3) = (f64::from(wanted) * f64::from(p.time_step_s), out as f64 * particle_m3);
        // What stands there at the start has not come out.
        let came_m3 = if p.flow.vent.effusion_m3_s > 0.0 { volume_m3 } else { 0.0 };
        rows.push(vec![
            json!(time_s),
            json!(out),
            json!(volume_m3),
            json!((came_m3 - before.1) / (time_s - before.0)),
            json!(seen.front_m),
            json!(seen.area_m2),
            json!(volume_m3 / seen.area_m2),
            json!(seen.highest_m),
            json!(seen.mean_k),
            json!(seen.greatest_k),
            json!(skin_k),
        ]);
        before = (time_s, came_m3);
    }
    Ok(ResultTable {
        title: "A flow over time: what is out, how far, how thick and how hot it is",
        columns: &[
            "time s",
            "particles",
            "volume m3",
            "effusion m3/s",
            "front m",
            "area m2",
            "thickness m",
            "greatest thickness m",
            "mean K",
            "greatest K",
            "skin K",
        ],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slab of 20 x 3 x 10 particles, a tenth of a metre apart.
    #[test]
    fn a_slab_is_as_far_as_wide_and_as_thick_as_it_is() {
        let place = |n: u32| DVec3::new(f64::from(n % 20), f64::from(n / 200), f64::from(n / 20 % 10));
        let places: Vec<DVec3> = (0..600).map(|n| 0.1 * (place(n) + 0.5)).collect();
        let kelvin: Vec<f64> = (0..600).map(|n| 1000.0 + f64::from(n)).collect();
        let level = Bed::level();
        let seen = observed(Vec3::new(6.0, 1.0, 3.0), 0.1, (&level, None), &places, &kelvin);
        assert!((seen.front_m - 2.0).abs() < 1e-9 && (seen.highest_m - 0.3).abs() < 1e-9, "{seen:?}");
        // 40 x 20 squares of 0.15 m: 14 x 7 of them reach into the slab of 2 m x 1 m.
        assert!((seen.area_m2 - 14.0 * 7.0 * 0.0225).abs() < 1e-9, "{seen:?}");
        assert!((seen.mean_k - 1299.5).abs() < 1e-9 && seen.greatest_k == 1599.0, "{seen:?}");
        let seen = observed(Vec3::new(6.0, 1.0, 3.0), 0.1, (&level, Some(DVec2::new(1.95, 0.95))), &places, &kelvin);
        assert!((seen.front_m - 1.9f64.hypot(0.9) - 0.05).abs() < 1e-9, "{seen:?}");
    }
}
