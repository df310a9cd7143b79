//! The finished picture and the cast against rays that are traced in double precision: outlines, pieces that are not
//! there, light where none can be.

use std::path::PathBuf;

use fumarole::measure::study::Study;
use fumarole::papers::caustics::reference::{AIR, WaterVertex, refract};
use fumarole::papers::caustics::setup::Setup;
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant};
use fumarole::scene::{Light, MeshSource};
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::oracle::{Oracle, waves_surface};
use super::scene::{OBLIQUE, OVERHEAD, parameters, teapot};
use super::seen::{first_hit, first_hits, rays};
use crate::common::gpu_test;

/// The receiver in red on a blue floor, by ambient light alone.
fn told_apart(mesh: MeshSource) -> Vec<ReceiverInput> {
    let scene = Setup { meshes: vec![mesh], floor: true, ..Setup::default() }.load().unwrap();
    let albedo = [Vec3::X, Vec3::Z];
    scene.receivers.into_iter().zip(albedo).map(|(input, albedo)| ReceiverInput { albedo, ..input }).collect()
}

fn by_ambient_light(camera_above: bool) -> Parameters {
    let dark = Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO };
    let depth_m = Parameters::default().water_depth_m;
    let camera = if camera_above { Parameters::camera_above(depth_m) } else { Parameters::camera_below(depth_m) };
    Parameters { ambient: Vec3::ONE, camera, samples: 1, width: 200, height: 150, ..parameters(dark) }
}

/// The ray from the eye refracted where it first meets the waves: from where and whereto.
fn under_water(surface: impl Fn(f64, f64) -> WaterVertex, eye: DVec3, ray: DVec3) -> Option<(DVec3, DVec3)> {
    let above = |t: f64| {
        let p = eye + ray * t;
        p.y - surface(p.x, p.z).position.y
    };
    let step = 0.01;
    let first = (1..4000).map(|i| f64::from(i) * step).find(|&t| above(t) <= 0.0)?;
    let (mut low, mut high) = (first - step, first);
    for _ in 0..50 {
        let middle = (low + high) / 2.0;
        if above(middle) > 0.0 { low = middle } else { high = middle }
    }
    let p = eye + ray * high;
    let normal = surface(p.x, p.z).normal;
    Some((p, refract(ray, normal, AIR, f64::from(Parameters::default().refraction_index))?))
}

/// True for the pixels whose middles show the first receiver.
fn traced_mask(parameters: &Parameters, receivers: &[ReceiverInput]) -> Vec<bool> {
    let surface = waves_surface(parameters);
    let eye = parameters.camera.eye.as_dvec3();
    rays(parameters)
        .map(|ray| {
            let found = if parameters.is_seen_from_above() {
                under_water(&surface, eye, ray).and_then(|(from, ray)| first_hit(receivers, from, ray))
            } else {
                first_hit(receivers, eye, ray)
            };
            found.is_some_and(|(index, _)| index == 0)
        })
        .collect()
}

/// The pieces of a mask that hang together along sides or corners and have at least `least` pixels.
fn pieces(mask: &[bool], width: usize, least: usize) -> usize {
    let mut left = mask.to_vec();
    let mut count = 0;
    while let Some(start) = left.iter().position(|&is_set| is_set) {
        let (mut stack, mut size) = (vec![start], 0);
        left[start] = false;
        while let Some(at) = stack.pop() {
            size += 1;
            let (x, y) = ((at % width) as i64, (at / width) as i64);
            for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
                let (x, y) = (x + dx, y + dy);
                if x < 0 || y < 0 || x as usize >= width || y as usize >= mask.len() / width {
                    continue;
                }
                let next = y as usize * width + x as usize;
                if std::mem::take(&mut left[next]) {
                    stack.push(next);
                }
            }
        }
        count += usize::from(size >= least);
    }
    count
}

