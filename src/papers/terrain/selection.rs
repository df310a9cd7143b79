//! The choice of patches of the variant `mesh-lod` in a frame (CDLOD, section 3.2): those of the quadtree that the picture may
//! show, each the largest whose error is within the bound on the screen, and none beside one more than twice its size.
//!
//! CDLOD gives each level one range of distances. Here each patch has its own error: with one range for a level the roughest
//! place of the map would decide for all of it.

use glam::{DMat4, DVec2, DVec3};

use super::ground::Ground;
use super::placement::Rays;
use super::quadtree::{Bounds, PATCH_SIDE, Quadtree};
use crate::host_block;

host_block! {
    /// A patch as the vertex stage reads it.
    pub struct Patch {
        /// Its first node.
        pub corner: [i32; 2],
        /// Its level.
        pub shift: i32,
        /// Sides beside a coarser patch: 1 west, 2 east, 4 north, 8 south.
        pub coarser: i32,
    }
}

/// Neighbours of a patch, each with its bit in [`Patch::coarser`].
const SIDES: [(i32, [i32; 2]); 4] = [(1, [-1, 0]), (2, [1, 0]), (4, [0, -1]), (8, [0, 1])];

/// Column and row of a patch in its level.
type Place = (u32, u32);

/// The camera in a map's frame, in metres.
pub struct Viewer<'a> {
    ground: &'a Ground,
    eye: DVec3,
    /// The unit vector of the view's axis.
    forward: DVec3,
    /// Inward normals of planes through the eye: the picture's sides, and the axis.
    planes: [DVec3; 5],
    /// Metres of a pixel at a depth of 1 m.
    pixel_m: f64,
    /// The tangent of the picture's corner from the axis.
    corner_tangent: f64,
}

/// The box around a patch, or the ball where the base is curved; metres in the map's frame.
enum Volume {
    Box { low: DVec3, high: DVec3 },
    Ball { center: DVec3, radius: f64 },
}

impl Volume {
    /// The least and the most of the points along a direction.
    fn along(&self, direction: DVec3) -> (f64, f64) {
        match self {
            Volume::Box { low, high } => {
                let (a, b) = (*low * direction, *high * direction);
                (a.min(b).element_sum(), a.max(b).element_sum())
            }
            Volume::Ball { center, radius } => {
                let (middle, reach) = (center.dot(direction), radius * direction.length());
                (middle - reach, middle + reach)
            }
        }
    }

    fn distance(&self, point: DVec3) -> f64 {
        match self {
            Volume::Box { low, high } => point.distance(point.clamp(*low, *high)),
            Volume::Ball { center, radius } => (point.distance(*center) - radius).max(0.0),
        }
    }
}

impl<'a> Viewer<'a> {
    /// `size` is the picture's, in pixels.
    pub fn new(ground: &'a Ground, rays: &Rays, (width, height): (u32, u32)) -> Self {
        let scale = match &ground.curve {
            None => DVec3::new(ground.spacing_m.x, ground.spacing_m.y, ground.unit_m),
            Some(_) => DVec3::ONE,
        };
        let to_metres = DMat4::from_scale(scale) * ground.to_frame;
        let vector = |v: DVec3| to_metres.transform_vector3(v);
        let (corner, across, down) = (vector(rays.corner), vector(rays.across), vector(rays.down));
        // From the middle of the first pixel to the picture's corners.
        let direction = |x: f64, y: f64| corner + (x - 0.5) * across + (y - 0.5) * down;
        let (right, bottom) = (f64::from(width), f64::from(height));
        let forward = direction(0.5 * right, 0.5 * bottom);
        let inward = |normal: DVec3| normal * normal.dot(forward).signum() / normal.length();
        let planes = [
            inward(down.cross(direction(0.0, 0.0))),
            inward(down.cross(direction(right, 0.0))),
            inward(across.cross(direction(0.0, 0.0))),
            inward(across.cross(direction(0.0, bottom))),
            forward,
        ];
        Viewer {
            ground,
            eye: to_metres.project_point3(rays.eye),
            forward,
            planes,
            pixel_m: across.length().min(down.length()),
            corner_tangent: (direction(0.0, 0.0) - forward).length(),
        }
    }

