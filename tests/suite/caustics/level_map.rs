//! The level map against the oracle, stage by stage.

use std::slice::from_ref;

use fumarole::papers::caustics::reference::{AIR, CausticsMap, diffuse_map, refract};
use fumarole::papers::caustics::water::LEVEL_M;
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant};
use fumarole::scene::Light;
use glam::{DVec3, Vec3};

use super::drawing::Drawing;
use super::oracle::Oracle;
use super::scene::{OBLIQUE, OVERHEAD, POINT, bowl, parameters, sphere, teapot, tilted_plane};
use crate::common::gpu_test;

/// Relative error of a value stored as a half float, which a device may round or truncate.
const HALF_FLOAT: f64 = 1e-3;

const LIGHTS: [Light; 3] = [OVERHEAD, OBLIQUE, POINT];

fn receivers() -> [ReceiverInput; 4] {
    [teapot(), sphere(), tilted_plane(), bowl()]
}

/// Rows of `N` float4 each, without the fourth.
fn rows<const N: usize>(values: &[f32]) -> impl Iterator<Item = [DVec3; N]> {
    values.chunks_exact(4 * N).map(|row| std::array::from_fn(|i| Vec3::from_slice(&row[4 * i..]).as_dvec3()))
}

/// Late frames too: in single precision a phase would have lost 0.002 radians after an hour.
#[test]
fn the_water_is_the_sum_of_its_waves() {
    gpu_test(|device| {
        let early = parameters(OVERHEAD);
        for parameters in [early.clone(), Parameters { time_step_s: 1000.0, ..early }] {
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[sphere()]);
            let oracle = Oracle::of(&parameters, &OVERHEAD, &sphere(), &drawing.grid);
            let water = drawing.target("water");
            assert_eq!(water.len(), 8 * oracle.water.len());
            let mut highest_m = f64::NEG_INFINITY;
            for ([position, normal], expected) in rows(water).zip(&oracle.water) {
                assert!(position.distance(expected.position) < 1e-6, "{position}: {expected:?}");
                assert!(normal.distance(expected.normal) < 1e-6, "{normal}: {expected:?}");
                highest_m = highest_m.max(position.y);
            }
            assert!(highest_m > 0.02 && highest_m <= f64::from(parameters.waves.amplitude_m), "{highest_m}");
        }
    });
}

#[test]
fn a_ray_is_refracted_at_every_water_vertex() {
    gpu_test(|device| {
        for light in LIGHTS {
            let parameters = parameters(light);
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &[sphere()]);
            let oracle = Oracle::of(&parameters, &light, &sphere(), &drawing.grid);
            let along = |v: DVec3| oracle.receiver.direction_to_box(v);
            let middle = drawing.grid.center();
            let reference = along(DVec3::new(middle.x, LEVEL_M, middle.y));
            let rays = drawing.target("illumination-volumes");
            assert_eq!(rays.len(), 12 * oracle.water.len());
            assert!(rays.chunks_exact(12).all(|ray| ray[3] == 1.0));
            for ([origin, slope, incident], vertex) in rows(rays).zip(&oracle.water) {
                let direction = oracle.light.direction_at(vertex.position);
                let refracted = refract(direction, vertex.normal, AIR, oracle.medium.refraction_index).unwrap();
                let ray = along(refracted);
                let expected = DVec3::new(ray.x, ray.z, 1.0) / -ray.y;
                assert!(origin.distance(along(vertex.position) - reference) < 2e-6, "{origin}: {vertex:?}");
                assert!(slope.distance(expected) < 1e-6, "{slope}: {vertex:?}");
                assert!(incident.distance(along(direction)) < 1e-6, "{incident}: {vertex:?}");
            }
        }
    });
}

