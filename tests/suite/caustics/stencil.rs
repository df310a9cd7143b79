//! The stencil method: what is seen, which volumes light it, and how brightly.

use std::slice::from_ref;

use fumarole::image::compare;
use fumarole::papers::caustics::reference::flat_water_intensity;
use fumarole::papers::caustics::{Parameters, Variant, WaveParameters};
use fumarole::scene::{Camera, Light};
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::oracle::Oracle;
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, bowl, floor, parameters, sphere, teapot};
use super::seen::{Surface, first_hits};
use super::volumes::light_at;
use crate::common::gpu_test;

/// Relative error of a colour that was stored as a half float and added to.
const HALF_FLOATS: f64 = 2e-3;

/// Waves that do not focus above the floor.
const GENTLE: WaveParameters = WaveParameters { count: 6, amplitude_m: 0.038, wavelength_m: 3.0 };

/// Rounding of positions in single precision moves a volume's side by less than this.
const BAND_M: f64 = 1e-4;

/// Light that leaves a part of the bowl in the shadow of its rim.
const LOW: Light = Light::Parallel { direction: Vec3::new(1.0, -0.5, 0.0), intensity: Vec3::ONE };

/// A camera from which the floor fills most of the picture.
fn close_camera() -> Camera {
    Camera {
        eye: Vec3::new(-0.5, -0.9, 1.9),
        target: Vec3::new(0.0, -2.9, 0.0),
        vertical_fov_rad: 0.7,
        ..parameters(OVERHEAD).camera
    }
}

/// Values that the device found in the pixels that show a receiver: the surface, and the light on it but for the
/// ambient light.
fn lit_surfaces(drawing: &Drawing, ambient: Vec3) -> Vec<(Surface, DVec3)> {
    surfaces_with_light(drawing, drawing, ambient)
}

/// The same with the surfaces of one drawing and the light of another of the same view.
fn surfaces_with_light(surfaces: &Drawing, lit: &Drawing, ambient: Vec3) -> Vec<(Surface, DVec3)> {
    let colors = lit.target("underwater-color").chunks_exact(4).map(Vec3::from_slice);
    let texels = |name: &str| surfaces.target(name).chunks_exact(4).map(|t| (Vec3::from_slice(t), t[3]));
    let surfaces = texels("surface-position").zip(texels("surface-normal")).zip(texels("surface-albedo"));
    colors
        .zip(surfaces)
        .filter(|(_, ((position, _), _))| position.1 == 1.0)
        .map(|(color, (((position, _), (normal, _)), (albedo, _)))| {
            let [position, normal, albedo] = [position, normal, albedo].map(|v| v.as_dvec3());
            let light = color.as_dvec3() - ambient.as_dvec3() * albedo;
            (Surface { position, normal, albedo }, light)
        })
        .collect()
}

/// Largest error of `found` as a fraction of the whole colour.
fn error_of(found: DVec3, expected: DVec3, surface: &Surface, ambient: Vec3) -> f64 {
    let color = expected + ambient.as_dvec3() * surface.albedo;
    ((found - expected).abs() / color.max(DVec3::splat(1e-2))).max_element()
}

#[test]
fn the_surface_is_what_the_cameras_rays_hit_first() {
    gpu_test(|device| {
        let parameters = parameters(OVERHEAD);
        let receivers = [teapot(), sphere(), floor()];
        let drawing = Drawing::of(device, Variant::Stencil, &parameters, &receivers);
        let texels = |name: &str| drawing.target(name).chunks_exact(4).map(|t| Vec3::from_slice(t).as_dvec3());
        let surfaces = texels("surface-position").zip(texels("surface-normal")).zip(texels("surface-albedo"));
        let expected = first_hits(&parameters, &receivers);
        let (mut off, mut hits) = (0, 0);
        for (expected, ((position, normal), albedo)) in expected.iter().zip(surfaces) {
            let is_near = match expected {
                None => position == DVec3::ZERO && albedo == DVec3::ZERO,
                Some(hit) => {
                    position.distance(hit.position) < 2e-3
                        && normal.distance(hit.normal) < 1e-2
                        && albedo.distance(hit.albedo) < 1e-3
                }
            };
            hits += u32::from(expected.is_some());
            off += u32::from(!is_near);
        }
        // Outlines, where a corner snapped to a fraction of a pixel decides.
        println!("{off} of {hits} pixels differ");
        assert!(hits > 1000 && off * 100 <= hits, "{off} of {hits}");
    });
}

