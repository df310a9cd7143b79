//! Normals by accumulation (chapter 9) beside those by differences of heights (section 6.4): degrees from the isosurface's own.
//!
//! As in Iwasaki et al. (2006), whom the thesis follows, every accepted grid point is a surfel whose normal is the density's gradient; normals
//! are added up with the weights of eq. 6.3.

use glam::DVec3;
use serde_json::{Value, json};

use super::super::setup::Setup;
use super::surface::{Densities, Fields, fields};
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::{median, percentile};
use crate::papers::lava::SurfaceKind;

/// The grid of densities in metres.
struct Grid<'a> {
    densities: &'a Densities,
    spacing_m: DVec3,
}

impl Grid<'_> {
    /// Of the density, for each metre: central differences, one-sided at the grid's sides.
    fn gradient(&self, point: [usize; 3]) -> DVec3 {
        let along = |axis: usize| {
            let (mut before, mut after) = (point, point);
            before[axis] = point[axis].saturating_sub(1);
            after[axis] = (point[axis] + 1).min(self.densities.points[axis] - 1);
            let [low, high] = [before, after].map(|[i, j, k]| self.densities.at(i, j, k));
            let steps = (after[axis] - before[axis]) as f64;
            if steps > 0.0 { (high - low) / (steps * self.spacing_m[axis]) } else { 0.0 }
        };
        DVec3::new(along(0), along(1), along(2))
    }

    /// Out of the outermost isosurface over a column; none where there is none.
    fn isosurface(&self, [i, k]: [usize; 2]) -> Option<DVec3> {
        let height = self.densities.outermost([i, k], [0.0; 2])?;
        let (below, part) = (height.floor() as usize, height.fract());
        let above = (below + 1).min(self.densities.points[1] - 1);
        let gradient = self.gradient([i, below, k]).lerp(self.gradient([i, above, k]), part);
        (-gradient).try_normalize()
    }

    /// Sums of the unit normals of a column's accepted points: of all, and of the topmost.
    fn surfels(&self, [i, k]: [usize; 2]) -> [DVec3; 2] {
        let accepted = (0..self.densities.points[1]).filter(|&j| self.densities.at(i, j, k) >= self.densities.rho);
        let normals = accepted.map(|j| (-self.gradient([i, j, k])).normalize_or_zero());
        normals.fold([DVec3::ZERO; 2], |[sum, _], normal| [sum + normal, normal])
    }

    /// The normals of all columns from the surfels around them, by all accepted points and by the topmost.
    fn accumulated(&self, radius_m: f64) -> Vec<[DVec3; 2]> {
        let [columns, _, rows] = self.densities.points;
        let sums: Vec<[DVec3; 2]> =
            (0..rows).flat_map(|k| (0..columns).map(move |i| [i, k])).map(|column| self.surfels(column)).collect();
        let reach = |spacing_m: f64| (radius_m / spacing_m) as usize;
        let (across, along) = (reach(self.spacing_m.x), reach(self.spacing_m.z));
        let gathered = |i: usize, k: usize| {
            let mut normals = [DVec3::ZERO; 2];
            for z in k.saturating_sub(along)..=(k + along).min(rows - 1) {
                for x in i.saturating_sub(across)..=(i + across).min(columns - 1) {
                    let (dx, dz) = (x.abs_diff(i) as f64 * self.spacing_m.x, z.abs_diff(k) as f64 * self.spacing_m.z);
                    let ratio = dx.hypot(dz) / radius_m;
                    let weight = if ratio <= 1.0 { (-4.5 * ratio * ratio).exp() } else { 0.0 };
                    let [all, topmost] = sums[z * columns + x];
                    normals = [normals[0] + weight * all, normals[1] + weight * topmost];
                }
            }
            normals.map(DVec3::normalize_or_zero)
        };
        (0..rows).flat_map(|k| (0..columns).map(move |i| (i, k))).map(|(i, k)| gathered(i, k)).collect()
    }
}

