//! Solid textures of surfaces: gases and veins integrated over pixels, and the silhouettes of gases.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::model::{DensityFunction, Object, SolidTexture, Veins};
use fumarole::papers::gas::parameters::validate_object;
use fumarole::papers::gas::reference::rays::Rays;
use fumarole::papers::gas::reference::texture::mean_over_pixel;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Lists, Parameters, Variant};
use fumarole::scene::{Camera, Light, shapes};
use glam::{DVec3, Mat4, Quat, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::scenes::small;
use crate::common::gpu_test;

const WIDTH: u32 = 45;
const HEIGHT: u32 = 31;

/// The camera at the origin looks along -Z; colours are the surfaces' own.
fn parameters() -> Parameters {
    Parameters {
        volumes: Vec::new(),
        lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }],
        ambient: Vec3::ONE,
        camera: Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, near_m: 0.5, ..Parameters::default().camera },
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

/// A plane across the view at 5 m, turned about the horizontal: at 0 it is seen edge on.
fn plane(angle: f32) -> Object {
    let place = Mat4::from_rotation_translation(Quat::from_rotation_x(angle), Vec3::Z * -5.0);
    Object::new(shapes::plane(Vec2::splat(12.0), UVec2::ONE).transformed(&place), Vec3::ONE)
}

fn texture(function: DensityFunction, scale_per_m: f32) -> SolidTexture {
    SolidTexture { function, opaque: 1.1, power: 1.6, scale_per_m, offset: Vec3::new(4.2, 1.7, 9.1) }
}

/// Mean distances of `found` from the mean over the pixel, of the middle of the pixel from it, and the pixels.
fn distances(
    rays: &Rays<'_>,
    texture: &SolidTexture,
    object: &Object,
    found: impl Fn(usize) -> Option<f64>,
) -> [f64; 2] {
    let corners = [0, 1, 2].map(|i| object.mesh.positions[object.mesh.indices[i] as usize].as_dvec3());
    let (mut sums, mut count) = ([0.0; 2], 0.0);
    for pixel in 0..(WIDTH * HEIGHT) as usize {
        let Some(found) = found(pixel) else { continue };
        let place = [pixel as u32 % WIDTH, pixel as u32 / WIDTH];
        let mean = mean_over_pixel(rays, texture, corners, place, 16);
        let middle = mean_over_pixel(rays, texture, corners, place, 1);
        sums = [sums[0] + (found - mean).abs(), sums[1] + (middle - mean).abs()];
        count += 1.0;
    }
    assert!(count > 300.0, "{count} pixels");
    sums.map(|sum| sum / count)
}

const FUNCTIONS: [DensityFunction; 2] = [DensityFunction::Turbulence, DensityFunction::Clouds { frequency: 5.0 }];

/// Opacities are the means over the pixels of textures that vary within them: far nearer to them than one sample in the middle is,
/// on planes that face the eye and on steep ones, by linked lists and by tiles.
#[test]
fn the_opacity_of_a_gas_is_integrated_over_the_pixel() {
    gpu_test(|device| {
        for (function, angle, scale, lists) in [
            (FUNCTIONS[0], 1.4, 1.6, Lists::Linked),
            (FUNCTIONS[1], 1.4, 1.2, Lists::Linked),
            (FUNCTIONS[0], 0.5, 0.8, Lists::Tiles),
        ] {
            let scene = Parameters { lists, ..parameters() };
            let texture = texture(function, scale);
            let gas = Object { gas: Some(texture), ..plane(angle) };
            validate_object(&gas).unwrap();
            let drawing = Drawing::of(device, Variant::NoVolume, &scene, std::slice::from_ref(&gas));
            let opacity = |pixel: usize| {
                let whole = drawing.lists[pixel].iter().find(|f| f.coverage == 1.0);
                whole.map(|fragment| f64::from(fragment.opacity))
            };
            let [integrated, sampled] = distances(&Rays::new(&scene, 0), &texture, &gas, opacity);
            println!("{function:?}, {angle}: {integrated:.4} from the means, {sampled:.4} of one sample");
            assert!(integrated < 0.008 && integrated < 0.3 * sampled, "{function:?}: {integrated} and {sampled}");
        }
    });
}

