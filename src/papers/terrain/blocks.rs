//! The uniform blocks of the shaders.

use bytemuck::Zeroable;
use glam::{IVec2, UVec2, Vec2, Vec3};

use super::drape::Draping;
use super::ground::{Ground, REPEATED};
use super::parameters::{Interpolation, Normals, Parameters};
use super::placement::Rays;
use super::pyramid::Shape;
use super::scene::Scene;
use crate::host_block;

/// Kinds of base in [`TerrainBlock::base_kind`].
pub const PLANE: i32 = 0;
pub const CYLINDER: i32 = 1;
const ELLIPSOID: i32 = 2;

host_block! {
    /// A map and how the camera sees it, in the map's frame (see [`Ground::to_frame`]).
    pub struct TerrainBlock {
        /// The camera, in the map's frame.
        pub eye: Vec3,
        /// Nodes that a pixel covers at a depth of 1 m; on steep terrain those over which it rises by a pixel.
        pub pixel_nodes: f32,
        /// To the middle of pixel (0, 0), for 1 m of depth.
        pub corner_direction: Vec3,
        /// Near plane of what is rasterised.
        pub near_m: f32,
        /// The direction's change from a pixel to the next on the right.
        pub right_step: Vec3,
        /// Number of the map.
        pub map_index: i32,
        /// The direction's change from a pixel to the next below.
        pub down_step: Vec3,
        /// [`PLANE`], [`CYLINDER`] or an ellipsoid.
        pub base_kind: i32,
        /// For 1 m.
        pub to_sun: Vec3,
        /// Between nodes where they are farthest apart.
        pub widest_spacing_m: f32,
        /// The frame's axes in the world; see [`Ground::axes`].
        pub east: Vec3,
        /// Metres for a unit of height.
        pub height_unit_m: f32,
        /// The frame's second axis.
        pub up: Vec3,
        /// Height of the base.
        pub base_height: f32,
        /// The frame's third axis.
        pub south: Vec3,
        /// The height above the surface that counts as met where a root is approached.
        pub height_tolerance: f32,
        /// The lowest height that a ray may meet.
        pub lowest: f32,
        /// The highest height that a ray may meet.
        pub highest: f32,
        /// Bound of the rounding of a place, in nodes.
        pub rounding_nodes: f32,
        /// Bound of the rounding of a height.
        pub rounding_height: f32,
        /// Between columns and between rows.
        pub spacing_m: Vec2,
        /// Columns and rows.
        pub size: IVec2,
        /// Along which the levels lie in their layer: (1, 0) or (0, 1).
        pub level_axis: IVec2,
        /// The number of levels above the data.
        pub top_level: i32,
        /// 1 where texels are the bits of floats.
        pub is_float: i32,
        /// Of the ellipse of a meridian. This and what follows is 0 over a plane.
        pub semi_major_m: f32,
        /// Of that ellipse; negative where it is prolate.
        pub squared_eccentricity: f32,
        /// Of the latitude of the map's middle.
        pub sine_latitude: f32,
        /// Of the latitude of the map's middle.
        pub cosine_latitude: f32,
        /// The map's middle.
        pub middle_node: Vec2,
        /// From the axis to the map's middle.
        pub axis_distance_m: f32,
        /// Smallest radius of curvature.
        pub smallest_radius_m: f32,
        /// Nodes for a radian of longitude along u and of latitude along v; on a cylinder along v for a metre.
        pub nodes_per_unit: Vec2,
        /// Of a meridian's radius over a radian of latitude, as a fraction of it.
        pub curvature_change: f32,
        /// Of the quadric through the highest height: constant, squares and linear terms, off the axis and along it.
        pub shell_constant: f32,
        /// Of the shell, off the axis and along it.
        pub shell_squares: Vec2,
        /// Of the shell, off the axis and along it.
        pub shell_linear: Vec2,
        /// Of the base's quadric, whose constant is 0.
        pub base_squares: Vec2,
        /// Of the base's quadric.
        pub base_linear: Vec2,
        /// Nodes that a pixel covers, below which normals are those between the nodes'.
        pub node_normals_below: f32,
        /// The tiles that are read are marked.
        pub marks_tiles: i32,
        /// Metres towards the sun that lead out of the map from what is drawn in its place, for 1 m of depth.
        pub error_m: f32,
    }
}

