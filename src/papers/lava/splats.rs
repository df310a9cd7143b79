//! The splats of stage three (chapter 7): spread out evenly over the surface, drawn by `visibility` and `blending`.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::rock::Rock;
use super::targets::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::update;
use crate::gpu::{Buffer, Draw, Error, ImageView, Pass, Topology};
use crate::host_block;

host_block! {
    /// Position of a splat along x and z, metres.
    struct Place {
        place: [f32; 2],
    }
}

host_block! {
    pub(super) struct SceneBlock {
        view_projection: [f32; 16],
        glow: [f32; 3],
        splat_radius_m: f32,
        space_m: [f32; 3],
        epsilon_m: f32,
        columns: [f32; 2],
        rock_texels: [f32; 2],
        depth_per_m: f32,
        rock_tile_m: f32,
        _pad: [f32; 2],
    }
}

/// The splats on the device, and what their passes share.
pub struct Splats {
    vertices: Arc<Buffer>,
    count: u32,
    instanced: bool,
    /// Normals in RGB, heights in metres in alpha.
    pub normal_height: Arc<ImageView>,
    /// The uniform block of the stage.
    pub scene: Arc<Buffer>,
}

impl Splats {
    /// Splats on a texture of normals (RGB) and heights in metres (alpha) over the whole space. `instanced` ones are
    /// quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        normal_height: &Arc<ImageView>,
        rock: &Rock,
        instanced: bool,
    ) -> Result<Self, Error> {
        let places = places(context.parameters);
        let block = scene(context.parameters, normal_height, rock);
        let usage = vk::BufferUsageFlags::VERTEX_BUFFER;
        Ok(Splats {
            vertices: context.upload("splats", usage, bytemuck::cast_slice(&places))?,
            count: places.len() as u32,
            instanced,
            normal_height: normal_height.clone(),
            scene: context.upload("scene", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?,
        })
    }

    /// Writes the uniform block anew.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_scene(&self, parameters: &Parameters, rock: &Rock) -> Result<(), Error> {
        let block = scene(parameters, &self.normal_height, rock);
        update(&self.scene, bytemuck::bytes_of(&block))
    }

    /// A pass that draws the splats.
    pub fn pass(&self, name: &'static str, section: &'static str, fragment: &str) -> PassBuilder {
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
        splats.with("scene", &self.scene).with("normal_height", &self.normal_height)
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

/// The eye-space depth in metres that the depth texture stores as 1.
pub fn depth_range_m(parameters: &Parameters) -> f32 {
    parameters.camera.far_m + parameters.epsilon_m
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

fn scene(parameters: &Parameters, normal_height: &Arc<ImageView>, rock: &Rock) -> SceneBlock {
    let camera = &parameters.camera;
    let view_projection = camera.projection(parameters.aspect()) * camera.view();
    SceneBlock {
        view_projection: view_projection.to_cols_array(),
        glow: parameters.color.to_array(),
        splat_radius_m: parameters.splat_radius_m,
        space_m: parameters.space_m.to_array(),
        epsilon_m: parameters.epsilon_m,
        columns: [normal_height.width() as f32, normal_height.height() as f32],
        rock_texels: [rock.width as f32, rock.height as f32],
        depth_per_m: 1.0 / depth_range_m(parameters),
        rock_tile_m: parameters.rock_tile_m,
        _pad: [0.0; 2],
    }
}
