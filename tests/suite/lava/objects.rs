//! Polygon objects and the lava hide each other.

use std::sync::Arc;

use fumarole::gpu::Device;
use fumarole::measure::Paper;
use fumarole::papers::lava::{Lava, Parameters, Particles, Rock, Variant};
use fumarole::scene::{Camera, Mesh, shapes};
use glam::{DMat4, DVec3, Mat4, Vec3};

use super::scene::{draw, parameters, read_back, shaders, texels};
use crate::common::gpu_test;

/// A round object: its middle and its radius in metres.
#[derive(Clone, Copy)]
struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    fn mesh(self) -> Mesh {
        let sphere = shapes::sphere(96, 96);
        let scale = 2.0 * self.radius as f32 / sphere.bounds().diagonal().max_element();
        let place = Mat4::from_translation(self.center.as_vec3()) * Mat4::from_scale(Vec3::splat(scale));
        sphere.transformed(&place)
    }

    /// Distance along `ray` of the first hit, and how far from the outline it is in metres; below 0 for a miss.
    fn hit(self, eye: DVec3, ray: DVec3) -> (f64, f64) {
        let middle = ray.dot(self.center - eye);
        let off = (self.center - eye - ray * middle).length();
        let half = (self.radius.powi(2) - off.powi(2)).max(0.0).sqrt();
        (middle - half, self.radius - off)
    }
}

/// One that is half in the lava, one in front of it, one under the surface, which is seen below its near edge, and one
/// behind it.
const BALLS: [Ball; 4] = [
    Ball { center: DVec3::new(1.0, 0.5, 0.6), radius: 0.25 },
    Ball { center: DVec3::new(1.15, 0.68, 1.0), radius: 0.1 },
    Ball { center: DVec3::new(0.4, 0.25, 0.6), radius: 0.2 },
    Ball { center: DVec3::new(1.6, 0.3, -0.5), radius: 0.3 },
];

/// Level lava, half a metre high, without a border.
fn level() -> Parameters {
    let camera = Camera {
        eye: Vec3::new(1.1, 1.1, 2.8),
        target: Vec3::new(1.0, 0.4, 0.5),
        vertical_fov_rad: 0.7,
        ..parameters().camera
    };
    Parameters { density: [40, 1, 24], radius_m: 0.3, rho: Some(1e-6), border_m: 0.0, camera, ..parameters() }
}

fn picture(device: &Arc<Device>, parameters: &Parameters, objects: &[Mesh]) -> (Vec<[u8; 4]>, Vec<&'static str>) {
    let particles = Particles::seeded(parameters);
    let mut lava =
        Lava::new(&shaders(device), "test", Variant::Paper, parameters, &particles, Rock::built_in(), objects).unwrap();
    let passes = draw(device, &mut lava, 0).passes;
    assert_eq!(read_back(&lava).extract.accepted.len(), 40 * 24);
    (texels(device, lava.picture()), passes.iter().map(|p| p.info.name).collect())
}

