//! The layer of fire and smoke: particles as squares that face the viewer, one over the other.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::flames::Particle;
use super::lights::{HALF_SQUARE, Light, flame, noise, smoothstep};

/// The picture that the layer goes over.
#[derive(Debug, Clone, Copy)]
pub struct Viewer {
    /// From places to clip coordinates.
    pub to_clip: DMat4,
    /// The picture's axes in space, unit vectors.
    pub right: DVec3,
    /// Upwards.
    pub up: DVec3,
    /// Pixels of the layer along x and y.
    pub size: [u32; 2],
    /// Of a particle, diagonals.
    pub radius: f64,
}

/// A square in the layer.
#[derive(Debug, Clone, Copy)]
pub struct Square {
    middle: DVec2,
    /// From the middle to the sides to the right and above.
    half: DVec2,
    /// Along the view, diagonals.
    distance: f64,
    age: f64,
    own: f64,
    /// Linear RGB of smoke, and its opacity; of fire none.
    smoke: Option<(DVec3, f64)>,
}

impl Viewer {
    fn square(&self, particle: &Particle, half: DVec2, smoke: Option<(DVec3, f64)>) -> Square {
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        let seen = |place: DVec3| {
            let clip = self.to_clip * place.extend(1.0);
            ((DVec2::new(clip.x, clip.y) / clip.w + 1.0) / 2.0 * size - 0.5, clip.w)
        };
        let (middle, distance) = seen(particle.position);
        let half = self.radius * half;
        let right = seen(particle.position + half.x * self.right).0;
        let up = seen(particle.position + half.y * self.up).0;
        let half = DVec2::new(right.x - middle.x, up.y - middle.y);
        Square { middle, half, distance, age: age(particle), own: particle.own[0], smoke }
    }

    /// The square of a flame.
    pub fn fire(&self, particle: &Particle) -> Square {
        let age = age(particle);
        let height = smoothstep(0.0, 0.15, age) * (1.0 - 0.5 * age) * (0.75 + 0.25 * particle.own[1]);
        self.square(particle, HALF_SQUARE * height, None)
    }

    /// The square of a particle of smoke, in the light of the flames or, without lights, by itself.
    pub fn smoke(&self, particle: &Particle, lights: Option<&[Light]>) -> Square {
        let age = age(particle);
        let side = (0.45 + 0.55 * age) * (0.75 + 0.25 * particle.own[1]);
        let grey = match lights {
            Some(lights) => {
                let of = |light: &Light| {
                    let squared = light.place.distance_squared(particle.position) + light.radius * light.radius;
                    light.intensity * (0.25 / squared)
                };
                0.1 + 0.4 * lights.iter().map(of).sum::<DVec3>()
            }
            None => DVec3::new(0.11, 0.075, 0.05).lerp(DVec3::splat(0.1), smoothstep(0.0, 0.5, age)),
        };
        let opacity = 0.3 * smoothstep(0.0, 0.2, age) * (1.0 - age);
        self.square(particle, DVec2::splat(side), Some((grey, opacity)))
    }

    /// A pixel of the layer before a mesh at this distance, of squares in their order; and how near one of their sides
    /// comes to its middle, in pixels.
    pub fn pixel(&self, at: DVec2, mesh: f64, squares: &[Square]) -> (DVec4, f64) {
        let mut sum = DVec4::ZERO;
        let mut margin = f64::INFINITY;
        for square in squares {
            let place = (at - square.middle) / square.half;
            let shown = ((mesh - square.distance) / self.radius).clamp(0.0, 1.0);
            if shown == 0.0 {
                continue;
            }
            let color = match square.smoke {
                None => (shown * flame(place, square.age, square.own)).extend(0.0),
                Some((grey, opacity)) => {
                    let DVec2 { x, y } = DVec2::new(47.0, 31.0) * square.own;
                    let turbulence = noise(1.6 * place + DVec2::new(x, y - 1.2 * square.age));
                    let body = (1.0 - place.length() - 0.7 * (turbulence - 0.3)).clamp(0.0, 1.0);
                    grey.extend(1.0) * (shown * opacity * body)
                }
            };
            if color != DVec4::ZERO {
                let over = (place.abs() - 1.0) * square.half.abs();
                margin = margin.min(over.max_element().abs());
            }
            if place.abs().max_element() <= 1.0 {
                sum = sum * (1.0 - color.w) + color;
            }
        }
        (sum, margin)
    }
}

fn age(particle: &Particle) -> f64 {
    (f64::from(particle.age) / f64::from(particle.life)).clamp(0.0, 1.0)
}
