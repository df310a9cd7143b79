use serde_json::json;

use super::synthetic::Noise;
use super::*;
use crate::measure::statistics::summarize;
use crate::report::example;
use crate::report::record::{DeviceKind, PassKind, Validation};
use crate::report::table::Style;

const FRAMES: usize = 150;
const SEEDS: u64 = 100;

fn run_of(samples: &[f64]) -> Run {
    Run { frames: samples.len() as u32, frame_ms: summarize(samples), ..example::run() }
}

fn input(name: &str, runs: Vec<Run>) -> Input {
    Input { name: name.to_owned(), record: Record::new(example::environment(), vec![], runs) }
}

fn side(name: &str, processes: usize, mut samples: impl FnMut() -> Vec<f64>) -> Vec<Input> {
    (0..processes).map(|index| input(&format!("{name}{index}.json"), vec![run_of(&samples())])).collect()
}

fn verdict(a: &[Input], b: &[Input]) -> Verdict {
    compare(a, b, None).unwrap().runs[0].verdict
}

/// Number of seeds that give each of SAME, FASTER, SLOWER and UNCLEAR.
fn count(sides: impl Fn(&mut Noise) -> [Vec<Input>; 2]) -> [u64; 4] {
    let mut counts = [0; 4];
    for seed in 0..SEEDS {
        let [a, b] = sides(&mut Noise::new(seed));
        counts[verdict(&a, &b) as usize] += 1;
    }
    counts
}

#[test]
fn a_record_against_itself_is_the_same() {
    let mut noise = Noise::new(1);
    for processes in [1, 2, 5] {
        let a = side("a", processes, || noise.drifting_frame_times(FRAMES, 5.0, 0.05, 0.05));
        let b: Vec<Input> = a.iter().rev().cloned().collect();
        let comparison = compare(&a, &b, Some(0.0)).unwrap();
        let run = &comparison.runs[0];
        assert_eq!(run.verdict, Verdict::Same);
        assert_eq!(run.frame.unwrap().interval, [1.0, 1.0]);
        assert!(!comparison.has_regression());
    }
}

#[test]
fn a_true_slowdown_is_found() {
    let [same, faster, slower, unclear] = count(|noise| {
        [5.0, 5.5].map(|mean_ms| {
            // 3 % between frames and as much between processes.
            side("x", 5, || {
                let level = mean_ms * (1.0 + 0.03 * noise.normal());
                noise.frame_times(FRAMES, level, 0.03)
            })
        })
    });
    assert_eq!((same, faster), (0, 0));
    assert!(slower >= 95, "{slower} slower, {unclear} unclear");
}

#[test]
fn drift_without_a_change_gives_no_false_verdict() {
    for (processes, drift) in [(5, 0.03), (5, 0.0), (3, 0.03), (2, 0.03), (10, 0.03)] {
        let [_, faster, slower, _] = count(|noise| {
            ["a", "b"].map(|name| side(name, processes, || noise.drifting_frame_times(FRAMES, 5.0, 0.03, drift)))
        });
        let wrong = faster + slower;
        assert!(wrong <= 5, "{wrong} of {SEEDS} with {processes} processes, drift {drift}");
    }
}

#[test]
fn quiet_sides_without_a_change_are_the_same() {
    let [same, faster, slower, unclear] =
        count(|noise| ["a", "b"].map(|name| side(name, 5, || noise.drifting_frame_times(FRAMES, 5.0, 0.01, 0.003))));
    assert!(same >= 95, "{same} same, {faster} faster, {slower} slower, {unclear} unclear");
}

#[test]
fn one_process_a_side_is_unclear() {
    let counts = count(|noise| {
        [(1, 5.0), (3, 10.0)]
            .map(|(processes, mean_ms)| side("x", processes, || noise.frame_times(FRAMES, mean_ms, 0.001)))
    });
    assert_eq!(counts, [0, 0, 0, SEEDS]);
}

