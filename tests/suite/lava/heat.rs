//! The fluid's heat against its oracle, and its laws.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::lava::reference::{
    self, Heat as Oracle, cooled_slab, crust_face, light, melt_viscosity, yield_stress,
};
use fumarole::papers::lava::sph::Scale;
use fumarole::papers::lava::{
    Bed, Flow, Heat, Parameters, Particles, Rheology, Shading, Sides, SurfaceDraw, SurfaceKind, Variant,
};
use fumarole::scene::Camera;
use glam::{DVec3, Vec3};

use super::bed::{hills, over};
use super::fluid::{animate, by_cells, flowing, list, oracle, run, state, vectors};
use super::scene::{draw, texels, variant_of};
use super::splatting::low_camera;
use crate::common::gpu_test;

/// Of the cold half: a crust that stress makes yield.
const COLD_K: f32 = 1240.0;

/// Heat a hundred times as fast as that of basalt, and a crust.
fn hot() -> Heat {
    Heat { conductivity_w_mk: 100.0, capacity_j_kgk: 12.0, rheology: Rheology::Basalt, ..Heat::default() }
}

/// As fast as that heat: 350,000 J/kg over a hundred.
const BASALTS_LATENT: f32 = 3500.0;

fn with_heat(parameters: Parameters, heat: Heat) -> Parameters {
    Parameters { flow: Flow { heat, ..parameters.flow.clone() }, ..parameters }
}

/// Its particles, with the farther ones cold.
fn half_cold(parameters: &Parameters) -> Particles {
    let mut particles = Particles::of(parameters);
    for (place, kelvin) in particles.positions.iter().zip(&mut particles.temperatures_k) {
        if place.x > 0.3 {
            *kelvin = COLD_K;
        }
    }
    particles
}

fn oracle_of(parameters: &Parameters) -> Oracle {
    let Flow { heat, melt_kg_m3, .. } = &parameters.flow;
    let capacity = f64::from(*melt_kg_m3) * f64::from(heat.capacity_j_kgk);
    Oracle {
        diffusivity: f64::from(heat.conductivity_w_mk) / capacity,
        capacity,
        emissivity: f64::from(heat.emissivity),
        ambient: f64::from(heat.ambient_k),
        latent: f64::from(heat.latent_j_kg) / f64::from(heat.capacity_j_kgk),
        solidus: f64::from(heat.solidus_k),
        liquidus: f64::from(heat.liquidus_k),
    }
}

