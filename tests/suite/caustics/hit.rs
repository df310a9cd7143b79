//! The variant `hit` against photons, its passes against their oracle.

use std::slice::from_ref;

use fumarole::papers::caustics::reference::{
    LandedTriangle, Photons, WaterVertex, correlation, flat_water_intensity, landed_map, refract,
};
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::Light;
use glam::{DVec2, DVec3};

use super::drawing::Drawing;
use super::oracle::{Oracle, waves_surface};
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, bowl, floor, parameters, round_sphere, teapot, tilted_plane};
use crate::cli::program::{caustics, folder};
use crate::common::gpu_test;

/// Slope 0.34, root of the mean square.
const STEEP: WaveParameters = WaveParameters { count: 12, amplitude_m: 0.21, wavelength_m: 1.2 };

const SPHERE_RADIUS_M: f64 = 1.0;

/// Distance to a receiver and its normal there, in box space.
fn hit_of(receiver: &ReceiverInput, oracle: &Oracle) -> impl Fn(DVec3, DVec3) -> Option<(f64, DVec3)> + use<> {
    let is_sphere = receiver.mesh.name == "round sphere";
    // The floor of the pool, or the sphere that stands on it; both are in the middle of their boxes.
    let normal = oracle.receiver.direction_to_box(DVec3::Y);
    move |origin: DVec3, ray: DVec3| {
        if is_sphere {
            let towards = -origin.dot(ray);
            let inside = towards * towards - origin.length_squared() + SPHERE_RADIUS_M * SPHERE_RADIUS_M;
            let distance_m = towards - (inside >= 0.0).then(|| inside.sqrt())?;
            Some((distance_m, origin + ray * distance_m))
        } else {
            let distance_m = -origin.dot(normal) / ray.dot(normal);
            (distance_m > 0.0 && ray.dot(normal) < 0.0).then_some((distance_m, normal))
        }
    }
}

/// Two independent maps by photons, of that many strata along each side of the water, on the texels that hold the receiver.
fn truth(
    parameters: &Parameters,
    light: &Light,
    receiver: &ReceiverInput,
    drawing: &Drawing,
    strata: u32,
) -> [Vec<f64>; 2] {
    let oracle = Oracle::of(parameters, light, receiver, &drawing.grid);
    let (low, high) = (drawing.grid.corner, drawing.grid.corner + drawing.grid.extent_m());
    let surface = waves_surface(parameters);
    let (size, hit) = (parameters.map_size as usize, hit_of(receiver, &oracle));
    [0.25, 0.75].map(|place| {
        let photons = Photons { low, high, strata: [strata, strata], place: DVec2::splat(place), is_reflected: false };
        let map = photons.landed(&surface, oracle.light, oracle.medium, &oracle.receiver, &hit, size);
        let texels = map.into_iter().zip(drawing.target("position-map"));
        texels.map(|(intensity, &height)| if height < -1e29 { 0.0 } else { intensity }).collect()
    })
}

struct Judged {
    correlation: f64,
    /// Of the truth's greatest.
    greatest: f64,
    /// Of the truth's, on the texels that the receiver fills.
    flux: f64,
    /// Correlation of two halves of the truth.
    halves: f64,
}

fn judge(drawing: &Drawing, [one, other]: &[Vec<f64>; 2]) -> Judged {
    let map: Vec<f64> = drawing.target("caustics-map").iter().copied().map(f64::from).collect();
    let both: Vec<f64> = one.iter().zip(other).map(|(a, b)| (a + b) / 2.0).collect();
    // A texel at an edge has all of its light here, and there what lands on the part of it that is filled: of a sphere of
    // 64 texels' radius 0.4 % of all light.
    let heights = drawing.target("position-map");
    let size = heights.len().isqrt();
    let is_held = |x: usize, y: usize| x < size && y < size && heights[y * size + x] > -1e29;
    let around = |texel: usize| {
        let (x, y) = (texel % size, texel / size);
        (0..9).all(|i| is_held((x + i % 3).wrapping_sub(1), (y + i / 3).wrapping_sub(1)))
    };
    let filled: Vec<usize> = (0..heights.len()).filter(|&texel| around(texel)).collect();
    let sum = |map: &[f64]| filled.iter().map(|&texel| map[texel]).sum::<f64>();
    let greatest = |map: &[f64]| map.iter().copied().fold(0.0, f64::max);
    Judged {
        correlation: correlation(&map, &both),
        greatest: greatest(&map) / greatest(&both),
        flux: sum(&map) / sum(&both),
        halves: correlation(one, other),
    }
}

