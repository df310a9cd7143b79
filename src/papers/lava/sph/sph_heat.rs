//! Pass `sph-heat` (section 9): the temperature of each particle after conduction and the radiation of the surface.

use std::sync::Arc;

use super::over_cells;
use crate::gpu::{Buffer, Error, Pass, ShaderLibrary};
use crate::papers::lava::gpu_driven::sort::Sort;

/// Makes the pass; `pushed` holds the temperatures before, `heat` takes those after and the steepness of each face.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn sph_heat(shaders: &ShaderLibrary, sort: &Sort, pushed: &Arc<Buffer>, heat: &Arc<Buffer>) -> Result<Pass, Error> {
    over_cells("sph-heat", "lava/sph-heat.comp", sort).with("pushed", pushed).with("heat", heat).build(shaders)
}
