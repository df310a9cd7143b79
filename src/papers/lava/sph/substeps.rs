//! Steps of the fluid in the time of a frame.
//!
//! Corrections push lava apart as a spring would: n of them in a step of dt give it a speed of sound c, c^2 = n h^2 / dt^2 but for a factor, and
//! under its own weight lava of depth D is pressed together by g D / c^2. Finer particles have a smaller h; shorter steps make up for it at less
//! cost than more corrections do, since n counts once and dt twice (Macklin et al. 2019).

use super::super::parameters::Parameters;
use super::parameters::Sides;

/// Most steps of a frame.
pub const MOST: u32 = 100;
/// Most of g D dt^2 / (n h^2): a block that is let go is pressed together by three times as much at its foot.
const MOST_PRESSED: f64 = 1.0 / 24.0;
/// Most of the kernel's radius that gravity alone moves lava in a step.
const MOST_FALLEN: f64 = 0.5;

/// Steps that lava of these parameters needs, with a kernel of that radius in metres; they may be more than [`MOST`].
pub fn needed(parameters: &Parameters, support_m: f64) -> f64 {
    let flow = &parameters.flow;
    let step_s = f64::from(parameters.time_step_s);
    let fallen_m = step_s * step_s * f64::from(flow.gravity_m_s2);
    let pressed = fallen_m * depth_m(parameters) / (f64::from(flow.corrections) * support_m * support_m);
    let squared = (pressed / MOST_PRESSED).max(fallen_m / (MOST_FALLEN * support_m));
    squared.sqrt().ceil().max(1.0)
}

/// Steps of a frame: those given, or those that are needed.
pub fn of(parameters: &Parameters, support_m: f64) -> u32 {
    parameters.flow.substeps.unwrap_or_else(|| needed(parameters, support_m).min(f64::from(MOST)) as u32)
}

/// Depth of the lava along gravity: of the block as it stands there, between walls at least its height; of what comes out of a vent the height of
/// the room above that, of all of it were it level, or, between walls, of all of it in the end that the floor falls to.
fn depth_m(parameters: &Parameters) -> f64 {
    let flow = &parameters.flow;
    let [x, y, z] = flow.block_m.as_dvec3().to_array();
    // A bed has no slope of its own by default; it has hills.
    let (sine, cosine) = f64::from(flow.slope_deg(true)).to_radians().sin_cos();
    if flow.vent.effusion_m3_s > 0.0 {
        let space_m = parameters.space_m.as_dvec3();
        let level_m = x * y * z / (space_m.x * space_m.z);
        let pooled_m = match flow.sides {
            Sides::Walls => pooled_m(x * y * z / space_m.z, space_m.x, [sine, cosine]),
            Sides::Periodic => 0.0,
        };
        return f64::from(flow.vent.radius_m).max(level_m).max(pooled_m);
    }
    match flow.sides {
        // On a bed without a slope it stands as deep as it is high.
        Sides::Walls => (x * sine + y * cosine).max(y),
        Sides::Periodic => y * cosine,
    }
}

/// Depth of so many square metres between a floor that is so long, slopes by the angle of this sine and cosine, and ends at a wall that stands on
/// it: of a triangle with a right angle, sqrt(2 A / (cot a + tan a)), until it covers all of the floor.
fn pooled_m(area_m2: f64, floor_m: f64, [sine, cosine]: [f64; 2]) -> f64 {
    let wedge_m = (2.0 * area_m2 * sine * cosine).sqrt();
    if wedge_m < floor_m * sine { wedge_m } else { area_m2 / floor_m * cosine + 0.5 * floor_m * sine }
}

#[cfg(test)]
mod tests {
    use super::super::Scale;
    use super::*;
    use crate::papers::lava::{Flow, Simulation, Vent};

    /// As many as the root of what the column presses: finer particles, a longer step, fewer corrections.
    #[test]
    fn finer_particles_need_shorter_steps() {
        let of = |particles: u32, change: &dyn Fn(&mut Parameters)| {
            let mut parameters = Parameters { simulation: Simulation::Sph, particles, ..Parameters::default() };
            change(&mut parameters);
            Scale::of(&parameters).substeps
        };
        let as_is = |particles| of(particles, &|_| ());
        assert_eq!([400, 4000, 40_000, 400_000].map(as_is), [1, 1, 3, 5]);
        assert_eq!(of(4000, &|p| p.time_step_s *= 4.0), 4);
        assert_eq!(of(4000, &|p| p.flow = Flow { corrections: 1, ..Flow::default() }), 4);
        assert_eq!(of(4000, &|p| p.flow = Flow { gravity_m_s2: 0.0, ..Flow::default() }), 1);
        assert_eq!(of(40_000, &|p| p.flow = Flow { substeps: Some(2), ..Flow::default() }), 2);
        let step_s = |particles| {
            Scale::of(&Parameters { simulation: Simulation::Sph, particles, ..Parameters::default() }).step_s
        };
        assert!((step_s(40_000) - 1.0 / 90.0).abs() < 1e-9);
    }

    /// A square metre on 45 degrees is a triangle whose legs are a root of 2 long; twice the floor's triangle is a trapezium.
    #[test]
    fn lava_pools_where_the_floor_meets_the_end() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((pooled_m(1.0, 4.0, [half, half]) - 1.0).abs() < 1e-12);
        assert!((pooled_m(1.0, 1.0, [half, half]) - 1.5 * half).abs() < 1e-12);
        assert!((pooled_m(2.0, 4.0, [0.0, 1.0]) - 0.5).abs() < 1e-12);
        let of = |change: &dyn Fn(&mut Parameters)| {
            let vent = Vent { effusion_m3_s: 0.02, ..Vent::default() };
            let flow = Flow { vent, ..Flow::default() };
            let mut parameters =
                Parameters { simulation: Simulation::Sph, particles: 400_000, flow, ..Parameters::default() };
            change(&mut parameters);
            (depth_m(&parameters), Scale::of(&parameters).substeps)
        };
        // 0.72 cubic metres: 0.18 metres deep were they level, 0.5 in the wedge.
        let (deep_m, steps) = of(&|_| ());
        assert!((deep_m - (1.44 * 10f64.to_radians().sin() * 10f64.to_radians().cos()).sqrt()).abs() < 1e-6);
        let (level_m, fewer) = of(&|p| p.flow.slope_deg = Some(0.0));
        assert!((level_m - 0.18).abs() < 1e-6 && fewer < steps, "{level_m} {fewer} {steps}");
        // On a bed, which has no slope but hills, a block is as deep as it is high.
        let (tall_m, _) = of(&|p| p.flow = Flow { block_m: glam::Vec3::new(0.01, 0.9, 1.0), ..Flow::default() });
        assert!((tall_m - 0.9).abs() < 1e-6, "{tall_m}");
    }
}
