//! A sheet of viscous lava that spreads on a slope and cools, by lubrication theory on a grid of squares: the thin flows of Huppert (1982) and
//! Lister (1992), without particles.

/// Lava on a plane that falls along x: one half of it, since the other is its mirror image. Metres, seconds and kelvin.
pub struct Sheet {
    columns: usize,
    rows: usize,
    /// Of a square.
    side: f64,
    /// Gravity along the plane over three kinematic viscosities.
    down: f64,
    /// Gravity across the plane over as much.
    across: f64,
    thickness: Vec<f64>,
    /// Thickness times temperature.
    warmth: Vec<f64>,
}

/// A round vent in the line of symmetry.
pub struct Source {
    /// Its middle, from where the grid begins.
    pub x: f64,
    /// Its radius.
    pub radius: f64,
    /// Volume per second.
    pub rate: f64,
    /// Temperature of what comes out.
    pub kelvin: f64,
}

impl Sheet {
    /// None yet, on a plane of this slope in radians, of lava with a kinematic viscosity.
    pub fn new([columns, rows]: [usize; 2], side: f64, gravity: f64, slope: f64, kinematic: f64) -> Self {
        let [down, across] = [slope.sin(), slope.cos()].map(|part| gravity * part / (3.0 * kinematic));
        let empty = vec![0.0; columns * rows];
        Sheet { columns, rows, side, down, across, thickness: empty.clone(), warmth: empty }
    }

    /// Lets it flow for so long; a column loses `shed` of its temperature and thickness, in kelvin times metres per second.
    pub fn flow(&mut self, source: &Source, seconds: f64, shed: impl Fn(f64, f64) -> f64) {
        let is_fed = |at: &usize| {
            let (x, z) = self.place(*at);
            (x - source.x).hypot(z) < source.radius
        };
        let fed: Vec<usize> = (0..self.thickness.len()).filter(is_fed).collect();
        // Half of it comes out in this half.
        let rise = 0.5 * source.rate / (fed.len() as f64 * self.side * self.side);
        let mut left = seconds;
        while left > 0.0 {
            let thickest = self.thickness.iter().copied().fold(1e-3 * self.side, f64::max);
            let spread = 0.2 * self.side * self.side / (self.across * thickest.powi(3));
            let carried = 0.3 * self.side / (3.0 * self.down * thickest * thickest).max(1e-30);
            let filled = 0.1 * self.side / rise;
            let step = spread.min(carried).min(filled).min(left);
            for &at in &fed {
                self.thickness[at] += step * rise;
                self.warmth[at] += step * rise * source.kelvin;
            }
            self.spread(step);
            for at in 0..self.thickness.len() {
                let thickness = self.thickness[at];
                if thickness > 1e-9 {
                    self.warmth[at] -= step * shed(self.warmth[at] / thickness, thickness);
                }
            }
            left -= step;
        }
    }

    /// What flows through every side of every square in a step.
    fn spread(&mut self, step: f64) {
        let before = self.thickness.clone();
        let kelvin: Vec<f64> = before
            .iter()
            .zip(&self.warmth)
            .map(|(thick, warm)| if *thick > 0.0 { warm / thick } else { 0.0 })
            .collect();
        let per_side = step / self.side;
        for row in 0..self.rows {
            for column in 0..self.columns {
                let a = row * self.columns + column;
                let neighbours =
                    [(column + 1 < self.columns, a + 1, self.down), (row + 1 < self.rows, a + self.columns, 0.0)];
                for (_, b, down) in neighbours.into_iter().filter(|(is_there, ..)| *is_there) {
                    let cubes = [before[a], before[b]].map(|thick| thick.powi(3));
                    let fall = (before[a] - before[b]) / self.side;
                    let flux = per_side * (down * cubes[0] + self.across * 0.5 * (cubes[0] + cubes[1]) * fall);
                    let carried = flux * if flux > 0.0 { kelvin[a] } else { kelvin[b] };
                    self.thickness[a] -= flux;
                    self.thickness[b] += flux;
                    self.warmth[a] -= carried;
                    self.warmth[b] += carried;
                }
            }
        }
    }

    /// Middle of a square: along x from where the grid begins, and away from the line of symmetry.
    fn place(&self, at: usize) -> (f64, f64) {
        let middle = |n: usize| (n as f64 + 0.5) * self.side;
        (middle(at % self.columns), middle(at / self.columns))
    }

