//! The variant `hit` where beams slant and receivers hide parts of themselves: closed forms, photons, an edge as thin as texels.

use std::slice::from_ref;

use fumarole::papers::caustics::reference::{Photons, ReceiverBox, Tracer, correlation, flat_water_point_intensity};
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::{Light, shapes};
use glam::{DVec2, DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::oracle::{Oracle, waves_surface};
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, floor, parameters, round_sphere, sunk, tilted_plane};
use crate::common::gpu_test;

pub(super) const STEEP: WaveParameters = WaveParameters { count: 12, amplitude_m: 0.21, wavelength_m: 1.2 };

/// The point of the receiver that a texel's middle shows, in the world.
pub(super) fn shown(receiver: &ReceiverBox, heights: &[f32], texel: usize) -> DVec3 {
    let size = heights.len().isqrt();
    let place = |at: usize, extent: f64| ((at as f64 + 0.5) / size as f64 - 0.5) * extent;
    let (x, z) = (place(texel % size, receiver.width), place(texel / size, receiver.depth));
    receiver.to_world(DVec3::new(x, f64::from(heights[texel]), z))
}

/// The texels that hold the receiver with all around them, as far as `reach`.
pub(super) fn filled(heights: &[f32], reach: usize) -> Vec<usize> {
    let size = heights.len().isqrt();
    let is_filled = |&texel: &usize| {
        let (x, y) = (texel % size, texel / size);
        let inside = |at: usize| at >= reach && at + reach < size;
        let is_held = |y: usize| heights[y * size + x - reach..=y * size + x + reach].iter().all(|&h| h > -1e29);
        inside(x) && inside(y) && (y - reach..=y + reach).all(is_held)
    };
    (0..heights.len()).filter(is_filled).collect()
}

pub(super) fn position_of(light: Light) -> DVec3 {
    match light {
        Light::Point { position, .. } => position.as_dvec3(),
        Light::Parallel { .. } => panic!("no point light"),
    }
}

/// Under a point light every beam slants otherwise, and I_c of flat water is known at each point: on slopes that turn away from
/// the light, at small maps whose texels are long there, where triangles that land whole meet those that straddle.
#[test]
fn a_point_light_over_flat_water_lights_by_its_closed_form() {
    gpu_test(|device| {
        for (receiver, map_size) in [(floor(), 64), (tilted_plane(), 128), (round_sphere(), 64), (round_sphere(), 128)]
        {
            let parameters = Parameters { waves: FLAT, map_size, water_triangles: 10_000, ..parameters(POINT) };
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &POINT, &receiver, &drawing.grid);
            let heights = drawing.target("position-map");
            let center = oracle.receiver.center;
            let is_sphere = receiver.mesh.name == "round sphere";
            let (mut found, mut expected, mut farthest) = (Vec::new(), Vec::new(), 0.0_f64);
            for texel in filled(heights, 1) {
                let point = shown(&oracle.receiver, heights, texel);
                let (light, entry) = flat_water_point_intensity(position_of(POINT), point, oracle.medium).unwrap();
                let ray = (point - entry).normalize();
                // Beyond the terminator the sphere shades itself.
                let facing = if is_sphere { -(point - center).normalize().dot(ray) } else { 1.0 };
                if facing < 0.05 {
                    continue;
                }
                found.push(f64::from(drawing.target("caustics-map")[texel]));
                expected.push(light);
                farthest = farthest.max((found[found.len() - 1] / light - 1.0).abs());
            }
            let count = found.len() as f64;
            let square = found.iter().zip(&expected).map(|(a, b)| (a / b - 1.0).powi(2)).sum::<f64>();
            let (rms, correlation) = ((square / count).sqrt(), correlation(&found, &expected));
            let flux = found.iter().sum::<f64>() / expected.iter().sum::<f64>();
            let name = format!("{}, {map_size} texels", receiver.mesh.name);
            println!(
                "{name}: {count} texels, rms {rms:.5}, farthest {farthest:.4}, correlation {correlation:.5}, flux {flux:.5}"
            );
            let most = if is_sphere { (0.02, 0.5) } else { (0.003, 0.05) };
            assert!(count > 1000.0 && rms < most.0 && farthest < most.1, "{name}: {rms} {farthest}");
            assert!(correlation > 0.99 && (flux - 1.0).abs() < 0.002, "{name}: {correlation} {flux}");
        }
    });
}

/// The receiver's triangles in box space.
pub(super) fn triangles(receiver: &ReceiverInput, aligned: &ReceiverBox) -> Vec<[DVec3; 3]> {
    let mesh = &receiver.mesh;
    let corner = |index: u32| aligned.to_box(mesh.positions[index as usize].as_dvec3());
    mesh.indices.chunks_exact(3).map(|corners| [0, 1, 2].map(|i| corner(corners[i]))).collect()
}

