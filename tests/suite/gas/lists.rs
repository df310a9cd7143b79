//! Fragments: coverage, masks, order, against cutting in double precision.

use fumarole::gpu::{Compiler, Mode, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::gas::model::Object;
use fumarole::papers::gas::reference::coverage::{area, cut};
use fumarole::papers::gas::{Capacity, Fragment, Gas, Lists, Parameters, Variant};
use fumarole::scene::random::Random;
use fumarole::scene::{Camera, Mesh};
use glam::{DVec2, Vec3};

use super::drawing::Drawing;
use crate::common::{gpu_test, shaders_by};

pub const WIDTH: u32 = 90;
pub const HEIGHT: u32 = 62;

/// The camera at the origin looks along -Z.
pub fn parameters() -> Parameters {
    Parameters {
        volumes: Vec::new(),
        camera: Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, near_m: 0.5, ..Parameters::default().camera },
        width: WIDTH,
        height: HEIGHT,
        ..Parameters::default()
    }
}

pub fn object(triangles: &[[Vec3; 3]]) -> Object {
    let positions: Vec<Vec3> = triangles.concat();
    let mesh = Mesh {
        name: "triangles".to_owned(),
        normals: vec![Vec3::Z; positions.len()],
        indices: (0..positions.len() as u32).collect(),
        positions,
        ..Mesh::default()
    };
    Object::new(mesh, Vec3::ONE)
}

/// A place of the picture at a depth, as a point of the world.
pub fn unproject(pixel: DVec2, depth_m: f32) -> Vec3 {
    let size = (f64::from(parameters().camera.vertical_fov_rad) / 2.0).tan() / (f64::from(HEIGHT) / 2.0);
    let (x, y) = (pixel.x - f64::from(WIDTH) / 2.0, pixel.y - f64::from(HEIGHT) / 2.0);
    Vec3::new((x * size) as f32, (-y * size) as f32, -1.0) * depth_m
}

pub fn random_corners(random: &mut Random, reach: f32) -> [DVec2; 3] {
    let middle = [random.range(5.0, 85.0), random.range(5.0, 57.0)];
    [(); 3].map(|()| {
        let mut near = |m: f32| f64::from(m + random.range(-reach, reach));
        DVec2::new(near(middle[0]), near(middle[1]))
    })
}

#[test]
fn coverage_is_exact_and_masks_follow_it() {
    gpu_test(|device| {
        let mut random = Random::new(5);
        let (mut errors, mut count) = (0.0, 0);
        for reach in [0.6, 3.0, 20.0] {
            let corners: Vec<[DVec2; 3]> = (0..40).map(|_| random_corners(&mut random, reach)).collect();
            let triangles: Vec<[Vec3; 3]> =
                corners.iter().map(|c| c.map(|p| unproject(p, random.range(2.0, 9.0)))).collect();
            let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &[object(&triangles)]);
            for (i, list) in drawing.lists.iter().enumerate() {
                let pixel = DVec2::new((i as u32 % WIDTH).into(), (i as u32 / WIDTH).into());
                for (number, corners) in corners.iter().enumerate() {
                    let expected = area(&cut(corners, pixel));
                    let found = list.iter().find(|f| f.triangle == number as u32);
                    let coverage = found.map_or(0.0, |f| f64::from(f.coverage));
                    assert!((coverage - expected).abs() < 1e-3, "{coverage} for {expected}");
                    if let Some(found) = found.filter(|f| f.coverage > 1e-3 && f.coverage < 0.999 && f.opacity == 1.0) {
                        errors += (f64::from(found.mask.count_ones()) / 32.0 - expected).abs();
                        count += 1;
                    }
                }
            }
        }
        let mean = errors / f64::from(count);
        assert!(count > 500 && mean < 1.0 / 48.0, "{mean} over {count}");
    });
}

/// Fans of triangles round a point, at edges in all directions.
#[test]
fn triangles_that_share_edges_part_the_sub_pixels() {
    gpu_test(|device| {
        let mut random = Random::new(9);
        for _ in 0..6 {
            let middle = unproject(DVec2::new(random.range(30.0, 60.0).into(), random.range(20.0, 40.0).into()), 3.0);
            // On whole sub-pixels too, where edges go through their middles.
            let rim: Vec<Vec3> = [
                (-5.0, -5.0),
                (40.125, -5.0),
                (95.0, -5.0),
                (95.0, 30.0625),
                (95.0, 70.0),
                (45.0, 70.0),
                (-5.0, 70.0),
                (-5.0, 31.0),
            ]
            .map(|(x, y)| unproject(DVec2::new(x, y), random.range(2.0, 6.0)))
            .to_vec();
            let triangles: Vec<[Vec3; 3]> = (0..8).map(|i| [middle, rim[(i + 1) % 8], rim[i]]).collect();
            let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &[object(&triangles)]);
            for (pixel, list) in drawing.lists.iter().enumerate() {
                let full: Vec<_> = list.iter().filter(|f| f.opacity == 1.0).collect();
                let union = full.iter().fold(0, |all, f| all | f.mask);
                let sum: u32 = full.iter().map(|f| f.mask.count_ones()).sum();
                assert_eq!((union, sum), (u32::MAX, 32), "pixel {pixel}: {list:?}");
            }
        }
    });
}

