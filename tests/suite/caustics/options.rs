//! Departures from the thesis's reading by options: several samples a texel and intensities of vertices against
//! photons, shadows against rays, Fresnel's loss against its equations.

use std::path::Path;
use std::slice::from_ref;

use fumarole::gpu::{Compiler, ShaderLibrary};
use fumarole::measure::Variant as _;
use fumarole::papers::caustics::reference::{Photons, correlation};
use fumarole::papers::caustics::{Caustics, IntensityRule, Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::Light;
use glam::{DVec2, DVec3, Mat4, Vec3};

use super::drawing::Drawing;
use super::oracle::{Oracle, waves_surface};
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, floor, parameters, sphere, tilted_plane};
use super::seen::first_hit;
use crate::common::gpu_test;

/// Slopes of up to about 0.35, which fold the light many times on its way to the floor.
const STEEP: WaveParameters = WaveParameters { count: 8, amplitude_m: 0.1, wavelength_m: 1.2 };

fn of_steep_water(light: Light) -> Parameters {
    Parameters { planes: 1, map_size: 64, water_triangles: 6000, waves: STEEP, ..parameters(light) }
}

fn exact(map: &[f32]) -> Vec<f64> {
    map.iter().copied().map(f64::from).collect()
}

/// Two estimates by photons, each of 16,000 photons or so a texel's width of water.
fn truth(parameters: &Parameters, drawing: &Drawing, light: &Light) -> [Vec<f64>; 2] {
    let oracle = Oracle::of(parameters, light, &floor(), &drawing.grid);
    let (low, high) = (drawing.grid.corner, drawing.grid.corner + drawing.grid.extent_m());
    let surface = waves_surface(parameters);
    [0.25, 0.75].map(|place| {
        let photons = Photons { low, high, strata: [1200, 1200], place: DVec2::splat(place), is_reflected: false };
        let size = parameters.map_size as usize;
        let map = photons.map(&surface, oracle.light, oracle.medium, &oracle.receiver, 0.0, size);
        // Under slanting light the floor does not fill its map.
        let texels = map.into_iter().zip(drawing.target("position-map"));
        texels.map(|(intensity, &height)| if height < -1e29 { 0.0 } else { intensity }).collect()
    })
}

#[test]
fn more_samples_and_vertices_come_nearer_to_what_photons_light() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE] {
            let thesis = of_steep_water(light);
            let average = Parameters { coverage: 8, ..thesis.clone() };
            let by_vertex = Parameters { intensity: IntensityRule::Vertex, ..thesis.clone() };
            let both = Parameters { intensity: IntensityRule::Vertex, ..average.clone() };
            let draw = |p: &Parameters| Drawing::of(device, Variant::LevelMap, p, &[floor()]);
            let drawing = draw(&thesis);
            let [photons, others] = truth(&thesis, &drawing, &light);
            assert!(correlation(&photons, &others) > 0.999, "{}", correlation(&photons, &others));
            let sum = |map: &[f64]| map.iter().sum::<f64>();
            let greatest = |map: &[f64]| map.iter().copied().fold(0.0, f64::max);
            let judged = [&thesis, &average, &by_vertex, &both].map(|p| {
                let map = exact(draw(p).target("caustics-map"));
                let (correlation, flux) = (correlation(&map, &photons), sum(&map) / sum(&photons));
                println!(
                    "{light:?}, coverage {}, {:?}: correlation {correlation:.4}, greatest {:.1} of {:.1}, flux {flux:.4}",
                    p.coverage,
                    p.intensity,
                    greatest(&map),
                    greatest(&photons)
                );
                (correlation, greatest(&map), flux)
            });
            let [thesis, average, by_vertex, both] = judged;
            assert!(average.0 > 0.8 && by_vertex.0 > thesis.0 + 0.1 && both.0 > thesis.0 + 0.2, "{judged:?}");
            assert!(thesis.0 < 0.75, "{judged:?}");
            assert!(average.1 < 0.6 * thesis.1 && by_vertex.1 < 0.8 * thesis.1, "{judged:?}");
            assert!((average.2 - 1.0).abs() < 0.01 && (both.2 - 1.0).abs() < 0.01, "{judged:?}");
        }
    });
}

