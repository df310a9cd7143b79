//! Lava over a height map's land: passes that feel it, lava that comes to rest in it, and the surface on it.

use fumarole::measure::Paper;
use fumarole::papers::lava::reference::Fluid;
use fumarole::papers::lava::sph::Scale;
use fumarole::papers::lava::{Bed, Flow, Heat, Parameters, Particles, SurfaceKind, Variant};
use fumarole::scene::{HeightMap, Samples};
use glam::{DVec2, DVec3, Vec3};

use super::fluid::{animate, flowing, hold_passes, oracle, run, state};
use super::scene::{draw, texels, variant_of};
use crate::common::gpu_test;

/// A map of 41 x 41 samples over a square or less of the space, heights by the place in it from 0 to 1.
fn land(parameters: &Parameters, height: impl Fn(DVec2) -> f64) -> Bed {
    let side = parameters.space_m.x.max(parameters.space_m.z);
    let place = |at: usize| DVec2::new((at % 41) as f64, (at / 41) as f64) / 40.0;
    let heights = (0..41 * 41).map(|at| f64::from(side) * height(place(at))).map(|metres| metres as f32).collect();
    let map = HeightMap::new(41, 41, Samples::Float(heights)).unwrap();
    let map = map.with_spacing_m(DVec2::splat(f64::from(side) / 40.0)).unwrap();
    Bed::of(&map, parameters.space_m, Scale::of(parameters).spacing_m)
}

/// Hills as steep as 30 degrees.
pub(super) fn hills(parameters: &Parameters) -> Bed {
    land(parameters, |place| 0.06 * (9.0 * place.x).sin() * (7.0 * place.y + 1.0).cos())
}

/// The oracle over a bed.
pub(super) fn over(oracle: Fluid, bed: &Bed) -> Fluid {
    let bed = bed.clone();
    Fluid { bed: Box::new(move |place| bed.at(place)), ..oracle }
}

#[test]
fn every_pass_feels_the_bed() {
    gpu_test(|device| {
        let parameters = flowing();
        let bed = hills(&parameters);
        let particles = Particles::of(&parameters).over(bed.clone());
        hold_passes(device, &parameters, &particles, &over(oracle(&parameters), &bed));
    });
}

/// Thin lava that is let go at a bowl's side comes to rest in its middle, level, and none of it is in the ground. It leaves a film a
/// particle thick behind, which the ground holds.
#[test]
fn lava_comes_to_rest_level_in_a_bowl() {
    gpu_test(|device| {
        let parameters = Parameters {
            space_m: Vec3::new(1.6, 1.0, 1.6),
            radius_m: 0.1,
            flow: Flow {
                block_m: Vec3::new(0.6, 0.3, 0.6),
                viscosity_pa_s: 60.0,
                heat: Heat { emissivity: 0.0, ..Heat::default() },
                ..flowing().flow
            },
            ..flowing()
        };
        let bed = land(&parameters, |place| 0.8 * (place - 0.5).length_squared());
        let particles = Particles::of(&parameters).over(bed.clone());
        let mut animate = animate(device, &parameters, &particles);
        run(device, &mut animate, 240);
        let (places, velocities) = state(device, &animate, 600);
        let spacing = Scale::of(&parameters).spacing_m;
        let above = places.iter().map(|p| p.y - bed.at(DVec2::new(p.x, p.z)).z);
        let deepest = above.fold(f64::MAX, f64::min);
        let fastest = velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
        // The pool without its rim, half a metre around the middle.
        let pool: Vec<DVec3> =
            places.iter().copied().filter(|place| (place.x - 0.8).hypot(place.z - 0.8) < 0.45).collect();
        let middle = pool.iter().sum::<DVec3>() / pool.len() as f64;
        // The highest particle of each of eight sectors.
        let mut tops = [0.0f64; 8];
        for place in &pool {
            let turn = (place.z - 0.8).atan2(place.x - 0.8) / std::f64::consts::TAU + 0.5;
            let top = &mut tops[((8.0 * turn) as usize).min(7)];
            *top = top.max(place.y);
        }
        let (low, high) = tops.iter().fold((f64::MAX, 0.0f64), |(low, high), top| (low.min(*top), high.max(*top)));
        println!(
            "deepest {deepest} of {spacing}, fastest {fastest}, {} around {middle}, tops {low} to {high}",
            pool.len()
        );
        assert!(deepest > 0.2 * spacing && fastest < 0.05, "{deepest} {fastest}");
        assert!(pool.len() > 200 && (middle.x - 0.8).abs() < 0.1 && (middle.z - 0.8).abs() < 0.1, "{middle}");
        assert!(high - low < 1.5 * spacing, "{tops:?}");
    });
}

