//! Long marches and long lists: more iterations than a driver lets a shader make.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::gas::model::{DensityFunction, Object, SolidTexture, Volume};
use fumarole::papers::gas::parameters::default_volume;
use fumarole::papers::gas::reference::rays::{Rays, Sampling};
use fumarole::papers::gas::reference::shadow_table::ShadowTables;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, Light, Mesh};
use glam::Vec3;

use super::drawing::Drawing;
use super::march::{FRAME, gases, parameters};
use super::scenes::small;
use crate::common::gpu_test;

/// Largest difference of a drawing from rays in double precision whose gas shadows itself.
fn worst(drawing: &Drawing, parameters: &Parameters, rays: &Rays<'_>, sampling: Sampling) -> f64 {
    let difference = |pixel: u32| {
        let gas = rays.pixel(pixel % parameters.width, pixel / parameters.width, true, sampling);
        assert!(gas.transparency < 0.9, "there is no gas in pixel {pixel}");
        let expected = gas.color + parameters.background.as_dvec3() * gas.transparency;
        (drawing.color(pixel as usize) - expected).abs().max_element()
    };
    (0..parameters.width * parameters.height).map(difference).fold(0.0, f64::max)
}

/// 160 and 400 steps with traced shadows of three lights: thirty million densities a pixel.
#[test]
fn long_marches_are_those_of_their_rays() {
    gpu_test(|device| {
        for (steps, width, height) in [(160, 3, 2), (400, 1, 1)] {
            let mut parameters = Parameters { steps, width, height, ..parameters(vec![gases()[1]]) };
            parameters.camera.vertical_fov_rad = 0.1;
            let drawing = Drawing::of(device, Variant::Traced, &parameters, &[]);
            let rays = Rays::new(&parameters, parameters.scene_frame(0));
            let worst = worst(&drawing, &parameters, &rays, Sampling::Random);
            println!("{steps} steps: {worst:.1e} after {} runs", drawing.runs);
            assert!(worst < 5e-5, "{steps} steps: {worst}");
        }
    });
}

/// Samples at random places of ever shorter steps come ever nearer to the integral, down to rounding, for every number of
/// lights, with the eye outside and inside; with shadows by a table, nearer to that over a table in double precision.
#[test]
fn more_steps_are_never_further_from_the_integral() {
    gpu_test(|device| {
        let texture = SolidTexture { function: DensityFunction::Constant, opaque: 0.8, ..default_volume().texture };
        let gas = Volume { texture, ..default_volume() };
        let all = [
            Light::Parallel { direction: Vec3::new(-0.3, -1.0, -0.45), intensity: Vec3::new(0.9, 0.2, 0.3) },
            Light::Point { position: Vec3::new(3.0, 4.0, 1.0), intensity: Vec3::new(4.0, 18.0, 6.0) },
            Light::Parallel { direction: Vec3::new(1.0, -0.2, 0.1), intensity: Vec3::new(0.2, 0.2, 0.9) },
            Light::Point { position: Vec3::new(-3.0, 2.0, -1.0), intensity: Vec3::new(8.0, 4.0, 6.0) },
        ];
        for (lights, eye) in [(1, 5.0), (2, 0.3), (3, 0.3), (4, 5.0)] {
            let lights = all[..lights].to_vec();
            let mut parameters = Parameters { lights, table_size: 12, ..parameters(vec![gas]) };
            (parameters.width, parameters.height) = (2, 1);
            parameters.camera = Camera { eye: Vec3::new(0.2, 0.1, eye), vertical_fov_rad: 0.2, ..parameters.camera };
            for variant in [Variant::Traced, Variant::Table] {
                comes_nearer_with_its_steps(device, variant, &parameters);
            }
        }
    });
}

fn comes_nearer_with_its_steps(device: &Arc<Device>, variant: Variant, parameters: &Parameters) {
    // 4,000 parts in all: a straight line of constant gas to the light is exact for any step.
    let exact = Parameters { steps: 40, ..parameters.clone() };
    let tables = ShadowTables::new(&exact, exact.scene_frame(0));
    let rays = Rays::new(&exact, exact.scene_frame(0));
    let rays = if variant == Variant::Table { rays.shadowed_by(&tables) } else { rays };
    let name = format!("{variant:?}, {} lights", parameters.lights.len());
    let mut before = f64::INFINITY;
    for steps in [10, 40, 200, 1000] {
        let drawing = Drawing::of(device, variant, &Parameters { steps, ..parameters.clone() }, &[]);
        let error = worst(&drawing, &exact, &rays, Sampling::Fine(100));
        println!("{name}, {steps} steps: {error:.1e} after {} runs", drawing.runs);
        assert!(error < before.max(2e-5), "{name}, {steps} steps: {error} after {before}");
        before = error;
    }
    assert!(before < 2e-5, "{name}: {before}");
}

