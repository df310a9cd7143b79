//! Sizes that follow from the parameters.

use super::cluster::Point;
use super::culling;
use super::deferred::SplatShading;
use super::gpu_driven;
use super::parameters::{Parameters, SurfaceDraw, Variant};
use super::rock::Rock;
use super::sph;
use super::sph::parameters::Simulation;
use crate::measure::estimate::Estimate;
use crate::scene::Mesh;

/// Bytes of a texel of four floats.
pub const TEXEL: f64 = 16.0;

impl Parameters {
    /// Device memory, passes and fragments of a frame.
    pub fn estimate(&self, variant: Variant, rock: &Rock, objects: &[Mesh]) -> Estimate {
        let first_stages = match variant {
            Variant::Paper => self.read_back_estimate(),
            Variant::GpuDriven => gpu_driven::estimate(self),
        };
        let splats = f64::from(self.splats[0]) * f64::from(self.splats[1]);
        let pixels = f64::from(self.width) * f64::from(self.height);
        let vertices: usize = objects.iter().map(|mesh| mesh.positions.len()).sum();
        let indices: usize = objects.iter().map(|mesh| mesh.indices.len()).sum();
        let is_deferred = self.splat_shading == SplatShading::Deferred;
        let is_splatted = self.surface_draw(variant) == SurfaceDraw::Splats;
        let blended = if is_deferred && is_splatted { 2.0 * TEXEL } else { 0.0 };
        let bytes = [
            ("size", (TEXEL + 8.0 + blended) * pixels),
            ("rock", size_of_val(&rock.texels[..]) as f64),
            ("object", 24.0 * vertices as f64 + 4.0 * indices as f64),
        ];
        let flow = match self.simulation {
            Simulation::Free => Estimate::default(),
            Simulation::Sph => sph::estimate::estimate(self),
        };
        let detail = self.flow.crust.detail(self).unwrap_or(1);
        let cells = |columns: u32| f64::from(detail) * f64::from(columns) + 1.0;
        let patches = TEXEL * cells(self.density[0]) * cells(self.density[2]);
        let (drawn_bytes, buffers, invocations) = match self.surface_draw(variant) {
            SurfaceDraw::Splats => {
                let splat_bytes = 8.0 * splats + culling::bytes(self);
                let fragments = 2.0 * splats * (1.0 + self.splat_pixels().min(pixels));
                (("splats", splat_bytes), None, vec![("splat-radius", fragments), ("splats", 8.0 * splats)])
            }
            SurfaceDraw::March => (("density", patches), None, vec![("size", pixels)]),
        };
        Estimate {
            bytes: first_stages.bytes.into_iter().chain(bytes).chain([drawn_bytes]).chain(flow.bytes).collect(),
            buffers: first_stages.buffers.into_iter().chain(buffers).chain(flow.buffers).collect(),
            invocations: first_stages.invocations.into_iter().chain(invocations).chain(flow.invocations).collect(),
            passes: first_stages.passes.into_iter().chain(flow.passes).reduce(|a, b| (a.0, a.1 + b.1)),
            ..first_stages
        }
    }

    /// The thesis's stages one and two.
    fn read_back_estimate(&self) -> Estimate {
        let [columns, planes, rows] = self.density.map(f64::from);
        let particles = f64::from(self.particles);
        let clusters = f64::from(self.clusters());
        let point = size_of::<Point>() as f64;
        // A particle is drawn into every cluster that its radius reaches, as a square of eq. 6.1.
        let reached = (2.0 * f64::from(self.radius_m / self.space_m.y) * clusters + 1.0).min(clusters);
        let point_pixels = f64::from(self.point_size_px()).powi(2).min(columns * rows);
        // Each accepted grid point, at most all of them, as a disc of a particle's radius.
        let disc = std::f64::consts::PI * point_pixels / 4.0;
        Estimate {
            bytes: vec![
                ("particles", 7.0 * TEXEL * particles),
                ("density", clusters * (point * particles + TEXEL * columns * rows)),
                ("density", point * columns * planes * rows + 3.0 * TEXEL * columns * rows),
            ],
            passes: Some(("density", 3 * u64::from(self.clusters()) + 16)),
            invocations: vec![
                ("radius", particles * reached * point_pixels),
                ("density", columns * rows * planes.sqrt() * disc),
            ],
            ..Estimate::default()
        }
    }

    /// Pixels of a splat in the middle of the space.
    fn splat_pixels(&self) -> f64 {
        let distance_m = self.camera.eye.distance(0.5 * self.space_m).max(self.camera.near_m);
        let pixels_per_m = 0.5 * self.height as f32 / (0.5 * self.camera.vertical_fov_rad).tan() / distance_m;
        std::f64::consts::PI * f64::from(self.splat_radius_m * pixels_per_m).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(items: &[(&str, f64)]) -> f64 {
        items.iter().map(|(_, count)| count).sum()
    }

    #[test]
    fn what_is_set_higher_is_estimated_higher() {
        let of = |parameters: &Parameters| parameters.estimate(Variant::Paper, Rock::built_in(), &[]);
        let default = of(&Parameters::default());
        // 40,000 particles in six clusters, 600 x 150 splats and 800 x 600 pixels are some tens of megabytes.
        assert!((20e6..100e6).contains(&total(&default.bytes)), "{default:?}");
        let vast = of(&Parameters { density: [1, 67_108_864, 1], ..Parameters::default() });
        assert!(total(&vast.bytes) > 8e12 && vast.passes.is_some_and(|(_, count)| count > 50_000_000), "{vast:?}");
        let wide = of(&Parameters { splat_radius_m: 1.0, ..Parameters::default() });
        assert!(total(&wide.invocations) > 100.0 * total(&default.invocations), "{wide:?}");
        let driven = |parameters: Parameters| parameters.estimate(Variant::GpuDriven, Rock::built_in(), &[]);
        let most = driven(Parameters { particles: 16_777_216, ..Parameters::default() });
        assert!(total(&most.bytes) > 2e9 && most.buffers[0].1 == f64::from(128 << 20), "{most:?}");
        let wide = driven(Parameters { radius_m: 1.0, ..Parameters::default() });
        assert!(total(&wide.invocations) > 30.0 * total(&driven(Parameters::default()).invocations), "{wide:?}");
    }
}
