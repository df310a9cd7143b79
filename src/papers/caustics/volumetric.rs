//! The volumetric method (section 5.2.1, after Iwasaki et al.): a slice image of the receiver for every sample plane,
//! each multiplied by a caustics map of its own.

use std::sync::Arc;

use super::cast::Cast;
use super::caustics_map::CausticsMap;
use super::combine_slices::CombineSlices;
use super::illumination_volumes::IlluminationVolumes;
use super::multiply::Multiply;
use super::receiver::LitReceiver;
use super::resources::Context;
use super::sample_planes::SamplePlanes;
use super::shadow_map::ShadowMap;
use super::slice_images::SliceImages;
use super::underwater::Underwater;
use super::water_surface::WaterSurface;
use crate::gpu::{Error, ImageView};

/// Passes of the variant.
pub struct Volumetric {
    /// Shared by all receivers.
    pub sample_planes: SamplePlanes,
    /// One for each receiver under each light.
    pub receivers: Vec<ReceiverPasses>,
}

/// Passes of one receiver under one light.
pub struct ReceiverPasses {
    /// Diffuse light in each plane's cell.
    pub slice_images: SliceImages,
    /// I_c of one plane after the other.
    pub caustics_map: CausticsMap,
    /// I_c into each slice.
    pub multiply: Multiply,
    /// The slices put together.
    pub combine_slices: CombineSlices,
    /// The combined map on the receiver.
    pub cast: Cast,
}

impl Volumetric {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more planes than an array has layers.
    pub fn new(
        context: Context<'_>,
        lit_receivers: &[LitReceiver],
        water: &WaterSurface,
        volumes: &[IlluminationVolumes],
        shadow_maps: &[ShadowMap],
        underwater: &Underwater,
    ) -> Result<Self, Error> {
        let passes = |lit: &LitReceiver| {
            let volumes = &volumes[lit.light];
            let caustics_map = CausticsMap::new(context, volumes, water, None, shadow_maps.get(lit.light))?;
            let slice_images = SliceImages::new(context, lit)?;
            let multiply = Multiply::new(context, volumes, &caustics_map.map, &slice_images.slices)?;
            let combine_slices = CombineSlices::new(context, &slice_images.illumination_map)?;
            let cast = Cast::new(context, lit, &combine_slices.map, &combine_slices.position, None, underwater)?;
            Ok(ReceiverPasses { slice_images, caustics_map, multiply, combine_slices, cast })
        };
        let receivers = lit_receivers.iter().map(passes).collect::<Result<_, Error>>()?;
        Ok(Volumetric { sample_planes: SamplePlanes::new(context.parameters), receivers })
    }
}

impl ReceiverPasses {
    /// The maps that can be dumped.
    pub fn targets(&self) -> [(&'static str, &Arc<ImageView>); 4] {
        [
            ("illumination-map", &self.slice_images.illumination_map),
            ("caustics-map", &self.caustics_map.map),
            ("position-map", &self.combine_slices.position),
            ("combined-map", &self.combine_slices.map),
        ]
    }
}
