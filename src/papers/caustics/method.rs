//! What the thesis compares: ways from a receiver and its illumination volumes to the combined map that is cast.

use std::sync::Arc;

use super::illumination::{IlluminationVolumes, Ray};
use super::maps::BLACK;
use super::parameters::Parameters;
use super::receiver::{LitReceiver, PlaneConstants};
use super::water::Water;
use crate::gpu::{Blend, Error, Frame, ImageView, Pass, Sampler, ShaderLibrary};
use crate::host_block;

host_block! {
    /// The light's colour, where I_c is combined with I_d.
    pub struct CombineConstants {
        pub intensity: [f32; 4],
    }
}

impl CombineConstants {
    pub fn of(lit: &LitReceiver) -> Self {
        CombineConstants { intensity: lit.light_intensity().extend(0.0).to_array() }
    }
}

/// What a method is made of: one receiver under one light, and what all receivers share.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    pub shaders: &'a ShaderLibrary,
    /// Goes before the names of resources.
    pub label: &'a str,
    pub lit: &'a LitReceiver,
    pub water: &'a Water,
    pub volumes: &'a IlluminationVolumes,
    pub nearest: &'a Arc<Sampler>,
    pub parameters: &'a Parameters,
}

/// The caustics-map pass with an empty fragment stage: the same triangles on the same target, nothing shaded.
///
/// # Errors
/// What the Vulkan layer answers.
pub fn floor_pass(site: Site<'_>, caustics: &Arc<ImageView>) -> Result<Pass, Error> {
    Pass::graphics("caustics-map-floor", "4.5", "caustics/caustics-map.vert", "common/empty.frag")
        .vertices::<Ray>(&site.volumes.rays)
        .indices(&site.water.indices)
        .constants::<PlaneConstants>()
        .color(caustics, BLACK, Blend::Masked)
        .build(site.shaders)
}

/// Draws the triangles of every plane with [`floor_pass`].
///
/// # Errors
/// What the Vulkan layer answers.
pub fn draw_floor(
    frame: &mut Frame<'_>,
    pass: &Pass,
    lit: &LitReceiver,
    volumes: &IlluminationVolumes,
) -> Result<(), Error> {
    frame.graphics(pass, |draw| {
        for cell in &lit.cells {
            draw.constants(&lit.plane_constants(cell, volumes)).indices(volumes.index_count);
        }
    })
}

/// One method for one receiver under one light. The stages run in this order.
pub trait Method {
    /// The receiver into maps: the position and diffuse map, or a slice image for every plane.
    fn create_maps(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error>;

    /// Places the planes anew by what the maps hold; methods that do not know keep the uniform ones.
    fn refine_planes(&mut self, _frame: &mut Frame<'_>, _lit: &mut LitReceiver) -> Result<(), Error> {
        Ok(())
    }

    /// Texels in each depth level, the nearest to the light first, where the method counts them.
    fn depth_profile(&self) -> Option<&[u32]> {
        None
    }

    /// The intersection triangles of every plane into the caustics map.
    fn create_caustics(
        &self,
        frame: &mut Frame<'_>,
        lit: &LitReceiver,
        volumes: &IlluminationVolumes,
    ) -> Result<(), Error>;

    /// Draws what [`Method::create_caustics`] draws with an empty fragment stage, after a frame.
    fn draw_floor(&self, frame: &mut Frame<'_>, lit: &LitReceiver, volumes: &IlluminationVolumes) -> Result<(), Error>;

    /// I_c x I_d into the combined map.
    fn combine(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error>;

    /// Heights of the lit surface, metres of box space, one channel.
    fn position_map(&self) -> &Arc<ImageView>;

    /// How far a height of the position map may lie from the surface itself, in metres.
    fn height_slack_m(&self, lit: &LitReceiver) -> f32;

    /// I_c x I_d, linear RGB; alpha is 1 where there is a receiver.
    fn combined_map(&self) -> &Arc<ImageView>;

    /// What `--dump` knows, by name.
    fn targets(&self) -> Vec<(&'static str, &Arc<ImageView>)>;
}