/// Heights above the ground of columns, 30 a row, of those that have any: at a front as large a part of them as there is lava around.
fn fronts(heights: &[Option<f64>]) -> Vec<f64> {
    let rows = heights.len() as i64 / 30;
    let of = |at: usize| {
        let (i, k) = (at as i64 % 30, at as i64 / 30);
        let (mut weights, mut covered, mut sum) = (0.0, 0.0, 0.0);
        for (x, z) in (-1i64..=1).flat_map(|z| (-1i64..=1).map(move |x| (x, z))) {
            let weight = (-0.5 * (x * x + z * z) as f64).exp();
            weights += weight;
            if let Some(height) = heights[((k + z).clamp(0, rows - 1) * 30 + (i + x).clamp(0, 29)) as usize] {
                covered += weight;
                sum += weight * height;
            }
        }
        let share: f64 = (2.0 * covered / weights - 0.5).clamp(0.0, 1.0);
        match heights[at] {
            Some(own) => share.max(0.5) * (sum / covered + share.max(0.5) * (own - sum / covered)),
            None if share > 0.0 => share * sum / covered,
            None => 0.0,
        }
    };
    (0..heights.len()).map(of).collect()
}

/// In both variants: where there is no lava the surface is the bed's, and where there is it lies above it, falling off at its front.
#[test]
fn the_surface_lies_on_the_bed() {
    gpu_test(|device| {
        let parameters = Parameters {
            surface: SurfaceKind::Crossing,
            border_m: 0.0,
            density: [30, 16, 18],
            radius_m: 0.15,
            ..flowing()
        };
        let bed = land(&parameters, |place| 0.1 * place.x + 0.05 * place.y);
        let particles = Particles::of(&parameters).over(bed.clone());
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let mut lava = variant_of(device, variant, &parameters, &particles);
            draw(device, &mut lava, 3);
            let surface: Vec<[f32; 4]> = texels(device, &lava.normal_height.surface);
            let sums: Vec<[f32; 4]> = texels(device, lava.method.sums());
            let ground = |at: usize| {
                let column = DVec2::new((at % 30) as f64, (at / 30) as f64) + 0.5;
                bed.at(column / DVec2::new(30.0, 18.0) * DVec2::new(2.0, 1.2)).z
            };
            let height =
                |(at, sum): (usize, &[f32; 4])| (sum[3] > 0.0).then(|| f64::from(sum[0] / sum[3]) - ground(at));
            let heights: Vec<Option<f64>> = sums.iter().enumerate().map(height).collect();
            let expected = fronts(&heights);
            let (mut bare, mut beside, mut covered) = (0, 0, 0);
            for (at, texel) in surface.iter().enumerate() {
                let above = f64::from(texel[3]) - ground(at);
                assert!((above - expected[at]).abs() < 2e-5, "{variant:?} {at}: {above} {}", expected[at]);
                bare += usize::from(above.abs() < 1e-5);
                beside += usize::from(heights[at].is_none() && above > 0.01);
                covered += usize::from(above > 0.2);
            }
            assert!(bare > 200 && beside > 3 && covered > 20, "{variant:?}: {bare} {beside} {covered}");
            // Land that is drawn, in the picture's lower half.
            let picture: Vec<[u8; 4]> = texels(device, lava.picture());
            let (land, lit) = picture.iter().fold((0, 0), |(land, lit), [red, green, blue, _]| {
                (land + u32::from(blue > red && *green > 0), lit + u32::from(*red > 100 && red > blue))
            });
            assert!(land > 1000 && lit > 100, "{variant:?}: {land} pixels of land, {lit} of lava");
        }
    });
}
