//! The axes of `stress`.

use super::placement::{Object, Place};
use super::setup::Setup;
use crate::measure::Error;
use crate::measure::stress::{Amount, Axis, scaled};
use crate::scene::MeshSource;

fn product(sides: &[u32]) -> f64 {
    sides.iter().map(|&side| f64::from(side)).product()
}

/// The default first.
pub fn all() -> Vec<Axis<Setup>> {
    vec![
        Axis::of("particles", 10_000).help("Particles, in the same space and of the same radius"),
        Axis::new("splats", 10_000, |setup: &mut Setup, splats| {
            setup.parameters.splats = scaled(setup.parameters.splats, splats);
            Ok(())
        })
        .help("Splats, of the same radius")
        .most(16_777_216)
        .sets("splats")
        .amount(Amount::Rounded(|setup| product(&setup.parameters.splats))),
        Axis::new("grid", 7_200, |setup: &mut Setup, points| {
            setup.parameters.density = scaled(setup.parameters.density, points);
            Ok(())
        })
        .help("Points of the density grid; the particles' radius covers more of them")
        .unit("grid points")
        .most(67_108_864)
        .sets("density")
        .amount(Amount::Rounded(|setup| product(&setup.parameters.density))),
        Axis::new("object-triangles", 8_000, divide)
            .help("Triangles of the polygon objects, which are divided evenly; of a teapot where there are none")
            .unit("triangles")
            .most(MeshSource::MOST_DIVIDED)
            .amount(Amount::Counted("object_triangles")),
    ]
}

fn divide(setup: &mut Setup, triangles: u64) -> Result<(), Error> {
    if setup.objects.is_empty() {
        setup.objects = vec![Object { source: MeshSource::Teapot, place: Place::Fitted }];
    }
    let each = triangles.div_ceil(setup.objects.len() as u64);
    for object in &mut setup.objects {
        object.source = object.source.divided(each);
    }
    Ok(())
}
