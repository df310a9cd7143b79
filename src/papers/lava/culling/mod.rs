//! Culling of splats (chapter 9): those that cannot be seen are found on the device, the others drawn in their order, in one indirect draw.
//! Ours.
//!
//! ```text
//! cull ─► cull-sum ─► cull-compact ─► visibility ─► blending
//! ```

mod cull;
mod cull_compact;
mod cull_sum;

use std::sync::Arc;

use ash::vk;

use self::cull::cull;
use self::cull_compact::cull_compact;
use self::cull_sum::cull_sum;
use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::Context;
use crate::choice;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Frame, Pass};
use crate::host_block;
use crate::shader_build::HostBlock;

/// Splats of a cluster, which follow each other along x.
const CLUSTER: u32 = 64;
/// Bytes of a cluster.
const CLUSTER_BYTES: u64 = 16;
/// Words of an indirect draw's parameters, and of the count of clusters behind them.
const ARGUMENTS: usize = 6;
/// Corners of a splat that is drawn without a geometry stage.
const CORNERS: u32 = 4;

choice! {
    /// Splats that are left out.
    pub enum SplatCulling {
        /// None.
        Off = ("off", "The thesis's: every splat is drawn"),
        /// Beyond the picture's sides.
        Frustum = ("frustum", "Not those beyond the picture's sides, by clusters and one by one"),
        /// Those, and the ones that are turned away and hidden.
        Facing = ("facing", "Nor those that are turned away and hidden by more than epsilon"),
    }
}

host_block! {
    struct CullConstants {
        eye_m: [f32; 3],
        splats: u32,
        clusters: u32,
    }
}

/// Counts of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kept {
    /// Splats that were drawn.
    pub splats: u32,
    /// Clusters that were not left out as a whole.
    pub clusters: u32,
    /// Clusters in all.
    pub of_clusters: u32,
}

/// The passes.
pub struct Culling {
    cull: Pass,
    cull_sum: Pass,
    cull_compact: Pass,
    constants: CullConstants,
    /// Numbers of the splats that stay, or their places as quads.
    drawn: Arc<Buffer>,
    /// Indices of a quad's corners; `None` of points.
    corners: Option<Arc<Buffer>>,
    arguments: Arc<Buffer>,
}

impl Culling {
    /// Over the splats at `places`; `None` where every splat is drawn. `instanced` ones are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        scene: &Scene,
        places: &Arc<Buffer>,
        instanced: bool,
    ) -> Result<Option<Self>, Error> {
        let is_facing = match context.parameters.culling {
            SplatCulling::Off => return Ok(None),
            SplatCulling::Frustum => false,
            SplatCulling::Facing => true,
        };
        let [columns, rows] = context.parameters.splats;
        let splats = columns * rows;
        let clusters = splats.div_ceil(CLUSTER);
        let buffer = |name: &str, bytes: u64, usage| {
            let usage = usage | vk::BufferUsageFlags::STORAGE_BUFFER;
            Buffer::new(context.device(), BufferDesc::new(context.name(name), bytes).usage(usage))
                .map_err(|error| error.set_by("splats"))
        };
        let kept = buffer("kept-splats", CLUSTER_BYTES * u64::from(clusters), vk::BufferUsageFlags::empty())?;
        let arguments = buffer("splat-arguments", 4 * ARGUMENTS as u64, vk::BufferUsageFlags::INDIRECT_BUFFER)?;
        let (drawn, corners) = if instanced {
            let indices: Vec<u32> = (0..CORNERS).collect();
            let usage = vk::BufferUsageFlags::INDEX_BUFFER;
            let corners = context.upload("splat-corners", usage, bytemuck::cast_slice(&indices))?;
            (buffer("drawn-splats", places.size_bytes(), vk::BufferUsageFlags::VERTEX_BUFFER)?, Some(corners))
        } else {
            (buffer("drawn-splats", 4 * u64::from(splats), vk::BufferUsageFlags::INDEX_BUFFER)?, None)
        };
        Ok(Some(Culling {
            cull: cull(context, scene, places, &kept, is_facing)?,
            cull_sum: cull_sum(context, &kept, &arguments, instanced)?,
            cull_compact: cull_compact(context, &kept, &drawn, instanced.then_some(places))?,
            constants: CullConstants { eye_m: context.parameters.camera.eye.to_array(), splats, clusters },
            drawn,
            corners,
            arguments,
        }))
    }

    /// A pass of the splats that stay, in place of all of those at `places`; `T` is what a splat's stages read.
    pub fn splats<T: HostBlock>(&self, pass: PassBuilder, places: &Arc<Buffer>) -> PassBuilder {
        let pass = match &self.corners {
            None => pass.vertices::<T>(places).indices(&self.drawn),
            Some(corners) => pass.instances::<T>(&self.drawn).indices(corners),
        };
        pass.indirect(&self.arguments)
    }

    /// Sets the eye to that of the parameters' camera.
    pub fn set_eye(&mut self, parameters: &Parameters) {
        self.constants.eye_m = parameters.camera.eye.to_array();
    }

    /// Finds the splats that stay.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let CullConstants { clusters, .. } = self.constants;
        for (pass, elements) in [(&self.cull, clusters), (&self.cull_sum, 1), (&self.cull_compact, clusters)] {
            frame.compute(pass, |dispatch| dispatch.constants(&self.constants).elements(elements))?;
        }
        Ok(())
    }

    /// Reads back what the last frame drew.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn kept(&self, device: &Arc<Device>) -> Result<Kept, Error> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(device, &self.arguments)?);
        let word = |at: usize| words.get(at).copied().unwrap_or(0);
        let splats = if self.corners.is_some() { word(1) } else { word(0) };
        Ok(Kept { splats, clusters: word(ARGUMENTS - 1), of_clusters: self.constants.clusters })
    }
}

/// Device memory beside the splats' own places.
pub fn bytes(parameters: &Parameters) -> f64 {
    let splats = parameters.splats.iter().map(|&n| f64::from(n)).product::<f64>();
    match parameters.culling {
        SplatCulling::Off => 0.0,
        SplatCulling::Frustum | SplatCulling::Facing => {
            splats * (size_of::<[f32; 2]>() as f64 + CLUSTER_BYTES as f64 / f64::from(CLUSTER))
        }
    }
}
