//! Lists by tiles: those of `linked` up to the first full cover, and the same pictures.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::model::Object;
use fumarole::papers::gas::reference::coverage::{area, cut};
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Fragment, Lists, Parameters, Variant};
use fumarole::scene::random::Random;
use glam::{DVec2, Vec3};

use super::drawing::Drawing;
use super::lists::{HEIGHT, WIDTH, object, parameters, random_corners, unproject};
use super::scenes::small;
use crate::common::gpu_test;

/// Pixels along a tile's side.
const TILE: u32 = 8;

fn with(lists: Lists, parameters: &Parameters) -> Parameters {
    Parameters { lists, ..parameters.clone() }
}

/// The list is that of `linked` up to the first fragment that hides all behind it, and one more, of which a fraction may show.
/// Behind them some of `linked`'s may be left: a dispatch cuts by the covers among its own triangles, and which those are of a
/// tile that takes several follows from nothing.
fn is_cut_behind_its_cover(list: &[Fragment], linked: &[Fragment]) -> bool {
    let is_cover = |f: &Fragment| f.mask == u32::MAX && f.opacity == 1.0;
    let needed = linked.iter().position(is_cover).map_or(linked.len(), |cover| linked.len().min(cover + 2));
    let (shown, mut hidden) = (&linked[..needed], linked[needed..].iter());
    list.starts_with(shown) && list[needed..].iter().all(|left| hidden.any(|fragment| fragment == left))
}

fn fragments(drawing: &Drawing) -> usize {
    drawing.lists.iter().map(Vec::len).sum()
}

#[test]
fn tiles_make_the_lists_and_pictures_of_linked() {
    gpu_test(|device| {
        for preset in Preset::ALL {
            let (parameters, objects) = small(preset);
            let frame = preset.bench_frame();
            for variant in [Variant::NoVolume, preset.variant()] {
                let draw = |lists| {
                    let parameters = with(lists, &parameters);
                    Drawing::frame(device, Compiler::Glslang, variant, &parameters, &objects, frame)
                };
                let (linked, tiles) = (draw(Lists::Linked), draw(Lists::Tiles));
                for (pixel, (list, linked)) in tiles.lists.iter().zip(&linked.lists).enumerate() {
                    assert!(is_cut_behind_its_cover(list, linked), "{preset:?}, pixel {pixel}: {list:?}\n{linked:?}");
                }
                println!("{preset:?}: {} of {} fragments", fragments(&tiles), fragments(&linked));
                assert!(tiles.radiance == linked.radiance, "{preset:?} {variant:?}");
            }
        }
    });
}

/// Every shadowing has the same picture; with the hither plane through surfaces and gas, and in bands of rows.
#[test]
fn every_variant_draws_the_same_by_tiles() {
    gpu_test(|device| {
        let (mut parameters, objects) = small(Preset::Fig6);
        parameters.camera.near_m = 4.0;
        for variant in [Variant::None, Variant::Surfaces, Variant::Traced, Variant::Table, Variant::Froxel] {
            let linked = Drawing::of(device, variant, &parameters, &objects);
            let tiles = Drawing::of(device, variant, &with(Lists::Tiles, &parameters), &objects);
            assert!(tiles.radiance == linked.radiance, "{variant:?}");
            let bound = Parameters { list_bytes: Some(40_000), ..with(Lists::Tiles, &parameters) };
            let banded = Drawing::of(device, variant, &bound, &objects);
            assert!(banded.demand.rows < parameters.height && banded.radiance == linked.radiance, "{variant:?}");
        }
    });
}

