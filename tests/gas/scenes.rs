//! The figures' scenes, small, and bad numbers.

use fumarole::gpu::Compiler;
use fumarole::papers::gas::parameters::validate_object;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{Parameters, Variant};

use crate::common::gpu_test;
use crate::drawing::Drawing;

/// 90 x 62 pixels, 16 steps and 32 entries a side; a solid has steps enough for its surface.
pub fn small(preset: Preset) -> (Parameters, Vec<fumarole::papers::gas::model::Object>) {
    let scene = preset.scene();
    let steps = if preset == Preset::Solid { 60 } else { 16 };
    (Parameters { width: 90, height: 62, steps, table_size: 32, ..scene.parameters }, scene.objects)
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
        (Parameters { table_size: 0, ..default() }, "--table"),
        (Parameters { table_size: 4096, ..default() }, "--table"),
        (Parameters { steps: 0, ..default() }, "--steps"),
        (Parameters { early_end: f32::NAN, ..default() }, "--early-end"),
        (Parameters { shadow_threshold: -1.0, ..default() }, "--shadow-threshold"),
        (Parameters { lights: Vec::new(), ..default() }, "--light"),
        (with_volume(|v| v.texture.opaque = -1.0), "--opaque"),
        (with_volume(|v| v.texture.opaque = f32::NAN), "--opaque"),
        (with_volume(|v| v.tau_per_m = f32::NAN), "--tau"),
        (with_volume(|v| v.falloff = 2.0), "--falloff"),
        (with_volume(|v| v.phase[0].weight = 3.0), "--phase"),
        (with_volume(|v| v.half_extent_m.x = 0.0), "--half-extent"),
    ];
    for (parameters, name) in cases {
        assert_eq!(parameters.validate().unwrap_err().name, name);
    }
    assert!(default().validate().is_ok());
}
