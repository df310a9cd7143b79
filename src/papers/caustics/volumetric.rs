//! The volumetric method for one receiver under one light (section 5.2.1, after Iwasaki et al.): a slice image of the
//! receiver for every sample plane, each multiplied by a caustics map of its own.

use std::sync::Arc;

use super::illumination::{IlluminationVolumes, Ray};
use super::maps::{self, BLACK, FAR};
use super::method::{CombineConstants, Method, Site, draw_floor, floor_pass};
use super::receiver::{LitReceiver, MapConstants, PlaneConstants, Vertex};
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct SlicesConstants {
        count: u32,
        top: f32,
        cell_height: f32,
    }
}

/// The illumination map and the passes of the method.
pub struct Volumetric {
    /// One for every plane: same pass, next layer.
    slice_images: Vec<Pass>,
    caustics_map: Pass,
    /// The caustics map's triangles with an empty fragment stage.
    floor: Pass,
    multiply: Vec<Pass>,
    combine_slices: Pass,
    slices: Arc<ImageView>,
    caustics: Arc<ImageView>,
    position: Arc<ImageView>,
    combined: Arc<ImageView>,
}

impl Volumetric {
    /// # Errors
    /// What the Vulkan layer answers; [`Error::Limit`] for more planes than an array has layers.
    pub fn new(site: Site<'_>) -> Result<Self, Error> {
        let Site { shaders, label, lit, water, volumes, nearest, parameters } = site;
        let map = |name: &str, format| maps::map(shaders, format!("{label}/{name}"), format, parameters);
        let caustics = map("caustics-map", maps::CAUSTICS)?;
        let position = map("position-map", maps::POSITION)?;
        let combined = map("combined-map", maps::LIGHT)?;
        let depth = map("slice-depth", maps::DEPTH)?;
        // A map of this size exists by now: what a device may still refuse is the number of layers.
        let desc = maps::map_desc(format!("{label}/illumination-map"), maps::LIGHT, parameters);
        let illumination_map = Image::new(shaders.device(), desc.layers(parameters.planes));
        let illumination_map = illumination_map.map_err(|error| error.set_by("--planes"))?;
        let slices = illumination_map.view()?;
        let layers = (0..parameters.planes).map(|i| illumination_map.layer(i)).collect::<Result<Vec<_>, _>>()?;

        let slice_image =
            Pass::graphics("slice-images", "5.2.1", "caustics/receiver-map.vert", "caustics/diffuse-map.frag")
                .vertices::<Vertex>(&lit.receiver.vertices)
                .indices(&lit.receiver.indices)
                .constants::<MapConstants>()
                .color(&layers[0], BLACK, Blend::Replace)
                .depth(&depth, FAR, DepthTest::LessWrite)
                .build(shaders)?;
        let caustics_map =
            Pass::graphics("caustics-map", "5.2.1", "caustics/caustics-map.vert", "caustics/caustics-map-plane.frag")
                .vertices::<Ray>(&volumes.rays)
                .indices(&water.indices)
                .constants::<PlaneConstants>()
                .color(&caustics, BLACK, Blend::Add)
                .build(shaders)?;
        let multiply = Pass::graphics("multiply", "5.2.1", "common/fullscreen.vert", "caustics/multiply.frag")
            .constants::<CombineConstants>()
            .with("caustics_map", &caustics)
            .with("nearest", nearest)
            .color(&layers[0], Load::Keep, Blend::Multiply)
            .build(shaders)?;
        let combine_slices =
            Pass::graphics("combine-slices", "5.2.1", "common/fullscreen.vert", "caustics/combine-slices.frag")
                .constants::<SlicesConstants>()
                .with("illumination_map", &slices)
                .with("nearest", nearest)
                .color(&combined, Load::Discard, Blend::Replace)
                .color(&position, Load::Discard, Blend::Replace)
                .build(shaders)?;

        let each_layer = |pass: &Pass, load: Load| {
            layers.iter().map(|layer| pass.rebind().color(0, layer, load).build(shaders)).collect::<Result<Vec<_>, _>>()
        };
        let floor = floor_pass(site, &caustics)?;
        Ok(Volumetric {
            floor,
            slice_images: each_layer(&slice_image, BLACK)?,
            caustics_map,
            multiply: each_layer(&multiply, Load::Keep)?,
            combine_slices,
            slices,
            caustics,
            position,
            combined,
        })
    }
}

impl Method for Volumetric {
    fn create_maps(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        for (slice_image, cell) in self.slice_images.iter().zip(&lit.cells) {
            frame.graphics(slice_image, |draw| {
                draw.constants(&lit.map_constants(Some(cell))).indices(lit.receiver.index_count);
            })?;
        }
        Ok(())
    }

    fn create_caustics(
        &self,
        frame: &mut Frame<'_>,
        lit: &LitReceiver,
        volumes: &IlluminationVolumes,
    ) -> Result<(), Error> {
        for (multiply, cell) in self.multiply.iter().zip(&lit.cells) {
            frame.graphics(&self.caustics_map, |draw| {
                draw.constants(&lit.plane_constants(cell, volumes)).indices(volumes.index_count);
            })?;
            frame.graphics(multiply, |draw| {
                draw.constants(&CombineConstants::of(lit)).vertices(3);
            })?;
        }
        Ok(())
    }

    fn draw_floor(&self, frame: &mut Frame<'_>, lit: &LitReceiver, volumes: &IlluminationVolumes) -> Result<(), Error> {
        draw_floor(frame, &self.floor, lit, volumes)
    }

    fn combine(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        let height = lit.aligned.extent.y;
        let constants = SlicesConstants {
            count: lit.cells.len() as u32,
            top: (height / 2.0) as f32,
            cell_height: (height / lit.cells.len() as f64) as f32,
        };
        frame.graphics(&self.combine_slices, |draw| {
            draw.constants(&constants).vertices(3);
        })
    }

    fn position_map(&self) -> &Arc<ImageView> {
        &self.position
    }

    fn height_slack_m(&self, lit: &LitReceiver) -> f32 {
        // A slice knows its surface to half a cell.
        (lit.aligned.extent.y / (2.0 * lit.cells.len() as f64)) as f32
    }

    fn combined_map(&self) -> &Arc<ImageView> {
        &self.combined
    }

    fn targets(&self) -> Vec<(&'static str, &Arc<ImageView>)> {
        vec![
            ("illumination-map", &self.slices),
            ("caustics-map", &self.caustics),
            ("position-map", &self.position),
            ("combined-map", &self.combined),
        ]
    }
}
