//! The pass `normal` (section 4): the normal of the surface that was met, interpolated at the level that was used, and the
//! height there. Once for each map.

use std::sync::Arc;

use ash::vk;
use glam::{Vec2, Vec3, Vec3Swizzles, Vec4};
use rayon::prelude::*;

use super::blocks::{CYLINDER, PLANE, TerrainBlock};
use super::geodesy::meridian;
use super::geometric_transformation::SceneView;
use super::height_field::{Field, FieldWork, HeightField};
use super::hit::{Hit, Surface};
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use super::scene::DeviceScene;
use super::stage::Stage;
use crate::measure::parameter::Choice;
use crate::gpu::{Error, Frame, ImageView, Load, Pass, PassInfo, ShaderLibrary};

/// The pass on the device.
pub struct Normal {
    stage: Stage,
    passes: Vec<Pass>,
    /// Of each pixel the normal in the world, and the height above the base in metres.
    pub target: Arc<ImageView>,
}

impl Normal {
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        stage: Stage,
        parameters: &Parameters,
        scene: &DeviceScene,
        depth: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let target = stage.image(shaders, format!("{label}/normal"), vk::Format::R32G32B32A32_SFLOAT, parameters)?;
        let program = format!("normal-{}", parameters.interpolation.name());
        let mut passes = Vec::new();
        for (i, map) in scene.maps.iter().enumerate() {
            let load = if i == 0 { Load::Discard } else { Load::Keep };
            let resources =
                [("terrain", (&map.terrain).into()), ("levels", (&map.levels.view).into()), ("depth", depth.into())];
            passes.push(stage.pass(("normal", "4"), &program, (&target, load), &resources).build(shaders)?);
        }
        Ok(Normal { stage, passes, target })
    }

    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.passes.iter().try_for_each(|pass| self.stage.record(frame, pass, &self.target))
    }
}

/// The pass on the processor.
pub struct HostNormal {
    info: Arc<PassInfo>,
    width: u32,
    normals: Vec<Vec4>,
}

impl HostNormal {
    pub fn new(parameters: &Parameters) -> Self {
        HostNormal {
            info: PassInfo::host("normal", "4", &["land", "levels", "depth"], &["normal"]),
            width: parameters.width,
            normals: vec![Vec4::ZERO; parameters.pixels()],
        }
    }

    /// Of each pixel the normal in the world, and the height above the base in metres.
    pub fn record(&mut self, frame: &mut Frame<'_>, maps: &[HeightField], view: &SceneView, hits: &[Hit]) -> &[Vec4] {
        let HostNormal { ref info, width, ref mut normals } = *self;
        frame.host(info, || {
            for (map, terrain) in maps.iter().zip(&view.terrains) {
                map.with(Rows { terrain, width, hits, normals });
            }
        });
        normals
    }
}

struct Rows<'a> {
    terrain: &'a TerrainBlock,
    width: u32,
    hits: &'a [Hit],
    normals: &'a mut [Vec4],
}

impl FieldWork for Rows<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let (width, map) = (self.width as usize, self.terrain.map_index as u32);
        let caster = RayCaster { terrain: self.terrain, field, footprint: Footprint::Data };
        self.normals.par_chunks_mut(width).zip(self.hits.par_chunks(width)).enumerate().for_each(|(y, (row, hits))| {
            for (x, (normal, hit)) in row.iter_mut().zip(hits).enumerate().filter(|(_, (_, hit))| hit.map == map) {
                *normal = normal_of(&caster, caster.direction(x as u32, y as u32), hit);
            }
        });
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
            let slope = field.slope(shift, place);
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
