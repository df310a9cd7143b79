//! The rocks that we make from seeded noise that repeats at the edges: plates of crust with cracks between them, and the grain of a crust.

use std::sync::OnceLock;

use super::rock::Rock;
use crate::scene::random::Random;

/// Texels a side.
const SIZE: u32 = 512;
/// Values of the table that lattice points choose from; a power of two.
const TABLE: usize = 4096;
/// Plates along each side.
const PLATES: u32 = 9;

impl Rock {
    /// Plates of crust with bright cracks between them, 512 x 512 texels. They are made once.
    pub fn built_in() -> &'static Rock {
        static ROCK: OnceLock<Rock> = OnceLock::new();
        ROCK.get_or_init(|| {
            let plates = Plates::new();
            Rock::made_by(|texel| plates.at(texel))
        })
    }

    /// The grain of a crust that has no cracks, of as many texels. It is made once.
    pub fn crust() -> &'static Rock {
        static ROCK: OnceLock<Rock> = OnceLock::new();
        ROCK.get_or_init(|| {
            let crust = Crust::new();
            Rock::made_by(|texel| crust.at(texel))
        })
    }

    fn made_by(value: impl Fn([u32; 2]) -> f32) -> Rock {
        let texel = |i: u32| {
            let value = value([i % SIZE, i / SIZE]);
            let [r, g, b] = [value, value * 0.97, value * 0.93].map(|v| (v * 255.0 + 0.5) as u8);
            [r, g, b, 255]
        };
        Rock { width: SIZE, height: SIZE, texels: (0..SIZE * SIZE).map(texel).collect() }
    }
}

/// The place of a texel's centre along an axis, in [0, 1) of the texture.
fn center(texel: u32) -> f32 {
    (texel as f32 + 0.5) / SIZE as f32
}

/// Random values on lattices that repeat after the whole texture.
struct Noise {
    values: Vec<f32>,
    order: Vec<u16>,
}

impl Noise {
    fn new() -> Self {
        let mut random = Random::new(7);
        let values = (0..TABLE).map(|_| random.unit()).collect();
        let mut order: Vec<u16> = (0..TABLE as u16).collect();
        for i in (1..TABLE).rev() {
            order.swap(i, random.next_u32() as usize % (i + 1));
        }
        Noise { values, order }
    }

    /// The value of a lattice point, uniform in [0, 1); `period` points make a side.
    fn point(&self, x: usize, y: usize, period: u32, layer: u32) -> f32 {
        let mix = |seed: usize, with: usize| usize::from(self.order[(seed + with) % TABLE]);
        self.values[mix(mix(mix(layer as usize, period as usize), x), y)]
    }

    /// All points of a lattice: far fewer than the texels that read them.
    fn lattice(&self, period: u32, layer: u32) -> Lattice {
        let side = period as usize;
        let values = (0..side * side).map(|i| self.point(i % side, i / side, period, layer)).collect();
        let tap = |texel: u32| {
            let place = center(texel) * period as f32;
            let t = place - place.floor();
            let first = place as usize;
            Tap { first, next: (first + 1) % side, weight: t * t * t * (t * (t * 6.0 - 15.0) + 10.0) }
        };
        Lattice { period, values, taps: (0..SIZE).map(tap).collect() }
    }

    /// Octaves of smooth noise, each twice as fine and half as strong.
    fn octaves(&self, period: u32, count: u32, layer: u32) -> Octaves {
        Octaves((0..count).map(|octave| self.lattice(period << octave, layer + octave)).collect())
    }
}

/// The values of a lattice that repeats after the whole texture, row by row.
struct Lattice {
    /// Points a side.
    period: u32,
    values: Vec<f32>,
    /// Of each texel, along either axis.
    taps: Vec<Tap>,
}

/// The two points along an axis between which a texel's centre lies, and the second one's weight.
struct Tap {
    first: usize,
    next: usize,
    weight: f32,
}

impl Lattice {
    fn wrapped(&self, coordinate: i32) -> usize {
        coordinate.rem_euclid(self.period as i32) as usize
    }

    /// Smooth noise in [0, 1) at a texel.
    fn smooth(&self, texel: [u32; 2]) -> f32 {
        let side = self.period as usize;
        let [across, down] = texel.map(|at| &self.taps[at as usize]);
        let [row, next_row] = [down.first, down.next].map(|row| &self.values[row * side..][..side]);
        let blend = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let along = |row: &[f32]| blend(row[across.first], row[across.next], across.weight);
        blend(along(row), along(next_row), down.weight)
    }
}

struct Octaves(Vec<Lattice>);

impl Octaves {
    /// In [0, 1), at a texel.
    fn at(&self, texel: [u32; 2]) -> f32 {
        let weights = || std::iter::successors(Some(1.0_f32), |weight| Some(0.5 * weight)).take(self.0.len());
        let sum: f32 = weights().zip(&self.0).map(|(weight, lattice)| weight * lattice.smooth(texel)).sum();
        sum / weights().sum::<f32>()
    }
}

/// Cells beside one along an axis, in which the two nearest seed points may lie: the nearer ones first.
const NEAR: [i32; 5] = [0, -1, 1, -2, 2];

/// A seed point in each cell of a lattice, whose plates are what lies nearest to it.
struct Seeds {
    across: Lattice,
    down: Lattice,
}

impl Seeds {
    fn new(noise: &Noise, period: u32, layer: u32) -> Self {
        Seeds { across: noise.lattice(period, layer), down: noise.lattice(period, layer + 1) }
    }

