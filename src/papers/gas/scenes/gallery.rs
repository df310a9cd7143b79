//! Figures 3 and 5: a gallery with a gaseous ball as part of a modern sculpture; and a solid volume on its pedestal.

use glam::{Mat4, Vec2, Vec3};

use super::lathe::{curve, turned};
use super::{Scene, block, bright, floor, placed, shiny};
use crate::papers::gas::model::{Checker, DensityFunction, Object, Shape, SolidTexture, Veins, Volume};
use crate::papers::gas::parameters::{Parameters, default_volume};
use crate::scene::{Camera, Light, shapes};

const BALL_M: Vec3 = Vec3::new(0.0, 1.75, 0.0);

/// Veins of marble: a sine wave through the turbulent space, narrow where it is dense.
fn marble(color: Vec3, scale_per_m: f32) -> Option<Veins> {
    let function = DensityFunction::Clouds { frequency: 9.0 };
    let texture = SolidTexture { function, opaque: 0.85, power: 3.0, scale_per_m, offset: Vec3::new(2.3, 6.1, 4.7) };
    Some(Veins { color, texture })
}

fn pedestal() -> Object {
    let points = [(0.50, 0.0), (0.48, 0.12), (0.30, 0.25), (0.24, 0.5), (0.30, 0.78), (0.45, 0.88), (0.45, 0.95)];
    let mut profile = curve(&points.map(|(x, y)| Vec2::new(x, y)), 6);
    profile.extend([Vec2::new(0.45, 0.95), Vec2::new(0.0, 0.95)]);
    let stone = placed(turned("pedestal", &profile, 48), Vec3::ZERO, Vec3::new(0.55, 0.53, 0.50));
    shiny(Object { veins: marble(Vec3::new(0.16, 0.17, 0.20), 2.0), ..stone }, 0.2, 20.0)
}

/// A framed picture on the back wall.
fn painting(middle: Vec3, half: Vec2, color: Vec3) -> [Object; 2] {
    let corner = |grow: f32, depth: f32| {
        let reach = (half + grow).extend(depth);
        block(middle - reach.with_z(0.0), middle + reach, color)
    };
    let squares = Some(Checker { color: Vec3::new(0.9, 0.85, 0.7) - color * 0.5, edge_m: half.x * 0.45 });
    let frame = Object { color: Vec3::new(0.30, 0.20, 0.08), ..corner(0.07, 0.05) };
    [frame, Object { checker: squares, ..corner(0.0, 0.06) }]
}

fn room() -> Vec<Object> {
    let tiles = Checker { color: Vec3::new(0.16, 0.12, 0.10), edge_m: 0.8 };
    let mut objects = vec![
        Object { checker: Some(tiles), ..floor(Vec2::splat(16.0), 0.0, Vec3::new(0.42, 0.36, 0.30)) },
        block(Vec3::new(-8.0, 0.0, -3.2), Vec3::new(8.0, 5.0, -3.0), Vec3::new(0.24, 0.17, 0.15)),
        block(Vec3::new(-4.2, 0.0, -3.0), Vec3::new(-4.0, 5.0, 6.0), Vec3::new(0.22, 0.19, 0.20)),
        pedestal(),
    ];
    objects.extend(painting(Vec3::new(-2.3, 2.1, -3.0), Vec2::new(0.75, 0.55), Vec3::new(0.55, 0.12, 0.10)));
    objects.extend(painting(Vec3::new(2.2, 2.0, -3.0), Vec2::new(0.6, 0.75), Vec3::new(0.10, 0.22, 0.50)));
    let teapot = shapes::teapot();
    let bounds = teapot.bounds();
    let scale = 0.9 / bounds.diagonal().max_element();
    let foot = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z) * scale;
    let stand = Vec3::new(2.1, 0.7, -1.2);
    let stone = block(Vec3::new(1.7, 0.0, -1.6), Vec3::new(2.5, 0.7, -0.8), Vec3::new(0.20, 0.30, 0.24));
    objects.push(Object { veins: marble(Vec3::new(0.62, 0.66, 0.60), 2.6), ..stone });
    let place = Mat4::from_translation(stand - foot) * Mat4::from_scale(Vec3::splat(scale));
    objects.push(shiny(Object::new(teapot.transformed(&place), Vec3::new(0.55, 0.35, 0.12)), 0.6, 40.0));
    objects
}

/// Three rods that hold the ball.
fn rods() -> Vec<Object> {
    let rod = turned("rod", &[Vec2::new(0.03, 0.0), Vec2::new(0.03, 1.7)], 12);
    [(-0.38, 0.25), (0.38, 0.25), (0.0, -0.38)]
        .into_iter()
        .map(|(x, z)| shiny(placed(rod.clone(), Vec3::new(x, 0.95, z), Vec3::new(0.75, 0.6, 0.25)), 0.8, 30.0))
        .collect()
}

fn parameters(volume: Volume) -> Parameters {
    let position = Vec3::new(3.0, 6.0, 3.0);
    Parameters {
        volumes: vec![volume],
        lights: vec![Light::Point { position, intensity: Vec3::splat(position.length_squared() * 0.8) }],
        ambient: Vec3::splat(0.32),
        camera: Camera {
            eye: Vec3::new(1.2, 2.0, 6.2),
            target: Vec3::new(0.0, 1.45, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.62,
            near_m: 0.1,
            far_m: 60.0,
        },
        width: 1024,
        height: 682,
        ..Parameters::default()
    }
}

/// Figures 3 and 5.
pub fn scene() -> Scene {
    let ball = bright(Volume {
        shape: Shape::Sphere,
        center: BALL_M,
        half_extent_m: Vec3::splat(0.85),
        falloff: 0.45,
        texture: SolidTexture {
            function: DensityFunction::Turbulence,
            opaque: 2.2,
            power: 3.0,
            scale_per_m: 2.4,
            offset: Vec3::new(3.1, 0.7, 5.9),
        },
        tau_per_m: 14.0,
        ..default_volume()
    });
    let objects = room().into_iter().chain(rods()).collect();
    Scene { parameters: parameters(ball), objects }
}

/// The surface of the solid.
pub const HYPERTEXTURE: DensityFunction = DensityFunction::Hypertexture { amplitude: 1.4, softness: 0.16 };

/// A hypertexture ball, opaque, with shaded normals.
pub fn solid() -> Scene {
    let ball = Volume {
        shape: Shape::Sphere,
        center: BALL_M,
        half_extent_m: Vec3::splat(0.8),
        is_solid: true,
        texture: SolidTexture {
            function: HYPERTEXTURE,
            opaque: 1.0,
            power: 1.0,
            scale_per_m: 3.2,
            offset: Vec3::new(1.3, 8.2, 2.4),
        },
        tau_per_m: 20.0,
        albedo: Vec3::new(0.75, 0.42, 0.18),
        ..default_volume()
    };
    let parameters = Parameters { steps: 120, ..parameters(ball) };
    Scene { parameters, objects: room() }
}