/// Degrees between normals and the isosurface's, over the columns inside the border.
fn degrees(grid: &Grid<'_>, border_m: f64, normal: impl Fn(usize) -> DVec3) -> Vec<f64> {
    let [columns, _, rows] = grid.densities.points;
    let is_inside = |at: usize, count: usize, spacing_m: f64| {
        let place_m = (at as f64 + 0.5) * spacing_m;
        // The differences reach one column farther.
        place_m.min(count as f64 * spacing_m - place_m) > border_m + spacing_m
    };
    let all = (0..rows).flat_map(|k| (0..columns).map(move |i| (i, k)));
    let inside = all.filter(|&(i, k)| is_inside(i, columns, grid.spacing_m.x) && is_inside(k, rows, grid.spacing_m.z));
    let mut found: Vec<f64> = inside
        .filter_map(|(i, k)| Some(grid.isosurface([i, k])?.angle_between(normal(k * columns + i)).to_degrees()))
        .filter(|degrees| degrees.is_finite())
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// A row for each way.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn table(machine: &mut Machine, setup: &Setup, frame: u32) -> Result<ResultTable, Error> {
    let p = &setup.parameters;
    let border_m = f64::from(p.border_m);
    let mut rows: Vec<Vec<Value>> = Vec::new();
    let mut add = |name: &str, surface: &str, degrees: &[f64]| {
        let measured = [median(degrees), percentile(degrees, 0.95)];
        rows.push(vec![json!(name), json!(surface), json!(degrees.len()), json!(measured[0]), json!(measured[1])]);
    };
    for kind in [SurfaceKind::Mean, SurfaceKind::Crossing] {
        let Fields { surface, densities, .. } = fields(machine, setup, kind, frame)?;
        let spacing_m = p.space_m.as_dvec3() / DVec3::from_array(densities.points.map(|n| n as f64));
        let grid = Grid { densities: &densities, spacing_m };
        let drawn =
            |at: usize| surface.get(at).map_or(DVec3::Y, |&[x, y, z, _]| DVec3::new(x.into(), y.into(), z.into()));
        let is_mean = kind == SurfaceKind::Mean;
        add("differences of heights", if is_mean { "mean" } else { "crossing" }, &degrees(&grid, border_m, drawn));
        if is_mean {
            let accumulated = grid.accumulated(f64::from(p.radius_m));
            add("accumulated", "all accepted points", &degrees(&grid, border_m, |at| accumulated[at][0]));
            add("accumulated", "topmost accepted points", &degrees(&grid, border_m, |at| accumulated[at][1]));
        }
    }
    Ok(ResultTable {
        title: "Normals by differences and by accumulation: degrees from the outermost isosurface's",
        columns: &["normals", "surface", "columns", "median degrees", "p95 degrees"],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A density that falls linearly upwards and along x has one normal everywhere, however it is made.
    #[test]
    fn a_plane_has_one_normal() {
        let densities = Densities::of([9, 8, 7], 4.0, |i, j, k| 8.0 - j as f64 - 0.5 * i as f64 + 0.25 * k as f64);
        let grid = Grid { densities: &densities, spacing_m: DVec3::new(0.1, 0.2, 0.1) };
        // Downwards of (-5, -5, 2.5) a metre.
        let expected = DVec3::new(5.0, 5.0, -2.5).normalize();
        assert!(grid.gradient([3, 3, 3]).normalize().distance(-expected) < 1e-9);
        assert!(grid.isosurface([4, 3]).unwrap().distance(expected) < 1e-9);
        for [all, topmost] in grid.accumulated(0.25) {
            assert!(all.distance(expected) < 1e-9 && topmost.distance(expected) < 1e-9, "{all} {topmost}");
        }
        let found = degrees(&grid, 0.0, |_| DVec3::Y);
        assert!(
            !found.is_empty() && found.iter().all(|d| (d - expected.angle_between(DVec3::Y).to_degrees()).abs() < 1e-6)
        );
    }
}
