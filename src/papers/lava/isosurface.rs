//! Stage two (chapter 6): the density of every cluster's four grid planes, the accepted grid points, and from them the
//! texture of normals and heights.

use std::f32::consts::PI;
use std::sync::Arc;

use super::animation::host_vertices;
use super::clusters::Point;
use super::floors::{EMPTY, FLOORS};
use super::parameters::Parameters;
use super::targets::{FLOATS, ZERO, desc, target};
use crate::gpu::{
    Blend, Buffer, BufferDesc, Error, Frame, Image, ImageView, Load, Location, Pass, PassInfo, ShaderLibrary, Topology,
};
use crate::host_block;

host_block! {
    struct DensityConstants {
        plane_heights_m: [f32; 4],
        space_m: [f32; 3],
        radius_m: f32,
        columns: [f32; 2],
        point_size_px: f32,
        peak: f32,
    }
}

host_block! {
    struct DepthConstants {
        space_m: [f32; 2],
        columns: [f32; 2],
        radius_m: f32,
    }
}

host_block! {
    struct NormalConstants {
        space_m: [f32; 2],
        columns: [f32; 2],
        border_m: f32,
    }
}

/// No height reaches a plane that is not there.
const NO_PLANE_M: f32 = 1.0e9;

/// The passes and resources of stage two.
pub struct Isosurface {
    clusters: Vec<ClusterPasses>,
    extract: Arc<PassInfo>,
    accumulate_depths: Pass,
    accumulate_floor: Pass,
    normal_height_pass: Pass,
    readback: Arc<Buffer>,
    /// Room for every grid point.
    vertices: Arc<Buffer>,
    grid: Grid,
    accepted: Vec<Point>,
    /// Lowest and highest density of the last frame.
    range: [f32; 2],
    density_constants: DensityConstants,
    depth_constants: DepthConstants,
    normal_constants: NormalConstants,
    instanced: bool,
    density: Arc<ImageView>,
    accumulated: Arc<ImageView>,
    normal_height: Arc<ImageView>,
}

/// What differs from cluster to cluster.
struct ClusterPasses {
    density: Pass,
    /// The same points with an empty fragment stage.
    density_floor: Pass,
    read_density: Pass,
    plane_heights_m: [f32; 4],
    /// Planes that are there, 1 to 4.
    planes: usize,
}

/// Where grid points lie, and which are accepted.
struct Grid {
    columns: usize,
    spacing_m: [f32; 2],
    rho: f32,
}

impl Isosurface {
    /// # Errors
    /// What the Vulkan layer answers; [`Error::Limit`] for a grid or a point size (eq. 6.1) beyond the device's.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        cluster_vertices: &[Arc<Buffer>],
        instanced: bool,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        check_point_size(shaders, label, parameters)?;
        let [x, y, z] = parameters.density;
        let name = |what: &str| format!("{label}/{what}");
        let layers = Image::new(device, desc(name("density"), FLOATS, x, z).layers(parameters.clusters()))?;
        let bytes = 16 * u64::from(x) * u64::from(z);
        let readback =
            Buffer::new(device, BufferDesc::new(name("density-readback"), bytes).location(Location::Readback))?;
        let mut clusters: Vec<ClusterPasses> = Vec::with_capacity(cluster_vertices.len());
        for (k, vertices) in (0..).zip(cluster_vertices) {
            let layer = layers.layer(k)?;
            let points = |name, fragment| {
                Pass::graphics(name, "6.1", "lava/density.vert", fragment)
                    .vertices::<Point>(vertices)
                    .topology(Topology::Points)
                    .constants::<DensityConstants>()
            };
            let again = |pass: &Pass, load| pass.rebind().vertices(vertices).color(0, &layer, load).build(shaders);
            let (density, density_floor) = match clusters.first() {
                None => (
                    points("density", "lava/density.frag").color(&layer, ZERO, Blend::Add).build(shaders)?,
                    points(FLOORS[0].1, EMPTY).color(&layer, Load::Keep, Blend::Masked).build(shaders)?,
                ),
                Some(first) => (again(&first.density, ZERO)?, again(&first.density_floor, Load::Keep)?),
            };
            let planes = (y - 4 * k).min(4);
            let height_m = |j: u32| if j < planes { parameters.plane_height_m(4 * k + j) } else { NO_PLANE_M };
            clusters.push(ClusterPasses {
                density,
                density_floor,
                read_density: Pass::copy("read-density", "6.2", &layer, &readback),
                plane_heights_m: [0, 1, 2, 3].map(height_m),
                planes: planes as usize,
            });
        }

