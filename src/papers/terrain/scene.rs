//! The maps of a configuration in their places, and what the device's passes share of them.

use std::sync::Arc;

use ash::vk;
use glam::{DMat4, DVec4};

use super::blocks::{LandBlock, LightBlock};
use super::ground::{Ground, Origin};
use super::levels::Levels;
use super::parameters::{Interpolation, Parameters};
use super::placement::{Extent, Placement, Rays};
use super::pyramid::Bound;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Location, ShaderLibrary};
use crate::scene::{Camera, HeightMap, Samples};

/// A height map and its place.
#[derive(Debug, Clone)]
pub struct MapInput {
    pub map: Arc<HeightMap>,
    pub placement: Placement,
}

/// The maps' places over the base, and the box around all.
pub struct Scene {
    pub grounds: Vec<Ground>,
    pub extent: Extent,
    /// Lowest and highest above the base, metres.
    range_m: (f64, f64),
    /// Of each map, whether its texels are the bits of floats.
    are_floats: Vec<bool>,
}

impl Scene {
    /// Of at least one map.
    pub fn new(parameters: &Parameters, inputs: &[MapInput]) -> Self {
        let maps = || inputs.iter().map(|input| &*input.map);
        let lowest_m = maps().map(|map| map.range_m().0).fold(f32::INFINITY, f32::min);
        let highest_m = maps().map(|map| map.range_m().1).fold(f32::NEG_INFINITY, f32::max);
        let base_level_m = f64::from(parameters.base_level_m.unwrap_or(lowest_m));
        let origin = Origin::of(maps());
        let ground = |input: &MapInput| Ground::new(&input.map, input.placement, parameters.base, origin, base_level_m);
        let grounds: Vec<Ground> = inputs.iter().map(ground).collect();
        let start = Extent::of(std::iter::empty());
        Scene {
            extent: grounds.iter().map(Ground::extent).fold(start, Extent::union),
            range_m: (f64::from(lowest_m) - base_level_m, f64::from(highest_m) - base_level_m),
            grounds,
            are_floats: maps().map(|map| matches!(map.samples(), Samples::Float(_))).collect(),
        }
    }

    /// The pass `geometric-transformation`: eq. 10 and 11 for every map. Only the base's matrix is touched.
    pub fn transform(&self, parameters: &Parameters) -> Seen {
        let camera = parameters.camera(&self.extent);
        let rays = Rays::new(&camera, parameters.width, parameters.height);
        let maps = self.grounds.iter().zip(&self.are_floats).zip(0..);
        let land = |((ground, &is_float), index)| {
            LandBlock::new(ground, parameters.interpolation, is_float, index, &rays, camera.near_m)
        };
        Seen {
            lands: maps.map(land).collect(),
            light: LightBlock::new(parameters, &rays, self.range_m),
            to_clip: to_clip(&camera, parameters.aspect()),
        }
    }
}

/// The scene in the camera's eyes.
pub struct Seen {
    pub lands: Vec<LandBlock>,
    pub light: LightBlock,
    /// World to Vulkan clip space for what is rasterised: w is the depth along the view's axis in metres, z is
    /// 1 - near / w, without a far plane.
    pub to_clip: DMat4,
}

fn to_clip(camera: &Camera, aspect: f64) -> DMat4 {
    let scale = 1.0 / (f64::from(camera.vertical_fov_rad) / 2.0).tan();
    let projection = DMat4::from_cols(
        DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -scale, 0.0, 0.0),
        DVec4::new(0.0, 0.0, -1.0, -1.0),
        DVec4::new(0.0, 0.0, -f64::from(camera.near_m), 0.0),
    );
    projection * camera.view().as_dmat4()
}

/// A map on the device.
pub struct Map {
    pub levels: Levels,
    pub land: Arc<Buffer>,
}

/// The maps on the device, and the blocks that the host writes anew for every frame.
pub struct DeviceScene {
    pub maps: Vec<Map>,
    pub light: Arc<Buffer>,
}

impl DeviceScene {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        inputs: &[MapInput],
    ) -> Result<Self, Error> {
        let bounds: &[Bound] = match parameters.interpolation {
            Interpolation::Bilinear => &[Bound::Highest],
            Interpolation::Bicubic => &[Bound::Highest, Bound::Lowest],
        };
        let device = shaders.device();
        let map = |(index, input): (usize, &MapInput)| {
            let name = format!("{label}/map-{index}");
            Ok(Map {
                levels: Levels::new(shaders, &name, &input.map, bounds)?,
                land: block_buffer::<LandBlock>(device, &format!("{name}/land"))?,
            })
        };
        let maps = inputs.iter().enumerate().map(map).collect::<Result<_, Error>>()?;
        Ok(DeviceScene { maps, light: block_buffer::<LightBlock>(device, &format!("{label}/light"))? })
    }

    /// # Errors
    /// What the Vulkan layer answers.
    pub fn write(&self, seen: &Seen) -> Result<(), Error> {
        for (map, land) in self.maps.iter().zip(&seen.lands) {
            map.land.write(0, bytemuck::bytes_of(land))?;
        }
        self.light.write(0, bytemuck::bytes_of(&seen.light))
    }
}

fn block_buffer<T>(device: &Arc<Device>, name: &str) -> Result<Arc<Buffer>, Error> {
    let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
    let desc = BufferDesc::new(name, size_of::<T>() as u64).usage(usage).location(Location::Upload);
    Buffer::new(device, desc)
}