    /// The whole sheet's volume.
    pub fn volume(&self) -> f64 {
        2.0 * self.side * self.side * self.thickness.iter().sum::<f64>()
    }

    /// Thickness at a place, of the square around it.
    pub fn thickness(&self, x: f64, z: f64) -> f64 {
        let at = |along: f64| (along / self.side) as usize;
        self.thickness[at(z) * self.columns + at(x)]
    }

    /// The value of a place, from its x and z, that no more than so large a share of the lava exceeds.
    pub fn quantile(&self, share: f64, of: impl Fn(f64, f64) -> f64) -> f64 {
        let mut parts: Vec<(f64, f64)> = (0..self.thickness.len())
            .map(|at| {
                let (x, z) = self.place(at);
                (of(x, z), self.thickness[at])
            })
            .collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let all: f64 = self.thickness.iter().sum();
        let mut beyond = 0.0;
        for (value, thickness) in parts {
            beyond += thickness;
            if beyond > share * all {
                return value;
            }
        }
        0.0
    }

    /// Mean temperature of the lava at places of which `of` is true, and their share of all lava.
    pub fn mean_kelvin(&self, of: impl Fn(f64, f64) -> bool) -> (f64, f64) {
        let (mut warmth, mut thickness) = (0.0, 0.0);
        for at in 0..self.thickness.len() {
            let (x, z) = self.place(at);
            if of(x, z) {
                warmth += self.warmth[at];
                thickness += self.thickness[at];
            }
        }
        (warmth / thickness, thickness / self.thickness.iter().sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a level plane the radius of what is fed evenly is 0.715 (g Q^3 / (3 nu))^(1/8) t^(1/2) (Huppert 1982).
    #[test]
    fn a_level_sheet_is_a_gravity_current() {
        let mut sheet = Sheet::new([100, 50], 0.05, 3.0, 0.0, 1.0);
        sheet.flow(&Source { x: 2.5, radius: 0.1, rate: 1.0, kelvin: 1000.0 }, 6.0, |_, _| 0.0);
        assert!((sheet.volume() - 6.0).abs() < 1e-6, "{}", sheet.volume());
        let radius = sheet.quantile(0.001, |x, z| (x - 2.5).hypot(z));
        let expected = 0.715 * 6f64.sqrt();
        assert!((radius / expected - 1.0).abs() < 0.04, "{radius} {expected}");
        assert!((sheet.mean_kelvin(|_, _| true).0 - 1000.0).abs() < 1e-6);
    }

    /// On a slope behind the front it is as thick as A x^(-1/7) (Smith 1973), its front goes as t^(7/9) and its sides as t^(1/3)
    /// (Lister 1992).
    #[test]
    fn a_sheet_on_a_slope_has_its_similarity_form() {
        let slope = std::f64::consts::FRAC_PI_4;
        let mut sheet = Sheet::new([120, 45], 0.15, 3.0 / slope.sin(), slope, 1.0);
        let source = Source { x: 3.0, radius: 0.3, rate: 1.0, kelvin: 1.0 };
        let extents = |sheet: &Sheet| [sheet.quantile(0.01, |x, _| x - 3.0), sheet.quantile(0.01, |_, z| z)];
        sheet.flow(&source, 20.0, |_, _| 0.0);
        let early = extents(&sheet);
        sheet.flow(&source, 20.0, |_, _| 0.0);
        let late = extents(&sheet);
        let [along, across] = [0, 1].map(|axis| (late[axis] / early[axis]).log2());
        println!("{early:?} {late:?}: t^{along:.3}, t^{across:.3}");
        assert!((along - 7.0 / 9.0).abs() < 0.05 && (across - 1.0 / 3.0).abs() < 0.05, "{along} {across}");
        let a = (35.0 / (32.0 * (14.0f64 / 3.0).sqrt())).powf(2.0 / 7.0);
        let b = (14.0 / 3.0 * a).sqrt();
        for x in [3.0f64, 5.0] {
            let found = sheet.thickness(3.0 + x, 0.01) / (a * x.powf(-1.0 / 7.0));
            let half = sheet.thickness(3.0 + x, 0.5 * b * x.powf(3.0 / 7.0)) / (0.75 * a * x.powf(-1.0 / 7.0));
            println!("at {x}: {found:.3} of Smith's thickness, {half:.3} at half of its width");
            assert!((found - 1.0).abs() < 0.05 && (half - 1.0).abs() < 0.06, "{x}: {found} {half}");
        }
    }
}
