//! Normals between the nodes, which know no cells.

use fumarole::papers::terrain::reference::Ray;
use fumarole::papers::terrain::{Base, Inputs, Interpolation, Normals, Parameters, Rays, Surface, Variant};
use fumarole::scene::Camera;
use fumarole::scene::random::Random;
use glam::{DVec2, Vec3};

use super::drawing::Drawing;
use super::world::{Relief, Stand, World, random_map};
use crate::common::gpu_test;

const BASES: [Base; 3] =
    [Base::Plane, Base::Cylinder { radius_m: 900.0 }, Base::Ellipsoid { equatorial_m: 3000.0, polar_m: 2200.0 }];
const SIZE: (u32, u32) = (64, 48);

/// Of each pixel that sees terrain: the device's normal, the oracle's between the nodes, and that of the surface.
fn normals(world: &World, rays: &Rays, drawing: &Drawing) -> Vec<[glam::DVec3; 3]> {
    let map = &world.terrain.maps[0];
    let pixels = drawing.hits.iter().zip(&drawing.normals).enumerate();
    let seen = pixels.filter(|(_, (hit, _))| hit.surface == Surface::Terrain);
    let normals = seen.map(|(pixel, (hit, normal))| {
        let (x, y) = ((pixel as u32 % SIZE.0) as f64, (pixel as u32 / SIZE.0) as f64);
        let direction = rays.corner + x * rays.across + y * rays.down;
        let ray = Ray::new(world.moved(rays.eye), world.turned(direction));
        let uv = world.terrain.base.place(ray.at(f64::from(hit.depth_m) * direction.length())).uv;
        let found = world.turned(Vec3::new(normal[0], normal[1], normal[2]).as_dvec3());
        [found, world.terrain.normal_between_nodes(map, uv), world.terrain.surface_normal(map, uv)]
    });
    normals.collect()
}

#[test]
fn normals_between_nodes_are_the_oracle_s() {
    gpu_test(|device| {
        for (seed, base) in (70..).zip(BASES) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let mut random = Random::new(seed);
                let map = random_map(&mut random, Relief::Waves, (41, 34), 4.0);
                let world = World::alone("nodes", base, interpolation, None, map);
                let camera = world.camera(Stand::Above, &mut random);
                let rays = Rays::new(&camera, SIZE.0, SIZE.1);
                let parameters = Parameters { normals: Normals::Nodes, ..world.parameters(camera, SIZE) };
                let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
                for variant in [Variant::GpuCompute, Variant::GpuFragment, Variant::Cpu] {
                    let normals = normals(&world, &rays, &Drawing::with(device, variant, &parameters, &inputs));
                    assert!(normals.len() > 200, "{base:?} {variant:?}: only {} pixels of terrain", normals.len());
                    for [found, between, _] in normals {
                        let off = found.distance(between);
                        assert!(off < 5e-3, "{base:?} {interpolation:?} {variant:?}: {found}, not {between}");
                    }
                }
            }
        }
    });
}

/// `auto` takes those between the nodes where a bilinear cell is larger than a pixel, and nowhere else.
#[test]
fn large_cells_are_smooth_and_small_ones_as_they_are() {
    gpu_test(|device| {
        let mut random = Random::new(73);
        let map = random_map(&mut random, Relief::Noise, (31, 31), 2.0);
        for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let world = World::alone("auto", Base::Plane, interpolation, None, map.clone());
            // From straight above, a pixel being a fifth of a cell and two of them.
            let from = |sides: f64| Camera {
                eye: world.point(DVec2::splat(0.5), world.top_m() + sides * world.side_m()).as_vec3(),
                target: Vec3::ZERO,
                up: Vec3::NEG_Z,
                vertical_fov_rad: 1.0,
                near_m: 1.0,
                far_m: 1e6,
            };
            let (near, far) = (from(0.2), from(3.0));
            for (camera, is_near) in [(near, true), (far, false)] {
                let rays = Rays::new(&camera, SIZE.0, SIZE.1);
                let parameters = Parameters { normals: Normals::Auto, ..world.parameters(camera, SIZE) };
                let inputs = Inputs { maps: &world.maps, ..Inputs::default() };
                let normals = normals(&world, &rays, &Drawing::with(device, Variant::GpuCompute, &parameters, &inputs));
                let wanted = if is_near && interpolation == Interpolation::Bilinear { 1 } else { 2 };
                let like = |which: usize| normals.iter().filter(|n| n[0].distance(n[which]) < 5e-3).count();
                assert!(!normals.is_empty() && like(wanted) == normals.len(), "{interpolation:?} {is_near}");
                assert!(like(3 - wanted) * 2 < normals.len(), "{interpolation:?} {is_near}: they do not differ");
            }
        }
    });
}
