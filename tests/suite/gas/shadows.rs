//! The light that surfaces get through the gas: traced, and by the table.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::papers::gas::model::{DensityFunction, Object, Volume};
use fumarole::papers::gas::reference::rays::{Rays, towards};
use fumarole::papers::gas::reference::shadow_table::ShadowTables;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::{Camera, Light, shapes};
use glam::{DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::march::{FRAME, HEIGHT, WIDTH, gases, lights, parameters};
use crate::common::gpu_test;

/// A white floor under the gas, seen from beside it: the gas is not in the way of the eye.
fn floor() -> Object {
    let mesh = shapes::plane(Vec2::splat(12.0), UVec2::ONE).transformed(&Mat4::from_translation(Vec3::NEG_Y * 1.6));
    Object::new(mesh, Vec3::ONE)
}

fn floor_view(volume: Volume, lights: Vec<Light>) -> Parameters {
    Parameters {
        lights,
        ambient: Vec3::ZERO,
        steps: 20,
        camera: Camera {
            eye: Vec3::new(0.0, -1.15, 4.5),
            target: Vec3::new(0.0, -1.6, 0.5),
            vertical_fov_rad: 0.35,
            ..Parameters::default().camera
        },
        ..parameters(vec![volume])
    }
}

/// Gases that vary, so dense that every one of them and every light leaves dark shadows.
fn dark_gases() -> Vec<Volume> {
    let dark = |mut gas: Volume| {
        // The fog has not come far, and the steam thins with its height.
        let function = gas.texture.function;
        let is_thin = matches!(function, DensityFunction::Fog { .. } | DensityFunction::Steam { .. });
        gas.texture.opaque = if is_thin { 6.0 } else { 2.5 };
        gas
    };
    gases().into_iter().skip(1).map(dark).collect()
}

/// A place of the floor in the picture.
struct Place {
    point: DVec3,
    /// The radiance there, over that without the gas.
    lit: DVec3,
    /// Of each light, what it would give without the gas, over all lights' together.
    shares: Vec<DVec3>,
}

impl Place {
    /// By how much the picture differs from light that goes through these optical depths, one a light.
    fn error(&self, depth_to: impl Fn(usize) -> f64) -> f64 {
        let expected: DVec3 = self.shares.iter().enumerate().map(|(l, &share)| share * (-depth_to(l)).exp()).sum();
        (self.lit - expected).abs().max_element()
    }
}

fn places(device: &Arc<Device>, variant: Variant, parameters: &Parameters) -> Vec<Place> {
    let drawing = Drawing::of(device, variant, parameters, &[floor()]);
    let rays = Rays::new(parameters, FRAME);
    let mut places = Vec::new();
    for (pixel, list) in drawing.lists.iter().enumerate() {
        // The diagonal of the floor: two pieces with middles of their own.
        if list.len() != 1 || list[0].coverage < 1.0 {
            continue;
        }
        let [column, row] = [pixel as u32 % WIDTH, pixel as u32 / WIDTH].map(|p| f64::from(p) + 0.5);
        let ray = rays.direction(column, row);
        let depth_m = f64::midpoint(list[0].depth_m[0].into(), list[0].depth_m[1].into());
        let point = rays.eye() + ray * depth_m;
        assert!(ray.y < 0.0 && (point.y + 1.6).abs() < 0.02, "{point}");
        let light = |light: &Light| {
            let (way, _, irradiance) = towards(light, point);
            irradiance * way.y.max(0.0)
        };
        let open: Vec<DVec3> = parameters.lights.iter().map(light).collect();
        let all: DVec3 = open.iter().sum();
        places.push(Place { point, lit: drawing.color(pixel) / all, shares: open.iter().map(|&o| o / all).collect() });
    }
    assert!(places.len() > (WIDTH * HEIGHT / 2) as usize, "{} places", places.len());
    places
}

/// The mean and the largest of the errors.
fn spread(errors: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0_u32);
    for error in errors {
        sum += error;
        worst = worst.max(error);
        count += 1;
    }
    (sum / f64::from(count), worst)
}

/// The least share of any light colour that is seen anywhere: there is a shadow, and it is dark.
fn darkest(places: &[Place]) -> f64 {
    places.iter().map(|place| place.lit.min_element()).fold(1.0, f64::min)
}