/// Draws each receiver under each water and light and sets it against photons.
fn assert_lit_as_by_photons(map_size: u32, strata: u32, lights: &[Light]) {
    gpu_test(|device| {
        let waters = [Parameters::default().waves, STEEP];
        for (waves, &light) in lights.iter().flat_map(|light| waters.map(|waves| (waves, light))) {
            let parameters = Parameters { waves, map_size, water_triangles: 10_000, ..parameters(light) };
            for receiver in [floor(), round_sphere()] {
                let name = format!("{} under {light:?}, slope {:.3}", receiver.mesh.name, parameters.mean_slope());
                let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
                drawing.assert_finite();
                let truth = truth(&parameters, &light, &receiver, &drawing, strata);
                let Judged { correlation, greatest, flux, halves } = judge(&drawing, &truth);
                println!(
                    "{name}, {} triangles: correlation {correlation:.4} (halves {halves:.5}), greatest {greatest:.3}, \
                     flux {flux:.4}",
                    drawing.grid.triangle_count()
                );
                assert!(correlation > 0.98, "{name}: {correlation}");
                assert!((1.0 / 1.3..1.3).contains(&greatest), "{name}: {greatest}");
                assert!((flux - 1.0).abs() < 0.005, "{name}: {flux}");
            }
        }
    });
}

/// `FUMAROLE_TEST_ALL_PHOTONS=1` lights maps of 512 texels too, with 72 million photons each: three minutes.
#[test]
fn hit_lights_planes_and_spheres_as_photons_do() {
    assert_lit_as_by_photons(128, 2000, &[OVERHEAD, OBLIQUE]);
    if std::env::var_os("FUMAROLE_TEST_ALL_PHOTONS").is_some() {
        assert_lit_as_by_photons(512, 6000, &[OVERHEAD]);
    }
}

/// Under flat water eq. 4-18 is the same everywhere, on any receiver: on its slopes, at its edges, and where triangles
/// that land whole meet those that straddle.
#[test]
fn hit_lights_every_texel_alike_under_flat_water() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE] {
            for receiver in [floor(), round_sphere(), tilted_plane(), bowl(), teapot()] {
                let parameters = Parameters { waves: FLAT, absorption_per_m: 0.0, ..parameters(light) };
                let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
                let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
                let direction = oracle.light.direction_at(DVec3::ZERO);
                let expected = flat_water_intensity(direction, oracle.medium, 0.0).unwrap();
                let texels = drawing.target("position-map").iter().zip(drawing.target("caustics-map"));
                // Each of a texel's triangles is rounded, to 1e-5 of its area.
                let held = texels.clone().filter(|(height, _)| **height > -1e29);
                let farthest =
                    held.clone().map(|(_, light)| (f64::from(*light) / expected - 1.0).abs()).fold(0.0, f64::max);
                let name = &receiver.mesh.name;
                println!("{name} under {light:?}: {} texels, off by {farthest:.6} at the most", held.clone().count());
                assert!(held.count() > 1000 && farthest < 1e-4, "{name} under {light:?}: {farthest}");
                assert!(texels.clone().all(|(height, light)| *height > -1e29 || *light == 0.0), "{name}");
            }
        }
    });
}

/// More words of light than a row of workgroups has invocations; long ways of beams through many texels.
#[test]
fn large_maps_hold_the_light_of_small_ones() {
    gpu_test(|device| {
        let [small, large] = [128, 1536].map(|map_size| {
            let parameters = Parameters { waves: STEEP, map_size, ..parameters(OVERHEAD) };
            Drawing::of(device, Variant::Hit, &parameters, &[teapot()])
        });
        let mean = |drawing: &Drawing| {
            let map = drawing.target("caustics-map");
            map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64
        };
        let (small, large) = (mean(&small), mean(&large));
        println!("{small} {large}");
        assert!(small > 0.1 && (large / small - 1.0).abs() < 0.03, "{small} {large}");
    });
}

