//! Pass `slice-images` (section 5.2.1, figures 5-2 and 5-3): for every sample plane an image of the diffuse light on
//! the receiver within the plane's cell.

use std::sync::Arc;

use super::receiver::LitReceiver;
use super::resources::{BLACK, Context, DEPTH, FAR, LIGHT};
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageView, Pass};

/// The pass.
pub struct SliceImages {
    /// One for each plane: same pass, next layer.
    passes: Vec<Pass>,
    /// All slices, one a layer.
    pub illumination_map: Arc<ImageView>,
    /// Each slice by itself.
    pub slices: Vec<Arc<ImageView>>,
}

impl SliceImages {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more planes than an array has layers.
    pub fn new(context: Context<'_>, lit: &LitReceiver) -> Result<Self, Error> {
        let planes = context.parameters.planes;
        let depth = context.map("slice-depth", DEPTH)?;
        // A map of this size exists by now: what a device may still refuse is the number of layers.
        let desc = context.map_desc("illumination-map", LIGHT).layers(planes);
        let image = Image::new(context.device(), desc).map_err(|error| error.set_by("planes"))?;
        let slices = (0..planes).map(|i| image.layer(i)).collect::<Result<Vec<_>, _>>()?;
        let first = lit
            .map_pass("slice-images", "5.2.1", "caustics/diffuse-map.frag")
            .color(&slices[0], BLACK, Blend::Replace)
            .depth(&depth, FAR, DepthTest::LessWrite)
            .build(context.shaders)?;
        let each = slices.iter().map(|slice| first.rebind().color(0, slice, BLACK).build(context.shaders));
        Ok(SliceImages { passes: each.collect::<Result<_, _>>()?, illumination_map: image.view()?, slices })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        let mut each = self.passes.iter().zip(&lit.cells);
        each.try_for_each(|(pass, cell)| lit.draw_into_map(frame, pass, Some(cell)))
    }
}
