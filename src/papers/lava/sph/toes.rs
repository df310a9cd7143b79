//! Toes of pahoehoe (section 3.2): the places at which lava breaks out of the skin of a flow that is fed from inside, one after another.
//!
//! A toe takes as much lava as its skin lets in before it holds. Then the flow breaks out where the pressure inside is greatest beside the
//! skin's strength, which grows with its thickness, the root of its age (Hon et al. 1994), and is scattered as that of what breaks by its flaws
//! (Weibull 1951). Toes branch from toes so at random as in Crown and Baloga (1999) and Hamilton et al. (2013).

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::vent::Vent;
use crate::scene::random::Random;

/// Most toes of a flow.
pub const MOST_TOES: f64 = 500.0;
/// Height of a toe over its radius.
const FLATNESS: f64 = 0.75;
/// Toes have between a half and one and a half times the mean's volume.
pub const LEAST_VOLUME: f32 = 0.5;
/// Places on a toe's rim at which it may break.
const PLACES: u32 = 16;
/// Distance of a break from its toe's middle, over the radius: the skin breaks at the foot, inside the rim.
const RIM: f64 = 0.8;
/// Nearest that a toe's middle comes to another one's but its own toe's, over the sum of their radii.
const ROOM: f64 = 0.8;
/// Weibull's modulus of the skin's strength.
const MODULUS: f64 = 3.0;

/// Radius of a toe, half a ball that is flattened, of this volume in cubic metres.
pub fn radius_m(volume_m3: f64) -> f64 {
    (volume_m3 / (2.0 / 3.0 * PI * FLATNESS)).cbrt()
}

/// A toe, in metres along x and z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Toe {
    /// Lava that was out as it broke out, cubic metres.
    pub first_m3: f64,
    /// Lava that it takes, cubic metres.
    pub volume_m3: f64,
    /// Its first place: the break in the skin that it came from.
    pub break_m: DVec2,
    /// Unit vector away from the toe that it came from; 0 of the first, which stays over the vent.
    pub way: DVec2,
    /// Toe that it came from: its own number of the first.
    pub parent: usize,
}

impl Toe {
    /// Its middle as it has so much lava: it grows away from the break, where its rim stays.
    pub fn middle_m(&self, volume_m3: f64) -> DVec2 {
        self.break_m + radius_m(volume_m3) * self.way
    }

    /// Middle and radius once it has all of its lava.
    pub fn full(&self) -> (DVec2, f64) {
        (self.middle_m(self.volume_m3), radius_m(self.volume_m3))
    }
}

/// Number of the toe that is fed as so much lava is out; 0 where there are none.
pub fn toe_of(toes: &[Toe], out_m3: f64) -> u32 {
    toes.partition_point(|toe| toe.first_m3 <= out_m3).saturating_sub(1) as u32
}

/// A break that may come.
struct Break {
    toe: Toe,
    /// Pressure over strength.
    load: f64,
}

/// Toes of a vent until so much lava is out, on a plane that falls by `fall` for each metre along x, in a space of these sides along x and z.
pub fn toes(vent: &Vent, out_m3: f64, fall: f64, sides_m: DVec2, seed: u64) -> Vec<Toe> {
    let mut random = Random::with_stream(seed, 4);
    let source_m = DVec2::from(vent.middle_m.map(f64::from));
    let low = DVec2::splat(f64::from(vent.radius_m));
    let mut toes: Vec<Toe> = Vec::new();
    let mut circles: Vec<(DVec2, f64)> = Vec::new();
    let mut first_m3 = 0.0;
    while first_m3 < out_m3 && toes.len() < 2 * MOST_TOES as usize {
        let volume_m3 = f64::from(vent.toe_m3) * f64::from(random.range(LEAST_VOLUME, 2.0 - LEAST_VOLUME));
        let mut toe = Toe { first_m3, volume_m3, break_m: source_m, way: DVec2::ZERO, parent: toes.len() };
        if !toes.is_empty() {
            let mut breaks = breaks(&toes, &toe, |place_m| (place_m.x - source_m.x) * fall, &mut random);
            breaks.sort_by(|a, b| b.load.total_cmp(&a.load));
            let is_inside = |middle_m: DVec2| middle_m.cmpge(low).all() && middle_m.cmple(sides_m - low).all();
            let has_room = |next: &Toe| {
                let (middle_m, radius_m) = next.full();
                let apart = |(at, &(other_m, other_radius_m)): (usize, &(DVec2, f64))| {
                    at == next.parent || middle_m.distance(other_m) >= ROOM * (radius_m + other_radius_m)
                };
                is_inside(middle_m) && circles.iter().enumerate().all(apart)
            };
            let weakest = |fits: &dyn Fn(&Toe) -> bool| breaks.iter().map(|next| next.toe).find(|toe| fits(toe));
            // Where there is no room left a toe overruns others, and last of all swells over the vent.
            toe = weakest(&has_room).or_else(|| weakest(&|next| is_inside(next.full().0))).unwrap_or(toe);
        }
        first_m3 += volume_m3;
        circles.push(toe.full());
        toes.push(toe);
    }
    toes
}

