//! Stage one: listing 5.1 and the clusters of section 5.2.

use glam::DVec3;

/// Moves one particle: position in metres, velocity in metres per second, a step of `time_s`.
pub fn step(position: &mut DVec3, velocity: &mut DVec3, space: DVec3, time_s: f64) {
    if position.x >= space.x {
        position.x = 0.0;
    }
    for axis in [1, 2] {
        let speed = velocity[axis].abs();
        if position[axis] >= space[axis] {
            velocity[axis] = -speed;
        }
        if position[axis] <= 0.0 {
            velocity[axis] = speed;
        }
    }
    *position += *velocity * time_s;
}

/// The particles of every cluster as indices into `heights`, by testing each particle against each cluster: four
/// successive ones of `planes`, the last cluster perhaps fewer.
pub fn clusters(heights: &[f64], planes: &[f64], radius: f64) -> Vec<Vec<usize>> {
    let members = |four: &[f64]| {
        let lowest = four.iter().copied().fold(f64::INFINITY, f64::min) - radius;
        let highest = four.iter().copied().fold(f64::NEG_INFINITY, f64::max) + radius;
        heights.iter().enumerate().filter(|&(_, y)| lowest <= *y && *y <= highest).map(|(i, _)| i).collect()
    };
    planes.chunks(4).map(members).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_turn_particles_before_they_move() {
        let space = DVec3::new(4.0, 1.0, 1.0);
        let moved = |mut p: DVec3, mut v: DVec3| {
            step(&mut p, &mut v, space, 0.5);
            (p, v)
        };
        let v = DVec3::new(0.2, 0.1, -0.1);
        assert_eq!(moved(DVec3::new(1.0, 0.5, 0.5), v), (DVec3::new(1.1, 0.55, 0.45), v));
        assert_eq!(moved(DVec3::new(4.05, 0.5, 0.5), v).0.x, 0.1);
        assert_eq!(moved(DVec3::new(1.0, 1.0, -0.01), v), (DVec3::new(1.1, 0.95, 0.04), DVec3::new(0.2, -0.1, 0.1)));
    }

    #[test]
    fn a_particle_counts_in_every_cluster_that_it_reaches() {
        let planes = [0.1, 0.3, 0.5, 0.7, 0.9];
        let found = clusters(&[0.0, 0.7, 0.8, 1.0, 1.1], &planes, 0.15);
        assert_eq!(found, [vec![0, 1, 2], vec![2, 3]]);
    }
}