#[test]
fn the_maps_show_the_surface_nearest_to_the_light() {
    gpu_test(|device| {
        for (light, receiver) in LIGHTS.into_iter().flat_map(|light| receivers().map(|r| (light, r))) {
            let mut parameters = parameters(light);
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let (map, tolerance_m) = (&oracle.positions, oracle.receiver.height_tolerance_m());
            let heights = drawing.target("position-map");
            let diffuse = drawing.target("diffuse-map");
            let expected = diffuse_map(&oracle.receiver, map, receiver.albedo.as_dvec3());
            let (mut outline, mut off) = (0, 0);
            for (texel, &height) in heights.iter().enumerate() {
                let found = Vec3::from_slice(&diffuse[4 * texel..]).as_dvec3();
                match map.y_range[texel] {
                    _ if map.at_outline[texel] => outline += 1,
                    None => assert!(height < -1e29 && found == DVec3::ZERO, "texel {texel}: {height} {found}"),
                    Some([low, high]) => {
                        let height = f64::from(height);
                        let is_between = height >= low - tolerance_m && height <= high + tolerance_m;
                        assert!(is_between, "texel {texel}: {height} is not in {low}..{high}");
                        let expected = expected[texel];
                        let tolerance = HALF_FLOAT * expected.length().max(0.1);
                        off += u32::from(found.distance(expected) > tolerance);
                    }
                }
            }
            println!("{} under {light:?}: {outline} texels at the outline, {off} off", receiver.mesh.name);
            assert!(outline * 50 <= heights.len());
            // Where one surface ends before another, or turns away from the light, a corner snapped to a fraction of a
            // texel changes the normal more than a half float does.
            assert!(off <= 4, "{off} texels of the diffuse map are off");

            parameters.mrt = false;
            let apart = Drawing::of(device, Variant::LevelMap, &parameters, from_ref(&receiver));
            for map in ["position-map", "diffuse-map", "caustics-map", "combined-map"] {
                assert_eq!(apart.target(map), drawing.target(map), "{map}");
            }
        }
    });
}

#[test]
fn the_caustics_map_meets_the_oracle() {
    gpu_test(|device| {
        let lights = LIGHTS.map(|light| vec![light]);
        let alone = lights.iter().flat_map(|lights| receivers().map(|r| (lights.clone(), vec![r])));
        let together = (LIGHTS.to_vec(), vec![sphere(), tilted_plane(), bowl()]);
        for (lights, receivers) in alone.chain([together]) {
            let mut parameters = parameters(OVERHEAD);
            parameters.lights = lights;
            let drawing = Drawing::of(device, Variant::LevelMap, &parameters, &receivers);
            for (l, light) in parameters.lights.iter().enumerate() {
                for (r, receiver) in receivers.iter().enumerate() {
                    let oracle = Oracle::among(&parameters, light, receiver, &receivers, &drawing.grid);
                    let case = format!("{} under {light:?}", receiver.mesh.name);
                    assert_meets(drawing.map("caustics-map", l, r), &oracle.caustics_map(), &case);
                }
            }
        }
    });
}

/// A caustics map against the oracle's: 1e-4 relative, but for at most 2 % of the texels, which rounding may decide.
pub fn assert_meets(found: &[f32], map: &CausticsMap, case: &str) {
    let mut excluded = 0;
    let mut worst = 0.0f64;
    for (texel, &found) in found.iter().enumerate() {
        if map.excluded[texel] {
            excluded += 1;
            continue;
        }
        assert!(found.is_finite(), "{case}, texel {texel}: {found}");
        let expected = map.intensity[texel];
        worst = worst.max((f64::from(found) - expected).abs() / expected.max(0.1));
    }
    let fraction = f64::from(excluded) / found.len() as f64;
    println!("{case}: {excluded} texels excluded ({:.2} %), the others off by {worst:.1e} at most", 100.0 * fraction);
    assert!(fraction <= 0.02 && worst <= 1e-4, "{case}: {excluded} texels excluded, the others off by {worst:e}");
    assert!(map.intensity.iter().filter(|i| **i > 0.0).count() > found.len() / 4, "{case}: little is lit");
}

#[test]
fn the_combined_map_is_the_product_of_its_maps_and_the_light() {
    gpu_test(|device| {
        let intensity = Vec3::new(1.5, 1.0, 0.25);
        let light = Light::Parallel { direction: Vec3::new(0.6, -1.0, -0.35), intensity };
        let drawing = Drawing::of(device, Variant::LevelMap, &parameters(light), &[teapot()]);
        let maps = drawing.target("caustics-map").iter().zip(drawing.target("diffuse-map").chunks_exact(4));
        for (combined, (caustics, diffuse)) in drawing.target("combined-map").chunks_exact(4).zip(maps) {
            let expected = intensity * *caustics * Vec3::from_slice(diffuse);
            let found = Vec3::from_slice(combined);
            let tolerance = expected * HALF_FLOAT as f32 + 1e-6;
            assert!((found - expected).abs().cmple(tolerance).all(), "{found} {expected}");
            assert_eq!(combined[3], diffuse[3]);
        }
    });
}