/// Beyond the foci of strong waves, too, where volumes fold over and many light one pixel.
#[test]
fn every_pixel_has_the_light_of_the_volumes_around_it() {
    gpu_test(|device| {
        let strong = parameters(OVERHEAD).waves;
        let cases = [
            (OVERHEAD, GENTLE, floor(), close_camera()),
            (OBLIQUE, GENTLE, floor(), close_camera()),
            (OVERHEAD, GENTLE, sphere(), parameters(OVERHEAD).camera),
            (POINT, GENTLE, sphere(), parameters(OVERHEAD).camera),
            (OBLIQUE, strong, floor(), close_camera()),
            (OVERHEAD, strong, sphere(), parameters(OVERHEAD).camera),
        ];
        for (light, waves, receiver, camera) in cases {
            let parameters = Parameters { waves, camera, ..parameters(light) };
            let drawing = Drawing::of(device, Variant::Stencil, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let (mut lit, mut excluded, mut worst) = (0, 0, 0.0f64);
            for (surface, found) in lit_surfaces(&drawing, parameters.ambient) {
                let diffuse = surface.diffuse(oracle.receiver.v);
                let sum = light_at(&oracle, oracle.receiver.to_box(surface.position), BAND_M);
                lit += u32::from(diffuse != DVec3::ZERO);
                if sum.is_at_side && diffuse != DVec3::ZERO {
                    excluded += 1;
                    continue;
                }
                worst = worst.max(error_of(found, diffuse * sum.intensity, &surface, parameters.ambient));
            }
            let excluded = 100.0 * f64::from(excluded) / f64::from(lit);
            let case = format!("{} under {light:?}, waves of {} m", receiver.mesh.name, waves.amplitude_m);
            println!("{case}: {lit} pixels, {excluded:.2} % excluded, the others off by {worst:.1e} at most");
            assert!(lit > 1000 && excluded <= 2.0, "{case}: {excluded} % of {lit} pixels excluded");
            assert!(worst <= HALF_FLOATS, "{case}: off by {worst}");
        }
    });
}

/// Under flat and clear water I_c is one number everywhere: a pixel that two volumes light would have it twice, one
/// that no volume lights would be dark.
#[test]
fn flat_clear_water_lights_every_pixel_alike_and_once() {
    gpu_test(|device| {
        for (light, receiver) in
            [OVERHEAD, OBLIQUE].into_iter().flat_map(|l| [floor(), sphere(), bowl()].map(|r| (l, r)))
        {
            let camera =
                if receiver.mesh.name == floor().mesh.name { close_camera() } else { parameters(light).camera };
            let parameters = Parameters { waves: FLAT, absorption_per_m: 0.0, camera, ..parameters(light) };
            let drawing = Drawing::of(device, Variant::Stencil, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let direction = oracle.light.direction_at(DVec3::ZERO);
            let everywhere = flat_water_intensity(direction, oracle.medium, 0.0).unwrap();
            let surfaces = lit_surfaces(&drawing, parameters.ambient);
            assert!(surfaces.len() > 1000, "{}", surfaces.len());
            let off = surfaces.iter().filter(|(surface, found)| {
                let expected = surface.diffuse(oracle.receiver.v) * everywhere;
                error_of(*found, expected, surface, parameters.ambient) > HALF_FLOATS
            });
            let off = off.count();
            println!("{} under {light:?}: {off} of {} pixels off", receiver.mesh.name, surfaces.len());
            assert_eq!(off, 0);
        }
    });
}

/// Overhead light takes the way straight down, so that e^(-K d) is known at every pixel's own depth.
#[test]
fn murky_water_absorbs_as_deep_as_each_pixel_lies() {
    gpu_test(|device| {
        let parameters = Parameters { waves: FLAT, absorption_per_m: 0.5, ..parameters(OVERHEAD) };
        let drawing = Drawing::of(device, Variant::Stencil, &parameters, &[sphere(), floor()]);
        let surfaces = lit_surfaces(&drawing, parameters.ambient);
        let worst = surfaces.iter().map(|(surface, found)| {
            let expected = surface.diffuse(DVec3::Y) * (0.5 * surface.position.y).exp();
            error_of(*found, expected, surface, parameters.ambient)
        });
        let worst = worst.fold(0.0, f64::max);
        println!("{} pixels, off by {worst:.1e}", surfaces.len());
        assert!(surfaces.len() > 1000 && worst <= HALF_FLOATS, "{worst}");
    });
}

/// The far wall of a bowl lies in the near wall's shadow, which the level map knows and the stencil method does not.
#[test]
fn no_surface_stands_in_anothers_shadow() {
    gpu_test(|device| {
        let camera = Camera { eye: Vec3::new(0.4, -0.3, 0.6), ..close_camera() };
        let parameters = Parameters { waves: FLAT, absorption_per_m: 0.0, camera, ..parameters(LOW) };
        let [stencil, level] =
            [Variant::Stencil, Variant::LevelMap].map(|variant| Drawing::of(device, variant, &parameters, &[bowl()]));
        let oracle = Oracle::of(&parameters, &LOW, &bowl(), &stencil.grid);
        let surfaces = lit_surfaces(&stencil, parameters.ambient);
        let in_level_map = surfaces_with_light(&stencil, &level, parameters.ambient);
        let everywhere = flat_water_intensity(oracle.light.direction_at(DVec3::ZERO), oracle.medium, 0.0).unwrap();
        let (mut facing, mut shadowed) = (0, 0);
        for ((surface, found), (_, in_level_map)) in surfaces.iter().zip(in_level_map) {
            let expected = surface.diffuse(oracle.receiver.v) * everywhere;
            if expected.max_element() > 0.05 {
                facing += 1;
                assert!(error_of(*found, expected, surface, parameters.ambient) <= HALF_FLOATS, "{surface:?}: {found}");
                shadowed += u32::from(in_level_map.max_element() < 1e-3);
            }
        }
        println!("{shadowed} of {facing} pixels in the level map's shadow");
        assert!(shadowed * 20 > facing, "{shadowed} of {facing}");
    });
}

/// If nothing is hidden from the light the methods draw one picture, but for the level map's texels and planes, which
/// the foci of strong waves are as thin as.
#[test]
fn the_floor_looks_as_the_level_map_draws_it() {
    gpu_test(|device| {
        let strong = parameters(OVERHEAD).waves;
        for (light, (waves, bound)) in [OVERHEAD, OBLIQUE, POINT]
            .into_iter()
            .flat_map(|light| [(FLAT, 0.05), (GENTLE, 0.1), (strong, 0.4)].map(|case| (light, case)))
        {
            let camera = close_camera();
            let parameters = Parameters { waves, planes: 101, map_size: 512, camera, ..parameters(light) };
            let [stencil, level] = [Variant::Stencil, Variant::LevelMap]
                .map(|variant| Drawing::of(device, variant, &parameters, &[floor()]).picture);
            let difference = compare(&stencil, &level, None).unwrap();
            println!("{light:?}, waves of {} m: {difference:?}", waves.amplitude_m);
            assert!(difference.mean <= bound, "{light:?}: {difference:?}");
        }
    });
}
