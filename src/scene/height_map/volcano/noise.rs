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

    /// Octaves of halving wavelength and amplitude, the first of wavelength 1 and amplitude 1.
    pub(super) fn fractal(self, octaves: u32) -> Fractal {
        let layer = |octave| Self { seed: self.seed.wrapping_add(u64::from(octave)) }.gradient();
        Fractal { layers: (0..octaves).map(layer).collect() }
    }

    /// Gradient noise (Perlin, 2002) of wavelength 1, about -0.7 to 0.7.
    pub(super) fn gradient(self) -> Gradient {
        Gradient { noise: self, cell: None, corners: [Vec2::ZERO; 4] }
    }
}

/// Gradient noise. It keeps the corners of the cell that it was last asked about, in which the next place mostly lies.
#[derive(Clone)]
pub(super) struct Gradient {
    noise: Noise,
    cell: Option<IVec2>,
    corners: [Vec2; 4],
}

impl Gradient {
    pub(super) fn at(&mut self, place: Vec2) -> f32 {
        let (cell, inside) = cell_and_inside(place);
        if self.cell != Some(cell) {
            self.cell = Some(cell);
            self.corners = CORNERS.map(|corner| self.noise.cell(cell + corner));
        }
        let fade = inside * inside * inside * (inside * (inside * 6.0 - 15.0) + 10.0);
        let corner = |at: usize| self.corners[at].dot(inside - CORNERS[at].as_vec2());
        let mixed = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let (north, south) = (mixed(corner(0), corner(1), fade.x), mixed(corner(2), corner(3), fade.x));
        mixed(north, south, fade.y)
    }
}

const CORNERS: [IVec2; 4] = [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE];

/// The cell of the integer lattice in which a place lies, and where in it.
pub(super) fn cell_and_inside(place: Vec2) -> (IVec2, Vec2) {
    // Without calls: not every x86-64 rounds by an instruction.
    let towards_zero = place.as_ivec2();
    let above = towards_zero.as_vec2().cmpgt(place);
    let cell = towards_zero - IVec2::new(i32::from(above.x), i32::from(above.y));
    (cell, place - cell.as_vec2())
}

/// Octaves of gradient noise.
#[derive(Clone)]
pub(super) struct Fractal {
    layers: Vec<Gradient>,
}

impl Fractal {
    pub(super) fn at(&mut self, place: Vec2) -> f32 {
        let (mut sum, mut scale) = (0.0, 1.0);
        for (octave, layer) in (0_u8..).zip(&mut self.layers) {
            // Layers are shifted, so that no lattice point is a zero of all of them.
            let shift = Vec2::new(0.37, 0.71) * f32::from(octave);
            sum += layer.at(place * scale + shift) / scale;
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
