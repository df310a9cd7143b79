//! Parts that fall (ours, not the dissertation's): what hangs together, and a tick of a rigid part, in `f64` from the
//! equations of motion.

use glam::{DMat3, DQuat, DVec3};

use super::boundary::RATE;
use super::displacement::GRAVITY;

/// Directions in which a part may topple, and in which the contacts of its foot are looked for.
const DIRECTIONS: usize = 8;
/// Slope of the planes that look for contacts.
const LEAN: f64 = 0.1;
/// Of the ground, in diagonals.
const NEAR_GROUND: f64 = 0.01;
/// Distance beyond its foot by which a toppling part leans out, in diagonals.
const MARGIN: f64 = 0.005;
/// Coulomb's.
const FRICTION: f64 = 0.6;
/// Of the spin, what rolling leaves after a tick on the ground.
const ROLLING: f64 = 0.98;
/// Speed below which what stands comes to rest.
const STILL: f64 = 0.04;
/// Rounds over the contacts.
const ROUNDS: usize = 24;
/// Added to each principal moment, diagonals squared.
const THINNEST: f64 = 1e-6;

/// The lowest vertex that each one hangs together with by triangles that are there and by pairs that hold.
pub fn components(count: usize, triangles: &[[usize; 3]], pairs: &[[usize; 2]]) -> Vec<usize> {
    let mut around = vec![Vec::new(); count];
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]).chain(pairs.iter().copied());
    for [a, b] in sides {
        around[a].push(b);
        around[b].push(a);
    }
    let mut lowest = vec![usize::MAX; count];
    for root in 0..count {
        let mut open = vec![root];
        while let Some(at) = open.pop() {
            if lowest[at] == usize::MAX {
                lowest[at] = root;
                open.extend(&around[at]);
            }
        }
    }
    lowest
}

/// A rigid part: a place p of the object is at `turn * p + offset`.
#[derive(Debug, Clone, Copy)]
pub struct Body {
    /// Rotation since rest, of unit length.
    pub orientation: DQuat,
    /// Displacement after the rotation, in diagonals.
    pub offset: DVec3,
    /// It lies still, and takes part in no further tick.
    pub rests: bool,
    /// Of the centre of mass.
    pub velocity: DVec3,
    /// Angular velocity, radians a second, in the axes of the world.
    pub spin: DVec3,
}

/// Centre of mass, and moments of inertia about it over the weight, in the axes of the object.
pub fn moments(places: &[DVec3], weights: &[f64]) -> (DVec3, DMat3) {
    let total: f64 = weights.iter().sum();
    let center = places.iter().zip(weights).map(|(&p, &w)| w * p).sum::<DVec3>() / total;
    let mut inertia = DMat3::from_diagonal(DVec3::splat(THINNEST));
    for (&place, &weight) in places.iter().zip(weights) {
        let r = place - center;
        let outer = DMat3::from_cols(r * r.x, r * r.y, r * r.z);
        inertia += (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer) * (weight / total);
    }
    (center, inertia)
}

impl Body {
    pub fn world(&self, place: DVec3) -> DVec3 {
        self.orientation * place + self.offset
    }

    fn inertia(&self, own: DMat3) -> DMat3 {
        let axes = DMat3::from_quat(self.orientation);
        axes * own * axes.transpose()
    }

    /// Kinetic and potential energy over the weight.
    pub fn energy(&self, center: DVec3, own: DMat3, floor: f64) -> f64 {
        let turning = self.spin.dot(self.inertia(own) * self.spin);
        (self.velocity.length_squared() + turning) / 2.0 + GRAVITY * (self.world(center).y - floor)
    }

    /// True where the centre of mass lies over what touches the ground.
    pub fn stands(&self, places: &[DVec3], center: DVec3, floor: f64) -> bool {
        let feet: Vec<DVec3> = places.iter().map(|p| self.world(*p)).filter(|p| p.y <= floor + NEAR_GROUND).collect();
        let at = self.world(center);
        (0..DIRECTIONS).map(direction).all(|d| feet.iter().any(|p| d.dot(*p - at) >= -MARGIN))
    }