#[test]
fn slivers_take_the_nearest_sub_pixel_at_the_opacity_of_their_coverage() {
    gpu_test(|device| {
        let corners = [DVec2::new(10.02, 10.01), DVec2::new(10.09, 10.01), DVec2::new(10.02, 10.05)];
        let triangle = corners.map(|p| unproject(p, 3.0));
        let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &[object(&[triangle])]);
        let list = &drawing.lists[(10 * WIDTH + 10) as usize];
        let expected = area(&corners) * 32.0;
        assert_eq!((list.len(), list[0].mask), (1, 1));
        assert!((f64::from(list[0].opacity) - expected).abs() < 2e-3, "{} for {expected}", list[0].opacity);
    });
}

/// Slivers in all directions: where a triangle's piece misses the middles of all sub-pixels, one that it goes through
/// stands for it.
#[test]
fn empty_masks_take_a_sub_pixel_at_the_opacity_of_their_coverage() {
    gpu_test(|device| {
        let mut random = Random::new(17);
        let corners: Vec<[DVec2; 3]> = (0..60)
            .map(|_| {
                let from = DVec2::new(random.range(5.0, 80.0).into(), random.range(5.0, 55.0).into());
                let along = DVec2::from_angle(random.range(0.0, std::f32::consts::TAU).into());
                let across = along.perp() * f64::from(random.range(0.005, 0.05));
                [from, from + along * f64::from(random.range(0.1, 9.0)), from + across]
            })
            .collect();
        let triangles: Vec<[Vec3; 3]> = corners.iter().map(|c| c.map(|p| unproject(p, 3.0))).collect();
        let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &[object(&triangles)]);
        let mut count = 0;
        for (i, list) in drawing.lists.iter().enumerate() {
            let pixel = DVec2::new((i as u32 % WIDTH).into(), (i as u32 / WIDTH).into());
            for fragment in list {
                let piece = cut(&corners[fragment.triangle as usize], pixel);
                let holds = |bit: u32| {
                    let middle = DVec2::new(f64::from(bit % 4) + 0.5, f64::from(bit / 4) + 0.5) / DVec2::new(4.0, 8.0);
                    let sides = (0..piece.len()).map(|k| {
                        let (a, b) = (piece[k], piece[(k + 1) % piece.len()]);
                        (b - a).perp_dot(middle - a)
                    });
                    let sides: Vec<f64> = sides.collect();
                    sides.iter().all(|&s| s > -1e-6) || sides.iter().all(|&s| s < 1e-6)
                };
                if (0..32).any(holds) {
                    continue;
                }
                assert_eq!(fragment.mask.count_ones(), 1, "{fragment:?}");
                let expected = (area(&piece) * 32.0).min(0.99);
                assert!((f64::from(fragment.opacity) - expected).abs() < 5e-3, "{fragment:?} for {expected}");
                // The sub-pixel's own piece of the triangle, with slack for rounding.
                let bit = fragment.mask.trailing_zeros();
                let sub_pixels: Vec<DVec2> = piece.iter().map(|p| *p * DVec2::new(4.0, 8.0)).collect();
                let cell = DVec2::new((bit % 4).into(), (bit / 4).into());
                let center = sub_pixels.iter().sum::<DVec2>() / sub_pixels.len() as f64;
                let is_through = area(&cut(&sub_pixels, cell)) > 0.0;
                assert!(is_through || (center - cell - 0.5).abs().max_element() < 0.51, "{fragment:?}: {piece:?}");
                count += 1;
            }
        }
        assert!(count > 50, "{count} slivers");
    });
}

/// Many triangles over each other, some at one depth: sorted by mean depth, then object, then triangle.
#[test]
fn long_lists_are_sorted() {
    gpu_test(|device| {
        let mut random = Random::new(11);
        let mut sheets = |count: usize| {
            let triangles: Vec<[Vec3; 3]> = (0..count)
                .map(|_| {
                    let depth = (random.range(2.0, 9.0) * 4.0).round() / 4.0;
                    [(-20.0, -20.0), (220.0, -20.0), (-20.0, 200.0)].map(|(x, y)| unproject(DVec2::new(x, y), depth))
                })
                .collect();
            Object { opacity: 0.2, ..object(&triangles) }
        };
        let objects = [sheets(41), sheets(30), sheets(1)];
        let drawing = Drawing::of(device, Variant::NoVolume, &parameters(), &objects);
        for list in &drawing.lists {
            assert_eq!(list.len(), 72);
            let key = |f: &fumarole::papers::gas::Fragment| (f.depth_m[0] + f.depth_m[1], f.object, f.triangle);
            assert!(list.windows(2).all(|w| key(&w[0]) < key(&w[1])), "{list:?}");
        }
    });
}