/// A surface with veins has their colour by the mean of their texture over the pixel; by both compilers, and where it moves they
/// move with it.
#[test]
fn veins_are_integrated_over_the_pixel() {
    gpu_test(|device| {
        for (function, compiler) in [(FUNCTIONS[0], Compiler::Glslang), (FUNCTIONS[1], Compiler::Naga)] {
            let texture = texture(function, 1.3);
            let veins = Some(Veins { color: Vec3::new(0.25, 0.5, 0.75), texture });
            let object = Object { veins, color: Vec3::ONE, ..plane(1.3) };
            validate_object(&object).unwrap();
            let scene = parameters();
            let drawing = Drawing::frame(device, compiler, Variant::NoVolume, &scene, std::slice::from_ref(&object), 0);
            let part = |pixel: usize| {
                let is_whole = drawing.lists[pixel].iter().any(|fragment| fragment.coverage == 1.0);
                let color = drawing.color(pixel);
                // Of all three components the same part.
                let parts = (DVec3::ONE - color) / DVec3::new(0.75, 0.5, 0.25);
                assert!(!is_whole || (parts - parts.x).abs().max_element() < 1e-3, "{color}");
                is_whole.then_some(parts.x)
            };
            let [integrated, sampled] = distances(&Rays::new(&scene, 0), &texture, &object, part);
            println!("{function:?}: {integrated:.4} from the means, {sampled:.4} of one sample");
            assert!(integrated < 0.008 && integrated < 0.3 * sampled, "{function:?}: {integrated} and {sampled}");
        }
        // Moved towards the eye it is the same surface elsewhere: the same at twice the distance from half as far away.
        let texture = texture(FUNCTIONS[0], 0.2);
        let veins = Some(Veins { color: Vec3::ZERO, texture });
        let moved = Object { veins, per_frame_m: Vec3::new(0.3, 0.0, 0.0), ..plane(1.4) };
        let scene = parameters();
        let followed = Camera { eye: Vec3::X * 0.3, target: Vec3::new(0.3, 0.0, -1.0), ..scene.camera };
        let draw = |scene: &Parameters, number| {
            let objects = std::slice::from_ref(&moved);
            Drawing::frame(device, Compiler::Glslang, Variant::NoVolume, scene, objects, number)
        };
        let scene = Parameters { first_frame: 0, frame_step: 1, ..scene };
        let (still, along) = (draw(&scene, 0), draw(&Parameters { camera: followed, ..scene.clone() }, 1));
        let worst = still.radiance.iter().zip(&along.radiance).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-3, "{worst}");
    });
}

/// A gas on an ellipsoid fades by 3 t^2 - 2 t^3 of the cosine to its normal over its rim, and not without one.
#[test]
fn a_gas_fades_towards_its_silhouette() {
    gpu_test(|device| {
        let texture = SolidTexture { opaque: 0.5, ..texture(DensityFunction::Constant, 1.0) };
        let place = Mat4::from_scale_rotation_translation(Vec3::new(1.2, 0.8, 0.6), Quat::IDENTITY, Vec3::Z * -4.0);
        let mesh = shapes::sphere(64, 32).transformed(&place);
        for rim in [0.0, 0.8] {
            let gas = Some(texture);
            let ellipsoid = Object { gas, rim, is_two_sided: false, ..Object::new(mesh.clone(), Vec3::ONE) };
            // Fine enough for triangles that fill pixels.
            let scene = Parameters { width: 4 * WIDTH, height: 4 * HEIGHT, ..parameters() };
            let drawing = Drawing::of(device, Variant::NoVolume, &scene, &[ellipsoid]);
            let rays = Rays::new(&scene, 0);
            let mut faded = 0;
            for (pixel, list) in (0..).zip(&drawing.lists) {
                let place = [pixel % scene.width, pixel / scene.width].map(|p| f64::from(p) + 0.5);
                let ray = rays.direction(place[0], place[1]);
                for fragment in list.iter().filter(|f| f.coverage == 1.0) {
                    // Where the ray meets the ellipsoid: |(r t - m) / h| = 1, and its gradient there.
                    let (middle, half) = (DVec3::Z * -4.0, DVec3::new(1.2, 0.8, 0.6));
                    let (o, d) = (-middle / half, ray / half);
                    let (b, c) = (o.dot(d), o.dot(o) - 1.0);
                    let under = b * b - d.dot(d) * c;
                    if under < 0.05 {
                        continue; // the mesh ends before the ellipsoid does
                    }
                    let point = ray * ((-b - under.sqrt()) / d.dot(d));
                    let normal = ((point - middle) / (half * half)).normalize();
                    let t = (normal.dot(ray.normalize()).abs() / f64::from(rim)).min(1.0);
                    let expected = if rim > 0.0 { 0.5 * t * t * (3.0 - 2.0 * t) } else { 0.5 };
                    let error = (f64::from(fragment.opacity) - expected).abs();
                    assert!(error < 0.01, "{rim}, pixel {pixel}: {} for {expected}", fragment.opacity);
                    faded += usize::from(expected < 0.45);
                }
            }
            assert!(if rim > 0.0 { faded > 30 } else { faded == 0 }, "{rim}: {faded}");
        }
    });
}

/// A layer and ellipsoids: both are seen through and white where they are dense, and nothing of them is seen where they have holes.
#[test]
fn clouds_cover_the_sky_in_part() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Clouds);
        let all = Drawing::of(device, Variant::NoVolume, &parameters, &objects);
        let land = Drawing::of(device, Variant::NoVolume, &parameters, &objects[..1]);
        let opacity = |pixel: usize| f64::from(all.radiance[4 * pixel + 3]);
        let sky: Vec<usize> = (0..land.lists.len()).filter(|&pixel| land.lists[pixel].is_empty()).collect();
        let share = |is: &dyn Fn(f64) -> bool| {
            sky.iter().filter(|&&pixel| is(opacity(pixel))).count() as f64 / sky.len() as f64
        };
        let (clear, dense) = (share(&|o| o < 0.2), share(&|o| o > 0.8));
        println!("of the sky {clear:.2} is clear and {dense:.2} is dense");
        assert!(sky.len() > 2000 && clear > 0.05 && dense > 0.2, "{} pixels, {clear}, {dense}", sky.len());
    });
}