/// After some steps of a block with a hot and a cold end: temperatures, viscosities, and the viscosity solved with them.
#[test]
fn heat_and_rheology_do_what_their_equations_say() {
    gpu_test(|device| {
        let crust = Heat { crust_pa_s: 4000.0, ..hot() };
        let thin = Parameters { flow: Flow { viscosity_pa_s: 20.0, ..flowing().flow }, ..flowing() };
        let periodic = Parameters {
            space_m: Vec3::new(0.75, 1.0, 0.7),
            flow: Flow { sides: Sides::Periodic, block_m: Vec3::new(0.75, 0.3, 0.6), ..thin.flow.clone() },
            ..flowing()
        };
        let walled = with_heat(thin, crust.clone());
        let periodic = with_heat(periodic, Heat { emissivity: 0.5, ambient_k: 900.0, ..crust.clone() });
        let on_level = |parameters: Parameters| (parameters, Bed::level());
        let crystallising = with_heat(walled.clone(), Heat { latent_j_kg: BASALTS_LATENT, ..crust });
        let hilly = (crystallising.clone(), hills(&crystallising));
        for (parameters, bed) in [on_level(walled), on_level(periodic), hilly] {
            let particles = half_cold(&parameters).over(bed.clone());
            let mut animate = animate(device, &parameters, &particles);
            run(device, &mut animate, 7);
            let sph = animate.sph().unwrap();
            let began = by_cells(device, &sph.sort.places, parameters.particles as usize);
            let pushed: Vec<[f32; 4]> = list(device, &sph.pushed);
            let kelvin: Vec<f64> = pushed.iter().map(|p| f64::from(p[3])).collect();
            let heat: Vec<[f32; 2]> = list(device, &sph.heat);
            let (fluid, rules) = (over(oracle(&parameters), &bed), oracle_of(&parameters));

            let (mut off_kelvin, mut off_steep, mut lost, mut gained, mut faces) = (0.0f64, 0.0f64, 0.0f64, 0.0f64, 0);
            for i in 0..began.len() {
                let steepness = fluid.steepness(&began, i);
                let (found, is_inside) = (f64::from(heat[i][1]), steepness == 0.0);
                if (found == 0.0) != is_inside {
                    // Rounding at the threshold alone.
                    assert!((found.max(steepness) - 0.6).abs() < 1e-4, "{found} {steepness}");
                    continue;
                }
                faces += usize::from(!is_inside);
                off_steep = off_steep.max((found - steepness).abs());
                let (expected, conducted) = fluid.heated(&rules, &began, &kelvin, i);
                off_kelvin = off_kelvin.max((f64::from(heat[i][0]) - expected).abs());
                gained = gained.max((conducted - kelvin[i]).abs());
                lost = lost.max(conducted - expected);
            }
            println!("kelvin {off_kelvin}, steepness {off_steep}, conducted {gained}, radiated {lost}, {faces} faces");
            assert!(off_kelvin < 5e-3 && off_steep < 1e-4, "{off_kelvin} {off_steep}");
            assert!(gained > 3.0 && lost > 1.0 && (50..550).contains(&faces), "{gained} {lost} {faces}");

            // The rates of strain that the step began with, and the viscosities that follow them.
            let Flow { viscosity_pa_s, heat: rheology, gravity_m_s2, .. } = &parameters.flow;
            let before = vectors(device, &sph.pushed);
            let after = by_cells(device, &sph.velocities[sph.iterations() % 2], before.len());
            let angle = f64::from(parameters.flow.slope_deg(bed.is_level())).to_radians();
            let gained = f64::from(parameters.time_step_s) * f64::from(*gravity_m_s2);
            let gained = gained * DVec3::new(angle.sin(), -angle.cos(), 0.0);
            let speeds: Vec<DVec3> = before.iter().map(|pushed| *pushed - gained).collect();
            let strains: Vec<_> = (0..began.len()).map(|i| fluid.strain_rate(&began, &speeds, i)).collect();
            let [along, across] = sph.strains().unwrap().each_ref().map(|buffer| vectors(device, buffer));
            let (mut off_strain, mut strained) = (0.0f64, 0.0f64);
            for (at, (strain, is_close_call)) in strains.iter().enumerate() {
                if *is_close_call {
                    continue;
                }
                let diagonal = DVec3::new(strain.x_axis.x, strain.y_axis.y, strain.z_axis.z);
                let beside = 2.0 * DVec3::new(strain.y_axis.z, strain.z_axis.x, strain.x_axis.y);
                let off = (along[at] - diagonal).length().max((across[at] - beside).length());
                off_strain = off_strain.max(off);
                strained = strained.max(diagonal.length().max(beside.length()));
            }
            println!("rates of strain off by {off_strain} of {strained}");
            assert!(off_strain < 1e-3 * strained && strained > 0.5, "{off_strain} {strained}");

            let melt = f64::from(*viscosity_pa_s);
            let stiffest = f64::from(rheology.crust_pa_s) / melt;
            let viscosities: Vec<f64> =
                list::<f32>(device, sph.viscosities().unwrap()).into_iter().map(f64::from).collect();
            let (mut off, mut yielding, mut capped) = (0.0f64, 0, 0);
            for i in 0..began.len() {
                let now = f64::from(heat[i][0]);
                let (strain, is_close_call) = fluid.strain_around(&began, &strains, i);
                if is_close_call {
                    continue;
                }
                let is_crust = now < f64::from(rheology.solidus_k);
                let crust = if is_crust { yield_stress(now) / strain } else { 0.0 };
                let all = melt_viscosity(now) / melt_viscosity(f64::from(rheology.melt_k)) + crust / melt;
                off = off.max((viscosities[i] / all.min(stiffest) - 1.0).abs());
                // Where the yield stress is a part of the viscosity.
                yielding += usize::from(all < stiffest && crust / melt > 0.02 * all);
                capped += usize::from(all > stiffest);
            }
            println!("viscosity {off}, {yielding} yield, {capped} are as stiff as any");
            assert!(off < 2e-3 && yielding > 50 && capped < 500, "{off} {yielding} {capped}");

            let remaining = |velocities: &[DVec3]| {
                let residual = |i| fluid.viscous_residual(&began, &viscosities, [&before, velocities], i);
                (0..began.len()).map(|i| residual(i).length_squared()).sum::<f64>().sqrt()
            };
            let (first, last) = (remaining(&before), remaining(&after));
            println!("viscosity: {first} {last} after {}", sph.iterations());
            assert!(last < 2e-3 * first + 1e-4, "{first} {last}");
        }
    });
}