/// Drawn at a multiple, every variant lights as with one sample where the light does not vary.
#[test]
fn options_change_nothing_under_flat_water() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE] {
            for variant in [Variant::LevelMap, Variant::LevelMapSmart, Variant::Volumetric] {
                let plain = Parameters { waves: FLAT, ..parameters(light) };
                let options =
                    Parameters { coverage: 3, intensity: IntensityRule::Vertex, shadows: true, ..plain.clone() };
                let draw = |compiler, p| Drawing::compiled_by(compiler, device, variant, p, &[tilted_plane()]);
                let expected = draw(Compiler::Glslang, &plain);
                for compiler in [Compiler::Glslang, Compiler::Naga] {
                    let found = draw(compiler, &options);
                    found.assert_finite();
                    let pairs = found.target("combined-map").iter().zip(expected.target("combined-map"));
                    let off = pairs.filter(|(a, b)| (**a - **b).abs() > 2e-3 * b.max(0.1)).count();
                    assert!(off <= 8, "{}: {off} values differ", variant.as_str());
                }
            }
        }
    });
}

/// A sphere that floats over the floor.
fn sphere_over_floor() -> [ReceiverInput; 2] {
    let place = Mat4::from_translation(Vec3::new(0.1, -1.6, 0.1)) * Mat4::from_scale(Vec3::splat(0.35));
    let mesh = fumarole::scene::shapes::sphere(32, 32).transformed(&place);
    [ReceiverInput { mesh, albedo: Vec3::ONE }, floor()]
}

/// Under flat water the floor is dark exactly where the refracted light passes the sphere.
#[test]
fn a_receiver_throws_its_shadow_on_the_floor() {
    gpu_test(|device| {
        let receivers = sphere_over_floor();
        for (light, variant) in [
            (OVERHEAD, Variant::LevelMap),
            (OBLIQUE, Variant::LevelMap),
            (POINT, Variant::LevelMapSmart),
            (OBLIQUE, Variant::Volumetric),
            (OBLIQUE, Variant::Hit),
            (POINT, Variant::Hit),
        ] {
            let parameters = Parameters { waves: FLAT, ..parameters(light) };
            let without = Drawing::of(device, variant, &parameters, &receivers);
            let with_shadows = Parameters { shadows: true, ..parameters.clone() };
            let with = Drawing::of(device, variant, &with_shadows, &receivers);
            let oracle = Oracle::among(&parameters, &light, &receivers[1], &receivers, &with.grid);
            let maps = |d: &Drawing| d.map("combined-map", 0, 1).chunks_exact(4).map(|t| t[0]).collect::<Vec<_>>();
            let heights = with.map("position-map", 0, 1);
            let (size, frame) = (parameters.map_size as usize, &oracle.receiver);
            let texel_m = frame.width.max(frame.depth) / size as f64;
            let (mut dark, mut off) = (0, 0);
            for (texel, (lit, unshadowed)) in maps(&with).into_iter().zip(maps(&without)).enumerate() {
                if heights[texel] < -1e29 {
                    continue;
                }
                let fraction = |i: usize| (i as f64 + 0.5) / size as f64 - 0.5;
                let place = DVec3::new(
                    fraction(texel % size) * frame.width,
                    f64::from(heights[texel]),
                    fraction(texel / size) * frame.depth,
                );
                // Where the nearest places agree; a point light's rays differ from V by what the water leaves them.
                let shaded = |aside: DVec3| {
                    let from = frame.to_world(place + aside * 4.0 * texel_m);
                    let towards = match light {
                        Light::Parallel { .. } => frame.v,
                        Light::Point { position, .. } => entry_of(position.as_dvec3(), from) - from,
                    };
                    first_hit(&receivers[..1], from, towards.normalize()).is_some()
                };
                let asides = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
                let count = asides.iter().filter(|&&aside| shaded(aside)).count();
                dark += usize::from(count == 4);
                let expected = if count == 4 { 0.0 } else { unshadowed };
                off += usize::from((count == 0 || count == 4) && (lit - expected).abs() > 1e-3);
            }
            println!("{light:?}, {}: {dark} texels in shadow, {off} off", variant.as_str());
            assert!(dark > 300 && off == 0, "{light:?}, {}: {dark} {off}", variant.as_str());
            // The sphere, nearest to the light, is as it was.
            assert_eq!(with.map("position-map", 0, 0), without.map("position-map", 0, 0));
            let both = with.map("combined-map", 0, 0).iter().zip(without.map("combined-map", 0, 0));
            assert!(both.filter(|(a, b)| (**a - **b).abs() > 1e-3).count() <= 8);
        }
    });
}

