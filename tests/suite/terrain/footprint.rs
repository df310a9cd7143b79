//! `--lod pixel` against the oracle, ray by ray.
//!
//! A ray that stops at the footprint of a pixel meets the surface through the maxima of texels as large as that. Whatever its
//! shape, this is bound from both sides by the samples that the texels cover: up to the place that is given the ray was nowhere
//! below all samples of its footprint, and there it is not above all of them.

use fumarole::gpu::Compiler;
use fumarole::papers::terrain::reference::{Grid, Interpolation as Between, Ray};
use fumarole::papers::terrain::{Base, Hit, Inputs, Interpolation, Lod, Parameters, Rays, Surface, Variant};
use fumarole::scene::random::Random;
use rayon::prelude::*;

use super::drawing::Painter;
use super::world::{Relief, Stand, World, random_map};
use crate::common::gpu_test;

/// Places along a ray at which it is compared with its footprint.
const PLACES: u32 = 60;
/// A fraction of a cell for what single precision costs.
const HAIR: f64 = 1e-3;

/// Lowest and highest height above the base that interpolation on a level can make within a texel of a place; none outside
/// the map.
fn footprint(world: &World, map: &Grid, uv: [f64; 2], shift: u32) -> Option<[f64; 2]> {
    if !map.contains(uv) {
        return None;
    }
    let is_bicubic = world.terrain.interpolation == Between::Bicubic;
    let reach = if is_bicubic { 3 } else { 2 };
    let texels = [0, 1].map(|axis| {
        let last = ((map.size[axis] - 1) >> shift) as isize;
        let mut node = (uv[axis] - map.origin[axis]) / map.spacing[axis];
        if axis == 1 && matches!(world.base, Base::Ellipsoid { .. }) {
            // The oracle's rows count northwards there, the device's levels southwards.
            node = (map.size[1] - 1) as f64 - node;
        }
        let size = f64::from(1u32 << shift);
        let middle = (node / size + 0.5 / size - 0.5).floor() as isize;
        ((middle - reach + 1).clamp(0, last), (middle + reach).clamp(0, last))
    });
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for row in texels[1].0 << shift..((texels[1].1 + 1) << shift).min(map.size[1] as isize) {
        for column in texels[0].0 << shift..((texels[0].1 + 1) << shift).min(map.size[0] as isize) {
            let row = if matches!(world.base, Base::Ellipsoid { .. }) { map.size[1] as isize - 1 - row } else { row };
            let height_m = map.node(column, row) - world.terrain.base_level_m;
            (low, high) = (low.min(height_m), high.max(height_m));
        }
    }
    let overshoot_m = if is_bicubic { (high - low) * 9.0 / 32.0 } else { 0.0 };
    Some([low - overshoot_m, high + overshoot_m])
}

/// The level as large as a pixel at a depth.
fn shift_at(world: &World, map: &Grid, rays: &Rays, depth_m: f64) -> u32 {
    let spacing_m = world.maps[0].map.spacing_m().max_element();
    let nodes = depth_m * rays.pixel_m() / spacing_m;
    let top = map.size[0].max(map.size[1]).next_power_of_two().trailing_zeros();
    if nodes < 1.0 { 0 } else { (nodes.log2() as u32).min(top) }
}

/// Why a hit is outside its bounds.
fn fault(world: &World, rays: &Rays, ray: &Ray, stretch: f64, hit: &Hit) -> Option<String> {
    let map = &world.terrain.maps[0];
    let hair_m = HAIR * world.cell_m();
    let is_ground = hit.surface != Surface::Sky;
    let far_m = 4.0 * (ray.origin.length() + world.side_m());
    let end = if is_ground { f64::from(hit.depth_m) * stretch } else { far_m };
    for n in 0..PLACES {
        let t = end * f64::from(n) / f64::from(PLACES);
        let place = world.terrain.base.place(ray.at(t));
        // Where the level changes, the finer or the coarser one was read.
        let shift = shift_at(world, map, rays, t / stretch);
        let finer = shift_at(world, map, rays, 0.99 * t / stretch - world.cell_m());
        for shift in [shift, finer] {
            if let Some([low, _]) = footprint(world, map, place.uv, shift)
                && place.h < low.max(0.0) - hair_m
                && n > 0
            {
                return Some(format!("{} m below all of its footprint at {t} m of {end} m", low - place.h));
            }
        }
    }
    if hit.surface != Surface::Terrain {
        return None;
    }
    let place = world.terrain.base.place(ray.at(end));
    let [low, high] = footprint(world, map, place.uv, hit.shift.max(shift_at(world, map, rays, end / stretch)))?;
    let is_bound = (low - hair_m..=high + hair_m).contains(&place.h);
    (!is_bound).then(|| format!("at {} m, its footprint at {low} to {high} m", place.h))
}

#[test]
fn a_pixel_s_height_is_that_of_its_footprint() {
    gpu_test(|device| {
        let bases = [
            Base::Plane,
            Base::Cylinder { radius_m: 4000.0 },
            Base::Ellipsoid { equatorial_m: 9000.0, polar_m: 7000.0 },
        ];
        let (width, height) = (64, 48);
        for (seed, base) in (30..).zip(bases) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let mut random = Random::new(seed);
                let map = random_map(&mut random, Relief::Waves, (257, 180), 12.0);
                let world = World::alone("footprint", base, interpolation, None, map);
                let stands = [Stand::Above, Stand::Beside, Stand::Hovering, Stand::Far(3.0)];
                let cameras = stands.map(|stand| (stand, world.camera(stand, &mut random)));
                let parameters = Parameters { lod: Lod::Pixel, ..world.parameters(cameras[0].1, (width, height)) };
                let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
                let mut coarse = 0;
                for (variant, compiler) in [
                    (Variant::Cpu, Compiler::Glslang),
                    (Variant::GpuCompute, Compiler::Glslang),
                    (Variant::GpuFragment, Compiler::Naga),
                    (Variant::DdaCompute, Compiler::Naga),
                    (Variant::DdaFragment, Compiler::Glslang),
                    (Variant::DdaCpu, Compiler::Glslang),
                ] {
                    let mut painter = Painter::new(device, compiler, variant, &parameters, &inputs);
                    for (stand, camera) in cameras {
                        let rays = Rays::new(&camera, width, height);
                        let drawing = painter.from(camera);
                        let judge = |(pixel, hit): (usize, &Hit)| {
                            let (x, y) = ((pixel % width as usize) as f64, (pixel / width as usize) as f64);
                            let direction = rays.corner + x * rays.across + y * rays.down;
                            let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
                            fault(&world, &rays, &ray, direction.length(), hit)
                                .map(|fault| format!("pixel {pixel}, {hit:?}: {fault}"))
                        };
                        let faults: Vec<String> = drawing.hits.par_iter().enumerate().filter_map(judge).collect();
                        let place = format!("{base:?} {interpolation:?} {stand:?} {variant:?} {compiler:?}");
                        let first: Vec<&String> = faults.iter().take(4).collect();
                        assert!(faults.is_empty(), "{place}: {} rays: {first:#?}", faults.len());
                        let met = drawing.hits.iter().filter(|hit| hit.surface == Surface::Terrain).count();
                        assert!(met > 20, "{place}: only {met} rays meet the map");
                        coarse += drawing.hits.iter().filter(|hit| hit.shift > 0).count();
                    }
                }
                assert!(coarse > 1000, "{base:?} {interpolation:?}: only {coarse} rays end above the data");
            }
        }
    });
}
