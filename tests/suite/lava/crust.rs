//! The relief of a fluid's crust: its oracle, what it keeps, and the folds that its ropes are.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::lava::reference::{self, Columns, Texel, fold_length, fold_steepness};
use fumarole::papers::lava::sph::Scale;
use fumarole::papers::lava::{
    Crust, Flow, Heat, Lava, Parameters, Particles, Rheology, Rock, Simulation, SurfaceKind, Variant, Vent,
};
use glam::{DVec2, DVec3, Vec3};

use super::fluid::{by_cells, flowing, list, vectors};
use super::scene::{draw, shaders, texels};
use crate::common::gpu_test;

/// A block of 600 particles that falls apart under a crust.
fn crusted(crust: Crust) -> Parameters {
    let heat = Heat { rheology: Rheology::Basalt, ..Heat::default() };
    Parameters {
        surface: SurfaceKind::Crossing,
        density: [40, 16, 24],
        radius_m: 0.15,
        border_m: 0.0,
        flow: Flow { crust, heat, renewal_s: 0.5, ..flowing().flow },
        ..flowing()
    }
}

/// After ten steps, with temperatures from 1,243 to 1,423 K that change from one end to the other.
fn drawn(device: &Arc<Device>, parameters: &Parameters) -> Lava {
    parameters.validate().unwrap();
    let mut particles = Particles::of(parameters);
    for (kelvin, place) in particles.temperatures_k.iter_mut().zip(&particles.positions) {
        *kelvin = 1423.0 - 150.0 * place.z / 0.5 - 60.0 * place.y;
    }
    let rock = Rock::built_in();
    let mut lava = Lava::new(&shaders(device), "test", Variant::GpuDriven, parameters, &particles, rock, &[]).unwrap();
    draw(device, &mut lava, 9);
    lava
}

fn floats(texels: Vec<[f32; 4]>) -> Vec<[f64; 4]> {
    texels.into_iter().map(|texel| texel.map(f64::from)).collect()
}

/// Ropes are as long as the folds that grow fastest in a stability analysis; a rope's arc is as long as the skin was.
#[test]
fn ropes_are_the_folds_that_grow_fastest() {
    let skin = Crust { skin_m: 1.0, ..Crust::default() };
    for stiffness in [5.0, 10.0, 20.0, 100.0, 1000.0, 10_000.0] {
        let (found, expected) = (skin.rope_m(stiffness), fold_length(stiffness));
        println!("{stiffness}: {found} {expected}");
        assert!((found / expected - 1.0).abs() < 0.04, "{stiffness}: {found} {expected}");
    }
    for longer in [1.0, 1.02, 1.1, 1.25, 1.4] {
        let steepness = fold_steepness(longer);
        let root = (1.0 + 0.5 * steepness * steepness).sqrt();
        assert!((root / longer - 1.0).abs() < 0.02, "{longer}: {root}");
    }
}

/// Speed, warmth and depth of each column against sums over all particles.
#[test]
fn surface_motion_is_that_of_the_particles_around_it() {
    gpu_test(|device| {
        let parameters = crusted(Crust { pieces: 1.5, ..Crust::default() });
        let lava = drawn(device, &parameters);
        let sph = lava.animate.sph().unwrap();
        let began = by_cells(device, &sph.sort.places, parameters.particles as usize);
        let arrived = vectors(device, sph.arrived());
        let heat: Vec<[f32; 2]> = list(device, &sph.heat);
        let relief = lava.relief.as_ref().unwrap();
        let motion = floats(texels(device, &relief.motion));
        let surface = floats(texels(device, &lava.normal_height.surface));
        let support = Scale::of(&parameters).support_m;
        let (mut compared, mut fastest) = (0, 0.0f64);
        for (at, [u, w, kelvin, depth]) in motion.into_iter().enumerate() {
            let height = surface[at][3];
            assert!((depth - height).abs() < 1e-6, "{at}: {depth} {height}");
            let middle = DVec3::new((at % 40) as f64 + 0.5, 0.0, (at / 40) as f64 + 0.5) / DVec3::new(20.0, 1.0, 20.0);
            let (mut weights, mut way, mut columns, mut warmth) = (0.0, DVec2::ZERO, 0.0, 0.0);
            for (i, place) in arrived.iter().enumerate() {
                let apart = *place - middle.with_y(height);
                let inside = (1.0 - DVec2::new(apart.x, apart.z).length() / support).max(0.0);
                let near = inside.powi(4) * (5.0 - 4.0 * inside);
                let weight = near * 0.5f64.powf(4.8 * apart.y.abs() / support);
                way += weight * DVec2::new(place.x - began[i].x, place.z - began[i].z);
                weights += weight;
                columns += near;
                warmth += near * f64::from(heat[i][0]);
            }
            // Particles are looked for in the cells that they began the step in: at the rim of the kernel one may be missed.
            if columns < 0.05 {
                continue;
            }
            let expected = way / weights * 30.0;
            compared += 1;
            fastest = fastest.max(expected.length());
            assert!((DVec2::new(u, w) - expected).length() < 2e-3, "{at}: {u} {w} {expected} {columns}");
            assert!((kelvin - warmth / columns).abs() < 0.5, "{at}: {kelvin} {} {columns}", warmth / columns);
        }
        assert!(compared > 150 && fastest > 0.2, "{compared} {fastest}");
    });
}

