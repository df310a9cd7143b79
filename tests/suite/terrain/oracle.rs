//! The device against the oracle, ray by ray: random maps, random cameras, every base and interpolation.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Variant as _;
use fumarole::papers::terrain::{Base, Inputs, Interpolation, Lod, MapInput, Parameters, Placement, Rays, Variant};
use fumarole::scene::Camera;
use fumarole::scene::random::Random;
use glam::{DVec2, DVec3, Vec3};

use super::drawing::Painter;
use super::maps::adversaries;
use super::verdict::{Judge, Tally};
use super::world::{Relief, Stand, World, random_map};
use crate::common::gpu_test;

pub const THOUSANDTH: f64 = 1e-3;
const VARIANTS: [Variant; 6] = [
    Variant::Cpu,
    Variant::GpuCompute,
    Variant::GpuFragment,
    Variant::DdaCompute,
    Variant::DdaFragment,
    Variant::DdaCpu,
];
const STANDS: [Stand; 7] =
    [Stand::Above, Stand::Beside, Stand::Hovering, Stand::Under, Stand::Down, Stand::Up, Stand::Far(4.0)];

/// The tally of one variant, by one compiler's binaries, over many pictures.
struct Trial {
    variant: Variant,
    compiler: Compiler,
    tally: Tally,
}

/// All variants, and the pictures so far.
pub struct Trials<'a> {
    device: &'a Arc<Device>,
    trials: Vec<Trial>,
    size: (u32, u32),
    lod: Lod,
}

impl<'a> Trials<'a> {
    pub fn new(device: &'a Arc<Device>, size: (u32, u32)) -> Self {
        Self::compiled_by(device, size, &VARIANTS, &[Compiler::Glslang])
    }

    fn compiled_by(device: &'a Arc<Device>, size: (u32, u32), variants: &[Variant], compilers: &[Compiler]) -> Self {
        let pairs = variants.iter().flat_map(|&variant| compilers.iter().map(move |&compiler| (variant, compiler)));
        let trials = pairs.map(|(variant, compiler)| Trial { variant, compiler, tally: Tally::default() });
        Trials { device, trials: trials.collect(), size, lod: Lod::Exact }
    }

    /// At another level of detail.
    pub fn at(self, lod: Lod) -> Self {
        Trials { lod, ..self }
    }

    /// Looks at a world from stands by chance.
    fn draw(&mut self, world: &World, stands: &[Stand], random: &mut Random) {
        let cameras: Vec<_> = stands.iter().map(|&s| (world.camera(s, random), format!("{s:?}"))).collect();
        self.compare(world, &cameras, THOUSANDTH);
    }

    pub fn compare(&mut self, world: &World, cameras: &[(Camera, String)], tolerance_cells: f64) {
        let Trials { device, trials, size, lod } = self;
        let judge = |(camera, stand): &(Camera, String)| {
            (*camera, stand.clone(), Judge::new(world, &Rays::new(camera, size.0, size.1), *size, tolerance_cells))
        };
        let judges: Vec<_> = cameras.iter().map(judge).collect();
        let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
        let parameters = Parameters { lod: *lod, ..world.parameters(cameras[0].0, *size) };
        for Trial { variant, compiler, tally: sum } in trials {
            let mut painter = Painter::new(device, *compiler, *variant, &parameters, &inputs);
            for (camera, stand, judge) in &judges {
                let mut tally = judge.tally(&painter.from(*camera));
                let place = format!("{} {stand} {} {compiler:?}", world.name, variant.as_str());
                for reasons in [&mut tally.wrong, &mut tally.hairs] {
                    *reasons = reasons.iter().take(3).map(|reason| format!("{place}: {reason}")).collect();
                }
                sum.add(tally);
            }
        }
    }

    pub fn assert_none_wrong(&self) {
        for Trial { variant, tally, .. } in &self.trials {
            assert!(tally.wrong.is_empty(), "{}:\n{}", variant.as_str(), tally.wrong.join("\n"));
        }
    }

    /// No ray is wrong, less than one in a thousand ends elsewhere by a hair, and every kind of `kinds` was seen.
    pub fn assert(&self, kinds: [bool; 5]) {
        self.assert_none_wrong();
        for Trial { variant, tally, .. } in self.trials.iter().filter(|trial| trial.tally.rays > 0) {
            let word = variant.as_str();
            let hairs = tally.hairs.join("\n");
            assert!(tally.elsewhere * 1000 < tally.rays, "{word}: {} of {}:\n{hairs}", tally.elsewhere, tally.rays);
            let is_seen = tally.seen.iter().zip(kinds).all(|(&seen, wanted)| !wanted || seen >= 20);
            assert!(is_seen, "{word} saw too little: {:?}", tally.seen);
        }
    }
}

