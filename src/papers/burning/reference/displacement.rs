//! Section 3.4: displacement of a triangle's corner, gravity, the countdown of flammability.

use glam::DVec3;

use super::boundary::{RATE, area};
use super::{State, Tick, Variant};

/// Metres a second squared; one model diagonal counts as a metre.
pub const GRAVITY: f64 = 9.81;
/// No corner passes the middle of an edge.
const HALF: f64 = 0.5;

/// Intersection of the cevians from C to the point at the fraction `l` of B A, and from A to that at `m` of B C.
pub fn cevians([a, b, c]: [DVec3; 3], l: f64, m: f64) -> DVec3 {
    (l * (1.0 - m) * a + (1.0 - l) * (1.0 - m) * b + m * (1.0 - l) * c) / (1.0 - l * m)
}

/// X, Y and Z as they are printed with P1 and P2 exchanged; undefined for a triangle that is edge-on in x y or in y z,
/// and for l = m = 0 (no numbers there, or infinite ones).
pub fn printed([a, b, c]: [DVec3; 3], l: f64, m: f64) -> DVec3 {
    let [p1, p2] = [l * a + (1.0 - l) * b, m * c + (1.0 - m) * b];
    // The printed fraction of the coordinate s, with the coordinate t beside it.
    let printed = |s: usize, t: usize| {
        let above = p1[s] * p2[s] * (a[t] - c[t])
            + p1[s] * a[s] * (c[t] - p2[t])
            + c[s] * p2[s] * (p1[t] - a[t])
            + a[s] * c[s] * (p2[t] - p1[t]);
        above / ((a[s] - p2[s]) * (c[t] - p1[t]) - (c[s] - p1[s]) * (a[t] - p2[t]))
    };
    DVec3::new(printed(0, 1), printed(1, 0), printed(2, 1))
}

/// Displacement(lambda) as a fraction of the edge: beta rho (L / L0) d_mean / d, weaker by phi with both ends heated.
pub fn fraction(weakening: f64, bond: f64, mean_edge: f64, length: f64) -> f64 {
    if length > 0.0 { HALF.min(bond * weakening * mean_edge / length) } else { 0.0 }
}

impl Tick<'_> {
    /// The fractions l and m of corner `k` of a triangle.
    pub(super) fn fractions(&self, state: &State, triangle: usize, k: usize) -> [f64; 2] {
        let vertices = self.model.triangles[triangle].vertices;
        let b = vertices[k];
        let weakening = self.constants.beta * self.constants.rho * f64::from(state.left[b])
            / f64::from(self.constants.flammability);
        [vertices[(k + 2) % 3], vertices[(k + 1) % 3]].map(|end| {
            let bond = if state.labels[end] >= area::INITIAL { self.constants.phi } else { 1.0 };
            fraction(weakening, bond, self.model.mean_edge, state.positions[end].distance(state.positions[b]))
        })
    }

    /// A, B and C with B the corner `k`.
    pub(super) fn corners(&self, state: &State, triangle: usize, k: usize) -> [DVec3; 3] {
        let vertices = self.model.triangles[triangle].vertices;
        [2, 0, 1].map(|step| state.positions[vertices[(k + step) % 3]])
    }

    /// Gravity of one tick: epsilon g dt^2.
    pub(super) fn fall(&self) -> f64 {
        self.constants.epsilon * GRAVITY / (RATE * RATE)
    }

    /// Pass `internal-deformation`. Answers for each vertex by how much its closest decision was made, in lengths:
    /// where that is next to nothing, rounding decides.
    pub fn deform(&self, state: &mut State) -> Vec<f64> {
        if self.variant == Variant::Melting {
            let guides = self.guided(state);
            return self.follow(state, &guides);
        }
        let before = state.clone();
        for v in 0..before.positions.len() {
            if !self.is_active(&before, v) {
                continue;
            }
            let triangles = &self.model.incidence[v];
            let target = |&[t, k]: &[usize; 2]| {
                let corners = self.corners(&before, t, k);
                let [l, m] = self.fractions(&before, t, k);
                let moved = cevians(corners, l, m);
                if self.variant == Variant::Solid { self.contract(moved, corners, l) } else { moved }
            };
            let mean = triangles.iter().map(target).sum::<DVec3>() / triangles.len() as f64;
            state.left[v] -= 1;
            let moved = mean - DVec3::Y * self.fall();
            state.positions[v] =
                if self.variant == Variant::Solid { self.charred(v, moved, state.left[v]) } else { moved };
        }
        vec![f64::INFINITY; before.positions.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::wave;
    use super::*;

    /// Triangles in no special position.
    fn triangles() -> impl Iterator<Item = [DVec3; 3]> {
        (0..200).map(|i| [0, 3, 6].map(|k| DVec3::new(wave(9 * i + k), wave(9 * i + k + 1), wave(9 * i + k + 2))))
    }

    #[test]
    fn the_printed_form_is_the_cevians_crossing_once_p1_and_p2_are_exchanged() {
        let mut compared = 0;
        for triangle in triangles() {
            let [a, b, c] = triangle;
            let normal = (a - b).cross(c - b);
            // Edge-on in x y or y z.
            if normal.x.abs() < 0.1 || normal.z.abs() < 0.1 {
                continue;
            }
            for [l, m] in [[0.5, 0.5], [0.1, 0.4], [0.02, 0.01]] {
                let (ours, theirs) = (cevians(triangle, l, m), printed(triangle, l, m));
                assert!(ours.distance(theirs) < 1e-9, "{triangle:?} {l} {m}: {ours} {theirs}");
                compared += 1;
            }
        }
        assert!(compared > 200, "{compared}");
    }

    #[test]
    fn unheated_corners_stay_and_others_move_inside() {
        for triangle in triangles() {
            let [a, b, c] = triangle;
            assert!(cevians(triangle, 0.0, 0.0).distance(b) < 1e-15);
            assert!(cevians(triangle, 1e-6, 1e-6).distance(b) < 1e-5);
            for [l, m] in [[0.5, 0.5], [0.1, 0.4], [0.999, 0.999], [0.0, 0.3]] {
                let p = cevians(triangle, l, m);
                let n = (b - a).cross(c - a);
                let inside = [[a, b], [b, c], [c, a]].map(|[s, e]| (e - s).cross(p - s).dot(n) / n.length_squared());
                assert!(inside.iter().all(|w| *w >= -1e-9) && (inside.iter().sum::<f64>() - 1.0).abs() < 1e-6);
                // On both cevians.
                let (on_ba, on_bc) = (b.lerp(a, l), b.lerp(c, m));
                assert!((p - c).cross(on_ba - c).length() < 1e-9 && (p - a).cross(on_bc - a).length() < 1e-9);
            }
        }
    }

    #[test]
    fn a_fraction_is_a_length_in_proportion_to_what_burns() {
        assert!((fraction(0.025, 1.0, 0.1, 0.1) - 0.025).abs() < 1e-15);
        assert!((fraction(0.025, 0.5, 0.1, 0.2) - 0.00625).abs() < 1e-15);
        assert_eq!(fraction(0.9, 1.0, 0.1, 0.01), 0.5);
        assert_eq!(fraction(0.9, 1.0, 0.1, 0.0), 0.0);
    }
}
