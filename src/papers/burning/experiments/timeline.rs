//! A fire followed from ignition by its simulation passes alone: an experiment finds in it the frames that it measures.

use super::super::setup::Setup;
use crate::gpu::Mode;
use crate::gpu::transfer::read_buffer;
use crate::measure::Error;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::study::Study;
use crate::papers::burning::model::tree::nodes_of;
use crate::papers::burning::{Burning, Counts, Parameters, TICKS_PER_S, Variant};

/// No fire is followed for longer, in ticks.
pub const MOST_TICKS: u32 = 20_000;

/// The counts of a fire after some tick.
#[derive(Debug, Clone, Copy)]
pub struct Snapshot {
    /// Counts of the state.
    pub counts: Counts,
    /// Coarse triangles that are refined; absent where none ever are.
    pub refined: Option<u32>,
    /// Triangles before division.
    pub coarse: u32,
}

impl Snapshot {
    /// Fraction of the coarse triangles that are refined.
    pub fn refined_fraction(&self) -> f64 {
        f64::from(self.refined.unwrap_or(0)) / f64::from(self.coarse.max(1))
    }
}

/// Snapshots of a fire every `step` ticks until it has burnt out or `is_enough` of one.
///
/// # Errors
/// [`Error::Input`] for a fire that does not begin within 20,000 ticks; [`Error::Interrupted`]; what loading and the
/// Vulkan layer answer.
pub fn follow(
    machine: &mut Machine,
    setup: &Setup,
    variant: Variant,
    step: u32,
    watch: &mut Watch<'_>,
    is_enough: impl Fn(&Snapshot) -> bool,
) -> Result<Vec<Snapshot>, Error> {
    let mut paper = at_rest(machine, setup, variant)?;
    let distances = || paper.model().rest.iter().map(|r| f64::from(r.boundary_distance));
    let (nearest, farthest) = (distances().fold(f64::INFINITY, f64::min), distances().fold(0.0, f64::max));
    let p = &setup.parameters;
    let ticks_to = |radius: f64| radius / f64::from(p.speed_per_s) * TICKS_PER_S;
    if ticks_to(nearest) >= f64::from(MOST_TICKS) {
        return Err(Error::Input(format!(
            "nothing burns within {MOST_TICKS} ticks: the object begins at {nearest} of the heat boundary's radius; move \
             `source` nearer or raise `speed`"
        )));
    }
    let all_burn = farthest + 2.0 * f64::from(p.width_of_areas);
    let expected = u64::from((ticks_to(all_burn) as u32 + p.flammability).min(MOST_TICKS));
    let mut snapshots: Vec<Snapshot> = Vec::new();
    // Ticks since the last vertex began to burn: after as many as it has levels all is over.
    let mut over = 0;
    loop {
        watch.check()?;
        machine.recorder.run(Mode::Plain, |frame| (0..step).try_for_each(|_| paper.tick(frame)))?;
        let snapshot = snapshot(machine, &paper)?;
        snapshots.push(snapshot);
        let tick = snapshot.counts.tick;
        (watch.progress)(u64::from(tick), expected.max(u64::from(tick)));
        over += if f64::from(snapshot.counts.radius) > all_burn { step } else { 0 };
        if is_enough(&snapshot) || over > p.flammability || tick >= MOST_TICKS {
            return Ok(snapshots);
        }
    }
}

/// A fire that has not been lit yet.
///
/// # Errors
/// Those of loading and of the Vulkan layer.
pub fn at_rest(machine: &mut Machine, setup: &Setup, variant: Variant) -> Result<Burning, Error> {
    let parameters = Parameters { first_frame: 0, ..setup.parameters.clone() };
    let study = Setup { parameters, ..setup.clone() };
    let scene = study.load()?;
    Ok(build(machine, &study, &scene, variant)?.paper)
}

/// The radii at which the boundary reaches the vertices.
///
/// # Errors
/// Those of loading and of the Vulkan layer.
pub fn reaches(machine: &mut Machine, setup: &Setup, variant: Variant) -> Result<Vec<f64>, Error> {
    let paper = at_rest(machine, setup, variant)?;
    Ok(paper.model().rest.iter().map(|rest| f64::from(rest.boundary_distance)).collect())
}

/// The counts of the device, read back.
///
/// # Errors
/// [`Error::Gpu`].
pub fn snapshot(machine: &Machine, paper: &Burning) -> Result<Snapshot, Error> {
    /// Status of a triangle that its four children stand for.
    const SPLIT: i32 = -1;
    let model = paper.model();
    let refined = match paper.refinement() {
        None => None,
        Some(refinement) => {
            let bytes = read_buffer(&machine.device, &refinement.statuses)?;
            let statuses: Vec<i32> = bytemuck::pod_collect_to_vec(&bytes);
            let roots = statuses.iter().step_by(nodes_of(model.levels) as usize);
            Some(roots.filter(|&&status| status == SPLIT).count() as u32)
        }
    };
    Ok(Snapshot { counts: paper.counts()?, refined, coarse: model.coarse_count() })
}

/// The snapshot of most live particles, of several the one of most active triangles, of those the first.
fn busiest(snapshots: &[Snapshot]) -> Option<&Snapshot> {
    let load = |snapshot: &Snapshot| {
        (snapshot.counts.fire_particles + snapshot.counts.smoke_particles, snapshot.counts.active_triangles)
    };
    snapshots.iter().rev().max_by_key(|snapshot| load(snapshot))
}

/// The tick of [`busiest`].
///
/// # Errors
/// [`Error::Input`] without a snapshot of the fire.
pub fn busiest_tick(snapshots: &[Snapshot]) -> Result<u32, Error> {
    let snapshot = busiest(snapshots).ok_or_else(|| Error::Input("no tick of the fire was seen".to_owned()))?;
    Ok(snapshot.counts.tick)
}

/// The frame of `parameters` before the one that shows `tick`.
pub fn frame_before(parameters: &Parameters, tick: u32) -> u32 {
    let slices = f64::from(tick) * f64::from(parameters.time_division);
    let frame = slices / (parameters.time_step_s * TICKS_PER_S);
    (frame.round() as u32).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(tick: u32, fire_particles: u32, active_triangles: u32) -> Snapshot {
        let counts = Counts { tick, fire_particles, active_triangles, ..Counts::default() };
        Snapshot { counts, refined: None, coarse: 0 }
    }

    #[test]
    fn the_busiest_snapshot_has_most_particles_then_most_active_triangles_then_comes_first() {
        let snapshots = [at(1, 3, 9), at(2, 5, 1), at(3, 5, 2), at(4, 5, 2), at(5, 4, 8)];
        assert_eq!(busiest(&snapshots).unwrap().counts.tick, 3);
        assert!(busiest(&[]).is_none());
    }

    #[test]
    fn the_frame_after_the_one_before_a_tick_ends_with_it() {
        for (time_division, frames_a_tick) in [(1, 1.0), (4, 1.0), (1, 3.0)] {
            let time_step_s = 1.0 / (TICKS_PER_S * frames_a_tick);
            let parameters = Parameters { time_division, time_step_s, ..Parameters::default() };
            let first_frame = frame_before(&parameters, 30);
            let shown = Parameters { first_frame, ..parameters }.slices_due(0) / u64::from(time_division);
            assert_eq!(shown, 30, "{time_division} {frames_a_tick}");
        }
    }
}
