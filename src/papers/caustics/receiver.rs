//! A receiver of caustics on the device, its box under one light, and the camera of its maps.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::bounding_box::{Axes, ReceiverBox};
use super::parameters::Parameters;
use super::planes::{self, Cell};
use super::resources::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::upload_each;
use crate::gpu::{Buffer, Error, Frame, Pass};
use crate::host_block;
use crate::scene::{Bounds, Mesh};

host_block! {
    /// A vertex of a receiver, world space.
    pub struct Vertex {
        position: [f32; 3],
        normal: [f32; 3],
    }
}

host_block! {
    /// A box as `box.glsl` reads it.
    pub struct BoxBlock {
        u: [f32; 3],
        center_u: f32,
        v: [f32; 3],
        center_v: f32,
        w: [f32; 3],
        center_w: f32,
        extent: [f32; 3],
        texels: f32,
    }
}

host_block! {
    /// Constants of the passes that draw the receiver into a map.
    struct MapConstants {
        bounds: BoxBlock,
        albedo: [f32; 3],
        top: f32,
        bottom: f32,
    }
}

/// An object that a caller puts into the water: a mesh in world space and its colour.
#[derive(Debug, Clone)]
pub struct ReceiverInput {
    /// World space, metres.
    pub mesh: Mesh,
    /// Diffuse reflectance, linear RGB, 0 to 1.
    pub albedo: Vec3,
}

/// A receiver's mesh on the device.
pub struct Receiver {
    /// A [`Vertex`] each.
    pub vertices: Arc<Buffer>,
    /// Three a triangle.
    pub indices: Arc<Buffer>,
    /// Length of the indices.
    pub index_count: u32,
    /// Diffuse reflectance, linear RGB, 0 to 1.
    pub albedo: Vec3,
    /// World positions, for the boxes that are aligned anew in every frame.
    pub positions: Vec<Vec3>,
}

impl Receiver {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, input: &ReceiverInput) -> Result<Self, Error> {
        let mesh = &input.mesh;
        let vertex =
            |at: usize| Vertex { position: mesh.positions[at].to_array(), normal: mesh.normals[at].to_array() };
        let (name, usage) = (context.name("receiver"), vk::BufferUsageFlags::VERTEX_BUFFER);
        let indices = bytemuck::cast_slice(&mesh.indices);
        Ok(Receiver {
            vertices: upload_each(context.device(), &name, usage, mesh.positions.len(), vertex)?,
            indices: context.upload("receiver-indices", vk::BufferUsageFlags::INDEX_BUFFER, indices)?,
            index_count: mesh.indices.len() as u32,
            albedo: input.albedo,
            positions: mesh.positions.clone(),
        })
    }
}

/// A receiver under one light: its box, and its planes once they are sliced.
pub struct LitReceiver {
    /// The mesh, which all lights share.
    pub receiver: Arc<Receiver>,
    /// Index of the light.
    pub light: usize,
    /// Index of the receiver.
    pub index: usize,
    /// Its box in the light's axes.
    pub aligned: ReceiverBox,
    /// Planes of the level map and of its culling.
    pub planes: u32,
    /// Nearest to the light first.
    pub cells: Vec<Cell>,
    /// Texels a side of its maps.
    pub map_size: u32,
    /// K of eq. 4-17.
    pub absorption_per_m: f32,
}

impl LitReceiver {
    pub fn new(receiver: &Arc<Receiver>, index: usize, light: usize, axes: Axes, parameters: &Parameters) -> Self {
        LitReceiver {
            light,
            index,
            aligned: ReceiverBox::around(axes, &receiver.positions),
            receiver: receiver.clone(),
            planes: parameters.planes_at(Bounds::of_points(receiver.positions.iter().copied()).center()),
            cells: Vec::with_capacity(parameters.planes as usize),
            map_size: parameters.map_size,
            absorption_per_m: parameters.absorption_per_m,
        }
    }

    /// Aligns the box (section 4.2.1).
    pub fn align(&mut self) {
        self.aligned = ReceiverBox::around(self.aligned.axes, &self.receiver.positions);
    }

    /// Aligns the box and slices it (section 4.2.1).
    pub fn slice(&mut self, planes: u32) {
        self.align();
        planes::slice(self.aligned.extent.y, planes, &mut self.cells);
    }

    /// A pass that draws the receiver under the orthographic camera of its maps (sections 4.2.2 and 5.2.1).
    pub fn map_pass(&self, name: &'static str, section: &'static str, fragment: &str) -> PassBuilder {
        Pass::graphics(name, section, "caustics/receiver-map.vert", fragment)
            .vertices::<Vertex>(&self.receiver.vertices)
            .indices(&self.receiver.indices)
            .constants::<MapConstants>()
    }

    /// Draws the whole receiver, or what lies in one cell, by a [`LitReceiver::map_pass`].
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn draw_into_map(&self, frame: &mut Frame<'_>, pass: &Pass, within: Option<&Cell>) -> Result<(), Error> {
        let half = (self.aligned.extent.y / 2.0) as f32;
        let constants = MapConstants {
            bounds: self.box_block(),
            albedo: self.receiver.albedo.to_array(),
            top: within.map_or(half, |cell| cell.upper),
            bottom: within.map_or(-half, |cell| cell.lower),
        };
        frame.graphics(pass, |draw| draw.constants(&constants).indices(self.receiver.index_count))
    }

    /// Half the height of a uniform plane's cell, metres.
    pub fn half_cell_m(&self) -> f32 {
        (self.aligned.extent.y / (2.0 * self.cells.len() as f64)) as f32
    }

    pub fn box_block(&self) -> BoxBlock {
        box_block(&self.aligned, self.map_size)
    }
}

/// A box with maps of so many texels a side.
pub fn box_block(bounds: &ReceiverBox, texels: u32) -> BoxBlock {
    let ReceiverBox { axes, center, extent } = bounds;
    BoxBlock {
        u: axes.u.as_vec3().to_array(),
        center_u: center.x as f32,
        v: axes.v.as_vec3().to_array(),
        center_v: center.y as f32,
        w: axes.w.as_vec3().to_array(),
        center_w: center.z as f32,
        extent: extent.as_vec3().to_array(),
        texels: texels as f32,
    }
}
