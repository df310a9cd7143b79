//! Rays against the height field, pixel by pixel, beside the oracle's.

use fumarole::gpu::Compiler;
use fumarole::measure::Paper;
use fumarole::papers::lava::{Lava, Parameters, Particles, Rock, Shading, SurfaceDraw, Variant, depth_range_m};
use fumarole::scene::{Camera, shapes};
use glam::{DVec3, Mat4, Vec3};

use super::scene::{draw, parameters, texels};
use super::splatting::{low_camera, ridge, stage};
use crate::common::{gpu_test, shaders_by};

/// Direction of the ray through a pixel's middle, its length along the view 1.
pub(super) fn direction(parameters: &Parameters, at: usize) -> DVec3 {
    let (width, height) = (parameters.width as usize, parameters.height as usize);
    let camera = &parameters.camera;
    let forward = (camera.target - camera.eye).as_dvec3().normalize();
    let right = forward.cross(camera.up.as_dvec3()).normalize();
    let up = right.cross(forward);
    let half = (0.5 * f64::from(camera.vertical_fov_rad)).tan();
    let across = (((at % width) as f64 + 0.5) / width as f64 * 2.0 - 1.0) * half * width as f64 / height as f64;
    let above = 1.0 - ((at / width) as f64 + 0.5) / height as f64 * 2.0;
    forward + right * across + up * (above * half)
}

#[test]
fn rays_meet_the_height_field_where_the_oracle_s_do() {
    gpu_test(|device| {
        let view = |eye: [f32; 3], target: [f32; 3]| Camera {
            eye: Vec3::from_array(eye),
            target: Vec3::from_array(target),
            ..low_camera()
        };
        let cameras = [
            ("low", low_camera()),
            ("above the sheet, in the space", view([0.2, 0.9, 0.2], [1.8, 0.2, 0.9])),
            ("in the lava", view([1.0, 0.2, 0.1], [1.2, 0.1, 1.2])),
            ("below", view([0.9, -1.5, 0.7], [1.0, 0.0, 0.6])),
            ("straight down", view([1.0, 3.0, 0.6], [1.0, 0.0, 0.6])),
            ("far", view([9.0, 6.0, 9.0], [1.0, 0.2, 0.6])),
        ];
        for (name, camera) in cameras {
            let parameters = Parameters {
                shading: Shading::Heights,
                surface_draw: Some(SurfaceDraw::March),
                camera,
                width: 96,
                height: 72,
                ..parameters()
            };
            let surface = ridge(&parameters);
            let stage = stage(device, &parameters, &surface, Rock::built_in());
            let sums: Vec<[f32; 4]> = texels(device, &stage.sums);
            let depths: Vec<f32> = texels(device, &stage.depth);
            let range_m = f64::from(depth_range_m(&parameters));
            let (eye, near, far) = (camera.eye.as_dvec3(), f64::from(camera.near_m), f64::from(camera.far_m));
            let (mut met, mut off) = (0, 0);
            for (at, (sums, depth)) in sums.iter().zip(&depths).enumerate() {
                let ray = if name == "straight down" {
                    // The camera's up is the picture's -z.
                    let from = Camera { up: Vec3::NEG_Z, ..camera };
                    direction(&Parameters { camera: from, ..parameters.clone() }, at)
                } else {
                    direction(&parameters, at)
                };
                let expected = surface.cast(eye, ray, [near, far]);
                let found = (sums[3] > 0.0).then(|| f64::from(*depth) * range_m - f64::from(parameters.epsilon_m));
                met += u32::from(expected.is_some());
                let is_same = match (found, expected) {
                    (Some(found), Some(expected)) => {
                        let height = (eye + ray * expected).y / surface.space.y;
                        (found - expected).abs() < 1e-3 && (f64::from(sums[0]) - height).abs() < 1e-3
                    }
                    (None, None) => true,
                    _ => false,
                };
                // Where a ray grazes the sheet or an edge, rounding decides.
                off += u32::from(!is_same);
            }
            println!("{name}: {met} rays meet it, {off} are off");
            assert!(met > 80 && off * 200 <= met, "{name}: {met} {off}");
        }
    });
}

/// By the depths that `march` writes, objects and lava hide each other; no particle, no bordering column is needed.
#[test]
fn objects_mix_with_a_marched_surface() {
    gpu_test(|device| {
        for compiler in [Compiler::Glslang, Compiler::Naga] {
            let parameters = Parameters {
                surface_draw: Some(SurfaceDraw::March),
                border_m: 0.0,
                geometry_stage: false,
                ..parameters()
            };
            let (center, radius) = (Vec3::new(0.8, 0.45, 0.6), 0.3);
            let sphere = shapes::sphere(96, 96);
            let scale = 2.0 * radius / sphere.bounds().diagonal().max_element();
            let ball = sphere.transformed(&(Mat4::from_translation(center) * Mat4::from_scale(Vec3::splat(scale))));
            let shaders = shaders_by(device, compiler);
            let picture = |objects: &[_]| {
                let particles = Particles::seeded(&parameters);
                let mut lava =
                    Lava::new(&shaders, "test", Variant::Paper, &parameters, &particles, Rock::built_in(), objects)
                        .unwrap();
                draw(device, &mut lava, 0);
                let depths: Vec<f32> = texels(device, &lava.splatting.depth);
                (texels::<[u8; 4]>(device, lava.picture()), depths)
            };
            let (alone, depths) = picture(&[]);
            let (with, _) = picture(&[ball]);
            let range_m = f64::from(depth_range_m(&parameters));
            let eye = parameters.camera.eye.as_dvec3();
            let (mut seen, mut hidden) = (0, 0);
            for (at, (alone, with)) in alone.iter().zip(&with).enumerate() {
                let ray = direction(&parameters, at);
                let to = center.as_dvec3() - eye;
                let middle = ray.dot(to) / ray.length_squared();
                let aside = (ray * middle - to).length();
                if (aside - f64::from(radius)).abs() < 0.01 {
                    continue;
                }
                let half = (f64::from(radius).powi(2) - aside * aside).max(0.0).sqrt() / ray.length();
                let to_lava = f64::from(depths[at]) * range_m - f64::from(parameters.epsilon_m);
                let before = to_lava - (middle - half);
                if aside > f64::from(radius) || before < -0.02 {
                    assert_eq!(with, alone, "pixel {at}");
                    hidden += u32::from(aside < f64::from(radius));
                } else if before > 0.02 {
                    assert_ne!(with, alone, "pixel {at}");
                    seen += 1;
                }
            }
            assert!(seen > 50 && hidden > 20, "{compiler:?}: {seen} {hidden}");
        }
    });
}
