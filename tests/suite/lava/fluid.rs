//! The viscous fluid against its oracle, and its laws.

use std::sync::Arc;

use bytemuck::Pod;
use fumarole::gpu::transfer::read_buffer;
use fumarole::gpu::{Buffer, Device, ImageView, Mode, Recorder, Track};
use fumarole::measure::Paper;
use fumarole::papers::lava::reference::Fluid;
use fumarole::papers::lava::sph::Scale;
use fumarole::papers::lava::{
    Animate, Flow, Lava, Parameters, Particles, Rock, Sides, Simulation, State, SurfaceDraw, Variant,
};
use fumarole::scene::Camera;
use glam::{DVec3, Vec3};

use super::scene::{draw, parameters, shaders, texels, variant_of};
use super::splatting::{low_camera, ridge, stage};
use crate::common::gpu_test;

/// 600 particles in a corner of the small space.
pub(super) fn flowing() -> Parameters {
    Parameters {
        simulation: Simulation::Sph,
        particles: 600,
        flow: Flow { block_m: Vec3::new(0.6, 0.5, 0.5), ..Flow::default() },
        ..parameters()
    }
}

pub(super) fn oracle(parameters: &Parameters) -> Fluid {
    let Scale { spacing_m, support_m, margin_m, step_s, .. } = Scale::of(parameters);
    Fluid {
        space: parameters.space_m.as_dvec3(),
        bed: Box::new(|_| DVec3::ZERO),
        spacing: spacing_m,
        support: support_m,
        step: step_s,
        kinematic: f64::from(parameters.flow.viscosity_pa_s) / f64::from(parameters.flow.melt_kg_m3),
        margin: margin_m,
        is_periodic: parameters.flow.sides == Sides::Periodic,
    }
}

pub(super) fn animate(device: &Arc<Device>, parameters: &Parameters, particles: &Particles) -> Animate {
    parameters.validate().unwrap();
    Animate::new(&shaders(device), "test", parameters, particles).unwrap()
}

/// So many steps, each a frame of its own.
pub(super) fn run(device: &Arc<Device>, animate: &mut Animate, steps: u32) {
    let mut recorder = Recorder::new(device).unwrap();
    for _ in 0..steps {
        recorder.run(Mode::Plain, |frame| animate.record(frame)).unwrap();
    }
    animate.sph().unwrap().check(device).unwrap();
}

/// Places and velocities of all particles after the last step.
pub(super) fn state(device: &Arc<Device>, animate: &Animate, count: usize) -> (Vec<DVec3>, Vec<DVec3>) {
    let State { positions, velocities } = animate.state();
    (by_cells(device, positions, count), by_cells(device, velocities, count))
}

