//! A receiver of caustics on the device, and what every method shares about it: its box under one light, the map's
//! camera, a plane's constants.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::illumination::IlluminationVolumes;
use super::parameters::Parameters;
use super::planes::{Axes, Cell, ReceiverBox};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, ShaderLibrary};
use crate::host_block;
use crate::scene::{Light, Mesh};

host_block! {
    /// A vertex of a receiver, world space.
    pub struct Vertex {
        pub position: [f32; 3],
        pub normal: [f32; 3],
    }
}

host_block! {
    /// A box as `box.glsl` reads it.
    pub struct BoxBlock {
        pub u: [f32; 4],
        pub v: [f32; 4],
        pub w: [f32; 4],
        pub extent: [f32; 4],
    }
}

host_block! {
    /// Constants of the passes that draw the receiver into a map.
    pub struct MapConstants {
        pub bounds: BoxBlock,
        pub albedo: [f32; 4],
        pub top: f32,
        pub bottom: f32,
        _pad: [f32; 2],
    }
}

host_block! {
    /// Constants of one plane's draw.
    pub struct PlaneConstants {
        pub center: [f32; 2],
        pub to_clip: [f32; 2],
        pub height: f32,
        pub lower: f32,
        pub upper: f32,
        pub absorption_per_m: f32,
        pub texel_area_m2: f32,
    }
}

/// What a caller puts into the water: a mesh in world space and its colour.
#[derive(Debug, Clone)]
pub struct ReceiverInput {
    pub mesh: Mesh,
    /// Diffuse reflectance, linear RGB, 0 to 1.
    pub albedo: Vec3,
}

/// A receiver's mesh on the device.
pub struct Receiver {
    pub vertices: Arc<Buffer>,
    pub indices: Arc<Buffer>,
    pub index_count: u32,
    pub albedo: Vec3,
    /// World positions, for the boxes that are aligned anew in every frame.
    pub positions: Vec<Vec3>,
}

impl Receiver {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shaders: &ShaderLibrary, label: &str, input: &ReceiverInput) -> Result<Self, Error> {
        let device = shaders.device();
        let mesh = &input.mesh;
        let vertices: Vec<Vertex> = mesh
            .positions
            .iter()
            .zip(&mesh.normals)
            .map(|(p, n)| Vertex { position: p.to_array(), normal: n.to_array() })
            .collect();
        let name = |what: &str| format!("{label}/{what}");
        Ok(Receiver {
            vertices: upload(
                device,
                &name("receiver"),
                vk::BufferUsageFlags::VERTEX_BUFFER,
                bytemuck::cast_slice(&vertices),
            )?,
            indices: upload(
                device,
                &name("receiver-indices"),
                vk::BufferUsageFlags::INDEX_BUFFER,
                bytemuck::cast_slice(&mesh.indices),
            )?,
            index_count: mesh.indices.len() as u32,
            albedo: input.albedo,
            positions: mesh.positions.clone(),
        })
    }
}

/// A receiver under one light: its box, and its planes once they are sliced.
pub struct LitReceiver {
    pub receiver: Arc<Receiver>,
    pub aligned: ReceiverBox,
    /// Nearest to the light first.
    pub cells: Vec<Cell>,
    map_size: u32,
    absorption_per_m: f32,
    light_intensity: Vec3,
}

impl LitReceiver {
    pub fn new(receiver: &Arc<Receiver>, axes: Axes, light: &Light, parameters: &Parameters) -> Self {
        let light_intensity = match *light {
            Light::Parallel { intensity, .. } | Light::Point { intensity, .. } => intensity,
        };
        LitReceiver {
            receiver: receiver.clone(),
            aligned: ReceiverBox::around(axes, &receiver.positions),
            cells: Vec::with_capacity(parameters.planes as usize),
            map_size: parameters.map_size,
            absorption_per_m: parameters.absorption_per_m,
            light_intensity,
        }
    }

    /// Aligns the box and slices it (section 4.2.1).
    pub fn slice(&mut self, planes: u32) {
        self.aligned = ReceiverBox::around(self.aligned.axes, &self.receiver.positions);
        super::planes::slice(self.aligned.extent.y, planes, &mut self.cells);
    }

    /// The whole box, or the part between two heights, as the map's camera sees it.
    pub fn map_constants(&self, between: Option<&Cell>) -> MapConstants {
        let half = (self.aligned.extent.y / 2.0) as f32;
        MapConstants {
            bounds: self.box_block(),
            albedo: self.receiver.albedo.extend(0.0).to_array(),
            top: between.map_or(half, |cell| cell.upper),
            bottom: between.map_or(-half, |cell| cell.lower),
            _pad: [0.0; 2],
        }
    }

    pub fn plane_constants(&self, cell: &Cell, volumes: &IlluminationVolumes) -> PlaneConstants {
        let extent = self.aligned.extent;
        let offset = self.aligned.center - volumes.reference;
        let texels = f64::from(self.map_size) * f64::from(self.map_size);
        PlaneConstants {
            center: [offset.x as f32, offset.z as f32],
            to_clip: [(2.0 / extent.x) as f32, (2.0 / extent.z) as f32],
            height: (offset.y + f64::from(cell.plane)) as f32,
            lower: cell.lower,
            upper: cell.upper,
            absorption_per_m: self.absorption_per_m,
            texel_area_m2: (extent.x * extent.z / texels) as f32,
        }
    }

    pub fn box_block(&self) -> BoxBlock {
        let ReceiverBox { axes, center, extent } = self.aligned;
        let axis = |axis: glam::DVec3, at: f64| axis.as_vec3().extend(at as f32).to_array();
        BoxBlock {
            u: axis(axes.u, center.x),
            v: axis(axes.v, center.y),
            w: axis(axes.w, center.z),
            extent: extent.as_vec3().extend(self.map_size as f32).to_array(),
        }
    }

    pub fn light_intensity(&self) -> Vec3 {
        self.light_intensity
    }
}
