use glam::{IVec2, Vec2};

/// Seeded gradient noise and the numbers behind it, without a transcendental function.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    seed: u64,
}

impl Noise {
    /// One of many independent noises of the same seed.
    pub(super) fn new(seed: u64, layer: u64) -> Self {
        Self { seed: mix(seed ^ mix(layer.wrapping_add(0x9e37_79b9_7f4a_7c15))) }
    }

    /// Two numbers in [-1, 1) for one cell of the integer lattice.
    pub(super) fn cell(self, cell: IVec2) -> Vec2 {
        let key = (u64::from(cell.x as u32) << 32) | u64::from(cell.y as u32);
        let bits = mix(self.seed ^ key.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        Vec2::new(bits as u32 as f32, (bits >> 32) as u32 as f32) * (2.0 / 4_294_967_296.0) - 1.0
    }

    /// Gradient noise (Perlin, 2002) of wavelength 1, about -0.7 to 0.7.
    pub(super) fn gradient(self, place: Vec2) -> f32 {
        let floor = place.floor();
        let (cell, inside) = (floor.as_ivec2(), place - floor);
        let fade = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
        let corner = |x: i32, y: i32| {
            let offset = inside - Vec2::new(x as f32, y as f32);
            self.cell(cell + IVec2::new(x, y)).dot(offset)
        };
        let mixed = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let north = mixed(corner(0, 0), corner(1, 0), fade.x);
        let south = mixed(corner(0, 1), corner(1, 1), fade.x);
        mixed(north, south, fade.y)
    }

    /// Octaves of halving wavelength and amplitude, the first of wavelength 1 and amplitude 1.
    pub(super) fn fractal(self, place: Vec2, octaves: u32) -> f32 {
        let (mut sum, mut scale) = (0.0, 1.0);
        for octave in 0..octaves {
            // Layers are shifted, so that no lattice point is a zero of all of them.
            let shift = Vec2::new(0.37, 0.71) * octave as f32;
            let layer = Self { seed: self.seed.wrapping_add(u64::from(octave)) };
            sum += layer.gradient(place * scale + shift) / scale;
            scale *= 2.0;
        }
        sum
    }
}

/// The finalizer of SplitMix64 (Steele, Lea and Flood, 2014).
fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