/// The point of flat water where light from `light` to `point` enters: Snell's law by bisection.
fn entry_of(light: DVec3, point: DVec3) -> DVec3 {
    let n = f64::from(Parameters::default().refraction_index);
    let on_water = |p: DVec3| DVec3::new(p.x, 0.0, p.z);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        let entry = on_water(light).lerp(on_water(point), middle);
        let sine = |from: DVec3| (entry - on_water(from)).length() / (entry - from).length();
        if sine(light) < n * sine(point) { low = middle } else { high = middle }
    }
    on_water(light).lerp(on_water(point), low)
}

/// The caustics map, of the stencil method the light on what is seen.
fn light_of(drawing: &Drawing, variant: Variant) -> Vec<f32> {
    if variant != Variant::Stencil {
        return drawing.target("caustics-map").to_vec();
    }
    let pixels = drawing.target("underwater-color").chunks_exact(4).zip(drawing.target("underwater-depth"));
    pixels.filter(|(_, depth)| **depth < 1.0).map(|(color, _)| color[0]).collect()
}

/// Under flat water all light loses one share on entering, by Fresnel's equations as sines and tangents.
#[test]
fn the_surface_reflects_its_share() {
    gpu_test(|device| {
        let grazing = Light::Parallel { direction: Vec3::new(1.0, -0.2, 0.1), intensity: Vec3::ONE };
        // Relative: in single precision, by sums of whole 2^-18, in half floats.
        for (light, variant, tolerance) in [
            (OVERHEAD, Variant::LevelMap, 1e-5),
            (OBLIQUE, Variant::Volumetric, 1e-5),
            (grazing, Variant::LevelMap, 1e-5),
            (OBLIQUE, Variant::Hit, 1e-4),
            (grazing, Variant::Hit, 1e-4),
            (OBLIQUE, Variant::Stencil, 2e-3),
            (grazing, Variant::Stencil, 2e-3),
        ] {
            let plain = Parameters { waves: FLAT, ambient: Vec3::ZERO, ..parameters(light) };
            let lossy = Parameters { fresnel: true, ..plain.clone() };
            let [plain, lossy] = [plain, lossy].map(|p| Drawing::of(device, variant, &p, from_ref(&sphere())));
            let Light::Parallel { direction, .. } = light else { panic!("parallel") };
            let incident = (-direction.as_dvec3().normalize().y).acos();
            let refracted = (incident.sin() / f64::from(Parameters::default().refraction_index)).asin();
            let (minus, plus) = (incident - refracted, incident + refracted);
            let n = f64::from(Parameters::default().refraction_index);
            let reflected = if plus < 1e-6 {
                ((n - 1.0) / (n + 1.0)).powi(2)
            } else {
                ((minus.sin() / plus.sin()).powi(2) + (minus.tan() / plus.tan()).powi(2)) / 2.0
            };
            let (mut lit, mut farthest) = (0, 0.0_f64);
            for (&found, &whole) in light_of(&lossy, variant).iter().zip(&light_of(&plain, variant)) {
                lit += u32::from(whole > 0.1);
                let expected = f64::from(whole) * (1.0 - reflected);
                farthest = farthest.max((f64::from(found) - expected).abs() / expected.max(1.0));
            }
            println!("{light:?}, {}: {reflected:.4}, {lit} lit, off by {farthest:.6}", variant.as_str());
            assert!(lit > 1000 && farthest < tolerance, "{light:?}, {}: {lit} {farthest}", variant.as_str());
        }
    });
}

/// A vertex shader that two passes share may be replaced by one that reads what only one of them draws with.
#[test]
fn a_replaced_shader_may_read_what_its_sibling_reads() {
    gpu_test(|device| {
        let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/caustics");
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sibling/caustics");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::copy(shaders.join("plane.glsl"), folder.join("plane.glsl")).unwrap();
        let vertex = std::fs::read_to_string(shaders.join("caustics-map.vert")).unwrap();
        let reads = "layout(set = 0, binding = 0) uniform texture2D position_map;\n\
                     layout(set = 0, binding = 1) uniform sampler nearest;\n\nvoid main() {\n\
                     float found = texelFetch(sampler2D(position_map, nearest), ivec2(0), 0).r;\n";
        let vertex = vertex.replace("void main() {\n", reads).replace("0.5, 1.0)", "0.5 + 0.0 * found, 1.0)");
        std::fs::write(folder.join("caustics-map.vert"), vertex).unwrap();
        let library = ShaderLibrary::new(device, Compiler::Glslang, folder.parent()).unwrap();
        let made = Caustics::new(&library, "test", Variant::LevelMap, &parameters(OVERHEAD), &[sphere()]);
        assert!(made.is_ok(), "{}", made.err().map(|error| error.to_string()).unwrap_or_default());
    });
}
