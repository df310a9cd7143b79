//! Numbers that the discretization follows from.

use glam::DVec3;

use super::super::gpu_driven::Cells;
use super::super::parameters::Parameters;
use super::{kernel, substeps};

/// Nearest that a particle comes to a wall, in distances of particles at rest.
const MARGIN: f64 = 0.25;
/// Cells beyond one for each particle: 16 MiB of their starts.
const MORE_CELLS: u32 = 1 << 22;

/// Numbers of the discretization, for `particles` of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Distance at rest, metres.
    pub spacing_m: f64,
    /// Radius of the kernel, metres.
    pub support_m: f64,
    /// Volume of a particle over support^3, so that a lattice has the density 1.
    pub volume: f64,
    /// The same, so that a lattice has the Laplacian of a parabola.
    pub laplacian: f64,
    /// Steps in the time of a frame.
    pub substeps: u32,
    /// Time of one, seconds.
    pub step_s: f64,
    /// Step times viscosity over density and support^2.
    pub stiffness: f64,
    /// Nearest that a particle comes to a wall, metres.
    pub margin_m: f64,
    /// Step times diffusivity of heat over support^2.
    pub heat_stiffness: f64,
    /// Of a particle's warmth over its face's, that which goes to a whole face in a step.
    pub given: f64,
    /// Heat that a face radiates over that which reaches it from the particle's middle for each kelvin, per K^3.
    pub radiance: f64,
    /// Most viscosity over the melt's.
    pub stiffest: f64,
}

impl Scale {
    /// Of these parameters.
    pub fn of(parameters: &Parameters) -> Self {
        let flow = &parameters.flow;
        let spacing_m = flow.spacing_m(parameters.particles);
        let support_m = kernel::SUPPORT * spacing_m;
        let (density, laplacian) = kernel::lattice_sums();
        let volume = (spacing_m / support_m).powi(3);
        let kinematic = f64::from(flow.viscosity_pa_s) / f64::from(flow.melt_kg_m3);
        let substeps = substeps::of(parameters, support_m);
        let step_s = f64::from(parameters.time_step_s) / f64::from(substeps);
        let diffusivity_m2_s = flow.heat.diffusivity_m2_s(flow.melt_kg_m3);
        Scale {
            spacing_m,
            support_m,
            volume: volume / density,
            laplacian: volume / laplacian,
            substeps,
            step_s,
            stiffness: step_s * kinematic / (support_m * support_m),
            margin_m: MARGIN * spacing_m,
            heat_stiffness: step_s * diffusivity_m2_s / (support_m * support_m),
            // The face is half a distance away.
            given: 2.0 * step_s * diffusivity_m2_s / (spacing_m * spacing_m),
            radiance: flow.heat.radiance(spacing_m),
            stiffest: flow.heat.stiffest(flow.viscosity_pa_s),
        }
    }

    /// Cells of the kernel's radius.
    pub fn cells(&self, parameters: &Parameters, particles: u32) -> Cells {
        let most = particles.saturating_add(MORE_CELLS).min(1 << 24);
        Cells::of_side(parameters.space_m, self.support_m, most, particles)
    }

    /// Most particles at rest that three cells above each other may hold: full of lava as far as it goes, since it may pool anywhere. They are some
    /// dozens, unless a space has room for more cells of the kernel's radius than there may be, so that they are larger.
    pub fn in_column(&self, parameters: &Parameters, particles: u32) -> f64 {
        let above = f64::from(self.cells(parameters, particles).counts[1].min(3));
        let cell = self.cell_m(parameters, particles) / self.spacing_m;
        (above * cell.element_product()).min(particles.into())
    }

    /// Sides of a cell in metres.
    pub fn cell_m(&self, parameters: &Parameters, particles: u32) -> DVec3 {
        parameters.space_m.as_dvec3() / DVec3::from(self.cells(parameters, particles).counts.map(f64::from))
    }
}
