//! Sides in turn, and sides that are not.

use super::*;

#[test]
fn sides_that_follow_each_other_are_doubted() {
    // The places of both sides in the order of measurement, as A A B B.
    let doubts = |order: &str| {
        let of = |side: char| {
            let places = (0..).zip(order.chars().filter(|c| *c != ' ')).filter(|(_, of)| *of == side);
            let runs = places.map(|(second, _): (u32, _)| {
                let mut noise = Noise::new(u64::from(second));
                Run {
                    process: second,
                    started: Some(format!("2026-01-31T12:00:{second:02}Z")),
                    ..run_of(&noise.frame_times(FRAMES, 5.0, 0.01))
                }
            });
            [input("x.json", runs.collect())]
        };
        compared(&of('A'), &of('B'), None).warnings
    };
    for order in ["A B", "A A B B", "B B B A A A"] {
        assert!(doubts(order)[0].contains("wholly before"), "{order}");
    }
    for (order, says) in [
        ("A A A A B A B B B B", "hardly measured in turn (3 changes of side in 10 processes)"),
        ("A A A B B B B A A A", "(2 changes of side in 10 processes)"),
    ] {
        assert!(doubts(order)[0].contains(says), "{order}: {}", doubts(order)[0]);
    }
    for order in ["A B A B", "A B B A", "A B B A A B B A A B B A", "A A B A B B", "A A B B A A B B"] {
        assert_eq!(doubts(order), [""; 0], "{order}");
    }
    let of_one = || [input("x.json", vec![Run { started: Some("2026".to_owned()), ..run_of(&[5.0; 4]) }])];
    assert_eq!(compared(&of_one(), &of_one(), None).warnings, [""; 0], "a process against itself");
}

#[test]
fn sides_in_turn_cancel_drift() {
    let mut noise = Noise::new(5);
    let mut level = 1.0;
    let mut sides = [vec![], vec![]];
    for _ in 0..20 {
        for side in [0, 1, 1, 0] {
            // The machine slows down by a percent from process to process; B takes 6 % longer.
            level *= 1.01;
            let mean_ms = level * [5.0, 5.3][side];
            let process = sides[side].len() as u32;
            let run = Run { process, ..run_of(&noise.frame_times(FRAMES, mean_ms, 0.005)) };
            sides[side].push(input("x.json", vec![run]));
        }
    }
    let [a, b] = sides;
    let blocks = Options { design: Design::Blocks, ..Options::default() };
    let frame = &compare(&a, &b, &blocks).unwrap().runs[0].frame;
    assert_eq!(frame.verdict, Verdict::Slower);
    assert!((frame.ratio.unwrap() - 1.06).abs() < 0.003, "{frame:?}");
    assert_eq!(compared(&a, &b, None).runs[0].frame.verdict, Verdict::Unclear, "drift hides it otherwise");

    // What is measured in turn may differ in its work: that is what is compared.
    let mut other = b.clone();
    for input in &mut other {
        input.record.runs[0].variant = "splats".to_owned();
    }
    let comparison = compare(&a, &other, &blocks).unwrap();
    assert_eq!(comparison.differences[0].what, "variant");
    assert_eq!(comparison.runs[0].frame.verdict, Verdict::Slower);
}

