//! The pass `depth` (section 3): where the ray of each pixel ends, on a map, on the base, or nowhere. Once for each map.

use std::sync::Arc;

use ash::vk;
use rayon::prelude::*;

use super::blocks::TerrainBlock;
use super::geometric_transformation::SceneView;
use super::height_field::{Field, FieldWork, HeightField};
use super::hit::Hit;
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::DeviceScene;
use super::stage::Stage;
use crate::measure::parameter::Choice;
use crate::gpu::{Error, Frame, ImageView, Load, Pass, PassInfo, ShaderLibrary};

/// The pass on the device: section 4's second application.
pub struct Depth {
    stage: Stage,
    passes: Vec<Pass>,
    /// A [`Hit`] of each pixel, of all maps.
    pub target: Arc<ImageView>,
}

impl Depth {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        stage: Stage,
        parameters: &Parameters,
        scene: &DeviceScene,
    ) -> Result<Self, Error> {
        let Parameters { base, interpolation, lod, .. } = parameters;
        let program = format!("depth-{}-{}-{}", base.kind(), interpolation.name(), lod.name());
        let ping_pong = (0..scene.maps.len().min(2))
            .map(|_| stage.image(shaders, format!("{label}/depth"), vk::Format::R32G32B32A32_SFLOAT, parameters))
            .collect::<Result<Vec<_>, _>>()?;
        let mut passes = Vec::new();
        // Each map's pass reads what the maps before it found.
        let mut prior = scene.no_hits.clone();
        for (map, target) in scene.maps.iter().zip(ping_pong.iter().cycle()) {
            let resources =
                [("terrain", (&map.terrain).into()), ("levels", (&map.levels.view).into()), ("prior", (&prior).into())];
            passes.push(stage.pass(("depth", "3"), &program, (target, Load::Discard), &resources).build(shaders)?);
            prior = target.clone();
        }
        Ok(Depth { stage, passes, target: prior })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| self.stage.record(frame, pass, &self.target))
    }
}

/// The pass on the processor: section 4's first application, by rows on all cores.
pub struct HostDepth {
    info: Arc<PassInfo>,
    footprint: Footprint,
    width: u32,
    hits: Vec<Hit>,
}

impl HostDepth {
    pub fn new(parameters: &Parameters) -> Self {
        HostDepth {
            info: PassInfo::host("depth", "3", &["land", "levels"], &["depth"]),
            footprint: parameters.lod.into(),
            width: parameters.width,
            hits: vec![Hit::SKY; parameters.pixels()],
        }
    }

    /// The hit of each pixel's ray, row by row.
    pub fn record(&mut self, frame: &mut Frame<'_>, maps: &[HeightField], view: &SceneView) -> &[Hit] {
        let HostDepth { ref info, footprint, width, ref mut hits } = *self;
        frame.host(info, || {
            hits.par_iter_mut().for_each(|hit| *hit = Hit::SKY);
            for (map, terrain) in maps.iter().zip(&view.terrains) {
                map.with(Rows { terrain, footprint, width, hits });
            }
        });
        hits
    }
}

struct Rows<'a> {
    terrain: &'a TerrainBlock,
    footprint: Footprint,
    width: u32,
    hits: &'a mut [Hit],
}

impl FieldWork for Rows<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let caster = RayCaster { terrain: self.terrain, field, footprint: self.footprint };
        self.hits.par_chunks_mut(self.width as usize).enumerate().for_each(|(y, row)| {
            for (x, hit) in row.iter_mut().enumerate() {
                *hit = caster.find(caster.direction(x as u32, y as u32), *hit);
            }
        });
    }
}