    /// Distance of the second nearest seed point less that of the nearest, lattice cells: 0 on the border of a plate.
    fn border(&self, [x, y]: [f32; 2]) -> f32 {
        let (period, side) = (self.across.period as f32, self.across.period as usize);
        let (x, y) = (x * period, y * period);
        let (i, j) = (x.floor() as i32, y.floor() as i32);
        let columns = NEAR.map(|at| self.across.wrapped(i + at));
        let mut nearest_squared = [f32::INFINITY; 2];
        // No point of cells so far away is among the two nearest.
        let is_beyond = |cell: i32, from: f32, second: f32| {
            let apart = (cell as f32 - from).max(from - (cell + 1) as f32);
            apart > 0.0 && apart * apart >= second
        };
        for cy in NEAR.map(|at| j + at) {
            if is_beyond(cy, y, nearest_squared[1]) {
                continue;
            }
            let row = self.across.wrapped(cy) * side;
            for (at, column) in NEAR.into_iter().zip(columns) {
                if is_beyond(i + at, x, nearest_squared[1]) {
                    continue;
                }
                let px = (i + at) as f32 + self.across.values[row + column] - x;
                let py = cy as f32 + self.down.values[row + column] - y;
                let squared = px * px + py * py;
                if squared < nearest_squared[0] {
                    nearest_squared = [squared, nearest_squared[0]];
                } else {
                    nearest_squared[1] = nearest_squared[1].min(squared);
                }
            }
        }
        let [nearest, second] = nearest_squared.map(f32::sqrt);
        second - nearest
    }
}

/// Lighter and darker, with small dark pits, which are burst bubbles.
struct Crust {
    broad: Octaves,
    grain: Octaves,
    pits: Lattice,
}

impl Crust {
    fn new() -> Self {
        let noise = Noise::new();
        Crust { broad: noise.octaves(4, 6, 70), grain: noise.octaves(40, 3, 80), pits: noise.lattice(56, 90) }
    }

    fn at(&self, texel: [u32; 2]) -> f32 {
        let broad = stretched(self.broad.at(texel), 1.8);
        let grain = stretched(self.grain.at(texel), 2.2);
        let pits = 1.0 - stretched(self.pits.smooth(texel), 3.0);
        (0.7 + 0.1 * broad + 0.2 * grain) * (1.0 - 0.15 * pits * pits * pits)
    }
}

struct Plates {
    bends: [Octaves; 2],
    crust: Octaves,
    grain: Octaves,
    large: Seeds,
    small: Seeds,
}

impl Plates {
    fn new() -> Self {
        let noise = Noise::new();
        Plates {
            bends: [10, 20].map(|layer| noise.octaves(5, 6, layer)),
            crust: noise.octaves(3, 7, 50),
            grain: noise.octaves(32, 4, 60),
            large: Seeds::new(&noise, PLATES, 30),
            small: Seeds::new(&noise, 2 * PLATES, 40),
        }
    }

    fn at(&self, texel: [u32; 2]) -> f32 {
        // Plates do not break along straight lines.
        let bent = [0, 1].map(|axis| center(texel[axis]) + 0.16 * (self.bends[axis].at(texel) - 0.5));
        let crust = stretched(self.crust.at(texel), 2.0);
        let grain = stretched(self.grain.at(texel), 2.6);
        let crack = |width: f32, seeds: &Seeds| {
            let t = (1.0 - seeds.border(bent) / width).max(0.0);
            t * t
        };
        // Cracks gape here and are nearly closed there.
        let cracks = crack(0.12 + 0.32 * grain, &self.large).max(0.5 * crack(0.1 + 0.3 * crust, &self.small));
        // Lighter and darker crust, grainy; where it is torn the rock is fresh and bright.
        let crust = 0.05 + (0.1 + 0.45 * crust * crust) * (0.25 + 1.5 * grain * grain);
        (crust + (1.0 - crust) * cracks).min(1.0)
    }
}

/// Noise gathers around its mean: stretched, it fills the range.
fn stretched(value: f32, contrast: f32) -> f32 {
    (0.5 + contrast * (value - 0.5)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rocks_repeat_without_a_seam() {
        for rock in [Rock::built_in(), Rock::crust()] {
            assert_eq!(rock.validate(), Ok(()));
            let at = |x: u32, y: u32| i32::from(rock.texels[(y % SIZE * SIZE + x % SIZE) as usize][0]);
            let step = |x: u32, y: u32| (at(x + 1, y) - at(x, y)).abs() + (at(y, x + 1) - at(y, x)).abs();
            let mean = |x: u32| (0..SIZE).map(|y| step(x, y)).sum::<i32>() as f32 / SIZE as f32;
            let inside = (0..SIZE - 1).map(mean).fold(0.0, f32::max);
            assert!(mean(SIZE - 1) <= inside, "{} {inside}", mean(SIZE - 1));
        }
        let dark = |rock: &Rock| rock.texels.iter().filter(|t| t[0] < 128).count();
        let plates = Rock::built_in();
        assert!(dark(plates) > plates.texels.len() / 3 && dark(plates) < plates.texels.len(), "{}", dark(plates));
        // No cracks: nothing much brighter or darker than the rest.
        let crust = Rock::crust().texels.iter().map(|texel| texel[0]);
        let (darkest, brightest) = crust.fold((255, 0), |(low, high), value| (value.min(low), value.max(high)));
        assert!(darkest > 128 && brightest > 200, "{darkest} {brightest}");
    }
}