/// A bowl so smooth that its facets do not show, deep enough that what enters by one side meets the other.
fn deep_bowl() -> ReceiverInput {
    let mut mesh = shapes::plane(Vec2::splat(2.0), UVec2::splat(128));
    mesh.name = "deep bowl".to_owned();
    for p in &mut mesh.positions {
        p.y = 1.1 * (p.x * p.x + p.z * p.z).min(1.0);
    }
    mesh.smooth_normals();
    sunk(&mesh)
}

/// A concave receiver: light is focused inside it, beams meet its rim and its inner side several times over, and the first counts.
#[test]
fn hit_lights_a_bowl_as_photons_do() {
    gpu_test(|device| {
        for (waves, light) in
            [(Parameters::default().waves, OVERHEAD), (STEEP, OVERHEAD), (STEEP, OBLIQUE), (STEEP, POINT)]
        {
            let parameters = Parameters { waves, map_size: 128, water_triangles: 10_000, ..parameters(light) };
            let receiver = deep_bowl();
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let corners = triangles(&receiver, &oracle.receiver);
            let tracer = Tracer::new(&corners);
            let several = std::sync::atomic::AtomicU64::new(0);
            let hit = |origin: DVec3, ray: DVec3| {
                let (distance_m, index) = tracer.first_hit(origin, ray, 0.0)?;
                let [a, b, c] = corners[index];
                let across = (b - a).cross(c - a);
                let normal = (if across.dot(ray) > 0.0 { -across } else { across }).normalize();
                let place = origin + ray * distance_m;
                if tracer.first_hit(place, ray, 1e-6).is_some() {
                    several.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                }
                // What another part of the bowl hides from the light's box is not in its map.
                let is_hidden = normal.y > 0.0 && tracer.first_hit(place, DVec3::Y, 1e-6).is_some();
                (!is_hidden).then_some((distance_m, normal))
            };
            let (low, high) = (drawing.grid.corner, drawing.grid.corner + drawing.grid.extent_m());
            let surface = waves_surface(&parameters);
            let halves = [0.25, 0.75].map(|place| {
                let photons = Photons { low, high, strata: [1200; 2], place: DVec2::splat(place), is_reflected: false };
                photons.landed(&surface, oracle.light, oracle.medium, &oracle.receiver, hit, 128)
            });
            let held = filled(drawing.target("position-map"), 1);
            let at = |map: &[f64]| held.iter().map(|&texel| map[texel]).collect::<Vec<f64>>();
            let [one, other] = halves.each_ref().map(|half| at(half));
            let truth: Vec<f64> = one.iter().zip(&other).map(|(a, b)| (a + b) / 2.0).collect();
            let found: Vec<f64> = held.iter().map(|&texel| f64::from(drawing.target("caustics-map")[texel])).collect();
            let greatest = |map: &[f64]| map.iter().copied().fold(0.0, f64::max);
            let (like, apart) = (correlation(&found, &truth), greatest(&found) / greatest(&truth));
            let flux = found.iter().sum::<f64>() / truth.iter().sum::<f64>();
            let several = several.into_inner();
            println!(
                "bowl under {light:?}, slope {:.2}: correlation {like:.4} (halves {:.4}), greatest {apart:.3}, flux {flux:.4}, \
                 {several} photons meet it again",
                parameters.mean_slope(),
                correlation(&one, &other)
            );
            assert!(like > 0.98 && (1.0 / 1.3..1.3).contains(&apart), "{light:?}: {like} {apart}");
            assert!((flux - 1.0).abs() < 0.01, "{light:?}: {flux}");
        }
    });
}

/// A wall on the floor, one and a half texels of a map of 2,048 thick, aslant to the map's rows.
fn thin_wall(thickness_m: f32) -> ReceiverInput {
    let mut mesh = shapes::plane(Vec2::splat(2.0), UVec2::ONE);
    let place = Mat4::from_translation(Vec3::new(0.55, 0.0, 0.1)) * Mat4::from_rotation_y(0.5);
    let wall = shapes::cuboid();
    let bounds = wall.bounds();
    let scale = Vec3::new(thickness_m, 0.4, 1.0) / bounds.diagonal();
    let wall = wall.placed(&(place * Mat4::from_scale(scale) * Mat4::from_translation(-Vec3::Y * bounds.min.y)));
    mesh.name = "thin wall".to_owned();
    let first = mesh.positions.len() as u32;
    mesh.indices.extend(wall.indices.iter().map(|i| i + first));
    mesh.positions.extend(&wall.positions);
    mesh.normals.extend(&wall.normals);
    mesh.texture_coordinates.extend(&wall.texture_coordinates);
    sunk(&mesh)
}

