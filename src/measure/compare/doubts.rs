//! Warnings of the measured runs of both sides: whoever reads a verdict has not seen what their programs printed.

use super::Input;
use crate::report::console::counted_warnings;

/// Every warning of each side's runs once, with the number of runs that it concerns.
pub(super) fn of_runs(a: &[Input], b: &[Input]) -> Vec<String> {
    let of = |side: &str, inputs: &[Input]| -> Vec<String> {
        let runs = inputs.iter().flat_map(|input| &input.record.runs);
        let warnings = counted_warnings(runs.map(|run| run.warnings.as_slice()));
        warnings.into_iter().map(|warning| format!("side {side}: {warning}")).collect()
    };
    [of("A", a), of("B", b)].concat()
}

#[cfg(test)]
mod tests {
    use super::super::{Options, compare, markdown, render};
    use super::*;
    use crate::report::example;
    use crate::report::table::Style;

    #[test]
    fn the_runs_warnings_are_said_once_for_each_side() {
        let input = |name: &str, warnings: &[&str]| {
            let mut record = example::full();
            record.runs[0].warnings = warnings.iter().map(|&warning| warning.to_owned()).collect();
            Input { name: name.to_owned(), record }
        };
        let noisy = |percent: u32| format!("noisy: repetitions of one frame scatter by {percent} %");
        let [six, seven, nine] = [6, 7, 9].map(noisy);
        let a = [
            input("a.json", &["slow", "no\nstamps", &six, "slow"]),
            input("a1.json", &["slow", &nine]),
            input("a2.json", &[&seven]),
        ];
        let b = [input("b.json", &["slow", &seven])];
        let expected = [
            "side A: slow (2 of 3 runs)",
            "side A: no\\u000astamps",
            "side A: noisy: repetitions of one frame scatter by up to 9 % (3 of 3 runs)",
            "side B: slow",
            "side B: noisy: repetitions of one frame scatter by 7 %",
        ];
        assert_eq!(of_runs(&a, &b), expected);
        let comparison = compare(&a, &b, &Options::default()).unwrap();
        let text = render(&comparison, Style::default());
        for line in expected {
            assert_eq!(text.matches(&format!("warning: {line}\n")).count(), 1, "{line} in {text}");
        }
        assert!(markdown(&comparison).contains("- warning: side B: slow\n"));
    }
}
