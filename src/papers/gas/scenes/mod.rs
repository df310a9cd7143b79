//! The scenes of the paper's figures, modelled anew from procedural meshes.

mod chess;
mod clouds;
mod gallery;
mod glass;
mod lathe;
mod sweep;

use crate::named;
use glam::{Mat4, Vec2, Vec3};

pub use self::chess::FOG;
pub use self::gallery::HYPERTEXTURE;
pub use self::glass::STEAM;

use super::model::{Highlight, Object, Volume};
use super::parameters::Parameters;
use crate::scene::{Mesh, shapes};

named! {
    /// A figure's scene.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Preset {
        /// A gallery with a gaseous sculpture.
        Fig3 = "fig-3",
        /// Surface-defined fog over a chess board.
        Fig4 = "fig-4",
        /// The gallery, self-shadowed by the table.
        Fig5 = "fig-5",
        /// Steam that rises from a glass, glasses in front of, around and behind it.
        Fig6 = "fig-6",
        /// Volume fog that rolls over a chess board.
        Fig7 = "fig-7",
        /// Steam and one glass, for the shadowing variants.
        Fig8 = "fig-8",
        /// A solid (hypertexture) volume on a pedestal.
        Solid = "solid",
        /// A layer of clouds, and clouds on ellipsoids, by surfaces.
        Clouds = "clouds",
    }
}

/// A scene with its numbers.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its numbers.
    pub parameters: Parameters,
    /// Its surfaces.
    pub objects: Vec<Object>,
}

impl Preset {
    /// The frames of the paper's sequence.
    pub fn frames(self) -> Vec<u32> {
        match self {
            Preset::Fig6 => (0..=150).step_by(30).collect(),
            Preset::Fig7 => (0..=400).step_by(80).chain((440..=520).step_by(40)).collect(),
            _ => vec![self.bench_frame()],
        }
    }

    /// A frame in which there is gas, for benchmarks.
    pub fn bench_frame(self) -> u32 {
        match self {
            Preset::Fig3 | Preset::Fig5 | Preset::Solid | Preset::Clouds => 0,
            Preset::Fig4 => 60,
            Preset::Fig6 | Preset::Fig8 => 60,
            Preset::Fig7 => 400,
        }
    }

    /// The variant of the figure.
    pub fn variant(self) -> super::Variant {
        match self {
            Preset::Fig3 => super::Variant::None,
            Preset::Fig4 | Preset::Clouds => super::Variant::NoVolume,
            Preset::Fig5 | Preset::Fig8 | Preset::Solid => super::Variant::Table,
            Preset::Fig6 | Preset::Fig7 => super::Variant::Surfaces,
        }
    }

    /// Models the scene. It begins at frame 0, and frame by frame.
    pub fn scene(self) -> Scene {
        match self {
            Preset::Fig3 | Preset::Fig5 => gallery::scene(),
            Preset::Fig4 => chess::surface_fog(),
            Preset::Fig6 => glass::three_glasses(),
            Preset::Fig7 => chess::volume_fog(),
            Preset::Fig8 => glass::one_glass(),
            Preset::Solid => gallery::solid(),
            Preset::Clouds => clouds::scene(),
        }
    }
}

/// A box between two corners, metres.
fn block(low: Vec3, high: Vec3, color: Vec3) -> Object {
    let place = Mat4::from_scale_rotation_translation((high - low) / 2.0, glam::Quat::IDENTITY, (low + high) / 2.0);
    Object { is_two_sided: false, ..Object::new(shapes::cuboid().transformed(&place), color) }
}

/// A level rectangle that faces up, metres.
fn floor(size_m: Vec2, height_m: f32, color: Vec3) -> Object {
    placed(shapes::plane(size_m, glam::UVec2::ONE), Vec3::Y * height_m, color)
}

/// A mesh moved to a place.
fn placed(mesh: Mesh, at: Vec3, color: Vec3) -> Object {
    Object::new(mesh.transformed(&Mat4::from_translation(at)), color)
}

fn shiny(object: Object, strength: f32, exponent: f32) -> Object {
    Object { highlight: Highlight { strength, exponent }, ..object }
}

/// A gas as most scenes have it: bright, as its higher orders of scattering are in the ambient light.
fn bright(volume: Volume) -> Volume {
    Volume { albedo: Vec3::splat(0.95), ..volume }
}