/// Maps by chance over a base, each from several of the stands in turn.
fn assert_random(base: Base, interpolation: Interpolation, seed: u64, worlds: usize, stands: usize) {
    gpu_test(|device| {
        let mut random = Random::new(seed);
        let mut trials = Trials::new(device, (48, 36));
        for number in 0..worlds {
            let relief = [Relief::Waves, Relief::Noise, Relief::Terraces][number % 3];
            // Of a large map on a round base hardly a wall is seen.
            let longest: f32 = match number % 2 {
                _ if base == Base::Plane => 1024.0,
                0 => 80.0,
                _ => 256.0,
            };
            // As many small as large, odd by even.
            let side = |random: &mut Random| (2.0 * (longest / 2.0).powf(random.unit())) as u32;
            let size = (side(&mut random) | 1, side(&mut random) & !1);
            let amplitude_cells = random.range(0.5, 6.0);
            let map = random_map(&mut random, relief, size, amplitude_cells);
            let (low, high) = map.range_m();
            // No terrace lies on the base: which of the two is seen would be a matter of last bits.
            let level = [None, Some(low - 0.3 * (high - low)), Some(low + 0.37 * (high - low))][number / 2 % 3];
            let name = format!("{number} {relief:?} {size:?} {level:?}");
            let world = World::alone(&name, base, interpolation, level, map);
            let turn: Vec<Stand> = STANDS.iter().cycle().skip(number * stands).take(stands).copied().collect();
            trials.draw(&world, &turn, &mut random);
        }
        trials.assert([true; 5]);
    });
}

#[test]
fn bilinear_maps_on_a_plane() {
    assert_random(Base::Plane, Interpolation::Bilinear, 1, 7, 3);
}

#[test]
fn bicubic_maps_on_a_plane() {
    assert_random(Base::Plane, Interpolation::Bicubic, 2, 7, 2);
}

#[test]
fn adversarial_maps() {
    gpu_test(|device| {
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let mut random = Random::new(3);
            let mut trials = Trials::new(device, (49, 37));
            for (number, (name, map)) in adversaries().into_iter().enumerate() {
                let world = World::alone(name, Base::Plane, interpolation, None, map);
                trials.draw(&world, &[STANDS[number % STANDS.len()], Stand::Above], &mut random);
            }
            trials.assert([false, true, true, true, false]);
        }
    });
}

#[test]
fn maps_around_a_cylinder() {
    let base = Base::Cylinder { radius_m: 900.0 };
    assert_random(base, Interpolation::Bilinear, 4, 6, 2);
    assert_random(base, Interpolation::Bicubic, 5, 6, 2);
}

#[test]
fn maps_on_flat_and_long_ellipsoids() {
    let flat = Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 };
    assert_random(flat, Interpolation::Bilinear, 6, 6, 2);
    let long = Base::Ellipsoid { equatorial_m: 2000.0, polar_m: 2600.0 };
    assert_random(long, Interpolation::Bicubic, 7, 6, 2);
}

/// Maps once around, which meet themselves at a seam, and from pole to pole.
#[test]
fn whole_turns_and_poles() {
    gpu_test(|device| {
        let (a, b) = (400.0, 300.0);
        let round = Base::Cylinder { radius_m: 300.0 };
        let whole = Base::Ellipsoid { equatorial_m: a, polar_m: b };
        let (a, b) = (f64::from(a), f64::from(b));
        let cases = [
            (round, (61, 30), DVec2::new(TAU * 300.0 / 60.0, 25.0)),
            (whole, (41, 21), DVec2::new(TAU * a / 40.0, PI * b * b / a / 20.0)),
        ];
        for (seed, (base, size, spacing_m)) in (16..).zip(cases) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let mut random = Random::new(seed);
                let mut trials = Trials::new(device, (32, 24));
                let map = random_map(&mut random, Relief::Waves, size, 1.5);
                let factor = (spacing_m.x / map.spacing_m().x) as f32;
                let map = map.with_exaggeration(factor).unwrap().with_spacing_m(spacing_m).unwrap();
                let world = World::alone("whole", base, interpolation, None, map);
                trials.draw(
                    &world,
                    &[Stand::Above, Stand::Above, Stand::Hovering, Stand::Under, Stand::Far(3.0)],
                    &mut random,
                );
                trials.assert([true, false, true, false, true]);
            }
        }
    });
}

