//! The figures' scenes, small, and bad numbers.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::model::{Highlight, Object};
use fumarole::papers::gas::parameters::validate_object;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Parameters, Variant};
use fumarole::scene::{Camera, Light};
use glam::Vec3;

use super::drawing::Drawing;
use crate::common::gpu_test;

/// 90 x 62 pixels, 16 steps and 32 entries a side; a solid has steps enough for its surface.
pub fn small(preset: Preset) -> (Parameters, Vec<Object>) {
    let scene = preset.scene();
    let steps = if preset == Preset::Solid { 60 } else { 16 };
    (Parameters { width: 90, height: 62, steps, table_size: 32, ..scene.parameters }, scene.objects)
}

/// Sizes, shadowing and frames of tables 1 and 2 and of the captions.
#[test]
fn the_figures_have_the_papers_sizes_and_frames() {
    let [every_30, every_80] =
        [(30, 150), (80, 400)].map(|(step, last)| (0..=last).step_by(step).collect::<Vec<u32>>());
    let fig_7 = [every_80, vec![440, 480, 520]].concat();
    for (preset, size, variant, frames) in [
        (Preset::Fig3, (1024, 682), Variant::None, vec![0]),
        (Preset::Fig4, (1024, 768), Variant::NoVolume, vec![60]),
        (Preset::Fig5, (1024, 682), Variant::Table, vec![0]),
        (Preset::Fig6, (420, 400), Variant::Surfaces, every_30),
        (Preset::Fig7, (320, 240), Variant::Surfaces, fig_7),
        (Preset::Fig8, (360, 250), Variant::Table, vec![60]),
    ] {
        let parameters = preset.scene().parameters;
        assert_eq!(((parameters.width, parameters.height), preset.variant()), (size, variant), "{preset:?}");
        assert_eq!(preset.frames(), frames, "{preset:?}");
    }
}

/// Step = longest side / 40; tau 4 over side 2; albedo 0.3; 0.8 at g = 0.5 and 0.2 at g = -0.3; light at (3, 6, 3).
#[test]
fn the_defaults_are_those_that_are_documented() {
    let parameters = Parameters::default();
    let volume = parameters.volumes[0];
    assert_eq!((volume.step_m(parameters.steps), volume.tau_per_m), (2.0 / 40.0, 4.0 / 2.0));
    assert_eq!((volume.albedo, volume.phase.map(|p| (p.weight, p.g))), (Vec3::splat(0.3), [(0.8, 0.5), (0.2, -0.3)]));
    assert!(matches!(parameters.lights[0], Light::Point { position, .. } if position == Vec3::new(3.0, 6.0, 3.0)));
    assert_eq!((parameters.table_size, parameters.early_end), (64, 0.01));
}

#[test]
fn every_scene_draws_its_gas() {
    gpu_test(|device| {
        for preset in Preset::ALL {
            let (parameters, objects) = small(preset);
            objects.iter().for_each(|o| validate_object(o).unwrap());
            let frame = preset.bench_frame();
            let draw = |variant, compiler| Drawing::frame(device, compiler, variant, &parameters, &objects, frame);
            let own = draw(preset.variant(), Compiler::Glslang);
            assert!(own.radiance.iter().all(|v| v.is_finite()), "{preset:?}");
            assert!(own.lists.iter().any(|l| l.len() > 2));
            if preset.variant() != Variant::NoVolume {
                let bare = draw(Variant::NoVolume, Compiler::Glslang);
                let changed = own.radiance.iter().zip(&bare.radiance).filter(|(a, b)| (*a - *b).abs() > 0.02).count();
                assert!(changed > 100, "{preset:?}: {changed}");
            }
        }
    });
}

/// From below a board hides what stands on it, also where the two meet in one plane.
#[test]
fn a_board_hides_its_pieces_from_below() {
    gpu_test(|device| {
        for preset in [Preset::Fig4, Preset::Fig7] {
            let (mut parameters, objects) = small(preset);
            parameters.camera = Camera { eye: Vec3::new(0.5, -5.0, 4.0), target: Vec3::ZERO, ..parameters.camera };
            let draw = |objects: &[Object]| Drawing::of(device, Variant::NoVolume, &parameters, objects);
            let (all, board) = (draw(&objects), draw(&objects[..1]));
            let mut hidden = 0;
            for (pixel, list) in board.lists.iter().enumerate() {
                if list.iter().fold(0, |mask, fragment| mask | fragment.mask) == u32::MAX {
                    hidden += 1;
                    assert_eq!(all.color(pixel), board.color(pixel), "{preset:?}, pixel {pixel}");
                }
            }
            assert!(hidden > 500, "{preset:?}: {hidden} pixels of the board");
        }
    });
}

