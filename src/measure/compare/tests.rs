mod conditions;
mod order;
mod steps;
mod words;

use serde_json::json;

use super::synthetic::Noise;
use super::*;
use crate::measure::statistics::summarize;
use crate::report::example;
use crate::report::record::{Pass, PassKind, Run, Validation};
use crate::report::table::Style;

const FRAMES: usize = 150;
const SEEDS: u64 = 100;

impl Noise {
    /// One process's frame times: independent noise of the given relative deviation.
    pub fn frame_times(&mut self, count: usize, mean_ms: f64, deviation: f64) -> Vec<f64> {
        (0..count).map(|_| mean_ms * (1.0 + deviation * self.normal())).collect()
    }

    /// One process's frame times as they are on a busy machine: the process as a whole is off by `drift`, and its
    /// frames by noise with correlation 0.9 from one to the next.
    pub fn drifting_frame_times(&mut self, count: usize, mean_ms: f64, deviation: f64, drift: f64) -> Vec<f64> {
        let level = mean_ms * (1.0 + drift * self.normal());
        let noise = self.autoregressive(count, 0.9);
        noise.iter().map(|x| level * (1.0 + deviation * x)).collect()
    }
}

fn run_of(samples: &[f64]) -> Run {
    Run { frames: samples.len() as u32, frame_ms: summarize(samples), ..example::run() }
}

fn input(name: &str, runs: Vec<Run>) -> Input {
    Input { name: name.to_owned(), record: Record::new(example::environment(), vec![], runs) }
}

fn side(name: &str, processes: usize, mut samples: impl FnMut() -> Vec<f64>) -> Vec<Input> {
    (0..processes).map(|index| input(&format!("{name}{index}.json"), vec![run_of(&samples())])).collect()
}

fn compared(a: &[Input], b: &[Input], fail_above: Option<f64>) -> Comparison {
    compare(a, b, &Options { fail_above, ..Options::default() }).unwrap()
}

fn verdict(a: &[Input], b: &[Input]) -> Verdict {
    compared(a, b, None).runs[0].frame.verdict
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
        let comparison = compared(&a, &b, Some(0.0));
        let run = &comparison.runs[0];
        assert_eq!(run.frame.verdict, Verdict::Same);
        assert_eq!(run.frame.interval, Some([1.0, 1.0]));
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
    let comparison = compared(&sides[0], &sides[1], Some(0.05));
    assert_eq!(comparison.runs[0].frame.verdict, Verdict::Unclear);
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
    let comparison = compared(&sides[0], &sides[1], None);
    assert_eq!(comparison.runs[0].a_processes, 5);
    assert_eq!(comparison.runs[0].frame.verdict, Verdict::Slower);
    assert_eq!(verdict(&sides[1], &sides[0]), Verdict::Faster);
}

#[test]
fn a_regression_is_an_interval_beyond_the_limit() {
    let mut noise = Noise::new(1);
    let [a, b] = [5.0, 5.5].map(|mean_ms| side("x", 5, || noise.frame_times(FRAMES, mean_ms, 0.005)));
    let fails = |limit| compared(&a, &b, Some(limit)).has_regression();
    assert!(fails(0.05));
    assert!(!fails(0.10));
    assert!(!fails(0.15));
    assert!(!compared(&b, &a, Some(0.05)).has_regression());
    assert!(!compared(&a, &b, None).has_regression());

    // A limit below the margin replaces it: what fails is not called the same.
    let b = side("x", 5, || noise.frame_times(FRAMES, 5.075, 0.001));
    let strict = compared(&a, &b, Some(0.005));
    assert_eq!(strict.runs[0].frame.verdict, Verdict::Slower);
    assert!(strict.has_regression());
    assert_eq!(verdict(&a, &b), Verdict::Same);
}

