//! The variants see the same land.

use fumarole::gpu::Compiler;
use fumarole::papers::Variant as _;
use fumarole::papers::terrain::{Lod, MapInput, Parameters, Variant, View};

use crate::common::gpu_test;
use crate::drawing::{Drawing, differing};
use crate::land::{adversaries, alone, volcano};

fn small(view: View, lod: Lod) -> Parameters {
    Parameters { view, lod, width: 160, height: 120, ..Parameters::default() }
}

/// One in a thousand rays may pass a ridge on the other side by rounding.
fn assert_agree(name: &str, a: &Drawing, b: &Drawing) {
    let differing = differing(a, b);
    assert!(differing * 1000 <= a.hits.len(), "{name}: {differing} of {} pixels differ", a.hits.len());
}

#[test]
fn all_variants_find_the_same_hits() {
    gpu_test(|device| {
        let mut maps: Vec<(String, Vec<MapInput>)> = vec![("volcano".to_owned(), alone(volcano(100)))];
        maps.extend(adversaries().into_iter().map(|(name, map)| (name.to_owned(), alone(map))));
        for (name, maps) in maps {
            for lod in [Lod::Exact, Lod::Pixel] {
                for view in [View::Side, View::Top] {
                    let parameters = small(view, lod);
                    let compute = Drawing::of(device, Variant::GpuCompute, &parameters, &maps);
                    for variant in [Variant::GpuFragment, Variant::Cpu] {
                        let other = Drawing::of(device, variant, &parameters, &maps);
                        assert_agree(&format!("{name} {lod:?} {view:?} {}", variant.word()), &compute, &other);
                    }
                }
            }
        }
    });
}

#[test]
fn both_compilers_draw_one_picture() {
    gpu_test(|device| {
        for lod in [Lod::Exact, Lod::Pixel] {
            for variant in [Variant::GpuCompute, Variant::GpuFragment] {
                let of = |compiler| {
                    Drawing::compiled_by(compiler, device, variant, &small(View::Side, lod), &alone(volcano(60)))
                };
                assert_agree(variant.word(), &of(Compiler::Glslang), &of(Compiler::Naga));
            }
        }
    });
}
