//! Culling of splats: with it and without, depths and sums are equal to the bit, and fewer splats are drawn.

use std::sync::Arc;

use fumarole::gpu::{Compiler, Device};
use fumarole::measure::Paper;
use fumarole::papers::lava::{
    CAMERAS, Kept, Lava, Parameters, Particles, Rock, SplatCulling, SplatShading, SplatShape, Variant,
};
use fumarole::scene::Camera;
use glam::Vec3;

use super::pictures::reduced;
use super::scene::{draw, lava, parameters, texels};
use crate::common::{gpu_test, shaders_by};

/// The figures' cameras, and from low down, from inside the lava, from below, from above one end, and looking away.
fn cameras() -> Vec<(&'static str, Camera)> {
    let view = |eye: [f32; 3], target: [f32; 3]| Camera {
        eye: Vec3::from_array(eye),
        target: Vec3::from_array(target),
        ..CAMERAS[0].1
    };
    let others = [
        ("low", view([2.0, 0.9, 3.5], [2.0, 0.2, 0.5])),
        ("lower", view([5.5, 0.6, 0.5], [3.0, 0.2, 0.5])),
        ("inside", view([1.0, 0.3, 0.5], [2.0, 0.3, 0.5])),
        ("below", view([2.0, -2.0, 0.4], [2.0, 0.0, 0.5])),
        ("end", view([0.3, 1.2, 0.5], [0.4, 0.2, 0.5])),
        ("away", view([2.0, 1.5, 2.0], [2.0, 1.5, 5.0])),
    ];
    CAMERAS.into_iter().chain(others).collect()
}

/// Bits of everything that the splats of a frame leave.
fn drawn(device: &Arc<Device>, lava: &Lava) -> Vec<u32> {
    let splatting = &lava.splatting;
    let mut bits: Vec<u32> = texels(device, &splatting.depth);
    bits.extend(texels::<u32>(device, &splatting.sums));
    if let Some(deferred) = splatting.deferred() {
        bits.extend(texels::<u32>(device, &deferred.normals));
        bits.extend(texels::<u32>(device, &deferred.depths));
    }
    bits
}

/// Draws the frame that is there from another camera.
fn draw_from(
    device: &Arc<Device>,
    lava: &mut Lava,
    parameters: &Parameters,
    camera: Camera,
) -> (Vec<u32>, Option<Kept>) {
    lava.set_drawn(&Parameters { camera, ..parameters.clone() }, Rock::built_in(), &[]).unwrap();
    lava.repeat();
    draw(device, lava, 0);
    (drawn(device, lava), lava.splatting.kept(device).unwrap())
}

#[test]
fn nothing_that_is_seen_is_left_out() {
    gpu_test(|device| {
        let of = |culling, geometry_stage, splat_shape, splat_shading| Parameters {
            culling,
            geometry_stage,
            splat_shape,
            splat_shading,
            ..reduced()
        };
        for (geometry_stage, shape, shading) in
            [(true, SplatShape::Disc, SplatShading::Gouraud), (false, SplatShape::Fitted, SplatShading::Deferred)]
        {
            let mut ways = [SplatCulling::Off, SplatCulling::Frustum, SplatCulling::Facing].map(|culling| {
                let parameters = of(culling, geometry_stage, shape, shading);
                let mut lava = lava(device, &parameters);
                draw(device, &mut lava, 0);
                (lava, parameters)
            });
            let all = 200 * 50;
            for (name, camera) in cameras() {
                let [off, frustum, facing] =
                    ways.each_mut().map(|(lava, parameters)| draw_from(device, lava, parameters, camera));
                assert_eq!(off.1, None);
                let (frustum_kept, facing_kept) = (frustum.1.unwrap(), facing.1.unwrap());
                println!("{name}, {shape:?}: of {all} splats {frustum_kept:?}, {facing_kept:?}");
                assert!(frustum.0 == off.0, "{name}, {shape:?}: the picture's sides change it");
                assert!(facing.0 == off.0, "{name}, {shape:?}: what is turned away changes it");
                assert!(facing_kept.splats <= frustum_kept.splats && frustum_kept.splats <= all, "{name}");
                assert_eq!(frustum_kept.of_clusters, all.div_ceil(64), "{name}");
                match name {
                    "away" => assert_eq!((frustum_kept.splats, frustum_kept.clusters), (0, 0)),
                    "end" => assert!(frustum_kept.clusters < 157 && frustum_kept.splats < 5000, "{frustum_kept:?}"),
                    "low" | "lower" if shape == SplatShape::Disc => {
                        assert!(facing_kept.splats < frustum_kept.splats, "{name}: {facing_kept:?}");
                    }
                    _ => {}
                }
            }
        }
    });
}

/// A row that is no whole number of clusters, a single splat, and more rows than columns.
#[test]
fn clusters_hold_every_splat() {
    gpu_test(|device| {
        for splats in [[1, 1], [65, 3], [3, 100], [64, 2], [130, 1]] {
            let with = |culling| {
                let parameters = Parameters { splats, culling, splat_radius_m: 0.2, ..parameters() };
                let mut lava = lava(device, &parameters);
                draw(device, &mut lava, 0);
                (drawn(device, &lava), lava.splatting.kept(device).unwrap())
            };
            let (expected, _) = with(SplatCulling::Off);
            let (found, kept) = with(SplatCulling::Facing);
            let kept = kept.unwrap();
            assert!(expected == found, "{splats:?}: {kept:?}");
            assert!(kept.splats > 0 && kept.splats <= splats[0] * splats[1], "{splats:?}: {kept:?}");
        }
    });
}

#[test]
fn both_compilers_cull_alike() {
    gpu_test(|device| {
        let of = |compiler| {
            let low = Camera { eye: Vec3::new(1.0, 0.9, 3.0), target: Vec3::new(0.3, 0.2, 0.5), ..CAMERAS[0].1 };
            let parameters =
                Parameters { geometry_stage: false, culling: SplatCulling::Facing, camera: low, ..parameters() };
            let shaders = shaders_by(device, compiler);
            let particles = Particles::seeded(&parameters);
            let mut lava =
                Lava::new(&shaders, "test", Variant::Paper, &parameters, &particles, Rock::built_in(), &[]).unwrap();
            let sample = draw(device, &mut lava, 0);
            let names: Vec<_> = sample.passes.iter().map(|pass| pass.info.name).collect();
            let last = ["cull", "cull-sum", "cull-compact", "visibility", "blending", "normalisation"];
            assert_eq!(names[names.len() - 6..], last);
            lava.splatting.kept(device).unwrap().unwrap()
        };
        let [glslang, naga] = [Compiler::Glslang, Compiler::Naga].map(of);
        assert!(glslang.splats.abs_diff(naga.splats) <= 2 && glslang.clusters == naga.clusters, "{glslang:?} {naga:?}");
        assert!(glslang.splats > 100 && glslang.splats < 60 * 36, "{glslang:?}");
    });
}
