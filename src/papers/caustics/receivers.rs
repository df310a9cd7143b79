//! Pass `receivers` (section 3.2): the receivers under the viewer's camera with ambient light, and the surface that is
//! seen in each pixel, for the stencil method.

use std::sync::Arc;

use ash::vk;

use super::bounding_box::Axes;
use super::receiver::{Receiver, Vertex};
use super::resources::{BLACK, COLOR_MAP, Context, DEEP_WATER, FAR, LIGHT};
use super::underwater::Underwater;
use crate::gpu::{Blend, DepthTest, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct ReceiverConstants {
        albedo: [f32; 3],
        _pad: f32,
        ambient: [f32; 3],
    }
}

/// The pass.
pub struct Receivers {
    passes: Vec<(Pass, Arc<Receiver>)>,
    ambient: [f32; 3],
    /// Position of the surface that is seen, metres.
    pub position: Arc<ImageView>,
    /// Its unit normal.
    pub normal: Arc<ImageView>,
    /// Its diffuse reflectance, linear RGB.
    pub albedo: Arc<ImageView>,
}

impl Receivers {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, receivers: &[Arc<Receiver>], underwater: &Underwater) -> Result<Self, Error> {
        let image = |name: &str, format| context.image(name, format, COLOR_MAP)?.view();
        let position = image("surface-position", vk::Format::R32G32B32A32_SFLOAT)?;
        let normal = image("surface-normal", LIGHT)?;
        let albedo = image("surface-albedo", LIGHT)?;
        let pass = |(index, receiver): (usize, &Arc<Receiver>)| {
            let load = |clear| if index == 0 { clear } else { Load::Keep };
            let (vertex, fragment) = ("caustics/stencil-receivers.vert", "caustics/stencil-receivers.frag");
            let pass = Pass::graphics("receivers", "3.2", vertex, fragment)
                .vertices::<Vertex>(&receiver.vertices)
                .indices(&receiver.indices)
                .constants::<ReceiverConstants>()
                .with("camera", &underwater.camera)
                .color(&underwater.color, load(DEEP_WATER), Blend::Replace)
                .color(&position, load(BLACK), Blend::Replace)
                .color(&normal, load(BLACK), Blend::Replace)
                .color(&albedo, load(BLACK), Blend::Replace)
                .depth(&underwater.depth, load(FAR), DepthTest::LessWrite)
                .build(context.shaders)?;
            Ok((pass, receiver.clone()))
        };
        let passes = receivers.iter().enumerate().map(pass).collect::<Result<_, Error>>()?;
        Ok(Receivers { passes, ambient: context.parameters.ambient.to_array(), position, normal, albedo })
    }

    /// The lowest height of a receiver along V, metres.
    pub fn lowest_along(&self, axes: &Axes) -> f64 {
        let points = self.passes.iter().flat_map(|(_, receiver)| &receiver.positions);
        points.map(|p| axes.along(p.as_dvec3()).y).fold(f64::INFINITY, f64::min)
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|(pass, receiver)| {
            let constants = ReceiverConstants { albedo: receiver.albedo.to_array(), _pad: 0.0, ambient: self.ambient };
            frame.graphics(pass, |draw| draw.constants(&constants).indices(receiver.index_count))
        })
    }
}