/// Heights and temperatures of the crust with ropes, with pieces, and with both, and of toes; temperatures are the surface's in the mean.
#[test]
fn the_crust_is_what_its_equations_say() {
    gpu_test(|device| {
        let ropes = Crust { skin_m: 0.03, ..Crust::default() };
        let pieces = Crust { pieces: 1.3, jumble: 0.7, healing_s: 0.4, ..Crust::default() };
        let cases = [
            (ropes, 0.0),
            (pieces, 0.0),
            (Crust { skin_m: 0.03, ..pieces }, 0.0),
            (Crust::default(), 0.02),
            (pieces, 0.02),
        ];
        for (crust, toe_m3) in cases {
            let mut parameters = crusted(crust);
            if toe_m3 > 0.0 {
                parameters.flow.vent = Vent { effusion_m3_s: 0.25, middle_m: [0.4, 0.6], radius_m: 0.3, toe_m3 };
                // Shorter steps, of which each fills no more of a small toe than it may.
                parameters.flow.substeps = Some(3);
            }
            let lava = drawn(device, &parameters);
            let sph = lava.animate.sph().unwrap();
            let out = lava.animate.out() as usize;
            let relief = lava.relief.as_ref().unwrap();
            let surface_temperature = lava.surface_temperature.as_ref().unwrap();
            let columns = Columns {
                counts: [40, 24],
                space: DVec2::new(2.0, 1.2),
                motion: floats(texels(device, &relief.motion)),
                heat: floats(texels(device, &surface_temperature.temperatures)),
                carried: floats(texels(device, &surface_temperature.carried)),
            };
            let items: Vec<[u32; 2]> = list(device, &sph.sort.items);
            let numbers = items.into_iter().map(|[_, number]| number);
            let particles: Vec<(DVec3, u32)> =
                vectors(device, sph.arrived()).into_iter().zip(numbers).take(out).collect();
            let breaks: Vec<f64> = parameters.flow.vent.toes(&parameters).iter().map(|toe| toe.first_m3).collect();
            let toe_of =
                |number: u32| breaks.iter().rposition(|first| *first <= f64::from(number) * 2.5e-4).unwrap_or(0) as u32;
            let toes: Vec<u32> = (0..600).map(toe_of).collect();
            assert_eq!(toes[out - 1] > 1, toe_m3 > 0.0);
            let Scale { spacing_m, support_m, .. } = Scale::of(&parameters);
            let oracle = reference::Crust {
                rope: 6.463 * f64::from(crust.skin_m),
                piece: f64::from(crust.pieces) * spacing_m,
                jumble: f64::from(crust.jumble),
                healing: f64::from(crust.healing_s),
                kept: if crust.pieces > 0.0 { 1.3f64.powi(-3) } else { 1.0 },
                melt: 1423.0,
                solidus: 1273.0,
                ambient: 300.0,
                least: 1.5 * spacing_m,
                seam: if toe_m3 > 0.0 { 1.5 * spacing_m } else { 0.0 },
                toes,
            };
            let heights = floats(texels(device, &relief.normal_height));
            let heat = floats(texels(device, &relief.temperatures));
            let (width, rows) = (relief.normal_height.width() as usize, relief.normal_height.height() as usize);
            let texel = 2.0 / width as f64;
            let (mut compared, mut left_out, mut highest, mut coldest) = (0, 0, 0.0f64, 0.0f64);
            let stride = width * rows / 2000;
            for at in (0..width * rows).step_by(stride) {
                let place = DVec2::new((at % width) as f64 + 0.5, (at / width) as f64 + 0.5) * texel;
                let expected: Texel = oracle.at(&columns, &particles, place, texel, support_m);
                let (height, kelvin) = (heights[at][3], heat[at][0]);
                if expected.is_uncertain {
                    left_out += 1;
                    continue;
                }
                compared += usize::from(heat[at][1] > 0.0);
                // A rope's height is that of an arc, within 4 % of 1.5 / tau of its length.
                // A particle that a step moves far may have left the cells in which it is looked for, which a seam's weights feel.
                let tolerance = 2e-4 + 0.04 * 0.24 * oracle.rope + 0.02 * oracle.seam;
                let warmer = if oracle.seam > 0.0 { 3.0 } else { 0.5 };
                assert!((height - expected.height).abs() < tolerance, "{place}: {height} {}", expected.height);
                assert!((kelvin - expected.kelvin).abs() < warmer, "{place}: {kelvin} {}", expected.kelvin);
                let plain = columns.motion[at % width * 40 / width + at / width * 24 / rows * 40][3];
                highest = highest.max((height - plain).abs());
                coldest = coldest
                    .max((kelvin - columns.heat[at % width * 40 / width + at / width * 24 / rows * 40][0]).abs());
            }
            println!(
                "{crust:?}, {toe_m3}: {compared} of {}, {left_out} left out, {highest} m, {coldest} K",
                width * rows / stride
            );
            assert!(compared > 300 && left_out * 10 < width * rows / stride && highest > 0.01, "{compared} {left_out}");
        }
    });
}

