//! Chapter 3's kinds of lava as presets: small flows of basalt out of a vent. Viscosities are those of Giordano and Dingwell's fit (2003) at
//! the temperature of eruption; heat is faster than rock's, so that minutes of cooling pass in seconds. The crust's relief, colder and finer than the
//! particles, is drawn over them.

use glam::Vec3;

use super::parameters::{Parameters, SurfaceKind};
use super::sph::crust::Crust;
use super::sph::heat::{Heat, Rheology};
use super::sph::parameters::{Flow, Simulation};
use super::sph::vent::Vent;
use crate::scene::Camera;

/// The fluid's own surface in black bodies' colours at dusk, from a camera.
fn basalt(eye: Vec3, target: Vec3, exposure: f32, flow: Flow) -> Parameters {
    Parameters {
        simulation: Simulation::Sph,
        surface: SurfaceKind::Crossing,
        border_m: 0.0,
        is_blackbody: true,
        daylight: 0.6,
        camera: Camera { eye, target, ..Parameters::default().camera },
        exposure,
        flow,
        ..Parameters::default()
    }
}

fn heat(melt_k: f32, capacity_j_kgk: f32, conductivity_w_mk: f32, [crust_pa_s, crust_w_mk]: [f32; 2]) -> Heat {
    let rheology = Rheology::Basalt;
    Heat { melt_k, capacity_j_kgk, conductivity_w_mk, rheology, crust_pa_s, crust_w_mk, ..Heat::default() }
}

/// Section 3.2: 1,150 degrees Celsius, very fluid, a sheet a hand thick that chills after a metre or two.
pub fn pahoehoe() -> Parameters {
    let flow = Flow {
        block_m: Vec3::new(1.0, 0.3, 1.0),
        viscosity_pa_s: 122.0,
        slope_deg: Some(10.0),
        renewal_s: 6.0,
        heat: heat(1423.0, 12.0, 20.0, [1000.0, 12.0]),
        crust: Crust { pieces: 1.5, ..Crust::default() },
        vent: Vent { effusion_m3_s: 0.04, middle_m: [0.4, 0.8], radius_m: 0.2, ..Vent::default() },
        ..Flow::default()
    };
    Parameters {
        space_m: Vec3::new(3.2, 0.5, 1.6),
        particles: 4000,
        radius_m: 0.09,
        density: [96, 24, 48],
        splats: [320, 160],
        splat_radius_m: 0.02,
        rock_tile_m: 0.8,
        gloss: 0.3,
        ..basalt(Vec3::new(2.5, 0.8, 2.0), Vec3::new(1.0, 0.05, 0.8), 4.0, flow)
    }
}

/// Section 3.2: the same lava under a skin that stiffens, slowed as it spreads.
pub fn ropy() -> Parameters {
    let flow = Flow {
        block_m: Vec3::new(1.0, 0.09, 1.0),
        viscosity_pa_s: 122.0,
        slope_deg: Some(12.0),
        renewal_s: 6.0,
        heat: heat(1423.0, 12.0, 6.0, [2500.0, 4.0]),
        crust: Crust { skin_m: 0.006, ..Crust::default() },
        vent: Vent { effusion_m3_s: 0.011, middle_m: [0.4, 0.55], radius_m: 0.13, ..Vent::default() },
        ..Flow::default()
    };
    Parameters {
        space_m: Vec3::new(1.5, 0.35, 1.1),
        particles: 4000,
        radius_m: 0.06,
        density: [100, 24, 72],
        splats: [240, 180],
        splat_radius_m: 0.01,
        rock_tile_m: 0.25,
        gloss: 0.3,
        ..basalt(Vec3::new(1.58, 0.6, 1.08), Vec3::new(0.62, 0.0, 0.5), 6.0, flow)
    }
}

/// Section 3.2: lava of 1,100 degrees Celsius, slow, that breaks out of its skin as toe after toe.
pub fn toes() -> Parameters {
    let flow = Flow {
        block_m: Vec3::new(0.3, 0.2, 0.45),
        viscosity_pa_s: 317.0,
        slope_deg: Some(5.0),
        renewal_s: 20.0,
        heat: heat(1373.0, 12.0, 10.0, [2200.0, 8.0]),
        vent: Vent { effusion_m3_s: 0.002, middle_m: [0.3, 0.6], radius_m: 0.07, toe_m3: 0.003 },
        ..Flow::default()
    };
    Parameters {
        space_m: Vec3::new(1.6, 0.3, 1.2),
        particles: 3000,
        radius_m: 0.055,
        density: [96, 18, 72],
        splats: [270, 210],
        splat_radius_m: 0.012,
        rock_tile_m: 0.5,
        time_step_s: 1.0 / 20.0,
        gloss: 0.3,
        ..basalt(Vec3::new(1.5, 0.7, 1.2), Vec3::new(0.6, 0.0, 0.58), 6.0, flow)
    }
}

/// Section 3.3: 1,050 degrees Celsius, more viscous, metres thick and yet faster.
pub fn aa() -> Parameters {
    let flow = Flow {
        block_m: Vec3::new(3.0, 1.5, 2.0),
        viscosity_pa_s: 941.0,
        slope_deg: Some(18.0),
        renewal_s: 6.0,
        heat: heat(1323.0, 6.0, 60.0, [9000.0, 1.5]),
        crust: Crust { pieces: 1.5, jumble: 0.8, healing_s: 1.5, ..Crust::default() },
        vent: Vent { effusion_m3_s: 1.4, middle_m: [1.2, 3.0], radius_m: 0.7, ..Vent::default() },
        ..Flow::default()
    };
    Parameters {
        space_m: Vec3::new(11.0, 2.5, 6.0),
        particles: 5000,
        radius_m: 0.19,
        density: [120, 48, 66],
        splats: [330, 180],
        splat_radius_m: 0.06,
        rock_tile_m: 1.0,
        ..basalt(Vec3::new(7.2, 2.0, 5.6), Vec3::new(2.9, 0.25, 2.9), 6.0, flow)
    }
}