#[test]
fn copies_of_one_record_are_one_process() {
    let mut noise = Noise::new(1);
    let sides = [5.0, 10.0].map(|mean_ms| {
        let one = side("x", 1, || noise.frame_times(FRAMES, mean_ms, 0.01));
        vec![one[0].clone(), one[0].clone(), one[0].clone()]
    });
    let comparison = compare(&sides[0], &sides[1], Some(0.05)).unwrap();
    assert_eq!(comparison.runs[0].verdict, Verdict::Unclear);
    assert_eq!(comparison.runs[0].a_processes, 1);
    assert!(!comparison.has_regression());
    assert!(comparison.warnings.iter().any(|w| w.contains("counted once")));
}

#[test]
fn processes_may_share_a_record() {
    let mut noise = Noise::new(1);
    let sides = [5.0, 10.0].map(|mean_ms| {
        let runs = (0..5).map(|process| Run { process, ..run_of(&noise.frame_times(FRAMES, mean_ms, 0.01)) });
        vec![input("x.json", runs.collect())]
    });
    let comparison = compare(&sides[0], &sides[1], None).unwrap();
    assert_eq!(comparison.runs[0].a_processes, 5);
    assert_eq!(comparison.runs[0].verdict, Verdict::Slower);
    assert_eq!(verdict(&sides[1], &sides[0]), Verdict::Faster);
}

#[test]
fn a_regression_is_an_interval_beyond_the_limit() {
    let mut noise = Noise::new(1);
    let [a, b] = [5.0, 5.5].map(|mean_ms| side("x", 5, || noise.frame_times(FRAMES, mean_ms, 0.005)));
    let fails = |limit| compare(&a, &b, Some(limit)).unwrap().has_regression();
    assert!(fails(0.05));
    assert!(!fails(0.10));
    assert!(!fails(0.15));
    assert!(!compare(&b, &a, Some(0.05)).unwrap().has_regression());
    assert!(!compare(&a, &b, None).unwrap().has_regression());

    // A limit below the margin replaces it: what fails is not called the same.
    let b = side("x", 5, || noise.frame_times(FRAMES, 5.075, 0.001));
    let strict = compare(&a, &b, Some(0.005)).unwrap();
    assert_eq!(strict.runs[0].verdict, Verdict::Slower);
    assert!(strict.has_regression());
    assert_eq!(verdict(&a, &b), Verdict::Same);
}

#[test]
fn what_was_measured_differently_cannot_be_compared() {
    let original = run_of(&[5.0; 4]);
    let with = |change: fn(&mut Input)| {
        let mut other = input("b.json", vec![original.clone()]);
        change(&mut other);
        compare(&[input("a.json", vec![original.clone()])], &[other], None)
    };
    assert!(with(|_| ()).is_ok());
    type Change = fn(&mut Input);
    let cases: [(&str, Change); 8] = [
        ("paper is \"gas\"", |b| b.record.runs[0].paper = "lava".into()),
        ("variant", |b| b.record.runs[0].variant = "splats".into()),
        ("preset is absent", |b| b.record.runs[0].preset = Some("figure-7".into())),
        ("config.planes", |b| {
            b.record.runs[0].config.insert("planes".into(), json!(60));
        }),
        ("width is 800", |b| b.record.runs[0].width = 1024),
        ("seed", |b| b.record.runs[0].seed = 2),
        ("validation", |b| b.record.runs[0].validation = Validation::Clean),
        ("environment.device.type is cpu", |b| {
            b.record.environment.device.kind = DeviceKind::Discrete;
        }),
    ];
    for (field, change) in cases {
        let message = with(change).unwrap_err().to_string();
        for part in [field, "a.json", "b.json"] {
            assert!(message.contains(part), "{part} in {message}");
        }
    }
}

