//! Rays whose loops the driver left before their end.

use std::sync::Arc;

use super::hit::Hit;
use super::{Technique, Terrain};
use crate::gpu::transfer::read_image;
use crate::gpu::{Device, Error, ImageView};

impl Terrain {
    /// Fails where the last frame has rays that did not end: to what is seen, or from there to the sun.
    ///
    /// # Errors
    /// [`Error::Pass`] of such rays, errors of the Vulkan layer.
    pub(super) fn check_rays(&self, device: &Arc<Device>) -> Result<(), Error> {
        let unfinished = |target: &Arc<ImageView>, is_one: &dyn Fn(&[f32]) -> bool, values: usize| {
            let texels = bytemuck::pod_collect_to_vec::<u8, f32>(&read_image(device, target)?);
            Ok::<_, Error>(texels.chunks_exact(values).filter(|texel| is_one(texel)).count())
        };
        let is_hit = |texel: &[f32]| texel.first_chunk().is_some_and(|&texel| Hit::from_texel(texel).is_unfinished());
        let is_light = |texel: &[f32]| texel[0] > 1.0;
        let mut counts = Vec::new();
        // Triangles are seen without rays, but not lit.
        if let Technique::RayCast(_, depth, _) = &self.technique {
            counts.push(("depth", unfinished(depth.target(), &is_hit, 4)?));
        }
        if let Technique::RayCast(_, _, shading) | Technique::Mesh(_, _, shading) = &self.technique {
            for (name, light) in [("shadow", &shading.shadow), ("occlusion", &shading.occlusion)] {
                if let Some(light) = light {
                    counts.push((name, unfinished(&light.target, &is_light, 1)?));
                }
            }
        }
        if let Some(shadows) = self.objects.as_ref().and_then(|objects| objects.shadow.as_ref()) {
            counts.push(("object-shadow", unfinished(&shadows.shadow.target, &is_light, 1)?));
            counts.push(("object-occlusion", unfinished(&shadows.occlusion.target, &is_light, 1)?));
        }
        let Some((pass, rays)) = counts.into_iter().find(|(_, rays)| *rays > 0) else { return Ok(()) };
        let problem = format!(
            "{rays} rays did not end: this driver leaves a shader's loops early, as after 65,535 iterations together; take a \
             smaller map or `object`, `interpolation` bilinear, `lod` pixel or variant cpu"
        );
        Err(Error::Pass { pass: pass.into(), problem })
    }
}