#[test]
fn surfaces_get_the_light_that_the_gas_lets_through() {
    gpu_test(|device| {
        for gas in dark_gases() {
            for lights in lights().into_iter().map(|l| vec![l]).chain([lights()]) {
                let parameters = floor_view(gas, lights);
                let rays = Rays::new(&parameters, FRAME);
                for variant in [Variant::Surfaces, Variant::Traced] {
                    let places = places(device, variant, &parameters);
                    let traced = |finer| {
                        let depth =
                            |place: &Place, l: usize| rays.optical_depth(place.point, &parameters.lights[l], finer);
                        spread(places.iter().map(|place| place.error(|l| depth(place, l))))
                    };
                    let ((_, worst), (mean, _), darkest) = (traced(1), traced(8), darkest(&places));
                    let case = format!("{:?}, {:?}, {variant:?}", gas.texture.function, parameters.lights);
                    println!("{case}: {worst:.2e}; from fine rays {mean:.4} on average; darkest {darkest:.3}");
                    assert!(worst < 1e-3 && mean < 0.01, "{case}: {worst}, {mean} from fine rays");
                    assert!(darkest < 0.5, "{case}: no shadow is darker than {darkest}");
                }
            }
        }
    });
}

/// The table's shadows are those of a table in double precision, outside of its box too.
#[test]
fn the_table_shadows_surfaces_as_one_in_double_precision() {
    gpu_test(|device| {
        for gas in dark_gases() {
            let parameters = floor_view(gas, lights());
            let tables = ShadowTables::new(&parameters, FRAME);
            let everywhere = places(device, Variant::Table, &parameters);
            let (_, worst) = spread(everywhere.iter().map(|p| p.error(|l| tables.optical_depth(p.point, l))));
            println!("{:?}: {worst:.2e}", gas.texture.function);
            assert!(worst < 1e-3, "{:?}: {worst}", gas.texture.function);
            for (l, light) in lights().into_iter().enumerate() {
                let alone = floor_view(gas, vec![light]);
                let places = places(device, Variant::Table, &alone);
                let ((_, worst), darkest) =
                    (spread(places.iter().map(|p| p.error(|_| tables.optical_depth(p.point, l)))), darkest(&places));
                let case = format!("{:?}, {light:?}", gas.texture.function);
                println!("{case}: {worst:.2e}, darkest {darkest:.3}");
                assert!(worst < 1e-3, "{case}: {worst}");
                assert!(darkest < 0.5, "{case}: no shadow is darker than {darkest}");
            }
        }
    });
}

/// The mean difference on the floor of what one light's table lets through from what rays let through, both in double
/// precision.
fn error_of_the_method(gas: Volume, light: Light, table_size: u32) -> f64 {
    let parameters = Parameters { table_size, ..floor_view(gas, vec![light]) };
    let (rays, tables) = (Rays::new(&parameters, FRAME), ShadowTables::new(&parameters, FRAME));
    let places = (0..21 * 21).map(|i| DVec3::new(f64::from(i % 21 - 10) * 0.12, -1.6, f64::from(i / 21 - 10) * 0.12));
    let difference = |point: DVec3| {
        let [table, traced] = [tables.optical_depth(point, 0), rays.optical_depth(point, &light, 8)];
        ((-table).exp() - (-traced).exp()).abs()
    };
    spread(places.map(difference)).0
}

/// The difference between table and rays is the method's: each entry's sum is interpolated from four others', so that a
/// shadow spreads on its way, the most from a light inside. Below 0.03 on average at 64 entries a side in gas of the
/// usual density; in denser gas more, but the less the finer the table.
#[test]
fn a_table_in_double_precision_is_near_rays() {
    for gas in gases().into_iter().skip(1) {
        for light in lights() {
            let mean = error_of_the_method(gas, light, 64);
            println!("{:?}, {light:?}: {mean:.4}", gas.texture.function);
            assert!(mean < 0.03, "{:?}, {light:?}: {mean}", gas.texture.function);
        }
    }
    let (gas, light) = (dark_gases()[0], lights()[2]);
    let means = [32, 64, 128].map(|size| error_of_the_method(gas, light, size));
    println!("dense turbulence round a light, by table size: {means:.4?}");
    assert!(means.windows(2).all(|m| m[1] < 0.8 * m[0]), "{means:?}");
}
