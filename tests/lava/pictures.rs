//! The picture: a closed surface, particles as points, and the goldens.

use std::path::Path;
use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::image::Rgba8;
use fumarole::image::golden::{self, Tolerance};
use fumarole::papers::Paper;
use fumarole::papers::lava::{CAMERAS, Lava, Parameters, Shading};
use glam::{Vec3, Vec4};

use crate::common::gpu_test;
use crate::scene::{clamped, draw, lava, texels};

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
fn meets_the_surface(device: &Arc<Device>, lava: &Lava, parameters: &Parameters) -> Vec<bool> {
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

fn picture(device: &Arc<Device>, parameters: &Parameters) -> Rgba8 {
    let mut lava = lava(device, parameters);
    draw(device, &mut lava, 0);
    let view = lava.picture();
    Rgba8::new(view.width(), view.height(), texels(device, view)).unwrap()
}

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

#[test]
fn the_pictures_are_the_golden_ones() {
    gpu_test(|device| {
        for (name, camera) in CAMERAS {
            let picture = picture(device, &Parameters { camera, ..reduced() });
            let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/lava-{name}.png"));
            if let Err(error) = golden::check(&picture, &golden, TOLERANCE, Path::new(env!("CARGO_TARGET_TMPDIR"))) {
                panic!("{error}");
            }
        }
    });
}

/// Light comes from the hollows: seen from above, low places are brighter than high ones.
#[test]
fn hollows_are_brighter_than_ridges() {
    gpu_test(|device| {
        let parameters = Parameters { camera: CAMERAS[1].1, ..reduced() };
        let shaded = |shading| picture(device, &Parameters { shading, ..parameters.clone() });
        let (lava, heights) = (shaded(Shading::Lava), shaded(Shading::Heights));
        // Low and high places: sums of brightness, and pixels.
        let mut sums = [(0.0, 0u32); 2];
        for (lava, height) in lava.pixels().chunks_exact(4).zip(heights.pixels().chunks_exact(4)) {
            let (brightness, height) = (lava[..3].iter().map(|&c| f64::from(c)).sum::<f64>(), height[0]);
            let place = match height {
                25..115 => 0,
                140..=255 => 1,
                _ => continue,
            };
            sums[place].0 += brightness;
            sums[place].1 += 1;
        }
        let [low, high] = sums.map(|(sum, pixels)| sum / f64::from(pixels));
        assert!(sums.iter().all(|s| s.1 > 500) && low > 1.25 * high, "{low} {high} {sums:?}");
    });
}

/// Figure 5.2: every particle inside the picture leaves a point, and nothing else does.
#[test]
fn particles_are_drawn_as_points() {
    gpu_test(|device| {
        let parameters = Parameters { shading: Shading::Particles, particles: 300, ..reduced() };
        let mut lava = lava(device, &parameters);
        for number in [0, 1] {
            draw(device, &mut lava, number);
            let pixels: Vec<[u8; 4]> = texels(device, lava.picture());
            let camera = &parameters.camera;
            let matrix = camera.projection(parameters.aspect()) * camera.view();
            let (width, height) = (parameters.width as f32, parameters.height as f32);
            let mut expected = vec![false; pixels.len()];
            let mut close_calls = vec![false; pixels.len()];
            for place in clamped(device, &lava, &parameters) {
                let clip = matrix.project_point3(place.as_vec3());
                let (x, y) = ((clip.x + 1.0) / 2.0 * width, (clip.y + 1.0) / 2.0 * height);
                let at = |x: f32, y: f32| {
                    (x >= 0.0 && y >= 0.0 && x < width && y < height)
                        .then(|| y as usize * parameters.width as usize + x as usize)
                };
                if let Some(pixel) = at(x, y) {
                    expected[pixel] = true;
                }
                for (dx, dy) in [(-0.1, -0.1), (0.1, -0.1), (-0.1, 0.1), (0.1, 0.1)] {
                    if let Some(pixel) = at(x + dx, y + dy).filter(|&p| Some(p) != at(x, y)) {
                        close_calls[pixel] = true;
                    }
                }
                let frays = [x, y].iter().any(|c| c.fract() < 0.1 || c.fract() > 0.9);
                if let Some(pixel) = at(x, y).filter(|_| frays) {
                    close_calls[pixel] = true;
                }
            }
            let drawn = expected.iter().filter(|&&e| e).count();
            assert!(drawn > 200, "{drawn}");
            for (i, pixel) in pixels.iter().enumerate().filter(|&(i, _)| !close_calls[i]) {
                assert_eq!(pixel[0] > 0, expected[i], "frame {number}, pixel {i}: {pixel:?}");
            }
        }
    });
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

/// Figure 8.5, its radii times three as the splats here are: the two smallest leave holes, the largest none.
#[test]
fn small_splats_leave_holes() {
    gpu_test(|device| {
        let holes = [0.005625, 0.013125, 0.024375, 0.061875].map(|splat_radius_m| {
            let parameters = Parameters { camera: CAMERAS[3].1, splat_radius_m, ..reduced() };
            let mut lava = lava(device, &parameters);
            draw(device, &mut lava, 0);
            let sums: Vec<[f32; 4]> = texels(device, lava.splatting().accumulated_colors());
            let met = meets_the_surface(device, &lava, &parameters);
            let inside = met.iter().filter(|&&m| m).count();
            let holes = met.iter().zip(&sums).filter(|(met, sums)| **met && sums[3] == 0.0).count();
            holes as f64 / inside as f64
        });
        println!("shares of holes: {holes:?}");
        assert!(holes[0] > 0.5 && holes[1] > 0.1 && holes[2] < holes[1] && holes[3] == 0.0, "{holes:?}");
    });
}