    /// The part 1/60 s later; what lies still begins to fall with the next step. Answers also by how much its contacts were chosen, in lengths.
    pub fn step(&self, places: &[DVec3], weights: &[f64], floor: f64) -> (Body, f64) {
        let (center, own) = moments(places, weights);
        let stands = self.stands(places, center, floor);
        if self.rests {
            return (Body { rests: stands, ..*self }, f64::INFINITY);
        }
        let dt = 1.0 / RATE;
        let mut next = Body { rests: false, velocity: self.velocity - DVec3::Y * GRAVITY * dt, ..*self };
        let inverse = self.inertia(own).inverse();
        let at = self.world(center);
        let world: Vec<DVec3> = places.iter().map(|p| self.world(*p)).collect();
        let mut margin = f64::INFINITY;
        let leaning = (0..DIRECTIONS).map(|k| DVec3::Y - LEAN * direction(k)).chain([DVec3::Y]);
        let contacts: Vec<DVec3> = leaning
            .map(|up| {
                let mut heights: Vec<(f64, DVec3)> = world.iter().map(|p| (up.dot(*p), *p)).collect();
                heights.sort_by(|a, b| a.0.total_cmp(&b.0));
                margin = heights.get(1).map_or(margin, |second| margin.min(second.0 - heights[0].0));
                heights[0].1
            })
            .collect();
        // What an impulse of 1 along n at r adds to the velocity there, along n.
        let yielding = |r: DVec3, n: DVec3| 1.0 + (inverse * r.cross(n)).cross(r).dot(n);
        let mut touches = false;
        for _ in 0..ROUNDS {
            for &contact in &contacts {
                let r = contact - at;
                let least = -(contact.y - floor).max(0.0) / dt;
                let u = next.velocity + next.spin.cross(r);
                if u.y >= least {
                    continue;
                }
                touches = true;
                let impulse = (least - u.y) / yielding(r, DVec3::Y);
                next.velocity += impulse * DVec3::Y;
                next.spin += inverse * r.cross(impulse * DVec3::Y);
                let u = next.velocity + next.spin.cross(r);
                let sliding = DVec3::new(u.x, 0.0, u.z);
                if sliding.length() > 1e-6 {
                    let along = sliding.normalize();
                    let rubbing = (FRICTION * impulse).min(sliding.length() / yielding(r, along));
                    next.velocity -= rubbing * along;
                    next.spin -= inverse * r.cross(rubbing * along);
                }
            }
        }
        next.spin *= if touches { ROLLING } else { 1.0 };
        let extent = ((own.x_axis.x + own.y_axis.y + own.z_axis.z) / 2.0).sqrt();
        if stands && next.velocity.length() + extent * next.spin.length() < STILL {
            return (Body { rests: true, velocity: DVec3::ZERO, spin: DVec3::ZERO, ..*self }, margin);
        }
        next.orientation = (DQuat::from_scaled_axis(next.spin * dt) * self.orientation).normalize();
        let at = at + next.velocity * dt;
        next.offset = at - next.orientation * center;
        // Angular momentum goes on.
        let momentum = self.inertia(own) * next.spin;
        let carried = next.inertia(own).inverse() * momentum;
        let (had, given) = (next.spin.dot(momentum), carried.dot(momentum));
        next.spin = if given > had { carried * (had / given).sqrt() } else { carried };
        let (before, after) = (self.energy(center, own, floor), next.energy(center, own, floor));
        if after > before {
            let height = GRAVITY * (at.y - floor);
            if height > before {
                return (Body { rests: false, velocity: DVec3::ZERO, spin: DVec3::ZERO, ..*self }, margin);
            }
            let kept = ((before - height) / (after - height)).sqrt();
            next.velocity *= kept;
            next.spin *= kept;
        }
        (next, margin)
    }
}

fn direction(k: usize) -> DVec3 {
    let angle = k as f64 * std::f64::consts::FRAC_PI_4;
    DVec3::new(angle.cos(), 0.0, angle.sin())
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::boxed;
    use super::*;

    #[test]
    fn a_chain_breaks_where_a_link_leaves() {
        let whole = [[0, 1, 2], [2, 3, 4], [4, 5, 6]];
        assert_eq!(components(8, &whole, &[]), [0, 0, 0, 0, 0, 0, 0, 7]);
        assert_eq!(components(8, &[whole[0], whole[2]], &[]), [0, 0, 0, 3, 4, 4, 4, 7]);
        assert_eq!(components(8, &[whole[0], whole[2]], &[[1, 6]]), [0, 0, 0, 3, 0, 0, 0, 7]);
    }

    #[test]
    fn a_tilted_box_topples_loses_energy_and_comes_to_rest_on_a_side() {
        let (places, _) = boxed();
        let weights = vec![1.0; places.len()];
        let (center, own) = moments(&places, &weights);
        let orientation = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(0.2);
        let lowest = places.iter().map(|p| (orientation * *p).y).fold(f64::INFINITY, f64::min);
        let offset = DVec3::Y * (0.1 - lowest);
        let mut body = Body { orientation, offset, rests: false, velocity: DVec3::ZERO, spin: DVec3::ZERO };
        let mut energy = body.energy(center, own, 0.0);
        for tick in 0..400 {
            body = body.step(&places, &weights, 0.0).0;
            let now = body.energy(center, own, 0.0);
            assert!(now <= energy + 1e-12, "tick {tick}: {now} after {energy}");
            energy = now;
            let lowest = places.iter().map(|p| body.world(*p).y).fold(f64::INFINITY, f64::min);
            assert!(lowest > -0.004, "tick {tick}: {lowest}");
        }
        assert!(body.velocity.length() < STILL, "{body:?}");
        let heights = places.iter().map(|p| body.world(*p).y);
        assert!(heights.filter(|y| *y < 0.02).count() >= 6, "on an edge at least: each corner is there three times");
    }

    #[test]
    fn free_flight_keeps_momentum_and_falls_by_half_g_t_squared() {
        let (places, _) = boxed();
        let weights: Vec<f64> = (0..places.len()).map(|i| 1.0 + i as f64).collect();
        let (center, own) = moments(&places, &weights);
        let start = DVec3::new(0.0, 50.0, 0.0);
        let spin = DVec3::new(1.0, 2.0, -0.5);
        let mut body = Body { orientation: DQuat::IDENTITY, offset: start, rests: false, velocity: DVec3::X, spin };
        let momentum = body.inertia(own) * spin;
        let from = body.world(center);
        for _ in 0..60 {
            body = body.step(&places, &weights, 0.0).0;
        }
        let moved = body.world(center) - from;
        // Semi-implicit: half a tick's velocity more than the parabola.
        assert!(moved.distance(DVec3::new(1.0, -GRAVITY / 2.0 * (1.0 + 1.0 / 60.0), 0.0)) < 1e-9, "{moved}");
        let now = body.inertia(own) * body.spin;
        assert!(now.angle_between(momentum) < 1e-9 && now.length() <= momentum.length() + 1e-12);
        assert!(now.length() > 0.9 * momentum.length(), "{} of {}", now.length(), momentum.length());
    }
}