/// Lava that flows, mixes and conducts without radiating keeps its heat to a ten-thousandth of the difference that it began with;
/// what is latent, too, and it takes longer to even out then.
#[test]
fn heat_is_kept_without_radiation() {
    gpu_test(|device| {
        let plain = Heat { emissivity: 0.0, rheology: Rheology::Constant, ..hot() };
        let crystallising = Heat { latent_j_kg: BASALTS_LATENT, ..plain.clone() };
        let [plain, crystallising] = [plain, crystallising].map(|heat| left_of_the_spread(device, heat));
        assert!(plain < 0.9 && crystallising > plain && crystallising < 0.95, "{plain} {crystallising}");
    });
}

/// After 80 steps without radiation, in which no heat is lost: the squares of the temperatures about their mean over those at the start.
fn left_of_the_spread(device: &Arc<Device>, heat: Heat) -> f64 {
    let parameters = with_heat(flowing(), heat);
    let oracle = oracle_of(&parameters);
    let particles = half_cold(&parameters);
    let mean = |list: &[f32], of: &dyn Fn(f64) -> f64| list.iter().map(|t| of(f64::from(*t))).sum::<f64>() / 600.0;
    let held = |list: &[f32]| mean(list, &|kelvin| oracle.enthalpy(kelvin));
    let mut animate = animate(device, &parameters, &particles);
    run(device, &mut animate, 80);
    let velocities: Vec<[f32; 4]> = texels(device, &animate.state().velocities);
    let after: Vec<f32> = velocities[..600].iter().map(|v| v[3]).collect();
    let (coldest, hottest) = after.iter().fold((f32::MAX, 0.0f32), |(low, high), t| (low.min(*t), high.max(*t)));
    let difference = oracle.enthalpy(parameters.flow.heat.melt_k.into()) - oracle.enthalpy(COLD_K.into());
    let lost = held(&particles.temperatures_k) - held(&after);
    println!("{lost} K are lost of a difference of {difference}; {coldest} to {hottest}");
    assert!(lost.abs() < 1e-4 * difference, "{lost} {difference}");
    // It went from the hot to the cold, and nothing is hotter or colder than at the start.
    assert!(coldest > COLD_K - 0.01 && hottest < 1423.01, "{coldest} {hottest}");
    let spread = |list: &[f32]| {
        let middle = mean(list, &|kelvin| kelvin);
        mean(list, &|kelvin| (kelvin - middle) * (kelvin - middle))
    };
    spread(&after) / spread(&particles.temperatures_k)
}

