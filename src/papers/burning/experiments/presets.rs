//! The objects and numbers of the dissertation's results.

use glam::Vec3;

use super::super::setup::Setup;
use crate::papers::burning::{Material, Parameters, Variant};
use crate::scene::MeshSource;

/// A configuration of the dissertation, by its section or its object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Preset {
    /// Section 3.8: 15,949 triangles, 3,000 fire and 1,800 smoke particles.
    Results38,
    /// Section 4.6: the box of 12 triangles, 2,000 and 500 particles.
    Box,
    /// A door, as thin a box of 12 triangles, 2,000 and 500 particles.
    Door,
    /// Section 5.5: a solid of 45,000 triangles, 2,000 and 500 particles.
    Solid45k,
    /// Section 6.5: wax of 40,000 triangles, 2,000 and 500 particles.
    Melt40k,
}

impl Preset {
    pub const ALL: [Preset; 5] = [Preset::Results38, Preset::Box, Preset::Door, Preset::Solid45k, Preset::Melt40k];

    pub fn as_str(self) -> &'static str {
        match self {
            Preset::Results38 => "3.8",
            Preset::Box => "box",
            Preset::Door => "door",
            Preset::Solid45k => "solid-45k",
            Preset::Melt40k => "melt-40k",
        }
    }

    /// The method of its chapter.
    pub fn variant(self) -> Variant {
        match self {
            Preset::Results38 => Variant::Shell,
            Preset::Box | Preset::Door => Variant::LowPoly,
            Preset::Solid45k => Variant::Solid,
            Preset::Melt40k => Variant::Melting,
        }
    }

    /// Object and numbers. The dissertation's models are not at hand; the shipped ones are brought to their counts.
    pub fn setup(self) -> Setup {
        let few_particles = Parameters { fire: 2000, smoke: 500, ..Parameters::default() };
        let wax = Parameters { material: Material::Plain, albedo: Vec3::new(0.8, 0.66, 0.4), ..few_particles.clone() };
        // Displacements are shares of edges, which are short in so fine a mesh: with the defaults it would lose hardly any volume.
        let timber = Parameters { beta: 0.5, flammability: 120, ..few_particles.clone() };
        let (mesh, stretch, triangles, parameters) = match self {
            Preset::Results38 => (MeshSource::Bunny, Vec3::ONE, Some(15_949), Parameters::default()),
            Preset::Box => (MeshSource::Box, Vec3::ONE, None, few_particles),
            Preset::Door => (MeshSource::Box, Vec3::new(1.0, 2.1, 0.08), None, few_particles),
            Preset::Solid45k => (MeshSource::Box, Vec3::new(2.0, 1.0, 1.0), Some(45_000), timber),
            Preset::Melt40k => (MeshSource::Bunny, Vec3::ONE, Some(40_000), wax),
        };
        Setup { parameters, mesh, stretch, triangles, preset: Some(self.as_str().to_owned()), ..Setup::default() }
    }
}