/// The rays of the water's vertices land where exact rays meet the floor and the sphere.
#[test]
fn rays_land_where_exact_ones_do() {
    gpu_test(|device| {
        for (waves, light) in [(STEEP, OVERHEAD), (Parameters::default().waves, OBLIQUE), (STEEP, POINT)] {
            let parameters = Parameters { waves, ..parameters(light) };
            let size = f64::from(parameters.map_size);
            for receiver in [floor(), round_sphere()] {
                let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
                let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
                let hit = hit_of(&receiver, &oracle);
                let (mut landed, mut off, mut missed) = (0, 0, 0);
                for (vertex, found) in oracle.water.iter().zip(drawing.target("landings").chunks_exact(4)) {
                    let incident = oracle.light.direction_at(vertex.position);
                    let index = oracle.medium.refraction_index;
                    let refracted = refract(incident, vertex.normal, 1.0, index);
                    let Some(refracted) = refracted else { continue };
                    let origin = oracle.receiver.to_box(vertex.position);
                    let ray = oracle.receiver.direction_to_box(refracted);
                    // Away from edges, where the surface of texels ends before the receiver's.
                    let Some((distance_m, normal)) = hit(origin, ray).filter(|(_, n)| n.y > 0.6) else { continue };
                    let place = origin + ray * distance_m;
                    let extent = DVec2::new(oracle.receiver.width, oracle.receiver.depth);
                    let texel = (DVec2::new(place.x, place.z) / extent + 0.5) * size;
                    let world = oracle.receiver.to_world(place);
                    let is_inside = receiver.mesh.name == "round sphere" || world.x.abs().max(world.z.abs()) < 0.9;
                    let turned = normal.dot(-ray) / (normal.y * -ray.y);
                    // Where a beam grazes the surface, a small error of its height moves the place far.
                    if !is_inside || turned < 0.3 {
                        continue;
                    }
                    landed += 1;
                    missed += usize::from(found[3] < 0.0);
                    let found_at = DVec2::new(f64::from(found[0]), f64::from(found[1]));
                    let weight = (-oracle.medium.absorption_per_m * distance_m).exp() / -ray.y;
                    let is_off = found_at.distance(texel) > 0.1 || (f64::from(found[3]) / weight - 1.0).abs() > 0.02;
                    off += usize::from(found[3] >= 0.0 && is_off);
                }
                println!("{} under {light:?}: {landed} land, {missed} missed, {off} off", receiver.mesh.name);
                assert!(landed > 500 && missed == 0 && off * 100 < landed, "{missed} {off} of {landed}");
            }
        }
    });
}

/// I_c of eq. 4-18 where the ray of each vertex of the water meets a floor, by the areas that its neighbours bound on the water and
/// on the floor; negative where the light is turned over.
fn floor_intensities(oracle: &Oracle, columns: usize) -> Vec<f64> {
    let up = oracle.receiver.direction_to_box(DVec3::Y);
    let landing = |vertex: &WaterVertex| {
        let incident = oracle.light.direction_at(vertex.position);
        let refracted = refract(incident, vertex.normal, 1.0, oracle.medium.refraction_index).unwrap();
        let (origin, ray) = (oracle.receiver.to_box(vertex.position), oracle.receiver.direction_to_box(refracted));
        let distance_m = -origin.dot(up) / ray.dot(up);
        (origin + ray * distance_m, (-oracle.medium.absorption_per_m * distance_m).exp() / -ray.y)
    };
    let landings: Vec<(DVec3, f64)> = oracle.water.iter().map(landing).collect();
    let count = landings.len();
    let intensity = |index: usize| {
        let column = index % columns;
        let [left, right] = [index - usize::from(column > 0), index + usize::from(column + 1 < columns)];
        let above = index.checked_sub(columns).unwrap_or(index);
        let below = if index + columns < count { index + columns } else { index };
        let across = |place: &dyn Fn(usize) -> DVec3| (place(right) - place(left)).cross(place(below) - place(above));
        let passing =
            across(&|i| oracle.water[i].position).dot(oracle.light.direction_at(oracle.water[index].position));
        passing * landings[index].1 / across(&|i| landings[i].0).y
    };
    (0..count).map(intensity).collect()
}