/// A thin wall is not stepped over, however fine the map: behind it it is dark, but where a way passes the corner between
/// two texels, and beside it as without it.
#[test]
fn a_wall_as_thin_as_texels_shades_a_large_map() {
    gpu_test(|device| {
        let light = Light::Point { position: Vec3::new(0.0, 2.5, 0.0), intensity: Vec3::ONE };
        let parameters = Parameters {
            waves: FLAT,
            absorption_per_m: 0.0,
            map_size: 2048,
            water_triangles: 10_000,
            ..parameters(light)
        };
        let receiver = thin_wall(1.5 * 2.0 / 2048.0);
        let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
        let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
        let tracer = Tracer::new(&triangles(&receiver, &oracle.receiver));
        let heights = drawing.target("position-map");
        let floor_m = -parameters.water_depth_m;
        let (mut dark, mut leaks, mut lit, mut missed) = (0, 0, 0, 0);
        for (row, column) in
            (20..2028).step_by(5).flat_map(|row| (20..2028).step_by(5).map(move |column| (row, column)))
        {
            let texel = row * 2048 + column;
            let point = shown(&oracle.receiver, heights, texel);
            if (point.y - f64::from(floor_m)).abs() > 1e-3 {
                continue;
            }
            let is_shaded = |at: DVec3| {
                let (_, entry) = flat_water_point_intensity(position_of(light), at, oracle.medium).unwrap();
                let (from, ray) = (oracle.receiver.to_box(entry), oracle.receiver.direction_to_box(at - entry));
                tracer.first_hit(from, ray, 0.0).is_some_and(|(distance, _)| distance < 1.0 - 1e-5)
            };
            // A triangle of light may reach some texels over the shadow's edge.
            let around = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|aside| is_shaded(point + aside * 0.012));
            let (expected, _) = flat_water_point_intensity(position_of(light), point, oracle.medium).unwrap();
            let share = f64::from(drawing.target("caustics-map")[texel]) / expected;
            if around.iter().all(|&is| is) && is_shaded(point) {
                dark += 1;
                leaks += u32::from(share > 0.05);
            } else if around.iter().all(|&is| !is) && !is_shaded(point) {
                lit += 1;
                missed += u32::from((share - 1.0).abs() > 0.05);
            }
        }
        println!("{leaks} of {dark} texels in shadow are lit, {missed} of {lit} in light are not");
        assert!(dark > 300 && leaks * 50 <= dark, "{leaks} of {dark}");
        assert!(lit > 100_000 && missed * 1000 <= lit, "{missed} of {lit}");
    });
}

/// A post 4,000 times as high as wide, on a foot twice as wide: of the ways of rays through its box far more lies beside a large map
/// than over it, and each beam covers a million of its texels. The light on top and foot is that of a small map.
#[test]
fn a_high_post_is_lit_alike_on_maps_of_two_sizes() {
    gpu_test(|device| {
        let (mut post, mut foot) = (shapes::cuboid(), shapes::cuboid());
        post.positions.iter_mut().for_each(|place| *place *= Vec3::new(1.0 / 4000.0, 1.0, 1.0 / 4000.0));
        foot.positions
            .iter_mut()
            .for_each(|place| *place = *place * Vec3::new(1.0 / 2000.0, 0.1, 1.0 / 2000.0) - 0.9 * Vec3::Y);
        let first = post.positions.len() as u32;
        post.indices.extend(foot.indices.iter().map(|index| index + first));
        post.positions.extend(&foot.positions);
        post.normals.extend(&foot.normals);
        post.texture_coordinates.extend(&foot.texture_coordinates);
        let receiver = sunk(&post);
        let [small, large] = [64, 256].map(|map_size| {
            let parameters = Parameters { waves: STEEP, map_size, water_triangles: 40_000, ..parameters(OVERHEAD) };
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
            let heights = drawing.target("position-map");
            let mean = |is_top: bool| {
                let texels = heights.iter().zip(drawing.target("caustics-map"));
                let of_it = texels.filter(|(at, _)| **at > -1e29 && (**at > 0.0) == is_top);
                let lit: Vec<f64> = of_it.map(|(_, &light)| f64::from(light)).collect();
                assert!(lit.len() > 100, "{} texels of {map_size}", lit.len());
                lit.iter().sum::<f64>() / lit.len() as f64
            };
            [mean(true), mean(false)]
        });
        println!("{small:?} and {large:?}");
        assert!(small.iter().zip(large).all(|(small, large)| *small > 0.01 && (large / small - 1.0).abs() < 0.03));
    });
}

/// Few triangles over many texels: what rounding has of a beam beside its edges is no light, and no less than none.
#[test]
fn rounding_at_the_edges_of_large_beams_is_no_light() {
    gpu_test(|device| {
        for mesh in [shapes::teapot(), shapes::sphere(48, 24)] {
            let waves = WaveParameters { count: 12, amplitude_m: 0.2, wavelength_m: 1.2 };
            let parameters = Parameters { waves, map_size: 512, water_triangles: 300, ..parameters(OVERHEAD) };
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&sunk(&mesh)));
            let greatest = drawing.target("caustics-map").iter().copied().fold(0.0, f32::max);
            println!("{}: {greatest}", mesh.name);
            assert!((1.0..1000.0).contains(&greatest), "{}: {greatest}", mesh.name);
        }
    });
}
