//! Rates of right and wrong verdicts, over many simulated families of twelve quantities.

use super::synthetic::Noise;
use super::{Evidence, Gate, Input, LOOKS, Options, Rules, Verdict, compare, decide, gate};
use crate::measure::statistics::summarize;
use crate::report::example;
use crate::report::record::{Pass, PassKind, Record, Run};

const SEEDS: u64 = 100;

/// Verdicts of many trials: at most `wrong` families in a hundred have a false FASTER or SLOWER.
#[test]
fn families_keep_their_error() {
    let (mut wrong, mut same) = (0, 0);
    for seed in 0..SEEDS {
        let mut noise = Noise::new(1000 + seed);
        let evidence: Vec<Evidence> = (0..12)
            .map(|_| {
                let [a, b] = [0, 1].map(|_| noise.process_log_medians(10, 0.01, 0.01));
                Evidence::welch(&a, &b).unwrap()
            })
            .collect();
        let verdicts = decide(&evidence.iter().collect::<Vec<_>>(), Rules::default());
        same += u64::from(verdicts[0] == Verdict::Same);
        wrong += u64::from(verdicts.iter().any(|v| matches!(v, Verdict::Faster | Verdict::Slower)));
    }
    assert!(wrong <= 7, "{wrong} of {SEEDS}");
    assert!(same >= 93, "{same} of {SEEDS}");
}

/// Twelve quantities, the second 10 % slower on side B: it is named, and a limit of 5 % hardly ever lets it through.
#[test]
fn a_slower_pass_is_named_and_stopped() {
    for (spread, least) in [(0.01, 95), (0.03, 0)] {
        let (mut found, mut failed, mut passed) = (0, 0, 0);
        for seed in 0..SEEDS {
            let mut noise = Noise::new(2000 + seed);
            let evidence: Vec<Evidence> = (0..12)
                .map(|index| {
                    let [a, mut b] = [0, 1].map(|_| noise.process_log_medians(10, spread, 0.01));
                    b.iter_mut().filter(|_| index == 1).for_each(|b| *b += 1.1_f64.ln());
                    Evidence::welch(&a, &b).unwrap()
                })
                .collect();
            let evidence: Vec<&Evidence> = evidence.iter().collect();
            found += u64::from(decide(&evidence, Rules::default())[1] == Verdict::Slower);
            let gates = gate(&evidence, 0.05, Rules::default().error);
            failed += u64::from(gates[1] == Gate::Failed);
            passed += u64::from(gates[1] == Gate::Passed);
        }
        assert!(found >= 93, "{found} of {SEEDS} at a spread of {spread}");
        assert!(failed >= least && passed <= 5, "{failed} stopped, {passed} let through at a spread of {spread}");
    }
}

/// Blocks A B B A on a machine that drifts and steps, looked at as `ab` does: a false verdict in at most 7 of 100; equal
/// frames are the same, and a pass that is 10 % slower is named, in at least 93.
#[test]
fn blocks_keep_their_error_under_drift() {
    let rules = Rules { error: Rules::default().error / LOOKS.len() as f64, ..Rules::default() };
    let last = LOOKS[LOOKS.len() - 1];
    let (mut same, mut found, mut wrong) = (0, 0, 0);
    for seed in 0..SEEDS {
        let mut noise = Noise::new(3000 + seed);
        let levels = noise.block_levels(last, 0.05);
        let members: Vec<Vec<f64>> =
            (0..12).map(|index| noise.block_differences(&levels, if index == 1 { 1.1 } else { 1.0 })).collect();
        let verdicts = LOOKS.iter().find_map(|&look| {
            let evidence: Vec<Evidence> =
                members.iter().map(|blocks| Evidence::signed_ranks(&blocks[..look]).unwrap()).collect();
            let verdicts = decide(&evidence.iter().collect::<Vec<_>>(), rules);
            (look == last || !verdicts.contains(&Verdict::Unclear)).then_some(verdicts)
        });
        let mut verdicts = verdicts.unwrap();
        same += u64::from(verdicts[0] == Verdict::Same);
        found += u64::from(verdicts.remove(1) == Verdict::Slower);
        wrong += u64::from(verdicts.iter().any(|verdict| matches!(verdict, Verdict::Faster | Verdict::Slower)));
    }
    assert!(wrong <= 7, "{wrong} of {SEEDS}");
    assert!(same >= 93 && found >= 93, "{same} the same, {found} slower of {SEEDS}");
}

/// A record of ten processes that differ by 1 %: a frame of 20 ms, and eleven passes of which the first takes 5 % of it.
fn record(noise: &mut Noise, factor: f64) -> Vec<Input> {
    let mut of_processes =
        |ms: f64| noise.process_log_medians(10, 0.01, 0.01).into_iter().map(|log| ms * log.exp()).collect::<Vec<_>>();
    let frames = of_processes(20.0);
    let passes: Vec<Vec<f64>> = (0..11).map(|index| of_processes(if index == 0 { factor } else { 1.9 })).collect();
    let names: Vec<String> = (0..11).map(|index| format!("pass-{index}")).collect();
    let runs = (0..10).map(|process| {
        let at = process as usize;
        let passes = names.iter().zip(&passes);
        let passes = passes.map(|(name, times)| Pass {
            gpu_ms: summarize(&times[at..=at]),
            ..example::pass(name, PassKind::Graphics)
        });
        Run { process, frame_ms: summarize(&frames[at..=at]), passes: passes.collect(), ..example::run() }
    });
    let record = Record::new(example::environment(), vec![], runs.collect());
    vec![Input { name: "x.json".to_owned(), record }]
}

/// The same of whole records, as `compare` decides on its exit code: the limit of 5 % stops a pass of 5 % share that is 10 %
/// slower, and hardly ever sides that are alike.
#[test]
fn records_end_as_their_passes_do() {
    let options = Options { fail_above: Some(0.05), ..Options::default() };
    let (mut found, mut stopped, mut wrong, mut stopped_alike) = (0, 0, 0, 0);
    for seed in 0..SEEDS {
        let mut noise = Noise::new(4000 + seed);
        let [a, alike, slower] = [1.0, 1.0, 1.1].map(|factor| record(&mut noise, factor));
        let comparison = compare(&a, &slower, &options).unwrap();
        let verdicts: Vec<Verdict> = comparison.quantities().map(|quantity| quantity.verdict).collect();
        assert!(comparison.quantities().all(|quantity| quantity.counts) && verdicts.len() == 12);
        found += u64::from(verdicts[1] == Verdict::Slower);
        stopped += u64::from(comparison.has_regression());
        let comparison = compare(&a, &alike, &options).unwrap();
        let is_wrong = |verdict: Verdict| matches!(verdict, Verdict::Faster | Verdict::Slower);
        wrong += u64::from(comparison.quantities().any(|quantity| is_wrong(quantity.verdict)));
        stopped_alike += u64::from(comparison.has_regression());
    }
    assert!(found >= 93 && stopped >= 93, "{found} found and {stopped} stopped of {SEEDS}");
    assert!(wrong <= 7 && stopped_alike <= 1, "{wrong} false verdicts and {stopped_alike} stopped of {SEEDS}");
}