/// A slab that does not flow, against the heat equation in one dimension; one that crystallises, against that with an enthalpy
/// (Voller and Cross 1981): its upper layers have crystallised, those below have begun to.
#[test]
fn a_slab_cools_as_the_heat_equation_says() {
    gpu_test(|device| {
        let plain = Heat { conductivity_w_mk: 120.0, capacity_j_kgk: 10.0, ..Heat::default() };
        let crystallising = Heat { latent_j_kg: 1500.0, solidus_k: 1360.0, liquidus_k: 1430.0, ..plain.clone() };
        let fallen = cooled(device, plain);
        assert!(fallen > 150.0, "{fallen}");
        let slower = cooled(device, crystallising);
        assert!(slower < 0.9 * fallen && slower > 1423.0 - 1355.0, "{slower} {fallen}");
    });
}

/// 12 particles deep, after four seconds: by how many kelvin its upper face has cooled.
fn cooled(device: &Arc<Device>, heat: Heat) -> f64 {
    let spacing = 0.05;
    let flow = Flow {
        block_m: spacing * Vec3::new(8.0, 12.0, 8.0),
        gravity_m_s2: 0.0,
        // What pressure moves comes to rest at once.
        viscosity_pa_s: 2000.0,
        sides: Sides::Periodic,
        heat,
        ..Flow::default()
    };
    let space_m = Vec3::new(flow.block_m.x, 1.0, flow.block_m.z);
    let parameters = Parameters { particles: 768, space_m, radius_m: 0.1, flow, ..flowing() };
    let particles = Particles::of(&parameters);
    let mut animate = animate(device, &parameters, &particles);
    const STEPS: u32 = 120;
    run(device, &mut animate, STEPS);
    let (places, _) = state(device, &animate, 768);
    // Sideways the space repeats; pressure evens out the shaken lattice, and nothing flows.
    let climbed = places.iter().zip(&particles.positions).map(|(now, start)| (now.y - f64::from(start.y)).abs());
    let climbed = climbed.fold(0.0, f64::max);
    println!("climbed {climbed} m at most");
    assert!(climbed < 0.5 * f64::from(spacing), "it does not flow");
    let velocities: Vec<[f32; 4]> = texels(device, &animate.state().velocities);
    let time = f64::from(STEPS) * f64::from(parameters.time_step_s);
    let start = f64::from(parameters.flow.heat.melt_k);
    let slab = cooled_slab(&oracle_of(&parameters), 0.6, 120, start, time);
    let (mut off, mut lost, mut lost_here) = (0.0f64, 0.0, 0.0);
    for layer in 0..12 {
        // The block is laid layer by layer.
        let found = velocities[64 * layer..64 * layer + 64].iter().map(|v| f64::from(v[3])).sum::<f64>() / 64.0;
        let expected = slab[10 * layer..10 * layer + 10].iter().sum::<f64>() / 10.0;
        println!("layer {layer}: {found:.2} K, expected {expected:.2}");
        off = off.max((found - expected).abs());
        lost += start - expected;
        lost_here += start - found;
    }
    let fallen = start - slab[119];
    println!("off by {off} of {fallen} K; heat lost {:.4} of what it should", lost_here / lost);
    assert!(off < 0.03 * fallen && (lost_here / lost - 1.0).abs() < 0.03, "{off} {fallen}");
    fallen
}

