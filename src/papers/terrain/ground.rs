//! The geometric transformation (eq. 10 and 11): a map over its base surface, as rays see it. The base alone is transformed;
//! heights never are.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4};

use super::curve::Curve;
use super::interpolation::OVERSHOOT;
use super::parameters::Base;
use super::placement::{Extent, Placement};
use super::pyramid::Shape;
use crate::scene::{HeightMap, Samples};

/// Rows of eq. 10 with the one that the print lost: u = x, v = z, h = y.
const T: DMat4 = DMat4::from_cols(DVec4::X, DVec4::Z, DVec4::Y, DVec4::W);

/// Longitude and latitude of the world's origin on an ellipsoid, radians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Origin {
    /// East of the prime meridian.
    pub longitude_rad: f64,
    /// North of the equator.
    pub latitude_rad: f64,
}

impl Origin {
    /// The middle of the first map that knows its place, or where equator and prime meridian meet.
    pub fn of<'a>(maps: impl Iterator<Item = &'a HeightMap>) -> Self {
        maps.filter_map(middle_of).next().unwrap_or_default()
    }
}

/// Longitude and latitude of the middle of a map that knows its place.
fn middle_of(map: &HeightMap) -> Option<Origin> {
    let geographic = map.geographic()?;
    let last = DVec2::new(f64::from(map.width() - 1), f64::from(map.height() - 1));
    let half_deg = last * geographic.step_deg / 2.0;
    Some(Origin {
        longitude_rad: (geographic.west_deg + half_deg.x).to_radians(),
        latitude_rad: (geographic.north_deg - half_deg.y).to_radians(),
    })
}

/// One map as the rays see it.
#[derive(Debug, Clone)]
pub struct Ground {
    /// Size of the map and its levels.
    pub shape: Shape,
    /// World to the map's frame. On a plane u and v in nodes from the first sample and h in the map's own numbers: G = T M. On
    /// a curved base metres from the map's middle: east, off the axis, along it.
    pub to_frame: DMat4,
    /// The frame's axes in the world: on a plane east, up and south; else those of `to_frame`.
    pub axes: [DVec3; 3],
    /// Metres between columns and rows, in the middle of the map.
    pub spacing_m: DVec2,
    /// Metres for a unit of h.
    pub unit_m: f64,
    /// Lowest and highest h, and that of the base.
    pub lowest: f64,
    /// Highest h.
    pub highest: f64,
    /// The base's h.
    pub base: f64,
    /// The most by which Catmull-Rom surfaces pass the lowest and the highest h: next to holes those of their nodes count as well.
    pub overshoot: f64,
    /// Height of a pixel's footprint on the terrain over its width, at least 1: a footprint as wide as a pixel is then higher
    /// than one.
    pub steepness: f64,
    /// None over a plane.
    pub curve: Option<Curve>,
    /// True where the map's columns fill a whole turn, so that the first follows the last. `shape` then has two columns more on
    /// each side, which repeat those of the other.
    pub closes: bool,
}

/// Columns that are repeated on each side of a map that closes: what bicubic interpolation reads beyond a cell, and half a
/// cell.
pub const REPEATED: u32 = 2;
/// The most by which the columns may miss a whole turn, in nodes.
const WHOLE_TURN: f64 = 1e-3;

/// Steep terrain of a map, over its slope's root of the mean square; of maps steeper than one to one.
const STEEP: f64 = 2.0;

/// The slope of a map's steep terrain, metres for a metre, at least 1.
fn steepness(map: &HeightMap) -> f64 {
    f64::max(STEEP * map.slope() - 1.0, 1.0)
}