/// Against polygons cut in double precision: a tile has each triangle with a piece in it once, and none whose box of pixels
/// it does not meet, or that lies beyond one of its edges.
#[test]
fn tiles_hold_the_triangles_that_touch_them() {
    gpu_test(|device| {
        let mut random = Random::new(31);
        let corners: Vec<[DVec2; 3]> = [0.7, 4.0, 30.0, 400.0]
            .iter()
            .flat_map(|&reach| [reach; 30])
            .map(|r| random_corners(&mut random, r))
            .collect();
        let triangles: Vec<[Vec3; 3]> = corners.iter().map(|c| c.map(|p| unproject(p, 3.0))).collect();
        let parameters = with(Lists::Tiles, &parameters());
        let drawing = Drawing::of(device, Variant::NoVolume, &parameters, &[object(&triangles)]);
        let across = WIDTH.div_ceil(TILE);
        assert_eq!(drawing.tiles.len() as u32, across * HEIGHT.div_ceil(TILE));
        let (mut held, mut touching) = (0, 0);
        for (tile, list) in (0..).zip(&drawing.tiles) {
            let low = DVec2::new((tile % across * TILE).into(), (tile / across * TILE).into());
            let end = low + f64::from(TILE);
            let high = end.min(DVec2::new(WIDTH.into(), HEIGHT.into())); // of what is in the picture
            for (number, corners) in (0..).zip(&corners) {
                let count = list.iter().filter(|&&n| n == number).count();
                assert!(count <= 1, "triangle {number} is {count} times in tile {tile}");
                let [a, b, c] = *corners;
                let meets_box = a.min(b).min(c).floor().cmplt(high).all() && a.max(b).max(c).ceil().cmpgt(low).all();
                let turn = (b - a).perp_dot(c - a).signum();
                let reaches = |from: DVec2, to: DVec2| {
                    let side = |x, y| turn * (to - from).normalize().perp_dot(DVec2::new(x, y) - from);
                    [side(low.x, low.y), side(end.x, low.y), side(low.x, end.y), side(end.x, end.y)]
                        .into_iter()
                        .any(|side| side > -0.05)
                };
                let may = meets_box && reaches(a, b) && reaches(b, c) && reaches(c, a);
                let scaled = corners.map(|p| (p - low) / (high - low));
                let must = area(&cut(&scaled, DVec2::ZERO)) > 1e-5;
                assert!(count == 1 || !must, "tile {tile} lacks triangle {number}: {corners:?}");
                assert!(count == 0 || may, "tile {tile} has triangle {number}: {corners:?}");
                held += count;
                touching += usize::from(must);
            }
        }
        println!("{held} places for {touching}");
        assert!(touching > 500, "{touching}");
    });
}

/// So many sheets across the view that one dispatch does not do a tile's triangles: all fragments are there, in order.
#[test]
fn tiles_of_many_triangles_are_done_in_several_dispatches() {
    gpu_test(|device| {
        let mut random = Random::new(12);
        let sheets: Vec<[Vec3; 3]> = (0..2500)
            .map(|_| {
                let depth = random.range(2.0, 9.0);
                [(-20.0, -20.0), (220.0, -20.0), (-20.0, 200.0)].map(|(x, y)| unproject(DVec2::new(x, y), depth))
            })
            .collect();
        let sheets = [Object { opacity: 0.001, ..object(&sheets) }];
        let parameters = Parameters { width: 4, height: 3, ..parameters() };
        let linked = Drawing::of(device, Variant::NoVolume, &parameters, &sheets);
        let tiles = Drawing::of(device, Variant::NoVolume, &with(Lists::Tiles, &parameters), &sheets);
        assert!(tiles.lists.iter().all(|list| list.len() == 2500), "{:?}", tiles.demand);
        assert!(tiles.lists == linked.lists && tiles.radiance == linked.radiance);
    });
}

