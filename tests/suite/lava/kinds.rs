//! Chapter 3's kinds, told apart by what one who studies flows measures.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::measure::study::Study;
use fumarole::papers::lava::setup::Setup;
use fumarole::papers::lava::{Parameters, Particles};
use glam::DVec2;

use super::fluid::{animate, list, run, state};
use crate::common::gpu_test;

/// Of a flow after two seconds.
struct Measured {
    /// Its front from the vent or the corner in which its block stood, metres.
    front: f64,
    /// Way of its front in the last one, metres.
    advance: f64,
    /// Volume over covered area, metres.
    thickness: f64,
    /// Mean of the particles that radiate over that of their eruption, kelvin.
    chilled: f64,
}

/// With a few particles.
fn measured(device: &Arc<Device>, name: &str) -> Measured {
    let preset = Setup::presets().into_iter().find(|preset| preset.name == name).unwrap();
    let parameters = Parameters { particles: 900, ..(preset.setup)().parameters };
    let spacing = parameters.flow.spacing_m(900);
    assert!((preset.setup)().bed.is_none());
    let mut animate = animate(device, &parameters, &Particles::of(&parameters));
    let vent = parameters.flow.vent;
    let from = if vent.effusion_m3_s > 0.0 { DVec2::from(vent.middle_m.map(f64::from)) } else { DVec2::ZERO };
    let steps = (1.0 / parameters.time_step_s).round() as u32;
    let mut fronts = Vec::new();
    let mut squares = Vec::new();
    for _ in 0..2 {
        run(device, &mut animate, steps);
        let (places, _) = state(device, &animate, animate.out() as usize);
        let across = |place: &glam::DVec3| DVec2::new(place.x, place.z);
        fronts.push(places.iter().map(|place| across(place).distance(from)).fold(0.0, f64::max));
        squares = places.iter().map(|place| (across(place) / (1.5 * spacing)).floor().as_ivec2().to_array()).collect();
    }
    squares.sort_unstable();
    squares.dedup();
    let heat: Vec<[f32; 2]> = list(device, &animate.sph().unwrap().heat);
    let skin = heat.iter().take(animate.out() as usize).filter(|heat| heat[1] > 0.0);
    let (count, sum) = skin.fold((0.0, 0.0), |(count, sum), heat| (count + 1.0, sum + f64::from(heat[0])));
    Measured {
        front: fronts[1],
        advance: fronts[1] - fronts[0],
        thickness: f64::from(animate.out()) * spacing.powi(3) / (squares.len() as f64 * (1.5 * spacing).powi(2)),
        chilled: sum / count - f64::from(parameters.flow.heat.melt_k),
    }
}

/// Pahoehoe is thin, its toes creep; aa is thicker and yet faster; all of them chill at the surface.
#[test]
fn kinds_flow_as_chapter_3_tells() {
    gpu_test(|device| {
        let [pahoehoe, ropy, toes, aa] = ["pahoehoe", "ropy", "toes", "aa"].map(|name| {
            let found = measured(device, name);
            println!(
                "{name}: {} m far, {} m/s, {} m thick, {} K",
                found.front, found.advance, found.thickness, found.chilled
            );
            assert!(found.chilled < -5.0, "{name}: {}", found.chilled);
            found
        });
        assert!(pahoehoe.thickness < 0.2 && ropy.thickness < 0.2 && toes.thickness < pahoehoe.thickness);
        assert!(aa.thickness > 3.0 * pahoehoe.thickness && aa.advance > 2.0 * pahoehoe.advance);
        // Toes advance in leaps, each where the skin breaks.
        assert!(toes.front < 0.6 * pahoehoe.front && toes.front > 0.07);
    });
}
