//! Pictures on the object: coordinates stay with the corners, also where these are welded and refined.

use std::sync::Arc;

use fumarole::gpu::transfer::read_image;
use fumarole::gpu::{Compiler, Device};
use fumarole::image::{Rgba8, srgb};
use fumarole::measure::Paper;
use fumarole::papers::burning::model::Model;
use fumarole::papers::burning::{Parameters, Texture, Variant, with_levels};
use fumarole::scene::{Mesh, shapes};
use glam::{DMat4, DVec2, DVec3, Vec2, Vec3};

use super::fire::{Fire, text};
use crate::common::{gpu_test, shaders_by};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

/// Rectangles in z = 0, each with vertices of its own: corner and opposite corner, and their texture coordinates.
fn sheets(parts: &[[Vec2; 4]]) -> Mesh {
    let mut mesh = Mesh { name: "sheets".to_owned(), ..Mesh::default() };
    for [low, high, from, to] in parts {
        let first = mesh.positions.len() as u32;
        for at in [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y] {
            mesh.positions.push((low + at * (high - low)).extend(0.0));
            mesh.texture_coordinates.push(from + at * (to - from));
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    mesh.smooth_normals();
    mesh.validate().unwrap();
    mesh
}

fn texture(width: u32, height: u32, color: impl Fn(u32, u32) -> [u8; 3]) -> (Rgba8, Arc<Texture>) {
    let texel = |i: u32| {
        let [r, g, b] = color(i % width, i / width);
        [r, g, b, 255]
    };
    let picture = Rgba8::new(width, height, (0..width * height).flat_map(texel).collect()).unwrap();
    let texture = Arc::new(with_levels(&picture));
    (picture, texture)
}

fn covered(texture: &Arc<Texture>) -> Parameters {
    Parameters {
        texture: Some(texture.clone()),
        albedo: Some(Vec3::ONE),
        background: Vec3::ZERO,
        sources: vec![Vec3::new(900.0, 0.0, 0.0)],
        fire: 0,
        smoke: 0,
        width: WIDTH,
        height: HEIGHT,
        ..text()
    }
}

fn pixels(device: &Arc<Device>, fire: &Fire) -> Vec<[u8; 4]> {
    bytemuck::pod_collect_to_vec(&read_image(device, fire.paper.picture()).unwrap())
}

#[test]
fn children_have_the_coordinates_of_their_own_coarse_triangle() {
    let mut mesh = shapes::cuboid();
    // Faces that share no coordinate, so that every welded edge is a seam.
    for (vertex, coordinate) in mesh.texture_coordinates.iter_mut().enumerate() {
        *coordinate += Vec2::new((vertex / 4) as f32 * 3.0, 0.0);
    }
    for levels in 0..=3 {
        let parameters = Parameters { levels: Some(levels), ..text() };
        let model = Model::new(&mesh, Variant::LowPoly, &parameters, 1 << 27).unwrap();
        let lattice = &model.lattice;
        assert_eq!(lattice.texture_coordinates.len(), lattice.welds.len());
        let place = |corner: u32| lattice.positions[lattice.welds[corner as usize] as usize].as_dvec3();
        let mut seams = vec![Vec::new(); lattice.positions.len()];
        for (at, children) in lattice.finest().chunks(1 << (2 * levels)).enumerate() {
            let coarse = lattice.nodes[0][at];
            let [a, b, c] = coarse.map(place);
            let given = [0, 1, 2].map(|k| mesh.texture_coordinates[mesh.indices[3 * at + k] as usize].as_dvec2());
            let area = (b - a).cross(c - a);
            for &corner in children.as_flattened() {
                let p = place(corner);
                let share = |q: DVec3, r: DVec3| (q - p).cross(r - p).dot(area) / area.length_squared();
                let expected: DVec2 = share(b, c) * given[0] + share(c, a) * given[1] + share(a, b) * given[2];
                let [u, v] = lattice.texture_coordinates[corner as usize];
                assert!(expected.distance(DVec2::new(u.into(), v.into())) < 1e-5, "{corner}: {u} {v}, not {expected}");
                seams[lattice.welds[corner as usize] as usize].push([u, v].map(f32::to_bits));
            }
        }
        // On an edge of the box two faces meet, in a corner three.
        let mut counts = [0; 4];
        for mut list in seams {
            list.sort_unstable();
            list.dedup();
            counts[list.len()] += 1;
        }
        assert_eq!(counts[3], 8);
        assert_eq!(counts[2], 12 * ((1 << levels) - 1));
    }
}

#[test]
fn a_seam_stays_sharp_where_its_vertices_are_welded() {
    let (_, halves) = texture(16, 16, |x, _| if x < 8 { [255, 0, 0] } else { [0, 0, 255] });
    let of = |low: f32, from: f32| {
        [Vec2::new(low, 0.0), Vec2::new(low + 1.0, 1.5), Vec2::new(from, 0.1), Vec2::new(from + 0.2, 0.9)]
    };
    let mesh = sheets(&[of(-1.0, 0.15), of(0.0, 0.65)]);
    gpu_test(|device| {
        for (variant, levels) in [(Variant::Shell, 0), (Variant::FullySubdivided, 3), (Variant::LowPoly, 3)] {
            // All is refined ahead of the boundary, and nothing is charred yet.
            let parameters = Parameters {
                levels: Some(levels),
                sources: vec![Vec3::new(0.0, -0.2, 0.0)],
                width_of_areas: 0.5,
                ..covered(&halves)
            };
            let mut fire = Fire::new(device, variant, &parameters, &mesh);
            assert_eq!(
                fire.paper.model().rest.len(),
                (2 * (1 << levels) + 1) * ((1 << levels) + 1),
                "the seam is welded"
            );
            fire.frame(0);
            assert_eq!(fire.paper.counts().unwrap().drawn_triangles, 4 << (2 * levels), "{variant:?}");
            let [mut red, mut blue] = [0; 2];
            for [r, _, b, _] in pixels(device, &fire) {
                assert!(r < 60 || b < 60, "{variant:?}: red and blue mix: {r} {b}");
                red += u32::from(r > 120);
                blue += u32::from(b > 120);
            }
            assert!(red.min(blue) > 800, "{variant:?}: {red} {blue}");
        }
    });
}

/// Linear light of a repeated picture between its four nearest texels, (0, 0) the lower left corner.
fn sampled(picture: &Rgba8, at: DVec2) -> DVec3 {
    let size = [picture.width(), picture.height()].map(i64::from);
    let texel = |x: i64, y: i64| {
        let i = 4 * (y.rem_euclid(size[1]) * size[0] + x.rem_euclid(size[0])) as usize;
        DVec3::from_array([0, 1, 2].map(|k| srgb::decode(f64::from(picture.pixels()[i + k]) / 255.0)))
    };
    let place = DVec2::new(at.x * size[0] as f64, (1.0 - at.y) * size[1] as f64) - 0.5;
    let (low, t) = (place.floor(), place - place.floor());
    let (x, y) = (low.x as i64, low.y as i64);
    texel(x, y).lerp(texel(x + 1, y), t.x).lerp(texel(x, y + 1).lerp(texel(x + 1, y + 1), t.x), t.y)
}

#[test]
fn every_pixel_shows_its_place_of_the_picture() {
    let noise = |x: u32, y: u32| [x * 37 % 251, y * 91 % 241, (x * 13 + y * 57) % 239].map(|v| v as u8);
    let (picture, noisy) = texture(7, 5, noise);
    // Once and a half, from outside of the picture.
    let (from, to) = (Vec2::new(-0.25, -0.4), Vec2::new(1.25, 1.1));
    let mesh = sheets(&[[Vec2::NEG_ONE, Vec2::ONE, from, to]]);
    gpu_test(|device| {
        for compiler in [Compiler::Glslang, Compiler::Naga] {
            let mut fire = Fire::compiled(device, compiler, Variant::Shell, &covered(&noisy), &mesh);
            fire.frame(0);
            let camera = fire.paper.camera();
            let seen = camera.projection(WIDTH as f32 / HEIGHT as f32).as_dmat4() * camera.view().as_dmat4();
            let back: DMat4 = seen.inverse();
            // Of a surface that faces +z, with an ambient share of 0.35.
            let light = 0.35 + 0.65 * DVec3::new(0.45, 0.75, 0.6).normalize().z;
            let side = 0.5_f64.sqrt();
            let mut shown = 0;
            for (i, pixel) in (0..).zip(pixels(device, &fire)) {
                let at = DVec2::new(f64::from(i % WIDTH) + 0.5, f64::from(i / WIDTH) + 0.5);
                let at = 2.0 * at / DVec2::new(WIDTH.into(), HEIGHT.into()) - 1.0;
                let [near, far] = [0.2, 0.9].map(|depth| back.project_point3(at.extend(depth)));
                let place = near + (far - near) * (near.z / (near.z - far.z));
                let share = DVec2::new(place.x / side + 0.5, place.y / side);
                // Pixels that the edges cut belong to neither side for certain.
                if share.min_element() < 0.02 || share.max_element() > 0.98 {
                    continue;
                }
                let expected = light * sampled(&picture, from.as_dvec2() + share * (to - from).as_dvec2());
                for (ours, theirs) in expected.to_array().iter().zip(pixel) {
                    let off = (255.0 * srgb::encode(*ours) - f64::from(theirs)).abs();
                    assert!(off < 1.5, "pixel {i}: {expected} is not {pixel:?}");
                }
                shown += 1;
            }
            assert!(shown > 1000, "{shown}");
        }
    });
}

#[test]
fn a_picture_of_many_texels_a_pixel_does_not_flicker() {
    let (_, board) = texture(256, 256, |x, y| [255 * ((x + y) % 2) as u8; 3]);
    let mesh = sheets(&[[Vec2::NEG_ONE, Vec2::ONE, Vec2::ZERO, Vec2::splat(3.0)]]);
    let (_, dot) = texture(1, 1, |_, _| [188; 3]);
    gpu_test(|device| {
        let shown = |texture: &Arc<Texture>| {
            let mut fire = Fire::new(device, Variant::Shell, &covered(texture), &mesh);
            fire.frame(0);
            pixels(device, &fire)
        };
        // From afar a board of black and white is half as light as white, as one texel of that grey is.
        for (board, dot) in shown(&board).into_iter().zip(shown(&dot)) {
            assert!(board[0].abs_diff(dot[0]) <= 2, "{board:?} {dot:?}");
        }
    });
}

#[test]
fn a_mesh_without_coordinates_takes_no_texture() {
    let (_, dot) = texture(1, 1, |_, _| [188; 3]);
    let mesh = Mesh { texture_coordinates: Vec::new(), ..shapes::cuboid() };
    gpu_test(|device| {
        let shaders = shaders_by(device, Compiler::Glslang);
        let made = fumarole::papers::burning::Burning::new(&shaders, "test", Variant::Shell, &covered(&dot), &mesh);
        let error = made.err().unwrap().to_string();
        assert!(error.contains("no texture coordinates"), "{error}");
    });
}
