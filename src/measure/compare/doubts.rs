//! What the measured runs of both sides were doubted for: whoever reads a verdict has not seen what their programs printed.

use super::Input;
use crate::report::console::counted_warnings;

/// Every warning of each side's runs once, with the number of runs that it concerns.
pub(super) fn of_runs(a: &[Input], b: &[Input]) -> Vec<String> {
    let of = |side: &str, inputs: &[Input]| -> Vec<String> {
        let warnings = counted_warnings(inputs.iter().flat_map(|input| &input.record.runs));
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
        let a = [input("a.json", &["noisy", "no\nstamps"]), input("a1.json", &["noisy"])];
        let b = [input("b.json", &["noisy"])];
        let expected = ["side A: noisy (2 of 2 runs)", "side A: no\\u000astamps", "side B: noisy"];
        assert_eq!(of_runs(&a, &b), expected);
        let comparison = compare(&a, &b, &Options::default()).unwrap();
        let text = render(&comparison, Style::default());
        for line in expected {
            assert_eq!(text.matches(&format!("warning: {line}\n")).count(), 1, "{line} in {text}");
        }
        assert!(markdown(&comparison).contains("- warning: side B: noisy\n"));
    }
}
