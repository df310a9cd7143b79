//! The three surfaces over the same densities, beside the isosurface that marching would find: the first place from above
//! at which the density is rho.
//!
//! Between grid points the density is linear in the six tetrahedra of a cell (Kuhn's division), so that the isosurface is
//! that of marching tetrahedra; on the cell's edges its vertices are those of marching cubes.

use std::sync::Arc;

use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::gpu::ImageView;
use crate::gpu::transfer::read_image;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::Choice;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::{median, percentile};
use crate::measure::study::Study;
use crate::measure::{Error, picture};
use crate::papers::lava::{SurfaceKind, Variant};

/// Places along each side of a cell.
const PLACES: usize = 4;

/// Densities of a frame at its grid points.
pub struct Densities {
    /// Points along x, y and z.
    pub points: [usize; 3],
    /// Layers of four planes, rows along z, points along x, planes of the layer.
    values: Vec<f32>,
    /// Density that is accepted.
    pub rho: f64,
}

/// A frame's targets.
pub struct Fields {
    /// Normals and heights in metres, row by row.
    pub surface: Vec<[f32; 4]>,
    positions: Vec<[f32; 4]>,
    /// Its densities.
    pub densities: Densities,
}

impl Densities {
    /// At a grid point; 0 beyond the grid.
    pub fn at(&self, i: usize, j: usize, k: usize) -> f64 {
        let [x, _, z] = self.points;
        f64::from(self.values.get((((j / 4) * z + k) * x + i) * 4 + j % 4).copied().unwrap_or(0.0))
    }

    /// The first place from above at which the density is rho, in planes from the lowest, in cell `i`, `k` at the
    /// fractions `u` and `w` of its sides; none without one between the planes.
    pub fn outermost(&self, [i, k]: [usize; 2], [u, w]: [f64; 2]) -> Option<f64> {
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

/// Those of a frame with that surface.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`].
pub fn fields(machine: &mut Machine, setup: &Setup, kind: SurfaceKind, frame: u32) -> Result<Fields, Error> {
    let mut setup = setup.clone();
    setup.parameters.surface = kind;
    // Nothing is looked at; a picture of no pixels would be a warning.
    (setup.parameters.splats, setup.parameters.width, setup.parameters.height) = ([1; 2], 160, 120);
    let scene = setup.load()?;
    let mut paper = build(machine, &setup, &scene, Variant::Paper)?.paper;
    picture::render(machine, &mut paper, frame)?;
    let read = |view: &Arc<ImageView>| read_image(&machine.device, view);
    let p = &setup.parameters;
    Ok(Fields {
        surface: bytemuck::pod_collect_to_vec(&read(&paper.normal_height.surface)?),
        positions: bytemuck::pod_collect_to_vec(&read(&paper.animate.state().positions)?),
        densities: Densities {
            points: p.density.map(|n| n as usize),
            values: bytemuck::pod_collect_to_vec(&read(paper.method.density())?),
            rho: f64::from(p.rho()),
        },
    })
}

fn distances(machine: &mut Machine, setup: &Setup, kind: SurfaceKind, frame: u32) -> Result<Distances, Error> {
    let Fields { surface, positions, densities } = fields(machine, setup, kind, frame)?;
    let p = &setup.parameters;
    let points = densities.points;
    let [x, y, z] = points;
    let space = p.space_m.as_dvec3();
    let plane_m = space.y / y as f64;
    let height_m = |i: usize, k: usize| {
        let texel = k.min(z - 1) * x + i.min(x - 1);
        f64::from(surface.get(texel).map_or(0.0, |found| found[3]))
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
    for &[px, py, pz, _] in positions.iter().take(p.particles as usize) {
        let [px, py, pz] = [px, py, pz].map(f64::from);
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
impl Densities {
    /// Of a function of the indices along x, y and z.
    pub fn of(points: [usize; 3], rho: f64, value: impl Fn(usize, usize, usize) -> f64) -> Self {
        let [x, y, z] = points;
        let mut values = vec![0.0; 4 * x * y.div_ceil(4) * z];
        for (j, k, i) in (0..y).flat_map(|j| (0..z).flat_map(move |k| (0..x).map(move |i| (j, k, i)))) {
            values[(((j / 4) * z + k) * x + i) * 4 + j % 4] = value(i, j, k) as f32;
        }
        Densities { points, values, rho }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A density that is linear over the whole grid: its isosurface is a plane.
    #[test]
    fn a_linear_density_has_a_plane() {
        let value = |i: usize, j: usize, k: usize| 10.0 - j as f64 + 0.25 * i as f64 - 0.5 * k as f64;
        let densities = Densities::of([5, 8, 6], 6.5, value);
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