impl Ground {
    /// `base_level_m` is the map's height at which the base lies.
    pub fn new(map: &HeightMap, placement: Placement, base: Base, origin: Origin, base_level_m: f64) -> Self {
        let (origin_m, unit_m) = match map.samples() {
            Samples::Steps { origin_m, step_m, .. } => (f64::from(*origin_m), f64::from(*step_m)),
            Samples::Float(_) => (0.0, 1.0),
        };
        let shape = Shape::new(map.width(), map.height());
        let middle = DVec2::new(f64::from(shape.width - 1), f64::from(shape.height - 1)) / 2.0;
        let (low_m, high_m) = map.range_m();
        let value = |height_m: f64| (height_m - origin_m) / unit_m;
        let mut ground = Ground {
            shape,
            to_frame: DMat4::IDENTITY,
            axes: [DVec3::X, DVec3::Y, DVec3::Z],
            spacing_m: map.spacing_m(),
            unit_m,
            lowest: value(low_m.into()),
            highest: value(high_m.into()),
            base: value(base_level_m),
            overshoot: (value(high_m.into()) - value(map.lowest_node_m().into())) * OVERSHOOT,
            steepness: steepness(map),
            curve: None,
            closes: false,
        };
        let highest_m = (ground.highest - ground.base) * unit_m;
        let reach_m = (highest_m + ground.overshoot * unit_m).max(0.0);
        match base {
            Base::Plane => {
                let center = DVec3::new(placement.center_m.x, 0.0, placement.center_m.y);
                let scale = DVec3::new(1.0 / ground.spacing_m.x, 1.0 / unit_m, 1.0 / ground.spacing_m.y);
                let model = DMat4::from_translation(DVec3::new(middle.x, ground.base, middle.y))
                    * DMat4::from_scale(scale)
                    * DMat4::from_rotation_y(-placement.yaw_rad)
                    * DMat4::from_translation(-center);
                ground.to_frame = T * model;
                let turn = DMat3::from_rotation_y(placement.yaw_rad);
                ground.axes = ground.axes.map(|axis| turn * axis);
            }
            Base::Cylinder { radius_m } => {
                let radius_m = f64::from(radius_m);
                let angle = placement.center_m.x / radius_m;
                let axis = DVec3::new(0.0, -radius_m, 0.0);
                ground.to_frame = DMat4::from_translation(axis)
                    * DMat4::from_rotation_z(angle)
                    * DMat4::from_translation(DVec3::new(0.0, radius_m, -placement.center_m.y));
                ground.curve = Some(Curve::cylinder(radius_m, ground.spacing_m, middle, reach_m));
                ground.set_axes();
            }
            Base::Ellipsoid { equatorial_m, polar_m } => {
                let (a, b) = (f64::from(equatorial_m), f64::from(polar_m));
                let (place, step_rad) = match (middle_of(map), map.geographic()) {
                    (Some(place), Some(geographic)) => (place, geographic.step_deg.map(f64::to_radians)),
                    _ => {
                        let radii = |latitude: f64| Curve::radii(a, b, latitude);
                        let (across, along) = radii(origin.latitude_rad);
                        let cosine = origin.latitude_rad.cos();
                        let place = Origin {
                            longitude_rad: origin.longitude_rad + placement.center_m.x / (across * cosine),
                            latitude_rad: origin.latitude_rad - placement.center_m.y / along,
                        };
                        let (across, along) = radii(place.latitude_rad);
                        let metres = DVec2::new(across * place.latitude_rad.cos(), along);
                        (place, ground.spacing_m / metres)
                    }
                };
                let curve = Curve::ellipsoid(a, b, place.latitude_rad, step_rad, middle, reach_m);
                let world = Curve::ellipsoid(a, b, origin.latitude_rad, step_rad, middle, reach_m);
                let to_world = world.frame(origin.longitude_rad) * world.tangent();
                ground.to_frame = curve.frame(place.longitude_rad).inverse() * to_world;
                ground.spacing_m = curve.spacing_m();
                ground.curve = Some(curve);
                ground.set_axes();
            }
        }
        ground.close();
        ground
    }

    fn close(&mut self) {
        let Some(curve) = &mut self.curve else { return };
        let columns = f64::from(self.shape.width);
        self.closes = (TAU * curve.steps.x - columns).abs() < WHOLE_TURN;
        if self.closes {
            self.shape = Shape::new(self.shape.width + 2 * REPEATED, self.shape.height);
            curve.middle.x += f64::from(REPEATED);
        }
    }

