//! The CPU oracle of the terrain paper: plain `f64` written from the equations, not a port of a shader.
//!
//! A terrain is a base surface and the maps over it. A place on the base is (u, v, h): h is the height along the base's
//! normal, in metres, and the point is F = P(u, v) + n h (eq. 5, 6). The base is solid below h = 0, a map's rectangle is
//! solid below its interpolated heights (eq. 7) less the base level, and the solids are united: the edges of a map are
//! walls, and outside every map there is the base itself.
//!
//! ```text
//! Grid (heights, interpolation) ─┐
//! Base (u, v, h <-> x, y, z) ────┴─► Terrain ─► first_hit, clearance ─► lambert, is_lit
//!                                       └─────► segment, sphere
//! ```
//!
//! | base | u | v | h |
//! | --- | --- | --- | --- |
//! | plane | x, metres | z, metres | y |
//! | cylinder about y | angle from +x towards -z, radians | y, metres | above the radius |
//! | ellipsoid about y | longitude from +x towards -z, radians | geodetic latitude, radians | along the normal |

mod base;
mod clearance;
mod collision;
#[cfg(test)]
mod fixtures;
mod grid;
mod interval;
mod path;
mod polynomial;
mod pyramid;
mod ray;
mod search;
mod shading;
mod sheet;
#[cfg(test)]
mod tests;
mod triangles;

pub use base::{Base, Frame, Place};
pub use clearance::Clearance;
pub use collision::Contact;
pub use grid::{Grid, Interpolation, Sample};
pub use pyramid::{Extreme, Level, pyramid};
pub use ray::{Hit, Part, Ray, Terrain};
pub use shading::{is_lit, lambert};
pub use triangles::Square;
