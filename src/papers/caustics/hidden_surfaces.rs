//! Pass `hidden-surfaces` (section 6.3): the surfaces that face the light below what its box shows, one below the other, each
//! with maps of its own.

use std::sync::Arc;

use ash::vk;

use super::ceilings::Ceilings;
use super::receiver::LitReceiver;
use super::resources::{BACKGROUND, BLACK, CAUSTICS, Context, DEPTH, FAR, LIGHT, POSITION};
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageView, Pass};

/// The passes of one receiver under one light.
pub struct HiddenSurfaces {
    /// The pass of each surface, and that of the room above it.
    passes: Vec<(Pass, Ceilings)>,
    /// Heights of each, metres of box space, layer by layer.
    pub positions: Arc<ImageView>,
    /// Heights of what ends the room above each, metres of box space.
    pub ceilings: Arc<ImageView>,
    /// I_d of eq. 4-19 of each.
    pub diffuse: Arc<ImageView>,
    /// I_c of each.
    pub caustics: Arc<ImageView>,
    /// I_c x I_d of each.
    pub combined: Arc<ImageView>,
}

impl HiddenSurfaces {
    /// Those below the surface of `position_map`; none where the configuration has no further layers.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, lit: &LitReceiver, position_map: &Arc<ImageView>) -> Result<Option<Self>, Error> {
        let count = context.parameters.layers - 1;
        if count == 0 {
            return Ok(None);
        }
        let maps = |name: &str, format: vk::Format| {
            let image = Image::new(context.device(), context.map_desc(name, format).layers(count));
            image.map_err(|error| error.set_by("map-size` or `layers"))?.view()
        };
        let positions = maps("hidden-position-map", POSITION)?;
        let ceilings = maps("ceilings", POSITION)?;
        let diffuse = maps("hidden-diffuse-map", LIGHT)?;
        let depth = context.map("hidden-depth", DEPTH)?;
        let mut above = position_map.clone();
        let mut passes = Vec::new();
        for layer in 0..count {
            let below = positions.image().layer(layer)?;
            let surface = lit
                .map_pass("hidden-surfaces", "6.3", "caustics/hidden-surfaces.frag")
                .with("above", &above)
                .with("nearest", context.nearest)
                .color(&below, BACKGROUND, Blend::Replace)
                .color(&diffuse.image().layer(layer)?, BLACK, Blend::Replace)
                .depth(&depth, FAR, DepthTest::LessWrite)
                .build(context.shaders)?;
            let ceiling = Ceilings::new(context, lit, [&above, &below], &ceilings.image().layer(layer)?, &depth)?;
            passes.push((surface, ceiling));
            above = below;
        }
        Ok(Some(HiddenSurfaces {
            passes,
            positions,
            ceilings,
            diffuse,
            caustics: maps("hidden-caustics-map", CAUSTICS)?,
            combined: maps("hidden-combined-map", LIGHT)?,
        }))
    }

    /// Surfaces below the first.
    pub fn count(&self) -> u32 {
        self.positions.image().desc().layers
    }

    /// The maps that can be dumped.
    pub fn targets(&self) -> [(&'static str, &Arc<ImageView>); 4] {
        [
            ("hidden-position-map", &self.positions),
            ("hidden-diffuse-map", &self.diffuse),
            ("hidden-caustics-map", &self.caustics),
            ("hidden-combined-map", &self.combined),
        ]
    }

    /// Draws the receiver into the maps of each surface.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        self.passes.iter().try_for_each(|(surface, ceilings)| {
            lit.draw_into_map(frame, surface, None)?;
            ceilings.record(frame, lit)
        })
    }
}
