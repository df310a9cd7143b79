//! Collisions of segments and spheres with the terrain, by brute force over all cells.

use crate::papers::terrain::reference::sheet::{Sheet, sheets};
use crate::papers::terrain::reference::{Hit, Part, Ray, Terrain};
use glam::DVec3;

/// Distances to a map are found to this share of its cell.
const TOLERANCE_CELLS: f64 = 1e-6;

/// The contact of a sphere with the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// From the sphere's centre to the solid, in metres; 0 when the centre is in it.
    pub distance_m: f64,
    /// The solid's nearest point; the centre itself when it is inside.
    pub point: DVec3,
    /// The nearest surface.
    pub part: Part,
    /// The map's number; `None` for the base and inside.
    pub map: Option<usize>,
}

impl Terrain {
    /// The first point of the segment from `start` to `end` in the solid.
    pub fn segment(&self, start: DVec3, end: DVec3) -> Option<Hit> {
        let length = (end - start).length();
        let direction = if length > 0.0 { (end - start) / length } else { DVec3::Y };
        self.first_hit(&Ray { origin: start, direction }, [0.0, length])
    }

    /// The solid's nearest point to a sphere's centre, when it is in the sphere; exact to 1e-6 of a cell.
    pub fn sphere(&self, center: DVec3, radius_m: f64) -> Option<Contact> {
        if self.is_solid(center) {
            return Some(Contact { distance_m: 0.0, point: center, part: Part::Inside, map: None });
        }
        let mut foot = self.base.place(center);
        let mut nearest = Contact { distance_m: foot.h, point: center, part: Part::Base, map: None };
        foot.h = 0.0;
        nearest.point = self.base.point(foot);
        for (number, map) in self.maps.iter().enumerate() {
            let tolerance_m = self.cell_m(map) * TOLERANCE_CELLS;
            for (part, sheet) in sheets(self, map) {
                let within = nearest.distance_m.min(radius_m + tolerance_m);
                if let Some((distance_m, point)) = nearest_on(&sheet, center, within, tolerance_m) {
                    nearest = Contact { distance_m, point, part, map: Some(number) };
                }
            }
        }
        (nearest.distance_m <= radius_m).then_some(nearest)
    }
}

