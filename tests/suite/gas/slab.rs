//! Boxes of constant density against closed forms.

use std::f64::consts::PI;
use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::gas::model::{DensityFunction, HenyeyGreenstein, Object, SolidTexture, Volume};
use fumarole::papers::gas::parameters::{DEFAULT_PHASE, default_volume};
use fumarole::papers::gas::reference::phase::phase;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::{Camera, Light, shapes};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use crate::common::gpu_test;

const WIDTH: u32 = 30;
const HEIGHT: u32 = 20;

/// Looks along -Z at a box from z = -1 to 1 that fills the picture.
fn parameters(density: f32) -> Parameters {
    let texture = SolidTexture { function: DensityFunction::Constant, opaque: density, ..default_volume().texture };
    Parameters {
        volumes: vec![Volume { half_extent_m: Vec3::new(9.0, 9.0, 1.0), texture, tau_per_m: 0.7, ..default_volume() }],
        lights: vec![Light::Parallel { direction: Vec3::new(-0.3, -1.0, -0.4), intensity: Vec3::ONE }],
        ambient: Vec3::ZERO,
        background: Vec3::ONE,
        camera: Camera { eye: Vec3::Z * 5.0, target: Vec3::ZERO, ..Parameters::default().camera },
        early_end: 0.0,
        steps: 16,
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

/// A pane across the view at depth z, white, opaque or not.
fn pane(z_m: f32, opacity: f32) -> Object {
    let turn = Mat4::from_translation(Vec3::Z * z_m) * Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let mesh = shapes::plane(Vec2::splat(30.0), UVec2::ONE).transformed(&turn);
    Object { opacity, ..Object::new(mesh, Vec3::ZERO) }
}

/// The ray of a pixel, of depth 1.
fn ray(parameters: &Parameters, pixel: usize) -> DVec3 {
    let pixel_size = (f64::from(parameters.camera.vertical_fov_rad) / 2.0).tan() / (f64::from(HEIGHT) / 2.0);
    let x = (pixel as u32 % WIDTH) as f64 + 0.5 - f64::from(WIDTH) / 2.0;
    let y = (pixel as u32 / WIDTH) as f64 + 0.5 - f64::from(HEIGHT) / 2.0;
    DVec3::new(x * pixel_size, -y * pixel_size, -1.0)
}

/// Transmittance of the whole box, and the gas's brightness at transmittance 0, in one pixel.
fn closed_form(parameters: &Parameters, pixel: usize) -> (f64, f64) {
    let volume = parameters.volumes[0];
    let ray = ray(parameters, pixel);
    let depth = f64::from(volume.tau_per_m) * f64::from(volume.texture.opaque) * 2.0 * ray.length();
    let Light::Parallel { direction, .. } = parameters.lights[0] else { unreachable!() };
    let cosine = (-direction.as_dvec3().normalize()).dot(ray.normalize());
    ((-depth).exp(), 0.3 * PI * phase(&DEFAULT_PHASE, cosine))
}

fn draw(device: &Arc<Device>, parameters: &Parameters, objects: &[Object]) -> Drawing {
    Drawing::of(device, Variant::None, parameters, objects)
}

#[test]
fn opacity_and_brightness_are_exact_for_every_step_and_section() {
    gpu_test(|device| {
        for (steps, panes) in [(16, 0), (7, 0), (100, 0), (16, 1), (16, 4)] {
            let parameters = Parameters { steps, ..parameters(1.0) };
            // Panes of almost no opacity cut the gas into sections.
            let panes: Vec<Object> = (0..panes).map(|i| pane(-0.71 + 0.4 * i as f32, 1.6e-5)).collect();
            let drawing = draw(device, &parameters, &panes);
            // On the panes' diagonals there are two triangles a pane.
            assert!(drawing.lists.iter().all(|l| (panes.len()..=2 * panes.len()).contains(&l.len())));
            for pixel in 0..(WIDTH * HEIGHT) as usize {
                let (passed, brightness) = closed_form(&parameters, pixel);
                let expected = passed + brightness * (1.0 - passed);
                let found = drawing.red(pixel);
                let slack = 1e-4 + 2e-5 * panes.len() as f64;
                assert!((found - expected).abs() < slack, "{steps}, {}: {found} for {expected}", panes.len());
            }
        }
    });
}

#[test]
fn a_pane_in_front_inside_and_behind_is_composited() {
    gpu_test(|device| {
        let opacity = 0.4;
        for (z_m, share_before) in [(2.0, 0.0), (0.3, 0.35), (-3.0, 1.0)] {
            let parameters = parameters(1.0);
            let drawing = draw(device, &parameters, &[pane(z_m, opacity)]);
            for pixel in 0..(WIDTH * HEIGHT) as usize {
                let (passed, brightness) = closed_form(&parameters, pixel);
                let before = passed.powf(share_before);
                let after = passed.powf(1.0 - share_before);
                let glass = 1.0 - f64::from(opacity);
                let expected = brightness * (1.0 - before) + before * glass * (brightness * (1.0 - after) + after);
                assert!((drawing.red(pixel) - expected).abs() < 2e-4, "{z_m}: {} for {expected}", drawing.red(pixel));
            }
        }
    });
}

/// An opaque pane that covers a part of a pixel, within the gas: the rest of the pixel shows the gas behind it.
#[test]
fn gas_goes_on_behind_what_covers_a_part_of_the_pixel() {
    gpu_test(|device| {
        let parameters = parameters(1.0);
        // Its border crosses the picture aslant; share of the gas before it 0.35.
        let turn = Mat4::from_translation(Vec3::new(0.0, 0.0, 0.3)) * Mat4::from_rotation_z(0.3);
        let mut half = pane(0.0, 1.0);
        half.mesh = half.mesh.transformed(&(turn * Mat4::from_translation(Vec3::X * 15.0)));
        let drawing = draw(device, &parameters, &[half]);
        let mut partial = 0;
        for (pixel, list) in drawing.lists.iter().enumerate() {
            let open_at = |bit: u32| -> f64 {
                list.iter().filter(|f| f.mask >> bit & 1 == 1).map(|f| 1.0 - f64::from(f.opacity)).product()
            };
            let open = (0..32).map(open_at).sum::<f64>() / 32.0;
            partial += usize::from(open > 0.0 && open < 1.0);
            let (passed, brightness) = closed_form(&parameters, pixel);
            let (before, after) = (passed.powf(0.35), passed.powf(0.65));
            let expected = brightness * (1.0 - before) + before * open * (brightness * (1.0 - after) + after);
            assert!((drawing.red(pixel) - expected).abs() < 2e-4, "{} for {expected}", drawing.red(pixel));
        }
        assert!(partial > 15, "{partial} partly covered pixels");
    });
}

/// The tracing begins at the farther of hither plane and entry, and ends at the nearer of yon plane and exit; the eye
/// may stand in the gas.
#[test]
fn gas_is_traced_between_the_hither_and_the_yon_plane() {
    gpu_test(|device| {
        for (eye_z_m, near_m, far_m, thickness_m) in [
            (5.0, 4.5, 99.0, 1.5),
            (5.0, 0.1, 5.2, 1.2),
            (5.0, 4.4, 4.9, 0.5),
            (0.3, 0.1, 99.0, 1.2),
            (5.0, 6.5, 99.0, 0.0),
        ] {
            let mut parameters = parameters(1.0);
            parameters.camera =
                Camera { eye: Vec3::Z * eye_z_m, target: Vec3::NEG_Z * 9.0, near_m, far_m, ..parameters.camera };
            let drawing = draw(device, &parameters, &[]);
            for pixel in 0..(WIDTH * HEIGHT) as usize {
                let (passed, brightness) = closed_form(&parameters, pixel);
                let passed = passed.powf(thickness_m / 2.0);
                let expected = passed + brightness * (1.0 - passed);
                assert!((drawing.red(pixel) - expected).abs() < 1e-4, "{near_m} to {far_m}, {}", drawing.red(pixel));
            }
        }
    });
}

/// The early end looks at all sections together: none of these, an increment each, is so opaque alone.
#[test]
fn the_tracing_ends_by_the_transparency_of_all_sections() {
    gpu_test(|device| {
        let parameters = Parameters { early_end: 0.6, ..parameters(1.0) };
        let panes: Vec<Object> = (0..4).map(|i| pane(-0.71 + 0.4 * i as f32, 1.6e-5)).collect();
        let drawing = draw(device, &parameters, &panes);
        for (pixel, texel) in drawing.radiance.chunks_exact(4).enumerate() {
            // At z = 0.49 more than 0.6 is left, at 0.09 less: the second section is the last.
            let (whole, _) = closed_form(&parameters, pixel);
            let (passed, expected) = (1.0 - f64::from(texel[3]), whole.powf(0.91 / 2.0));
            assert!((passed - expected).abs() < 1e-3, "{passed} for {expected}");
        }
    });
}

#[test]
fn a_solid_slab_follows_its_formula() {
    gpu_test(|device| {
        let mut parameters = parameters(0.3);
        parameters.volumes[0].is_solid = true;
        parameters.volumes[0].albedo = Vec3::ZERO;
        let drawing = draw(device, &parameters, &[]);
        for pixel in 0..(WIDTH * HEIGHT) as usize {
            let length = 2.0 * ray(&parameters, pixel).length();
            let expected = (1.0 - f64::from(0.3_f32)).powf(f64::from(0.7_f32) * length);
            assert!((drawing.red(pixel) - expected).abs() < 1e-4);
        }
    });
}

#[test]
fn gases_that_overlap_add_up() {
    gpu_test(|device| {
        let once = draw(device, &parameters(1.0), &[]);
        let mut halves = parameters(0.5);
        halves.volumes.push(halves.volumes[0]);
        let twice = draw(device, &halves, &[]);
        for (a, b) in once.radiance.iter().zip(&twice.radiance) {
            assert!((a - b).abs() < 1e-5);
        }
    });
}

#[test]
fn no_density_is_no_volume_bit_for_bit() {
    gpu_test(|device| {
        let objects = [pane(0.4, 0.5), Object::new(shapes::teapot(), Vec3::new(0.8, 0.5, 0.2))];
        let parameters = parameters(0.0);
        let without = Drawing::of(device, Variant::NoVolume, &parameters, &objects);
        for variant in [Variant::None, Variant::Surfaces, Variant::Traced, Variant::Table, Variant::Froxel] {
            let with = Drawing::of(device, variant, &parameters, &objects);
            assert!(with.demand.sections > 0 && with.radiance == without.radiance, "{variant:?}");
        }
    });
}

#[test]
fn nothing_is_evaluated_behind_an_opaque_wall() {
    gpu_test(|device| {
        let parameters = Parameters { steps: 90, ..parameters(1.0) };
        let drawing = draw(device, &parameters, &[pane(2.0, 1.0)]);
        assert_eq!((drawing.demand.sections, drawing.evaluations), (0, 0));
        assert!(drawing.radiance.chunks_exact(4).all(|p| p[3] == 1.0));
        // One evaluation an increment of 0.2 m, as far as the wall.
        for (wall_z_m, thickness_m) in [(-3.0, 2.0), (0.1, 0.9)] {
            let drawing = draw(device, &parameters, &[pane(wall_z_m, 1.0)]);
            let increments = |pixel| (thickness_m * ray(&parameters, pixel).length() / 0.2).ceil() as u64;
            let expected: u64 = (0..(WIDTH * HEIGHT) as usize).map(increments).sum();
            assert!(drawing.evaluations.abs_diff(expected) * 100 <= expected, "{} for {expected}", drawing.evaluations);
        }
    });
}

/// g > 0 scatters forwards: gas between the eye and the light is brighter than gas with the light behind the eye.
#[test]
fn gas_before_the_light_is_brighter_where_g_is_positive() {
    gpu_test(|device| {
        let lit = |towards_z: f32, g: f32| {
            let mut parameters = parameters(1.0);
            parameters.background = Vec3::ZERO;
            let direction = Vec3::new(0.0, 0.0, towards_z);
            parameters.lights = vec![Light::Parallel { direction, intensity: Vec3::ONE }];
            parameters.volumes[0].phase =
                [HenyeyGreenstein { weight: 1.0, g }, HenyeyGreenstein { weight: 0.0, g: 0.0 }];
            draw(device, &parameters, &[]).red((WIDTH * HEIGHT / 2 + WIDTH / 2) as usize)
        };
        for g in [-0.6_f64, 0.0, 0.5] {
            // The two directions' ratio in the middle of the picture: ((1 + g) / (1 - g))^3.
            let ratio = lit(1.0, g as f32) / lit(-1.0, g as f32);
            let expected = ((1.0 + g) / (1.0 - g)).powi(3);
            assert!((ratio / expected - 1.0).abs() < 0.01, "{g}: {ratio} for {expected}");
        }
    });
}
