//! Pass `shadow-map` (no part of the thesis, whose receivers cast no shadow on one another): height and index of the
//! receiver nearest to a light, for all of them.

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::bounding_box::ReceiverBox;
use super::receiver::{BoxBlock, LitReceiver, Receiver, Vertex, box_block};
use super::resources::{Context, DEPTH, FAR};
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct MapConstants {
        bounds: BoxBlock,
        receiver: f32,
    }
}

/// Height in metres of the box's space, and index.
const NEAREST: vk::Format = vk::Format::R32G32_SFLOAT;
/// Nothing there: below everything.
const NOTHING: Load = Load::Clear([-1.0e30, -1.0, 0.0, 0.0]);

/// The pass of one light.
pub struct ShadowMap {
    passes: Vec<(Pass, Arc<Receiver>)>,
    /// The box around all receivers, which the map covers.
    pub bounds: ReceiverBox,
    /// Height in metres of the box's space, and index of the receiver.
    pub map: Arc<ImageView>,
}

impl ShadowMap {
    /// For the receivers under the light with this index.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, lit_receivers: &[LitReceiver], light: usize) -> Result<Option<Self>, Error> {
        let lit: Vec<&LitReceiver> = lit_receivers.iter().filter(|lit| lit.light == light).collect();
        let Some(first) = lit.first() else { return Ok(None) };
        let everything: Vec<_> = lit.iter().flat_map(|lit| lit.receiver.positions.iter().copied()).collect();
        let bounds = ReceiverBox::around(first.aligned.axes, &everything);
        let map = context.map("shadow-map", NEAREST)?;
        let depth = context.map("shadow-depth", DEPTH)?;
        let pass = |lit: &&LitReceiver| {
            let load = |clear| if lit.index == 0 { clear } else { Load::Keep };
            let receiver = &lit.receiver;
            let pass = Pass::graphics("shadow-map", "", "caustics/shadow-map.vert", "caustics/shadow-map.frag")
                .vertices::<Vertex>(&receiver.vertices)
                .indices(&receiver.indices)
                .constants::<MapConstants>()
                .color(&map, load(NOTHING), Blend::Replace)
                .depth(&depth, load(FAR), DepthTest::LessWrite)
                .build(context.shaders)?;
            Ok((pass, receiver.clone()))
        };
        let passes = lit.iter().map(pass).collect::<Result<_, Error>>()?;
        Ok(Some(ShadowMap { passes, bounds, map }))
    }

    /// The box's middle and the map's texels a metre, along x and z; the heights of the box's middle and top. Metres from
    /// `reference`.
    pub fn place(&self, reference: DVec3) -> [[f32; 2]; 3] {
        let ReceiverBox { center, extent, .. } = self.bounds;
        let (offset, texels) = (center - reference, f64::from(self.map.width()));
        [
            [offset.x as f32, offset.z as f32],
            [(texels / extent.x) as f32, (texels / extent.z) as f32],
            [offset.y as f32, (offset.y + extent.y / 2.0) as f32],
        ]
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let bounds = box_block(&self.bounds, self.map.width());
        self.passes.iter().enumerate().try_for_each(|(index, (pass, receiver))| {
            frame.graphics(pass, |draw| {
                draw.constants(&MapConstants { bounds, receiver: index as f32 }).indices(receiver.index_count);
            })
        })
    }
}
