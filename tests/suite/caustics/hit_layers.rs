//! The variant `hit` with several layers: surfaces that the receiver hides from the light's box, against rays and photons.

use std::f32::consts::{FRAC_PI_4, PI, TAU};
use std::slice::from_ref;

use fumarole::image::compare;
use fumarole::papers::caustics::reference::{Photons, Tracer, correlation, flat_water_point_intensity};
use fumarole::papers::caustics::{Parameters, ReceiverInput, Variant, WaveParameters};
use fumarole::scene::{Light, Mesh, shapes};
use glam::{DVec2, DVec3, Mat4, UVec2, Vec2, Vec3};

use super::drawing::Drawing;
use super::hit_shapes::{STEEP, filled, position_of, shown, triangles};
use super::oracle::{Oracle, waves_surface};
use super::scene::{FLAT, OBLIQUE, OVERHEAD, POINT, parameters, sunk};
use crate::common::gpu_test;

/// It is near, so that its light spreads: what enters beside the plate lands below it.
const NEAR: Light = Light::Point { position: Vec3::new(-0.3, 0.5, -0.2), intensity: Vec3::ONE };

/// Adds a mesh to another.
fn add(mesh: &mut Mesh, other: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.indices.extend(other.indices.iter().map(|i| i + first));
    mesh.positions.extend(&other.positions);
    mesh.normals.extend(&other.normals);
    mesh.texture_coordinates.extend(&other.texture_coordinates);
}

/// A square plate over a floor: solid, or a sheet that faces up.
fn plate_over_floor(is_solid: bool) -> ReceiverInput {
    let mut mesh = shapes::plane(Vec2::splat(2.0), UVec2::ONE);
    let plate = if is_solid { shapes::cuboid() } else { shapes::plane(Vec2::ONE, UVec2::ONE) };
    let size = plate.bounds().diagonal();
    let scale = Vec3::new(0.6, 0.06, 0.5) / Vec3::new(size.x, size.y.max(1.0), size.z);
    let place =
        Mat4::from_translation(Vec3::new(0.55, 0.9, 0.35)) * Mat4::from_rotation_y(0.4) * Mat4::from_scale(scale);
    add(&mut mesh, &plate.placed(&place));
    mesh.name = if is_solid { "plate over a floor" } else { "sheet over a floor" }.to_owned();
    sunk(&mesh)
}

/// A jar with a thick wall, a part of a hollow sphere that narrows to its mouth, where its wall is rounded.
fn jar() -> ReceiverInput {
    const AROUND: u32 = 128;
    let (radius, half_wall) = (0.9, 0.05);
    let from = -PI / 2.0;
    // Radius, height, and the normal's part along each.
    let arc = |radius: f32, facing: f32, angle: f32| {
        let direction = Vec2::from_angle(angle);
        (direction * radius, direction * facing)
    };
    let along = |count: u32, from: f32, to: f32| (0..=count).map(move |i| from + (to - from) * i as f32 / count as f32);
    let middle = Vec2::from_angle(FRAC_PI_4) * radius;
    let outside = along(80, from, FRAC_PI_4).map(|angle| arc(radius + half_wall, 1.0, angle));
    let rim = along(16, FRAC_PI_4, FRAC_PI_4 + PI).map(|angle| {
        let direction = Vec2::from_angle(angle);
        (middle + direction * half_wall, direction)
    });
    let inside = along(80, FRAC_PI_4, from).map(|angle| arc(radius - half_wall, -1.0, angle));
    let profile: Vec<(Vec2, Vec2)> = outside.chain(rim).chain(inside).collect();
    let mut mesh = Mesh { name: "jar".to_owned(), ..Mesh::default() };
    for turn in 0..=AROUND {
        let turn = Vec2::from_angle(TAU * turn as f32 / AROUND as f32);
        let turned = |at: Vec2| Vec3::new(at.x * turn.x, at.y, at.x * turn.y);
        mesh.positions.extend(profile.iter().map(|&(at, _)| turned(at)));
        mesh.normals.extend(profile.iter().map(|&(_, normal)| turned(normal)));
        mesh.texture_coordinates.extend(profile.iter().map(|_| Vec2::ZERO));
    }
    let rows = profile.len() as u32;
    for (turn, row) in (0..AROUND).flat_map(|turn| (0..rows - 1).map(move |row| (turn, row))) {
        let (a, b) = (turn * rows + row, (turn + 1) * rows + row);
        mesh.indices.extend([a, a + 1, b, b, a + 1, b + 1]);
    }
    sunk(&mesh)
}

