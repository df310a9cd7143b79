//! The frame in which distances to a map's solid are measured: places over its base as points in metres, and back.

use glam::{DVec2, DVec3};

use super::ground::{Ground, REPEATED};

/// A ground in metres: on a plane east, south and up from the first sample; else as [`super::curve::Curve`] has it.
#[derive(Clone, Copy)]
pub struct Solid<'a> {
    ground: &'a Ground,
}

impl<'a> Solid<'a> {
    pub fn new(ground: &'a Ground) -> Self {
        Solid { ground }
    }

    /// The world's point in this frame.
    pub fn framed(&self, world: DVec3) -> DVec3 {
        let framed = self.ground.to_frame.project_point3(world);
        match self.ground.curve {
            Some(_) => framed,
            None => (framed - DVec3::Z * self.ground.base) * self.scale(),
        }
    }

    /// This frame's point in the world.
    pub fn world(&self, framed: DVec3) -> DVec3 {
        let framed = match self.ground.curve {
            Some(_) => framed,
            None => framed / self.scale() + DVec3::Z * self.ground.base,
        };
        self.ground.to_frame.inverse().project_point3(framed)
    }

    /// Metres for the numbers of a plane's frame.
    fn scale(&self) -> DVec3 {
        self.ground.spacing_m.extend(self.ground.unit_m)
    }

    /// F = P + n h (eq. 5, 6) over a place in nodes.
    pub fn point(&self, place: DVec2, height_m: f64) -> DVec3 {
        match &self.ground.curve {
            None => (place * self.ground.spacing_m).extend(height_m),
            Some(curve) => curve.point(place, height_m),
        }
    }

    /// The place in nodes below a point, and its height above the base.
    pub fn place(&self, point: DVec3) -> (DVec2, f64) {
        match &self.ground.curve {
            None => (point.truncate() / self.ground.spacing_m, point.z),
            Some(curve) => curve.place(point),
        }
    }

    /// The derivatives of F along u, v and h, for a node and for a metre; square to each other.
    pub fn axes(&self, place: DVec2, height_m: f64) -> [DVec3; 3] {
        match &self.ground.curve {
            None => [DVec3::X * self.ground.spacing_m.x, DVec3::Y * self.ground.spacing_m.y, DVec3::Z],
            Some(curve) => curve.axes(place, height_m),
        }
    }

    /// The most by which F leaves its tangent where u and v change by up to `reach` nodes and h by up to `rise_m`, to a height of
    /// `height_m` at most.
    pub fn bend_m(&self, reach: DVec2, rise_m: f64, height_m: f64) -> f64 {
        self.ground.curve.as_ref().map_or(0.0, |curve| curve.bend_m(reach, rise_m, height_m))
    }

    /// Metres above the base of one of the map's own numbers.
    pub fn above_base_m(&self, number: f64) -> f64 {
        (number - self.ground.base) * self.ground.unit_m
    }

    /// The shorter side of the map's middle cell, metres.
    pub fn cell_m(&self) -> f64 {
        self.ground.spacing_m.min_element()
    }

    /// The last column and row.
    pub fn last_node(&self) -> DVec2 {
        let shape = self.ground.shape;
        DVec2::new(f64::from(shape.width - 1), f64::from(shape.height - 1))
    }

    /// True of a map that goes once round and has no eastern and western side.
    pub fn closes(&self) -> bool {
        self.ground.closes
    }

    /// The corners of what is searched. Of a map that closes the outermost columns only serve those beside them.
    pub fn span(&self) -> [DVec2; 2] {
        let spare = if self.ground.closes { DVec2::X * f64::from(REPEATED - 1) } else { DVec2::ZERO };
        [spare, self.last_node() - spare]
    }

    /// The point of the sheet below an edge, `axis` 0 for a column and 1 for a row, that is nearest to a point.
    pub fn foot_on_edge(&self, axis: usize, node: f64, point: DVec3) -> DVec3 {
        match &self.ground.curve {
            Some(curve) if axis == 0 => curve.foot_on_column(node, point),
            Some(curve) => curve.foot_on_row(node, point),
            None => {
                let mut foot = point;
                foot[axis] = node * self.ground.spacing_m[axis];
                foot
            }
        }
    }
}