host_block! {
    /// The light and the camera in the world.
    pub struct LightBlock {
        /// To the middle of pixel (0, 0), for 1 m of depth.
        pub corner_direction: Vec3,
        /// Near plane of what is rasterised.
        pub near_m: f32,
        /// The direction's change from a pixel to the next on the right.
        pub right_step: Vec3,
        /// The sky's light, as a fraction of its full strength.
        pub sky_strength: f32,
        /// The direction's change from a pixel to the next below.
        pub down_step: Vec3,
        /// By haze.
        pub extinction_per_m: f32,
        /// A unit vector.
        pub to_sun: Vec3,
        /// The lowest height above the base.
        pub lowest_m: f32,
        /// Linear.
        pub haze_color: Vec3,
        /// The highest height above the base.
        pub highest_m: f32,
        /// Columns and rows of the first map that the draped picture covers.
        pub drape_cells: Vec2,
        /// Column and row of the first map at which its north-west corner lies.
        pub drape_corner: Vec2,
        /// World, metres.
        pub eye: Vec3,
        /// 0 without a picture; 1 with one whose corners lie on the first map's, 2 with one in a place of its own.
        pub draping: i32,
        /// Of a curved base, world, metres. This and the axis are 0 over a plane.
        pub base_center: Vec3,
        /// Metres between lines of equal height, or the heights' exaggeration.
        pub drape_scale: f32,
        /// Of a curved base, a unit vector.
        pub base_axis: Vec3,
        /// Distance from the base up to the maps' height 0, metres.
        pub zero_m: f32,
        /// Of a curved base, off the axis and along it.
        pub base_radii: Vec2,
        /// [`PLANE`], [`CYLINDER`] or an ellipsoid.
        pub base_kind: i32,
        /// Columns of the first map that fill a whole turn under a picture with a place of its own; 0 where none do.
        pub drape_turn: f32,
    }
}

/// Bound of a coordinate's rounding, as a fraction of the largest number that it is made of.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;
/// The height above the surface that counts as met where a root is approached, as a fraction of a cell.
const HEIGHT_TOLERANCE: f64 = 2.5e-4;
/// The haze's colour, linear: the sky at the horizon.
const HAZE: Vec3 = Vec3::new(0.42, 0.53, 0.66);
/// The strength of the sky's light.
const SKY: f32 = 0.45;

impl TerrainBlock {
    /// Of the map that is number `index`; `rays` are the world's.
    pub fn new(ground: &Ground, parameters: &Parameters, is_float: bool, index: u32, rays: &Rays, near_m: f32) -> Self {
        let framed = rays.in_map(&ground.to_frame);
        let shape = ground.shape;
        let side = f64::from(shape.width.max(shape.height));
        let (spacing, unit) = (ground.spacing_m.min_element(), ground.unit_m);
        // How far away the eye is, in nodes and in heights.
        let (away, above) = match &ground.curve {
            None => (framed.eye.x.abs().max(framed.eye.y.abs()), framed.eye.z.abs()),
            Some(_) => (2.0 * framed.eye.length() / spacing, framed.eye.length() / unit),
        };
        let overshoot = match parameters.interpolation {
            Interpolation::Bilinear => 0.0,
            Interpolation::Bicubic => ground.overshoot,
        };
        // The ground is solid down to the base, so a ray may meet it below its lowest sample.
        let lowest = (ground.lowest - overshoot).min(ground.base);
        let highest = ground.highest + overshoot;
        let height = [lowest, highest, ground.base, above].into_iter().map(f64::abs).fold(0.0, f64::max);
        let [east, up, south] = ground.axes.map(|axis| axis.as_vec3());
        let (axis_u, axis_v) = shape.axis();
        let to_sun = ground.to_frame.transform_vector3(parameters.sun.direction().as_dvec3());
        let flat = TerrainBlock {
            eye: framed.eye.as_vec3(),
            pixel_nodes: (rays.pixel_m() / ground.spacing_m.max_element() / ground.steepness) as f32,
            corner_direction: framed.corner.as_vec3(),
            near_m,
            right_step: framed.across.as_vec3(),
            map_index: index as i32,
            down_step: framed.down.as_vec3(),
            base_kind: PLANE,
            to_sun: to_sun.as_vec3(),
            widest_spacing_m: ground.spacing_m.max_element() as f32,
            east,
            height_unit_m: unit as f32,
            up,
            base_height: ground.base as f32,
            south,
            height_tolerance: (HEIGHT_TOLERANCE * spacing / unit) as f32,
            lowest: lowest as f32,
            highest: highest as f32,
            rounding_nodes: (side.max(away) * ROUNDING) as f32,
            rounding_height: (height * ROUNDING) as f32,
            spacing_m: ground.spacing_m.as_vec2(),
            size: UVec2::new(shape.width, shape.height).as_ivec2(),
            level_axis: UVec2::new(axis_u, axis_v).as_ivec2(),
            top_level: shape.top as i32,
            is_float: is_float.into(),
            node_normals_below: match (parameters.normals, parameters.interpolation) {
                (Normals::Surface, _) | (Normals::Auto, Interpolation::Bicubic) => 0.0,
                // In the nodes of `pixel_nodes`.
                (Normals::Auto, Interpolation::Bilinear) => (1.0 / ground.steepness) as f32,
                (Normals::Nodes, _) => f32::MAX,
            },
            ..Zeroable::zeroed()
        };
        let Some(curve) = &ground.curve else { return flat };
        let (sine, cosine) = curve.latitude_rad.sin_cos();
        let (shell, base) = (curve.shell(), curve.ground());
        TerrainBlock {
            base_kind: if curve.is_cylinder { CYLINDER } else { ELLIPSOID },
            semi_major_m: curve.a as f32,
            squared_eccentricity: curve.squared_eccentricity as f32,
            sine_latitude: sine as f32,
            cosine_latitude: cosine as f32,
            middle_node: curve.middle.as_vec2(),
            axis_distance_m: curve.off_m as f32,
            smallest_radius_m: curve.smallest_radius_m as f32,
            nodes_per_unit: curve.steps.as_vec2(),
            curvature_change: curve.bend as f32,
            shell_constant: shell.constant as f32,
            shell_squares: shell.squares.as_vec2(),
            shell_linear: shell.linear.as_vec2(),
            base_squares: base.squares.as_vec2(),
            base_linear: base.linear.as_vec2(),
            ..flat
        }
    }
}

