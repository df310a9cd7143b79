//! The pass `shadow` (optional; section 2 has the sun as a source of light): rays to the sun from what is seen, through the
//! same levels. Once for each map. The pass `object-shadow` is the same from polygon objects.

use std::sync::Arc;

use ash::vk;

use super::geometric_transformation::SceneView;
use super::height_field::HeightField;
use super::hit::{Hit, Surface};
use super::host::{HostPass, PixelWork};
use super::levels::Levels;
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::{DeviceScene, texels};
use super::stage::{Build, PixelPass};
use crate::gpu::{Error, Frame, ImageView, PassInfo};

/// Format of what is left of the sun's light.
pub const FORMAT: vk::Format = vk::Format::R32_SFLOAT;

/// A single texel for where the sun reaches everything; `name` goes before its own.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn all_lit(build: &Build<'_>, name: &str) -> Result<Arc<ImageView>, Error> {
    let name = format!("{}{name}/all-lit", build.label);
    texels(build.shaders.device(), &name, FORMAT, (1, 1), |_, bytes| {
        bytes.copy_from_slice(bytemuck::bytes_of(&1.0_f32));
    })
}

/// The shadows of the scene's maps on what `depth` has, in passes of that name. The target has the maps' shadow: 0 inside, 1
/// in the sunlight.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn shadow(
    build: &Build<'_>,
    name: &'static str,
    scene: &DeviceScene,
    depth: &Arc<ImageView>,
) -> Result<PixelPass, Error> {
    let program = |levels: &Levels| build.ray_program("shadow", levels);
    let first = build.image(&format!("{name}-0"), FORMAT)?;
    let second = if scene.maps.len() > 1 { build.image(&format!("{name}-1"), FORMAT)? } else { first.clone() };
    let prior = all_lit(build, &format!("/{name}"))?;
    build.map_passes((name, "2"), &program, [&first, &second], scene, prior, &|_| vec![("depth", depth.into())])
}

/// The pass on the processor.
pub struct HostShadow(HostPass<f32>);

impl HostShadow {
    pub fn new(parameters: &Parameters) -> Self {
        let info = PassInfo::host("shadow", "2", &["land", "levels", "depth"], &["shadow"]);
        HostShadow(HostPass::new(info, parameters, 1.0))
    }

    /// The maps' shadow at each pixel: 0 inside, 1 in the sunlight.
    pub fn record(&mut self, frame: &mut Frame<'_>, scene: (&[HeightField], &SceneView), hits: &[Hit]) -> &[f32] {
        self.0.record(frame, scene, (Some(1.0), Footprint::Data), &Darken(hits))
    }
}

struct Darken<'a>(&'a [Hit]);

impl PixelWork<f32> for Darken<'_> {
    fn run<T: Texel>(&self, caster: &RayCaster<'_, T>, (x, y): (u32, u32), index: usize, sunlit: &mut f32) {
        let hit = &self.0[index];
        if hit.surface != Surface::Sky && caster.is_shadowed(caster.direction(x, y), hit) {
            *sunlit = 0.0;
        }
    }
}