#[test]
fn variants_of_one_side_are_listed_and_conflicts_are_errors() {
    let run = |variant: &str, planes: u32| {
        let mut run = run_of(&[5.0; 4]);
        run.variant = variant.to_owned();
        run.config.insert("planes".to_owned(), json!(planes));
        run
    };
    let a = [input("a.json", vec![run("slices", 30), run("splats", 30)])];
    let b = [input("b.json", vec![run("slices", 30)])];
    let comparison = compare(&a, &b, None).unwrap();
    assert_eq!(comparison.runs.len(), 1);
    assert_eq!(comparison.only_in_a.len(), 1);
    assert!(comparison.only_in_a[0].contains("splats"));

    let conflict = [input("b.json", vec![run("slices", 30), run("splats", 60)])];
    let message = compare(&a, &conflict, None).unwrap_err().to_string();
    assert!(message.contains("config.planes is 30"), "{message}");
    for (a, b) in [(&a[..], &[][..]), (&[], &a), (&a, &[input("b.json", vec![])])] {
        assert!(matches!(compare(a, b, None), Err(CompareError::NoRun { .. })));
    }
}

#[test]
fn passes_are_reported_by_clock() {
    let with_passes = |factor: f64, extra: bool| {
        let mut run = run_of(&[5.0; 4]);
        let mut splat = example::pass("splat", PassKind::Graphics);
        splat.gpu_ms = summarize(&[2.0 * factor; 4]);
        let mut cluster = example::pass("cluster", PassKind::Host);
        cluster.host_ms = summarize(&[1.0; 4]);
        run.passes = vec![cluster, splat];
        if extra {
            let mut blur = example::pass("blur", PassKind::Compute);
            blur.gpu_ms = summarize(&[1.0; 4]);
            run.passes.push(blur);
        }
        run
    };
    let a = [input("a.json", vec![with_passes(1.0, false)])];
    let b = [input("b.json", vec![with_passes(1.5, true)])];
    let comparison = compare(&a, &b, None).unwrap();
    let passes = &comparison.runs[0].passes;
    let found: Vec<_> =
        passes.iter().map(|pass| (pass.name.as_str(), pass.clock, pass.ratio.map(|ratio| ratio.ratio))).collect();
    assert_eq!(found[0], ("cluster", Clock::Host, Some(1.0)));
    assert_eq!((found[1].0, found[1].1), ("splat", Clock::Gpu));
    assert!((found[1].2.unwrap() - 1.5).abs() < 1e-12);
    assert_eq!(found[2], ("blur", Clock::Gpu, None));
    let text = render(&comparison, Style::default());
    assert!(text.contains("1.5000"), "{text}");
    assert!(text.lines().any(|line| line.starts_with("blur") && line.contains('-')));
}

#[test]
fn conditions_that_differ_are_warnings() {
    let a = [input("a.json", vec![run_of(&[5.0; 4])])];
    let mut b = a.clone();
    b[0].name = "b.json".to_owned();
    b[0].record.environment.device.driver_version = Some("Mesa 25".to_owned());
    let comparison = compare(&a, &b, None).unwrap();
    let expected = "device.driver_version is null in a.json and \"Mesa 25\" in b.json";
    assert_eq!(comparison.warnings, [expected]);
}

#[test]
fn the_outcome_is_readable_by_people_and_programs() {
    let mut noise = Noise::new(1);
    let [a, b] =
        [("a", 5.0), ("b", 6.0)].map(|(name, mean_ms)| side(name, 5, || noise.frame_times(FRAMES, mean_ms, 0.01)));
    let comparison = compare(&a, &b, Some(0.05)).unwrap();
    let text = render(&comparison, Style::default());
    for part in ["SLOWER: frame B / A 1.", "5 processes", "regression beyond 5 %"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let document = serde_json::to_value(&comparison).unwrap();
    assert_eq!(document["runs"][0]["verdict"], "SLOWER");
    assert_eq!(document["schema"], SCHEMA);
    let read: Comparison = serde_json::from_value(document).unwrap();
    assert_eq!(read.runs[0].verdict, Verdict::Slower);
    assert_eq!(read.a, comparison.a);
}
