//! The three surfaces over the same densities, beside the isosurface that marching would find: the first place from above
//! at which the density is rho.
//!
//! Between grid points the density is linear in the six tetrahedra of a cell (Kuhn's division), so that the isosurface is
//! that of marching tetrahedra; on the cell's edges its vertices are those of marching cubes.

use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::image::{Raster, Samples};
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Choice;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::{median, percentile};
use crate::measure::study::Study;
use crate::measure::{Error, Paper, picture};
use crate::papers::lava::{SurfaceKind, Variant};

/// Places along each side of a cell.
const PLACES: usize = 4;

/// Densities of a frame at its grid points.
struct Densities {
    /// Points along x, y and z.
    points: [usize; 3],
    /// Layers of four planes, rows along z, points along x, planes of the layer.
    values: Vec<f32>,
    rho: f64,
}

impl Densities {
    fn at(&self, i: usize, j: usize, k: usize) -> f64 {
        let [x, _, z] = self.points;
        f64::from(self.values.get((((j / 4) * z + k) * x + i) * 4 + j % 4).copied().unwrap_or(0.0))
    }

    /// The first place from above at which the density is rho, in planes from the lowest, in cell `i`, `k` at the
    /// fractions `u` and `w` of its sides; none without one between the planes.
    fn outermost(&self, [i, k]: [usize; 2], [u, w]: [f64; 2]) -> Option<f64> {
        let corner = |dx: usize, j: usize, dz: usize| {
            let last = |index: usize, count: usize| index.min(count - 1);
            self.at(last(i + dx, self.points[0]), j, last(k + dz, self.points[2]))
        };
        let in_cell = |j: usize, v: f64| {
            // Kuhn: from the corner 0 along the axes in the order of their fractions, the largest first.
            let mut order = [(u, 0), (v, 1), (w, 2)];
            order.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut step = [0; 3];
            let mut value = corner(0, j, 0);
            let mut before = value;
            for (fraction, axis) in order {
                step[axis] = 1;
                let here = corner(step[0], j + step[1], step[2]);
                value += fraction * (here - before);
                before = here;
            }
            value
        };
        for j in (0..self.points[1].saturating_sub(1)).rev() {
            // The vertical leaves one tetrahedron for another at the height of either fraction.
            let breaks = [1.0, u.max(w), u.min(w), 0.0];
            for pair in breaks.windows(2).filter(|pair| pair[0] > pair[1]) {
                let (high, low) = (in_cell(j, pair[0]), in_cell(j, pair[1]));
                if high < self.rho && low >= self.rho {
                    return Some(j as f64 + pair[1] + (low - self.rho) / (low - high) * (pair[0] - pair[1]));
                }
                if high >= self.rho {
                    // Above the highest plane nothing is known.
                    return None;
                }
            }
        }
        None
    }
}

/// Heights, and signed distances above the isosurface: at the columns of grid points, and between them.
struct Distances {
    heights_m: Vec<f64>,
    /// Planes, above is positive.
    at_columns: Vec<f64>,
    between: Vec<f64>,
    /// Share of the particles inside the border that lie above the surface.
    above: f64,
}

fn floats(raster: &Raster) -> Vec<f32> {
    match raster.samples() {
        Samples::F32(values) => values.clone(),
        _ => Vec::new(),
    }
}