#[test]
fn objects_and_lava_hide_each_other() {
    gpu_test(|device| {
        for geometry_stage in [true, false] {
            let parameters = Parameters { geometry_stage, ..level() };
            let (without, passes) = picture(device, &parameters, &[]);
            assert_eq!(passes.last(), Some(&"normalisation"));
            let (with, passes) = picture(device, &parameters, &BALLS.map(Ball::mesh));
            assert_eq!(passes.last(), Some(&"objects"));

            let camera = &parameters.camera;
            let eye = camera.eye.as_dvec3();
            let matrix: DMat4 = camera.projection(parameters.aspect()).as_dmat4() * camera.view().as_dmat4();
            let to_world = matrix.inverse();
            let space = parameters.space_m.as_dvec3();
            let (width, height) = (parameters.width as usize, parameters.height as usize);
            let (mut seen, mut hidden, mut left_out) = ([0; 4], [0; 4], 0);
            for (at, (with, without)) in with.iter().zip(&without).enumerate() {
                let place = |index: usize, count: usize| (index as f64 + 0.5) / count as f64 * 2.0 - 1.0;
                let through = DVec3::new(place(at % width, width), place(at / width, height), 0.5);
                let ray = (to_world.project_point3(through) - eye).normalize();
                let to_lava = (0.5 - eye.y) / ray.y;
                let met = eye + ray * to_lava;
                let from_edge = (met.x.min(space.x - met.x)).min(met.z.min(space.z - met.z));
                let is_lava = to_lava > 0.0 && from_edge > 0.0;
                let hits = BALLS.map(|ball| ball.hit(eye, ray));
                let nearest = (0..4).filter(|&i| hits[i].1 > 0.0).min_by(|&a, &b| hits[a].0.total_cmp(&hits[b].0));
                let is_close_call = hits.iter().any(|(distance, inside)| {
                    inside.abs() < 0.006 || (*inside > 0.0 && is_lava && (distance - to_lava).abs() < 0.01)
                });
                // Splats reach beyond the edge.
                if is_close_call || (nearest.is_some() && from_edge.abs() < 0.06) {
                    left_out += 1;
                    continue;
                }
                match nearest {
                    Some(i) if !is_lava || hits[i].0 < to_lava => {
                        seen[i] += 1;
                        let facing = (eye + ray * hits[i].0 - BALLS[i].center) / BALLS[i].radius;
                        let glow = parameters.color.as_dvec3() * 0.4;
                        let color = 0.55 * glow.lerp(DVec3::new(0.8, 0.9, 1.1), 0.5 + 0.5 * facing.y);
                        let found = DVec3::from_array([0, 1, 2].map(|c| f64::from(with[c]) / 255.0));
                        let off = (found - color.min(DVec3::ONE)).abs().max_element();
                        assert!(off < 0.02, "pixel {at}, ball {i}: {found} {color}");
                    }
                    _ => {
                        (0..4).filter(|&i| hits[i].1 > 0.0).for_each(|i| hidden[i] += 1);
                        assert_eq!(with, without, "pixel {at}");
                    }
                }
            }
            println!("seen {seen:?}, hidden {hidden:?}, {left_out} pixels left out");
            assert!(seen[0] > 300 && seen[1] > 100 && seen[2] > 100 && seen[3] > 50, "{seen:?}");
            assert!(hidden[0] > 100 && hidden[2] > 100 && hidden[3] > 50, "{hidden:?}");
            assert!(left_out * 10 < with.len(), "{left_out}");
        }
    });
}

/// Warnings of a picture, after it.
fn warnings(device: &Arc<Device>, variant: Variant, parameters: &Parameters, objects: &[Mesh]) -> Vec<String> {
    let particles = Particles::seeded(parameters);
    let shaders = shaders(device);
    let mut lava = Lava::new(&shaders, "test", variant, parameters, &particles, Rock::built_in(), objects).unwrap();
    draw(device, &mut lava, 0);
    assert!(lava.settle(&shaders).unwrap() && lava.settle(&shaders).unwrap());
    doubts(&lava)
}

/// Its warnings but for that of splats' options where rays draw the surface.
fn doubts(lava: &Lava) -> Vec<String> {
    lava.warnings().into_iter().filter(|warning| !warning.contains("do not heed")).collect()
}

#[test]
fn an_object_under_the_lava_is_named_once() {
    gpu_test(|device| {
        let parameters = Parameters { geometry_stage: false, ..level() };
        let under = Ball { center: DVec3::new(0.9, 0.25, 0.6), radius: 0.2 };
        for variant in [Variant::Paper, Variant::GpuDriven] {
            // One that the surface cuts, and one that reaches beyond the space, can be seen.
            let seen = [BALLS[0], Ball { center: DVec3::new(0.1, 0.25, 0.6), radius: 0.2 }].map(Ball::mesh);
            assert_eq!(warnings(device, variant, &parameters, &seen), [""; 0], "{variant:?}");
            let found = warnings(device, variant, &parameters, &[BALLS[0].mesh(), under.mesh()]);
            let [warning] = &found[..] else { panic!("{found:?}") };
            assert!(warning.contains("2 of 2") && warning.contains("lies under the lava"), "{warning}");
        }
    });
}

/// Beyond the 20 m that a camera reaches by itself.
#[test]
fn far_away_lava_is_drawn_or_said_to_be_small() {
    gpu_test(|device| {
        for variant in [Variant::Paper, Variant::GpuDriven] {
            let near = Parameters { geometry_stage: false, ..level() };
            let away = |factor: f32| {
                let eye = near.camera.target + factor * (near.camera.eye - near.camera.target);
                Parameters { camera: Camera { eye, ..near.camera }, ..near.clone() }
            };
            let lit = |parameters: &Parameters| {
                let mut lava = super::scene::variant_of(device, variant, parameters, &Particles::seeded(parameters));
                draw(device, &mut lava, 0);
                let pixels: Vec<[u8; 4]> = texels(device, lava.picture());
                (pixels.iter().filter(|p| p[0] > 0).count(), doubts(&lava))
            };
            // 22 m: some 14 pixels wide.
            let (pixels, said) = lit(&away(9.0));
            assert!(pixels > 20 && said.is_empty(), "{variant:?}: {pixels} {said:?}");
            let (_, said) = lit(&away(90.0));
            assert!(said.len() == 1 && said[0].contains("pixels large"), "{variant:?}: {said:?}");
        }
    });
}
