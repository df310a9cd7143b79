//! The axes of `stress`.

use super::setup::Setup;
use crate::measure::Error;
use crate::measure::stress::{Amount, Axis, side};
use crate::scene::MeshSource;

/// The default first.
pub fn all() -> Vec<Axis<Setup>> {
    vec![
        Axis::new("receiver-triangles", 8_000, divide)
            .help("Triangles of the receivers, which are divided evenly")
            .unit("triangles")
            .most(MeshSource::MOST_DIVIDED)
            .amount(Amount::Counted("receiver_triangles")),
        Axis::new("receivers", 1, repeat).help("Receivers: the given ones again and again, side by side").most(1 << 16),
        Axis::of("water-triangles", 5_000)
            .help("Triangles of the water's mesh")
            .unit("triangles")
            .amount(Amount::Counted("water_triangles")),
        Axis::new("map", 128 * 128, |setup: &mut Setup, texels| {
            setup.parameters.map_size = side(texels);
            Ok(())
        })
        .help("Texels of the position, caustics and slice maps")
        .unit("texels")
        .most(1 << 32)
        .sets("map-size")
        .amount(Amount::Rounded(|setup| f64::from(setup.parameters.map_size).powi(2))),
        Axis::of("planes", 4).help("Reference (sample) planes of each receiver"),
    ]
}

fn divide(setup: &mut Setup, triangles: u64) -> Result<(), Error> {
    let each = triangles.div_ceil(setup.meshes.len().max(1) as u64);
    for mesh in &mut setup.meshes {
        *mesh = mesh.divided(each);
    }
    Ok(())
}

fn repeat(setup: &mut Setup, receivers: u64) -> Result<(), Error> {
    setup.meshes = setup.meshes.iter().cycle().take(receivers as usize).cloned().collect();
    Ok(())
}
