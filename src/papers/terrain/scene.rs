//! Everything of a configuration that the device's passes share: maps with their levels, and the blocks that the host writes
//! anew for every frame.

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::blocks::{LandBlock, LightBlock};
use super::levels::Levels;
use super::parameters::Parameters;
use super::placement::{Extent, Ground, Placement, Rays};
use super::pyramid::Bound;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Location, ShaderLibrary};
use crate::scene::HeightMap;

/// A height map and its place.
#[derive(Debug, Clone)]
pub struct MapInput {
    pub map: Arc<HeightMap>,
    pub placement: Placement,
}

/// A map on the device.
pub struct Map {
    pub ground: Ground,
    pub levels: Levels,
    pub land: Arc<Buffer>,
}

/// The maps and the light.
pub struct Scene {
    pub maps: Vec<Map>,
    pub light: Arc<Buffer>,
    pub extent: Extent,
}

/// The maps' places over the base.
pub fn grounds(parameters: &Parameters, inputs: &[MapInput]) -> Vec<Ground> {
    let lowest_m = inputs.iter().map(|input| input.map.range_m().0).fold(f32::INFINITY, f32::min);
    let base_level_m = f64::from(parameters.base_level_m.unwrap_or(lowest_m));
    inputs.iter().map(|input| Ground::new(&input.map, input.placement, base_level_m)).collect()
}

/// The box around all maps.
pub fn extent_of(grounds: &[Ground]) -> Extent {
    let start = Extent { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
    grounds
        .iter()
        .map(Ground::extent)
        .fold(start, |all, one| Extent { low: all.low.min(one.low), high: all.high.max(one.high) })
}

impl Scene {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        inputs: &[MapInput],
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let grounds = grounds(parameters, inputs);
        let extent = extent_of(&grounds);
        let mut maps = Vec::new();
        for (index, (ground, input)) in grounds.into_iter().zip(inputs).enumerate() {
            let name = format!("{label}/map-{index}");
            maps.push(Map {
                levels: Levels::new(shaders, &name, &input.map, &[Bound::Highest])?,
                land: block_buffer::<LandBlock>(device, &format!("{name}/land"))?,
                ground,
            });
        }
        Ok(Scene { maps, light: block_buffer::<LightBlock>(device, &format!("{label}/light"))?, extent })
    }

    /// The pass `geometric-transformation`: eq. 10 and 11 for every map.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn transform(&self, parameters: &Parameters) -> Result<(), Error> {
        let camera = parameters.camera(&self.extent);
        let rays = Rays::new(&camera, parameters.width, parameters.height);
        for (index, map) in self.maps.iter().enumerate() {
            let block = LandBlock::new(&map.ground, map.levels.is_float, index as u32, &rays);
            map.land.write(0, bytemuck::bytes_of(&block))?;
        }
        self.light.write(0, bytemuck::bytes_of(&LightBlock::new(parameters, &rays, &self.extent)))
    }
}

fn block_buffer<T>(device: &Arc<Device>, name: &str) -> Result<Arc<Buffer>, Error> {
    let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
    let desc = BufferDesc::new(name, size_of::<T>() as u64).usage(usage).location(Location::Upload);
    Buffer::new(device, desc)
}
