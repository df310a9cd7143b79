//! The variants see the same terrain.

use fumarole::gpu::Compiler;
use fumarole::measure::Variant as _;
use fumarole::papers::terrain::{Base, Inputs, Interpolation, Lod, MapInput, Parameters, Surface, Variant, View};

use fumarole::scene::shapes;
use glam::{Mat4, Vec3};

use super::drawing::{Drawing, Painter, differing};
use super::maps::{adversaries, alone, volcano};
use crate::common::gpu_test;

pub fn small(view: View, lod: Lod) -> Parameters {
    Parameters { view, lod, width: 160, height: 120, ..Parameters::default() }
}

/// One in a thousand rays may pass a ridge on the other side by rounding.
pub fn assert_agree(name: &str, a: &Drawing, b: &Drawing) {
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
                    // Of two traversals that end at a pixel's footprint each ends at its own place in it.
                    let dda: &[Variant] = if lod == Lod::Exact { &DDA } else { &[] };
                    for &variant in [Variant::GpuFragment, Variant::Cpu].iter().chain(dda) {
                        let other = Drawing::of(device, variant, &parameters, &maps);
                        assert_agree(&format!("{name} {lod:?} {view:?} {}", variant.as_str()), &compute, &other);
                    }
                }
            }
        }
    });
}

const DDA: [Variant; 3] = [Variant::DdaCompute, Variant::DdaFragment, Variant::DdaCpu];

const BASES: [Base; 3] = [
    Base::Cylinder { radius_m: 9000.0 },
    Base::Ellipsoid { equatorial_m: 15_000.0, polar_m: 11_000.0 },
    Base::Ellipsoid { equatorial_m: 8_000.0, polar_m: 10_000.0 },
];

#[test]
fn all_variants_agree_on_every_base_and_interpolation() {
    gpu_test(|device| {
        for base in [Base::Plane, Base::EARTH].into_iter().chain(BASES) {
            for interpolation in [Interpolation::Bilinear, Interpolation::Bicubic] {
                for lod in [Lod::Exact, Lod::Pixel] {
                    let parameters = Parameters { base, interpolation, ..small(View::Side, lod) };
                    let maps = alone(volcano(100));
                    let compute = Drawing::of(device, Variant::GpuCompute, &parameters, &maps);
                    // Of two traversals that end at a pixel's footprint each ends at its own place in it.
                    let dda: &[Variant] = if lod == Lod::Exact { &DDA } else { &[] };
                    for &variant in [Variant::GpuFragment, Variant::Cpu].iter().chain(dda) {
                        let other = Drawing::of(device, variant, &parameters, &maps);
                        assert_agree(
                            &format!("{base:?} {interpolation:?} {lod:?} {}", variant.as_str()),
                            &compute,
                            &other,
                        );
                    }
                }
            }
        }
    });
}

/// Over so short a distance a base as large as a star is a plane.
#[test]
fn a_huge_round_base_is_a_plane() {
    gpu_test(|device| {
        let of = |base| {
            let parameters = Parameters { base, ..small(View::Top, Lod::Exact) };
            Drawing::of(device, Variant::GpuCompute, &parameters, &alone(volcano(100)))
        };
        let plane = of(Base::Plane);
        let radius_m = 1.0e8;
        assert_agree("cylinder", &plane, &of(Base::Cylinder { radius_m }));
        assert_agree("sphere", &plane, &of(Base::Ellipsoid { equatorial_m: radius_m, polar_m: radius_m }));
    });
}

#[test]
fn both_compilers_draw_one_picture() {
    // In the air above the crater.
    let ball = shapes::sphere(16, 12)
        .transformed(&(Mat4::from_translation(2500.0 * Vec3::Y) * Mat4::from_scale(Vec3::splat(700.0))));
    gpu_test(|device| {
        for lod in [Lod::Exact, Lod::Pixel] {
            for variant in [Variant::GpuCompute, Variant::GpuFragment, Variant::DdaCompute, Variant::DdaFragment] {
                let of = |compiler| {
                    let maps = alone(volcano(60));
                    let objects = [ball.clone()];
                    let inputs = Inputs { maps: &maps, objects: &objects, ..Inputs::default() };
                    let parameters = Parameters { shadows: true, ..small(View::Side, lod) };
                    Painter::new(device, compiler, variant, &parameters, &inputs).draw()
                };
                let [glslang, naga] = [Compiler::Glslang, Compiler::Naga].map(of);
                assert_agree(variant.as_str(), &glslang, &naga);
                let [a, b] = [&glslang, &naga].map(|drawing| drawing.picture.pixels().as_chunks::<4>().0);
                let pixels = a.iter().zip(b);
                let differing = pixels.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 6)).count();
                assert!(differing * 1000 <= glslang.hits.len(), "{}: {differing} colours differ", variant.as_str());
            }
        }
    });
}

/// Nodes that the mesh shows are where the rays meet the exact surface: both are the map there.
#[test]
fn depth_agrees_with_the_mesh_at_visible_nodes() {
    gpu_test(|device| {
        let map = volcano(40);
        for view in [View::Side, View::Top] {
            let parameters = Parameters { width: 200, height: 150, ..small(view, Lod::Exact) };
            let maps = alone(map.clone());
            let [rays, mesh] =
                [Variant::GpuCompute, Variant::Mesh].map(|variant| Drawing::of(device, variant, &parameters, &maps));
            let mut nodes = 0;
            for (ray, mesh) in rays.hits.iter().zip(&mesh.hits) {
                let is_node = mesh.surface == Surface::Terrain
                    && mesh.place.iter().all(|&c| (c - c.round()).abs() < 0.08 && c > 0.5 && c < 38.5);
                if is_node {
                    nodes += 1;
                    assert_eq!(ray.surface, Surface::Terrain);
                    let off = (ray.depth_m - mesh.depth_m).abs();
                    assert!(off <= 2e-3 * mesh.depth_m, "{view:?} {:?}: {} {}", mesh.place, ray.depth_m, mesh.depth_m);
                }
            }
            assert!(nodes >= 100, "{view:?}: only {nodes} nodes");
            let others = rays.hits.iter().zip(&mesh.hits).filter(|(ray, mesh)| ray.surface != mesh.surface).count();
            assert!(others * 50 < rays.hits.len(), "{view:?}: {others} pixels see another surface");
        }
    });
}
