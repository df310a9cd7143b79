//! Whole frames: pass order, replay, both ways to make splats, both compilers.

use fumarole::gpu::bindings::Resource;
use fumarole::gpu::{Compiler, Device, Feature, Instance, Mode, PassKind, PhysicalDevice, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::lava::{Lava, NEEDS, Parameters, Particles, Rock, Variant};
use fumarole::scene::Camera;
use glam::Vec3;

use super::scene::{draw, lava, parameters, texels};
use crate::common::{gpu_test, gpu_test_alone, shaders_by};

#[test]
fn passes_run_in_the_order_of_the_thesis() {
    gpu_test(|device| {
        let parameters = parameters();
        let mut lava = lava(device, &parameters);
        let sample = draw(device, &mut lava, 0);
        let passes: Vec<_> = sample.passes.iter().map(|p| (p.info.name, p.calls, p.info.kind)).collect();
        use PassKind::{Graphics, Host, Transfer};
        // Ten planes make three clusters.
        assert_eq!(
            passes,
            [
                ("animate", 1, Graphics),
                ("read-positions", 1, Transfer),
                ("cluster", 1, Host),
                ("density", 3, Graphics),
                ("read-density", 3, Transfer),
                ("extract", 3, Host),
                ("accumulate-depths", 1, Graphics),
                ("normal-height", 1, Graphics),
                ("visibility", 1, Graphics),
                ("blending", 1, Graphics),
                ("normalisation", 1, Graphics),
            ]
        );
        let is_timed = |name: &str| sample.passes.iter().any(|p| p.info.name == name && p.host_ms.is_some());
        assert!(is_timed("cluster") && is_timed("extract"));
        let waits = sample.passes.iter().filter(|p| p.wait_ms.is_some()).map(|p| p.info.name);
        assert_eq!(waits.collect::<Vec<_>>(), ["read-positions", "read-density"]);
    });
}

#[test]
fn a_frame_depends_on_its_number_alone() {
    gpu_test(|device| {
        let parameters = parameters();
        let mut lava = lava(device, &parameters);
        let picture = |lava: &mut Lava, number| -> Vec<u8> {
            draw(device, lava, number);
            texels(device, lava.picture())
        };
        let straight: Vec<_> = (0..4).map(|number| picture(&mut lava, number)).collect();
        assert_ne!(straight[0], straight[3]);
        lava.restart().unwrap();
        assert_eq!(picture(&mut lava, 0), straight[0]);
        // Frames 1 and 2 are caught up.
        assert_eq!(picture(&mut lava, 3), straight[3]);
        let mut recorder = Recorder::new(device).unwrap();
        let error = recorder.run(Mode::Plain, |frame| lava.record(frame, 3)).unwrap_err().to_string();
        assert!(error.contains("frame 3 comes before frame 4") && error.contains("restart"), "{error}");
        let mut other = self::lava(device, &parameters);
        assert_eq!(picture(&mut other, 3), straight[3], "another paper, the same seed");
    });
}

/// Bytes by which two pictures differ at most, and in how many pixels by more than one.
fn difference(a: &[u8], b: &[u8]) -> (u8, usize) {
    assert_eq!(a.len(), b.len());
    let off = |(x, y): (&u8, &u8)| x.abs_diff(*y);
    let worst = a.iter().zip(b).map(off).max().unwrap_or(0);
    (worst, a.iter().zip(b).filter(|&pair| off(pair) > 1).count())
}

#[test]
fn instanced_quads_draw_what_the_geometry_stage_draws() {
    gpu_test(|device| {
        let pictures = [true, false].map(|geometry_stage| {
            let parameters = Parameters { geometry_stage, ..parameters() };
            let mut lava = lava(device, &parameters);
            let sample = draw(device, &mut lava, 0);
            let has_geometry = |name: &str| {
                let pass = sample.passes.iter().find(|p| p.info.name == name).unwrap();
                pass.info.shaders.iter().any(|s| s.ends_with(".geom"))
            };
            for pass in ["accumulate-depths", "visibility", "blending"] {
                assert_eq!(has_geometry(pass), geometry_stage, "{pass}");
            }
            // The device has the stage, so leaving it out is the user's choice and no warning.
            assert_eq!(lava.warnings(), Vec::<String>::new());
            texels::<u8>(device, lava.picture())
        });
        let (worst, off) = difference(&pictures[0], &pictures[1]);
        assert!(off <= 8, "{off} values differ, by {worst} at most");
    });
}

/// lavapipe has geometry stages, so it is opened as if it had none: no pass may ask for one.
#[test]
fn a_device_without_geometry_stages_draws_quads_and_says_so() {
    gpu_test_alone(|device| {
        let parameters = parameters();
        let mut with = lava(device, &parameters);
        draw(device, &mut with, 0);
        assert_eq!(with.warnings(), Vec::<String>::new());
        let expected: Vec<u8> = texels(device, with.picture());

        let instance = Instance::new(true).unwrap();
        let same = |physical: &PhysicalDevice| physical.uuid == device.physical().uuid;
        let physical = PhysicalDevice::enumerate(&instance).unwrap().into_iter().find(same).unwrap();
        let lesser = Device::open(&instance, physical.without(Feature::GeometryShader)).unwrap();
        assert_eq!(lesser.physical().lacks(&NEEDS), Vec::<&str>::new(), "it is capable of the paper");
        let mut without = lava(&lesser, &parameters);
        let sample = draw(&lesser, &mut without, 0);
        for pass in ["accumulate-depths", "visibility", "blending"] {
            let shaders = &sample.passes.iter().find(|p| p.info.name == pass).unwrap().info.shaders;
            assert!(shaders.iter().any(|s| s.ends_with("quad.vert")), "{pass}: {shaders:?}");
            assert!(!shaders.iter().any(|s| s.ends_with(".geom")), "{pass}: {shaders:?}");
        }
        let warnings = without.warnings();
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(warning.contains("no geometry stage") && warning.contains("instanced quads"), "{warning}");
        let (worst, off) = difference(&expected, &texels(&lesser, without.picture()));
        assert!(off <= 8, "{off} values differ, by {worst} at most");
        drop((without, lesser));
        assert_eq!(instance.take_messages().iter().map(ToString::to_string).collect::<Vec<_>>(), Vec::<String>::new());
    });
}

#[test]
fn both_compilers_draw_one_picture() {
    gpu_test(|device| {
        let pictures = [Compiler::Glslang, Compiler::Naga].map(|compiler| {
            let parameters = Parameters { geometry_stage: false, ..parameters() };
            let shaders = shaders_by(device, compiler);
            let particles = Particles::seeded(&parameters);
            let mut lava =
                Lava::new(&shaders, "test", Variant::Paper, &parameters, &particles, Rock::built_in(), &[]).unwrap();
            let sample = draw(device, &mut lava, 1);
            let ran = sample.passes.iter().filter_map(|p| p.info.compiler);
            assert!(ran.clone().count() == 7 && ran.into_iter().all(|c| c == compiler));
            texels::<u8>(device, lava.picture())
        });
        let (worst, off) = difference(&pictures[0], &pictures[1]);
        assert!(off <= 8, "{off} values differ, by {worst} at most");

        // With a geometry stage every stage of the pass is glslang's, and the record says so.
        let parameters = parameters();
        let shaders = shaders_by(device, Compiler::Naga);
        let particles = Particles::seeded(&parameters);
        let mut lava =
            Lava::new(&shaders, "test", Variant::Paper, &parameters, &particles, Rock::built_in(), &[]).unwrap();
        let sample = draw(device, &mut lava, 0);
        for pass in sample.passes.iter().filter(|p| p.info.compiler.is_some()) {
            let has_geometry = pass.info.shaders.iter().any(|s| s.ends_with(".geom"));
            let expected = if has_geometry { Compiler::Glslang } else { Compiler::Naga };
            assert_eq!(pass.info.compiler, Some(expected), "{}", pass.info.name);
        }
    });
}

#[test]
fn extreme_configurations_draw_finite_values() {
    gpu_test(|device| {
        let small = parameters();
        let camera = |eye: Vec3, target: Vec3| Camera { eye, target, ..small.camera };
        let cases = [
            Parameters { particles: 1, density: [1; 3], splats: [1; 2], width: 1, height: 1, ..small.clone() },
            Parameters { time_step_s: 1000.0, speed_m_s: 1000.0, ..small.clone() },
            Parameters { radius_m: 1.0, splat_radius_m: 1.0, epsilon_m: 1000.0, ..small.clone() },
            Parameters { border_m: 1000.0, ..small.clone() },
            Parameters { radius_m: 1e-4, rho: Some(1e-30), ..small.clone() },
            Parameters {
                space_m: Vec3::new(1000.0, 1e-3, 1e-3),
                radius_m: 1e-3,
                splat_radius_m: 1e-3,
                ..small.clone()
            },
            // From within the lava, and from below.
            Parameters { camera: camera(Vec3::new(1.0, 0.4, 0.6), Vec3::new(2.0, 0.4, 0.6)), ..small.clone() },
            Parameters { camera: camera(Vec3::new(1.0, -2.0, 0.6), Vec3::new(1.0, 0.0, 0.6)), ..small.clone() },
        ];
        for (case, parameters) in cases.into_iter().enumerate() {
            let mut lava = lava(device, &parameters);
            for number in [0, 1] {
                draw(device, &mut lava, number);
            }
            for target in lava.targets().into_iter().filter(|t| t.name != "picture") {
                let Resource::Image(view) = &target.resource else { panic!("{} is an image", target.name) };
                let values: Vec<f32> = texels(device, view);
                assert!(values.iter().all(|v| v.is_finite()), "case {case}: {}", target.name);
            }
        }
    });
}
