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
        ROCK.get_or_init(|| Rock::made_by(Noise::plates))
    }

    /// The grain of a crust that has no cracks, of as many texels. It is made once.
    pub fn crust() -> &'static Rock {
        static ROCK: OnceLock<Rock> = OnceLock::new();
        ROCK.get_or_init(|| Rock::made_by(Noise::crust))
    }

    fn made_by(value: fn(&Noise, [f32; 2]) -> f32) -> Rock {
        let noise = Noise::new();
        let texel = |i: u32| {
            let value = value(&noise, [i % SIZE, i / SIZE].map(|c| (c as f32 + 0.5) / SIZE as f32));
            let [r, g, b] = [value, value * 0.97, value * 0.93].map(|v| (v * 255.0 + 0.5) as u8);
            [r, g, b, 255]
        };
        Rock { width: SIZE, height: SIZE, texels: (0..SIZE * SIZE).map(texel).collect() }
    }
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
    fn lattice(&self, x: i32, y: i32, period: u32, layer: u32) -> f32 {
        let mix = |seed: usize, with: usize| usize::from(self.order[(seed + with) % TABLE]);
        let wrapped = |c: i32| c.rem_euclid(period as i32) as usize;
        self.values[mix(mix(mix(layer as usize, period as usize), wrapped(x)), wrapped(y))]
    }

    /// Smooth noise in [0, 1) at a place in [0, 1) of the texture.
    fn smooth(&self, [x, y]: [f32; 2], period: u32, layer: u32) -> f32 {
        let (x, y) = (x * period as f32, y * period as f32);
        let ease = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let (tx, ty) = (ease(x - x.floor()), ease(y - y.floor()));
        let (i, j) = (x.floor() as i32, y.floor() as i32);
        let at = |dx, dy| self.lattice(i + dx, j + dy, period, layer);
        let blend = |a: f32, b: f32, t: f32| a + (b - a) * t;
        blend(blend(at(0, 0), at(1, 0), tx), blend(at(0, 1), at(1, 1), tx), ty)
    }

    /// Octaves of smooth noise, each twice as fine and half as strong, in [0, 1).
    fn octaves(&self, place: [f32; 2], period: u32, count: u32, layer: u32) -> f32 {
        let weight = |octave: u32| 0.5f32.powi(octave as i32);
        let sum: f32 = (0..count).map(|o| weight(o) * self.smooth(place, period << o, layer + o)).sum();
        sum / (0..count).map(weight).sum::<f32>()
    }

    /// Distance of the second nearest seed point less that of the nearest, lattice cells: 0 on the border of a plate.
    fn border(&self, [x, y]: [f32; 2], period: u32, layer: u32) -> f32 {
        let (x, y) = (x * period as f32, y * period as f32);
        let (i, j) = (x.floor() as i32, y.floor() as i32);
        let mut nearest = [f32::INFINITY; 2];
        for (dx, dy) in (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy))) {
            let (cx, cy) = (i + dx, j + dy);
            let px = cx as f32 + self.lattice(cx, cy, period, layer) - x;
            let py = cy as f32 + self.lattice(cx, cy, period, layer + 1) - y;
            let distance = (px * px + py * py).sqrt();
            if distance < nearest[0] {
                nearest = [distance, nearest[0]];
            } else {
                nearest[1] = nearest[1].min(distance);
            }
        }
        nearest[1] - nearest[0]
    }

    /// Lighter and darker, with small dark pits, which are burst bubbles.
    fn crust(&self, place: [f32; 2]) -> f32 {
        let broad = stretched(self.octaves(place, 4, 6, 70), 1.8);
        let grain = stretched(self.octaves(place, 40, 3, 80), 2.2);
        let pits = 1.0 - stretched(self.smooth(place, 56, 90), 3.0);
        (0.7 + 0.1 * broad + 0.2 * grain) * (1.0 - 0.15 * pits * pits * pits)
    }

    fn plates(&self, place: [f32; 2]) -> f32 {
        // Plates do not break along straight lines.
        let bend = |layer| 0.16 * (self.octaves(place, 5, 6, layer) - 0.5);
        let bent = [place[0] + bend(10), place[1] + bend(20)];
        let crust = stretched(self.octaves(place, 3, 7, 50), 2.0);
        let grain = stretched(self.octaves(place, 32, 4, 60), 2.6);
        let crack = |width: f32, period, layer| {
            let t = (1.0 - self.border(bent, period, layer) / width).max(0.0);
            t * t
        };
        // Cracks gape here and are nearly closed there.
        let cracks = crack(0.12 + 0.32 * grain, PLATES, 30).max(0.5 * crack(0.1 + 0.3 * crust, 2 * PLATES, 40));
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