/// Of every length from 1 to 90 side by side, in the runs that are sorted at once and beyond them, with depths that are equal:
/// all fragments are there, by depth and then by triangle.
#[test]
fn lists_of_every_length_are_sorted() {
    gpu_test(|device| {
        let mut random = Random::new(41);
        let mut depths: Vec<f32> = (0..WIDTH).map(|_| random.range(2.0, 9.0)).collect();
        for equal in [3, 12, 40, 41, 77] {
            depths[equal] = depths[equal - 3];
        }
        // Each begins in the middle of a column, and goes on to the picture's right.
        let sheet = |(column, &depth): (usize, &f32)| {
            let left = column as f64 + 0.5;
            [(left, -400.0), (600.0, 31.0), (left, 462.0)].map(|(x, y)| unproject(DVec2::new(x, y), depth))
        };
        let triangles: Vec<[Vec3; 3]> = depths.iter().enumerate().map(sheet).collect();
        let objects = [Object { opacity: 0.1, ..object(&triangles) }];
        for lists in [Lists::Linked, Lists::Tiles] {
            let parameters = Parameters { lists, ..parameters() };
            let drawing = Drawing::of(device, Variant::NoVolume, &parameters, &objects);
            for (pixel, list) in drawing.lists.iter().enumerate() {
                assert_eq!(list.len(), pixel % WIDTH as usize + 1, "{lists:?}, pixel {pixel}");
                let key = |f: &Fragment| (f.depth_m[0] + f.depth_m[1], f.triangle);
                assert!(list.windows(2).all(|w| key(&w[0]) < key(&w[1])), "{lists:?}, pixel {pixel}: {list:?}");
            }
        }
    });
}

/// Lists without room are counted, grown and drawn again: the picture is that of lists that had room at once.
#[test]
fn lists_that_overflow_grow() {
    gpu_test(|device| {
        let triangle = [(-20.0, -20.0), (220.0, -20.0), (-20.0, 200.0)];
        let triangles: Vec<[Vec3; 3]> =
            (0..9).map(|i| triangle.map(|(x, y)| unproject(DVec2::new(x, y), 2.0 + 0.5 * i as f32))).collect();
        let objects = [Object { opacity: 0.3, ..object(&triangles) }];
        let shaders = shaders_by(device, Compiler::Glslang);
        for (lists, most_runs) in [(Lists::Linked, 2), (Lists::Tiles, 3)] {
            let parameters = Parameters { lists, ..parameters() };
            let expected = Drawing::of(device, Variant::NoVolume, &parameters, &objects);
            let small = Capacity { rows: HEIGHT, fragments: 100, sections: 1, chunks: 1 };
            let mut gas = Gas::new(&shaders, "test", Variant::NoVolume, &parameters, &objects, Some(small)).unwrap();
            let mut recorder = Recorder::new(device).unwrap();
            let mut runs = 0;
            loop {
                runs += 1;
                recorder.run(Mode::Plain, |frame| gas.record(frame, 0)).unwrap();
                if gas.settle(&shaders).unwrap() {
                    break;
                }
            }
            assert_eq!((runs, gas.demand(&shaders).unwrap()), (most_runs, expected.demand));
            assert_eq!(gas.fragments(&shaders).unwrap(), expected.lists);
        }
    });
}

/// Fragments are counted over all bands of a frame, and anew in each frame.
#[test]
fn fragments_of_all_bands_are_counted() {
    gpu_test(|device| {
        let triangle = [(-20.0, -20.0), (220.0, -20.0), (-20.0, 200.0)];
        let triangles: Vec<[Vec3; 3]> =
            (0..5).map(|i| triangle.map(|(x, y)| unproject(DVec2::new(x, y), 2.0 + 0.5 * i as f32))).collect();
        let objects = [Object { opacity: 0.3, ..object(&triangles) }];
        let shaders = shaders_by(device, Compiler::Glslang);
        let whole = Drawing::of(device, Variant::NoVolume, &parameters(), &objects);
        let expected = whole.lists.iter().map(|list| list.len() as u64).sum::<u64>();
        let rows = HEIGHT.div_ceil(3);
        let band = Capacity { rows, fragments: 10 * WIDTH * rows, sections: 1, chunks: 1 };
        let mut gas = Gas::new(&shaders, "test", Variant::NoVolume, &parameters(), &objects, Some(band)).unwrap();
        let mut recorder = Recorder::new(device).unwrap();
        for number in 0..3 {
            recorder.run(Mode::Plain, |frame| gas.record(frame, number)).unwrap();
            assert!(gas.settle(&shaders).unwrap());
            assert_eq!(gas.kept_fragments(&shaders).unwrap(), Some(expected));
            assert_eq!(gas.evaluations(&shaders).unwrap(), None);
        }
        assert!(u64::from(gas.demand(&shaders).unwrap().fragments) < expected);
        let tiles = Parameters { lists: Lists::Tiles, ..parameters() };
        let mut gas = Gas::new(&shaders, "tiles", Variant::NoVolume, &tiles, &objects, Some(band)).unwrap();
        recorder.run(Mode::Plain, |frame| gas.record(frame, 0)).unwrap();
        assert_eq!(gas.kept_fragments(&shaders).unwrap(), None);
    });
}