pub(super) fn list<T: Pod>(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Vec<T> {
    bytemuck::pod_collect_to_vec(&read_buffer(device, buffer).unwrap())
}

pub(super) fn vectors(device: &Arc<Device>, buffer: &Arc<Buffer>) -> Vec<DVec3> {
    list::<[f32; 4]>(device, buffer).iter().map(|&[x, y, z, _]| Vec3::new(x, y, z).as_dvec3()).collect()
}

/// Of a texture by cells.
pub(super) fn by_cells(device: &Arc<Device>, view: &Arc<ImageView>, count: usize) -> Vec<DVec3> {
    let texels: Vec<[f32; 4]> = texels(device, view);
    texels.iter().take(count).map(|&[x, y, z, _]| Vec3::new(x, y, z).as_dvec3()).collect()
}

/// After some steps in which the block falls apart: each pass of the last step against the oracle's equation for it.
#[test]
fn every_pass_does_what_its_equation_says() {
    gpu_test(|device| {
        // So few corrections that something is too dense before the last.
        let walled = Parameters { flow: Flow { corrections: 2, ..flowing().flow }, ..flowing() };
        let periodic = Parameters {
            space_m: Vec3::new(0.75, 1.0, 0.7),
            flow: Flow {
                sides: Sides::Periodic,
                block_m: Vec3::new(0.75, 0.3, 0.6),
                corrections: 2,
                ..Flow::default()
            },
            ..flowing()
        };
        let stiff = Parameters {
            flow: Flow { viscosity_pa_s: 3000.0, corrections: 2, ..walled.flow.clone() },
            ..walled.clone()
        };
        for parameters in [walled, periodic, stiff] {
            let (particles, oracle) = (Particles::of(&parameters), oracle(&parameters));
            hold_passes(device, &parameters, &particles, &oracle);
        }
    });
}

/// Each pass of the seventh step against the oracle's equation for it.
pub(super) fn hold_passes(device: &Arc<Device>, parameters: &Parameters, particles: &Particles, oracle: &Fluid) {
    let mut animate = animate(device, parameters, particles);
    run(device, &mut animate, 7);
    let sph = animate.sph().unwrap();
    let began = by_cells(device, &sph.sort.places, parameters.particles as usize);
    // Viscosity: a thousandth of the first guess's residual is left.
    let before = vectors(device, &sph.pushed);
    let after = by_cells(device, &sph.velocities[sph.iterations() % 2], began.len());
    let even = vec![1.0; began.len()];
    let left = |velocities: &[DVec3]| {
        let all = 0..began.len();
        all.map(|i| oracle.viscous_residual(&began, &even, [&before, velocities], i).length_squared())
            .sum::<f64>()
            .sqrt()
    };
    let (first, last) = (left(&before), left(&after));
    println!("viscosity: {first} {last} after {}", sph.iterations());
    assert!(last < 2e-3 * first + 1e-4, "{first} {last}");

    // Density and constraint at the places before the last correction, and that correction.
    let odd = parameters.flow.corrections as usize % 2;
    let places = by_cells(device, &sph.predicted[1 - odd], began.len());
    let corrected = by_cells(device, &sph.predicted[odd], began.len());
    let factors: Vec<[f32; 2]> = list(device, &sph.factors);
    let support = oracle.support;
    let expected: Vec<_> = (0..places.len()).map(|i| oracle.constraint(&places, i, 0.7)).collect();
    let lambdas: Vec<_> = expected.iter().map(|(_, lambda)| *lambda).collect();
    let (mut off_density, mut off_factor, mut off_place, mut moved) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    for i in 0..places.len() {
        off_density = off_density.max((f64::from(factors[i][1]) - expected[i].0).abs());
        off_factor = off_factor.max((f64::from(factors[i][0]) - lambdas[i] / (support * support)).abs());
        let place = oracle.corrected(&places, &lambdas, i);
        off_place = off_place.max((corrected[i] - place).length());
        moved = moved.max((place - places[i]).length());
    }
    println!("density {off_density}, factor {off_factor}, place {off_place} of {moved}");
    assert!(off_density < 1e-4 && off_factor < 1e-4 && off_place < 1e-5, "{off_density} {off_factor} {off_place}");
    assert!(moved > 10.0 * off_place && lambdas.iter().any(|l| *l < 0.0), "{moved}");
}

/// Lava that touches nothing keeps its momentum, whatever its particles do to each other.
#[test]
fn a_free_blob_keeps_its_momentum_and_its_particles() {
    gpu_test(|device| {
        let parameters = Parameters {
            space_m: Vec3::splat(3.0),
            flow: Flow { gravity_m_s2: 0.0, viscosity_pa_s: 50.0, ..flowing().flow },
            ..flowing()
        };
        let mut particles = Particles::of(&parameters);
        for (i, (place, velocity)) in particles.positions.iter_mut().zip(&mut particles.velocities).enumerate() {
            *place += 1.2;
            // It is squeezed along x, and turns.
            let aside = *place - Vec3::new(1.5, 1.45, 1.45);
            *velocity = Vec3::new(0.3 - aside.x + aside.z, 0.05 * (i % 3) as f32, -aside.x);
        }
        let sum = |list: &[DVec3]| list.iter().sum::<DVec3>() / list.len() as f64;
        let start: Vec<_> = particles.velocities.iter().map(|v| v.as_dvec3()).collect();
        let mut animate = animate(device, &parameters, &particles);
        run(device, &mut animate, 20);
        let (places, velocities) = state(device, &animate, 600);
        let reach = Scale::of(&parameters).support_m;
        let is_free = |p: &DVec3| {
            p.cmpgt(DVec3::splat(reach)).all() && (parameters.space_m.as_dvec3() - *p).cmpgt(DVec3::splat(reach)).all()
        };
        assert!(places.iter().all(is_free), "it met no wall");
        let off = (sum(&velocities) - sum(&start)).length();
        println!("mean velocity {} is off by {off}", sum(&velocities));
        assert!(off < 2e-5, "{off}");
        let kinetic = |list: &[DVec3]| list.iter().map(|v| (*v - sum(list)).length_squared()).sum::<f64>();
        println!("kinetic energy {} of {}", kinetic(&velocities), kinetic(&start));
        assert!(kinetic(&velocities) < kinetic(&start));
        // None is lost, none is another's double.
        for (i, place) in places.iter().enumerate() {
            assert!(places[..i].iter().all(|other| other.distance(*place) > 1e-4), "{i}");
        }
    });
}

/// Steady flow down a slope, 12 particles deep: rho g h^2 sin(alpha) / (3 eta) (Nusselt 1916; Jeffreys 1925).
#[test]
fn a_film_on_a_slope_has_its_mean_speed() {
    gpu_test(|device| {
        let spacing = 0.05;
        let flow = Flow {
            block_m: spacing * Vec3::new(8.0, 12.0, 8.0),
            viscosity_pa_s: 800.0,
            slope_deg: Some(6.0),
            sides: Sides::Periodic,
            ..Flow::default()
        };
        let space_m = Vec3::new(flow.block_m.x, 1.0, flow.block_m.z);
        let parameters = Parameters { particles: 768, space_m, radius_m: 0.1, flow, ..flowing() };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        run(device, &mut animate, 110);
        let (places, velocities) = state(device, &animate, 768);
        let mean = velocities.iter().map(|v| v.x).sum::<f64>() / 768.0;
        let slope = f64::from(parameters.flow.slope_deg(true)).to_radians();
        let Flow { viscosity_pa_s, melt_kg_m3, gravity_m_s2, .. } = parameters.flow;
        let (eta, rho, g) = (f64::from(viscosity_pa_s), f64::from(melt_kg_m3), f64::from(gravity_m_s2));
        let depth = 12.0 * f64::from(spacing);
        let thickness = 2.0 * places.iter().map(|p| p.y).sum::<f64>() / 768.0;
        // Particles that have left their lattice lie closer: the film's own thickness, and its density by that.
        let rho = rho * depth / thickness;
        let expected = rho * g * thickness * thickness * slope.sin() / (3.0 * eta);
        println!("thickness {thickness} of {depth}, mean speed {mean}, expected {expected}: {:.4}", mean / expected);
        assert!((mean / expected - 1.0).abs() < 0.05, "{mean} {expected}");
        assert!((thickness / depth - 1.0).abs() < 0.08, "{thickness} {depth}");
        // What a particle moves in a step beside the film's own profile, rho g sin(alpha) (h y - y^2 / 2) / eta: corrections
        // that overshoot shake it by up to a distance of particles, and leave the means as they are.
        let steepest = rho * g * slope.sin() / eta;
        let beside = |(place, velocity): (&DVec3, &DVec3)| {
            let along = steepest * (thickness * place.y - 0.5 * place.y * place.y);
            (*velocity - DVec3::new(along, 0.0, 0.0)).length() * f64::from(parameters.time_step_s) / f64::from(spacing)
        };
        let shaken = places.iter().zip(&velocities).map(beside).fold(0.0, f64::max);
        println!("a particle moves {shaken:.3} distances a step beside the film at most");
        assert!(shaken < 0.25, "{shaken}");
    });
}

/// A block that is let go at the default step spreads, stays in its walls and comes to no great density.
#[test]
fn a_block_spreads_and_stays_whole() {
    gpu_test(|device| {
        let parameters = Parameters { particles: 2000, simulation: Simulation::Sph, ..Parameters::default() };
        let particles = Particles::of(&parameters);
        let mut animate = animate(device, &parameters, &particles);
        run(device, &mut animate, 60);
        let (places, velocities) = state(device, &animate, 2000);
        let space = parameters.space_m.as_dvec3();
        let is_inside = |p: &DVec3| p.cmpge(DVec3::ZERO).all() && p.cmple(space).all();
        assert!(places.iter().all(is_inside) && velocities.iter().all(|v| v.is_finite()));
        let front = places.iter().map(|p| p.x).fold(0.0, f64::max);
        let height = places.iter().map(|p| p.y).fold(0.0, f64::max);
        let fastest = velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        let factors: Vec<[f32; 2]> = list(device, &animate.sph().unwrap().factors);
        let densest = factors.iter().map(|f| f[1]).fold(0.0, f32::max);
        println!("front {front}, height {height}, fastest {fastest}, densest {densest}");
        assert!(front > 1.5 && height < 0.6, "{front} {height}");
        // A dam break of something without viscosity is no faster than 2 sqrt(g h).
        assert!(fastest < 4.9 && densest < 1.3, "{fastest} {densest}");
    });
}

/// In both variants, and after a restart: the same to the bit.
#[test]
fn two_runs_of_the_fluid_are_equal_to_the_bit() {
    gpu_test(|device| {
        let parameters = flowing();
        let particles = Particles::of(&parameters);
        let mut first = animate(device, &parameters, &particles);
        run(device, &mut first, 9);
        let expected = texels::<u32>(device, &first.state().positions);
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let rock = Rock::built_in();
            let mut lava = Lava::new(&shaders(device), "test", variant, &parameters, &particles, rock, &[]).unwrap();
            draw(device, &mut lava, 8);
            assert!(expected == texels::<u32>(device, &lava.animate.state().positions), "{variant:?}");
            lava.animate.restart();
            run(device, &mut lava.animate, 9);
            assert!(expected == texels::<u32>(device, &lava.animate.state().positions), "{variant:?}, again");
        }
    });
}

