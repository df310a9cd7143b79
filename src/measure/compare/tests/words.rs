//! The outcome as text, as Markdown, for the page and as JSON.

use super::*;

fn validator() -> jsonschema::Validator {
    let schema = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/schema/fumarole.compare-2.json"));
    let schema: Value = serde_json::from_str(schema).unwrap();
    jsonschema::meta::validate(&schema).unwrap();
    jsonschema::validator_for(&schema).unwrap()
}

/// Times that no device gives, as a record edited by hand may hold them.
#[test]
fn extreme_times_have_no_verdict_but_sane_words() {
    let validator = validator();
    let times = [1e308, 1e-310, 5e-324, 0.0, 5.0];
    for (a, b) in times.iter().flat_map(|a| times.map(|b| (*a, b))) {
        let of = |name: &str, ms: f64| {
            let runs = (0..3).map(|process| {
                let near = ms * (1.0 - 0.001 * f64::from(process));
                Run { process, ..with_passes(&[near; 4], &[ms; 4], &[5.0; 4]) }
            });
            vec![input(name, runs.collect())]
        };
        let comparison = compared(&of("a.json", a), &of("b.json", b), Some(0.05));
        for quantity in comparison.quantities() {
            let numbers = [quantity.ratio, quantity.share].into_iter().flatten();
            assert!(
                numbers.chain(quantity.interval.into_iter().flatten()).all(f64::is_finite),
                "{a} {b}: {quantity:?}"
            );
        }
        let document = serde_json::to_value(&comparison).unwrap();
        let errors: Vec<String> =
            validator.iter_errors(&document).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{a} {b}: {errors:#?}");
        for text in [render(&comparison, Style::default()), markdown(&comparison)] {
            assert!(!text.contains("NaN") && !text.contains("inf"), "{a} {b}: {text}");
            assert!(text.lines().all(|line| line.len() < 400), "{a} {b}: {text}");
        }
    }
}

#[test]
fn the_outcome_is_readable_by_people_and_programs() {
    let mut noise = Noise::new(1);
    let [a, b] =
        [("a", 5.0), ("b", 6.0)].map(|(name, mean_ms)| side(name, 5, || noise.frame_times(FRAMES, mean_ms, 0.01)));
    let comparison = compared(&a, &b, Some(0.05));
    let text = render(&comparison, Style::default());
    for part in ["SLOWER: frame B / A 1.", "5 processes", "regression beyond 5 %: frame"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let document = serde_json::to_value(&comparison).unwrap();
    assert_eq!(document["runs"][0]["frame"]["verdict"], "SLOWER");
    assert_eq!(document["schema"], SCHEMA);
    let validator = validator();
    let errors: Vec<String> =
        validator.iter_errors(&document).map(|error| format!("{}: {error}", error.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    for (pointer, wrong) in [("/schema", json!("x")), ("/runs/0/frame/verdict", json!("BAD")), ("/margin", json!("2"))]
    {
        let mut document = document.clone();
        *document.pointer_mut(pointer).unwrap() = wrong;
        assert!(!validator.is_valid(&document), "{pointer}");
    }
    let read: Comparison = serde_json::from_value(document).unwrap();
    assert_eq!(read.runs[0].frame.verdict, Verdict::Slower);
    assert_eq!(read.a, comparison.a);
}

/// Two numbers of planes on both sides, one slower on B: whose the verdict is, and which run only A has.
#[test]
fn runs_of_one_variant_are_named_by_what_tells_them_apart() {
    let mut noise = Noise::new(1);
    let mut side = |name: &str, counts: &[(u32, f64)]| {
        let mut runs = vec![];
        for (process, (planes, mean_ms)) in (0..5).flat_map(|process| counts.iter().map(move |count| (process, *count)))
        {
            let frame = noise.frame_times(FRAMES, mean_ms, 0.005);
            let mut run = Run { process, ..with_passes(&frame, &[1.0; 4], &[1.0; 4]) };
            run.config =
                [("planes", json!(planes)), ("scale", json!(2))].map(|(n, v)| (n.to_owned(), v)).into_iter().collect();
            runs.push(run);
        }
        [input(name, runs)]
    };
    let (a, mut b) = (side("a.json", &[(5, 3.0), (11, 5.0), (50, 9.0)]), side("b.json", &[(5, 3.0), (11, 6.0)]));
    let of_11 = b[0].record.runs.iter_mut().filter(|run| run.config["planes"] == 11);
    of_11.for_each(|run| run.passes.retain(|pass| pass.name != "splat"));
    let comparison = compared(&a, &b, None);
    let text = render(&comparison, Style::default());
    let below = |heading: &str| {
        let mut lines = text.lines().skip_while(|line| *line != heading).skip(1);
        lines.next().unwrap_or_else(|| panic!("no {heading} in\n{text}"))
    };
    let headings = ["gas slices, planes 5: 800 × 600", "gas slices, planes 11: 800 × 600"];
    assert!(below(headings[0]).starts_with("SAME: frame"), "{text}");
    assert!(below(headings[1]).starts_with("SLOWER: frame"), "{text}");
    assert_eq!(comparison.only_in_a, ["gas slices, planes 50, 800 × 600 (a.json)"]);
    assert!(text.contains("B lacks passes of gas slices, planes 11: 800 × 600: splat"), "{text}");
    let markdown = markdown(&comparison);
    let titles: Vec<String> = sections(&comparison).into_iter().map(|section| section.title).collect();
    for heading in headings {
        assert!(markdown.contains(&format!("### {heading}\n")), "{markdown}");
        assert!(titles.iter().any(|title| title == heading), "{titles:?}");
    }
}

/// 10 % against 5 % where processes differ by 5 %: certainly slower, and how many processes would say whether too much.
#[test]
fn a_limit_that_is_undecided_says_what_would_decide_where_the_verdict_is_clear() {
    let levels = [1.0, 1.05, 0.95, 1.06, 0.94];
    let [a, b] = [5.0, 5.5].map(|ms| levels.map(|level| input("x.json", vec![run_of(&[ms * level; 4])])));
    let comparison = compared(&a, &b, Some(0.05));
    let frame = &comparison.runs[0].frame;
    assert_eq!((frame.verdict, frame.gate), (Verdict::Slower, Some(Gate::Undecided)));
    assert_eq!(frame.reason, None);
    let words = frame.gate_reason.as_deref().unwrap();
    assert!(words.starts_with("about ") && words.ends_with(" processes a side would decide"), "{words}");
    let says = format!("undecided against 5 %: frame ({words})");
    for text in [render(&comparison, Style::default()), markdown(&comparison)] {
        assert!(text.contains(&says), "{says} in {text}");
    }
    // What is decided has no such words, with or without a limit.
    assert_eq!(compared(&a, &b, Some(0.3)).runs[0].frame.gate_reason, None);
    assert_eq!(compared(&a, &b, None).runs[0].frame.gate_reason, None);
}
