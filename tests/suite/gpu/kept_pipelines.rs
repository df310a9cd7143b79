//! Pipelines that a library keeps: by everything that they are made from, and by nothing else.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::live::Kind;
use fumarole::gpu::{Blend, Compiler, DepthTest, ImageView, Load, Pass, ShaderLibrary, Topology};

use super::fixtures::{BLACK, Paint, Range, color_target, storage_buffer};
use super::misuse_targets::depth_target;
use crate::common::gpu_test;

/// Name, section, shaders, formats, blending, culling, topology and depth test, each alone, ask for a pipeline of their own;
/// resources, load operations and extents do not.
#[test]
fn passes_of_one_state_share_a_pipeline() {
    gpu_test(|device| {
        let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
        let target = |name: &str, format, size| color_target(device, name, format, size, size);
        let small = target("small", vk::Format::R8G8B8A8_UNORM, 4);
        let others =
            [target("large", vk::Format::R8G8B8A8_UNORM, 8), target("wide", vk::Format::R16G16B16A16_SFLOAT, 4)];
        let depth = depth_target(device, vk::Format::D32_SFLOAT);
        let pass = |name, section, fragment: &str, target: &Arc<ImageView>, load, blend| {
            let pass = Pass::graphics(name, section, "common/fullscreen.vert", fragment).constants::<Paint>();
            pass.color(target, load, blend)
        };
        let own = || pass("paint", "1", "test/constant.frag", &small, BLACK, Blend::Replace);
        let pipelines = || device.live().count(Kind::Pipeline);
        let none = pipelines();
        let mut passes = vec![own().build(&shaders).unwrap()];
        let before = pipelines();
        assert_eq!(before, none + 1);
        for same in [
            own(),
            pass("paint", "1", "test/constant.frag", &others[0], BLACK, Blend::Replace),
            pass("paint", "1", "test/constant.frag", &small, Load::Keep, Blend::Replace),
        ] {
            passes.push(same.build(&shaders).unwrap());
            assert_eq!(pipelines(), before);
        }
        let others = [
            pass("repaint", "1", "test/constant.frag", &small, BLACK, Blend::Replace),
            pass("paint", "2", "test/constant.frag", &small, BLACK, Blend::Replace),
            pass("paint", "1", "test/constant.frag", &others[1], BLACK, Blend::Replace),
            pass("paint", "1", "test/constant.frag", &small, BLACK, Blend::Add),
            own().cull(vk::CullModeFlags::BACK),
            own().topology(Topology::TriangleStrip),
            Pass::graphics("paint", "1", "common/fullscreen.vert", "test/checker.frag").color(
                &small,
                BLACK,
                Blend::Replace,
            ),
            own().depth(&depth, Load::Clear([1.0; 4]), DepthTest::LessWrite),
            own().depth(&depth, Load::Clear([1.0; 4]), DepthTest::GreaterWrite),
        ];
        for (place, other) in others.into_iter().enumerate() {
            passes.push(other.build(&shaders).unwrap());
            assert_eq!(pipelines(), before + place + 1, "case {place}");
        }
        // What is forgotten is made anew, and what passes have of it stays with them.
        let kept = pipelines();
        shaders.forget_pipelines();
        assert_eq!(shaders.kept().map(|(_, count)| count), [0; 4]);
        assert_eq!(pipelines(), kept);
        passes.push(own().build(&shaders).unwrap());
        assert_eq!(pipelines(), kept + 1);
        drop(passes);
        drop(shaders);
        assert_eq!(pipelines(), none);
    });
}

/// The pipeline of counting draws has the layout of its pass, which another of the same shaders and state has not.
#[test]
fn counting_draws_share_no_pipeline_with_another_program() {
    gpu_test(|device| {
        let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
        let target = color_target(device, "target", vk::Format::R8G8B8A8_UNORM, 4, 4);
        let depth = depth_target(device, vk::Format::D32_SFLOAT);
        let pass = |fragment, load, blend, test| {
            let pass = Pass::graphics("paint", "", "common/fullscreen.vert", fragment);
            pass.color(&target, BLACK, blend).depth(&depth, load, test)
        };
        let checkers = || {
            let own = pass("test/checker.frag", Load::Clear([1.0; 4]), Blend::Replace, DepthTest::LessWrite);
            own.counting("common/empty.frag", DepthTest::LessReadOnly).build(&shaders).unwrap()
        };
        let pipelines = || shaders.kept()[3];
        let _first = checkers();
        assert_eq!(pipelines(), (Kind::Pipeline, 2));
        let _equal = checkers();
        assert_eq!(pipelines(), (Kind::Pipeline, 2));
        let empty = pass("common/empty.frag", Load::Keep, Blend::Masked, DepthTest::LessReadOnly);
        let _empty = empty.build(&shaders).unwrap();
        assert_eq!(pipelines(), (Kind::Pipeline, 3));
    });
}

/// Checks of a description are those of each pass, also where its pipeline is there.
#[test]
fn what_does_not_fit_is_refused_the_second_time() {
    gpu_test(|device| {
        let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
        let values = storage_buffer(device, "values", &[1.0, 2.0]);
        let sums = storage_buffer(device, "sums", &[0.0]);
        let sum = || Pass::compute("sum", "", "test/sum.comp").with("Values", &values).with("Sums", &sums);
        let _pass = sum().constants::<Range>().build(&shaders).unwrap();
        for (wrong, named) in [(sum(), "push constants"), (sum().constants::<Paint>(), "Paint")] {
            let error = wrong.build(&shaders).err().expect("it does not fit").to_string();
            assert!(error.contains(named), "{error}");
        }
    });
}