/// Maps whose columns fill a whole turn: the cell between the last and the first is closed.
#[test]
fn maps_once_round_close_at_their_seam() {
    gpu_test(|device| {
        let (a, b) = (400.0, 300.0);
        let round = Base::Cylinder { radius_m: 300.0 };
        let whole = Base::Ellipsoid { equatorial_m: a, polar_m: b };
        let (a, b) = (f64::from(a), f64::from(b));
        let cases = [
            (round, (60, 30), DVec2::new(TAU * 300.0 / 60.0, 25.0)),
            (whole, (41, 21), DVec2::new(TAU * a / 41.0, PI * b * b / a / 20.0)),
        ];
        let mut trials = Trials::new(device, (32, 24));
        for (seed, (base, size, spacing_m)) in (18..).zip(cases) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let mut random = Random::new(seed);
                let map = random_map(&mut random, Relief::Waves, size, 1.5);
                let factor = (spacing_m.x / map.spacing_m().x) as f32;
                let map = map.with_exaggeration(factor).unwrap().with_spacing_m(spacing_m).unwrap();
                let world = World::alone("once round", base, interpolation, None, map);
                assert!(world.terrain.maps[0].closes);
                trials.draw(&world, &[Stand::Seam, Stand::Seam, Stand::Above, Stand::Far(3.0)], &mut random);
            }
        }
        // From above the seam many rays graze the steep cell that closes it, so how many end elsewhere is not bound.
        trials.assert_none_wrong();
    });
}

/// The other compiler's binaries of the same shaders, on every base and interpolation.
#[test]
fn naga_s_binaries_meet_the_oracle() {
    gpu_test(|device| {
        let bases = [
            Base::Plane,
            Base::Cylinder { radius_m: 900.0 },
            Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 },
        ];
        let variants = [Variant::GpuCompute, Variant::GpuFragment, Variant::DdaCompute, Variant::DdaFragment];
        let mut trials = Trials::compiled_by(device, (48, 36), &variants, &[Compiler::Naga]);
        for (seed, base) in (20..).zip(bases) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let mut random = Random::new(seed);
                let map = random_map(&mut random, Relief::Waves, (61, 44), 4.0);
                let world = World::alone("naga", base, interpolation, None, map);
                trials.draw(&world, &[Stand::Above, Stand::Beside], &mut random);
            }
        }
        trials.assert([true, true, true, true, false]);
    });
}

/// Pictures of few pixels, of much terrain.
#[test]
fn large_maps() {
    gpu_test(|device| {
        let mut random = Random::new(8);
        let mut trials = Trials::new(device, (32, 24));
        for (relief, interpolation) in
            [(Relief::Waves, Interpolation::Bilinear), (Relief::Noise, Interpolation::Bicubic)]
        {
            let map = random_map(&mut random, relief, (1024, 1024), 12.0);
            let world = World::alone("1024", Base::Plane, interpolation, None, map);
            trials.draw(&world, &[Stand::Above, Stand::Beside, Stand::Hovering], &mut random);
        }
        trials.assert([true, true, true, false, false]);
    });
}

/// Maps that overlap, touch and stand apart, of different cells, in steps and floats.
#[test]
fn several_maps_united() {
    gpu_test(|device| {
        for (seed, base) in [(9, Base::Plane), (10, Base::Cylinder { radius_m: 4000.0 }), (11, Base::EARTH)] {
            let mut random = Random::new(seed);
            let mut trials = Trials::new(device, (48, 36));
            let mut place = |width: u32, height: u32, spacing_m: f64, x: f64, z: f64| {
                let relief = if width.is_multiple_of(2) { Relief::Waves } else { Relief::Noise };
                let map = random_map(&mut random, relief, (width, height), 3.0);
                let factor = (spacing_m / map.spacing_m().x) as f32;
                let map = map.with_exaggeration(factor).unwrap().with_spacing_m(DVec2::splat(spacing_m)).unwrap();
                MapInput {
                    map: Arc::new(map),
                    placement: Placement { center_m: DVec2::new(x, z), ..Placement::default() },
                }
            };
            let maps = vec![
                place(64, 48, 10.0, 0.0, 0.0),
                place(33, 65, 7.0, 427.0, 0.0),
                place(20, 31, 16.0, -200.0, 180.0),
                place(9, 10, 25.0, 100.0, -900.0),
            ];
            let world = World::new("united", base, Interpolation::Bilinear, None, maps);
            trials.draw(&world, &[Stand::Above, Stand::Beside, Stand::Under, Stand::Far(6.0)], &mut random);
            trials.assert([false, true, true, true, true]);
        }
    });
}

