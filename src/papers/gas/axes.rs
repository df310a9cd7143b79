//! The axes of `stress`.

use glam::Vec3;

use super::model::Object;
use super::parameters::MAX_LIGHTS;
use super::setup::Setup;
use crate::measure::stress::{Amount, Axis};
use crate::scene::{Light, Mesh, MeshSource, divided};

/// The default first.
pub fn all() -> Vec<Axis<Setup>> {
    vec![
        Axis::new("surface-triangles", 10_000, |setup: &mut Setup, triangles| {
            setup.surface_triangles = Some(triangles);
            Ok(())
        })
        .help("Triangles of all surfaces, which are divided evenly")
        .unit("triangles")
        .most(MeshSource::MOST_DIVIDED)
        .amount(Amount::Counted("triangles")),
        Axis::new("fragments", 1, |setup: &mut Setup, layers| {
            setup.layers = layers as u32;
            Ok(())
        })
        .help("Fragments a pixel: layers behind the scene that each fill the picture")
        .unit("layers")
        .most(1 << 20)
        .amount(Amount::Found("fragments", "fragments")),
        Axis::new("table", 8 * 8 * 8, |setup: &mut Setup, entries| {
            setup.parameters.table_size = (entries as f64).cbrt().round() as u32;
            Ok(())
        })
        .help("Entries of a volume's density table, and of its shadow table for each light")
        .unit("entries")
        .most(512 * 512 * 512)
        .sets("table")
        .amount(Amount::Rounded(|setup| f64::from(setup.parameters.table_size).powi(3))),
        Axis::of("steps", 10).help("Steps along a volume's longest side"),
        Axis::new("lights", 1, |setup: &mut Setup, lights| {
            setup.parameters.lights = (0..lights as u32).map(light).collect();
            Ok(())
        })
        .help("Lights from infinity, around the scene")
        .most(MAX_LIGHTS as u64),
    ]
}

/// One of several, each a golden angle further around.
fn light(number: u32) -> Light {
    let angle = number as f32 * 2.399_963;
    let direction = Vec3::new(angle.cos(), -1.0, angle.sin());
    Light::Parallel { direction, intensity: Vec3::splat(1.0 / (number + 1) as f32) }
}

impl Setup {
    /// Divides the surfaces into the triangles that the axis wants of all of them together, each by as much.
    pub(super) fn divide_surfaces(&self, objects: &mut [Object]) {
        let Some(wanted) = self.surface_triangles else { return };
        let all: u64 = objects.iter().map(|object| object.mesh.triangle_count() as u64).sum();
        let parts = wanted.div_ceil(all.max(1));
        for object in objects {
            object.mesh = divided(&object.mesh, parts * object.mesh.triangle_count() as u64);
        }
    }

    /// Layers across the whole picture, from twice as far as the camera's target to three times.
    pub(super) fn layers(&self) -> Option<Object> {
        let camera = &self.parameters.camera;
        let forward = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(camera.up).try_normalize().unwrap_or(Vec3::X);
        let (up, target_m) = (right.cross(forward), camera.target.distance(camera.eye));
        // Of its far end, and a little more than it takes to reach the corners.
        let half_m = 3.5 * target_m * (0.5 * camera.vertical_fov_rad).tan();
        let across = right * half_m * (self.parameters.width as f32 / self.parameters.height.max(1) as f32).max(1.0);
        let mut mesh = Mesh { name: "layers".to_owned(), ..Mesh::default() };
        for layer in 0..self.layers {
            let first = mesh.positions.len() as u32;
            let middle = camera.eye + forward * target_m * (2.0 + layer as f32 / self.layers as f32);
            let up = up * half_m;
            mesh.positions.extend([
                middle - across - up,
                middle + across - up,
                middle + across + up,
                middle - across + up,
            ]);
            mesh.normals.extend([-forward; 4]);
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
        }
        let opacity = self.layer_opacity;
        (self.layers > 0).then(|| Object { opacity, ..Object::new(mesh, Vec3::splat(0.5)) })
    }
}