    /// A line on map `number` of `count` if it goes more than once round its base, or beyond a pole.
    pub fn winding_warning(&self, number: usize, count: usize) -> Option<String> {
        let curve = self.curve.as_ref().filter(|_| !self.closes)?;
        let [columns, rows] = [self.shape.width, self.shape.height].map(|nodes| f64::from(nodes - 1));
        let turns = columns / (TAU * curve.steps.x.abs());
        let from_the_equator = curve.latitude_rad.abs() + rows / 2.0 / curve.steps.y.abs();
        let problem = if turns > 1.0 + WHOLE_TURN {
            format!("goes {turns:.1} times round its base: what lies more than half a turn from its middle is not seen")
        } else if !curve.is_cylinder && from_the_equator > PI / 2.0 + WHOLE_TURN {
            "goes beyond a pole of its base, where its land folds over itself".to_owned()
        } else {
            return None;
        };
        Some(format!("`map` {number} of {count} {problem}; take a larger `base` or a smaller `spacing`"))
    }

    fn set_axes(&mut self) {
        let to_world = self.to_frame.inverse();
        self.axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| to_world.transform_vector3(axis));
    }

    /// F = P + n h (eq. 6): the world's point over a place in nodes at a height in the map's own numbers.
    pub fn point(&self, place: DVec2, height: f64) -> DVec3 {
        let framed = match &self.curve {
            None => DVec3::new(place.x, place.y, height),
            Some(curve) => curve.point(place, (height - self.base) * self.unit_m),
        };
        self.to_frame.inverse().project_point3(framed)
    }

    /// The box around the map in the world.
    pub fn extent(&self) -> Extent {
        let last = DVec2::new(f64::from(self.shape.width - 1), f64::from(self.shape.height - 1));
        // Enough points for a curved base; the corners alone would do on a plane.
        let points = (0..17 * 17).flat_map(|i| {
            let fraction = DVec2::new(f64::from(i % 17), f64::from(i / 17)) / 16.0;
            [self.lowest.min(self.base), self.highest].map(|height| self.point(fraction * last, height))
        });
        Extent::of(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map of 61 x 31 samples whose columns go once round is in order, a wider one and one beyond a pole are told of.
    #[test]
    fn maps_that_go_round_their_base_more_than_once_are_told_of() {
        let warning = |base: Base, spacing_m: [f64; 2]| {
            let map = HeightMap::new(61, 31, Samples::Float(vec![1.0; 61 * 31])).unwrap();
            let map = map.with_spacing_m(spacing_m.into()).unwrap();
            let placement = Placement::default();
            Ground::new(&map, placement, base, Origin::default(), 0.0).winding_warning(2, 3)
        };
        let whole_m = 600.0 * TAU / 60.0;
        let round = Base::Cylinder { radius_m: 600.0 };
        for [across, along] in [[whole_m, 1e5], [TAU * 600.0 / 61.0, 10.0], [1.0, 1.0]] {
            assert_eq!(warning(round, [across, along]), None, "{across}");
            assert_eq!(warning(Base::Plane, [1e3 * across, along]), None);
        }
        let twice = warning(round, [2.0 * whole_m, 1.0]).unwrap();
        assert!(
            twice.starts_with("`map` 2 of 3 goes 2.0 times round its base") && twice.contains("`spacing`"),
            "{twice}"
        );
        let ball = Base::Ellipsoid { equatorial_m: 600.0, polar_m: 600.0 };
        assert_eq!(warning(ball, [whole_m, 600.0 * PI / 30.0]), None);
        assert!(warning(ball, [whole_m, 600.0 * PI / 28.0]).unwrap().contains("beyond a pole"));
        assert!(warning(ball, [1.1 * whole_m, 1.0]).unwrap().contains("1.1 times round"));
    }
}
