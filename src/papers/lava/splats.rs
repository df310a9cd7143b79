//! The splats of stage three (chapter 7): spread out evenly over the surface, drawn by `visibility` and `blending`.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::scene::Scene;
use super::targets::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Buffer, Draw, Error, Pass, Topology};
use crate::host_block;
use crate::measure::parameter::Choice;

/// Outline of a splat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SplatShape {
    /// Section 7.1.
    Disc,
    /// As long down a slope as it is steep.
    Fitted,
}

impl Choice for SplatShape {
    const ALL: &'static [Self] = &[SplatShape::Disc, SplatShape::Fitted];
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("disc", "The thesis's: a disc on the surface, so that steep slopes gape"),
        ("fitted", "Stretched down a slope until it covers a disc of the map, so that nothing gapes"),
    ];
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
}

impl Splats {
    /// `instanced` ones are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, instanced: bool) -> Result<Self, Error> {
        let places = places(context.parameters);
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        let vertices = context.upload("splats", usage, bytemuck::cast_slice(&places))?;
        Ok(Splats { vertices, count: places.len() as u32, instanced })
    }

    /// A pass that draws the splats of a scene.
    pub fn pass(&self, scene: &Scene, name: &'static str, section: &'static str, fragment: &str) -> PassBuilder {
        let splats = if self.instanced {
            Pass::graphics(name, section, "lava/splat-quad.vert", fragment)
                .instances::<Place>(&self.vertices)
                .topology(Topology::TriangleStrip)
        } else {
            Pass::graphics(name, section, "lava/splat.vert", fragment)
                .geometry("lava/splat.geom")
                .vertices::<Place>(&self.vertices)
                .topology(Topology::Points)
        };
        splats.with("scene", &scene.block).with("normal_height", &scene.normal_height)
    }

    /// Draws the splats by a [`Splats::pass`].
    pub fn draw(&self, draw: &mut Draw<'_>) {
        if self.instanced {
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
