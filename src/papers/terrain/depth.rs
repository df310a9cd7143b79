//! The pass `depth` (section 3): where the ray of each pixel ends, on a map, on the base, or nowhere. Once for each map.

use std::sync::Arc;

use super::geometric_transformation::SceneView;
use super::height_field::HeightField;
use super::hit::Hit;
use super::host::{HostPass, PixelWork};
use super::levels::Levels;
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::DeviceScene;
use super::stage::{Build, PixelPass, VECTOR};
use super::start::Starts;
use crate::gpu::{Error, Frame, ImageView, PassInfo};
use crate::measure::parameter::Choice;

/// The pass on the device: section 4's second application.
pub struct DeviceDepth(PixelPass);

impl DeviceDepth {
    /// Rays begin at `starts`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(build: &Build<'_>, scene: &DeviceScene, starts: &Starts) -> Result<Self, Error> {
        let lod = build.parameters.lod.name();
        let program = |levels: &Levels| format!("{}-{lod}", build.ray_program("depth", levels));
        let first = build.image("depth", VECTOR)?;
        let second = if scene.maps.len() > 1 { build.image("depth", VECTOR)? } else { first.clone() };
        let start = |map| starts.of_map(map).map(|start| ("starts", start.into())).into_iter().collect();
        let prior = scene.no_hits.clone();
        build.map_passes(("depth", "3"), &program, [&first, &second], scene, prior, &start).map(DeviceDepth)
    }

    /// A [`Hit`] of each pixel, of all maps.
    pub fn target(&self) -> &Arc<ImageView> {
        &self.0.target
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.0.record(frame)
    }
}

/// The pass on the processor.
pub struct HostDepth {
    pass: HostPass<Hit>,
    footprint: Footprint,
}

impl HostDepth {
    pub fn new(parameters: &Parameters) -> Self {
        let info = PassInfo::host("depth", "3", &["land", "levels"], &["depth"]);
        HostDepth { pass: HostPass::new(info, parameters, Hit::SKY), footprint: parameters.lod.into() }
    }

    /// The hit of each pixel's ray, row by row.
    pub fn record(&mut self, frame: &mut Frame<'_>, scene: (&[HeightField], &SceneView)) -> &[Hit] {
        self.pass.record(frame, scene, (Some(Hit::SKY), self.footprint), &Find)
    }
}

struct Find;

impl PixelWork<Hit> for Find {
    fn run<T: Texel>(&self, caster: &RayCaster<'_, T>, (x, y): (u32, u32), _: usize, hit: &mut Hit) {
        *hit = caster.find(caster.direction(x, y), *hit);
    }
}