        let points = u64::from(x) * u64::from(y) * u64::from(z);
        let vertices = host_vertices(shaders, name("isosurface"), points)?;
        let accumulated = target(shaders, name("accumulated-depths"), FLOATS, x, z)?;
        let normal_height = target(shaders, name("normal-height"), FLOATS, x, z)?;
        let splats = |name, fragment| {
            let splats = if instanced {
                Pass::graphics(name, "6.3", "lava/depth-splat-quad.vert", fragment)
                    .instances::<Point>(&vertices)
                    .topology(Topology::TriangleStrip)
            } else {
                Pass::graphics(name, "6.3", "lava/point.vert", fragment)
                    .geometry("lava/depth-splat.geom")
                    .vertices::<Point>(&vertices)
                    .topology(Topology::Points)
            };
            splats.constants::<DepthConstants>()
        };
        let accumulate_depths = splats("accumulate-depths", "lava/accumulate-depths.frag")
            .color(&accumulated, ZERO, Blend::Add)
            .build(shaders)?;
        let accumulate_floor =
            splats(FLOORS[1].1, EMPTY).color(&accumulated, Load::Keep, Blend::Masked).build(shaders)?;
        let normal_height_pass =
            Pass::graphics("normal-height", "6.4", "common/fullscreen.vert", "lava/normal-height.frag")
                .constants::<NormalConstants>()
                .with("accumulated_depths", &accumulated)
                .color(&normal_height, Load::Discard, Blend::Replace)
                .build(shaders)?;

