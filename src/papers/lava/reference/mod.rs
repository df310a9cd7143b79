//! The oracle of `lava`: the thesis's equations in `f64`, for the tests. It shares nothing with the shaders.
//!
//! [`step`] is listing 5.1, [`clusters`] section 5.2, [`density`] eq. 6.2, [`Grid::accepted`] section 6.2,
//! [`Surface`] eq. 6.3 and section 6.4, [`Splats`] chapter 7, [`toned`] the display's
//! tone, [`Surface::cast`] rays, which are ours, [`light`] black bodies', [`Fluid`] a viscous fluid and [`Heat`] its heat
//! (chapter 9),
//! [`Crust`] its crust's relief and [`fold_length`] the ropes' length (chapter 3).

mod animation;
mod blackbody;
mod crust;
mod density;
mod fluid;
mod folding;
mod heat;
mod rays;
mod splats;
mod surface;

pub use animation::{clusters, step};
pub use blackbody::{encoded, light};
pub use crust::{Columns, Crust, Texel, fold_steepness};
pub use density::{Grid, density};
pub use fluid::Fluid;
pub use folding::{fold_growth, fold_length};
pub use heat::{Heat, cooled_slab, crust_face, melt_viscosity, yield_stress};
pub use splats::{Pixel, Splats, toned};
pub use surface::Surface;
