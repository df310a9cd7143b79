//! Pass `crust-relief` (sections 3.2 and 3.3): ropes, pieces and seams of the crust, their temperatures and the rock on them. Ours.

use std::sync::Arc;

use super::super::sph::{Sph, over_cells};
use super::super::targets::Context;
use crate::gpu::{Buffer, Error, ImageView, Pass};

/// Makes the pass from the surface's motion, temperatures and carried rock to heights, temperatures and carried rock of the crust; `toes` has
/// the number of each particle's.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn crust_relief(
    context: Context<'_>,
    sph: &Sph,
    [motion, temperatures, carried]: [&Arc<ImageView>; 3],
    [crust, toes]: [&Arc<Buffer>; 2],
    [heights, crust_temperatures, crust_carried]: [&Arc<ImageView>; 3],
) -> Result<Pass, Error> {
    over_cells("crust-relief", "lava/crust-relief.comp", &sph.sort)
        .with("predicted", sph.arrived())
        .with("items", &sph.sort.items)
        .with("bed", &sph.bed)
        .with("motion", motion)
        .with("temperatures", temperatures)
        .with("carried", carried)
        .with("crust", crust)
        .with("toes", toes)
        .with("crowded", sph.crowded())
        .with("heights", heights)
        .with("crust_temperatures", crust_temperatures)
        .with("crust_carried", crust_carried)
        .build(context.shaders)
}
