//! The objects and numbers of the dissertation's results. Its models are not at hand; the shipped ones are brought to
//! their counts.

use glam::Vec3;

use super::super::setup::Setup;
use crate::measure::study::Preset;
use crate::papers::burning::{Parameters, Variant};
use crate::scene::MeshSource;

/// Section 3.8.
pub const RESULTS_3_8: Preset<Setup> = Preset {
    name: "3.8",
    help: "Section 3.8: a shell of 15,949 triangles, 15,950 here, 3,000 fire and 1,800 smoke particles",
    variant: Some(Variant::Shell),
    setup: || Setup { triangles: Some(15_949), ..Setup::default() },
};

/// Section 4.6.
pub const BOX: Preset<Setup> = Preset {
    name: "box",
    help: "Section 4.6: a box of 12 triangles, for low-poly",
    variant: Some(Variant::LowPoly),
    setup: || Setup { mesh: MeshSource::Box, parameters: few_particles(), ..Setup::default() },
};

const DOOR: Preset<Setup> = Preset {
    name: "door",
    help: "A door of 12 triangles, for low-poly",
    variant: Some(Variant::LowPoly),
    setup: || Setup { stretch: Vec3::new(1.0, 2.1, 0.08), ..(BOX.setup)() },
};

/// Section 5.5.
pub const SOLID_45K: Preset<Setup> = Preset {
    name: "solid-45k",
    help: "Section 5.5: a block of 45,000 triangles, for solid",
    variant: Some(Variant::Solid),
    setup: || Setup {
        mesh: MeshSource::Box,
        stretch: Vec3::new(2.0, 1.0, 1.0),
        triangles: Some(45_000),
        // Displacements are fractions of edges, which are short in so fine a mesh: with the defaults it would lose
        // hardly any volume.
        parameters: Parameters { beta: 0.5, flammability: 120, ..few_particles() },
        ..Setup::default()
    },
};

/// Section 6.5.
pub const MELT_40K: Preset<Setup> = Preset {
    name: "melt-40k",
    help: "Section 6.5: wax of 40,000 triangles, for melting",
    variant: Some(Variant::Melting),
    setup: || Setup { triangles: Some(40_000), parameters: few_particles(), ..Setup::default() },
};

/// Every preset, in the dissertation's order.
pub fn all() -> Vec<Preset<Setup>> {
    vec![RESULTS_3_8, BOX, DOOR, SOLID_45K, MELT_40K]
}

fn few_particles() -> Parameters {
    Parameters { fire: 2000, smoke: 500, ..Parameters::default() }
}
