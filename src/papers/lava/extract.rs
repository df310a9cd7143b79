//! Pass `extract` (section 6.2): on the host, the grid points whose density reaches rho, and of them those that
//! `accumulate-depths` draws: all, as in the thesis, or one for each column.

use std::sync::Arc;

use super::cluster::{Point, host_vertices};
use super::density::GridPlanes;
use super::parameters::SurfaceKind;
use super::targets::Context;
use crate::gpu::{Buffer, Error, Frame, PassInfo};

/// The pass, with the vertex buffer that it fills.
pub struct Extract {
    info: Arc<PassInfo>,
    /// The points of the surface; capacity for all grid points.
    pub vertices: Arc<Buffer>,
    grid: Grid,
    /// The columns, of a surface of one point for each of them.
    columns: Option<Columns>,
    clusters: usize,
    clusters_done: usize,
    /// The grid points that the last frame accepted, metres.
    pub accepted: Vec<Point>,
    /// Lowest and highest density at a grid point in the last frame.
    pub density_range: [f32; 2],
}

/// Grid points that a frame accepted as lava, by their number and densities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accepted {
    /// Grid points.
    pub count: usize,
    /// Lowest and highest density at a grid point.
    pub density_range: [f32; 2],
}

impl Accepted {
    /// Before any grid point.
    pub const NONE: Self = Accepted { count: 0, density_range: [f32::INFINITY, f32::NEG_INFINITY] };
}

/// The highest place of every column so far, from the lowest plane up.
struct Columns {
    kind: SurfaceKind,
    /// Height in metres and density of the highest accepted point; no height without any.
    tops: Vec<(Option<f32>, f32)>,
    /// True where the plane above has been seen.
    are_closed: Vec<bool>,
    /// The places of the last frame, metres.
    points: Vec<Point>,
}

impl Columns {
    fn clear(&mut self) {
        self.tops.fill((None, 0.0));
        self.are_closed.fill(false);
        self.points.clear();
    }

    /// Takes the density of a column's next plane, `y_m` high.
    fn take(&mut self, column: usize, y_m: f32, density: f32, rho: f32) {
        let (height_m, below) = &mut self.tops[column];
        if density >= rho {
            (*height_m, *below) = (Some(y_m), density);
            self.are_closed[column] = false;
        } else if let Some(height_m) = height_m.as_mut().filter(|_| !self.are_closed[column]) {
            if self.kind == SurfaceKind::Crossing {
                *height_m += (*below - rho) / (*below - density) * (y_m - *height_m);
            }
            self.are_closed[column] = true;
        }
    }
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
            columns: (parameters.surface != SurfaceKind::Mean).then(|| {
                let count = x as usize * z as usize;
                Columns {
                    kind: parameters.surface,
                    tops: vec![(None, 0.0); count],
                    are_closed: vec![false; count],
                    points: Vec::with_capacity(count),
                }
            }),
            clusters: parameters.clusters() as usize,
            clusters_done: 0,
            accepted: Vec::with_capacity(points as usize),
            density_range: [0.0; 2],
        })
    }

    /// Forgets the points of the last frame.
    pub fn clear(&mut self) {
        self.accepted.clear();
        self.columns.iter_mut().for_each(Columns::clear);
        self.clusters_done = 0;
        self.density_range = Accepted::NONE.density_range;
    }

    /// The points of the surface, as the vertex buffer holds them after the last cluster.
    pub fn points(&self) -> &[Point] {
        self.columns.as_ref().map_or(&self.accepted, |columns| &columns.points)
    }

    /// Adds the accepted points of one cluster's planes; clusters come from the lowest up.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>, densities: &Buffer, planes: &GridPlanes) -> Result<(), Error> {
        let Extract { info, vertices, grid, columns, clusters, clusters_done, accepted, density_range } = self;
        *clusters_done += 1;
        frame.host(info, || {
            let before = accepted.len();
            densities.read(densities.size_bytes(), |bytes| {
                let densities = bytemuck::cast_slice(bytes);
                grid.extract(densities, planes, accepted, density_range);
                if let Some(columns) = columns {
                    grid.follow(densities, planes, columns);
                }
            })?;
            let Some(columns) = columns else {
                let offset_bytes = (before * size_of::<Point>()) as u64;
                return vertices.write(offset_bytes, bytemuck::cast_slice(&accepted[before..]));
            };
            if clusters_done < clusters {
                return Ok(());
            }
            grid.collect(columns);
            vertices.write(0, bytemuck::cast_slice(&columns.points))
        })
    }
}

impl Grid {
    fn extract(
        &self,
        densities: &[[f32; 4]],
        planes: &GridPlanes,
        accepted: &mut Vec<Point>,
        density_range: &mut [f32; 2],
    ) {
        let [dx, dz] = self.spacing_m;
        // A register holds these while points are added; what a reference names goes to memory at every one.
        let [mut lowest, mut highest] = *density_range;
        for (row, texels) in densities.chunks_exact(self.columns).enumerate() {
            let z = (row as f32 + 0.5) * dz;
            for (column, texel) in texels.iter().enumerate() {
                let x = (column as f32 + 0.5) * dx;
                for (&density, &y) in texel.iter().zip(&planes.heights_m).take(planes.count) {
                    lowest = lowest.min(density);
                    highest = highest.max(density);
                    if density >= self.rho {
                        accepted.push(Point { position: [x, y, z] });
                    }
                }
            }
        }
        *density_range = [lowest, highest];
    }

    fn follow(&self, densities: &[[f32; 4]], planes: &GridPlanes, columns: &mut Columns) {
        for (column, texel) in densities.iter().enumerate().take(columns.tops.len()) {
            for (&density, &y_m) in texel.iter().zip(&planes.heights_m).take(planes.count) {
                columns.take(column, y_m, density, self.rho);
            }
        }
    }

    fn collect(&self, columns: &mut Columns) {
        let [dx, dz] = self.spacing_m;
        for (column, (height_m, _)) in columns.tops.iter().enumerate() {
            let (i, k) = (column % self.columns, column / self.columns);
            if let Some(y) = *height_m {
                columns.points.push(Point { position: [(i as f32 + 0.5) * dx, y, (k as f32 + 0.5) * dz] });
            }
        }
    }
}
