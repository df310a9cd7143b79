//! Work that a driver cuts short goes on in the next dispatch, and is the same in the end: shaders that have used up nearly all of
//! the iterations that lavapipe gives them before they begin, each group of threads up to another place.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use fumarole::gpu::{Compiler, Device, ShaderLibrary};
use fumarole::papers::gas::model::Volume;
use fumarole::papers::gas::scenes::Preset;
use fumarole::papers::gas::{March, Parameters, Variant};

use super::drawing::Drawing;
use super::long::{sheets, view};
use super::march::{gases, parameters};
use super::scenes::small;
use super::skipping::ground;
use crate::common::{gpu_test, shaders_by};

/// Uses up iterations in the first dispatch of a pass, but in the second one of `sort`: its first begins with loops that are short.
const USE_UP: &str = "
    if (band.call == uint(pass == SORT)) {
        uint group = gl_WorkGroupID.x * 97u + gl_WorkGroupID.y * 13u + gl_LocalInvocationIndex / 8u + band.part * 1021u;
        uint wanted = 65534u - scramble(group * 0x9e3779b9u + pass) % ROOM;
        uint turns = 0u;
        do {
            turns += 1u + (frame.size.x >> 30u);
        } while (turns < wanted);
        if (turns == 0xfffffffeu) {
            return false;
        }
    }
";

/// The shaders, which leave themselves up to `room` iterations at first; `sort` ends by itself as well, after 200 links.
fn starved(device: &Arc<Device>, compiler: Compiler, room: u32) -> ShaderLibrary {
    let shaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let folder = tempfile::tempdir().unwrap();
    let passes = ["sort", "volume-none", "volume-traced", "volume-delta", "light-attenuation-", "resolve"];
    for part in ["common", "gas"] {
        fs::create_dir_all(folder.path().join(part)).unwrap();
        for file in fs::read_dir(shaders.join(part)).unwrap() {
            let name = file.unwrap().file_name().into_string().unwrap();
            let is_pass = part == "gas" && passes.iter().any(|pass| name.starts_with(pass));
            if !name.ends_with(".glsl") && !is_pass {
                continue;
            }
            let mut text = fs::read_to_string(shaders.join(part).join(&name)).unwrap();
            let mut replace = |from: &str, to: &str| {
                assert!(text.contains(from), "{name} has no `{from}`");
                text = text.replace(from, to);
            };
            match name.as_str() {
                "progress.glsl" => {
                    let held = "    held = progress[3u * list + 2u].w;\n";
                    replace(held, &format!("{held}{}", USE_UP.replace("ROOM", &format!("{room}u"))));
                }
                "sort.comp" => replace("made < MOST_MADE", "made < 200u"),
                _ => {}
            }
            fs::write(folder.path().join(part).join(&name), text).unwrap();
        }
    }
    ShaderLibrary::new(device, compiler, Some(folder.path())).unwrap()
}

#[test]
fn what_a_dispatch_does_not_finish_another_does_to_the_same_end() {
    gpu_test(|device| {
        let scene = |preset| {
            let (scene, objects) = small(preset);
            (Parameters { width: 48, height: 36, samples: 2, ..scene }, objects)
        };
        let tracked = |(scene, objects): (Parameters, Vec<_>)| {
            (Parameters { march: March::Delta, density_cache: Some(16), ..scene }, objects)
        };
        let two = || {
            let mut volumes: Vec<Volume> = gases().into_iter().take(2).collect();
            volumes[1].center.x = 0.6;
            let mut parameters = Parameters { samples: 2, ..parameters(volumes) };
            parameters.lights.truncate(2);
            (parameters, vec![ground()])
        };
        let cases = [
            ("march", Variant::None, scene(Preset::Fig8)),
            ("shadows", Variant::Traced, scene(Preset::Fig7)),
            ("clouds", Variant::Traced, scene(Preset::Clouds)),
            ("ways", Variant::Traced, tracked(scene(Preset::Fig6))),
            ("two volumes and lights", Variant::Traced, two()),
            ("ways through two volumes", Variant::Traced, tracked(two())),
            ("long lists", Variant::None, (view(3), sheets(1500))),
        ];
        for (compiler, room) in [Compiler::Glslang, Compiler::Naga].into_iter().flat_map(|by| [(by, 40), (by, 1000)]) {
            let (whole, starved) = (shaders_by(device, compiler), starved(device, compiler, room));
            for (name, variant, (parameters, objects)) in &cases {
                if compiler == Compiler::Naga && parameters.march == March::Delta {
                    continue;
                }
                let draw =
                    |shaders: &ShaderLibrary| Drawing::tried_frame(shaders, *variant, parameters, objects, 0).unwrap();
                let (expected, found) = (draw(&whole), draw(&starved));
                let differences = expected.radiance.iter().zip(&found.radiance).map(|(a, b)| (a - b).abs());
                let apart = differences.fold(0.0, f32::max);
                let what = format!("{name} by {compiler:?}, room for {room}");
                println!("{what}: {} and {} runs, {apart:e} apart", expected.runs, found.runs);
                // What `resolve` does not finish is composited in another order.
                assert!(apart < 2e-6, "{what}: {apart}");
                if device.physical().name.contains("llvmpipe") {
                    assert!(found.runs > 1, "{what}: no dispatch was cut");
                }
            }
        }
    });
}