/// Light that stands aside shines below a plate, and where it does follows from rays: the place in the map of the floor below.
#[test]
fn light_shines_below_what_hides_the_floor() {
    gpu_test(|device| {
        for is_solid in [true, false] {
            let light = NEAR;
            let clear = Parameters { waves: FLAT, absorption_per_m: 0.0, map_size: 256, ..parameters(light) };
            let parameters = Parameters { layers: 2, water_triangles: 10_000, ..clear };
            let receiver = plate_over_floor(is_solid);
            let name = receiver.mesh.name.clone();
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let tracer = Tracer::new(&triangles(&receiver, &oracle.receiver));
            let heights = drawing.target("hidden-position-map");
            let floor_m = -f64::from(parameters.water_depth_m);
            let (mut dark, mut leaks, mut lit, mut missed) = (0, 0, 0, 0);
            for texel in filled(heights, 1) {
                let point = shown(&oracle.receiver, heights, texel);
                assert!((point.y - floor_m).abs() < 1e-3, "{name}: {point}");
                let is_shaded = |at: DVec3| {
                    let (_, entry) = flat_water_point_intensity(position_of(light), at, oracle.medium).unwrap();
                    let (from, ray) = (oracle.receiver.to_box(entry), oracle.receiver.direction_to_box(at - entry));
                    tracer.first_hit(from, ray, 0.0).is_some_and(|(distance, _)| distance < 1.0 - 1e-5)
                };
                // A triangle of light may reach some texels over the shadow's edge.
                let around =
                    [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|aside| is_shaded(point + aside * 0.025));
                let (expected, _) = flat_water_point_intensity(position_of(light), point, oracle.medium).unwrap();
                let share = f64::from(drawing.target("hidden-caustics-map")[texel]) / expected;
                if around.iter().all(|&is| is) && is_shaded(point) {
                    dark += 1;
                    leaks += u32::from(share > 0.05);
                } else if around.iter().all(|&is| !is) && !is_shaded(point) {
                    lit += 1;
                    missed += u32::from((share - 1.0).abs() > 0.05);
                }
            }
            println!("{name}: {leaks} of {dark} texels in shadow are lit, {missed} of {lit} in light are not");
            assert!(dark > 1000 && leaks * 50 <= dark, "{name}: {leaks} of {dark}");
            assert!(lit > 200 && missed * 50 <= lit, "{name}: {missed} of {lit}");
            // The first surface has its light as without further layers, but where light comes from below the plate.
            let alone = Drawing::of(device, Variant::Hit, &Parameters { layers: 1, ..parameters }, from_ref(&receiver));
            let (found, expected) = (drawing.target("caustics-map"), alone.target("caustics-map"));
            let off = found.iter().zip(expected).filter(|(a, b)| (*a - *b).abs() > 0.01 * b.abs().max(0.1)).count();
            println!("{name}: {off} of {} texels of the first surface differ", found.len());
            assert!(off * 100 <= found.len(), "{name}: {off}");
        }
    });
}

