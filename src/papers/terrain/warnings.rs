//! Options that a user gave and that change nothing: a variant does not heed them, or nothing of them is on the map.

use super::parameters::{Base, Parameters, Variant};
use super::placement::Extent;
use crate::measure::Variant as _;
use crate::measure::parameter::{Given, listed};
use crate::scene::Mesh;

/// Lines on the objects that lie beside all maps wholly, seen from above.
pub fn off_the_maps(objects: &[Mesh], extent: &Extent) -> Vec<String> {
    let warning = |(number, mesh): (usize, &Mesh)| {
        let bounds = mesh.bounds();
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let is_over =
            low.x <= extent.high.x && high.x >= extent.low.x && low.z <= extent.high.z && high.z >= extent.low.z;
        // No minus before a zero.
        let place = |x: f64, z: f64| format!("{},{}", x.round() + 0.0, z.round() + 0.0);
        (!is_over).then(|| {
            format!(
                "`object` {number} of {}, {}, lies off the maps: it reaches from {} to {} metres east and south, the \
                 maps from {} to {}",
                objects.len(),
                mesh.name,
                place(low.x, low.z),
                place(high.x, high.z),
                place(extent.low.x, extent.low.z),
                place(extent.high.x, extent.high.z)
            )
        })
    };
    (1..).zip(objects).filter_map(warning).collect()
}

/// A line on a base that lies over all ground, so that nothing of it is seen; `range_m` is its lowest and highest above the base, metres.
pub fn drowned(base_level_m: f64, range_m: (f64, f64)) -> Option<String> {
    let highest_m = base_level_m + range_m.1;
    (range_m.1 < 0.0).then(|| {
        format!(
            "`base-level` {base_level_m} lies over all ground, whose highest is at {highest_m:.1} metres: the base alone is seen"
        )
    })
}

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
    use crate::scene::MeshSource;
    use glam::{DVec3, Mat4, Vec3};

    #[test]
    fn objects_beside_all_maps_are_named_with_their_place() {
        let extent = Extent { low: DVec3::new(-500.0, 0.0, -300.0), high: DVec3::new(500.0, 90.0, 300.0) };
        let sphere = MeshSource::Sphere.load().unwrap();
        let at = |x: f32, z: f32| sphere.transformed(&Mat4::from_translation(Vec3::new(x, 5000.0, z)));
        let on = [at(0.0, 0.0), at(499.0, -300.5), at(-500.5, 0.0)];
        assert_eq!(off_the_maps(&on, &extent), Vec::<String>::new());
        let said = off_the_maps(&[at(0.0, 0.0), at(4000.0, 0.0), at(0.0, -900.0)], &extent);
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(said[0].starts_with("`object` 2 of 3, ") && said[1].starts_with("`object` 3 of 3, "), "{said:?}");
        assert!(said[0].contains("it reaches from 39") && said[0].ends_with("the maps from -500,-300 to 500,300"));
    }

    #[test]
    fn a_base_over_all_ground_is_told_with_both_heights() {
        assert_eq!(drowned(120.0, (-20.0, 0.0)), None);
        let said = drowned(10000.0, (-9900.0, -8765.5)).unwrap();
        assert_eq!(
            said,
            "`base-level` 10000 lies over all ground, whose highest is at 1234.5 metres: the base alone is seen"
        );
    }

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
