use glam::Vec3;

/// A light without extent. Colours are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Parallel rays, as from the sun.
    Parallel {
        /// The direction in which the light travels, not necessarily of unit length.
        direction: Vec3,
        /// Irradiance on a surface facing the light, W/m2 a channel.
        intensity: Vec3,
    },
    /// Rays from one point.
    Point {
        /// World position, metres.
        position: Vec3,
        /// Radiant intensity, W/sr a channel; irradiance falls with the square of the distance.
        intensity: Vec3,
    },
}