/// Steady flow of a Bingham fluid down a slope, 12 particles deep: slower by its plug, whose viscosity is the largest there is.
/// A film without yield stress is 3.6 % slower than theory, this one 7 %.
#[test]
fn a_film_of_crust_has_a_bingham_fluids_speed() {
    gpu_test(|device| {
        let spacing = 0.05;
        // 500 Pa of yield stress, where the melt has its viscosity.
        let kelvin = ((13.00997 - 500f64.log10()) / 0.0089) as f32;
        let heat =
            Heat { melt_k: kelvin, emissivity: 0.0, rheology: Rheology::Basalt, crust_pa_s: 6000.0, ..Heat::default() };
        let flow = Flow {
            block_m: spacing * Vec3::new(8.0, 12.0, 8.0),
            viscosity_pa_s: 800.0,
            slope_deg: Some(6.0),
            sides: Sides::Periodic,
            heat,
            ..Flow::default()
        };
        let space_m = Vec3::new(flow.block_m.x, 1.0, flow.block_m.z);
        let parameters = Parameters { particles: 768, space_m, radius_m: 0.1, flow, ..flowing() };
        let mut animate = animate(device, &parameters, &Particles::of(&parameters));
        run(device, &mut animate, 70);
        let (places, velocities) = state(device, &animate, 768);
        let mean = velocities.iter().map(|v| v.x).sum::<f64>() / 768.0;
        let depth = 12.0 * f64::from(spacing);
        let thickness = 2.0 * places.iter().map(|p| p.y).sum::<f64>() / 768.0;
        let slope = f64::from(parameters.flow.slope_deg(true)).to_radians();
        let Flow { viscosity_pa_s, melt_kg_m3, gravity_m_s2, heat, .. } = &parameters.flow;
        let (melt, stiff) = (f64::from(*viscosity_pa_s), f64::from(heat.crust_pa_s));
        let along = f64::from(*gravity_m_s2) * slope.sin();
        let at_bed = f64::from(*melt_kg_m3) * depth * along;
        let yielding = yield_stress(f64::from(kelvin));
        // The mean of the speed is the integral of the rate of strain times what lies above it.
        let mean_of = |yielding: f64| {
            let parts = 2000;
            let part = |at: i32| {
                let height = (f64::from(at) + 0.5) / f64::from(parts);
                let stress = at_bed * (1.0 - height);
                let rate = (stress / stiff).max((stress - yielding) / melt);
                rate * (1.0 - height) * thickness / f64::from(parts)
            };
            (0..parts).map(part).sum::<f64>()
        };
        let (expected, newtonian) = (mean_of(yielding), mean_of(0.0));
        println!("mean speed {mean}, expected {expected}, without yield stress {newtonian}: {:.4}", mean / expected);
        assert!((mean / expected - 1.0).abs() < 0.1, "{mean} {expected}");
        assert!(expected < 0.75 * newtonian);
    });
}

