//! Passes `depth-profile`, `sub-boxes` and `smart-planes`: smart slicing (section 4.7.2) where the position map is, for the
//! culled map (section 6.1). Nothing is read back, and the planes are those that the host would place, bit for bit.

mod sub_boxes;

use std::sync::Arc;

use ash::vk;

use self::sub_boxes::sub_boxes;
use super::culled_map::CellBlock;
use super::parameters::Parameters;
use super::planes::{self, Fit, SmartPlacement};
use super::receiver::LitReceiver;
use super::resources::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    struct ProfileConstants {
        top: f32,
        levels_per_m: f32,
        levels: u32,
        map_size: u32,
        threads: u32,
    }
}

host_block! {
    struct SmartConstants {
        top: f32,
        middle: f32,
        levels: u32,
        most: u32,
    }
}

host_block! {
    /// Neighbouring levels that hold the receiver, and their planes.
    pub struct SubBoxBlock {
        first: u32,
        end: u32,
        first_plane: u32,
        planes: u32,
    }
}

host_block! {
    /// Planes and sub-boxes that a frame placed.
    pub struct PlacedBlock {
        planes: u32,
        boxes: u32,
    }
}

/// Invocations that take a column's texels in turn, at the most.
const ROWS: u32 = 64;
/// Invocations of the workgroup that finds the sub-boxes.
const WORKGROUP: u32 = 256;

/// Begins a pass over the levels of the profile.
fn over_levels(name: &'static str, shader: &str, [held, fits, boxes, placed]: [&Arc<Buffer>; 4]) -> PassBuilder {
    Pass::compute(name, "4.7.2, 6.1", shader)
        .constants::<SmartConstants>()
        .with("held", held)
        .with("fits", fits)
        .with("sub_boxes", boxes)
        .with("placed", placed)
}

/// Passes of one receiver under one light.
pub struct SmartPlanes {
    depth_profile: Pass,
    sub_boxes: Pass,
    smart_planes: Pass,
    profile: ProfileConstants,
    smart: SmartConstants,
    /// First height of each level that it no longer holds, and the lowest, metres from the box's centre.
    pub bounds: Arc<Buffer>,
    /// A [`CellBlock`] for each plane that there is room for, zero beyond the last one of the last frame.
    pub cells: Arc<Buffer>,
    /// Of each level that holds the receiver, its sub-box: top, cells per metre, first plane and last one.
    pub sliced: Arc<Buffer>,
    /// A [`PlacedBlock`].
    pub placed: Arc<Buffer>,
}

impl Parameters {
    /// The acceptance threshold that is given, when the variant `culled` fits planes on the device. Of uniform planes it
    /// drops those without a texel by itself.
    pub fn smart_on_device(&self) -> Option<Option<f32>> {
        match self.smart.placement {
            SmartPlacement::Fitted { epsilon_m } if self.culled_smart => Some(epsilon_m),
            _ => None,
        }
    }
}

impl SmartPlanes {
    /// Places by the heights of `position_map`, the box's centre being at `middle_m` from the rays' reference point; `epsilon_m` is
    /// the acceptance threshold where one is given.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        lit: &LitReceiver,
        epsilon_m: Option<f32>,
        middle_m: f64,
        position_map: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let (height, levels) = (lit.aligned.extent.y, context.parameters.smart.levels);
        let map_size = context.parameters.map_size;
        let fits = Fit::of_each(height, levels, planes::threshold(height, context.parameters.planes, epsilon_m));
        let most = planes::most_fitted(&fits);
        let mut slices = Vec::new();
        planes::slice(height, levels, &mut slices);
        let lowest = slices.last().map(|cell| cell.lower);
        let bounds: Vec<f32> = slices.iter().map(|cell| cell.upper).chain(lowest).collect();

        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let upload = |name: &str, bytes: &[u8]| context.upload(name, storage, bytes);
        let buffer = |name: &str, bytes: u64| {
            Buffer::new(context.device(), BufferDesc::new(context.name(name), bytes).usage(storage))
                .map_err(|error| error.set_by("levels"))
        };
        let bounds = upload("level-bounds", bytemuck::cast_slice(&bounds))?;
        let held = upload("levels-held", bytemuck::cast_slice(&vec![0_u32; levels as usize]))?;
        let fits = upload("sub-box-fits", bytemuck::cast_slice(&fits))?;
        let boxes = buffer("sub-boxes", size_of::<SubBoxBlock>() as u64 * u64::from(levels.div_ceil(2)))?;
        let cells = buffer("plane-cells", size_of::<CellBlock>() as u64 * u64::from(most))?;
        let sliced = buffer("levels-sliced", 16 * u64::from(levels))?;
        let placed = buffer("planes-placed", size_of::<PlacedBlock>() as u64)?;
        let top = (height / 2.0) as f32;
        Ok(SmartPlanes {
            depth_profile: Pass::compute("depth-profile", "4.7.2, 6.1", "caustics/depth-profile.comp")
                .constants::<ProfileConstants>()
                .with("position_map", position_map)
                .with("nearest", context.nearest)
                .with("bounds", &bounds)
                .with("held", &held)
                .build(context.shaders)?,
            sub_boxes: sub_boxes(context.shaders, [&held, &fits, &boxes, &placed])?,
            smart_planes: over_levels("smart-planes", "caustics/smart-planes.comp", [&held, &fits, &boxes, &placed])
                .with("bounds", &bounds)
                .with("cells", &cells)
                .with("sliced", &sliced)
                .build(context.shaders)?,
            profile: ProfileConstants {
                top,
                levels_per_m: (f64::from(levels) / height) as f32,
                levels,
                map_size,
                threads: ROWS.min(map_size),
            },
            smart: SmartConstants { top, middle: middle_m as f32, levels, most },
            bounds,
            cells,
            sliced,
            placed,
        })
    }

    /// Planes that there is room for.
    pub fn most(&self) -> u32 {
        self.smart.most
    }

    /// Planes of the last frame.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn drawn(&self, device: &Arc<Device>) -> Result<u32, Error> {
        let placed: Vec<PlacedBlock> = bytemuck::pod_collect_to_vec(&read_buffer(device, &self.placed)?);
        Ok(placed.iter().map(|placed| placed.planes).sum())
    }

    /// Places the planes.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let ProfileConstants { map_size, threads, .. } = self.profile;
        frame
            .compute(&self.depth_profile, |dispatch| dispatch.constants(&self.profile).threads(map_size, threads, 1))?;
        let SmartConstants { levels, most, .. } = self.smart;
        for (pass, threads) in [(&self.sub_boxes, WORKGROUP), (&self.smart_planes, most.max(levels))] {
            frame.compute(pass, |dispatch| dispatch.constants(&self.smart).elements(threads))?;
        }
        Ok(())
    }
}