/// Waves bend light under a jar's narrowing wall, a light aside shines there: as much as photons find, where they find it.
#[test]
fn hit_lights_the_inside_of_a_jar_as_photons_do() {
    gpu_test(|device| {
        for light in [OVERHEAD, OBLIQUE, POINT] {
            let parameters =
                Parameters { waves: STEEP, map_size: 128, water_triangles: 10_000, layers: 2, ..parameters(light) };
            let receiver = jar();
            let drawing = Drawing::of(device, Variant::Hit, &parameters, from_ref(&receiver));
            let oracle = Oracle::of(&parameters, &light, &receiver, &drawing.grid);
            let corners = triangles(&receiver, &oracle.receiver);
            let tracer = Tracer::new(&corners);
            let hit = |origin: DVec3, ray: DVec3| {
                let (distance_m, index) = tracer.first_hit(origin, ray, 0.0)?;
                let [a, b, c] = corners[index];
                let across = (b - a).cross(c - a);
                let normal = (if across.dot(ray) > 0.0 { -across } else { across }).normalize();
                let place = origin + ray * distance_m;
                let is_hidden = normal.y > 0.0 && tracer.first_hit(place, DVec3::Y, 1e-6).is_some();
                is_hidden.then_some((distance_m, normal))
            };
            let (low, high) = (drawing.grid.corner, drawing.grid.corner + drawing.grid.extent_m());
            let surface = waves_surface(&parameters);
            let halves = [0.25, 0.75].map(|place| {
                let photons = Photons { low, high, strata: [1200; 2], place: DVec2::splat(place), is_reflected: false };
                photons.landed(&surface, oracle.light, oracle.medium, &oracle.receiver, hit, 128)
            });
            let held = filled(drawing.target("hidden-position-map"), 1);
            let at = |map: &[f64]| held.iter().map(|&texel| map[texel]).collect::<Vec<f64>>();
            let [one, other] = halves.each_ref().map(|half| at(half));
            let truth: Vec<f64> = one.iter().zip(&other).map(|(a, b)| (a + b) / 2.0).collect();
            let map = drawing.target("hidden-caustics-map");
            let found: Vec<f64> = held.iter().map(|&texel| f64::from(map[texel])).collect();
            // As it is seen (eq. 4-19): where a wall is grazed a texel's light means little, and photons are few.
            let diffuse = drawing.target("hidden-diffuse-map");
            let shown = |map: &[f64]| -> Vec<f64> {
                map.iter().zip(&held).map(|(light, &texel)| light * f64::from(diffuse[4 * texel])).collect()
            };
            let (found, truth) = (shown(&found), shown(&truth));
            let like = correlation(&found, &truth);
            let flux = found.iter().sum::<f64>() / truth.iter().sum::<f64>();
            let lit = truth.iter().filter(|&&light| light > 0.05).count();
            println!(
                "jar under {light:?}: {lit} of {} hidden texels are lit, correlation {like:.4} (halves {:.4}), flux {flux:.4}",
                held.len(),
                correlation(&shown(&one), &shown(&other))
            );
            assert!(lit > 100 && like > 0.93, "{light:?}: {lit} {like}");
            assert!((flux - 1.0).abs() < 0.08, "{light:?}: {flux}");
        }
    });
}

/// Straight light meets nothing that is hidden from its box; what is hidden has maps all the same, and a picture shows no difference.
#[test]
fn straight_light_finds_nothing_hidden() {
    gpu_test(|device| {
        let plain = Parameters { waves: FLAT, ..parameters(OVERHEAD) };
        let layered = Parameters { layers: 4, ..plain.clone() };
        let [one, several] = [&plain, &layered].map(|p| Drawing::of(device, Variant::Hit, p, &[jar()]));
        // Rays are followed farther down, which changes the last digits.
        let difference = compare(&one.picture, &several.picture, None).unwrap();
        assert!(difference.max < 1.0 && difference.mean < 1e-3, "{difference:?}");
        let maps = one.target("caustics-map").iter().zip(several.target("caustics-map"));
        let apart = maps.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-3, "{apart}");
        assert!(several.target("hidden-caustics-map").iter().all(|&light| light == 0.0));
        let heights = several.target("hidden-position-map");
        let held: Vec<usize> =
            heights.chunks_exact(128 * 128).map(|layer| layer.iter().filter(|&&h| h > -1e29).count()).collect();
        assert!(held[0] > 1000 && held[1..] == [0, 0], "{held:?}");
    });
}

/// A surface below an overhang is seen lit, and nothing is darker for it.
#[test]
fn a_picture_shows_the_light_below_an_overhang() {
    gpu_test(|device| {
        let plain = Parameters {
            waves: WaveParameters { amplitude_m: 0.01, ..Parameters::default().waves },
            ..parameters(NEAR)
        };
        let plain = Parameters { width: 256, height: 192, ..plain };
        let layered = Parameters { layers: 2, ..plain.clone() };
        let receiver = plate_over_floor(true);
        let [one, several] =
            [&plain, &layered].map(|p| Drawing::of(device, Variant::Hit, p, from_ref(&receiver)).picture);
        let (mut brighter, mut darker) = (0, 0);
        for (a, b) in one.pixels().chunks_exact(4).zip(several.pixels().chunks_exact(4)) {
            brighter += u32::from(b[0] > a[0].saturating_add(8));
            darker += u32::from(a[0] > b[0].saturating_add(8));
        }
        println!("{brighter} pixels are brighter, {darker} darker");
        assert!(brighter > 50 && darker * 10 <= brighter, "{brighter} {darker}");
    });
}