/// The surface has the temperatures of the particles around it, and the colour of them.
#[test]
fn the_surface_is_as_hot_as_its_particles() {
    gpu_test(|device| {
        let heat = Heat { emissivity: 0.0, rheology: Rheology::Constant, ..hot() };
        let parameters = Parameters {
            is_blackbody: true,
            shading: Shading::Color,
            surface: SurfaceKind::Crossing,
            surface_draw: Some(SurfaceDraw::March),
            camera: Camera { eye: Vec3::new(0.4, 3.0, 0.4), target: Vec3::new(0.35, 0.0, 0.3), ..low_camera() },
            border_m: 0.0,
            ..with_heat(flowing(), heat)
        };
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let mut lava = variant_of(device, variant, &parameters, &half_cold(&parameters));
            draw(device, &mut lava, 4);
            let sph = lava.animate.sph().unwrap();
            let places = vectors(device, sph.arrived());
            let kelvin: Vec<[f32; 2]> = list(device, &sph.heat);
            let surface: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
            let found: Vec<[f32; 4]> = texels(device, &lava.surface_temperature.as_ref().unwrap().temperatures);
            let Scale { support_m, spacing_m, .. } = Scale::of(&parameters);
            let [columns, _, rows] = parameters.density;
            let (mut covered, mut off, mut range) = (0, 0.0f64, (f64::MAX, 0.0f64));
            for (at, (found, surface)) in found.iter().zip(&surface).enumerate() {
                let (i, k) = (at as u32 % columns, at as u32 / columns);
                let x = (f64::from(i) + 0.5) / f64::from(columns) * f64::from(parameters.space_m.x);
                let z = (f64::from(k) + 0.5) / f64::from(rows) * f64::from(parameters.space_m.z);
                let (mut weights, mut sum) = (0.0, 0.0);
                for (place, kelvin) in places.iter().zip(&kelvin) {
                    let q = (place.x - x).hypot(place.z - z) / support_m;
                    let halvings = 2.0 * (place.y - f64::from(surface[3])).abs() / spacing_m;
                    let weight = (1.0 - q).max(0.0).powi(4) * (1.0 + 4.0 * q) * (-halvings.min(40.0)).exp2();
                    weights += weight;
                    sum += weight * f64::from(kelvin[0]);
                }
                if weights < 1e-3 {
                    continue;
                }
                assert_eq!(found[1], 1.0);
                covered += 1;
                off = off.max((f64::from(found[0]) - sum / weights).abs());
                range = (range.0.min(sum / weights), range.1.max(sum / weights));
            }
            println!("{variant:?}: {covered} columns off by {off} K, {range:?}");
            assert!(off < 1.5 && covered > 40 && range.1 - range.0 > 80.0, "{off} {covered} {range:?}");
        }
        // One temperature is one colour.
        let mut lava = variant_of(device, Variant::GpuDriven, &parameters, &Particles::of(&parameters));
        draw(device, &mut lava, 4);
        let sums: Vec<[f32; 4]> = texels(device, &lava.splatting.sums);
        let [red, green, blue] = light(1423.0).map(|value| value.max(0.0));
        let lit: Vec<_> = sums.iter().filter(|sums| sums[3] > 0.0).collect();
        for sums in &lit {
            let found = [sums[0], sums[1], sums[2]].map(|value| f64::from(value / sums[3]));
            let expected = [1.0, green / red, blue / red];
            let off = (0..3).map(|axis| (found[axis] - expected[axis]).abs()).fold(0.0, f64::max);
            assert!(off < 3e-3, "{found:?} {expected:?}");
        }
        assert!(lit.len() > 300, "{}", lit.len());
    });
}

/// The face of a crust is what glows: as hot as the particles where they have lost nothing, hundreds of kelvin colder where they have lost little.
#[test]
fn the_face_of_a_crust_glows() {
    gpu_test(|device| {
        let heat = Heat { emissivity: 0.9, crust_w_mk: 1.5, ambient_k: 400.0, ..hot() };
        let parameters = Parameters { surface: SurfaceKind::Crossing, border_m: 0.0, ..with_heat(flowing(), heat) };
        let oracle = oracle_of(&parameters);
        let spacing = Scale::of(&parameters).spacing_m;
        let mut lava = variant_of(device, Variant::GpuDriven, &parameters, &half_cold(&parameters));
        draw(device, &mut lava, 4);
        let found: Vec<[f32; 4]> = texels(device, &lava.surface_temperature.as_ref().unwrap().temperatures);
        let (mut covered, mut off, mut range) = (0, 0.0f64, (f64::MAX, 0.0f64));
        for found in found.iter().filter(|found| found[1] > 0.0) {
            let [face, _, _, kelvin] = found.map(f64::from);
            let expected = crust_face(&oracle, 1.5, 1423.0, spacing, kelvin);
            covered += 1;
            off = off.max((face - expected).abs());
            range = (range.0.min(face / kelvin), range.1.max(face / kelvin));
        }
        println!("{covered} columns off by {off} K, {range:?}");
        assert!(off < 0.5 && covered > 40 && range.0 < 0.75, "{off} {covered} {range:?}");
    });
    let plain = oracle_of(&with_heat(flowing(), hot()));
    // Through 2 cm of crust come 37.9 kW/m2, which a face of 918.2 K radiates.
    let lost = 0.5 * 0.02 * (1423.0 - 918.2) / 0.04;
    let face = crust_face(&plain, 1.5, 1423.0, 0.04, 1423.0 - lost);
    assert!((face - 918.2).abs() < 0.1, "{face}");
}