/// The triangles of the water over the floor under light from overhead, where they land on the device.
fn landed_triangles(drawing: &Drawing, oracle: &Oracle, intensities: &[f64]) -> Vec<LandedTriangle> {
    let texel_area_m2 = oracle.receiver.texel_area_m2(drawing.target("caustics-map").len());
    let landings: Vec<&[f32]> = drawing.target("landings").chunks_exact(4).collect();
    let triangle = |corners: &[u32]| {
        let corners = [0, 1, 2].map(|i| corners[i] as usize);
        let [a, b, c] = corners.map(|i| oracle.water[i].position);
        let face = (b - a).cross(c - a) / 2.0;
        let weight = corners.iter().map(|&i| f64::from(landings[i][3])).sum::<f64>() / 3.0;
        let places = corners.map(|i| DVec2::new(f64::from(landings[i][0]), f64::from(landings[i][1])));
        let light = face.y.abs() * weight.max(0.0) / texel_area_m2;
        LandedTriangle { corners: places, light, intensities: corners.map(|i| intensities[i]) }
    };
    drawing.grid.indices().chunks_exact(3).map(triangle).collect()
}

/// On the floor under light from overhead, where every triangle lands whole: the map by the areas that they cover.
#[test]
fn triangles_cover_texels_by_area() {
    gpu_test(|device| {
        let parameters = Parameters { waves: STEEP, map_size: 64, water_triangles: 600, ..parameters(OVERHEAD) };
        let drawing = Drawing::of(device, Variant::Hit, &parameters, &[floor()]);
        let oracle = Oracle::of(&parameters, &OVERHEAD, &floor(), &drawing.grid);
        let intensities = floor_intensities(&oracle, drawing.grid.columns as usize + 1);
        let landed = landed_triangles(&drawing, &oracle, &intensities);
        let expected = landed_map(landed, parameters.map_size as usize);
        let found: Vec<f64> = drawing.target("caustics-map").iter().copied().map(f64::from).collect();
        let (flux, exact) = (found.iter().sum::<f64>(), expected.iter().sum::<f64>());
        let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).sum::<f64>() / exact;
        println!("flux {:.6}, apart {apart:.6}, correlation {:.6}", flux / exact, correlation(&found, &expected));
        assert!((flux / exact - 1.0).abs() < 1e-3 && apart < 5e-3 && correlation(&found, &expected) > 0.9999);
    });
}

/// However little of a texel's light each triangle brings.
#[test]
fn texels_take_the_light_of_a_million_triangles() {
    gpu_test(|device| {
        let mean = |map_size, water_triangles| {
            let parameters = Parameters { map_size, water_triangles, ..parameters(OVERHEAD) };
            let drawing = Drawing::of(device, Variant::Hit, &parameters, &[floor()]);
            let map = drawing.target("caustics-map");
            map.iter().copied().map(f64::from).sum::<f64>() / map.len() as f64
        };
        let expected = mean(64, 10_000);
        for (map_size, water_triangles) in [(1, 300_000), (1, 1_000_000), (2, 1_500_000)] {
            let found = mean(map_size, water_triangles);
            println!("{map_size} texels a side, {water_triangles} triangles: {found:.4}, {expected:.4}");
            assert!((found / expected - 1.0).abs() < 0.01, "{found} of {expected}");
        }
    });
}

/// I_c on the floor at a place under gentle water and light from overhead, by the exact water: the ray that lands there is found by
/// steps, and the areas by differences of its neighbours.
fn exact_light(surface: &impl Fn(f64, f64) -> WaterVertex, oracle: &Oracle, floor_m: f64, place: DVec2) -> f64 {
    let landing = |at: DVec2| {
        let vertex = surface(at.x, at.y);
        let ray = refract(DVec3::NEG_Y, vertex.normal, 1.0, oracle.medium.refraction_index).unwrap();
        let distance_m = (floor_m - vertex.position.y) / ray.y;
        let landed = vertex.position + ray * distance_m;
        (DVec2::new(landed.x, landed.z), (-oracle.medium.absorption_per_m * distance_m).exp() / -ray.y)
    };
    let at = (0..60).fold(place, |at, _| at + place - landing(at).0);
    assert!(landing(at).0.distance(place) < 1e-9, "the light folds");
    let step = 1e-4;
    let moved = |by: DVec2| (landing(at + by).0 - landing(at - by).0) / (2.0 * step);
    landing(at).1 / moved(DVec2::X * step).perp_dot(moved(DVec2::Y * step)).abs()
}

