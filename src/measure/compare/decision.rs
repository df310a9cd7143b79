//! Verdicts on a family of quantities, a frame and its passes, that were measured together.

use serde::{Deserialize, Serialize};

use super::evidence::Evidence;

/// B against A.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Verdict {
    Same,
    Faster,
    Slower,
    Unclear,
}

/// Standing of a quantity against the limit of `--fail-above`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Gate {
    /// B is certainly not slower than the limit allows.
    Passed,
    /// B is certainly slower.
    Failed,
    /// Neither is certain.
    Undecided,
}

/// Rules of a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Fraction by which the ratio may lie off 1 and still be called the same.
    pub margin: f64,
    /// Probability of an error: of each SAME, and of any FASTER or SLOWER in the family.
    pub error: f64,
}

impl Default for Rules {
    fn default() -> Self {
        Rules { margin: SAME_MARGIN, error: 1.0 - CONFIDENCE }
    }
}

/// Probability with which an interval holds the true ratio.
pub const CONFIDENCE: f64 = 0.95;

/// Margin of [`Rules`] that name none: what moving code or memory about changes by itself (Mytkowicz et al., 2009,
/// "Producing wrong data without doing anything obviously wrong").
pub const SAME_MARGIN: f64 = 0.02;

/// Verdicts on a family.
///
/// The same is what two one-sided tests find within the margin, each at the error's level; it wins over a difference
/// that is certain but smaller. Faster and slower are corrected for their number after Holm: of many passes some differ
/// by chance.
pub fn decide(family: &[&Evidence], rules: Rules) -> Vec<Verdict> {
    let different = holm(&family.iter().map(|evidence| evidence.p_different()).collect::<Vec<_>>(), rules.error);
    let verdicts = family.iter().zip(different).map(|(evidence, is_different)| {
        if is_same(evidence, rules) {
            Verdict::Same
        } else if !is_different {
            Verdict::Unclear
        } else if evidence.estimate() > 0.0 {
            Verdict::Slower
        } else {
            Verdict::Faster
        }
    });
    verdicts.collect()
}

/// Holds a family against a limit, the fraction by which B may be slower; failures are corrected after Holm.
pub fn gate(family: &[&Evidence], limit: f64, error: f64) -> Vec<Gate> {
    let bound = limit.ln_1p();
    let failed = holm(&family.iter().map(|evidence| evidence.p_above(bound)).collect::<Vec<_>>(), error);
    let gates = family.iter().zip(failed).map(|(evidence, has_failed)| {
        if has_failed {
            Gate::Failed
        } else if evidence.p_below(bound) <= error {
            Gate::Passed
        } else {
            Gate::Undecided
        }
    });
    gates.collect()
}

/// About how many processes a side, or blocks, decide on the verdict if what was found is true; absent beyond `most`.
/// `count` are there now, and the family has `members`.
pub fn needed(evidence: &Evidence, rules: Rules, count: usize, members: usize, most: usize) -> Option<usize> {
    fewest(evidence, count, most, |foretold, least| {
        (least <= rules.error && is_same(foretold, rules))
            || (2.0 * least).max(foretold.p_different()) <= rules.error / members as f64
    })
}

/// The same for the standing against a limit, of the `members` that are held against it at an error.
pub fn needed_for_gate(
    evidence: &Evidence,
    (limit, error): (f64, f64),
    count: usize,
    members: usize,
    most: usize,
) -> Option<usize> {
    let bound = limit.ln_1p();
    fewest(evidence, count, most, |foretold, least| {
        least.max(foretold.p_below(bound)) <= error || least.max(foretold.p_above(bound)) <= error / members as f64
    })
}

/// The least number beyond `count` of which the evidence that is foretold decides, given the least probability that so many
/// can give.
fn fewest(evidence: &Evidence, count: usize, most: usize, decides: impl Fn(&Evidence, f64) -> bool) -> Option<usize> {
    (count + 1..=most).find(|&more| decides(&evidence.scaled(more as f64 / count as f64), evidence.least_p(more)))
}

fn is_same(evidence: &Evidence, rules: Rules) -> bool {
    let margin = rules.margin.ln_1p();
    evidence.p_above(-margin) <= rules.error && evidence.p_below(margin) <= rules.error
}

/// Rejections after Holm (1979): the smallest p against error / n, the next against error / (n - 1), until one fails.
fn holm(p: &[f64], error: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|x, y| p[*x].total_cmp(&p[*y]));
    let mut rejected = vec![false; p.len()];
    for (rank, index) in order.into_iter().enumerate() {
        if p[index] > error / (p.len() - rank) as f64 {
            break;
        }
        rejected[index] = true;
    }
    rejected
}