/// Next to no viscosity or conductivity, relative to which other numbers are so large that single precision does not hold their products.
#[test]
fn next_to_no_viscosity_and_conductivity_move_lava() {
    gpu_test(|device| {
        let thin = Parameters { flow: Flow { viscosity_pa_s: 1e-25, ..flowing().flow }, ..flowing() };
        let insulated = Heat { conductivity_w_mk: 2e-38, ..hot() };
        for parameters in [with_heat(thin, hot()), with_heat(flowing(), insulated)] {
            let mut animate = animate(device, &parameters, &half_cold(&parameters));
            run(device, &mut animate, 3);
            let sph = animate.sph().unwrap();
            let viscous = by_cells(device, &sph.velocities[sph.iterations() % 2], 600);
            let (places, velocities) = state(device, &animate, 600);
            assert!(viscous.iter().chain(&places).chain(&velocities).all(|value| value.is_finite()));
            let heat: Vec<[f32; 2]> = list(device, &sph.heat);
            assert!(heat.iter().all(|[kelvin, _]| (300.0..1423.1).contains(kelvin)));
        }
    });
}

#[test]
fn numbers_of_heat_that_cannot_be_are_refused() {
    let basalt = with_heat(flowing(), hot());
    assert_eq!(basalt.validate(), Ok(()));
    let heat = |heat: Heat| with_heat(flowing(), heat);
    let constant = Heat { rheology: Rheology::Constant, ..hot() };
    let cases = [
        ("melt-temperature", heat(Heat { melt_k: 600.0, ..hot() })),
        ("ambient", heat(Heat { ambient_k: 1500.0, ..hot() })),
        ("emissivity", heat(Heat { emissivity: 1.1, ..hot() })),
        ("conductivity", heat(Heat { conductivity_w_mk: 1000.0, ..hot() })),
        ("conductivity", heat(Heat { conductivity_w_mk: f32::NAN, ..hot() })),
        ("crust-conductivity", heat(Heat { crust_w_mk: -1.0, ..hot() })),
        ("heat-capacity", heat(Heat { capacity_j_kgk: 0.0, ..hot() })),
        ("solidus", heat(Heat { solidus_k: 1200.0, ..constant.clone() })),
        ("latent-heat", heat(Heat { latent_j_kg: -1.0, ..hot() })),
        ("latent-heat", heat(Heat { latent_j_kg: 350_000.0, ..hot() })),
        ("liquidus", heat(Heat { liquidus_k: 1500.0, ..hot() })),
        ("liquidus", heat(Heat { latent_j_kg: 10.0, liquidus_k: 1273.0, ..hot() })),
        ("solidus", heat(Heat { solidus_k: 100.0, ..hot() })),
        ("crust-viscosity", heat(Heat { crust_pa_s: 5000.0, ..constant })),
        ("crust-viscosity", heat(Heat { crust_pa_s: 50.0, ..hot() })),
        ("crust-viscosity", heat(Heat { crust_pa_s: 1e6, ..hot() })),
        ("viscosity", Parameters { flow: Flow { viscosity_pa_s: 0.0, ..basalt.flow.clone() }, ..basalt.clone() }),
        ("viscosity", Parameters { flow: Flow { viscosity_pa_s: 1e-28, ..basalt.flow.clone() }, ..basalt.clone() }),
    ];
    for (name, parameters) in cases {
        let error = parameters.validate().expect_err(name);
        assert_eq!(error.name, name, "{error}");
    }
    // The oracle's fits at the temperature of an eruption.
    assert!(
        (reference::melt_viscosity(1423.0) - 121.7).abs() < 0.1
            && (reference::yield_stress(1423.0) - 2.21).abs() < 0.01
    );
}
