//! How often verdicts are right, of many made families of twelve quantities.

use super::synthetic::Noise;
use super::{Evidence, Gate, LOOKS, Rules, Verdict, decide, gate};

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