#[cfg(test)]
mod tests {
    use super::*;

    fn evidence(ratio: f64, error: f64) -> Evidence {
        Evidence::Welch { estimate: ratio.ln(), error, rounding: 0.0, freedom: 18.0 }
    }

    #[test]
    fn holm_steps_down() {
        assert_eq!(holm(&[0.01, 0.04, 0.03], 0.05), [true, false, false]);
        assert_eq!(holm(&[0.016, 0.025, 0.05], 0.05), [true, true, true]);
        assert_eq!(holm(&[0.03, 0.02, 0.2], 0.05), [false; 3]);
        assert_eq!(holm(&[], 0.05), [false; 0]);
    }

    #[test]
    fn the_same_wins_over_a_small_difference() {
        let rules = Rules::default();
        let cases = [
            (evidence(1.01, 0.001), Verdict::Same),
            (evidence(1.03, 0.001), Verdict::Slower),
            (evidence(0.97, 0.001), Verdict::Faster),
            (evidence(1.01, 0.02), Verdict::Unclear),
        ];
        for (evidence, expected) in cases {
            assert_eq!(decide(&[&evidence], rules), [expected]);
        }
        // The same evidence among many is not certain any more.
        let weak = evidence(1.05, 0.02);
        assert_eq!(decide(&[&weak], rules), [Verdict::Slower]);
        let flat = evidence(1.0, 0.05);
        let family: Vec<&Evidence> = std::iter::once(&weak).chain(std::iter::repeat_n(&flat, 11)).collect();
        assert_eq!(decide(&family, rules)[0], Verdict::Unclear);
    }

    #[test]
    fn a_gate_passes_fails_or_says_that_it_cannot_tell() {
        let found = gate(&[&evidence(1.1, 0.01), &evidence(1.0, 0.01), &evidence(1.05, 0.01)], 0.05, 0.05);
        assert_eq!(found, [Gate::Failed, Gate::Passed, Gate::Undecided]);
    }

    #[test]
    fn more_processes_are_foretold_for_a_gate() {
        let found =
            |ratio: f64, error: f64| Evidence::Welch { estimate: ratio.ln(), error, rounding: 0.0, freedom: 8.0 };
        let count = |evidence: &Evidence, members| needed_for_gate(evidence, (0.05, 0.05), 5, members, 1000);
        let slower = found(1.1, 0.03);
        assert_eq!(gate(&[&slower], 0.05, 0.05), [Gate::Undecided]);
        assert_eq!(decide(&[&slower], Rules::default()), [Verdict::Slower]);
        // 0.03 √(5 / n) t(0.95) < ln 1.10 - ln 1.05 = 0.0465.
        let one = count(&slower, 1).unwrap();
        assert!((6..=8).contains(&one), "{one}");
        assert!(count(&slower, 12).unwrap() > one, "corrected for the number held against it");
        let faster = count(&found(1.0, 0.03), 12);
        assert!(faster.is_some_and(|count| (6..=8).contains(&count)), "to pass needs no correction: {faster:?}");
        assert_eq!(count(&found(1.05, 0.03), 1), None, "at the limit");
    }

    #[test]
    fn more_processes_are_foretold() {
        let rules = Rules::default();
        let few = Evidence::Welch { estimate: 0.0, error: 0.015, rounding: 0.0, freedom: 8.0 };
        let count = needed(&few, rules, 5, 1, 1000).unwrap();
        // 0.015 √(5 / n) t(0.95) < ln 1.02.
        assert!((7..=9).contains(&count), "{count}");
        assert!(needed(&few, rules, 5, 12, 1000).unwrap() <= count, "nothing differs");
        let margin = Evidence::Welch { estimate: 0.02_f64.ln_1p(), error: 0.5, rounding: 0.0, freedom: 8.0 };
        assert_eq!(needed(&margin, rules, 5, 1, 1000), None);
        // Ranks of few blocks are never certain, however clear the difference: 2 / 2^n <= 0.0125 / 6.
        let clear = Evidence::signed_ranks(&[2.0, 2.001]).unwrap();
        let look = Rules { error: 0.0125, ..rules };
        assert_eq!(needed(&clear, look, 2, 6, 1000), Some(10));
        let alike = Evidence::signed_ranks(&[0.0001, -0.0001]).unwrap();
        assert_eq!(needed(&alike, look, 2, 6, 1000), Some(7), "1 / 2^n <= 0.0125");
    }
}