fn distances(machine: &mut Machine, setup: &Setup, kind: SurfaceKind, frame: u32) -> Result<Distances, Error> {
    let mut setup = setup.clone();
    setup.parameters.surface = kind;
    // Nothing is looked at.
    (setup.parameters.splats, setup.parameters.width, setup.parameters.height) = ([1; 2], 1, 1);
    let scene = setup.load()?;
    let mut built = build(machine, &setup, &scene, Variant::Paper)?;
    picture::render(machine, &mut built.paper, frame)?;
    let targets = built.paper.targets();
    let read = |name: &str| -> Result<Vec<f32>, Error> {
        let target = targets.iter().find(|t| t.name == name);
        target.map_or(Ok(Vec::new()), |target| Ok(floats(&picture::read_target(&machine.device, target)?)))
    };
    let (heights, positions, values) = (read("normal-height")?, read("positions")?, read("density")?);
    let p = &setup.parameters;
    let points = p.density.map(|n| n as usize);
    let densities = Densities { points, values, rho: f64::from(p.rho()) };
    let [x, y, z] = points;
    let space = p.space_m.as_dvec3();
    let plane_m = space.y / y as f64;
    let height_m = |i: usize, k: usize| {
        let texel = k.min(z - 1) * x + i.min(x - 1);
        f64::from(heights.get(4 * texel + 3).copied().unwrap_or(0.0))
    };
    // Inside the border, where nothing sinks.
    let border_m = f64::from(p.border_m);
    let is_inside = |at: f64, side: f64| at >= border_m && at <= side - border_m;
    let mut found = Distances { heights_m: Vec::new(), at_columns: Vec::new(), between: Vec::new(), above: 0.0 };
    for (k, i) in (0..z.saturating_sub(1)).flat_map(|k| (0..x.saturating_sub(1)).map(move |i| (k, i))) {
        for (n, m) in (0..PLACES).flat_map(|n| (0..PLACES).map(move |m| (n, m))) {
            let [u, w] = [m, n].map(|at| at as f64 / PLACES as f64);
            let at = [(i as f64 + u + 0.5) / x as f64 * space.x, (k as f64 + w + 0.5) / z as f64 * space.z];
            if !(is_inside(at[0], space.x) && is_inside(at[1], space.z)) {
                continue;
            }
            let row = |k: usize| height_m(i, k) * (1.0 - u) + height_m(i + 1, k) * u;
            let ours_m = row(k) * (1.0 - w) + row(k + 1) * w;
            let is_column = n == 0 && m == 0;
            if is_column {
                found.heights_m.push(ours_m);
            }
            if let Some(outermost) = densities.outermost([i, k], [u, w]) {
                let off = ours_m / plane_m - 0.5 - outermost;
                if is_column { found.at_columns.push(off) } else { found.between.push(off) }
            }
        }
    }
    let mut counts = [0u32; 2];
    for place in positions.chunks_exact(4).take(p.particles as usize) {
        let [px, py, pz] = [place[0], place[1], place[2]].map(f64::from);
        if is_inside(px, space.x) && is_inside(pz, space.z) {
            let column = |at: f64, side: f64, count: usize| ((at / side * count as f64) as usize).min(count - 1);
            counts[0] += 1;
            counts[1] += u32::from(py > height_m(column(px, space.x, x), column(pz, space.z, z)));
        }
    }
    found.above = f64::from(counts[1]) / f64::from(counts[0]);
    Ok(found)
}

/// A row for each surface.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn table(machine: &mut Machine, setup: &Setup, frame: u32) -> Result<ResultTable, Error> {
    let row = |kind: SurfaceKind| -> Result<Vec<Value>, Error> {
        let found = distances(machine, setup, kind, frame)?;
        let mean = |values: &[f64]| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let height_m = mean(&found.heights_m);
        let squares: Vec<f64> =
            found.heights_m.iter().map(|height| (height - height_m.unwrap_or(0.0)).powi(2)).collect();
        let size = |values: &[f64]| {
            let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
            sizes.sort_by(f64::total_cmp);
            sizes
        };
        let (columns, between) = (size(&found.at_columns), size(&found.between));
        Ok(vec![
            json!(kind.name()),
            json!(height_m),
            json!(mean(&squares).map(f64::sqrt)),
            json!(found.above),
            json!(median(&columns)),
            json!(percentile(&columns, 0.95)),
            json!(median(&between)),
            json!(percentile(&between, 0.95)),
            json!(mean(&found.between)),
        ])
    };
    let rows = SurfaceKind::ALL.iter().copied().map(row).collect::<Result<_, _>>()?;
    Ok(ResultTable {
        title: "Surfaces beside the outermost isosurface: distances along the vertical, in planes of the grid",
        columns: &[
            "surface",
            "height m",
            "relief m",
            "particles above",
            "at columns, median",
            "at columns, p95",
            "between, median",
            "between, p95",
            "between, signed mean",
        ],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A density that is linear over the whole grid: its isosurface is a plane.
    #[test]
    fn a_linear_density_has_a_plane() {
        let points = [5, 8, 6];
        let value = |i: usize, j: usize, k: usize| 10.0 - j as f32 + 0.25 * i as f32 - 0.5 * k as f32;
        let mut values = vec![0.0; 5 * 6 * 8];
        for (j, k, i) in (0..8).flat_map(|j| (0..6).flat_map(move |k| (0..5).map(move |i| (j, k, i)))) {
            values[(((j / 4) * 6 + k) * 5 + i) * 4 + j % 4] = value(i, j, k);
        }
        let densities = Densities { points, values, rho: 6.5 };
        for (i, k) in (0..4).flat_map(|i| (0..4).map(move |k| (i, k))) {
            for (u, w) in [(0.0, 0.0), (0.5, 0.25), (0.25, 0.75), (0.75, 0.0)] {
                let expected = 3.5 + 0.25 * (i as f64 + u) - 0.5 * (k as f64 + w);
                let found = densities.outermost([i, k], [u, w]).unwrap();
                assert!((found - expected).abs() < 1e-9, "{i} {k} {u} {w}: {found} {expected}");
            }
        }
        assert_eq!(Densities { rho: 20.0, ..densities }.outermost([1, 1], [0.5, 0.5]), None);
    }
}