    fn volume(&self, first: DVec2, end: DVec2, bounds: &Bounds) -> Volume {
        let ground = self.ground;
        let Some(curve) = &ground.curve else {
            let spacing = ground.spacing_m;
            return Volume::Box {
                low: (first * spacing).extend(bounds.low * ground.unit_m),
                high: (end * spacing).extend(bounds.high * ground.unit_m),
            };
        };
        let [low_m, high_m] = [bounds.low, bounds.high].map(|height| (height - ground.base) * ground.unit_m);
        let center = curve.point(0.5 * (first + end), 0.5 * (low_m + high_m));
        let corner = |number: u32| {
            let along = |bit: u32, low: f64, high: f64| if number & bit == 0 { low } else { high };
            let place = DVec2::new(along(1, first.x, end.x), along(2, first.y, end.y));
            curve.point(place, along(4, low_m, high_m)).distance(center)
        };
        let reach = (0..8).map(corner).fold(0.0, f64::max);
        Volume::Ball { center, radius: reach + curve.bend_m(0.5 * (end - first), high_m - low_m, high_m.max(0.0)) }
    }

    fn is_seen(&self, volume: &Volume) -> bool {
        let rounding_m = 1e-9 * self.eye.length();
        self.planes.iter().all(|plane| volume.along(*plane).1 >= plane.dot(self.eye) - rounding_m)
    }

    /// A bound of the pixels between a place of the map in the volume that the picture shows and one `error_m` above or below:
    /// those move by the error across the view over the depth, and by the error along it times the tangent of their angle.
    fn pixels(&self, volume: &Volume, error_m: f64) -> f64 {
        let depth_m = volume.along(self.forward).0 - self.forward.dot(self.eye);
        let tangent = self.corner_tangent;
        let factor = match self.ground.curve {
            None => {
                let up = self.forward.z.abs();
                (1.0 - up * up).max(0.0).sqrt() + tangent * up
            }
            Some(_) => tangent.hypot(1.0),
        };
        let by_depth = if depth_m > 0.0 { factor / depth_m } else { f64::INFINITY };
        // What the picture shows is at least the cosine of its corner as deep as it is far.
        let by_distance = (1.0 + tangent * tangent) / volume.distance(self.eye);
        if error_m > 0.0 { by_depth.min(by_distance) * error_m / self.pixel_m } else { 0.0 }
    }
}

/// The patches of a frame.
pub struct Selection {
    tree: Quadtree,
    /// Of each patch of each level: whether it is divided.
    divided: Vec<Vec<bool>>,
    /// Those that are, of each level.
    lists: Vec<Vec<Place>>,
    /// The patches that are drawn, those at the map's border first.
    pub patches: Vec<Patch>,
    /// Number of patches at the border.
    pub at_border: usize,
}

impl Selection {
    pub fn new(tree: Quadtree) -> Self {
        Selection {
            divided: tree.levels.iter().map(|level| vec![false; level.patches.len()]).collect(),
            lists: vec![Vec::new(); tree.levels.len()],
            tree,
            patches: Vec::new(),
            at_border: 0,
        }
    }

    /// Patches that are drawn, by level from the map's own cells on.
    pub fn by_level(&self) -> Vec<u64> {
        let mut counts = vec![0; self.tree.levels.len()];
        for patch in &self.patches {
            counts[patch.shift as usize] += 1;
        }
        counts
    }

    /// Chooses the patches of a view whose error is at most `most_pixels`, where the map's own cells allow it.
    pub fn choose(&mut self, viewer: &Viewer<'_>, most_pixels: f64) {
        for (level, list) in self.lists.iter_mut().enumerate() {
            for (x, y) in list.drain(..) {
                self.divided[level][(y * self.tree.levels[level].columns + x) as usize] = false;
            }
        }
        let top = self.tree.levels.len() - 1;
        self.divide(viewer, most_pixels, top);
        self.balance(viewer);
        self.collect(viewer, top);
    }

    fn bounds(&self, level: usize, (x, y): Place) -> &Bounds {
        let of_level = &self.tree.levels[level];
        &of_level.patches[(y * of_level.columns + x) as usize]
    }

    fn volume(&self, viewer: &Viewer<'_>, level: usize, (x, y): Place) -> Volume {
        let [columns, rows] = self.tree.size;
        let node = |patch: u32, nodes: u32| f64::from((patch * (PATCH_SIDE << level)).min(nodes - 1));
        let at = |x: u32, y: u32| DVec2::new(node(x, columns), node(y, rows));
        viewer.volume(at(x, y), at(x + 1, y + 1), self.bounds(level, (x, y)))
    }

    fn is_divided(&self, level: usize, (x, y): Place) -> bool {
        self.divided[level][(y * self.tree.levels[level].columns + x) as usize]
    }

