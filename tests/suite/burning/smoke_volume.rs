//! Smoke as a volume: as dense as its particles show it, lit by the flames, and before the mesh alone.

use fumarole::measure::Paper;
use fumarole::papers::burning::parameters::SmokeAs;
use fumarole::papers::burning::reference::flames::Particle;
use fumarole::papers::burning::reference::smoke::{Grid, extinctions, marched, shown};
use fumarole::papers::burning::{FireLight, Parameters, Particle as DeviceParticle, SMOKE_CELLS, SmokeGrid, Variant};
use glam::{DVec3, DVec4};

use super::fire::{Fire, ball};
use super::lights::{burning, bytes, first_picture, image};
use crate::common::gpu_test;

/// Of a particle without age, by draw-smoke.frag: smoke-density.comp has it as a constant.
const BODY: f64 = 0.775;

fn smoking() -> Parameters {
    Parameters { smoke_as: SmokeAs::Volume, smoke: 1500, fire_scale: 1, ..burning() }
}

/// The grid, and its cells: light times extinction, and extinction.
fn volume(fire: &Fire) -> (Grid, Vec<DVec4>) {
    let volume = fire.paper.smoke_volume().expect("the smoke");
    let grids: Vec<SmokeGrid> = fire.read(&volume.grid);
    let grid = Grid { low: grids[0].low.as_dvec3(), width: grids[0].cell_width.into() };
    let cells: Vec<[f32; 4]> = fire.read(&volume.cells);
    (grid, cells.into_iter().map(|cell| DVec4::from_array(cell.map(f64::from))).collect())
}

#[test]
fn a_square_shows_as_much_as_its_particle_adds() {
    for age in [0.1_f64, 0.3, 0.7] {
        let fade = 0.3 * (age / 0.2).min(1.0).powi(2) * (3.0 - 2.0 * (age / 0.2).min(1.0)) * (1.0 - age);
        let body = shown(age) / fade;
        assert!((body / BODY - 1.0).abs() < 0.03, "{age}: {body}");
    }
}

#[test]
fn cells_hold_their_particles_and_the_light_of_the_flames() {
    gpu_test(|device| {
        for particle_radius in [0.02, 0.004] {
            let parameters = Parameters { particle_radius, ..smoking() };
            let fire = first_picture(device, Variant::Shell, &parameters, &ball());
            let (grid, cells) = volume(&fire);
            let radius = f64::from(particle_radius);
            assert!((grid.width / radius).log2().fract().abs() < 1e-6, "{grid:?}");
            let particles: Vec<DeviceParticle> = fire.read(&fire.paper.flames().unwrap().particles);
            let smoke: Vec<Particle> = particles[parameters.fire as usize..]
                .iter()
                .map(|p| Particle {
                    position: p.position.as_dvec3(),
                    age: p.age_ticks as u32,
                    life: p.life_ticks as u32,
                    block: p.block as usize,
                    own: p.random.map(f64::from),
                })
                .collect();
            let there = smoke.iter().filter(|particle| particle.life > 0);
            let inside = |p: &Particle| {
                let at = (p.position - grid.low) / grid.width;
                at.min_element() >= 1.5 && at.max_element() <= SMOKE_CELLS as f64 - 1.5
            };
            assert!(there.clone().count() > 50 && there.clone().all(inside), "{grid:?}");
            let expected = extinctions(&smoke, grid, radius, BODY);
            // Shares are whole numbers of units; a cell has some of several particles.
            let unit = radius * radius / 16384.0 / grid.width.powi(3);
            let most = expected.iter().fold(0.0_f64, |most, extinction| most.max(*extinction));
            let lights: Vec<FireLight> = fire.read(fire.paper.fire_lights().unwrap());
            let lights = &lights[..lights[0].count as usize];
            assert!(!lights.is_empty());
            let mut lit = 0;
            for (number, (found, expected)) in cells.iter().zip(&expected).enumerate() {
                let apart = (found.w - expected).abs();
                assert!(apart < 1e-3 * most + 8.0 * unit, "cell {number}: {} not {expected}", found.w);
                if found.w == 0.0 {
                    assert!(found.truncate() == DVec3::ZERO);
                    continue;
                }
                let cell = [1, SMOKE_CELLS, SMOKE_CELLS * SMOKE_CELLS].map(|step| (number / step % SMOKE_CELLS) as f64);
                let place = grid.low + (DVec3::from_array(cell) + 0.5) * grid.width;
                let around = lights.iter().map(|light| {
                    let squared = light.position.as_dvec3().distance_squared(place) + f64::from(light.radius).powi(2);
                    light.intensity.as_dvec3() * (0.25 / squared)
                });
                let light = 0.1 + 0.4 * around.sum::<DVec3>();
                let apart = (found.truncate() / found.w / light - 1.0).abs().max_element();
                assert!(apart < 1e-3, "cell {number}: {found} {light}");
                lit += u32::from(light.x > 0.101);
            }
            assert!(lit > 100, "{lit} cells in the light of the flames");
        }
    });
}

#[test]
fn rays_gather_what_lies_before_the_mesh() {
    gpu_test(|device| {
        for fire_scale in [1, 2] {
            let parameters = Parameters { fire_scale, fire: 0, ..smoking() };
            let fire = first_picture(device, Variant::Shell, &parameters, &ball());
            let (grid, cells) = volume(&fire);
            let layer = image(device, &fire, "fire-layer");
            let depths: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes(device, &fire, "depth"));
            let camera = *Paper::camera(&fire.paper).as_ref().unwrap();
            let from_clip = (camera.projection(parameters.aspect()) * camera.view()).as_dmat4().inverse();
            let eye = camera.eye.as_dvec3();
            let (width, height) = (parameters.width, parameters.height);
            let (mut seen, mut hidden) = (0, 0);
            for (i, found) in (0..).zip(&layer) {
                let columns = width.div_ceil(fire_scale);
                let pixel = [(i % columns, width), (i / columns, height)]
                    .map(|(texel, pixels)| (texel * fire_scale + fire_scale / 2).min(pixels - 1));
                let clip = |at: u32, pixels: u32| (2.0 * f64::from(at) + 1.0) / f64::from(pixels) - 1.0;
                let depth = f64::from(depths[(pixel[1] * width + pixel[0]) as usize]);
                let place = DVec3::new(clip(pixel[0], width), clip(pixel[1], height), depth);
                let mesh = from_clip.project_point3(place);
                let ray = (mesh - eye).normalize();
                let gathered = |to: f64, increments| marched(&cells, grid, (eye, ray), to, increments);
                let expected = gathered(mesh.distance(eye), 1.0);
                let apart = (*found - expected).abs().max_element();
                assert!(apart < 3e-3, "{i}: {found} {expected}");
                let fine = (gathered(mesh.distance(eye), 16.0) - expected).abs().max_element();
                assert!(fine < 0.03, "{i}: the increments show, {fine}");
                seen += u32::from(expected.w > 0.02);
                hidden += u32::from(gathered(f64::INFINITY, 1.0).w > expected.w + 0.02);
            }
            let whole = fire_scale * fire_scale;
            assert!(seen * whole > 40 && hidden * whole > 40, "{seen} pixels of smoke, behind the mesh {hidden}");
        }
    });
}
