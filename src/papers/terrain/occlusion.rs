//! The pass `occlusion` (optional; no part of the paper): the shadows that polygon objects cast on the terrain, by rays to the sun
//! through their triangles. The pass `object-occlusion` is the same on objects.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::geometric_transformation::SceneView;
use super::hit::{Hit, Surface};
use super::host::HostPass;
use super::parameters::Parameters;
use super::shadow;
use super::stage::{Build, PixelPass};
use crate::gpu::{Buffer, Error, Frame, ImageView, Load, PassInfo};
use crate::papers::triangle_tree::{DeviceTree, TriangleTree};

/// Of what a place is made of, what its rounding may be; as in the shader.
const ROUNDING: f32 = 2e-6;

/// Light of `prior` that the objects of `tree` leave on the surface in `depth`: 0 in a shadow.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn occlusion(
    build: &Build<'_>,
    name: &'static str,
    (light, tree): (&Arc<Buffer>, &DeviceTree),
    [depth, prior]: [&Arc<ImageView>; 2],
) -> Result<PixelPass, Error> {
    let target = build.image(name, shadow::FORMAT)?;
    let mut resources = vec![("light", light.into()), ("depth", depth.into()), ("prior", prior.into())];
    resources.extend(tree.buffers().map(|(name, buffer)| (name, buffer.into())));
    let pass = build.pass((name, ""), &tree.variant("occlusion"), (&target, Load::Discard), &resources)?;
    Ok(PixelPass { stage: build.stage, passes: vec![pass], target })
}

/// The pass on the processor.
pub struct HostOcclusion {
    pass: HostPass<f32>,
    tree: TriangleTree,
}

impl HostOcclusion {
    pub fn new(parameters: &Parameters, tree: TriangleTree) -> Self {
        let info = PassInfo::host("occlusion", "", &["light", "depth", "shadow"], &["occlusion"]);
        HostOcclusion { pass: HostPass::new(info, parameters, 1.0), tree }
    }

    /// Light of `sunlit` that the objects leave.
    pub fn record(&mut self, frame: &mut Frame<'_>, view: &SceneView, (hits, sunlit): (&[Hit], &[f32])) -> &[f32] {
        let HostOcclusion { pass: HostPass { info, width, values }, tree } = self;
        let (width, light) = (*width as usize, &view.light);
        frame.host(info, || {
            values.par_iter_mut().enumerate().for_each(|(index, lit)| {
                let (hit, before) = (&hits[index], sunlit[index]);
                let (x, y) = ((index % width) as f32, (index / width) as f32);
                let ray: Vec3 = light.corner_direction + x * light.right_step + y * light.down_step;
                let distance_m = hit.depth_m * ray.length();
                let away_m = ROUNDING * (distance_m + light.eye.length());
                let from = light.eye + (distance_m - away_m) * ray.normalize();
                let is_dark = hit.surface != Surface::Sky && before > 0.0 && tree.is_met(from, light.to_sun);
                *lit = if is_dark { 0.0 } else { before };
            });
        });
        values
    }
}