    /// Divides a patch, and those around it so that it is there.
    fn set_divided(&mut self, level: usize, (x, y): Place) {
        for (level, up) in (level..self.tree.levels.len()).zip(0..) {
            let place = (x >> up, y >> up);
            if self.is_divided(level, place) {
                break;
            }
            self.divided[level][(place.1 * self.tree.levels[level].columns + place.0) as usize] = true;
            self.lists[level].push(place);
        }
    }

    fn children(&self, level: usize, (x, y): Place) -> impl Iterator<Item = (usize, Place)> + use<> {
        let finer = &self.tree.levels[level - 1];
        let (columns, rows) = (finer.columns, finer.rows);
        [(0, 0), (1, 0), (0, 1), (1, 1)]
            .into_iter()
            .map(move |(right, below)| (2 * x + right, 2 * y + below))
            .filter(move |(x, y)| *x < columns && *y < rows)
            .map(move |place| (level - 1, place))
    }

    fn neighbour(&self, level: usize, (x, y): Place, [right, below]: [i32; 2]) -> Option<Place> {
        let (x, y) = (x.checked_add_signed(right)?, y.checked_add_signed(below)?);
        let of_level = &self.tree.levels[level];
        (x < of_level.columns && y < of_level.rows).then_some((x, y))
    }

    fn divide(&mut self, viewer: &Viewer<'_>, most_pixels: f64, top: usize) {
        let mut open = vec![(top, (0, 0))];
        while let Some((level, place)) = open.pop() {
            let volume = self.volume(viewer, level, place);
            let error_m = viewer.error_m(level, self.bounds(level, place));
            if level > 0 && viewer.is_seen(&volume) && viewer.pixels(&volume, error_m) > most_pixels {
                self.set_divided(level, place);
                open.extend(self.children(level, place));
            }
        }
    }

    /// Divides further, until none is more than twice as large as one beside it.
    fn balance(&mut self, viewer: &Viewer<'_>) {
        for level in 0..self.lists.len() - 1 {
            for place in self.lists[level].clone() {
                for (_, side) in SIDES {
                    let Some((x, y)) = self.neighbour(level, place, side) else { continue };
                    let parent = (x / 2, y / 2);
                    if !self.is_divided(level + 1, parent) && viewer.is_seen(&self.volume(viewer, level + 1, parent)) {
                        self.set_divided(level + 1, parent);
                    }
                }
            }
        }
    }

    fn collect(&mut self, viewer: &Viewer<'_>, top: usize) {
        self.patches.clear();
        let mut inside = Vec::new();
        let mut open = vec![(top, (0, 0))];
        while let Some((level, (x, y))) = open.pop() {
            if self.is_divided(level, (x, y)) {
                open.extend(self.children(level, (x, y)));
                continue;
            }
            if !viewer.is_seen(&self.volume(viewer, level, (x, y))) {
                continue;
            }
            let neighbours = SIDES.map(|(bit, side)| (bit, self.neighbour(level, (x, y), side)));
            let is_coarser = |&(_, neighbour): &(i32, Option<Place>)| {
                neighbour.is_some_and(|(x, y)| {
                    let parent = (x / 2, y / 2);
                    level < top
                        && !self.is_divided(level + 1, parent)
                        && viewer.is_seen(&self.volume(viewer, level + 1, parent))
                })
            };
            let coarser = neighbours.iter().filter(|neighbour| is_coarser(neighbour)).map(|(bit, _)| bit).sum();
            let corner = [x, y].map(|patch| (patch * (PATCH_SIDE << level)) as i32);
            let patch = Patch { corner, shift: level as i32, coarser };
            let is_inside = neighbours.iter().all(|(_, neighbour)| neighbour.is_some());
            if is_inside { &mut inside } else { &mut self.patches }.push(patch);
        }
        self.at_border = self.patches.len();
        self.patches.append(&mut inside);
    }
}

impl Viewer<'_> {
    /// The most by which a patch's triangles are off; on a curved base they are chords as well.
    fn error_m(&self, level: usize, bounds: &Bounds) -> f64 {
        let unit_m = self.ground.unit_m;
        let half_cell = DVec2::splat(0.5 * f64::from(1_u32 << level));
        let chord_m = self.ground.curve.as_ref().map_or(0.0, |curve| {
            let rise_m = (bounds.high - bounds.low) * unit_m;
            curve.bend_m(half_cell, rise_m, ((bounds.high - self.ground.base) * unit_m).max(0.0))
        });
        bounds.error * unit_m + chord_m
    }
}