#[test]
fn the_picture_shows_what_rays_meet_and_nothing_beside_it() {
    gpu_test(|device| {
        let bunny = MeshSource::File(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj")));
        for (mesh, above) in [(bunny.clone(), true), (MeshSource::Teapot, true), (bunny, false)] {
            let receivers = told_apart(mesh);
            let parameters = by_ambient_light(above);
            let expected = traced_mask(&parameters, &receivers);
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &receivers);
            let found: Vec<bool> = drawing.picture.pixels().chunks_exact(4).map(|p| p[0] > p[2]).collect();
            let shown = expected.iter().filter(|&&is_set| is_set).count();
            let off = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
            let width = parameters.width as usize;
            let [islands, truth] = [&found, &expected].map(|mask| pieces(mask, width, 2));
            let name = &receivers[0].mesh.name;
            println!("{name}, above {above}: {off} pixels off of {shown}, {islands} pieces instead of {truth}");
            assert!(shown > 1500, "{name}: {shown}");
            // 99 % of what is shown agrees, not of the picture, most of which is floor.
            assert!(off * 100 <= shown, "{name}, above {above}: {off} of {shown}");
            assert_eq!(islands, truth, "{name}, above {above}");
        }
    });
}

/// A pixel at an outline is neither of both sides, by so much as each of them fills of it.
#[test]
fn an_outline_has_steps_between() {
    gpu_test(|device| {
        let receivers = told_apart(MeshSource::Sphere);
        for above in [false, true] {
            let steps = |samples| {
                let parameters = Parameters { samples, ..by_ambient_light(above) };
                let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &receivers);
                let between = drawing.picture.pixels().chunks_exact(4).filter(|p| p[0].min(p[2]) > 120);
                between.count()
            };
            let (one, four) = (steps(1), steps(4));
            println!("above {above}: {one} mixed pixels with a sample, {four} with four");
            assert!(one <= 5 && four >= 60, "above {above}: {one} {four}");
        }
    });
}

/// Surfaces in their own shadow have ambient light alone, but for those within a texel or two of light.
#[test]
fn no_light_leaks_into_shadow() {
    gpu_test(|device| {
        let bunny = MeshSource::File(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/meshes/bunny.obj")));
        let bunny = told_apart(bunny).swap_remove(0);
        for (light, receiver) in [(OVERHEAD, bunny.clone()), (OBLIQUE, bunny), (OBLIQUE, teapot())] {
            let receivers = [receiver];
            let parameters = Parameters { width: 160, height: 120, ..parameters(light) };
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &receivers);
            let v = Oracle::of(&parameters, &light, &receivers[0], &drawing.grid).receiver.v;
            let margin_m = 3.0 * 2.0 / f64::from(parameters.map_size);
            let colors = drawing.target("underwater-color").chunks_exact(4).map(Vec3::from_slice);
            let (mut dark, mut leaks, mut bright, mut missed) = (0, 0, 0, 0);
            for (surface, color) in first_hits(&parameters, &receivers).into_iter().zip(colors) {
                let Some(surface) = surface else { continue };
                // In shadow with all that is near it, by something that stands clear of it.
                let sideways = v.any_orthonormal_pair();
                let places = [DVec3::ZERO, sideways.0, sideways.1, -sideways.0, -sideways.1];
                let shaded = |&&aside: &&DVec3| {
                    let from = surface.position + (aside + v * 2.0) * margin_m;
                    first_hit(&receivers, from, v).is_some()
                };
                let in_shadow = places.iter().filter(shaded).count();
                let lit = (color - receivers[0].albedo * parameters.ambient).max_element();
                if in_shadow == places.len() {
                    dark += 1;
                    leaks += u32::from(lit > 0.03);
                } else if in_shadow == 0 && surface.normal.dot(v) > 0.4 {
                    bright += 1;
                    missed += u32::from(lit < 0.05);
                }
            }
            println!(
                "{} under {light:?}: {leaks} of {dark} pixels in shadow are lit, {missed} of {bright} in light are not",
                receivers[0].mesh.name
            );
            assert!(dark > 30, "{}: {dark}", receivers[0].mesh.name);
            assert!(leaks * 200 <= dark, "{}: {leaks} of {dark}", receivers[0].mesh.name);
            assert!(bright > 500 && missed * 200 <= bright, "{}: {missed} of {bright}", receivers[0].mesh.name);
        }
    });
}