/// Without folded light a map of triangles of many texels has the exact light in each, not that of facets.
#[test]
fn light_is_smooth_over_triangles() {
    gpu_test(|device| {
        let waves = WaveParameters { count: 12, amplitude_m: 0.05, wavelength_m: 2.4 };
        let parameters = Parameters { waves, map_size: 256, ..parameters(OVERHEAD) };
        let receiver = floor();
        let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
        let oracle = Oracle::of(&parameters, &OVERHEAD, &receiver, &drawing.grid);
        let unknown = vec![0.0; oracle.water.len()];
        let facets = landed_map(landed_triangles(&drawing, &oracle, &unknown), 256);
        let surface = waves_surface(&parameters);
        let texel_m = oracle.receiver.width / 256.0;
        let (mut count, mut smooth, mut faceted) = (0.0, 0.0, 0.0);
        for (row, column) in (8..248).step_by(3).flat_map(|row| (8..248).step_by(3).map(move |column| (row, column))) {
            let aside = (DVec2::new(f64::from(column), f64::from(row)) - 127.5) * texel_m;
            let place = oracle.receiver.to_world(DVec3::new(aside.x, 0.0, aside.y));
            let exact = exact_light(&surface, &oracle, place.y, DVec2::new(place.x, place.z));
            let texel = (256 * row + column) as usize;
            count += 1.0;
            smooth += (f64::from(drawing.target("caustics-map")[texel]) / exact - 1.0).powi(2);
            faceted += (facets[texel] / exact - 1.0).powi(2);
        }
        let [smooth, faceted] = [smooth, faceted].map(|sum: f64| (sum / count).sqrt());
        println!("{} triangles: off by {smooth:.5}, facets by {faceted:.5}", drawing.grid.triangle_count());
        assert!(smooth < 0.005 && smooth < faceted / 2.0, "{smooth} {faceted}");
    });
}

/// The sums are whole numbers: one picture, whatever the order in which they were added.
#[test]
fn hit_is_the_same_each_time() {
    gpu_test(|device| {
        let parameters = Parameters { shadows: true, lights: vec![OBLIQUE, POINT], ..parameters(OVERHEAD) };
        let [one, other] = [0, 1].map(|_| Drawing::of(device, Variant::Hit, &parameters, &[teapot(), floor()]));
        for name in ["caustics-map", "landings", "underwater-color"] {
            assert!(one.target(name) == other.target(name), "{name}");
        }
        assert!(one.map("caustics-map", 1, 1) == other.map("caustics-map", 1, 1));
        assert!(one.target("caustics-map").iter().any(|&light| light > 0.0));
    });
}

/// Planes play no part, in any target.
#[test]
fn hit_is_the_same_with_any_number_of_planes() {
    gpu_test(|device| {
        let parameters = Parameters { shadows: true, ..parameters(OBLIQUE) };
        let [one, many] = [1, 101].map(|planes| {
            Drawing::of(device, Variant::Hit, &Parameters { planes, ..parameters.clone() }, &[teapot(), floor()])
        });
        assert!(one.names().eq(many.names()) && one.names().count() > 10);
        for name in one.names() {
            assert!(one.target(name) == many.target(name), "{name}");
        }
        assert_eq!(one.picture, many.picture);
    });
}

/// Few beams, each over thousands of texels: a driver that ends loops early leaves light out, and the frame fails.
#[test]
fn light_that_loops_leave_out_is_missed() {
    let scene = "render --variant hit --mesh teapot --light 1,-0.2,0 --map-size 2048 --water-triangles 2 --size 16x12";
    let folder = folder();
    let program = caustics(scene).on_test_device().arg("--quiet").arg("--image").arg(folder.path().join("a.png"));
    program.run().refused(1, &["straddle", "left light out", "--water-triangles"]);
}
