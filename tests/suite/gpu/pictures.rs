//! Pictures and values of passes, with the binaries of both compilers.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{Blend, Compiler, Device, Feature, Load, Mode, Pass};

use super::fixtures::{BLACK, Paint, Range, color_target, run, shaders, storage_buffer, texels, values};
use crate::common::{gpu_test, shaders_by};

/// Not square, and such that no texel's centre lies on an edge of the triangle.
const WIDTH: usize = 24;
const HEIGHT: usize = 20;

/// `test/asymmetric.*`
fn draw_asymmetric(device: &Arc<Device>, compiler: Compiler) -> Vec<[f32; 4]> {
    let target = color_target(device, "asymmetric", vk::Format::R32G32B32A32_SFLOAT, WIDTH as u32, HEIGHT as u32);
    let pass = Pass::graphics("asymmetric", "", "test/asymmetric.vert", "test/asymmetric.frag")
        .color(&target, BLACK, Blend::Replace)
        .build(&shaders_by(device, compiler))
        .unwrap();
    assert_eq!(pass.info().compiler, Some(compiler));
    run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.vertices(3))).unwrap();
    texels(device, &target)
}

/// The triangle of `test/corners.glsl` in texels from the top left: the right angle at (1.2, 2), the other corners
/// 16.8 to the right and 10 down; the colour is the barycentric coordinate.
fn expected_color(column: usize, row: usize) -> Option<[f64; 3]> {
    let green = (column as f64 + 0.5 - 1.2) / 16.8;
    let blue = (row as f64 + 0.5 - 2.0) / 10.0;
    let red = 1.0 - green - blue;
    (red.min(green).min(blue) > 0.0).then_some([red, green, blue])
}

#[test]
fn a_picture_stands_upright_and_is_the_same_with_both_compilers() {
    gpu_test(|device| {
        let picture = draw_asymmetric(device, Compiler::Glslang);
        for (i, texel) in picture.iter().enumerate() {
            let (column, row) = (i % WIDTH, i / WIDTH);
            let expected = expected_color(column, row).unwrap_or([0.0; 3]);
            for (got, wanted) in texel.iter().zip(expected) {
                assert!((f64::from(*got) - wanted).abs() < 1e-4, "texel ({column}, {row}): {texel:?}, {expected:?}");
            }
        }
        // The corners, said in words: red at the top left, green at the right, blue below.
        let strongest = |column: usize, row: usize| {
            let texel = picture[column + WIDTH * row];
            (0..3).max_by(|&a, &b| texel[a].total_cmp(&texel[b]))
        };
        assert_eq!([strongest(1, 2), strongest(16, 2), strongest(1, 10)], [Some(0), Some(1), Some(2)]);
        assert_eq!(picture, draw_asymmetric(device, Compiler::Naga));
    });
}