/// Pictures of other sizes than whole tiles, with a triangle, a sliver or nothing in them; far from the origin as well,
/// where depths are rounded more coarsely than tiles are bound by them.
#[test]
fn odd_pictures_are_the_same_by_tiles() {
    gpu_test(|device| {
        let triangle = [(20.0, 10.0), (60.3, 12.0), (31.0, 50.0)].map(|(x, y)| unproject(DVec2::new(x, y), 3.0));
        let sliver = [(20.0, 10.0), (60.3, 12.0), (60.3, 12.01)].map(|(x, y)| unproject(DVec2::new(x, y), 3.0));
        let behind = triangle.map(|corner| corner + 8.0 * Vec3::Z);
        let contents: [&[[Vec3; 3]]; 4] = [&[], &[triangle], &[sliver], &[behind]];
        let sheets: Vec<[Vec3; 3]> = (0..40)
            .map(|i| {
                let depth = 2.0 + 1e-4 * i as f32;
                [(-90.0, -90.0), (300.0, -90.0), (-90.0, 300.0)].map(|(x, y)| unproject(DVec2::new(x, y), depth))
            })
            .collect();
        for (width, height) in [(1, 1), (333, 7), (8, 8), (9, 17)] {
            for (content, triangles) in contents.iter().chain([&sheets.as_slice()]).enumerate() {
                for away in [Vec3::ZERO, Vec3::new(2000.0, -700.0, 3000.0)] {
                    let mut parameters = Parameters { width, height, ..parameters() };
                    parameters.camera.eye += away;
                    parameters.camera.target += away;
                    let moved: Vec<[Vec3; 3]> = triangles.iter().map(|t| t.map(|corner| corner + away)).collect();
                    let objects: Vec<Object> = (!moved.is_empty()).then(|| object(&moved)).into_iter().collect();
                    let linked = Drawing::of(device, Variant::NoVolume, &parameters, &objects);
                    let tiles = Drawing::of(device, Variant::NoVolume, &with(Lists::Tiles, &parameters), &objects);
                    for (list, linked) in tiles.lists.iter().zip(&linked.lists) {
                        assert!(is_cut_behind_its_cover(list, linked), "{content}, {away}: {list:?}\n{linked:?}");
                    }
                    assert!(tiles.radiance == linked.radiance, "{width} x {height}, {content}, {away}");
                }
            }
        }
    });
}

/// A k-buffer has the first fragments of the linked lists, says of how many pixels it shows less, and shows the same of
/// all others.
#[test]
fn a_k_buffer_counts_the_pixels_that_lose_what_shows() {
    gpu_test(|device| {
        for preset in [Preset::Fig3, Preset::Fig4, Preset::Fig8] {
            let (mut parameters, objects) = small(preset);
            parameters.list_bytes = (preset == Preset::Fig8).then_some(60_000);
            let draw = |lists| Drawing::of(device, Variant::NoVolume, &with(lists, &parameters), &objects);
            let all = Parameters { list_bytes: None, ..parameters.clone() };
            let linked = Drawing::of(device, Variant::NoVolume, &all, &objects);
            for nearest in [1, 2, 5, 32] {
                let kept = draw(Lists::Nearest(nearest));
                let count = nearest as usize;
                let shows = |list: &&Vec<Fragment>| {
                    let ends = list.iter().take(count - 1).filter(|f| f.opacity == 1.0);
                    list.len() > count && ends.fold(0, |mask, f| mask | f.mask) != u32::MAX
                };
                let lost = linked.lists.iter().filter(shows).count();
                println!("{preset:?}, k:{nearest}: {lost} pixels lose of {}", linked.lists.len());
                assert_eq!(kept.lost_pixels, Some(lost as u32), "{preset:?}, k:{nearest}");
                if parameters.list_bytes.is_none() {
                    for (list, linked) in kept.lists.iter().zip(&linked.lists) {
                        assert_eq!(list.as_slice(), &linked[..linked.len().min(count)], "{preset:?}, k:{nearest}");
                    }
                } else {
                    assert!(kept.demand.rows < parameters.height, "{:?}", kept.demand);
                }
                let colors = kept.radiance.chunks(4).zip(linked.radiance.chunks(4));
                for (list, (kept, linked)) in linked.lists.iter().zip(colors) {
                    assert!(shows(&list) || kept == linked, "{preset:?}, k:{nearest}: {kept:?} for {linked:?}");
                }
            }
        }
    });
}
