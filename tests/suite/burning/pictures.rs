//! The finished picture of each variant.

use std::path::Path;
use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::gpu::transfer::read_image;
use fumarole::image::golden::{self, Tolerance};
use fumarole::image::{Rgba8, srgb};
use fumarole::measure::{Paper, Variant as _};
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::{Parameters, Shading, Variant};
use fumarole::scene::{Mesh, MeshSource, shapes};
use glam::{UVec2, Vec2};

use super::fire::{Fire, ball, quick, text};
use crate::common::gpu_test;

/// Tight: the same Mesa draws the same picture, another one rounds differently here and there.
const TOLERANCE: Tolerance = Tolerance { mean: 0.1, p99: 1.0 };

/// The bunny of 2,000 triangles, and for the methods of chapter 4 the box of 12.
fn object(variant: Variant) -> Mesh {
    match variant {
        Variant::LowPoly | Variant::FullySubdivided => shapes::cuboid(),
        _ => with_triangles(&MeshSource::Bunny.load().unwrap(), 2000),
    }
}

#[test]
fn the_object_fills_its_share_of_the_picture() {
    gpu_test(|device| {
        // A tall object its height, a wide one the width.
        for (mesh, by_height) in [(MeshSource::Bunny, true), (MeshSource::Teapot, false)] {
            let (width, height) = (120, if by_height { 90 } else { 120 });
            let parameters = Parameters { shading: Shading::Normals, fire: 0, smoke: 0, width, height, ..text() };
            let mut fire = Fire::new(device, Variant::Shell, &parameters, &mesh.load().unwrap());
            fire.frame(0);
            let texels = read_image(device, fire.paper.picture()).unwrap();
            let is_object = |i: u32| texels[4 * i as usize..][..3] != texels[..3];
            let drawn: Vec<u32> = (0..width * height).filter(|i| is_object(*i)).collect();
            let extent = |at: fn(u32, u32) -> u32| {
                let places = drawn.iter().map(|i| at(*i, width));
                f64::from(places.clone().max().unwrap() - places.min().unwrap() + 1)
            };
            let columns = extent(|i, width| i % width) / f64::from(width);
            let rows = extent(|i, width| i / width) / f64::from(height);
            let (filled, other) = if by_height { (rows, columns) } else { (columns, rows) };
            assert!((filled - 0.8).abs() < 0.025 && other < 0.82, "{mesh}: {columns} x {rows}");
        }
    });
}

/// The picture of a sheet on the ground, in the light of the sun alone.
fn sheet(device: &Arc<Device>, ground: bool, number: u32) -> Vec<u8> {
    let quick = Parameters { speed_per_s: 1.0, flammability: 10, fire: 0, smoke: 0, ..Parameters::default() };
    let parameters = Parameters { ground, width: 160, height: 120, ..quick };
    let mut fire = Fire::new(device, Variant::Shell, &parameters, &shapes::plane(Vec2::ONE, UVec2::splat(8)));
    fire.frame(number);
    read_image(device, fire.paper.picture()).unwrap()
}

#[test]
fn a_sheet_on_the_ground_hides_it_and_leaves_ash_all_over() {
    gpu_test(|device| {
        let alone = sheet(device, false, 0);
        let of_sheet = |picture: &[u8]| {
            let pixels = alone.chunks_exact(4).zip(picture.chunks_exact(4));
            pixels.filter(|(pixel, _)| pixel[..] != alone[..4]).map(|(_, there)| there.to_vec()).collect::<Vec<_>>()
        };
        let on_ground = sheet(device, true, 0);
        assert!(on_ground != alone && of_sheet(&alone).len() > 1000);
        assert!(of_sheet(&on_ground) == of_sheet(&alone));
        // It has burnt.
        let mut ash: Vec<u8> = of_sheet(&sheet(device, true, 300)).iter().map(|pixel| pixel[0]).collect();
        ash.sort_unstable();
        let [median, most] = [ash[ash.len() / 2], ash[ash.len() - 1]].map(f64::from);
        assert!(median > 0.7 * most, "{median} of {most}");
    });
}

#[test]
fn a_late_picture_is_that_of_all_frames_before_it() {
    gpu_test(|device| {
        let mesh = shapes::cuboid();
        // So slow that it still burns; more ticks than a frame records.
        let parameters = Parameters { speed_per_s: 0.02, ..quick() };
        let [mut stepped, mut late] = [0, 1].map(|_| Fire::new(device, Variant::LowPoly, &parameters, &mesh));
        stepped.ticks(1500);
        stepped.frame(1500);
        late.frame(1500);
        assert!(stepped.state() == late.state());
        let counts = late.paper.counts().unwrap();
        assert!(counts.tick == 1501 && counts.active_vertices > 0 && counts.drawn_triangles > 0, "{counts:?}");
        let picture = |fire: &Fire| read_image(device, fire.paper.picture()).unwrap();
        assert!(picture(&stepped) == picture(&late));
    });
}

#[test]
fn the_pictures_are_the_golden_ones() {
    gpu_test(|device| {
        for &variant in Variant::ALL {
            let parameters = Parameters {
                speed_per_s: 0.2,
                first_frame: 120,
                fire: 300,
                smoke: 100,
                fire_scale: 1,
                width: 128,
                height: 96,
                ..text()
            };
            let mut fire = Fire::new(device, variant, &parameters, &object(variant));
            fire.frame(0);
            let view = fire.paper.picture();
            let texels = read_image(device, view).unwrap();
            let picture = Rgba8::new(view.width(), view.height(), texels).unwrap();
            let file = format!("tests/golden/burning-{}.png", variant.as_str());
            let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
            if let Err(error) = golden::check(&picture, &golden, TOLERANCE, Path::new(env!("CARGO_TARGET_TMPDIR"))) {
                panic!("{error}");
            }
        }
    });
}

/// Luminance of the background and mean luminance of what is not background, with its mean red over its mean blue, of a
/// picture without fire.
fn seen(fire: &Fire, device: &Arc<Device>) -> [f64; 3] {
    let texels = read_image(device, fire.paper.picture()).unwrap();
    let linear = |t: &[u8]| [0, 1, 2].map(|k| srgb::decode(f64::from(t[k]) / 255.0));
    let luminance = |[r, g, b]: [f64; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let mut sums = [0.0; 3];
    let object: Vec<_> = texels.chunks_exact(4).filter(|t| t[..3] != texels[..3]).map(linear).collect();
    object.iter().for_each(|t| (0..3).for_each(|k| sums[k] += t[k]));
    [luminance(linear(&texels[..4])), luminance(sums) / object.len() as f64, sums[0] / sums[2]]
}

#[test]
fn what_has_charred_stands_out_and_wax_keeps_its_colour() {
    gpu_test(|device| {
        let parameters = Parameters { fire: 0, smoke: 0, width: 64, height: 48, ..quick() };
        for (variant, chars) in [(Variant::Solid, true), (Variant::Melting, false)] {
            let mut fire = Fire::new(device, variant, &parameters, &ball());
            fire.frame(0);
            let [_, _, cold] = seen(&fire, device);
            fire.frame(300);
            let [background, burnt, warm] = seen(&fire, device);
            assert!(fire.paper.counts().unwrap().live_vertices == 0, "it has burnt out");
            match chars {
                true => assert!(burnt < background / 3.0 && warm < 1.1, "{burnt} before {background}, {warm}"),
                false => assert!(burnt > 3.0 * background && (warm / cold - 1.0).abs() < 0.05, "{cold} {warm}"),
            }
        }
    });
}
