//! A viscous fluid of particles (chapter 9, "Improved particle simulation"), each against every other.

use glam::{DVec2, DVec3};

/// The fluid's numbers, in metres, seconds and kilograms.
pub struct Fluid {
    /// Extent of the space along x, y and z, from 0 on; y has no upper end.
    pub space: DVec3,
    /// The ground at a place along x and z: its slopes along both, and its height.
    pub bed: Box<dyn Fn(DVec2) -> DVec3>,
    /// Distance of the particles at rest.
    pub spacing: f64,
    /// Radius of the kernel.
    pub support: f64,
    /// Time of one step.
    pub step: f64,
    /// Viscosity over density.
    pub kinematic: f64,
    /// Nearest that a particle comes to a wall.
    pub margin: f64,
    /// x and z repeat instead of having walls.
    pub is_periodic: bool,
}

/// A wall from a place.
pub(super) struct Wall {
    /// Metres from the place to it.
    pub(super) distance: f64,
    /// Away from it.
    pub(super) normal: DVec3,
    /// Of the pair that it belongs to; 1 of the bed.
    pub(super) axis: usize,
}

/// Wendland's kernel C2: 21 / (2 pi h^3) (1 - q)^4 (1 + 4 q).
pub(super) fn wendland(distance: f64, support: f64) -> f64 {
    let q = distance / support;
    if q >= 1.0 { 0.0 } else { 21.0 / (std::f64::consts::TAU * support.powi(3)) * (1.0 - q).powi(4) * (1.0 + 4.0 * q) }
}

/// Its derivative by the distance, by differences.
pub(super) fn wendland_slope(distance: f64, support: f64) -> f64 {
    let small = 1e-6 * support;
    let low = (distance - small).max(0.0);
    (wendland(distance + small, support) - wendland(low, support)) / (distance + small - low)
}

/// Integral from `low` to `high` by Simpson's rule.
pub(super) fn integral(low: f64, high: f64, of: impl Fn(f64) -> f64) -> f64 {
    const PARTS: usize = 64;
    let step = (high - low) / PARTS as f64;
    let weight = |at: usize| if at == 0 || at == PARTS { 1.0 } else { 2.0 + 2.0 * (at % 2) as f64 };
    (0..=PARTS).map(|at| weight(at) * of(low + step * at as f64)).sum::<f64>() * step / 3.0
}

impl Fluid {
    pub(super) fn apart(&self, a: DVec3, b: DVec3) -> DVec3 {
        let mut offset = a - b;
        if self.is_periodic {
            offset.x -= self.space.x * (offset.x / self.space.x).round();
            offset.z -= self.space.z * (offset.z / self.space.z).round();
        }
        offset
    }

    /// Factors of a particle's volume with which a cubic lattice has the density 1 and the Laplacian of a parabola.
    pub(super) fn volumes(&self) -> (f64, f64) {
        let range = -3..=3;
        let lattice = range.clone().flat_map(|x| range.clone().flat_map(move |y| (-3..=3).map(move |z| (x, y, z))));
        let (mut density, mut laplacian) = (0.0, 0.0);
        for (x, y, z) in lattice {
            let place = self.spacing * DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let distance = place.length();
            let volume = self.spacing.powi(3);
            density += volume * wendland(distance, self.support);
            if distance > 0.0 {
                laplacian -= volume * wendland_slope(distance, self.support) / distance * place.y * place.y;
            }
        }
        (self.spacing.powi(3) / density, self.spacing.powi(3) / laplacian)
    }

    /// Distances to walls and the directions away from them, of the bed to the plane that touches it below, by axis.
    pub(super) fn walls(&self, place: DVec3) -> Vec<Wall> {
        let DVec3 { x: along_x, y: along_z, z: height } = (self.bed)(DVec2::new(place.x, place.z));
        let normal = DVec3::new(-along_x, 1.0, -along_z).normalize();
        let bed = Wall { distance: ((place.y - height) * normal.y).max(0.0), normal, axis: 1 };
        let sides = [
            Wall { distance: place.x, normal: DVec3::X, axis: 0 },
            Wall { distance: self.space.x - place.x, normal: DVec3::NEG_X, axis: 0 },
            Wall { distance: place.z, normal: DVec3::Z, axis: 2 },
            Wall { distance: self.space.z - place.z, normal: DVec3::NEG_Z, axis: 2 },
        ];
        [bed].into_iter().chain(sides.into_iter().filter(|_| !self.is_periodic)).collect()
    }

