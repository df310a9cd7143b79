//! The picture: a closed surface, particles as points, and the goldens.

use std::path::Path;
use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::image::Rgba8;
use fumarole::image::golden::{self, Tolerance};
use fumarole::measure::Paper;
use fumarole::papers::lava::{CAMERAS, Lava, Parameters, Shading, Tone};
use fumarole::scene::Camera;
use glam::{Mat4, Vec3};

use super::scene::{clamped, draw, lava, texels};
use crate::common::gpu_test;

/// The preset `results` with a ninth of its splats, each three times as large, and fewer particles.
pub(super) fn reduced() -> Parameters {
    Parameters {
        particles: 10_000,
        splats: [200, 50],
        splat_radius_m: 0.061875,
        width: 200,
        height: 150,
        ..Parameters::default()
    }
}

/// The height field of a frame, as rays from the camera see it.
struct HeightField<'a> {
    parameters: &'a Parameters,
    /// Heights of the columns, row after row.
    heights: Vec<f32>,
    to_world: Mat4,
}

impl<'a> HeightField<'a> {
    fn new(device: &Arc<Device>, lava: &Lava, parameters: &'a Parameters) -> Self {
        let texture: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
        let camera = &parameters.camera;
        let to_world = (camera.projection(parameters.aspect()) * camera.view()).inverse();
        HeightField { parameters, heights: texture.iter().map(|t| t[3]).collect(), to_world }
    }

    fn height_m(&self, x: f32, z: f32) -> f32 {
        let ([columns, _, rows], space) = (self.parameters.density, self.parameters.space_m);
        let (u, v) = (x / space.x * columns as f32 - 0.5, z / space.z * rows as f32 - 0.5);
        let at = |i: f32, k: f32| {
            let i = i.clamp(0.0, columns as f32 - 1.0) as usize;
            self.heights[k.clamp(0.0, rows as f32 - 1.0) as usize * columns as usize + i]
        };
        let (i, k, s, t) = (u.floor(), v.floor(), u - u.floor(), v - v.floor());
        let row = |k: f32| at(i, k) * (1.0 - s) + at(i + 1.0, k) * s;
        row(k) * (1.0 - t) + row(k + 1.0) * t
    }

    /// Intersection of the ray through a pixel with the field from above, by steps of 2 mm through the space.
    fn met(&self, column: u32, row: u32) -> Option<Vec3> {
        let Parameters { width, height, space_m, camera, .. } = self.parameters;
        let x = (column as f32 + 0.5) / *width as f32 * 2.0 - 1.0;
        let y = (row as f32 + 0.5) / *height as f32 * 2.0 - 1.0;
        let ray = (self.to_world.project_point3(Vec3::new(x, y, 0.5)) - camera.eye).normalize();
        let (to_low, to_high) = (-camera.eye / ray, (*space_m - camera.eye) / ray);
        let first = to_low.min(to_high).max_element().max(0.0);
        let last = to_low.max(to_high).min_element();
        let steps = ((last - first) / 0.002).max(0.0) as u32;
        let places = (0..=steps).map(|step| camera.eye + ray * (first + 0.002 * step as f32));
        if last < first {
            return None;
        }
        // Through its side one would look below it.
        let mut was_above = false;
        for place in places {
            let is_above = place.y > self.height_m(place.x, place.z);
            if was_above && !is_above {
                return Some(place);
            }
            was_above |= is_above;
        }
        None
    }

    /// True for a place inside the border, at least a column away from it.
    fn is_inside(&self, place: Vec3) -> bool {
        let margin = self.parameters.border_m + 0.04;
        let from_border = place.min(self.parameters.space_m - place);
        from_border.x > margin && from_border.z > margin
    }

    /// Pixels that meet the field and those of them without weight: inside the border, and on its slope.
    fn holes(&self, device: &Arc<Device>, lava: &Lava) -> [(u32, u32); 2] {
        let sums: Vec<[f32; 4]> = texels(device, &lava.splatting.sums);
        let mut counts = [(0, 0); 2];
        for (at, sums) in (0..).zip(&sums) {
            let Some(place) = self.met(at % self.parameters.width, at / self.parameters.width) else { continue };
            let (met, holes) = &mut counts[usize::from(!self.is_inside(place))];
            *met += 1;
            *holes += u32::from(sums[3] == 0.0);
        }
        counts
    }
}

fn picture(device: &Arc<Device>, parameters: &Parameters) -> Rgba8 {
    let mut lava = lava(device, parameters);
    draw(device, &mut lava, 0);
    let view = lava.picture();
    Rgba8::new(view.width(), view.height(), texels(device, view)).unwrap()
}

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
pub(super) const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

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

/// By default nothing reaches the display's end; clipped, the red of many pixels does.
#[test]
fn nothing_clips_by_default() {
    gpu_test(|device| {
        for (name, camera) in CAMERAS {
            let share = [Tone::Shoulder, Tone::Clip].map(|tone| {
                let picture = picture(device, &Parameters { camera, tone, ..reduced() });
                let lit = || picture.pixels().chunks_exact(4).filter(|pixel| pixel[..3] != [0; 3]);
                lit().filter(|pixel| pixel[..3].contains(&255)).count() as f64 / lit().count() as f64
            });
            assert!(share[0] == 0.0 && share[1] > 0.05, "{name}: {share:?}");
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

/// Both sizes: what is inside the border is closed, and nearly all of the slope.
#[test]
fn the_surface_is_closed_inside_the_border() {
    gpu_test(|device| {
        for parameters in [reduced(), Parameters::default()] {
            for (name, camera) in CAMERAS {
                let parameters = Parameters { camera, ..parameters.clone() };
                let mut lava = lava(device, &parameters);
                draw(device, &mut lava, 0);
                let [inside, slope] = HeightField::new(device, &lava, &parameters).holes(device, &lava);
                println!("{name}, {} splats: {inside:?} inside, {slope:?} on the slope", parameters.splats[0]);
                assert!(inside.0 * 20 > parameters.width * parameters.height, "{name}: {inside:?}");
                assert_eq!(inside.1, 0, "{name}: of {} pixels", inside.0);
                assert!(slope.1 * 1000 < slope.0, "{name}: {slope:?}");
            }
        }
    });
}

/// From low down, where a slope of level splats would be a stair that one looks through.
#[test]
fn the_slope_at_the_border_holds_from_low_down() {
    gpu_test(|device| {
        let low = Camera { eye: Vec3::new(2.0, 0.9, 3.5), target: Vec3::new(2.0, 0.2, 0.5), ..CAMERAS[0].1 };
        let parameters = Parameters { camera: low, splats: [600, 150], splat_radius_m: 0.020625, ..reduced() };
        let mut lava = lava(device, &parameters);
        draw(device, &mut lava, 0);
        let [inside, slope] = HeightField::new(device, &lava, &parameters).holes(device, &lava);
        println!("{inside:?} inside, {slope:?} on the slope");
        assert!(slope.0 > 2000 && slope.1 * 50 < slope.0 && inside.1 == 0, "{inside:?} {slope:?}");
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
            let [(met, holes), _] = HeightField::new(device, &lava, &parameters).holes(device, &lava);
            f64::from(holes) / f64::from(met)
        });
        println!("shares of holes: {holes:?}");
        assert!(holes[0] > 0.5 && holes[1] > 0.1 && holes[2] < holes[1] && holes[3] == 0.0, "{holes:?}");
    });
}
