//! Pass `extract` (section 6.2) on the device: each column of grid points sums up those that it accepts.

use std::sync::Arc;

use super::super::targets::Context;
use crate::gpu::{Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct ExtractConstants {
        grid: [u32; 3],
        rho: f32,
        space_m: f32,
        kind: u32,
    }
}

/// The pass.
pub struct Extract {
    pass: Pass,
    constants: ExtractConstants,
}

impl Extract {
    /// Writes `columns`, and clears `sums`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        density: &Arc<ImageView>,
        columns: &Arc<ImageView>,
        sums: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let parameters = context.parameters;
        let pass = Pass::compute("extract", "6.2", "lava/extract.comp")
            .constants::<ExtractConstants>()
            .with("density", density)
            .with("columns", columns)
            .with("sums", sums)
            .whole(&["density", "columns", "sums"])
            .build(context.shaders)?;
        let constants = ExtractConstants {
            grid: parameters.density,
            rho: parameters.rho(),
            space_m: parameters.space_m.y,
            kind: parameters.surface as u32,
        };
        Ok(Extract { pass, constants })
    }

    /// Sums up the columns of the densities.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let [columns, _, rows] = self.constants.grid;
        frame.compute(&self.pass, |dispatch| dispatch.constants(&self.constants).threads(columns, rows, 1))
    }
}