#[test]
fn what_was_measured_differently_cannot_be_compared() {
    let original = run_of(&[5.0; 4]);
    let with = |change: fn(&mut Input)| {
        let mut other = input("b.json", vec![original.clone()]);
        change(&mut other);
        compare(&[input("a.json", vec![original.clone()])], &[other], &Options::default())
    };
    assert!(with(|_| ()).is_ok());
    type Change = fn(&mut Input);
    let cases: [(&str, Change); 7] = [
        ("paper is \"gas\"", |b| b.record.runs[0].paper = "lava".into()),
        ("variant", |b| b.record.runs[0].variant = "splats".into()),
        ("preset is absent", |b| b.record.runs[0].preset = Some("figure-7".into())),
        ("config.planes", |b| {
            b.record.runs[0].config.insert("planes".into(), json!(60));
        }),
        ("width is 800", |b| b.record.runs[0].width = 1024),
        ("seed", |b| b.record.runs[0].seed = 2),
        ("validation", |b| b.record.runs[0].validation = Validation::Clean),
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
    let comparison = compared(&a, &b, None);
    assert_eq!(comparison.runs.len(), 1);
    assert_eq!(comparison.only_in_a.len(), 1);
    assert!(comparison.only_in_a[0].contains("splats"));

    let conflict = [input("b.json", vec![run("slices", 30), run("splats", 60)])];
    let message = compare(&a, &conflict, &Options::default()).unwrap_err().to_string();
    assert!(message.contains("config.planes is 30"), "{message}");
    for (a, b) in [(&a[..], &[][..]), (&[], &a), (&a, &[input("b.json", vec![])])] {
        assert!(matches!(compare(a, b, &Options::default()), Err(CompareError::NoRun { .. })));
    }
}

/// A run of two passes besides the frame: `cluster` on the host's clock, `splat` on the device's.
fn with_passes(frame: &[f64], cluster: &[f64], splat: &[f64]) -> Run {
    let mut run = run_of(frame);
    run.passes = vec![
        Pass { host_ms: summarize(cluster), ..example::pass("cluster", PassKind::Host) },
        Pass { gpu_ms: summarize(splat), ..example::pass("splat", PassKind::Graphics) },
    ];
    run
}

#[test]
fn passes_have_verdicts_by_clock() {
    let mut noise = Noise::new(1);
    let mut times = |mean_ms: f64| noise.frame_times(FRAMES, mean_ms, 0.005);
    let [a, b] = [0.1, 0.3].map(|splat_ms| {
        let runs = (0..5).map(|process| {
            let mut run = Run { process, ..with_passes(&times(5.0), &times(1.0), &times(splat_ms)) };
            let wait_ms = summarize(&times(1.0 - splat_ms));
            run.passes.push(Pass { wait_ms, ..example::pass("read-back", PassKind::Transfer) });
            run
        });
        vec![input("x.json", runs.collect())]
    });
    let comparison = compared(&a, &b, Some(0.05));
    let run = &comparison.runs[0];
    assert_eq!(run.frame.verdict, Verdict::Same);
    let found: Vec<_> = run.passes.iter().map(|p| (p.name.as_str(), p.clock, p.time.verdict, p.time.gate)).collect();
    assert_eq!(found[0], ("cluster", Clock::Host, Verdict::Same, Some(Gate::Passed)));
    assert_eq!(found[1], ("splat", Clock::Gpu, Verdict::Slower, Some(Gate::Failed)));
    assert_eq!(found[2], ("read-back", Clock::Wait, Verdict::Faster, Some(Gate::Passed)));
    assert!((run.passes[1].time.ratio.unwrap() - 3.0).abs() < 0.02);
    assert!(comparison.has_regression(), "a pass of 6 % that takes three times as long fails");

    // Below the share it has its verdict and does not fail.
    let options = Options { fail_above: Some(0.05), min_share: 0.1, ..Options::default() };
    let lenient = compare(&a, &b, &options).unwrap();
    assert_eq!(lenient.runs[0].passes[1].time.verdict, Verdict::Slower);
    assert!(!lenient.has_regression() && !lenient.is_unclear());
    let text = render(&comparison, Style::default());
    assert!(text.contains("regression beyond 5 %: splat"), "{text}");
    assert!(markdown(&comparison).contains("| splat | GPU |"), "{}", markdown(&comparison));
}

#[test]
fn what_one_side_lacks_is_named() {
    let four = [1.0; 4];
    let mut more = with_passes(&[5.0; 4], &four, &four);
    let a = [input("a.json", vec![more.clone()])];
    more.passes.remove(1);
    let b = [input("b.json", vec![more])];
    let comparison = compared(&a, &b, None);
    assert_eq!(comparison.runs[0].missing_passes, ["splat"]);
    assert!(comparison.is_missing_any());
    assert!(!compared(&b, &a, None).is_missing_any());
    let splat = &comparison.runs[0].passes[1];
    assert_eq!((splat.time.ratio, splat.time.reason.as_deref()), (None, Some("B has no such time")));
    assert!(render(&comparison, Style::default()).contains("B lacks passes of"));
}

/// `ab` would go on for a pass that it can never find on the other side.
#[test]
fn what_one_side_lacks_is_never_waited_for() {
    let mut noise = Noise::new(1);
    let mut times = |mean_ms: f64| noise.frame_times(FRAMES, mean_ms, 0.002);
    let [a, b] = [1, 2].map(|passes| {
        let runs = (0..10).map(|process| {
            let mut run = Run { process, ..with_passes(&times(5.0), &times(1.0), &times(2.0)) };
            run.passes.truncate(passes);
            run
        });
        vec![input("x.json", runs.collect())]
    });
    for (a, b) in [(&a, &b), (&b, &a)] {
        for fail_above in [None, Some(0.05)] {
            let comparison = compared(a, b, fail_above);
            let splat = &comparison.runs[0].passes[1].time;
            assert!(splat.counts && splat.verdict == Verdict::Unclear, "{splat:?}");
            assert!(comparison.is_decided() && comparison.is_unclear());
        }
    }
    // What both have and nobody can tell yet is.
    let [a, b] = [[5.0, 5.3], [5.4, 5.1]].map(|times| times.map(|ms| input("x.json", vec![run_of(&[ms; 4])])));
    assert!(!compared(&a, &b, None).is_decided());
}

#[test]
fn what_cannot_be_told_is_unclear_and_says_what_would_decide() {
    let levels = [[5.0, 5.3, 4.8, 5.1], [5.3, 5.0, 5.5, 5.2]];
    let [a, b] = levels.map(|levels| levels.map(|ms| input(&format!("{ms}.json"), vec![run_of(&[ms; 4])])));
    let comparison = compared(&a, &b, Some(0.05));
    let frame = &comparison.runs[0].frame;
    assert_eq!((frame.verdict, frame.gate), (Verdict::Unclear, Some(Gate::Undecided)));
    assert!(frame.reason.as_ref().unwrap().contains("processes a side would"), "{frame:?}");
    assert!(comparison.is_unclear() && !comparison.has_regression());
    let text = render(&comparison, Style::default());
    assert!(text.contains("undecided against 5 %"), "{text}");
}