        let space = parameters.space_m;
        let (across, columns) = ([space.x, space.z], [x as f32, z as f32]);
        Ok(Isosurface {
            clusters,
            extract: PassInfo::host("extract", "6.2", &[readback.name()], &[vertices.name()]),
            accumulate_depths,
            accumulate_floor,
            normal_height_pass,
            readback,
            vertices,
            grid: Grid {
                columns: x as usize,
                spacing_m: [across[0] / columns[0], across[1] / columns[1]],
                rho: parameters.rho(),
            },
            accepted: Vec::with_capacity(points as usize),
            range: [0.0; 2],
            density_constants: DensityConstants {
                plane_heights_m: [0.0; 4],
                space_m: space.to_array(),
                radius_m: parameters.radius_m,
                columns,
                point_size_px: parameters.point_size_px(),
                // Eq. 6.2 at r = 0, with h to the first power as it is printed.
                peak: 405.0 / (748.0 * PI * parameters.radius_m),
            },
            depth_constants: DepthConstants { space_m: across, columns, radius_m: parameters.radius_m },
            normal_constants: NormalConstants { space_m: across, columns, border_m: parameters.border_m },
            instanced,
            density: layers.view()?,
            accumulated,
            normal_height,
        })
    }

    /// Densities and accepted points cluster by cluster, then heights and normals. `clusters` are the particles in the
    /// vertex buffers.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&mut self, frame: &mut Frame<'_>, clusters: &[Vec<Point>]) -> Result<(), Error> {
        self.accepted.clear();
        self.range = [f32::INFINITY, f32::NEG_INFINITY];
        for (passes, particles) in self.clusters.iter().zip(clusters) {
            self.draw_particles(frame, &passes.density, passes.plane_heights_m, particles)?;
            frame.copy(&passes.read_density)?;
            frame.wait_for(&passes.read_density)?;
            let Isosurface { grid, readback, accepted, range, vertices, .. } = self;
            frame.host(&self.extract, || {
                let before = accepted.len();
                readback.read(readback.size_bytes(), |bytes| {
                    grid.extract(bytemuck::cast_slice(bytes), passes, accepted, range);
                })?;
                let offset_bytes = (before * size_of::<Point>()) as u64;
                vertices.write(offset_bytes, bytemuck::cast_slice(&accepted[before..]))
            })?;
        }
        self.draw_accepted(frame, &self.accumulate_depths)?;
        frame.graphics(&self.normal_height_pass, |draw| {
            draw.constants(&self.normal_constants).vertices(3);
        })
    }

    /// Draws the last frame's points with an empty fragment stage, as the passes of [`FLOORS`]. It changes no texture.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record_floors(&self, frame: &mut Frame<'_>, clusters: &[Vec<Point>]) -> Result<(), Error> {
        for (passes, particles) in self.clusters.iter().zip(clusters) {
            self.draw_particles(frame, &passes.density_floor, passes.plane_heights_m, particles)?;
        }
        self.draw_accepted(frame, &self.accumulate_floor)
    }

    /// The particles of a cluster.
    fn draw_particles(
        &self,
        frame: &mut Frame<'_>,
        pass: &Pass,
        plane_heights_m: [f32; 4],
        particles: &[Point],
    ) -> Result<(), Error> {
        let constants = DensityConstants { plane_heights_m, ..self.density_constants };
        frame.graphics(pass, |draw| {
            draw.constants(&constants).vertices(particles.len() as u32);
        })
    }

    /// The accepted grid points as splats.
    fn draw_accepted(&self, frame: &mut Frame<'_>, pass: &Pass) -> Result<(), Error> {
        let points = self.accepted.len() as u32;
        frame.graphics(pass, |draw| {
            draw.constants(&self.depth_constants);
            if self.instanced {
                draw.instances(4, points)
            } else {
                draw.vertices(points)
            };
        })
    }

    /// The grid points that the last frame accepted, metres.
    pub fn accepted(&self) -> &[Point] {
        &self.accepted
    }

    /// Lowest and highest density at a grid point in the last frame.
    pub fn density_range(&self) -> [f32; 2] {
        self.range
    }

    /// A layer for each cluster, a component for each of its planes.
    pub fn density(&self) -> &Arc<ImageView> {
        &self.density
    }

    /// Sum of weighted heights in red, sum of weights in alpha.
    pub fn accumulated_depths(&self) -> &Arc<ImageView> {
        &self.accumulated
    }

    /// Normals in RGB, heights in metres in alpha.
    pub fn normal_height(&self) -> &Arc<ImageView> {
        &self.normal_height
    }
}

impl Grid {
    /// Adds the grid points of one cluster's planes whose density reaches rho (section 6.2).
    fn extract(
        &self,
        densities: &[[f32; 4]],
        passes: &ClusterPasses,
        accepted: &mut Vec<Point>,
        [lowest, highest]: &mut [f32; 2],
    ) {
        let [dx, dz] = self.spacing_m;
        for (row, texels) in densities.chunks_exact(self.columns).enumerate() {
            let z = (row as f32 + 0.5) * dz;
            for (column, texel) in texels.iter().enumerate() {
                let x = (column as f32 + 0.5) * dx;
                for (&density, &y) in texel.iter().zip(&passes.plane_heights_m).take(passes.planes) {
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

/// A point beyond the device's size would be clamped in silence.
fn check_point_size(shaders: &ShaderLibrary, label: &str, parameters: &Parameters) -> Result<(), Error> {
    let limit = shaders.device().physical().limits.point_size_range[1];
    let size = parameters.point_size_px();
    if size <= limit {
        return Ok(());
    }
    Err(Error::Limit {
        object: format!("{label}/density"),
        what: "point size in pixels (eq. 6.1: 2 x radius / space x density)",
        wanted: size.ceil() as u64,
        limit: limit as u64,
    })
}