impl LightBlock {
    /// `near_m` is the near plane of what is rasterised.
    pub fn new(scene: &Scene, parameters: &Parameters, rays: &Rays, near_m: f32) -> Self {
        let (lowest_m, highest_m) = scene.range_m;
        // A level map has one tint: over a range of nothing, rounding would choose it.
        let rounding_m = 1e-3 * lowest_m.abs().max(1.0);
        // Of a map that goes once round the outermost columns repeat others.
        let (shape, repeated) = scene
            .grounds
            .first()
            .map_or((Shape::new(2, 2), 0), |ground| (ground.shape, if ground.closes { REPEATED } else { 0 }));
        let columns = if repeated > 0 { shape.width - 2 * repeated } else { shape.width - 1 };
        let (corner, cells) = match scene.draping {
            Some(Draping::Placed { corner, cells }) => (corner, cells),
            _ => {
                let half_cell = if repeated > 0 { 0.5 } else { 0.0 };
                (Vec2::new(-half_cell, 0.0), UVec2::new(columns, shape.height - 1).as_vec2())
            }
        };
        let first = scene.grounds.first();
        let curve = first.and_then(|ground| ground.curve.as_ref().map(|curve| (ground, curve)));
        LightBlock {
            corner_direction: rays.corner.as_vec3(),
            near_m,
            right_step: rays.across.as_vec3(),
            sky_strength: SKY,
            down_step: rays.down.as_vec3(),
            extinction_per_m: parameters.extinction_per_km(&scene.extent) / 1000.0,
            to_sun: parameters.sun.direction(),
            lowest_m: lowest_m as f32,
            haze_color: HAZE,
            highest_m: highest_m.max(lowest_m + rounding_m) as f32,
            drape_cells: cells,
            drape_corner: corner + Vec2::new(repeated as f32, 0.0),
            eye: rays.eye.as_vec3(),
            draping: match scene.draping {
                Some(Draping::WholeMap) => 1,
                Some(Draping::Placed { .. }) => 2,
                _ => 0,
            },
            base_center: curve.map_or(Vec3::ZERO, |(ground, curve)| {
                ground.to_frame.inverse().transform_point3(curve.center()).as_vec3()
            }),
            drape_scale: match scene.draping {
                Some(Draping::Contours { interval_m }) => interval_m,
                Some(Draping::Hypsometric { scale }) => scale,
                _ => 0.0,
            },
            base_axis: curve.map_or(Vec3::ZERO, |(ground, _)| ground.axes[2].as_vec3()),
            zero_m: -scene.base_level_m as f32,
            base_radii: curve.map_or(Vec2::ZERO, |(_, curve)| curve.radii_m().as_vec2()),
            base_kind: curve.map_or(PLANE, |(_, curve)| if curve.is_cylinder { CYLINDER } else { ELLIPSOID }),
            drape_turn: match scene.draping {
                Some(Draping::Placed { .. }) if repeated > 0 => columns as f32,
                _ => 0.0,
            },
        }
    }

    /// The place of a hit on the first map as a fraction of the draped picture's sides.
    pub fn drape_fraction(&self, place: Vec2) -> Vec2 {
        let mut cells = place - self.drape_corner;
        // Across the seam of a map that goes once round, the picture goes on.
        if self.drape_turn > 0.0 {
            cells.x -= self.drape_turn * (cells.x / self.drape_turn).floor();
        }
        cells / self.drape_cells
    }
}
