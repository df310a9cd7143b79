//! The level map of one receiver under one light (section 5.2.2): one position map and one diffuse map, however many
//! planes.

use std::sync::Arc;

use super::illumination::{IlluminationVolumes, Ray};
use super::maps::{self, BACKGROUND, BLACK, FAR};
use super::method::{CombineConstants, Method, Site, draw_floor, floor_pass};
use super::parameters::{Parameters, SmartParameters};
use super::planes::{DepthProfile, SmartPlacement};
use super::receiver::{LitReceiver, MapConstants, PlaneConstants, Vertex};
use crate::gpu::{
    Blend, Buffer, BufferDesc, DepthTest, Error, Frame, ImageView, Load, Location, Pass, PassInfo, ShaderLibrary,
};

/// The maps and passes of the method.
pub struct LevelMap {
    /// Position and diffuse map in one pass with two targets, or one after the other (figures 5-6 and 5-5).
    maps: Vec<Pass>,
    caustics_map: Pass,
    /// The caustics map's triangles with an empty fragment stage.
    floor: Pass,
    combine: Pass,
    position: Arc<ImageView>,
    diffuse: Arc<ImageView>,
    caustics: Arc<ImageView>,
    combined: Arc<ImageView>,
    smart: Option<SmartSlicing>,
}

/// Depth profiling and the placement that follows from it (sections 4.7.2 and 5.2.3).
struct SmartSlicing {
    read_positions: Pass,
    depth_profile: Arc<PassInfo>,
    heights: Arc<Buffer>,
    profile: DepthProfile,
    parameters: SmartParameters,
    planes: u32,
}

impl SmartSlicing {
    fn new(
        shaders: &ShaderLibrary,
        label: &str,
        position: &Arc<ImageView>,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let size_bytes = 4 * u64::from(parameters.map_size) * u64::from(parameters.map_size);
        let desc = BufferDesc::new(format!("{label}/position-readback"), size_bytes).location(Location::Readback);
        let heights = Buffer::new(shaders.device(), desc)?;
        Ok(SmartSlicing {
            read_positions: Pass::copy("read-positions", "5.2.3", position, &heights),
            depth_profile: PassInfo::host("depth-profile", "4.7.2", &["position-map"], &["planes"]),
            heights,
            profile: DepthProfile::default(),
            parameters: parameters.smart,
            planes: parameters.planes,
        })
    }

    /// Figure 5-9: the position map is read back, its levels are counted, planes are placed in the valid ones.
    fn slice(&mut self, frame: &mut Frame<'_>, lit: &mut LitReceiver) -> Result<(), Error> {
        frame.copy(&self.read_positions)?;
        frame.wait_for(&self.read_positions)?;
        let height = lit.aligned.extent.y;
        let SmartParameters { levels, placement } = self.parameters;
        // Uniform planes are kept or dropped by their own cells.
        let levels = if placement == SmartPlacement::Kept { self.planes } else { levels };
        frame.host(&self.depth_profile, || {
            self.heights.read(self.heights.size_bytes(), |bytes| {
                self.profile.collect(bytemuck::cast_slice(bytes), height, levels);
                self.profile.place(height, self.planes, placement, &mut lit.cells);
            })
        })
    }
}

/// How the box is sliced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slicing {
    /// Uniformly (5.2.2).
    Normal,
    /// Where the receiver is (5.2.3).
    Smart,
}

