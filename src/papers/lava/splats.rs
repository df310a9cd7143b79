//! The splats of stage three (chapter 7): spread out evenly over the surface, drawn by `visibility` and `blending`.

use std::sync::Arc;

use ash::vk;

use super::culling::{Culling, Kept};
use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::Context;
use crate::choice;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, Device, Draw, Error, Frame, Pass, Topology};
use crate::host_block;

choice! {
    /// Outline of a splat.
    pub enum SplatShape {
        /// Section 7.1.
        Disc = ("disc", "The thesis's: a disc on the surface, so that steep slopes gape"),
        /// As long down a slope as it is steep.
        Fitted = ("fitted", "Stretched down a slope until it covers a disc of the map, so that nothing gapes"),
    }
}

host_block! {
    /// Position of a splat along x and z, metres.
    struct Place {
        place: [f32; 2],
    }
}

/// The splats on the device.
pub struct Splats {
    vertices: Arc<Buffer>,
    count: u32,
    instanced: bool,
    /// `None` where all of them are drawn.
    culling: Option<Culling>,
}

impl Splats {
    /// `instanced` ones are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, scene: &Scene, instanced: bool) -> Result<Self, Error> {
        let places = places(context.parameters);
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER | vk::BufferUsageFlags::STORAGE_BUFFER;
        let vertices = context.upload("splats", usage, bytemuck::cast_slice(&places))?;
        let culling = Culling::new(context, scene, &vertices, instanced)?;
        Ok(Splats { vertices, count: places.len() as u32, instanced, culling })
    }

    /// A pass that draws the splats of a scene.
    pub fn pass(&self, scene: &Scene, name: &'static str, section: &'static str, fragment: &str) -> PassBuilder {
        let pass = if self.instanced {
            Pass::graphics(name, section, "lava/splat-quad.vert", fragment).topology(Topology::TriangleStrip)
        } else {
            Pass::graphics(name, section, "lava/splat.vert", fragment)
                .geometry("lava/splat.geom")
                .topology(Topology::Points)
        };
        let pass = match &self.culling {
            Some(culling) => culling.splats::<Place>(pass, &self.vertices),
            None if self.instanced => pass.instances::<Place>(&self.vertices),
            None => pass.vertices::<Place>(&self.vertices),
        };
        pass.with("scene", &scene.block).with("normal_height", &scene.normal_height)
    }

    /// Finds the splats to draw, where some are left out.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn cull(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.culling.as_ref().map_or(Ok(()), |culling| culling.record(frame))
    }

    /// Sets the eye to that of the parameters' camera.
    pub fn set_eye(&mut self, parameters: &Parameters) {
        if let Some(culling) = &mut self.culling {
            culling.set_eye(parameters);
        }
    }

    /// Reads back what the last frame drew; `None` where that is every splat.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn kept(&self, device: &Arc<Device>) -> Result<Option<Kept>, Error> {
        self.culling.as_ref().map(|culling| culling.kept(device)).transpose()
    }

    /// Draws the splats by a [`Splats::pass`].
    pub fn draw(&self, draw: &mut Draw<'_>) {
        if self.culling.is_some() {
            draw.indices_indirect()
        } else if self.instanced {
            draw.instances(4, self.count)
        } else {
            draw.vertices(self.count)
        };
    }
}

/// The splats, spread out evenly (chapter 7).
fn places(parameters: &Parameters) -> Vec<Place> {
    let [columns, rows] = parameters.splats;
    let at = |i: u32, count: u32, side_m: f32| (i as f32 + 0.5) / count as f32 * side_m;
    let row = |j: u32| {
        let z = at(j, rows, parameters.space_m.z);
        (0..columns).map(move |i| Place { place: [at(i, columns, parameters.space_m.x), z] })
    };
    (0..rows).flat_map(row).collect()
}