/// Fog lies over the feet of figure 4's pieces as it does over the board round them: where a piece stands on the board the fog before
/// both is the same, and on a piece it has no edges, neither those of a disc nor those of planes that cut it.
#[test]
fn fog_lies_over_a_foot_as_over_the_board_round_it() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Fig4);
        // What is left of white surfaces behind black fog, in light from all around, is the fog's transparency.
        let parameters = Parameters {
            width: 512,
            height: 384,
            lights: vec![Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ZERO }],
            ambient: Vec3::ONE,
            ..parameters
        };
        let plain = |object: Object| {
            let color = if object.gas.is_some() { Vec3::ZERO } else { Vec3::ONE };
            let highlight = Highlight { strength: 0.0, ..object.highlight };
            Object { color, checker: None, highlight, ..object }
        };
        let objects: Vec<Object> = objects.into_iter().map(plain).collect();
        let frame = Preset::Fig4.bench_frame();
        let drawing = Drawing::frame(device, Compiler::Glslang, Variant::NoVolume, &parameters, &objects, frame);
        // The opaque surface that fills a pixel, if one does: its object and its mean depth.
        let surface = |pixel: usize| {
            let whole = drawing.lists[pixel].iter().find(|f| f.opacity == 1.0 && f.mask == u32::MAX);
            whole.map(|f| (f.object, f.depth_m[0].midpoint(f.depth_m[1])))
        };
        let (mut on_pieces, mut at_feet) = (Vec::new(), Vec::new());
        for above in 0..(parameters.width * (parameters.height - 3)) as usize {
            // The edge itself is between two such pixels.
            let below = above + 3 * parameters.width as usize;
            let (Some((upper, upper_m)), Some((lower, lower_m))) = (surface(above), surface(below)) else { continue };
            let change = (drawing.red(above) - drawing.red(below)).abs();
            if upper > 0 && lower == 0 && (upper_m - lower_m).abs() < 0.15 {
                at_feet.push(change);
            } else if upper > 0 && lower == upper && (upper_m - lower_m).abs() < 0.05 {
                on_pieces.push(change);
            }
        }
        for (place, mut changes) in [("feet", at_feet), ("pieces", on_pieces)] {
            changes.sort_by(f64::total_cmp);
            let [middle, most] = [changes[changes.len() / 2], changes[changes.len() * 98 / 100]];
            println!("{place}: {} places, {middle:.3} in the middle, {most:.3} at most of 98 %", changes.len());
            assert!(changes.len() > 80 && middle < 0.05 && most < 0.2, "{place}: {middle} and {most}");
        }
    });
}

#[test]
fn one_seed_gives_one_picture_and_both_compilers_draw_it() {
    gpu_test(|device| {
        let (parameters, objects) = small(Preset::Fig8);
        let draw = |compiler| Drawing::frame(device, compiler, Variant::Table, &parameters, &objects, 60).radiance;
        let first = draw(Compiler::Glslang);
        assert_eq!(first, draw(Compiler::Glslang));
        let other = draw(Compiler::Naga);
        let worst = first.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-3, "{worst}");
    });
}

#[test]
fn bad_numbers_are_named() {
    let default = Parameters::default;
    let with_volume = |change: fn(&mut fumarole::papers::gas::model::Volume)| {
        let mut parameters = default();
        change(&mut parameters.volumes[0]);
        parameters
    };
    let cases = [
        (Parameters { table_size: 0, ..default() }, "table"),
        (Parameters { table_size: 4096, ..default() }, "table"),
        (Parameters { steps: 0, ..default() }, "steps"),
        (Parameters { early_end: f32::NAN, ..default() }, "early-end"),
        (Parameters { shadow_threshold: -1.0, ..default() }, "shadow-threshold"),
        (Parameters { lights: Vec::new(), ..default() }, "light"),
        (with_volume(|v| v.texture.opaque = -1.0), "opaque"),
        (with_volume(|v| v.texture.opaque = f32::NAN), "opaque"),
        (with_volume(|v| v.tau_per_m = f32::NAN), "tau"),
        (with_volume(|v| v.falloff = 2.0), "falloff"),
        (with_volume(|v| v.phase[0].weight = 3.0), "phase"),
        (with_volume(|v| v.half_extent_m.x = 0.0), "volume"),
    ];
    for (parameters, name) in cases {
        assert_eq!(parameters.validate().unwrap_err().name, name);
    }
    assert!(default().validate().is_ok());
}
