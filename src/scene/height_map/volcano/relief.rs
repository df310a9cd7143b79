//! The volcano before rain and rivers: cone, crater, collapse scar, side vents, debris and plain.

use super::noise::{Fractal, Gradient, Noise};
use glam::Vec2;

/// Height of the plain, metres above the sea.
const PLAIN_M: f32 = 560.0;
/// Height of the undamaged cone above the plain.
const CONE_M: f32 = 1_480.0;
/// Distance from the summit at which the cone's foot runs out into the plain.
const FOOT_M: f32 = 6_200.0;
/// The summit crater.
const CRATER_RADIUS_M: f32 = 380.0;
const CRATER_DEPTH_M: f32 = 190.0;
/// Half the width of the scar at its head, and how much wider it gets for each metre north.
const SCAR_HALF_WIDTH_M: f32 = 640.0;
const SCAR_WIDENING: f32 = 0.24;
/// Distance north of the summit of the centre of the scar's head.
const SCAR_HEAD_M: f32 = 420.0;
/// Distance from its head at which the scar's floor reaches the plain.
const SCAR_LENGTH_M: f32 = 6_000.0;
/// The scar's floor above the plain, at its head.
const SCAR_FLOOR_M: f32 = 560.0;

/// A vent on the flank: where, metres east and north of the summit, and its cone.
struct Vent {
    place: Vec2,
    radius_m: f32,
    height_m: f32,
}

const VENTS: [Vent; 3] = [
    Vent { place: Vec2::new(1_350.0, 150.0), radius_m: 1_150.0, height_m: 300.0 },
    Vent { place: Vec2::new(-1_250.0, -700.0), radius_m: 950.0, height_m: 190.0 },
    Vent { place: Vec2::new(1_350.0, -2_900.0), radius_m: 1_050.0, height_m: 160.0 },
];

/// The noises of one seed, each for one thing.
#[derive(Clone)]
pub(super) struct Relief {
    outline: [Fractal; 2],
    scar: [Fractal; 2],
    rock: Fractal,
    /// Of two sizes.
    hummocks: [Gradient; 2],
    hills: Fractal,
}

/// The uneroded terrain at one place.
#[derive(Clone, Copy, Default)]
pub(super) struct Bare {
    /// Height in metres.
    pub(super) height_m: f32,
    /// Relative depth of gullies, 0 to 1: not into loose debris, which swallows the rain, nor into a crest, where none
    /// falls from above.
    pub(super) erodibility: f32,
}

impl Relief {
    pub(super) fn new(seed: u64) -> Self {
        let layer = |number| Noise::new(seed, number);
        Self {
            outline: [1, 2].map(|number| layer(number).fractal(2)),
            scar: [3, 4].map(|number| layer(number).fractal(3)),
            rock: layer(5).fractal(2),
            hummocks: [layer(6).gradient(), layer(6).gradient()],
            hills: layer(7).fractal(5),
        }
    }

    /// The terrain at `place`, metres east and north of the summit.
    pub(super) fn at(&mut self, place: Vec2) -> Bare {
        // Nothing in nature is round: outlines are bent at the scale of ridges and ravines.
        let bent = place + bend(&mut self.outline, place / 3_100.0) * 560.0 * ramp(200.0, 2_800.0, place.length());
        let torn = place + bend(&mut self.scar, place / 1_400.0) * 280.0;
        let (terrain_m, crest) = scarred_m(torn, self.cone_m(bent));
        let fan = fan(bent) * (1.0 - ramp(200.0, 620.0, terrain_m));
        let low = 1.0 - ramp(60.0, 500.0, terrain_m);
        let plain_m = low * 95.0 * self.hills.at(place / 3_400.0);
        let debris_m = if fan > 0.0 { fan * (30.0 + 75.0 * self.mounds(place)) } else { 0.0 };
        Bare { height_m: PLAIN_M + terrain_m + plain_m + debris_m, erodibility: (1.0 - 0.85 * fan) * (1.0 - crest) }
    }

    /// The cone with its crater and side vents, above the plain.
    fn cone_m(&mut self, place: Vec2) -> f32 {
        let mut cone_m = flank_m(place.length());
        for vent in &VENTS {
            let distance = place.distance(vent.place) / vent.radius_m;
            let dome = (1.0 - distance * distance).max(0.0);
            cone_m += vent.height_m * dome * dome * dome;
        }
        let inside = place.length() / CRATER_RADIUS_M;
        let rim_m = flank_m(CRATER_RADIUS_M) + 60.0 * self.rock.at(place / 700.0);
        let bowl_m = rim_m + CRATER_DEPTH_M * (inside * inside - 1.0);
        smooth_min(cone_m, bowl_m, 40.0)
    }

    /// Hummocks, 0 to about 1: rounded blocks of two sizes with gaps between them.
    fn mounds(&mut self, place: Vec2) -> f32 {
        let mut blocks = |size: usize, wavelength_m: f32| {
            let block = (self.hummocks[size].at(place / wavelength_m) + 0.05).max(0.0);
            block * block * 4.0
        };
        blocks(0, 420.0) + 0.45 * blocks(1, 190.0)
    }
}

/// The undamaged cone. Concave: some 33 degrees steep near the top, 10 at mid-flank, level at the foot.
fn flank_m(radius_m: f32) -> f32 {
    let flank = (1.0 - radius_m / FOOT_M).max(0.0);
    CONE_M * flank * flank * (0.25 + 0.75 * flank)
}

/// The terrain above the plain after its north flank collapsed into a horseshoe, open to the north; and how near, 0 to
/// 1, its rim is.
fn scarred_m(place: Vec2, cone_m: f32) -> (f32, f32) {
    let along_m = place.y - SCAR_HEAD_M;
    let half_width_m = SCAR_HALF_WIDTH_M + SCAR_WIDENING * along_m.max(0.0);
    let from_axis_m = Vec2::new(place.x, along_m.min(0.0)).length();
    // The floor falls towards the plain and is hollow across; the walls are steep.
    let beyond_m = along_m.max(0.0);
    let fall = (1.0 - beyond_m * beyond_m / ((beyond_m + 500.0) * SCAR_LENGTH_M)).max(0.0);
    let across = from_axis_m / half_width_m;
    let floor_m = SCAR_FLOOR_M * fall * fall + 70.0 * across * across;
    let wall_m = smooth_min(-floor_m, 160.0 - floor_m - 0.95 * (from_axis_m - half_width_m + 150.0), 260.0);
    let crest = ramp(0.0, 130.0, 130.0 - (cone_m + wall_m).abs());
    (smooth_min(cone_m, -wall_m, 130.0), crest)
}

/// Cover by the debris of the collapse: 0 outside the fan north of the scar, 1 inside.
fn fan(place: Vec2) -> f32 {
    let half_width_m = 700.0 + 0.62 * place.y.max(0.0);
    let across = 1.0 - ramp(0.35, 1.0, (place.x / half_width_m).abs());
    across * ramp(1_300.0, 2_600.0, place.y) * (1.0 - ramp(4_200.0, 5_700.0, place.y))
}

/// A vector that wanders with the place.
fn bend(noise: &mut [Fractal; 2], place: Vec2) -> Vec2 {
    Vec2::from(noise.each_mut().map(|noise| noise.at(place)))
}

/// 0 below `low`, 1 above `high`, a smooth step between.
pub(super) fn ramp(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The lower of two heights, rounded off where they are closer than `reach_m`.
fn smooth_min(a: f32, b: f32, reach_m: f32) -> f32 {
    let near = (1.0 - (a - b).abs() / reach_m).max(0.0);
    a.min(b) - near * near * reach_m / 4.0
}
