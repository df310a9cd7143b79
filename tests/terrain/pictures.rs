//! The finished picture.

use fumarole::image::write_png;
use fumarole::papers::terrain::{Base, Interpolation, Lod, Parameters, Variant};

use crate::common::gpu_test;
use crate::drawing::Drawing;
use crate::land::{alone, volcano};

#[test]
fn look() {
    gpu_test(|device| {
        let default = Parameters::default();
        let cases = [
            (
                "bicubic",
                Variant::GpuCompute,
                Parameters { interpolation: Interpolation::Bicubic, lod: Lod::Exact, ..default.clone() },
            ),
            (
                "cylinder",
                Variant::GpuCompute,
                Parameters { base: Base::Cylinder { radius_m: 9000.0 }, ..default.clone() },
            ),
            (
                "ellipsoid",
                Variant::GpuCompute,
                Parameters { base: Base::Ellipsoid { equatorial_m: 15000.0, polar_m: 11000.0 }, ..default.clone() },
            ),
            (
                "ellipsoid-mesh",
                Variant::Mesh,
                Parameters { base: Base::Ellipsoid { equatorial_m: 15000.0, polar_m: 11000.0 }, ..default.clone() },
            ),
            ("mesh", Variant::Mesh, default.clone()),
        ];
        for (name, variant, parameters) in cases {
            let drawing = Drawing::of(device, variant, &parameters, &alone(volcano(200)));
            write_png(format!("/tmp/h4-{name}.png").as_ref(), &drawing.picture).unwrap();
        }
    });
}