impl LevelMap {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(site: Site<'_>, slicing: Slicing) -> Result<Self, Error> {
        let Site { shaders, label, lit, water, volumes, nearest, parameters } = site;
        let map = |name: &str, format| maps::map(shaders, format!("{label}/{name}"), format, parameters);
        let position = map("position-map", maps::POSITION)?;
        let diffuse = map("diffuse-map", maps::LIGHT)?;
        let caustics = map("caustics-map", maps::CAUSTICS)?;
        let combined = map("combined-map", maps::LIGHT)?;
        let depth = map("position-depth", maps::DEPTH)?;

        let draw = |name, fragment| {
            Pass::graphics(name, "4.2.2", "caustics/receiver-map.vert", fragment)
                .vertices::<Vertex>(&lit.receiver.vertices)
                .indices(&lit.receiver.indices)
                .constants::<MapConstants>()
                .depth(&depth, FAR, DepthTest::LessWrite)
        };
        let maps = if parameters.mrt {
            vec![
                draw("position-diffuse-map", "caustics/position-diffuse-map.frag")
                    .color(&position, BACKGROUND, Blend::Replace)
                    .color(&diffuse, BLACK, Blend::Replace)
                    .build(shaders)?,
            ]
        } else {
            vec![
                draw("position-map", "caustics/position-map.frag")
                    .color(&position, BACKGROUND, Blend::Replace)
                    .build(shaders)?,
                draw("diffuse-map", "caustics/diffuse-map.frag")
                    .color(&diffuse, BLACK, Blend::Replace)
                    .build(shaders)?,
            ]
        };

        let caustics_map =
            Pass::graphics("caustics-map", "4.4, 4.5", "caustics/caustics-map.vert", "caustics/caustics-map.frag")
                .vertices::<Ray>(&volumes.rays)
                .indices(&water.indices)
                .constants::<PlaneConstants>()
                .with("position_map", &position)
                .with("nearest", nearest)
                .color(&caustics, BLACK, Blend::Add)
                .build(shaders)?;

        let combine = Pass::graphics("combine", "5.2.2", "common/fullscreen.vert", "caustics/combine.frag")
            .constants::<CombineConstants>()
            .with("caustics_map", &caustics)
            .with("diffuse_map", &diffuse)
            .with("nearest", nearest)
            .color(&combined, Load::Discard, Blend::Replace)
            .build(shaders)?;

        let smart = match slicing {
            Slicing::Normal => None,
            Slicing::Smart => Some(SmartSlicing::new(shaders, label, &position, parameters)?),
        };
        let floor = floor_pass(site, &caustics)?;
        Ok(LevelMap { floor, smart, maps, caustics_map, combine, position, diffuse, caustics, combined })
    }
}

impl Method for LevelMap {
    fn create_maps(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        for map in &self.maps {
            frame.graphics(map, |draw| {
                draw.constants(&lit.map_constants(None)).indices(lit.receiver.index_count);
            })?;
        }
        Ok(())
    }

    fn refine_planes(&mut self, frame: &mut Frame<'_>, lit: &mut LitReceiver) -> Result<(), Error> {
        match &mut self.smart {
            Some(smart) => smart.slice(frame, lit),
            None => Ok(()),
        }
    }

    fn depth_profile(&self) -> Option<&[u32]> {
        self.smart.as_ref().map(|smart| smart.profile.histogram.as_slice())
    }

    fn create_caustics(
        &self,
        frame: &mut Frame<'_>,
        lit: &LitReceiver,
        volumes: &IlluminationVolumes,
    ) -> Result<(), Error> {
        frame.graphics(&self.caustics_map, |draw| {
            for cell in &lit.cells {
                draw.constants(&lit.plane_constants(cell, volumes)).indices(volumes.index_count);
            }
        })
    }

    fn draw_floor(&self, frame: &mut Frame<'_>, lit: &LitReceiver, volumes: &IlluminationVolumes) -> Result<(), Error> {
        draw_floor(frame, &self.floor, lit, volumes)
    }

    fn combine(&self, frame: &mut Frame<'_>, lit: &LitReceiver) -> Result<(), Error> {
        frame.graphics(&self.combine, |draw| {
            draw.constants(&CombineConstants::of(lit)).vertices(3);
        })
    }

    fn position_map(&self) -> &Arc<ImageView> {
        &self.position
    }

    fn height_slack_m(&self, _lit: &LitReceiver) -> f32 {
        0.0
    }

    fn combined_map(&self) -> &Arc<ImageView> {
        &self.combined
    }

    fn targets(&self) -> Vec<(&'static str, &Arc<ImageView>)> {
        vec![
            ("position-map", &self.position),
            ("diffuse-map", &self.diffuse),
            ("caustics-map", &self.caustics),
            ("combined-map", &self.combined),
        ]
    }
}