/// Pairs of records that are no block cancel no drift: every record with K processes, a process too few, other blocks.
#[test]
fn processes_that_are_not_two_a_block_are_refused() {
    let side = |records: &[&[u32]]| -> Vec<Input> {
        let runs = |numbers: &[u32]| numbers.iter().map(|&process| Run { process, ..run_of(&[5.0; 4]) }).collect();
        records.iter().map(|numbers| input("ab-a.json", runs(numbers))).collect()
    };
    let blocks = |a: &[&[u32]], b: &[&[u32]]| {
        compare(&side(a), &side(b), &Options { design: Design::Blocks, ..Options::default() })
    };
    let whole: [&[&[u32]]; 3] = [&[&[0], &[1]], &[&[2, 3]], &[&[4], &[5], &[8], &[9]]];
    for blocks_of_both in whole {
        let comparison = blocks(blocks_of_both, blocks_of_both).unwrap();
        let count = blocks_of_both.iter().map(|record| record.len()).sum::<usize>();
        assert_eq!(comparison.runs[0].a_processes, count, "equal times are other processes' here");
    }
    let others: [&[&[u32]]; 5] =
        [&[&[0, 1, 2], &[0, 1, 2]], &[&[0, 1], &[0, 1]], &[&[0], &[1], &[2]], &[&[1], &[2]], &[&[2, 3, 0, 1]]];
    for wrong in others {
        let message = blocks(wrong, wrong).unwrap_err().to_string();
        assert!(message.contains("not of the same blocks") && message.contains("gas slices"), "{wrong:?}: {message}");
    }
    blocks(&[&[0, 1]], &[&[2, 3]]).unwrap_err();
    blocks(&[&[0, 1, 2, 3]], &[&[0, 1]]).unwrap_err();
}

/// A pass that one process did not time has no place in its block.
#[test]
fn a_time_that_a_process_lacks_is_in_no_block() {
    let side = |lacking: u32| {
        let runs = (0..4).map(|process| {
            let times = [5.0 + f64::from(process); 4];
            let mut run = Run { process, ..with_passes(&times, &times, &times) };
            run.passes.retain(|pass| process != lacking || pass.name != "splat");
            run
        });
        [input("x.json", runs.collect())]
    };
    let blocks = Options { design: Design::Blocks, ..Options::default() };
    let run = &compare(&side(1), &side(2), &blocks).unwrap().runs[0];
    let splat = &run.passes[1].time;
    assert_eq!((splat.verdict, splat.reason.as_deref()), (Verdict::Unclear, Some("not every block has this time")));
    assert_eq!(run.frame.verdict, Verdict::Same);
}

/// A run that one side lacks takes no other's place, and blocks that are compared as processes are told.
#[test]
fn blocks_of_several_variants_find_their_own() {
    let mut noise = Noise::new(9);
    let mut side = |variants: &[&str], seconds: [u32; 4]| {
        let runs = seconds.into_iter().zip(0..).flat_map(|(second, process)| {
            variants.iter().map(move |variant| (second, process, (*variant).to_owned())).collect::<Vec<_>>()
        });
        let runs = runs.map(|(second, process, variant)| Run {
            process,
            variant,
            started: Some(format!("2026-01-31T12:00:0{second}Z")),
            ..run_of(&noise.frame_times(FRAMES, 5.0, 0.01))
        });
        vec![input("x.json", runs.collect())]
    };
    let a = side(&["none", "slices", "march"], [0, 3, 4, 7]);
    let b = side(&["slices", "march"], [1, 2, 5, 6]);
    let blocks = Options { design: Design::Blocks, ..Options::default() };
    for (a, b) in [(&a, &b), (&b, &a)] {
        let comparison = compare(a, b, &blocks).unwrap();
        let variants: Vec<&str> = comparison.runs.iter().map(|run| run.variant.as_str()).collect();
        assert_eq!((variants, comparison.differences.len()), (vec!["slices", "march"], 0));
        let alone = [&comparison.only_in_a[..], &comparison.only_in_b].concat();
        assert!(alone.len() == 1 && alone[0].starts_with("gas none"), "{alone:?}");
    }
    assert!(are_in_blocks(&a, &b) && !are_in_blocks(&b, &a));
    assert_eq!(compared(&a, &b, None).warnings, [OF_BLOCKS]);
    // Another variant is compared where nothing else is left.
    let [a, b] = [("none", [0, 3, 4, 7]), ("march", [1, 2, 5, 6])].map(|(variant, seconds)| side(&[variant], seconds));
    let comparison = compare(&a, &b, &blocks).unwrap();
    assert_eq!((comparison.runs.len(), comparison.differences[0].what.as_str()), (1, "variant"));
}
