//! What the thesis compares: ways from a receiver and its illumination volumes to the combined map that is cast.

use std::sync::Arc;

use super::illumination::IlluminationVolumes;
use super::receiver::LitReceiver;
use crate::gpu::{Error, Frame, ImageView};
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
