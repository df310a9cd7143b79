//! Pass `accumulate-depths` (section 6.3): the accepted grid points as splats, their weighted heights added up.

use std::sync::Arc;

use super::FLOORS;
use super::cluster::Point;
use super::parameters::{Parameters, SurfaceKind};
use super::targets::{Context, EMPTY, ZERO};
use crate::gpu::pass::PassBuilder;
use crate::gpu::{Blend, Buffer, Error, Frame, ImageView, Load, Pass, Topology};
use crate::host_block;

host_block! {
    struct DepthConstants {
        space_m: [f32; 2],
        columns: [f32; 2],
        radius_m: f32,
    }
}

/// The pass.
pub struct AccumulateDepths {
    pass: Pass,
    instanced: bool,
    constants: DepthConstants,
    /// Sum of weighted heights in red, metres; sum of weights in alpha.
    pub sums: Arc<ImageView>,
}

impl AccumulateDepths {
    /// `instanced` splats are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, vertices: &Arc<Buffer>, instanced: bool) -> Result<Self, Error> {
        let parameters = context.parameters;
        let sums = context.grid_target("accumulated-depths")?;
        let pass = splats("accumulate-depths", "lava/accumulate-depths.frag", vertices, instanced)
            .color(&sums, ZERO, Blend::Add)
            .build(context.shaders)?;
        let constants = DepthConstants {
            space_m: [parameters.space_m.x, parameters.space_m.z],
            columns: [sums.width() as f32, sums.height() as f32],
            radius_m: radius_m(parameters),
        };
        Ok(AccumulateDepths { pass, instanced, constants, sums })
    }

    /// The same splats with an empty fragment stage. It changes no texture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn floor(&self, context: Context<'_>, vertices: &Arc<Buffer>) -> Result<Self, Error> {
        let pass = splats(FLOORS[1].1, EMPTY, vertices, self.instanced)
            .color(&self.sums, Load::Keep, Blend::Masked)
            .build(context.shaders)?;
        Ok(AccumulateDepths { pass, sums: self.sums.clone(), ..*self })
    }

    /// Draws the points of the surface, which the vertex buffer holds.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, surface: &[Point]) -> Result<(), Error> {
        let points = surface.len() as u32;
        frame.graphics(&self.pass, |draw| {
            draw.constants(&self.constants);
            if self.instanced {
                draw.instances(4, points)
            } else {
                draw.vertices(points)
            };
        })
    }
}

/// R_i of eq. 6.3, metres.
pub fn radius_m(parameters: &Parameters) -> f32 {
    match parameters.surface {
        SurfaceKind::Mean | SurfaceKind::Top => parameters.radius_m,
        // A crossing is the height of its own column: its splat reaches no neighbour.
        SurfaceKind::Crossing => {
            let [x, _, z] = parameters.density;
            0.25 * (parameters.space_m.x / x as f32).min(parameters.space_m.z / z as f32)
        }
    }
}

fn splats(name: &'static str, fragment: &str, vertices: &Arc<Buffer>, instanced: bool) -> PassBuilder {
    let splats = if instanced {
        Pass::graphics(name, "6.3", "lava/depth-splat-quad.vert", fragment)
            .instances::<Point>(vertices)
            .topology(Topology::TriangleStrip)
    } else {
        Pass::graphics(name, "6.3", "lava/point.vert", fragment)
            .geometry("lava/depth-splat.geom")
            .vertices::<Point>(vertices)
            .topology(Topology::Points)
    };
    splats.constants::<DepthConstants>()
}
