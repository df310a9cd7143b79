//! The finished picture.

use fumarole::image::write_png;
use fumarole::papers::Variant as _;
use fumarole::papers::terrain::{Lod, Parameters, Variant, View};

use crate::common::gpu_test;
use crate::drawing::Drawing;
use crate::land::{alone, volcano};

#[test]
fn look() {
    gpu_test(|device| {
        for view in [View::Side, View::Top] {
            for lod in [Lod::Exact, Lod::Pixel] {
                let parameters = Parameters { view, lod, ..Parameters::default() };
                for variant in [Variant::GpuCompute, Variant::Mesh] {
                    let drawing = Drawing::of(device, variant, &parameters, &alone(volcano(200)));
                    let name = format!("/tmp/h4-{view:?}-{lod:?}-{}.png", variant.word());
                    write_png(name.as_ref(), &drawing.picture).unwrap();
                }
            }
        }
    });
}