/// Frames before one are caught up as many at a time as fit into a submission, and a frame that does not fit is several, which give the same to
/// the bit. Both are counted in steps.
#[test]
fn late_frames_and_long_ones_are_several_submissions() {
    gpu_test(|device| {
        let flow = Flow { substeps: Some(3), corrections: 2, ..flowing().flow };
        let parameters = Parameters { flow, ..flowing() };
        let particles = Particles::of(&parameters);
        let caught_up = |most_work: Option<f64>| {
            let mut lava = variant_of(device, Variant::GpuDriven, &parameters, &particles);
            lava.animate.most_work = most_work.unwrap_or(lava.animate.most_work);
            let mut left = 0;
            let mut recorder = Recorder::new(device).unwrap();
            recorder.run(Mode::Plain, |frame| lava.advance(frame, 5, 128).map(|steps| left = steps)).unwrap();
            let frames = lava.animate.steps();
            let sample = draw(device, &mut lava, 5);
            let submissions = sample.spans.iter().filter(|span| span.track == Track::Wait).count();
            ((frames, left, submissions > 1), texels::<u32>(device, &lava.animate.state().positions))
        };
        let (found, whole) = caught_up(None);
        assert_eq!(found, (5, 0, false));
        // Less than a frame of three steps.
        let (found, parted) = caught_up(Some(1e5));
        assert_eq!(found, (1, 12, true));
        assert!(parted == whole);
    });
}

