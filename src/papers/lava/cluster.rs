//! Pass `cluster` (section 5.2): on the host, the particles that contribute to each four grid planes.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::parameters::Parameters;
use super::targets::Context;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Location, PassInfo};
use crate::host_block;

host_block! {
    /// A point of a vertex buffer: a particle of a cluster, or an accepted grid point. Metres.
    pub struct Point {
        /// In the simulation space.
        pub position: [f32; 3],
    }
}

/// The pass, with the vertex buffers that it fills.
pub struct Cluster {
    info: Arc<PassInfo>,
    /// The particles of the last frame's clusters.
    pub clusters: Clusters,
    /// One vertex buffer a cluster, each with the capacity for every particle; lowest cluster first.
    pub vertices: Vec<Arc<Buffer>>,
}

impl Cluster {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, positions: &Buffer, particle_count: usize) -> Result<Self, Error> {
        let vertices = (0..context.parameters.clusters())
            .map(|k| host_vertices(context, &format!("cluster-{k}"), particle_count as u64))
            .collect::<Result<Vec<_>, _>>()?;
        let names: Vec<&str> = vertices.iter().map(|v| v.name()).collect();
        let info = PassInfo::host("cluster", "5.2", &[positions.name()], &names);
        Ok(Cluster { info, clusters: Clusters::new(context.parameters), vertices })
    }

    /// Sorts the positions of the first `particles`, which were read back, into the vertex buffers.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>, positions: &Buffer, particles: u32) -> Result<(), Error> {
        let Cluster { info, clusters, vertices } = self;
        frame.host(info, || {
            positions.read(positions.size_bytes(), |bytes| {
                let texels: &[[f32; 4]] = bytemuck::cast_slice(bytes);
                // The last row of the texture may hold more texels than there are particles.
                clusters.classify(texels.get(..particles as usize).unwrap_or(texels));
            })?;
            for (buffer, particles) in vertices.iter().zip(&clusters.particles) {
                buffer.write(0, bytemuck::cast_slice(particles))?;
            }
            Ok(())
        })
    }
}

/// The heights that a cluster takes particles from: y_i1 - h to y_i4 + h, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Band {
    low_m: f32,
    high_m: f32,
}

/// The particles of every cluster, lowest cluster first.
pub struct Clusters {
    space_m: Vec3,
    bands: Vec<Band>,
    /// Lowest cluster first.
    pub particles: Vec<Vec<Point>>,
}

impl Clusters {
    /// Empty clusters over the space of `parameters`.
    pub fn new(parameters: &Parameters) -> Self {
        let planes = parameters.density[1];
        let band = |k: u32| Band {
            low_m: parameters.plane_height_m(4 * k) - parameters.radius_m,
            high_m: parameters.plane_height_m((4 * k + 3).min(planes - 1)) + parameters.radius_m,
        };
        let bands: Vec<Band> = (0..parameters.clusters()).map(band).collect();
        Clusters { space_m: parameters.space_m, particles: vec![Vec::new(); bands.len()], bands }
    }

    /// Sorts `positions`, x, y, z and anything, into the clusters. A particle may have left the space by one step; it
    /// counts at the nearest point inside.
    pub fn classify(&mut self, positions: &[[f32; 4]]) {
        self.particles.iter_mut().for_each(Vec::clear);
        for &[x, y, z, _] in positions {
            let place = Vec3::new(x, y, z).clamp(Vec3::ZERO, self.space_m);
            // Bands rise with their index: those that hold y are neighbours.
            let first = self.bands.partition_point(|band| band.high_m < place.y);
            for (band, cluster) in self.bands.iter().zip(&mut self.particles).skip(first) {
                if place.y < band.low_m {
                    break;
                }
                cluster.push(Point { position: place.to_array() });
            }
        }
    }
}

/// A vertex buffer that the host fills, with the capacity for `count` points. It begins as zeros, so that all of it may
/// be bound however few are drawn.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn host_vertices(context: Context<'_>, name: &str, count: u64) -> Result<Arc<Buffer>, Error> {
    let desc = BufferDesc::new(context.name(name), count * size_of::<Point>() as u64)
        .usage(vk::BufferUsageFlags::VERTEX_BUFFER)
        .location(Location::Upload);
    let buffer = Buffer::new(context.device(), desc)?;
    buffer.write(0, &vec![0; buffer.size_bytes() as usize])?;
    Ok(buffer)
}
