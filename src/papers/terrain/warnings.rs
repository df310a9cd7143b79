//! Options that a user gave and a variant does not heed.

use super::parameters::{Base, Parameters, Variant};
use crate::measure::Variant as _;
use crate::measure::parameter::{Given, listed};

/// A line that names them, if there are any.
pub fn unheeded(parameters: &Parameters, given: &Given, variant: Variant) -> Option<String> {
    let walks = matches!(variant, Variant::DdaCompute | Variant::DdaFragment);
    // Each with whether it is heeded.
    let options = [
        ("lod", !variant.is_rasterised()),
        ("start", walks && parameters.base == Base::Plane),
        ("corners", walks),
        ("mesh-error", variant == Variant::MeshLod),
        ("tile-memory", variant == Variant::TiledCompute),
    ];
    let idle = options.into_iter().filter(|&(name, is_heeded)| given.has(name) && !is_heeded);
    listed(idle.map(|(name, _)| name)).map(|names| format!("{} does not heed {names}", variant.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_options_that_a_variant_does_not_heed_are_named() {
        use Variant::{Cpu, DdaCompute, DdaCpu, DdaFragment, GpuCompute, GpuFragment, Mesh, MeshLod, TiledCompute};
        let plane = Parameters::default();
        let round = Parameters { base: Base::Cylinder { radius_m: 9000.0 }, ..plane.clone() };
        let all = "lod start corners mesh-error tile-memory";
        let rays = "`start`, `corners`, `mesh-error`, `tile-memory`";
        for (parameters, options, variant, names) in [
            (&plane, all, Cpu, rays),
            (&plane, all, GpuCompute, rays),
            (&plane, all, GpuFragment, rays),
            (&plane, all, Mesh, "`lod`, `start`, `corners`, `mesh-error`, `tile-memory`"),
            (&plane, all, MeshLod, "`lod`, `start`, `corners`, `tile-memory`"),
            (&plane, all, DdaCompute, "`mesh-error`, `tile-memory`"),
            (&plane, all, DdaFragment, "`mesh-error`, `tile-memory`"),
            (&round, all, DdaCompute, "`start`, `mesh-error`, `tile-memory`"),
            (&plane, all, DdaCpu, rays),
            (&plane, all, TiledCompute, "`start`, `corners`, `mesh-error`"),
            (&plane, "lod sun normals shadows", GpuCompute, ""),
            // Not given, they are the experiments' own.
            (&Parameters { mesh_error_px: 5.0, tile_memory_mib: 8, ..plane.clone() }, "", Mesh, ""),
        ] {
            let given = options.split_whitespace().map(str::to_owned).collect();
            let found = unheeded(parameters, &given, variant).unwrap_or_default();
            let expected =
                if names.is_empty() { String::new() } else { format!("{} does not heed {names}", variant.as_str()) };
            assert_eq!(found, expected, "{options}, {variant:?}");
        }
    }
}
