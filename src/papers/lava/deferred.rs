//! Deferred shading of splats (chapter 9): `blending` adds up their normals and depths in place of colours, and pass `deferred` gives
//! each pixel one colour by them. Ours.

use std::sync::Arc;

use super::parameters::Parameters;
use super::rays::{RayConstants, rays};
use super::scene::Scene;
use super::splats::Splats;
use super::targets::{Context, FLOATS, ZERO};
use crate::choice;
use crate::gpu::{Blend, Error, Frame, ImageView, Pass};

choice! {
    /// Place of the colours of splats.
    pub enum SplatShading {
        /// Section 7.2.
        Gouraud = ("gouraud", "The thesis's: a colour for each splat, blended, which blurs the rock"),
        /// Chapter 9.
        Deferred = ("deferred", "Normals and depths of the splats, blended, then a colour for each pixel"),
    }
}

/// The passes.
pub struct Deferred {
    blending: Pass,
    deferred: Pass,
    rays: RayConstants,
    /// Sums of weighted unit normals, sum of weights in alpha.
    pub normals: Arc<ImageView>,
    /// Sum of weighted eye-space depths in red, metres.
    pub depths: Arc<ImageView>,
}

impl Deferred {
    /// Colours `sums` by what the depths of `visibility` do not hide.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        scene: &Scene,
        splats: &Splats,
        visibility: &Arc<ImageView>,
        sums: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let Parameters { width, height, .. } = *context.parameters;
        let normals = context.target("blended-normals", FLOATS, width, height)?;
        let depths = context.target("blended-depths", FLOATS, width, height)?;
        let blending = scene
            .bounded(|shader| splats.pass(scene, "blending", "7.2", shader), "lava/deferred-blending")
            .with("visibility", visibility)
            .color(&normals, ZERO, Blend::Add)
            .color(&depths, ZERO, Blend::Add)
            .build(context.shaders)?;
        let deferred = scene
            .colored(|shader| Pass::graphics("deferred", "9", "common/fullscreen.vert", shader), "lava/deferred")
            .constants::<RayConstants>()
            .with("scene", &scene.block)
            .with("blended_normals", &normals)
            .with("blended_depths", &depths)
            .with("rock", &scene.rock)
            .with("linear", &scene.linear)
            .with("emission", &scene.emission)
            .color(sums, ZERO, Blend::Replace)
            .build(context.shaders)?;
        Ok(Deferred { blending, deferred, rays: rays(context.parameters), normals, depths })
    }

    /// Sets the rays to those of the parameters' camera.
    pub fn set_rays(&mut self, parameters: &Parameters) {
        self.rays = rays(parameters);
    }

    /// Draws the splats and colours the pixels; the rock has drifted `drift_m` along x.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, splats: &Splats, drift_m: f32) -> Result<(), Error> {
        frame.graphics(&self.blending, |draw| splats.draw(draw))?;
        frame.graphics(&self.deferred, |draw| draw.constants(&self.rays.drifted(drift_m)).vertices(3))
    }
}
