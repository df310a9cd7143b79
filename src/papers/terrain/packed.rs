//! A map on the device as rays over bilinear terrain read it best: the four corners of a cell by one fetch, of every level, and what
//! bounds blocks of cells as floats in an image of its own. Made of the map's levels, once.

use std::sync::Arc;

use ash::vk;

use super::levels::Levels;
use super::parameters::{Corners, Interpolation, Parameters};
use super::pyramid::Shape;
use crate::gpu::{Blend, Device, Error, Image, ImageDesc, ImageView, Load, Mode, Pass, Recorder, ShaderLibrary};
use crate::host_block;
use crate::scene::{HeightMap, Samples};

/// The part of the device's largest heap that the images of all maps may take where `corners` leaves the choice.
const HEAP_DIVISOR: u64 = 4;

host_block! {
    struct Packing {
        last: [i32; 2],
        beside: [i32; 2],
        axis: [i32; 2],
        top: i32,
        is_float: i32,
    }
}

/// The images of a map.
pub struct Packed {
    /// Of each cell of each level the values at its corners, in the numbers of the map's levels.
    pub corners: Arc<ImageView>,
    /// The highest values of the levels above the data, as floats.
    pub coarser: Arc<ImageView>,
}

/// Format of the highest values.
const HIGHEST: vk::Format = vk::Format::R32_SFLOAT;

/// The format of four corners.
fn corners_format(is_float: bool) -> vk::Format {
    if is_float { vk::Format::R32G32B32A32_UINT } else { vk::Format::R16G16B16A16_UINT }
}

/// Bytes of the images of a map.
pub fn packed_bytes(map: &HeightMap) -> u64 {
    let shape = Shape::new(map.width(), map.height());
    let area = |(width, height): (u32, u32)| u64::from(width) * u64::from(height);
    let corners = if matches!(map.samples(), Samples::Float(_)) { 16 } else { 8 };
    corners * area(shape.corners_extent()) + 4 * area(shape.coarser_extent())
}

/// True where the device's images are as large as those of every map, and its memory has room for all of them.
fn fits<'a>(device: &Device, maps: impl Iterator<Item = &'a HeightMap> + Clone) -> bool {
    let physical = device.physical();
    let most = physical.limits.max_image_dimension2_d;
    let heaps = &physical.memory.memory_heaps[..physical.memory.memory_heap_count as usize];
    let heap_bytes = heaps.iter().map(|heap| heap.size).max().unwrap_or(0);
    let bytes: u64 = maps.clone().map(packed_bytes).sum();
    let (width, height) = maps.fold((0, 0), |(width, height), map| {
        let (columns, rows) = Shape::new(map.width(), map.height()).corners_extent();
        (width.max(columns), height.max(rows))
    });
    width.max(height) <= most && bytes <= heap_bytes / HEAP_DIVISOR
}

/// The choice of `corners` for rays that walk over these maps on the device.
pub fn is_packed<'a>(
    device: &Device,
    parameters: &Parameters,
    maps: impl Iterator<Item = &'a HeightMap> + Clone,
) -> bool {
    parameters.interpolation == Interpolation::Bilinear
        && match parameters.corners {
            Corners::Packed => true,
            Corners::Image => false,
            Corners::Auto => fits(device, maps),
        }
}

/// A line for maps that no room was found for.
pub fn no_room<'a>(maps: impl Iterator<Item = &'a HeightMap>) -> String {
    format!(
        "`corners` packed would take {} MiB, more than a quarter of the device's memory, or images larger than its own: rays read \
         the image of the levels",
        maps.map(packed_bytes).sum::<u64>() >> 20
    )
}

impl Packed {
    /// Of a map that the device holds, with the highest values in the layer above the data's.
    ///
    /// # Errors
    /// [`Error::Limit`] for a map whose images are larger than the device's, [`Error::OutOfMemory`], errors of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, label: &str, levels: &Levels) -> Result<Self, Error> {
        let shape = levels.shape;
        let (x, y) = shape.axis();
        let packing = Packing {
            last: [shape.width as i32 - 1, shape.height as i32 - 1],
            beside: [(y * shape.width) as i32, (x * shape.height) as i32],
            axis: [x as i32, y as i32],
            top: shape.top as i32,
            is_float: levels.is_float.into(),
        };
        let mut recorder = Recorder::new(shaders.device())?;
        let mut draw = |name: &'static str, format, (width, height)| {
            let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::STORAGE;
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, width, height).usage(usage);
            let target = Image::new(shaders.device(), desc)?.view()?;
            let pass = Pass::graphics(name, "3", "common/fullscreen.vert", &format!("terrain/{name}.frag"))
                .with("levels", &levels.view)
                .constants::<Packing>()
                .color(&target, Load::Discard, Blend::Replace)
                .build(shaders)?;
            recorder.run(Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.constants(&packing).vertices(3)))?;
            Ok::<_, Error>(target)
        };
        Ok(Packed {
            corners: draw("corners", corners_format(levels.is_float), shape.corners_extent())?,
            coarser: draw("coarser", HIGHEST, shape.coarser_extent())?,
        })
    }
}
