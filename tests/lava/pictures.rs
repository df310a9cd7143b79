//! The picture: a closed surface, and the golden.

use fumarole::gpu::Device;
use fumarole::papers::lava::{CAMERAS, Parameters};
use glam::{Vec3, Vec4};
use std::sync::Arc;

use crate::common::gpu_test;
use crate::scene::{draw, lava, texels};

/// The preset `results` with a ninth of its splats, each three times as large, and fewer particles.
fn reduced() -> Parameters {
    Parameters {
        particles: 10_000,
        splats: [200, 50],
        splat_radius_m: 0.061875,
        width: 200,
        height: 150,
        ..Parameters::default()
    }
}

/// Whether the ray through each pixel meets the height field inside the border, at least a texel away from it.
fn meets_the_surface(device: &Arc<Device>, lava: &fumarole::papers::lava::Lava, parameters: &Parameters) -> Vec<bool> {
    let field: Vec<[f32; 4]> = texels(device, lava.isosurface().normal_height());
    let [columns, _, rows] = parameters.density;
    let space = parameters.space_m;
    let height_at = |x: f32, z: f32| {
        let (u, v) = (x / space.x * columns as f32 - 0.5, z / space.z * rows as f32 - 0.5);
        let at = |i: f32, k: f32| {
            let i = i.clamp(0.0, columns as f32 - 1.0) as usize;
            field[k.clamp(0.0, rows as f32 - 1.0) as usize * columns as usize + i][3]
        };
        let (i, k, s, t) = (u.floor(), v.floor(), u - u.floor(), v - v.floor());
        let row = |k: f32| at(i, k) * (1.0 - s) + at(i + 1.0, k) * s;
        row(k) * (1.0 - t) + row(k + 1.0) * t
    };
    let camera = &parameters.camera;
    let to_world = (camera.projection(parameters.aspect()) * camera.view()).inverse();
    let pixels = (0..parameters.height).flat_map(|row| (0..parameters.width).map(move |column| (column, row)));
    let met = |(column, row): (u32, u32)| {
        let x = (column as f32 + 0.5) / parameters.width as f32 * 2.0 - 1.0;
        let y = (row as f32 + 0.5) / parameters.height as f32 * 2.0 - 1.0;
        let through: Vec4 = to_world * Vec4::new(x, y, 0.5, 1.0);
        let ray = (through.truncate() / through.w - camera.eye).normalize();
        // Steps of 2 mm from the top of the space down to its ground.
        let first = ((space.y - camera.eye.y) / ray.y).max(0.0);
        for step in 0..10_000 {
            let place: Vec3 = camera.eye + ray * (first + 0.002 * step as f32);
            if place.y < 0.0 || ray.y >= 0.0 {
                return false;
            }
            let is_over = place.x >= 0.0 && place.x <= space.x && place.z >= 0.0 && place.z <= space.z;
            if is_over && place.y <= height_at(place.x, place.z) {
                let margin = parameters.border_m + 0.04;
                return place.x > margin
                    && place.x < space.x - margin
                    && place.z > margin
                    && place.z < space.z - margin;
            }
        }
        false
    };
    pixels.map(met).collect()
}

#[test]
fn the_surface_is_closed_inside_the_border() {
    gpu_test(|device| {
        for (name, camera) in CAMERAS {
            let parameters = Parameters { camera, ..reduced() };
            let mut lava = lava(device, &parameters);
            draw(device, &mut lava, 0);
            let sums: Vec<[f32; 4]> = texels(device, lava.splatting().accumulated_colors());
            let met = meets_the_surface(device, &lava, &parameters);
            let inside = met.iter().filter(|&&m| m).count();
            let holes = met.iter().zip(&sums).filter(|(met, sums)| **met && sums[3] == 0.0).count();
            println!("{name}: {inside} pixels meet the surface inside the border, {holes} holes");
            assert!(inside > 1500, "{name}: {inside}");
            assert_eq!(holes, 0, "{name}: of {inside} pixels");
        }
    });
}