    /// The kernel integrated over a plane at a distance.
    pub(super) fn over_plane(&self, distance: f64) -> f64 {
        if distance >= self.support {
            return 0.0;
        }
        integral(distance, self.support, |r| std::f64::consts::TAU * r * wendland(r, self.support))
    }

    /// The kernel integrated over all that lies beyond a wall at a distance.
    pub(super) fn beyond(&self, distance: f64) -> f64 {
        if distance >= self.support { 0.0 } else { integral(distance, self.support, |z| self.over_plane(z)) }
    }

    /// Drag of a wall: as if the speed beyond it went on linearly through 0 at the wall.
    fn wall_drag(&self, distance: f64) -> f64 {
        if distance >= self.support {
            return 0.0;
        }
        integral(distance, self.support, |z| self.drag_of_plane(z) * z) / distance
    }

    /// The kernel's slope over the distance, integrated over a plane.
    pub(super) fn drag_of_plane(&self, z: f64) -> f64 {
        integral(z, self.support, |r| -std::f64::consts::TAU * r * wendland_slope(r, self.support) / r.max(1e-12))
    }

    /// Density over that at rest and the constraint's factor, lambda, in metres squared.
    pub fn constraint(&self, places: &[DVec3], at: usize, softness: f64) -> (f64, f64) {
        let (volume, _) = self.volumes();
        let (mut density, mut own, mut others) = (0.0, DVec3::ZERO, 0.0);
        for (i, &other) in places.iter().enumerate() {
            let offset = self.apart(places[at], other);
            let distance = offset.length();
            density += volume * wendland(distance, self.support);
            if i != at && distance > 0.0 {
                let gradient = volume * wendland_slope(distance, self.support) * offset / distance;
                own += gradient;
                others += gradient.length_squared();
            }
        }
        for Wall { distance, normal, .. } in self.walls(places[at]) {
            density += self.beyond(distance);
            own -= self.over_plane(distance) * normal;
        }
        let softness = softness / (self.support * self.support);
        (density, -(density - 1.0).max(0.0) / (own.length_squared() + others + softness))
    }

    /// A particle's place after one correction with these factors.
    pub fn corrected(&self, places: &[DVec3], factors: &[f64], at: usize) -> DVec3 {
        let (volume, _) = self.volumes();
        let mut push = DVec3::ZERO;
        for (i, &other) in places.iter().enumerate() {
            let offset = self.apart(places[at], other);
            if i != at && offset.length() > 0.0 {
                let slope = wendland_slope(offset.length(), self.support);
                push += (factors[at] + factors[i]) * volume * slope * offset.normalize();
            }
        }
        for Wall { distance, normal, .. } in self.walls(places[at]) {
            push -= factors[at] * self.over_plane(distance) * normal;
        }
        self.inside(places[at] + push)
    }

    fn inside(&self, place: DVec3) -> DVec3 {
        let low = DVec3::splat(self.margin);
        let clamped = place.clamp(low, self.space - low);
        let across = if self.is_periodic { place } else { clamped };
        let ground = (self.bed)(DVec2::new(across.x, across.z));
        // As far above the ground as a plane that steep is when its distance is the margin.
        let lowest = ground.z + self.margin * (1.0 + ground.x * ground.x + ground.y * ground.y).sqrt();
        DVec3::new(across.x, clamped.y.max(lowest), across.z)
    }

    /// Residual of the equation of implicit viscosity for one particle: `before` after gravity, `after` after viscosity,
    /// `viscosities` over the melt's.
    pub fn viscous_residual(
        &self,
        places: &[DVec3],
        viscosities: &[f64],
        [before, after]: [&[DVec3]; 2],
        at: usize,
    ) -> DVec3 {
        let (_, volume) = self.volumes();
        let rate = 2.0 * self.step * self.kinematic;
        let mut braked = after[at];
        for (i, &other) in places.iter().enumerate() {
            let distance = self.apart(places[at], other).length();
            if i != at && distance > 0.0 {
                let drag = -wendland_slope(distance, self.support) / distance;
                // Half as resistant as both in a row.
                let viscosity = 2.0 / (1.0 / viscosities[at] + 1.0 / viscosities[i]);
                braked += rate * viscosity * volume * drag * (after[at] - after[i]);
            }
        }
        for Wall { distance, .. } in self.walls(places[at]) {
            braked += rate * viscosities[at] * self.wall_drag(distance) * after[at];
        }
        before[at] - braked
    }
}
