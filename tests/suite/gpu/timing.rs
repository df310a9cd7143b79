//! Timestamped frames tell each pass's own time. The proof is a heavy fragment pass before a heavy vertex pass on the same
//! target: under a scheme that lets their work overlap the second reads next to nothing.

use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{Blend, Device, FrameSample, Load, Mode, Pass, Recorder, Track};
use fumarole::host_block;

use super::fixtures::{BLACK, color_target, run, shaders};
use crate::common::{gpu_test, gpu_test_alone};

host_block! {
    /// `test/heavy.*`
    struct Work {
        iterations: u32,
    }
}

/// A pass, its load, and how many vertices it draws.
struct Heavy {
    pass: Pass,
    iterations: u32,
    vertex_count: u32,
}

const SIDE: u32 = 128;

fn heavy_passes(device: &Arc<Device>) -> [Heavy; 2] {
    let target = color_target(device, "shared target", vk::Format::R8G8B8A8_UNORM, SIDE, SIDE);
    let shaders = shaders(device);
    let build = |name, vertex, fragment, load| {
        Pass::graphics(name, "", vertex, fragment)
            .constants::<Work>()
            .color(&target, load, Blend::Replace)
            .build(&shaders)
            .unwrap()
    };
    let fragment = build("heavy-fragment", "common/fullscreen.vert", "test/heavy.frag", BLACK);
    let vertex = build("heavy-vertex", "test/heavy.vert", "test/asymmetric.frag", BLACK);
    // About 30 ms each on two cores of lavapipe, where vertex work takes only one.
    [
        Heavy { pass: fragment, iterations: 3_500, vertex_count: 3 },
        Heavy { pass: vertex, iterations: 20_000, vertex_count: 3_000 },
    ]
}

fn record<'a>(recorder: &'a mut Recorder, mode: Mode, order: &[&Heavy]) -> &'a FrameSample {
    recorder
        .run(mode, |frame| {
            for heavy in order {
                frame.graphics(&heavy.pass, |draw| {
                    draw.constants(&Work { iterations: heavy.iterations }).vertices(heavy.vertex_count);
                })?;
            }
            Ok::<(), fumarole::gpu::Error>(())
        })
        .unwrap()
}

/// Each pass's time in milliseconds, in the order of recording, of one timestamped frame.
fn timestamped_ms(recorder: &mut Recorder, order: &[&Heavy]) -> Vec<f64> {
    let sample = record(recorder, Mode::Timestamped, order);
    let times: Vec<f64> = sample.passes.iter().map(|p| p.gpu_ms.unwrap()).collect();
    let sum: f64 = times.iter().sum();
    assert!(sum <= sample.frame_ms, "passes {times:?} in a frame of {} ms", sample.frame_ms);
    assert_eq!(sample.bracket_ms, None);
    let of = |track| sample.spans.iter().filter(move |span| span.track == track);
    for (span, time) in of(Track::Gpu).zip(&times) {
        assert_eq!(span.duration_ms, *time);
        // The device's clock lies on the host's: its work is inside the wait for it, but for the reading of the clocks.
        let wait = of(Track::Wait).next().unwrap();
        let (start, end) = (wait.start_ms - 0.2, wait.start_ms + wait.duration_ms + 0.2);
        assert!(start <= span.start_ms && span.start_ms + span.duration_ms <= end, "{span:?} in {wait:?}");
    }
    times
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn a_pass_reads_its_own_time_whatever_runs_beside_it() {
    gpu_test_alone(|device| {
        let [fragment, vertex] = heavy_passes(device);
        let mut recorder = Recorder::new(device).unwrap();
        record(&mut recorder, Mode::Plain, &[&fragment, &vertex]); // compiles the pipelines
        let mut ratios = [const { Vec::new() }; 4];
        let mut shares = Vec::new();
        for _ in 0..7 {
            // Alone and beside each other in turns, so that a busy machine slows all alike.
            let fragment_alone = timestamped_ms(&mut recorder, &[&fragment])[0];
            let forth = timestamped_ms(&mut recorder, &[&fragment, &vertex]);
            let vertex_alone = timestamped_ms(&mut recorder, &[&vertex])[0];
            let back = timestamped_ms(&mut recorder, &[&vertex, &fragment]);
            ratios[0].push(forth[0] / fragment_alone);
            ratios[1].push(forth[1] / vertex_alone);
            ratios[2].push(back[0] / vertex_alone);
            ratios[3].push(back[1] / fragment_alone);
            // Alone, the pass is nearly the whole frame on the host's clock too.
            shares.push(vertex_alone / record(&mut recorder, Mode::Plain, &[&vertex]).frame_ms);
        }
        let share = median(shares);
        assert!((0.5..2.0).contains(&share), "timestamps and the host's clock differ: {share}");
        let names = ["fragment, first", "vertex after fragment", "vertex, first", "fragment after vertex"];
        for (name, ratio) in names.into_iter().zip(ratios.map(median)) {
            assert!((0.5..2.0).contains(&ratio), "{name}: {ratio:.3} of its time alone");
        }
    });
}

#[test]
fn a_mode_measures_what_it_says_and_nothing_else() {
    gpu_test(|device| {
        let target = color_target(device, "observed", vk::Format::R8G8B8A8_UNORM, 16, 16);
        let pass = Pass::graphics("observed", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&target, Load::Clear([0.0; 4]), Blend::Replace)
            .build(&shaders(device))
            .unwrap();
        for mode in [Mode::Plain, Mode::Bracketed, Mode::Timestamped, Mode::Counted] {
            let sample = run(device, mode, |frame| frame.graphics(&pass, |draw| draw.vertices(3))).unwrap();
            let one = &sample.passes[0];
            assert_eq!(sample.bracket_ms.is_some(), mode == Mode::Bracketed, "{mode:?}");
            assert_eq!(one.gpu_ms.is_some(), mode == Mode::Timestamped, "{mode:?}");
            assert_eq!(one.counts.is_some(), mode == Mode::Counted, "{mode:?}");
            assert_eq!(one.calls, 1, "{mode:?}");
            assert!(sample.bracket_ms.unwrap_or(0.0) <= sample.frame_ms, "{mode:?}");
        }
    });
}

#[test]
fn the_timestamps_cost_little_themselves() {
    gpu_test_alone(|device| {
        let floor_ms = Recorder::new(device).unwrap().timestamp_floor_ms().unwrap().unwrap();
        assert!((0.0..1.0).contains(&floor_ms), "{floor_ms} ms");
    });
}
