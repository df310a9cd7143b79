//! Fate of the surface's relief as it is carried along: of lava that flows it stays, of lava that boils it does not.

use glam::DVec2;
use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::gpu::transfer::read_image;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Error, picture};
use crate::papers::lava::{Lava, Variant};

/// The first frame that is looked at without `frame`: after a second of the default step.
pub const FRAME: u32 = 29;
/// Times of the others after it, seconds.
const LATER_S: [f64; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];

/// Surface and particles of a frame.
struct Moment {
    /// Metres, row by row.
    heights: Vec<f64>,
    /// Metres along x and z.
    places: Vec<DVec2>,
    /// Of the columns.
    is_covered: Vec<bool>,
}

/// The grid of the surface.
#[derive(Clone, Copy)]
struct Grid {
    columns: usize,
    rows: usize,
    space_m: DVec2,
}

impl Grid {
    /// Columns and rows from the middle of the first one on.
    fn at(&self, place_m: DVec2) -> DVec2 {
        place_m / self.space_m * DVec2::new(self.columns as f64, self.rows as f64) - 0.5
    }

    /// The column that a place lies in; none outside.
    fn column(&self, place_m: DVec2) -> Option<usize> {
        let at = (self.at(place_m) + 0.5).floor();
        let is_inside = at.cmpge(DVec2::ZERO).all() && at.x < self.columns as f64 && at.y < self.rows as f64;
        is_inside.then(|| at.y as usize * self.columns + at.x as usize)
    }

    fn middle_m(&self, column: usize) -> DVec2 {
        let at = DVec2::new((column % self.columns) as f64, (column / self.columns) as f64);
        (at + 0.5) / DVec2::new(self.columns as f64, self.rows as f64) * self.space_m
    }

    /// Linear between the middles of columns; none beyond them.
    fn height(&self, heights: &[f64], place_m: DVec2) -> Option<f64> {
        let at = self.at(place_m);
        let last = DVec2::new(self.columns as f64 - 1.0, self.rows as f64 - 1.0);
        if !(at.cmpge(DVec2::ZERO).all() && at.cmplt(last).all()) {
            return None;
        }
        let (base, part) = (at.floor(), at.fract());
        let of = |x: usize, z: usize| heights[(base.y as usize + z) * self.columns + base.x as usize + x];
        let north = of(0, 0) * (1.0 - part.x) + of(1, 0) * part.x;
        let south = of(0, 1) * (1.0 - part.x) + of(1, 1) * part.x;
        Some(north * (1.0 - part.y) + south * part.y)
    }

    /// The way that the particles of each column have gone since another moment, in the mean of it and of those beside it; none
    /// where there are no particles.
    fn ways_m(&self, before: &Moment, after: &Moment) -> Vec<Option<DVec2>> {
        let mut sums = vec![(DVec2::ZERO, 0u32); self.columns * self.rows];
        for (from, to) in before.places.iter().zip(&after.places) {
            let way = *to - *from;
            // One that has left the space comes in at its other end.
            if way.abs().cmpge(0.5 * self.space_m).any() {
                continue;
            }
            if let Some(column) = self.column(*to) {
                sums[column].0 += way;
                sums[column].1 += 1;
            }
        }
        let around = |column: usize| {
            let (x, z) = (column % self.columns, column / self.columns);
            let rows = z.saturating_sub(1)..(z + 2).min(self.rows);
            let beside = rows.flat_map(|z| (x.saturating_sub(1)..(x + 2).min(self.columns)).map(move |x| (x, z)));
            let all = beside.map(|(x, z)| sums[z * self.columns + x]);
            let (way, count) = all.fold((DVec2::ZERO, 0), |(way, count), sum| (way + sum.0, count + sum.1));
            (count > 0).then(|| way / f64::from(count))
        };
        (0..self.columns * self.rows).map(around).collect()
    }

    /// Correlation of a moment's relief with that of an earlier one carried along, and the mean way; over the columns inside a
    /// border that are covered in both. None of fewer than three.
    fn correlation(&self, border_m: f64, before: &Moment, after: &Moment) -> Option<(f64, f64)> {
        let mut pairs = Vec::new();
        let mut gone = 0.0;
        for (column, way) in self.ways_m(before, after).into_iter().enumerate() {
            let Some(way) = way else { continue };
            let (now, then) = (self.middle_m(column), self.middle_m(column) - way);
            let is_inside =
                |place: DVec2| place.cmpge(DVec2::splat(border_m)).all() && place.cmple(self.space_m - border_m).all();
            let was_covered = self.column(then).is_some_and(|column| before.is_covered[column]);
            if !(is_inside(now) && is_inside(then) && after.is_covered[column] && was_covered) {
                continue;
            }
            if let Some(height) = self.height(&before.heights, then) {
                pairs.push((height, after.heights[column]));
                gone += way.length();
            }
        }
        if pairs.len() < 3 {
            return None;
        }
        let count = pairs.len() as f64;
        let (a, b) = pairs.iter().fold((0.0, 0.0), |(a, b), pair| (a + pair.0 / count, b + pair.1 / count));
        let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
        for (x, y) in &pairs {
            both += (x - a) * (y - b);
            first += (x - a) * (x - a);
            second += (y - b) * (y - b);
        }
        let scale = (first * second).sqrt();
        (scale > 0.0).then(|| (both / scale, gone / count))
    }
}

