//! Figures 6 and 8: steam that rises out of a glass before a wall.

use glam::{Vec2, Vec3};

use super::lathe::{curve, turned};
use super::{Scene, block, bright, floor, placed, shiny};
use crate::papers::gas::model::{Checker, DensityFunction, Object, Shape, SolidTexture, Swirl, Volume};
use crate::papers::gas::parameters::{Parameters, default_volume};
use crate::scene::{Camera, Light, Mesh};

/// Height of the drink's surface, from which the steam rises, metres.
const DRINK_M: f32 = 0.85;

/// A tumbler of 0.5 m radius, inside and outside.
fn tumbler() -> Mesh {
    let outside = curve(&[Vec2::new(0.40, 0.0), Vec2::new(0.44, 0.35), Vec2::new(0.48, 0.8), Vec2::new(0.50, 1.2)], 6);
    let inside = curve(&[Vec2::new(0.46, 1.2), Vec2::new(0.44, 0.8), Vec2::new(0.40, 0.35), Vec2::new(0.36, 0.08)], 6);
    let mut profile = vec![Vec2::new(0.0, 0.0), outside[0]];
    profile.extend(&outside);
    profile.extend([outside[outside.len() - 1], inside[0]]);
    profile.extend(&inside);
    profile.extend([inside[inside.len() - 1], Vec2::new(0.0, 0.08)]);
    turned("tumbler", &profile, 48)
}

fn drink() -> Mesh {
    let profile = [
        (0.0, 0.09),
        (0.355, 0.09),
        (0.355, 0.09),
        (0.395, 0.35),
        (0.435, 0.80),
        (0.438, DRINK_M),
        (0.438, DRINK_M),
        (0.0, DRINK_M),
    ];
    turned("drink", &profile.map(|(x, y)| Vec2::new(x, y)), 48)
}

fn glass_at(at: Vec3) -> Object {
    let glass = Object { opacity: 0.16, ..placed(tumbler(), at, Vec3::new(0.75, 0.85, 0.9)) };
    shiny(glass, 2.5, 60.0)
}

/// The steam of figures 6 and 8.
pub const STEAM: DensityFunction =
    DensityFunction::Steam { swirl: Swirl { along_per_frame: 0.03, frames: 120.0, ellipse: [0.2, 0.2] } };

/// Steam from the drink's surface on.
fn steam() -> Volume {
    let half = Vec3::new(0.75, 1.05, 0.75);
    bright(Volume {
        shape: Shape::Frustum { bottom: 0.56, top: 1.0 },
        center: Vec3::new(0.0, DRINK_M + half.y, 0.0),
        half_extent_m: half,
        falloff: 0.5,
        texture: SolidTexture {
            function: STEAM,
            opaque: 2.1,
            power: 3.0,
            scale_per_m: 2.2,
            offset: Vec3::new(7.3, 2.1, 4.7),
        },
        tau_per_m: 9.0,
        ..default_volume()
    })
}

fn scene(objects: Vec<Object>) -> Scene {
    let room = [
        Object {
            checker: Some(Checker { color: Vec3::new(0.24, 0.14, 0.09), edge_m: 0.6 }),
            ..floor(Vec2::splat(12.0), 0.0, Vec3::new(0.34, 0.20, 0.12))
        },
        block(Vec3::new(-6.0, 0.0, -1.7), Vec3::new(6.0, 5.0, -1.5), Vec3::new(0.28, 0.34, 0.45)),
    ];
    let position = Vec3::new(1.8, 4.0, 3.2);
    let parameters = Parameters {
        volumes: vec![steam()],
        lights: vec![Light::Point { position, intensity: Vec3::splat(position.length_squared() * 0.85) }],
        ambient: Vec3::splat(0.22),
        camera: Camera {
            eye: Vec3::new(0.6, 2.1, 5.2),
            target: Vec3::new(0.0, 1.15, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.60,
            near_m: 0.1,
            far_m: 50.0,
        },
        ..Parameters::default()
    };
    Scene { parameters, objects: room.into_iter().chain(objects).collect() }
}

fn filled(at: Vec3) -> [Object; 2] {
    [shiny(placed(drink(), at, Vec3::new(0.20, 0.08, 0.03)), 0.3, 30.0), glass_at(at)]
}

/// Figure 8.
pub fn one_glass() -> Scene {
    scene(filled(Vec3::ZERO).into())
}

/// Figure 6: the steaming glass stands among others, one before the gas and one behind it.
pub fn three_glasses() -> Scene {
    let mut objects: Vec<Object> = filled(Vec3::ZERO).into();
    objects.push(glass_at(Vec3::new(0.75, 0.0, 0.9)));
    objects.push(glass_at(Vec3::new(-0.7, 0.0, -0.9)));
    let mut scene = scene(objects);
    (scene.parameters.width, scene.parameters.height) = (420, 400);
    scene
}
