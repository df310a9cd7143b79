//! A polygon mesh on the device, as the papers draw objects beside their own.

use std::sync::Arc;

use ash::vk;

use crate::gpu::transfer::{upload, upload_each};
use crate::gpu::{Buffer, Device, Error};
use crate::host_block;
use crate::scene::Mesh;

host_block! {
    /// A vertex, as the vertex stages read it.
    pub struct MeshVertex {
        /// In the unit of the mesh.
        position: [f32; 3],
        /// Of unit length.
        normal: [f32; 3],
    }
}

/// The buffers of a mesh.
pub struct DeviceMesh {
    /// A [`MeshVertex`] each.
    pub vertices: Arc<Buffer>,
    /// Three a triangle.
    pub indices: Arc<Buffer>,
    /// Number of indices.
    pub index_count: u32,
}

impl DeviceMesh {
    /// Uploads a mesh; `label` and its name go before the names of the buffers.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(device: &Arc<Device>, label: &str, mesh: &Mesh) -> Result<Self, Error> {
        let name = |what: &str| format!("{label}/{}/{what}", mesh.name);
        let vertex =
            |at: usize| MeshVertex { position: mesh.positions[at].to_array(), normal: mesh.normals[at].to_array() };
        let (usage, indices) = (vk::BufferUsageFlags::VERTEX_BUFFER, bytemuck::cast_slice(&mesh.indices));
        Ok(DeviceMesh {
            vertices: upload_each(device, &name("vertices"), usage, mesh.positions.len(), vertex)?,
            indices: upload(device, &name("indices"), vk::BufferUsageFlags::INDEX_BUFFER, indices)?,
            index_count: mesh.indices.len() as u32,
        })
    }
}
