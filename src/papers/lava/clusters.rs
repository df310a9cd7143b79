//! Clustering on the host (section 5.2): which particles contribute to which four grid planes.

use glam::Vec3;

use super::parameters::Parameters;
use crate::host_block;

host_block! {
    /// A point of a vertex buffer: a particle of a cluster, or an accepted grid point. Metres.
    pub struct Point {
        pub position: [f32; 3],
    }
}

/// The heights that a cluster takes particles from: y_i1 - h to y_i4 + h, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Band {
    low_m: f32,
    high_m: f32,
}

/// The particles of every cluster, lowest cluster first.
pub struct Clusters {
    space_m: Vec3,
    bands: Vec<Band>,
    pub particles: Vec<Vec<Point>>,
}

impl Clusters {
    pub fn new(parameters: &Parameters) -> Self {
        let planes = parameters.density[1];
        let band = |k: u32| Band {
            low_m: parameters.plane_height_m(4 * k) - parameters.radius_m,
            high_m: parameters.plane_height_m((4 * k + 3).min(planes - 1)) + parameters.radius_m,
        };
        let bands: Vec<Band> = (0..parameters.clusters()).map(band).collect();
        Clusters { space_m: parameters.space_m, particles: vec![Vec::new(); bands.len()], bands }
    }

    /// Sorts `positions`, x, y, z and anything, into the clusters. A particle may have left the space by one step; it
    /// counts at the nearest point inside.
    pub fn classify(&mut self, positions: &[[f32; 4]]) {
        self.particles.iter_mut().for_each(Vec::clear);
        for &[x, y, z, _] in positions {
            let place = Vec3::new(x, y, z).clamp(Vec3::ZERO, self.space_m);
            // Bands rise with their index: those that hold y are neighbours.
            let first = self.bands.partition_point(|band| band.high_m < place.y);
            for (band, cluster) in self.bands.iter().zip(&mut self.particles).skip(first) {
                if place.y < band.low_m {
                    break;
                }
                cluster.push(Point { position: place.to_array() });
            }
        }
    }
}
