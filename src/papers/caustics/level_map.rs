//! The level map (sections 5.2.2 and 5.2.3): one position map and one diffuse map, however many planes.

use std::sync::Arc;

use super::bounding_box::BoundingBox;
use super::cast::Cast;
use super::caustics_map::CausticsMap;
use super::combine::Combine;
use super::depth_profile::DepthProfile;
use super::diffuse_map::DiffuseMap;
use super::hidden_surfaces::HiddenSurfaces;
use super::illumination_volumes::IlluminationVolumes;
use super::intersections::Scope;
use super::parameters::Variant;
use super::position_diffuse_map::PositionDiffuseMap;
use super::position_map::PositionMap;
use super::read_positions::ReadPositions;
use super::receiver::LitReceiver;
use super::reference_planes::ReferencePlanes;
use super::resources::{Context, LIGHT};
use super::shadow_map::ShadowMap;
use super::underwater::Underwater;
use super::water_surface::WaterSurface;
use crate::gpu::{Error, ImageView};

/// Passes of the variants `level-map`, `level-map-smart`, `culled` and `hit`.
pub struct LevelMap {
    /// Shared by all receivers.
    pub slicing: Slicing,
    /// One for each receiver under each light.
    pub receivers: Vec<ReceiverPasses>,
}

/// First pass, by the way in which boxes are sliced.
pub enum Slicing {
    Uniform(ReferencePlanes),
    /// Later, by the depth profile, or not at all.
    Boxes(BoundingBox),
}

/// Passes of one receiver under one light.
pub struct ReceiverPasses {
    /// Position and diffuse map.
    pub maps: ReceiverMaps,
    /// Surfaces that the first hides from the light's box, by `hit` with several layers.
    pub hidden: Option<HiddenSurfaces>,
    /// `None` for uniform planes.
    pub smart: Option<SmartSlicing>,
    /// I_c of the receiver's planes.
    pub caustics_map: CausticsMap,
    /// I_c x I_d.
    pub combine: Combine,
    /// The same of each hidden surface.
    pub combine_hidden: Vec<Combine>,
    /// The combined map on the receiver.
    pub cast: Cast,
}

/// Position and diffuse map, in one pass with two targets or one after the other (figures 5-6 and 5-5).
pub enum ReceiverMaps {
    OnePass(PositionDiffuseMap),
    TwoPasses(PositionMap, DiffuseMap),
}

/// Planes by the depth profile (sections 4.7.2 and 5.2.3).
pub struct SmartSlicing {
    /// Heights for the host.
    pub read_positions: ReadPositions,
    /// Levels and the planes that follow from them.
    pub depth_profile: DepthProfile,
}

impl LevelMap {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        context: Context<'_>,
        variant: Variant,
        lit_receivers: &[LitReceiver],
        water: &WaterSurface,
        volumes: &[IlluminationVolumes],
        shadow_maps: &[ShadowMap],
        underwater: &Underwater,
    ) -> Result<Self, Error> {
        let slicing = match variant {
            Variant::LevelMapSmart | Variant::Hit => Slicing::Boxes(BoundingBox::new()),
            Variant::Culled if context.parameters.smart_on_device().is_some() => Slicing::Boxes(BoundingBox::new()),
            _ => Slicing::Uniform(ReferencePlanes::new()),
        };
        let passes = |lit: &LitReceiver| {
            let volumes = &volumes[lit.light];
            let maps = if context.parameters.mrt {
                ReceiverMaps::OnePass(PositionDiffuseMap::new(context, lit)?)
            } else {
                let position_map = PositionMap::new(context, lit)?;
                let diffuse_map = DiffuseMap::new(context, lit, &position_map.depth)?;
                ReceiverMaps::TwoPasses(position_map, diffuse_map)
            };
            let smart = match variant {
                Variant::LevelMapSmart => Some(SmartSlicing {
                    read_positions: ReadPositions::new(context, maps.position())?,
                    depth_profile: DepthProfile::new(context.parameters),
                }),
                _ => None,
            };
            let hidden = match variant {
                Variant::Hit => HiddenSurfaces::new(context, lit, maps.position())?,
                _ => None,
            };
            let shadows = shadow_maps.get(lit.light);
            let caustics_map = match variant {
                Variant::Culled => CausticsMap::culled(context, lit, volumes, water, maps.position(), shadows)?,
                Variant::Hit => {
                    let scope = Scope { context, volumes, water, position_map: Some(maps.position()), shadows };
                    CausticsMap::hit(scope, lit, maps.position(), hidden.as_ref())?
                }
                _ => CausticsMap::new(context, volumes, water, Some(maps.position()), shadows)?,
            };
            let combined_map = context.map("combined-map", LIGHT)?;
            let combine = Combine::new(context, volumes, &caustics_map.map, maps.diffuse(), combined_map)?;
            let combine_hidden = hidden.as_ref().map_or(Ok(Vec::new()), |hidden| {
                let of_layer = |layer| {
                    let (caustics, diffuse) =
                        (hidden.caustics.image().layer(layer)?, hidden.diffuse.image().layer(layer)?);
                    Combine::new(context, volumes, &caustics, &diffuse, hidden.combined.image().layer(layer)?)
                };
                (0..hidden.count()).map(of_layer).collect::<Result<_, Error>>()
            })?;
            let cast = Cast::new(context, lit, &combine.map, maps.position(), hidden.as_ref(), underwater)?;
            Ok(ReceiverPasses { maps, hidden, smart, caustics_map, combine, combine_hidden, cast })
        };
        let receivers = lit_receivers.iter().map(passes).collect::<Result<_, Error>>()?;
        Ok(LevelMap { slicing, receivers })
    }
}

impl ReceiverPasses {
    /// The maps that can be dumped.
    pub fn targets(&self) -> [(&'static str, &Arc<ImageView>); 4] {
        [
            ("position-map", self.maps.position()),
            ("diffuse-map", self.maps.diffuse()),
            ("caustics-map", &self.caustics_map.map),
            ("combined-map", &self.combine.map),
        ]
    }
}

impl ReceiverMaps {
    fn position(&self) -> &Arc<ImageView> {
        match self {
            ReceiverMaps::OnePass(both) => &both.position,
            ReceiverMaps::TwoPasses(position_map, _) => &position_map.position,
        }
    }

    fn diffuse(&self) -> &Arc<ImageView> {
        match self {
            ReceiverMaps::OnePass(both) => &both.diffuse,
            ReceiverMaps::TwoPasses(_, diffuse_map) => &diffuse_map.diffuse,
        }
    }
}