fn moment(machine: &mut Machine, paper: &mut Lava, frame: u32) -> Result<Moment, Error> {
    picture::render(machine, paper, frame)?;
    let read = |view| -> Result<Vec<[f32; 4]>, Error> {
        Ok(bytemuck::pod_collect_to_vec(&read_image(&machine.device, view)?))
    };
    let (surface, sums) = (read(&paper.normal_height.surface)?, read(paper.method.sums())?);
    let places = read(&paper.animate.state().positions)?;
    let out = paper.animate.out() as usize;
    Ok(Moment {
        heights: surface.iter().map(|texel| f64::from(texel[3])).collect(),
        places: places.iter().take(out).map(|&[x, _, z, _]| DVec2::new(x.into(), z.into())).collect(),
        is_covered: sums.iter().map(|texel| texel[3] > 0.0).collect(),
    })
}

/// A row for each time after a frame.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Image`], [`Error::Parameter`], [`Error::Input`] for a step that is none.
pub fn table(machine: &mut Machine, setup: &Setup, first: u32) -> Result<ResultTable, Error> {
    let step_s = f64::from(setup.parameters.time_step_s);
    if step_s <= 0.0 {
        return Err(Error::Input("`time-step` 0: nothing moves; give one above 0".to_owned()));
    }
    let mut setup = setup.clone();
    // Nothing is looked at.
    (setup.parameters.splats, setup.parameters.width, setup.parameters.height) = ([1; 2], 1, 1);
    let scene = setup.load()?;
    let mut paper = build(machine, &setup, &scene, Variant::GpuDriven)?.paper;
    let p = &setup.parameters;
    let [columns, _, rows] = p.density.map(|n| n as usize);
    let grid = Grid { columns, rows, space_m: DVec2::new(p.space_m.x.into(), p.space_m.z.into()) };
    let before = moment(machine, &mut paper, first)?;
    let mut steps: Vec<u32> = LATER_S.iter().map(|later_s| (later_s / step_s).round().clamp(1.0, 1e5) as u32).collect();
    steps.dedup();
    let row = |later: u32| -> Result<Vec<Value>, Error> {
        let after = moment(machine, &mut paper, first.saturating_add(later))?;
        let found = grid.correlation(p.border_m.into(), &before, &after);
        Ok(vec![
            json!(f64::from(later) * step_s),
            json!(found.map(|(correlation, _)| correlation)),
            json!(found.map(|(_, gone)| gone)),
        ])
    };
    let rows = steps.into_iter().map(row).collect::<Result<_, _>>()?;
    Ok(ResultTable {
        title: "Relief of a frame, carried along by the particles, beside the relief of later ones",
        columns: &["later s", "correlation", "gone m"],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { columns: 40, rows: 20, space_m: DVec2::new(4.0, 2.0) };

    fn wavy(moved: DVec2) -> Moment {
        let height = |column| {
            let place = GRID.middle_m(column) - moved;
            0.3 + 0.1 * (5.0 * place.x).sin() * (4.0 * place.y).cos()
        };
        let places = (0..800).map(|column| GRID.middle_m(column) + moved);
        Moment { heights: (0..800).map(height).collect(), places: places.collect(), is_covered: vec![true; 800] }
    }

    #[test]
    fn relief_that_is_carried_correlates_and_another_does_not() {
        let moved = DVec2::new(0.35, -0.17);
        let (correlation, gone) = GRID.correlation(0.1, &wavy(DVec2::ZERO), &wavy(moved)).unwrap();
        assert!(correlation > 0.99 && (gone - moved.length()).abs() < 1e-9, "{correlation} {gone}");
        // The same way of the particles under relief that stays where it is.
        let stays = Moment { heights: wavy(DVec2::ZERO).heights, ..wavy(moved) };
        let (correlation, _) = GRID.correlation(0.1, &wavy(DVec2::ZERO), &stays).unwrap();
        assert!(correlation < 0.3, "{correlation}");
        let bare = Moment { is_covered: vec![false; 800], ..wavy(moved) };
        assert!(GRID.correlation(0.1, &wavy(DVec2::ZERO), &bare).is_none());
    }
}
