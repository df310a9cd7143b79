//! The slope of a map's land, of rows that come one after another.

use glam::DVec2;

/// Most samples of a side that the slope is taken of.
const SAMPLES: u32 = 512;

/// The sum of squares of the slope, so far.
pub(super) struct SlopeMeter {
    size: (u32, u32),
    spacing_m: DVec2,
    sum: f64,
    count: f64,
}

impl SlopeMeter {
    /// Of a map of so many columns and rows.
    pub(super) fn new(size: (u32, u32), spacing_m: DVec2) -> Self {
        SlopeMeter { size, spacing_m, sum: 0.0, count: 0.0 }
    }

    /// True for a row that counts.
    pub(super) fn takes(&self, row: u32) -> bool {
        let height = self.size.1;
        row + 1 < height && row.is_multiple_of(height.div_ceil(SAMPLES))
    }

    /// Counts a row by the heights in its columns and those below them, metres.
    pub(super) fn take(&mut self, row: &dyn Fn(u32) -> f32, below: &dyn Fn(u32) -> f32) {
        let width = self.size.0;
        for column in (0..width - 1).step_by(width.div_ceil(SAMPLES) as usize) {
            let height_m = f64::from(row(column));
            let rise_m = DVec2::new(f64::from(row(column + 1)), f64::from(below(column))) - height_m;
            self.sum += (rise_m / self.spacing_m).length_squared();
            self.count += 1.0;
        }
    }

    /// Root of the mean square, metres for a metre.
    pub(super) fn slope(&self) -> f64 {
        f64::sqrt(self.sum / self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_its_own_slope_however_large() {
        for (width, height) in [(2, 2), (5, 900), (1_500, 3)] {
            let spacing_m = DVec2::new(2.0, 5.0);
            let plane = |column: u32, row: u32| 6.0 * column as f32 + 20.0 * row as f32;
            let mut meter = SlopeMeter::new((width, height), spacing_m);
            let mut rows = 0;
            for row in (0..height).filter(|row| meter.takes(*row)).collect::<Vec<_>>() {
                meter.take(&|column| plane(column, row), &|column| plane(column, row + 1));
                rows += 1;
            }
            // 3 and 4 metres for a metre.
            assert!((meter.slope() - 5.0).abs() < 1e-9, "{width} x {height}: {}", meter.slope());
            assert!((1..=SAMPLES).contains(&rows));
        }
    }
}
