//! Pass `density` (section 6.1): the particles of a cluster as points, added up over its four grid planes.

use std::f32::consts::PI;
use std::sync::Arc;

use super::FLOORS;
use super::cluster::Point;
use super::parameters::Parameters;
use super::targets::{Context, EMPTY, FLOATS, ZERO};
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Buffer, Error, Frame, Image, ImageView, Load, Pass, Topology};
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

/// No height reaches a plane that is not there.
const NO_PLANE_M: f32 = 1.0e9;

/// Four successive grid planes, the lowest first.
#[derive(Debug, Clone, Copy)]
pub struct GridPlanes {
    /// Heights, metres; out of reach for planes that are not there.
    pub heights_m: [f32; 4],
    /// Planes that are there, 1 to 4.
    pub count: usize,
}

impl GridPlanes {
    /// The planes of each cluster.
    pub fn all(parameters: &Parameters) -> Vec<Self> {
        let planes = |k: u32| {
            let count = (parameters.density[1] - 4 * k).min(4);
            let height_m = |j: u32| if j < count { parameters.plane_height_m(4 * k + j) } else { NO_PLANE_M };
            GridPlanes { heights_m: [0, 1, 2, 3].map(height_m), count: count as usize }
        };
        (0..parameters.clusters()).map(planes).collect()
    }
}

/// The pass.
pub struct Density {
    /// One for each cluster.
    passes: Vec<Pass>,
    constants: DensityConstants,
    /// A layer for each cluster, a component for each of its planes.
    pub density: Arc<ImageView>,
    /// Each layer by itself.
    pub layers: Vec<Arc<ImageView>>,
}

impl Density {
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for a grid or a point size (eq. 6.1) beyond the device's.
    pub fn new(context: Context<'_>, cluster_vertices: &[Arc<Buffer>]) -> Result<Self, Error> {
        let parameters = context.parameters;
        check_point_size(context)?;
        let [x, _, z] = parameters.density;
        let desc = context.desc("density", FLOATS, x, z).layers(parameters.clusters());
        let image = Image::new(context.device(), desc)?;
        let layers = (0..parameters.clusters()).map(|k| image.layer(k)).collect::<Result<Vec<_>, _>>()?;
        let begin = points("density", "lava/density.frag", cluster_vertices).color(&layers[0], ZERO, Blend::Add);
        let passes = each(context, begin, ZERO, cluster_vertices, &layers)?;
        let constants = DensityConstants {
            plane_heights_m: [0.0; 4],
            space_m: parameters.space_m.to_array(),
            radius_m: parameters.radius_m,
            columns: [x as f32, z as f32],
            point_size_px: parameters.point_size_px(),
            peak: peak(parameters.radius_m),
        };
        Ok(Density { passes, constants, density: image.view()?, layers })
    }

    /// The same points with an empty fragment stage. It changes no texture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn floor(&self, context: Context<'_>, cluster_vertices: &[Arc<Buffer>]) -> Result<Self, Error> {
        let (layers, density) = (self.layers.clone(), self.density.clone());
        let begin = points(FLOORS[0].1, EMPTY, cluster_vertices).color(&layers[0], Load::Keep, Blend::Masked);
        let passes = each(context, begin, Load::Keep, cluster_vertices, &layers)?;
        Ok(Density { passes, layers, density, ..*self })
    }

    /// Draws the particles of one cluster, which its vertex buffer holds.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &self,
        frame: &mut Frame<'_>,
        cluster: usize,
        planes: &GridPlanes,
        particles: &[Point],
    ) -> Result<(), Error> {
        let constants = DensityConstants { plane_heights_m: planes.heights_m, ..self.constants };
        frame.graphics(&self.passes[cluster], |draw| draw.constants(&constants).vertices(particles.len() as u32))
    }
}

fn points(name: &'static str, fragment: &str, cluster_vertices: &[Arc<Buffer>]) -> PassBuilder {
    Pass::graphics(name, "6.1", "lava/density.vert", fragment)
        .vertices::<Point>(&cluster_vertices[0])
        .topology(Topology::Points)
        .constants::<DensityConstants>()
}

/// One pass for each cluster, by the pipeline of the first.
fn each(
    context: Context<'_>,
    first: PassBuilder,
    load: Load,
    cluster_vertices: &[Arc<Buffer>],
    layers: &[Arc<ImageView>],
) -> Result<Vec<Pass>, Error> {
    let first = first.build(context.shaders)?;
    let each = cluster_vertices.iter().zip(layers);
    each.map(|(v, layer)| first.rebind().vertices(v).color(0, layer, load).build(context.shaders)).collect()
}

/// Eq. 6.2 at r = 0, with h to the first power as it is printed.
pub fn peak(radius_m: f32) -> f32 {
    405.0 / (748.0 * PI * radius_m)
}

/// A point beyond the device's size would be clamped in silence.
fn check_point_size(context: Context<'_>) -> Result<(), Error> {
    let limit = context.device().physical().limits.point_size_range[1];
    let size = context.parameters.point_size_px();
    if size <= limit {
        return Ok(());
    }
    Err(Error::Limit {
        object: context.name("density"),
        what: "point size in pixels (eq. 6.1: 2 x radius / space x density)",
        wanted: size.ceil() as u64,
        limit: limit as u64,
    })
}
