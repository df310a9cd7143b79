//! Small configurations: maps of 128 texels a side, 1,000 water triangles, nine planes, receivers 2 m long.

use fumarole::papers::caustics::{Parameters, ReceiverInput, WaveParameters};
use fumarole::scene::{Light, Mesh, shapes};
use glam::{Mat4, UVec2, Vec2, Vec3};

pub const OVERHEAD: Light = Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ONE };
pub const OBLIQUE: Light = Light::Parallel { direction: Vec3::new(0.6, -1.0, -0.35), intensity: Vec3::ONE };
pub const POINT: Light = Light::Point { position: Vec3::new(1.0, 2.5, -0.6), intensity: Vec3::ONE };

pub const FLAT: WaveParameters = WaveParameters { count: 0, amplitude_m: 0.0, wavelength_m: 1.0 };

const ALBEDO: Vec3 = Vec3::new(0.9, 0.6, 0.3);

pub fn parameters(light: Light) -> Parameters {
    let defaults = Parameters::default();
    Parameters {
        planes: 9,
        map_size: 128,
        water_triangles: 1000,
        lights: vec![light],
        camera: Parameters::camera_below(defaults.water_depth_m),
        width: 128,
        height: 96,
        ..defaults
    }
}

pub fn teapot() -> ReceiverInput {
    sunk(&shapes::teapot())
}

pub fn sphere() -> ReceiverInput {
    sunk(&shapes::sphere(32, 32))
}

/// A sphere that is round to a tenth of a millimetre.
pub fn round_sphere() -> ReceiverInput {
    sunk(&Mesh { name: "round sphere".to_owned(), ..shapes::sphere(200, 200) })
}

/// A square floor that faces up.
pub fn floor() -> ReceiverInput {
    sunk(&shapes::plane(Vec2::splat(2.0), UVec2::ONE))
}

/// A square that rises along both of its sides.
pub fn tilted_plane() -> ReceiverInput {
    let turn = Mat4::from_rotation_z(0.4) * Mat4::from_rotation_x(0.2);
    let mesh = shapes::plane(Vec2::splat(2.0), UVec2::ONE).transformed(&turn);
    sunk(&Mesh { name: "tilted plane".to_owned(), ..mesh })
}

/// A bowl, open at the top: oblique light enters over its rim and leaves a part of it in shadow.
pub fn bowl() -> ReceiverInput {
    let mut mesh = shapes::plane(Vec2::splat(2.0), UVec2::splat(24));
    mesh.name = "bowl".to_owned();
    for p in &mut mesh.positions {
        p.y = 0.9 * (p.x * p.x + p.z * p.z).min(1.0);
    }
    mesh.smooth_normals();
    sunk(&mesh)
}

/// The mesh scaled to 2 m and set on the pool's floor.
pub fn sunk(mesh: &Mesh) -> ReceiverInput {
    let bounds = mesh.bounds();
    let scale = 2.0 / bounds.diagonal().max_element();
    let foot = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z) * scale;
    let floor = Vec3::NEG_Y * Parameters::default().water_depth_m;
    let place = Mat4::from_translation(floor - foot) * Mat4::from_scale(Vec3::splat(scale));
    ReceiverInput { mesh: mesh.transformed(&place), albedo: ALBEDO }
}
