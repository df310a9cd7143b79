//! The elements of a scene: solids full of gas, surfaces, and the solid textures of both.

use glam::{Vec2, Vec3};

use crate::scene::Mesh;

/// The solid that bounds a gas, inside its box of `center` and `half_extent_m`. Axes of cylinder and frustum are
/// vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Box,
    /// An ellipsoid where the half extents differ.
    Sphere,
    Cylinder,
    /// Radii at the bottom and at the top as fractions of the half extents, 0 to 1.
    Frustum {
        /// Radius at the lower end.
        bottom: f32,
        /// Radius at the upper end.
        top: f32,
    },
}

/// A density function (section "Modeling and animating the gases").
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DensityFunction {
    /// `opaque` everywhere.
    Constant,
    /// (turbulence x opaque)^power.
    Turbulence,
    /// `clouds`: a sine wave through the turbulent space.
    Clouds { frequency: f32 },
    /// `chess_fog`, which rolls in along +X.
    Fog { swirl: Swirl, front: Front },
    /// Rises, and thins with its height in the volume (figure 6).
    Steam { swirl: Swirl },
    /// A soft ball with a turbulent surface (Perlin and Hoffert).
    Hypertexture {
        /// Fraction of its radius by which the turbulence moves the surface, at least 0.
        amplitude: f32,
        /// Fraction of the radius over which it turns dense, above 0.
        softness: f32,
    },
    /// (sample x opaque)^power: the grid of that index, from a file.
    Grid(usize),
}

/// Motion of a point through the solid texture as the frames go on: along a helix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swirl {
    /// DOWN of the fog, or the rise of the steam: texture units a frame.
    pub along_per_frame: f32,
    /// SWIRL_FRAMES, frames of one revolution; 0 for none.
    pub frames: f32,
    /// ELLIPSE1 and ELLIPSE2, texture units.
    pub ellipse: [f32; 2],
}

/// The fog's front: no fog has a greater x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    /// At frame 0, metres.
    pub x_m: f32,
    /// Metres a frame.
    pub per_frame_m: f32,
    /// Behind the front until the fog is at its thickest, above 0.
    pub depth_m: f32,
    /// FULL_FOG: frames until the fog is at its thickest; 0 for at once.
    pub full_frames: f32,
    /// Metres by which a turbulence of 1 moves it.
    pub turbulence_m: f32,
    /// Metres by which a random number of 1 of the table moves it.
    pub table_m: f32,
}

/// A density function with its place in the solid texture's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidTexture {
    /// The function of the turbulence there.
    pub function: DensityFunction,
    /// The density's factor, 0 to 1,000,000.
    pub opaque: f32,
    /// Its exponent, above 0 and at most 100.
    pub power: f32,
    /// Texture units a metre, above 0.
    pub scale_per_m: f32,
    /// Texture units.
    pub offset: Vec3,
}

/// One Henyey-Greenstein function of a sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreenstein {
    /// At least 0; the weights add up to 1.
    pub weight: f32,
    /// -1 (backwards) to 1 (forwards), both excluded.
    pub g: f32,
}

/// A solid full of gas, or a solid (hypertexture) object rendered as a volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// The solid that bounds it.
    pub shape: Shape,
    /// Metres.
    pub center: Vec3,
    /// Metres, above 0.
    pub half_extent_m: Vec3,
    /// Fraction of the distance from the boundary to the middle over which the gas fades, 0 (not at all) to 1.
    pub falloff: f32,
    /// A solid, with normals and opacity = 1 - (1 - density)^(c step).
    pub is_solid: bool,
    /// Its density.
    pub texture: SolidTexture,
    /// tau of a gas or c of a solid, per metre, 0 to 1,000,000.
    pub tau_per_m: f32,
    /// Linear RGB, 0 to 1.
    pub albedo: Vec3,
    /// The two functions whose sum scatters light.
    pub phase: [HenyeyGreenstein; 2],
}

impl Volume {
    /// Step of the march: the longest side over `steps`.
    pub fn step_m(&self, steps: u32) -> f32 {
        2.0 * self.half_extent_m.max_element() / steps as f32
    }
}

/// A pattern of squares in all three dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Checker {
    /// Of every other square, linear RGB.
    pub color: Vec3,
    /// Above 0.
    pub edge_m: f32,
}

/// A second colour in all three dimensions, by a solid texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Veins {
    /// Colour at 1 of the texture, linear RGB.
    pub color: Vec3,
    /// Its part of the surface's colour, 0 to 1.
    pub texture: SolidTexture,
}

/// Phong's highlight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Highlight {
    /// At least 0.
    pub strength: f32,
    /// Above 0.
    pub exponent: f32,
}

/// A surface object: scanline-rendered in the paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// In world space.
    pub mesh: Mesh,
    /// Linear RGB.
    pub color: Vec3,
    /// 0 to 1.
    pub opacity: f32,
    /// Squares of a second colour.
    pub checker: Option<Checker>,
    /// Veins of another colour.
    pub veins: Option<Veins>,
    /// Its highlight, 0 for none.
    pub highlight: Highlight,
    /// Triangles are seen from behind as well.
    pub is_two_sided: bool,
    /// A surface-defined gas: its opacity at every point.
    pub gas: Option<SolidTexture>,
    /// Depth before the opaque surface behind it over which a surface-defined gas fades, metres; 0 for none.
    pub fade_m: f32,
    /// Distances in x and z from its origin at which such a gas has faded out, over as many metres; 0 for no such end.
    pub ends_m: Vec2,
    /// Cosine between its normal and the ray below which such a gas fades towards its silhouette, 0 (not at all) to 1.
    pub rim: f32,
    /// Metres a frame.
    pub per_frame_m: Vec3,
}

impl Object {
    /// The same without its triangles.
    pub fn without_mesh(&self) -> Self {
        let &Object { color, opacity, checker, veins, highlight, is_two_sided, gas, fade_m, ends_m, rim, .. } = self;
        let (mesh, per_frame_m) = (Mesh::default(), self.per_frame_m);
        Object { mesh, color, opacity, checker, veins, highlight, is_two_sided, gas, fade_m, ends_m, rim, per_frame_m }
    }

    /// Its solid textures: that of its gas, then that of its veins.
    pub fn solid_textures(&self) -> impl Iterator<Item = &SolidTexture> {
        self.gas.iter().chain(self.veins.as_ref().map(|veins| &veins.texture))
    }

    /// A dull opaque object, seen from both sides.
    pub fn new(mesh: Mesh, color: Vec3) -> Self {
        Object {
            mesh,
            color,
            opacity: 1.0,
            checker: None,
            veins: None,
            highlight: Highlight { strength: 0.0, exponent: 1.0 },
            is_two_sided: true,
            gas: None,
            fade_m: 0.0,
            ends_m: Vec2::ZERO,
            rim: 0.0,
            per_frame_m: Vec3::ZERO,
        }
    }
}
