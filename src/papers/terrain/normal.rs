//! The pass `normal` (section 4): the normal of the surface that was met, interpolated at the level that was used, and the
//! height there. Once for each map.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec3Swizzles, Vec4};

use super::blocks::{CYLINDER, PLANE, TerrainBlock};
use super::geodesy::meridian;
use super::geometric_transformation::SceneView;
use super::height_field::HeightField;
use super::hit::{Hit, Surface};
use super::host::{HostPass, PixelWork};
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::DeviceScene;
use super::stage::{Build, PixelPass, Traversal, VECTOR};
use crate::gpu::{Error, Frame, ImageView, Load, PassInfo};
use crate::measure::parameter::Choice;

/// The pass on the device. Its target has the normal of each pixel in the world, and the height above the base in metres.
///
/// # Errors
/// Errors of the Vulkan layer.
pub fn normal(build: &Build<'_>, scene: &DeviceScene, depth: &Arc<ImageView>) -> Result<PixelPass, Error> {
    let target = build.image("normal", VECTOR)?;
    let interpolation = build.parameters.interpolation.name();
    let program = match build.traversal {
        Traversal::Tiles => format!("normal-tiled-{interpolation}"),
        Traversal::Halving | Traversal::Cells => format!("normal-{interpolation}"),
    };
    let mut passes = Vec::new();
    for map in &scene.maps {
        let load = if passes.is_empty() { Load::Discard } else { Load::Keep };
        let own = [("terrain", (&map.terrain).into()), ("depth", depth.into())];
        let resources = [&own[..], &map.levels.resources()].concat();
        passes.push(build.pass(("normal", "4"), &program, (&target, load), &resources)?);
    }
    Ok(PixelPass { stage: build.stage, passes, target })
}

/// The pass on the processor.
pub struct HostNormal(HostPass<Vec4>);

impl HostNormal {
    pub fn new(parameters: &Parameters) -> Self {
        let info = PassInfo::host("normal", "4", &["land", "levels", "depth"], &["normal"]);
        HostNormal(HostPass::new(info, parameters, Vec4::ZERO))
    }

    /// The normal of each pixel in the world, and the height above the base in metres.
    pub fn record(&mut self, frame: &mut Frame<'_>, scene: (&[HeightField], &SceneView), hits: &[Hit]) -> &[Vec4] {
        self.0.record(frame, scene, (None, Footprint::Data), &Normals(hits))
    }
}

struct Normals<'a>(&'a [Hit]);

impl PixelWork<Vec4> for Normals<'_> {
    fn run<T: Texel>(&self, caster: &RayCaster<'_, T>, (x, y): (u32, u32), index: usize, normal: &mut Vec4) {
        let hit = &self.0[index];
        if hit.map == caster.terrain.map_index as u32 {
            *normal = normal_of(caster, caster.direction(x, y), hit);
        }
    }
}

/// East, up and south where the map is at `place`, as directions of the map's frame, and metres between nodes there.
struct Local {
    east: Vec3,
    up: Vec3,
    south: Vec3,
    spacing_m: Vec2,
}

impl Local {
    fn at(terrain: &TerrainBlock, place: Vec2, height_m: f32) -> Self {
        let (off_m, steps) = (terrain.axis_distance_m, terrain.nodes_per_unit);
        let (s, c) = ((place.x - terrain.middle_node.x) / steps.x).sin_cos();
        let east = Vec3::new(c, -s, 0.0);
        match terrain.base_kind {
            PLANE => Local { east: Vec3::X, up: Vec3::Y, south: Vec3::Z, spacing_m: terrain.spacing_m },
            CYLINDER => Local {
                east,
                up: Vec3::new(s, c, 0.0),
                south: Vec3::Z,
                spacing_m: Vec2::new((off_m + height_m) / steps.x, 1.0 / steps.y.abs()),
            },
            _ => {
                let foot = meridian(terrain, (place.y - terrain.middle_node.y) / steps.y);
                let radii = Vec2::new((foot.across + height_m) * foot.cosine.max(1e-6), foot.radius + height_m);
                Local {
                    east,
                    up: Vec3::new(foot.cosine * s, foot.cosine * c, foot.sine),
                    south: Vec3::new(foot.sine * s, foot.sine * c, -foot.cosine),
                    spacing_m: radii / steps.abs(),
                }
            }
        }
    }
}

/// The normal of the surface that was met, in the world, and the height above the base in metres.
pub fn normal_of<T: Texel>(caster: &RayCaster<'_, T>, direction: Vec3, hit: &Hit) -> Vec4 {
    let (terrain, field, shift) = (caster.terrain, &caster.field, hit.shift as i32);
    let unit_m = terrain.height_unit_m;
    let place = Vec2::from_array(hit.place);
    let height_m = (field.height(shift, place) - terrain.base_height) * unit_m;
    let local = Local::at(terrain, place, height_m);
    let normal = match hit.surface {
        Surface::Sky | Surface::Base => local.up,
        Surface::Terrain => {
            let is_between = hit.depth_m * terrain.pixel_nodes < terrain.node_normals_below;
            let slope = if is_between { field.slope_between_nodes(shift, place) } else { field.slope(shift, place) };
            let slope = slope * ((-shift as f32).exp2() * unit_m) / local.spacing_m;
            local.up - slope.x * local.east - slope.y * local.south
        }
        Surface::WallWest => -local.east,
        Surface::WallEast => local.east,
        Surface::WallNorth => -local.south,
        Surface::WallSouth => local.south,
        Surface::Inside if terrain.base_kind != PLANE => -direction,
        Surface::Inside => -(direction * terrain.spacing_m.extend(unit_m)).xzy(),
    };
    let turned = normal.x * terrain.east + normal.y * terrain.up + normal.z * terrain.south;
    let above_m = if matches!(hit.surface, Surface::Sky | Surface::Base) { 0.0 } else { height_m };
    turned.normalize().extend(above_m)
}
