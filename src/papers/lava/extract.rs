//! Pass `extract` (section 6.2): on the host, the grid points whose density reaches rho.

use std::sync::Arc;

use super::cluster::{Point, host_vertices};
use super::density::GridPlanes;
use super::targets::Context;
use crate::gpu::{Buffer, Error, Frame, PassInfo};

/// The pass, with the vertex buffer that it fills.
pub struct Extract {
    info: Arc<PassInfo>,
    /// The accepted grid points; capacity for all.
    pub vertices: Arc<Buffer>,
    grid: Grid,
    /// The grid points that the last frame accepted, metres.
    pub accepted: Vec<Point>,
    /// Lowest and highest density at a grid point in the last frame.
    pub density_range: [f32; 2],
}

/// Grid points of a plane, and the density that they must reach.
struct Grid {
    columns: usize,
    /// Distance of neighbours along x and z, metres.
    spacing_m: [f32; 2],
    rho: f32,
}

impl Extract {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, densities: &Buffer) -> Result<Self, Error> {
        let parameters = context.parameters;
        let [x, _, z] = parameters.density;
        let points: u64 = parameters.density.iter().map(|&n| u64::from(n)).product();
        let vertices = host_vertices(context, "isosurface", points)?;
        let space = parameters.space_m;
        Ok(Extract {
            info: PassInfo::host("extract", "6.2", &[densities.name()], &[vertices.name()]),
            vertices,
            grid: Grid {
                columns: x as usize,
                spacing_m: [space.x / x as f32, space.z / z as f32],
                rho: parameters.rho(),
            },
            accepted: Vec::with_capacity(points as usize),
            density_range: [0.0; 2],
        })
    }

    /// Forgets the points of the last frame.
    pub fn clear(&mut self) {
        self.accepted.clear();
        self.density_range = [f32::INFINITY, f32::NEG_INFINITY];
    }

    /// Adds the accepted points of one cluster's planes.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>, densities: &Buffer, planes: &GridPlanes) -> Result<(), Error> {
        let Extract { info, vertices, grid, accepted, density_range } = self;
        frame.host(info, || {
            let before = accepted.len();
            densities.read(densities.size_bytes(), |bytes| {
                grid.extract(bytemuck::cast_slice(bytes), planes, accepted, density_range);
            })?;
            let offset_bytes = (before * size_of::<Point>()) as u64;
            vertices.write(offset_bytes, bytemuck::cast_slice(&accepted[before..]))
        })
    }
}

impl Grid {
    fn extract(
        &self,
        densities: &[[f32; 4]],
        planes: &GridPlanes,
        accepted: &mut Vec<Point>,
        [lowest, highest]: &mut [f32; 2],
    ) {
        let [dx, dz] = self.spacing_m;
        for (row, texels) in densities.chunks_exact(self.columns).enumerate() {
            let z = (row as f32 + 0.5) * dz;
            for (column, texel) in texels.iter().enumerate() {
                let x = (column as f32 + 0.5) * dx;
                for (&density, &y) in texel.iter().zip(&planes.heights_m).take(planes.count) {
                    *lowest = lowest.min(density);
                    *highest = highest.max(density);
                    if density >= self.rho {
                        accepted.push(Point { position: [x, y, z] });
                    }
                }
            }
        }
    }
}
