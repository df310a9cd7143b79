//! The pass `shadow` (optional; section 2 has the sun as a source of light): rays to the sun from what is seen, through the
//! same levels. Once for each map. The pass `object-shadow` is the same from polygon objects.

use std::sync::Arc;

use ash::vk;
use rayon::prelude::*;

use super::blocks::TerrainBlock;
use super::geometric_transformation::SceneView;
use super::height_field::{Field, FieldWork, HeightField};
use super::hit::{Hit, Surface};
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::{DeviceScene, texels};
use super::stage::Stage;
use crate::measure::parameter::Choice;
use crate::gpu::{Device, Error, Frame, ImageView, Load, Pass, PassInfo, ShaderLibrary};

/// A single texel for where the sun reaches everything.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn all_lit(device: &Arc<Device>, label: &str) -> Result<Arc<ImageView>, Error> {
    texels(device, &format!("{label}/all-lit"), vk::Format::R32_SFLOAT, (1, 1), |_, bytes| {
        bytes.copy_from_slice(bytemuck::bytes_of(&1.0_f32));
    })
}

/// The pass on the device.
pub struct Shadow {
    stage: Stage,
    passes: Vec<Pass>,
    /// The maps' shadow: 0 inside, 1 in the sunlight.
    pub target: Arc<ImageView>,
}

impl Shadow {
    /// The shadows of the scene's maps on what `depth` has, in passes of that name.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        (stage, name): (Stage, &'static str),
        parameters: &Parameters,
        scene: &DeviceScene,
        depth: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let program = format!("shadow-{}-{}", parameters.base.kind(), parameters.interpolation.name());
        let ping_pong = (0..scene.maps.len().min(2))
            .map(|index| stage.image(shaders, format!("{label}/{name}-{index}"), vk::Format::R32_SFLOAT, parameters))
            .collect::<Result<Vec<_>, _>>()?;
        let mut passes = Vec::new();
        // Each map's pass reads what the maps before it left.
        let mut prior = all_lit(shaders.device(), &format!("{label}/{name}"))?;
        for (map, target) in scene.maps.iter().zip(ping_pong.iter().cycle()) {
            let resources = [
                ("terrain", (&map.terrain).into()),
                ("levels", (&map.levels.view).into()),
                ("depth", depth.into()),
                ("prior", (&prior).into()),
            ];
            passes.push(stage.pass((name, "2"), &program, (target, Load::Discard), &resources).build(shaders)?);
            prior = target.clone();
        }
        Ok(Shadow { stage, passes, target: prior })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| self.stage.record(frame, pass, &self.target))
    }
}

/// The pass on the processor.
pub struct HostShadow {
    info: Arc<PassInfo>,
    width: u32,
    sunlit: Vec<f32>,
}

impl HostShadow {
    pub fn new(parameters: &Parameters) -> Self {
        HostShadow {
            info: PassInfo::host("shadow", "2", &["land", "levels", "depth"], &["shadow"]),
            width: parameters.width,
            sunlit: vec![1.0; parameters.pixels()],
        }
    }

    /// The maps' shadow at each pixel: 0 inside, 1 in the sunlight.
    pub fn record(&mut self, frame: &mut Frame<'_>, maps: &[HeightField], view: &SceneView, hits: &[Hit]) -> &[f32] {
        let HostShadow { ref info, width, ref mut sunlit } = *self;
        frame.host(info, || {
            sunlit.par_iter_mut().for_each(|sunlit| *sunlit = 1.0);
            for (map, terrain) in maps.iter().zip(&view.terrains) {
                map.with(Rows { terrain, width, hits, sunlit });
            }
        });
        sunlit
    }
}

struct Rows<'a> {
    terrain: &'a TerrainBlock,
    width: u32,
    hits: &'a [Hit],
    sunlit: &'a mut [f32],
}

impl FieldWork for Rows<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let width = self.width as usize;
        let caster = RayCaster { terrain: self.terrain, field, footprint: Footprint::Data };
        self.sunlit.par_chunks_mut(width).zip(self.hits.par_chunks(width)).enumerate().for_each(|(y, (row, hits))| {
            for (x, (sunlit, hit)) in row.iter_mut().zip(hits).enumerate() {
                if hit.surface != Surface::Sky && caster.is_shadowed(caster.direction(x as u32, y as u32), hit) {
                    *sunlit = 0.0;
                }
            }
        });
    }
}