#[test]
fn rows_go_down_and_columns_to_the_right() {
    gpu_test(|device| {
        let target = color_target(device, "numbers", vk::Format::R32_UINT, 7, 5);
        let pass = Pass::graphics("texels", "", "common/fullscreen.vert", "test/texels.frag")
            .color(&target, Load::Discard, Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        run(device, Mode::Plain, |frame| frame.graphics(&pass, |draw| draw.vertices(3))).unwrap();
        let expected: Vec<u32> = (0..5).flat_map(|row| (0..7).map(move |column| column + 256 * row)).collect();
        assert_eq!(texels::<u32>(device, &target), expected);
    });
}

/// `test/sum.comp`, step by step.
fn sum_of_64(values: &[f32]) -> f32 {
    let mut partial = [0.0; 64];
    partial[..values.len()].copy_from_slice(values);
    for half in [32, 16, 8, 4, 2, 1] {
        for i in 0..half {
            partial[i] += partial[i + half];
        }
    }
    partial[0]
}

#[test]
fn a_kernel_computes_the_same_with_both_compilers() {
    gpu_test(|device| {
        let input: Vec<f32> = (0..150).map(|i| (i as f32 * 0.37).sin()).collect();
        let buffer = storage_buffer(device, "values", &input);
        for compiler in [Compiler::Glslang, Compiler::Naga] {
            let sums = storage_buffer(device, "sums", &[0.0; 4]);
            let pass = Pass::compute("sum", "", "test/sum.comp")
                .constants::<Range>()
                .with("Values", &buffer)
                .with("Sums", &sums)
                .build(&shaders_by(device, compiler))
                .unwrap();
            assert_eq!(pass.info().compiler, Some(compiler));
            run(device, Mode::Plain, |frame| {
                frame.compute(&pass, |dispatch| {
                    dispatch.constants(&Range { value_count: 150 }).threads(150, 1, 1);
                })
            })
            .unwrap();
            let read = values(device, &sums);
            assert_eq!(read[0].to_bits(), 3, "workgroups, with {compiler}");
            let expected: Vec<f32> = input.chunks(64).map(sum_of_64).collect();
            assert_eq!(read[1..], expected, "with {compiler}");
        }
    });
}

#[test]
fn adding_many_draws_into_a_float_target_is_exact_and_repeatable() {
    gpu_test(|device| {
        assert!(device.physical().has(Feature::BlendR32Float), "{} cannot", device.physical().name);
        let target = color_target(device, "sum", vk::Format::R32_SFLOAT, 16, 16);
        let pass = Pass::graphics("add", "", "common/fullscreen.vert", "test/constant.frag")
            .constants::<Paint>()
            .color(&target, BLACK, Blend::Add)
            .build(&shaders(device))
            .unwrap();
        // 0.1 is no binary fraction: each sum rounds, in the order of the draws.
        let addends: Vec<f32> = (0..300).map(|i| if i % 3 == 0 { 0.1 } else { 1.0 }).collect();
        let draw = || {
            run(device, Mode::Plain, |frame| {
                frame.graphics(&pass, |draw| {
                    for &addend in &addends {
                        draw.constants(&Paint { value: [addend; 4] }).vertices(3);
                    }
                })
            })
            .unwrap();
            texels::<f32>(device, &target)
        };
        let expected = addends.iter().fold(0.0_f32, |sum, addend| sum + addend);
        let picture = draw();
        assert_eq!(picture, [expected; 256]);
        assert_eq!(picture, draw(), "a second run is the same, bit for bit");
    });
}

#[test]
fn the_blend_states_do_what_they_say() {
    gpu_test(|device| {
        let cases = [
            (Blend::Replace, [0.5, 0.25, 1.0, 0.5]),
            (Blend::Add, [0.75, 0.75, 1.25, 0.75]),
            (Blend::Multiply, [0.125, 0.125, 0.25, 0.25]),
            (Blend::Over, [0.375, 0.375, 0.625, 0.625]),
            (Blend::Premultiplied, [0.625, 0.5, 1.125, 0.625]),
        ];
        for (blend, expected) in cases {
            let target = color_target(device, "blended", vk::Format::R32G32B32A32_SFLOAT, 4, 4);
            let pass = Pass::graphics("blend", "", "common/fullscreen.vert", "test/constant.frag")
                .constants::<Paint>()
                .color(&target, Load::Clear([0.25, 0.5, 0.25, 0.25]), blend)
                .build(&shaders(device))
                .unwrap();
            assert_eq!(pass.info().blend, [blend.as_str()]);
            run(device, Mode::Plain, |frame| {
                frame.graphics(&pass, |draw| {
                    draw.constants(&Paint { value: [0.5, 0.25, 1.0, 0.5] }).vertices(3);
                })
            })
            .unwrap();
            assert_eq!(texels::<[f32; 4]>(device, &target), [expected; 16], "{blend:?}");
        }
    });
}

#[test]
fn every_embedded_shader_is_a_valid_module_with_both_compilers() {
    gpu_test(|device| {
        for compiler in [Compiler::Glslang, Compiler::Naga] {
            let library = shaders_by(device, compiler);
            for shader in fumarole::shader_build::EMBEDDED {
                let module = library.module(shader.name).unwrap();
                let expected = if shader.naga.is_ok() { compiler } else { Compiler::Glslang };
                assert_eq!(module.compiler, expected, "{}", shader.name);
            }
        }
    });
}