/// Of so few particles 75 steps are no work, but more passes than one command buffer is to have.
#[test]
fn a_frame_of_very_many_passes_is_several_submissions() {
    gpu_test(|device| {
        let submissions = |substeps: u32| {
            let flow = Flow { substeps: Some(substeps), corrections: 100, viscosity_pa_s: 0.0, ..flowing().flow };
            let parameters = Parameters { particles: 8, flow, ..flowing() };
            let mut animate = animate(device, &parameters, &Particles::of(&parameters));
            let mut recorder = Recorder::new(device).unwrap();
            let sample = recorder.run(Mode::Plain, |frame| animate.record(frame)).unwrap();
            sample.spans.iter().filter(|span| span.track == Track::Wait).count()
        };
        // 230 passes a step, of 16,384 in a submission.
        assert_eq!([5, 75].map(submissions), [1, 2]);
    });
}

#[test]
fn numbers_that_make_no_fluid_are_refused() {
    let good = flowing();
    assert_eq!(good.validate(), Ok(()));
    let flow = |flow: Flow| Parameters { flow, ..flowing() };
    let of = flowing().flow;
    let cases = [
        ("block", flow(Flow { block_m: Vec3::new(2.1, 0.5, 0.5), ..of.clone() })),
        ("block", flow(Flow { block_m: Vec3::new(0.0, 0.5, 0.5), ..of.clone() })),
        ("space", Parameters { particles: 8000, space_m: Vec3::splat(1000.0), ..good.clone() }),
        ("viscosity", flow(Flow { viscosity_pa_s: 1e6, ..of.clone() })),
        ("viscosity", flow(Flow { viscosity_pa_s: f32::NAN, ..of.clone() })),
        ("melt-density", flow(Flow { melt_kg_m3: 0.0, ..of.clone() })),
        ("gravity", flow(Flow { gravity_m_s2: -1.0, ..of.clone() })),
        ("slope", flow(Flow { slope_deg: Some(90.0), ..of.clone() })),
        ("corrections", flow(Flow { corrections: 0, ..of.clone() })),
        (
            "sides",
            Parameters {
                space_m: Vec3::new(0.6, 1.0, 0.4),
                radius_m: 0.1,
                ..flow(Flow { sides: Sides::Periodic, block_m: Vec3::new(0.6, 0.5, 0.4), ..of.clone() })
            },
        ),
        ("time-step", Parameters { time_step_s: 0.0, ..good.clone() }),
        ("time-step", Parameters { time_step_s: 10.0, ..good.clone() }),
        ("substeps", flow(Flow { substeps: Some(0), ..of.clone() })),
        ("substeps", Parameters { time_step_s: 1.0, ..flow(Flow { substeps: Some(4), ..of.clone() }) }),
        ("speed", Parameters { speed_m_s: 0.5, ..good.clone() }),
        (
            "viscosity",
            Parameters {
                simulation: Simulation::Free,
                flow: Flow { viscosity_pa_s: 5.0, ..Flow::default() },
                ..good.clone()
            },
        ),
    ];
    for (name, parameters) in cases {
        let error = parameters.validate().expect_err(name);
        assert_eq!(error.name, name, "{error}");
    }
}

