//! Pass `cast` (section 4.6): the receivers under the viewer's camera, each lit by its combined map.

use std::sync::Arc;

use super::hidden_surfaces::HiddenSurfaces;
use super::receiver::{BoxBlock, LitReceiver, Vertex};
use super::resources::{Context, DEEP_WATER, FAR};
use super::underwater::Underwater;
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct CastConstants {
        bounds: BoxBlock,
        albedo: [f32; 3],
        height_slack_m: f32,
        ambient: [f32; 3],
    }
}

/// The pass of one receiver under one light.
pub struct Cast {
    pass: Pass,
    ambient: [f32; 3],
}

impl Cast {
    /// The first light lays down depth and ambient light, the others are added (eq. 4-20). Surfaces below the first are lit by
    /// their own maps.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        lit: &LitReceiver,
        combined_map: &Arc<ImageView>,
        position_map: &Arc<ImageView>,
        hidden: Option<&HiddenSurfaces>,
        underwater: &Underwater,
    ) -> Result<Self, Error> {
        let load = |clear| if lit.light == 0 && lit.index == 0 { clear } else { Load::Keep };
        let (blend, test, ambient) = if lit.light == 0 {
            (Blend::Replace, DepthTest::LessWrite, context.parameters.ambient.to_array())
        } else {
            (Blend::Add, DepthTest::EqualReadOnly, [0.0; 3])
        };
        let fragment = if hidden.is_some() { "caustics/cast-several.frag" } else { "caustics/cast-one.frag" };
        let mut pass = Pass::graphics("cast", "4.6", "caustics/cast.vert", fragment)
            .vertices::<Vertex>(&lit.receiver.vertices)
            .indices(&lit.receiver.indices)
            .constants::<CastConstants>()
            .with("camera", &underwater.camera)
            .with("combined_map", combined_map)
            .with("position_map", position_map)
            .with("nearest", context.nearest)
            .color(&underwater.color, load(DEEP_WATER), blend)
            .depth(&underwater.depth, load(FAR), test);
        if let Some(hidden) = hidden {
            pass = pass.with("hidden_positions", &hidden.positions);
            pass = pass.with("hidden_light", &hidden.combined);
        }
        Ok(Cast { pass: pass.build(context.shaders)?, ambient })
    }

    /// Draws the receiver; heights of the position map lie within `height_slack_m` of the surface.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, lit: &LitReceiver, height_slack_m: f32) -> Result<(), Error> {
        let constants = CastConstants {
            bounds: lit.box_block(),
            albedo: lit.receiver.albedo.to_array(),
            height_slack_m,
            ambient: self.ambient,
        };
        frame.graphics(&self.pass, |draw| draw.constants(&constants).indices(lit.receiver.index_count))
    }
}