/// The breaks on the rims of all toes from which this one may come. `drop_m` is how far the ground has fallen from the vent to a place.
fn breaks(toes: &[Toe], next: &Toe, drop_m: impl Fn(DVec2) -> f64, random: &mut Random) -> Vec<Break> {
    let mut breaks = Vec::with_capacity(toes.len() * PLACES as usize);
    for (parent, toe) in toes.iter().enumerate() {
        let (middle_m, radius_m) = toe.full();
        let age_m3 = next.first_m3 - toe.first_m3 - 0.5 * toe.volume_m3;
        let turned = f64::from(random.unit());
        for place in 0..PLACES {
            let way = DVec2::from_angle(TAU * (f64::from(place) + turned) / f64::from(PLACES));
            let break_m = middle_m + RIM * radius_m * way;
            // From 0 to below 1: the logarithm's argument is above 0.
            let flaw = (-(1.0 - f64::from(random.unit())).ln()).powf(1.0 / MODULUS);
            let head_m = (FLATNESS * radius_m + drop_m(break_m)).max(0.0);
            let load = head_m / (flaw.max(1e-3) * age_m3.sqrt());
            breaks.push(Break { toe: Toe { break_m, way, parent, ..*next }, load });
        }
    }
    breaks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vent() -> Vent {
        Vent { effusion_m3_s: 0.01, middle_m: [1.5, 1.0], radius_m: 0.08, toe_m3: 0.005 }
    }

    fn of(fall: f64, seed: u64) -> Vec<Toe> {
        toes(&vent(), 0.1, fall, DVec2::new(3.0, 2.0), seed)
    }

    #[test]
    fn toes_share_all_lava_and_touch_the_toe_that_they_come_from() {
        for seed in 0..20 {
            let toes = of(0.1, seed);
            assert_eq!(toes, of(0.1, seed));
            assert!((14..=28).contains(&toes.len()), "{}", toes.len());
            let mut first_m3 = 0.0;
            for (at, toe) in toes.iter().enumerate() {
                assert!((toe.first_m3 - first_m3).abs() < 1e-12 && (0.0025..=0.0075).contains(&toe.volume_m3));
                first_m3 += toe.volume_m3;
                // A ball of that radius, flattened to three quarters, halved.
                let (middle_m, radius) = toe.full();
                assert!((2.0 / 3.0 * PI * 0.75 * radius.powi(3) / toe.volume_m3 - 1.0).abs() < 1e-12);
                if at == 0 {
                    assert_eq!((toe.parent, middle_m), (0, DVec2::new(1.5, 1.0)));
                    continue;
                }
                assert!(toe.parent < at);
                let (parent_m, parent_radius) = toes[toe.parent].full();
                assert!((middle_m.distance(parent_m) - 0.8 * parent_radius - radius).abs() < 1e-9);
                for (other, before) in toes[..at].iter().enumerate() {
                    let (other_m, other_radius) = before.full();
                    let apart = middle_m.distance(other_m) / (radius + other_radius);
                    assert!(other == toe.parent || apart >= 0.8 - 1e-9, "{seed}, {at}, {other}: {apart}");
                }
            }
            assert!(first_m3 >= 0.1);
        }
    }

    /// On level ground as often to either side, on a slope downhill; not only from the last one.
    #[test]
    fn toes_break_out_downhill_of_old_and_new() {
        let ways = |fall: f64| {
            let all: Vec<Toe> = (0..50).flat_map(|seed| of(fall, seed)).collect();
            let count = all.len() as f64;
            let mean = all.iter().map(|toe| toe.way).sum::<DVec2>() / count;
            let others = (0..50).flat_map(|seed| {
                let toes = of(fall, seed);
                (1..toes.len()).filter(move |at| toes[*at].parent + 1 != *at).collect::<Vec<_>>()
            });
            (mean, others.count() as f64 / count)
        };
        let (level, sloping) = (ways(0.0), ways(0.2));
        println!("{level:?} {sloping:?}");
        assert!(level.0.length() < 0.08 && sloping.0.x > 0.08 && sloping.0.y.abs() < 0.06);
        assert!((0.1..0.5).contains(&level.1) && (0.1..0.5).contains(&sloping.1));
    }

    #[test]
    fn toes_without_room_overrun_others() {
        let vent = Vent { middle_m: [0.5, 1.0], ..vent() };
        let toes = toes(&vent, 0.5, 0.1, DVec2::new(1.0, 2.0), 1);
        assert!(toes.len() > 80);
        for toe in &toes {
            let (middle_m, _) = toe.full();
            assert!(middle_m.cmpge(DVec2::splat(0.0799)).all() && middle_m.cmple(DVec2::new(0.9201, 1.9201)).all());
        }
    }
}