/// So many sheets across the view, in no order of depth: all almost clear but the farthest, which is opaque.
pub fn sheets(count: usize) -> Vec<Object> {
    let mut random = Random::new(23);
    let mut depths: Vec<f32> = (1..count).map(|_| random.range(3.0, 7.0)).collect();
    depths.insert(count / 3, 8.0);
    let object = |depths: &[f32], opacity: f32| {
        let sheet = |&z: &f32| [(-20.0, -20.0), (40.0, -20.0), (-20.0, 40.0)].map(|(x, y)| Vec3::new(x, y, -z));
        let positions: Vec<Vec3> = depths.iter().flat_map(sheet).collect();
        let mesh = Mesh {
            name: "sheets".to_owned(),
            normals: vec![Vec3::Z; positions.len()],
            indices: (0..positions.len() as u32).collect(),
            positions,
            ..Mesh::default()
        };
        Object { opacity, ..Object::new(mesh, Vec3::splat(0.5)) }
    };
    let (clear, opaque): (Vec<f32>, Vec<f32>) = depths.iter().partition(|&&z| z < 8.0);
    vec![object(&clear, 2e-5), object(&opaque, 1.0)]
}

pub fn view(width: u32) -> Parameters {
    let gas = Volume { center: Vec3::NEG_Z * 5.0, half_extent_m: Vec3::new(9.0, 9.0, 1.0), ..default_volume() };
    let texture = SolidTexture { function: DensityFunction::Constant, ..gas.texture };
    Parameters {
        volumes: vec![Volume { texture, tau_per_m: 0.2, ..gas }],
        camera: Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, near_m: 0.5, ..Parameters::default().camera },
        early_end: 0.0,
        steps: 8,
        width,
        height: 1,
        ..Parameters::default()
    }
}

fn draw_sheets(device: &Arc<Device>, variant: Variant, count: usize) -> Drawing {
    let drawing = Drawing::of(device, variant, &view(3), &sheets(count));
    for list in &drawing.lists {
        assert_eq!(list.len(), count, "{:?} {}", drawing.demand, drawing.runs);
        let key = |f: &fumarole::papers::gas::Fragment| (f.depth_m[0] + f.depth_m[1], f.object, f.triangle);
        assert!(list.windows(2).all(|w| key(&w[0]) < key(&w[1])), "{count} fragments are not in order");
    }
    drawing
}

/// Lists of thousands of fragments are sorted and blended to their end, which is opaque; also with gas between them.
#[test]
fn long_lists_are_opaque_where_their_last_fragment_is() {
    gpu_test(|device| {
        for (variant, count) in
            [(Variant::NoVolume, 1500), (Variant::Table, 1500), (Variant::Traced, 3000), (Variant::NoVolume, 60_000)]
        {
            let drawing = draw_sheets(device, variant, count);
            println!("{variant:?}, {count} fragments: {} runs", drawing.runs);
            for texel in drawing.radiance.chunks_exact(4) {
                assert!(texel[3] > 1.0 - 1e-5, "{variant:?}, {count} fragments: alpha {}", texel[3]);
            }
        }
    });
}

/// One step that takes more iterations than the driver allows is refused, and a device that ends none draws it.
#[test]
fn a_step_that_never_ends_is_refused_by_pass_and_parameter() {
    gpu_test(|device| {
        let parameters = Parameters { steps: 100_000, width: 3, height: 1, first_frame: FRAME, ..view(3) };
        let drawn = Drawing::tried(device, Variant::Traced, &parameters, &[]);
        if device.physical().name.contains("llvmpipe") {
            let error = drawn.err().expect("lavapipe cannot trace so long a ray").to_string();
            for part in ["volume", "`steps`", "3 pixels"] {
                assert!(error.contains(part), "{part}: {error}");
            }
        }
    });
}

/// The densest gas that the options allow is opaque: no power of the turbulence makes of it what is no number.
#[test]
fn gas_of_the_highest_power_has_a_finite_picture() {
    gpu_test(|device| {
        let (scene, objects) = small(Preset::Fig8);
        for variant in [Variant::None, Variant::Table, Variant::Froxel] {
            for density_cache in [None, Some(8)] {
                let mut parameters = Parameters { width: 48, height: 36, density_cache, ..scene.clone() };
                for volume in &mut parameters.volumes {
                    volume.texture.power = 100.0;
                    volume.texture.opaque = 1e6;
                }
                let drawing = Drawing::of(device, variant, &parameters, &objects);
                let unlike = drawing.radiance.iter().filter(|value| !value.is_finite()).count();
                assert_eq!(unlike, 0, "{variant:?}, cache {density_cache:?}");
                let opaque = drawing.radiance.chunks_exact(4).filter(|texel| texel[3] > 0.999).count();
                assert!(opaque > 20, "{variant:?}: {opaque}");
            }
        }
    });
}
