//! Figures 4 and 7: fog over a chess board, by surfaces and by a volume.

use glam::{Mat4, Vec2, Vec3};

use super::lathe::{curve, turned};
use super::sweep::swept;
use super::{Scene, block, bright, floor, placed, shiny};
use crate::papers::gas::model::{Checker, DensityFunction, Front, Object, Shape, SolidTexture, Swirl, Volume};
use crate::papers::gas::parameters::{Parameters, default_volume};
use crate::scene::{Camera, Light, Mesh};

const WHITE: Vec3 = Vec3::new(0.72, 0.66, 0.52);
const BLACK: Vec3 = Vec3::new(0.10, 0.08, 0.08);

fn piece(name: &str, points: &[(f32, f32)]) -> Mesh {
    let points: Vec<Vec2> = points.iter().map(|&(x, y)| Vec2::new(x, y)).collect();
    turned(name, &curve(&points, 4), 32)
}

fn rook() -> Mesh {
    piece(
        "rook",
        &[
            (0.42, 0.0),
            (0.42, 0.12),
            (0.30, 0.22),
            (0.24, 0.5),
            (0.22, 0.85),
            (0.34, 0.95),
            (0.34, 1.2),
            (0.24, 1.2),
            (0.22, 1.05),
            (0.0, 1.05),
        ],
    )
}

fn pawn() -> Mesh {
    piece(
        "pawn",
        &[
            (0.36, 0.0),
            (0.36, 0.1),
            (0.26, 0.2),
            (0.15, 0.45),
            (0.13, 0.6),
            (0.24, 0.66),
            (0.14, 0.72),
            (0.23, 0.86),
            (0.16, 1.02),
            (0.0, 1.08),
        ],
    )
}

/// A knight: a turned foot, and a horse's head, whose outline faces +X before it is turned.
fn knight(at: Vec3, color: Vec3) -> [Object; 2] {
    let foot =
        piece("knight's foot", &[(0.40, 0.0), (0.40, 0.12), (0.28, 0.24), (0.25, 0.36), (0.30, 0.44), (0.0, 0.46)]);
    let head: [&[(f32, f32)]; 4] = [
        // Chest, throat and jaw to the mouth.
        &[
            (0.27, 0.44),
            (0.25, 0.54),
            (0.17, 0.66),
            (0.10, 0.77),
            (0.13, 0.84),
            (0.24, 0.80),
            (0.33, 0.76),
            (0.39, 0.79),
        ],
        // Mouth, nose and forehead to the ear.
        &[(0.36, 0.82), (0.42, 0.85), (0.42, 0.92), (0.35, 0.98), (0.26, 1.06), (0.18, 1.17), (0.15, 1.22)],
        // The ear.
        &[(0.13, 1.36), (0.03, 1.25)],
        // The mane down to the neck.
        &[(-0.06, 1.24), (-0.15, 1.17), (-0.22, 1.05), (-0.26, 0.90), (-0.27, 0.74), (-0.26, 0.58), (-0.28, 0.44)],
    ];
    let smooth = |points: &&[(f32, f32)]| {
        let points: Vec<Vec2> = points.iter().map(|&(x, y)| Vec2::new(x + 1.0, y)).collect();
        curve(&points, 3)
    };
    let outline: Vec<Vec2> = head.iter().flat_map(smooth).map(|p| p - Vec2::X).collect();
    let turn = Mat4::from_rotation_y(3.0);
    let head = swept("knight's head", &outline, 0.16, 0.05).transformed(&turn);
    [piece_at(foot, at, color), piece_at(head, at, color)]
}

fn piece_at(mesh: Mesh, at: Vec3, color: Vec3) -> Object {
    shiny(placed(mesh, at, color), 0.35, 25.0)
}

/// As thick as real ones are: seen from below it hides the feet of its pieces.
fn board() -> Object {
    let squares = Checker { color: Vec3::new(0.08, 0.07, 0.07), edge_m: 1.0 };
    let wood = Vec3::new(0.60, 0.55, 0.45);
    Object { checker: Some(squares), ..block(Vec3::new(-4.0, -0.12, -4.0), Vec3::new(4.0, 0.0, 4.0), wood) }
}