/// Half of the space has lava: by splats and by rays the other half is bare, where the thesis's sheet lies on the floor.
#[test]
fn floor_without_lava_is_not_drawn() {
    gpu_test(|device| {
        let lit = |simulation, draw| {
            let parameters = Parameters {
                simulation,
                surface_draw: Some(draw),
                camera: Camera { eye: Vec3::new(1.0, 3.0, 0.7), target: Vec3::new(1.0, 0.0, 0.6), ..low_camera() },
                ..parameters()
            };
            let mut surface = ridge(&parameters);
            let middle = surface.heights.len() / 2;
            let (covered, bare) = surface.heights.split_at_mut(middle);
            covered.fill(0.25);
            bare.fill(0.0);
            let stage = stage(device, &parameters, &surface, Rock::built_in());
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            sums.iter().filter(|sums| sums[3] > 0.0).count() as f64
        };
        for draw in [SurfaceDraw::Splats, SurfaceDraw::March] {
            let (sheet, fluid) = (lit(Simulation::Free, draw), lit(Simulation::Sph, draw));
            assert!(sheet > 1000.0 && (0.4..0.6).contains(&(fluid / sheet)), "{draw:?}: {fluid} of {sheet} pixels");
        }
    });
}

/// Loops leave particles out where more than they take lie in one place: that is told, and not drawn.
#[test]
fn more_particles_in_one_place_than_a_loop_takes_are_refused() {
    gpu_test(|device| {
        let flow = Flow { viscosity_pa_s: 0.0, corrections: 1, ..flowing().flow };
        for (count, is_refused) in [(7_100, false), (7_300, true)] {
            let parameters = Parameters { particles: count, flow: flow.clone(), ..flowing() };
            let mut particles = Particles::of(&parameters);
            particles.positions.fill(Vec3::splat(0.3));
            let mut animate = animate(device, &parameters, &particles);
            Recorder::new(device).unwrap().run(Mode::Plain, |frame| animate.record(frame)).unwrap();
            let checked = animate.sph().unwrap().check(device).map_err(|error| error.to_string());
            assert_eq!(checked.is_err(), is_refused, "{count} particles: {checked:?}");
            if let Err(error) = checked {
                let parts = ["sph-neighbours", "`time-step`", "`particles`"];
                assert!(parts.iter().all(|part| error.contains(part)), "{error}");
            }
        }
    });
}