#[test]
fn a_turned_map() {
    gpu_test(|device| {
        let mut random = Random::new(12);
        let mut trials = Trials::new(device, (48, 36));
        let map = random_map(&mut random, Relief::Waves, (41, 24), 4.0);
        let placement = Placement { yaw_rad: 0.7, ..Placement::default() };
        let input = MapInput { map: Arc::new(map), placement };
        let world = World::new("turned", Base::Plane, Interpolation::Bilinear, None, vec![input]);
        trials.draw(&world, &[Stand::Above, Stand::Beside], &mut random);
        trials.assert([false, true, true, true, false]);
    });
}

/// Rays along the lines of the grid, and straight down through its nodes.
#[test]
fn rays_along_the_grid() {
    gpu_test(|device| {
        let mut random = Random::new(13);
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let mut trials = Trials::new(device, (49, 37));
            let map = random_map(&mut random, Relief::Waves, (41, 25), 4.0);
            let (low, high) = map.range_m();
            let (side, height) = (50.0 * map.spacing_m().x as f32, high - low);
            let world = World::alone("nodes", Base::Plane, interpolation, None, map);
            let camera = world.camera(Stand::Above, &mut random);
            let down = Camera { eye: Vec3::Y * (side + height), target: Vec3::ZERO, up: Vec3::NEG_Z, ..camera };
            let level = Vec3::Y * 0.8 * height;
            let mut cameras = vec![(down, "over a node".to_owned())];
            cameras.extend([Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].map(|direction| {
                (
                    Camera { eye: level - side * direction, target: level, ..camera },
                    format!("along the grid to {direction}"),
                )
            }));
            trials.compare(&world, &cameras, THOUSANDTH);
            trials.assert([true, true, true, true, false]);
        }
    });
}

/// An eye is in the ground or not by its last bits; its picture must be one or the other.
#[test]
fn a_camera_on_the_surface() {
    gpu_test(|device| {
        let mut random = Random::new(14);
        let mut trials = Trials::new(device, (32, 24));
        for base in [Base::Plane, Base::Cylinder { radius_m: 700.0 }] {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let map = random_map(&mut random, Relief::Waves, (31, 20), 4.0);
                let world = World::alone("on", base, interpolation, None, map);
                trials.draw(&world, &[Stand::On], &mut random);
            }
        }
        trials.assert_none_wrong();
    });
}

/// Single precision leaves 2^-21 of the distance there.
#[test]
fn a_camera_a_thousand_maps_away() {
    gpu_test(|device| {
        let mut random = Random::new(15);
        let mut trials = Trials::new(device, (48, 36));
        for relief in [Relief::Waves, Relief::Terraces] {
            let map = random_map(&mut random, relief, (61, 40), 5.0);
            let world = World::alone("far", Base::Plane, Interpolation::Bilinear, None, map);
            let camera = world.camera(Stand::Far(1000.0), &mut random);
            let cameras = [(camera, "a thousand sides away".to_owned())];
            trials.compare(&world, &cameras, 1000.0 * 61.0 / f64::from(1 << 21));
        }
        trials.assert_none_wrong();
    });
}

/// The judge's premises.
#[test]
fn rays_are_those_of_a_pinhole_camera() {
    let camera = Camera {
        eye: Vec3::new(120.0, 45.0, -80.0),
        target: Vec3::new(10.0, -5.0, 30.0),
        up: Vec3::Y,
        vertical_fov_rad: 0.9,
        near_m: 1.0,
        far_m: 1e4,
    };
    let rays = Rays::new(&camera, 64, 48);
    let forward = (camera.target - camera.eye).as_dvec3().normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    for (x, y) in [(0.0, 0.0), (63.0, 0.0), (17.0, 40.0), (31.5, 23.5)] {
        let pixel = 2.0 * 0.45_f64.tan() / 48.0;
        let expected = forward + (x - 31.5) * pixel * right - (y - 23.5) * pixel * up;
        let found = rays.corner + x * rays.across + y * rays.down;
        assert!(found.distance(expected) < 1e-6, "({x}, {y}): {found} and not {expected}");
    }
    assert_eq!(rays.eye, camera.eye.as_dvec3());
}