/// The nearest point of a sheet nearer than `within`: squares that cannot hold a nearer one are dropped, others quartered.
fn nearest_on(sheet: &Sheet<'_>, center: DVec3, within: f64, tolerance_m: f64) -> Option<(f64, DVec3)> {
    let mut nearest = None;
    let mut least = within;
    let mut stack = vec![sheet.whole()];
    while let Some(square) = stack.pop() {
        let view = sheet.view(&square, center);
        if view.distance_m < least {
            least = view.distance_m;
            nearest = Some((view.distance_m, view.point));
        }
        if view.at_least_m >= least - tolerance_m {
            continue;
        }
        let [first, second] = square.map(|side| side.halves());
        let quarters = first.into_iter().flat_map(|p| second.map(|q| [p, q]));
        let mut quarters: Vec<_> = quarters.map(|q| (sheet.view(&q, center).distance_m, q)).collect();
        quarters.sort_by(|a, b| b.0.total_cmp(&a.0));
        stack.extend(quarters.into_iter().map(|(_, quarter)| quarter));
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::terrain::reference::fixtures::{Dice, grid_of, random_grid};
    use crate::papers::terrain::reference::{Base, Grid, Interpolation, Place};
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    #[test]
    fn a_tilted_plane_and_a_wall_are_at_their_distances() {
        let map = grid_of([9, 9], [0.0; 2], [1.0; 2], |u, _| 10.0 + u);
        let terrain = Terrain::new(Base::Plane, Interpolation::Bilinear, vec![map], Some(0.0));
        let center = DVec3::new(3.0, 15.0, 4.2);
        let contact = terrain.sphere(center, 2.0).unwrap();
        assert!((contact.distance_m - 2.0_f64.sqrt()).abs() < 1e-6, "{contact:?}");
        assert_eq!((contact.part, contact.map), (Part::Surface, Some(0)));
        assert!((contact.point - DVec3::new(4.0, 14.0, 4.2)).length() < 1e-2);
        assert_eq!(terrain.sphere(center, 1.414), None);
        let beside = terrain.sphere(DVec3::new(-0.5, 4.0, 4.0), 1.0).unwrap();
        assert!((beside.distance_m - 0.5).abs() < 1e-6 && beside.part == Part::Wall);
        let below = terrain.sphere(DVec3::new(-3.0, 0.25, 4.0), 1.0).unwrap();
        assert_eq!((below.distance_m, below.part, below.map), (0.25, Part::Base, None));
        let corner = terrain.sphere(DVec3::new(-3.0, 5.0, -4.0), 6.0).unwrap();
        assert!((corner.distance_m - 5.0).abs() < 1e-6 || corner.part == Part::Base);
        assert_eq!(terrain.sphere(DVec3::new(3.0, 12.0, 3.0), 0.0).unwrap().part, Part::Inside);
    }

    #[test]
    fn a_constant_height_on_a_ball_is_at_the_distance_of_a_larger_ball() {
        let base = Base::Ellipsoid { equatorial_m: 10.0, polar_m: 10.0 };
        let map = grid_of([9, 5], [-PI, -FRAC_PI_2], [TAU / 8.0, PI / 4.0], |_, _| 2.0);
        let terrain = Terrain::new(base, Interpolation::Bilinear, vec![map], Some(0.0));
        let mut dice = Dice::new(3);
        for _ in 0..20 {
            let center = dice.direction() * dice.between(12.5, 20.0);
            let contact = terrain.sphere(center, 100.0).unwrap();
            assert!((contact.distance_m - (center.length() - 12.0)).abs() < 1e-5, "{contact:?}");
        }
    }

    /// The least distance to points of the map's surface `1 / fine` of a cell apart.
    fn sampled(terrain: &Terrain, map: &Grid, center: DVec3, fine: usize) -> f64 {
        let steps = map.size.map(|n| (n - 1) * fine);
        let place = |axis: usize, n: usize| map.origin[axis] + map.spacing[axis] * n as f64 / fine as f64;
        let mut least = f64::INFINITY;
        for (i, j) in (0..=steps[1]).flat_map(|j| (0..=steps[0]).map(move |i| (i, j))) {
            let uv = [place(0, i), place(1, j)];
            let h = terrain.height_above_base(map, uv);
            least = least.min((terrain.base.point(Place { uv, h }) - center).length());
        }
        least
    }

    #[test]
    fn no_sample_of_the_surface_is_nearer_than_the_contact() {
        let mut dice = Dice::new(4);
        let cylinder = Base::Cylinder { radius_m: 6.0 };
        for (number, interpolation) in
            [Interpolation::Bilinear, Interpolation::Bicubic].into_iter().cycle().take(24).enumerate()
        {
            let base = if number % 4 < 2 { Base::Plane } else { cylinder };
            let map = random_grid([6, 5], number as u64, 2.0);
            let map = if base.is_periodic() { Grid { spacing: [0.2, 1.0], ..map } } else { map };
            let terrain = Terrain::new(base, interpolation, vec![map.clone()], Some(-1.0));
            let uv = [dice.between(0.5, 4.5) * map.spacing[0], dice.between(0.5, 3.5)];
            let center = base.point(Place { uv, h: dice.between(3.5, 4.5) });
            let contact = terrain.sphere(center, 100.0).unwrap();
            let nearest = sampled(&terrain, &map, center, 48);
            assert!(contact.distance_m <= nearest + 2.0 * TOLERANCE_CELLS, "{contact:?} {nearest}");
            if contact.part == Part::Surface {
                assert!(contact.distance_m > nearest - 0.05, "{contact:?} {nearest}");
                let place = base.place(contact.point);
                assert!((place.h - terrain.height_above_base(&map, place.uv)).abs() < 1e-9);
            }
            let fits = contact.distance_m - 1e-3;
            assert_eq!(terrain.sphere(center, fits), None);
        }
    }

    #[test]
    fn segments_end_where_they_end() {
        let map = grid_of([5, 5], [0.0; 2], [1.0; 2], |_, _| 3.0);
        let terrain = Terrain::new(Base::Plane, Interpolation::Bicubic, vec![map], Some(0.0));
        let top = DVec3::new(2.2, 5.0, 2.2);
        assert_eq!(terrain.segment(top, DVec3::new(2.2, 3.001, 2.2)), None);
        let hit = terrain.segment(top, DVec3::new(2.2, 2.999, 2.2)).unwrap();
        assert!((hit.t - 2.0).abs() < 1e-12 && hit.part == Part::Surface);
        assert_eq!(terrain.segment(top, top), None);
        let inside = DVec3::new(1.0, 1.0, 1.0);
        assert_eq!(terrain.segment(inside, inside).unwrap().part, Part::Inside);
    }
}