fn parameters(volumes: Vec<Volume>) -> Parameters {
    Parameters {
        volumes,
        lights: vec![Light::Parallel { direction: Vec3::new(-0.45, -1.0, -0.35), intensity: Vec3::splat(0.95) }],
        ambient: Vec3::new(0.30, 0.31, 0.34),
        background: Vec3::new(0.03, 0.04, 0.07),
        camera: Camera {
            eye: Vec3::new(1.0, 2.5, 7.4),
            target: Vec3::new(0.0, 0.35, 0.0),
            up: Vec3::Y,
            vertical_fov_rad: 0.62,
            near_m: 0.1,
            far_m: 60.0,
        },
        width: 320,
        height: 240,
        ..Parameters::default()
    }
}

const fn swirl(along: f32) -> Swirl {
    Swirl { along_per_frame: along, frames: 126.0, ellipse: [0.25, 0.2] }
}

/// Fog that has no front within sight.
const NO_FRONT: Front =
    Front { x_m: 1e6, per_frame_m: 0.0, depth_m: 1.0, full_frames: 0.0, turbulence_m: 0.0, table_m: 0.0 };

/// Figure 4: three planes, each with its own transparency and motion, in one solid texture.
pub fn surface_fog() -> Scene {
    let mut objects = vec![board(), piece_at(rook(), Vec3::new(-0.5, 0.0, 0.5), WHITE)];
    objects.extend(knight(Vec3::new(1.5, 0.0, -0.5), BLACK));
    objects.push(piece_at(pawn(), Vec3::new(0.5, 0.0, 1.5), WHITE));
    objects.push(piece_at(pawn(), Vec3::new(-2.5, 0.0, -1.5), BLACK));
    for (height_m, opaque, power, along) in [(0.22, 1.5, 2.6, 0.006), (0.45, 1.35, 2.9, 0.01), (0.7, 1.2, 3.2, 0.015)] {
        let function = DensityFunction::Fog { swirl: swirl(along), front: NO_FRONT };
        let gas = SolidTexture { function, opaque, power, scale_per_m: 1.1, offset: Vec3::new(4.2, 1.7, 9.1) };
        // Ours: the paper says nothing of the planes' ends, and not of what they cut.
        let plane = floor(Vec2::splat(8.0), height_m, Vec3::splat(0.95));
        objects.push(Object { gas: Some(gas), fade_m: 0.9, ends_m: Vec2::splat(4.0), ..plane });
    }
    Scene { parameters: Parameters { width: 1024, height: 768, ..parameters(Vec::new()) }, objects }
}

/// The fog of figure 7.
pub const FOG: DensityFunction = DensityFunction::Fog {
    swirl: swirl(0.012),
    front: Front { x_m: -4.6, per_frame_m: 0.017, depth_m: 2.5, full_frames: 0.0, turbulence_m: 0.8, table_m: 0.6 },
};

/// Figure 7: fog rolls in from the left, and a rook moves through it.
pub fn volume_fog() -> Scene {
    let fog = bright(Volume {
        shape: Shape::Box,
        center: Vec3::new(0.0, 0.5, 0.0),
        half_extent_m: Vec3::new(4.0, 0.5, 4.0),
        falloff: 0.35,
        texture: SolidTexture {
            function: FOG,
            opaque: 2.0,
            power: 2.6,
            scale_per_m: 1.2,
            offset: Vec3::new(4.2, 1.7, 9.1),
        },
        tau_per_m: 6.0,
        ..default_volume()
    });
    let rook =
        Object { per_frame_m: Vec3::new(0.0, 0.0, 0.0045), ..piece_at(rook(), Vec3::new(-0.5, 0.0, -1.2), WHITE) };
    let objects = vec![
        board(),
        rook,
        piece_at(pawn(), Vec3::new(0.5, 0.0, 0.5), WHITE),
        piece_at(pawn(), Vec3::new(2.5, 0.0, -1.5), BLACK),
        piece_at(pawn(), Vec3::new(-2.5, 0.0, -0.5), BLACK),
    ];
    // The board is eight times as wide as the fog is high: the steps follow the height.
    Scene { parameters: Parameters { steps: 80, ..parameters(vec![fog]) }, objects }
}