/// The skin of lava that a wall halts folds there, across the flow, and is smooth where the flow stretches it.
#[test]
fn ropes_lie_across_a_flow_that_is_halted() {
    gpu_test(|device| {
        let parameters = crusted(Crust { skin_m: 0.02, ..Crust::default() });
        let flow = Flow { gravity_m_s2: 0.0, renewal_s: 100.0, block_m: Vec3::new(0.8, 0.4, 1.2), ..parameters.flow };
        let parameters = Parameters { flow, simulation: Simulation::Sph, ..parameters };
        let mut particles = Particles::of(&parameters);
        // Against the wall at the end.
        for ((place, velocity), kelvin) in
            particles.positions.iter_mut().zip(&mut particles.velocities).zip(&mut particles.temperatures_k)
        {
            place.x += 1.2;
            *velocity = Vec3::new(3.0 * (2.0 - place.x), 0.0, 0.0);
            *kelvin = 1300.0;
        }
        let rock = Rock::built_in();
        let mut lava =
            Lava::new(&shaders(device), "test", Variant::GpuDriven, &parameters, &particles, rock, &[]).unwrap();
        draw(device, &mut lava, 11);
        let relief = lava.relief.as_ref().unwrap();
        let normals = floats(texels(device, &relief.normal_height));
        let (width, rows) = (relief.normal_height.width() as usize, relief.normal_height.height() as usize);
        let (mut along, mut across) = (0.0, 0.0);
        for z in rows / 4..3 * rows / 4 {
            for x in width * 6 / 8..width * 15 / 16 {
                let [nx, ny, nz, _] = normals[z * width + x];
                along += (nx / ny).powi(2);
                across += (nz / ny).powi(2);
            }
        }
        println!("{along} {across}");
        assert!(along > 4.0 * across, "{along} {across}");
    });
}

/// Without ropes and pieces there is no pass of the crust, and a crust wants numbers that fit.
#[test]
fn a_crust_that_does_not_fit_is_refused() {
    gpu_test(|device| assert!(drawn(device, &crusted(Crust::default())).relief.is_none()));
    let constant = |crust| Parameters { flow: Flow { crust, ..flowing().flow }, ..flowing() };
    let default = Crust::default();
    let seamed = |density: [u32; 3]| {
        let vent = Vent { effusion_m3_s: 0.25, middle_m: [0.4, 0.6], radius_m: 0.3, toe_m3: 0.02 };
        Parameters { density, flow: Flow { vent, substeps: Some(3), ..crusted(default).flow }, ..crusted(default) }
    };
    assert_eq!(seamed([40, 16, 24]).validate(), Ok(()));
    for (name, parameters) in [
        ("skin", constant(Crust { skin_m: 0.03, ..default })),
        ("pieces", constant(Crust { pieces: 1.5, ..default })),
        ("pieces", crusted(Crust { pieces: 0.5, ..default })),
        ("pieces", crusted(Crust { pieces: 1.6, ..default })),
        ("jumble", crusted(Crust { jumble: 0.5, ..default })),
        ("healing", crusted(Crust { healing_s: 3.0, ..default })),
        ("skin", crusted(Crust { skin_m: 0.001, ..default })),
        ("skin", crusted(Crust { skin_m: f32::NAN, ..default })),
        ("particles", seamed([2, 16, 2])),
    ] {
        let error = parameters.validate().expect_err(name);
        assert_eq!(error.name, name, "{error}");
    }
    let heat = Heat { rheology: Rheology::Basalt, solidus_k: 1423.0, ..Heat::default() };
    let crust = Crust { skin_m: 0.03, ..default };
    let parameters = Parameters { flow: Flow { crust, heat, ..flowing().flow }, ..crusted(crust) };
    assert_eq!(parameters.validate().expect_err("solidus").name, "solidus");
}
