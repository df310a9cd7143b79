//! The stop logic against made machines.

use serde_json::{Value, json};

use super::*;
use crate::report::example;

/// A machine whose steps take what a formula says.
struct Made {
    clock_s: f64,
    seconds: fn(&Cell) -> f64,
    bytes: fn(&Cell) -> u64,
    free: Option<u64>,
    /// Ends the step in place of a result.
    end: fn(&Cell) -> Option<(StopKind, &'static str)>,
    change: fn(&Cell, &mut Step),
    interrupt_after: usize,
    taken: Vec<Cell>,
    kept: Vec<usize>,
}

impl Default for Made {
    fn default() -> Self {
        Made {
            clock_s: 0.0,
            seconds: |_| 0.001,
            bytes: |_| 1 << 20,
            free: None,
            end: |_| None,
            change: |_, _| {},
            interrupt_after: usize::MAX,
            taken: vec![],
            kept: vec![],
        }
    }
}

impl Climber for Made {
    type Error = ();

    fn elapsed_s(&self) -> f64 {
        self.clock_s
    }

    fn available_bytes(&self) -> Option<u64> {
        self.free
    }

    fn is_interrupted(&self) -> bool {
        self.taken.len() >= self.interrupt_after
    }

    fn take(&mut self, cell: &Cell, left_s: f64) -> Result<Outcome, ()> {
        self.taken.push(cell.clone());
        let seconds = (self.seconds)(cell);
        if seconds > left_s {
            self.clock_s += left_s;
            return Ok(Outcome::Stopped(StopKind::Time, "late".to_owned()));
        }
        self.clock_s += seconds;
        if let Some((kind, reason)) = (self.end)(cell) {
            return Ok(Outcome::Stopped(kind, reason.to_owned()));
        }
        let mut step = Step {
            value: cell.value,
            amount: cell.value as f64,
            throughput_per_s: None,
            wall_s: seconds,
            peak_bytes: Some((self.bytes)(cell)),
            not_finite: Default::default(),
            run: example::minimal().runs.remove(0),
        };
        (self.change)(cell, &mut step);
        Ok(Outcome::Finished(Box::new(step)))
    }

    fn keep(&mut self, series: &[Series]) -> Result<(), ()> {
        self.kept.push(series.iter().map(|series| series.steps.len()).sum());
        Ok(())
    }
}

fn climb(most: u64, budget_s: f64) -> Climb {
    let ladder = Ladder { from: 1, factor: 2.0, most };
    Climb { ladder, across: None, variants: vec!["a".to_owned()], counts_values: true, shard: Shard::ALONE, budget_s }
}

fn values(series: &Series) -> Vec<u64> {
    series.steps.iter().map(|step| step.value).collect()
}

fn stop(series: &Series) -> (StopKind, u64) {
    let stop = series.stop.as_ref().unwrap();
    (stop.kind, stop.value)
}

#[test]
fn the_axis_ends_it_and_every_step_is_kept() {
    let mut made = Made::default();
    let series = climb(20, 100.0).run(&mut made, vec![]).unwrap();
    assert_eq!((values(&series[0]), stop(&series[0])), (vec![1, 2, 4, 8, 16], (StopKind::End, 16)));
    assert_eq!(made.kept, [1, 2, 3, 4, 5, 5, 5]);
    let nothing = climb(0, 100.0).run(&mut made, vec![]).unwrap();
    assert_eq!((values(&nothing[0]), stop(&nothing[0]).0), (vec![], StopKind::End));
}

#[test]
fn a_step_beyond_the_budget_is_foretold_and_not_begun() {
    for (seconds, most) in [
        ((|cell| cell.value as f64) as fn(&Cell) -> f64, 8),
        (|cell| (cell.value as f64).powi(2) / 2.0, 4),
        (|cell| 3.0 + (cell.value as f64).sqrt(), 8),
    ] {
        let mut made = Made { seconds, ..Made::default() };
        let series = climb(u64::MAX, 20.0).run(&mut made, vec![]).unwrap();
        assert_eq!(values(&series[0]).last(), Some(&most));
        assert_eq!(stop(&series[0]), (StopKind::Time, 2 * most));
        assert!(series[0].stop.as_ref().unwrap().reason.contains("not begun"));
        assert!(made.clock_s <= 20.0 && made.taken.len() == series[0].steps.len());
    }
    // What grows suddenly is ended in time.
    let mut made = Made { seconds: |cell| if cell.value < 8 { 0.1 } else { 1e9 }, ..Made::default() };
    let series = climb(u64::MAX, 20.0).run(&mut made, vec![]).unwrap();
    assert_eq!((values(&series[0]), stop(&series[0])), (vec![1, 2, 4], (StopKind::Time, 8)));
    assert!(made.clock_s <= 20.0);
}

#[test]
fn memory_is_foretold_where_the_system_tells_what_is_free() {
    let bytes = |cell: &Cell| (100 + cell.value * 10) << 20;
    let mut made = Made { bytes, free: Some(500 << 20), ..Made::default() };
    let series = climb(u64::MAX, 100.0).run(&mut made, vec![]).unwrap();
    assert_eq!((values(&series[0]).last(), stop(&series[0])), (Some(&32), (StopKind::Memory, 64)));
    let mut made = Made { bytes, ..Made::default() };
    assert_eq!(stop(&climb(1 << 20, 100.0).run(&mut made, vec![]).unwrap()[0]), (StopKind::End, 1 << 20));
}

#[test]
fn what_ends_a_step_ends_its_series_alone() {
    for kind in [StopKind::Device, StopKind::Memory, StopKind::Crash, StopKind::Correctness, StopKind::Interruption] {
        let end: fn(&Cell) -> Option<(StopKind, &'static str)> = match kind {
            StopKind::Device => |cell| (cell.variant == "a" && cell.value > 4).then_some((StopKind::Device, "lost")),
            StopKind::Memory => |cell| (cell.variant == "a" && cell.value > 4).then_some((StopKind::Memory, "killed")),
            StopKind::Crash => |cell| (cell.variant == "a" && cell.value > 4).then_some((StopKind::Crash, "signal")),
            StopKind::Correctness => {
                |cell| (cell.variant == "a" && cell.value > 4).then_some((StopKind::Correctness, "cut"))
            }
            _ => |cell| (cell.variant == "a" && cell.value > 4).then_some((StopKind::Interruption, "ctrl-c")),
        };
        let mut made = Made { end, ..Made::default() };
        let climb = Climb { variants: vec!["a".to_owned(), "b".to_owned()], ..climb(16, 100.0) };
        let series = climb.run(&mut made, vec![]).unwrap();
        assert_eq!((values(&series[0]), stop(&series[0])), (vec![1, 2, 4], (kind, 8)));
        assert_eq!((values(&series[1]), stop(&series[1])), (vec![1, 2, 4, 8, 16], (StopKind::End, 16)));
        // In turn, the small ones first.
        let order: Vec<(&str, u64)> = made.taken.iter().map(|cell| (cell.variant.as_str(), cell.value)).collect();
        assert_eq!(order[..4], [("a", 1), ("b", 1), ("a", 2), ("b", 2)]);
    }
}

#[test]
fn numbers_that_are_not_finite_end_it_where_the_first_step_had_none() {
    let change: fn(&Cell, &mut Step) = |cell, step| {
        step.not_finite.insert("sky".to_owned(), 7);
        if cell.value >= 4 {
            step.not_finite.insert("heights".to_owned(), 1);
        }
    };
    let series = climb(64, 100.0).run(&mut Made { change, ..Made::default() }, vec![]).unwrap();
    assert_eq!((values(&series[0]), stop(&series[0])), (vec![1, 2, 4], (StopKind::Correctness, 4)));
    assert!(series[0].stop.as_ref().unwrap().reason.contains("heights"));

    let change: fn(&Cell, &mut Step) = |cell, step| {
        step.run.results.insert("rate".to_owned(), if cell.value < 8 { json!(1.5) } else { Value::Null });
        step.run.results.insert("never".to_owned(), Value::Null);
    };
    let series = climb(64, 100.0).run(&mut Made { change, ..Made::default() }, vec![]).unwrap();
    assert_eq!(stop(&series[0]), (StopKind::Correctness, 8));
    assert!(series[0].stop.as_ref().unwrap().reason.contains("rate"));
}

#[test]
fn a_second_call_takes_no_finished_step_again() {
    let mut first = Made { interrupt_after: 3, ..Made::default() };
    let known = climb(64, 100.0).run(&mut first, vec![]).unwrap();
    assert_eq!((values(&known[0]), stop(&known[0])), (vec![1, 2, 4], (StopKind::Interruption, 8)));
    let mut second = Made::default();
    let series = climb(64, 100.0).run(&mut second, known.clone()).unwrap();
    assert_eq!((values(&series[0]), stop(&series[0])), (vec![1, 2, 4, 8, 16, 32, 64], (StopKind::End, 64)));
    assert_eq!(second.taken.iter().map(|cell| cell.value).collect::<Vec<_>>(), [8, 16, 32, 64]);
    // A third has nothing to do, and takes no time.
    let mut third = Made::default();
    assert_eq!(climb(64, 0.0).run(&mut third, series.clone()).unwrap(), series);
    assert!(third.taken.is_empty());
    // Other values go between; all are kept, also when this call ends before them.
    let mut other = Made::default();
    let threes = Climb { ladder: Ladder { from: 3, factor: 4.0, most: 20 }, ..climb(20, 100.0) };
    let series = threes.run(&mut other, series).unwrap();
    assert_eq!(values(&series[0]), [1, 2, 3, 4, 8, 12, 16, 32, 64]);
}

#[test]
fn a_limit_of_an_earlier_call_holds_and_time_does_not() {
    let end: fn(&Cell) -> Option<(StopKind, &'static str)> =
        |cell| (cell.value == 8).then_some((StopKind::Device, "beyond"));
    let known = climb(64, 100.0).run(&mut Made { end, ..Made::default() }, vec![]).unwrap();
    let mut again = Made::default();
    let series = climb(64, 100.0).run(&mut again, known).unwrap();
    assert_eq!((stop(&series[0]), again.taken.len()), ((StopKind::Device, 8), 0));

    let seconds: fn(&Cell) -> f64 = |cell| cell.value as f64;
    let known = climb(64, 10.0).run(&mut Made { seconds, ..Made::default() }, vec![]).unwrap();
    assert_eq!(stop(&known[0]).0, StopKind::Time);
    let mut again = Made { seconds, ..Made::default() };
    let series = climb(64, 1000.0).run(&mut again, known).unwrap();
    assert_eq!(stop(&series[0]), (StopKind::End, 64));
}

#[test]
fn a_matrix_climbs_by_its_diagonals_and_ends_where_a_row_has_no_first_step() {
    let across = Some(Ladder { from: 10, factor: 2.0, most: 1000 });
    let matrix = Climb { across, ..climb(4, 100.0) };
    let end: fn(&Cell) -> Option<(StopKind, &'static str)> =
        |cell| (cell.across > Some(40)).then_some((StopKind::Device, "wide"));
    let mut made = Made { end, ..Made::default() };
    let series = matrix.run(&mut made, vec![]).unwrap();
    let found: Vec<_> = series.iter().map(|s| (s.across, values(s).len(), stop(s).0)).collect();
    let full = |across| (Some(across), 3, StopKind::End);
    assert_eq!(found, [full(10), full(20), full(40), (Some(80), 0, StopKind::Device)]);
    let cells: Vec<_> = made.taken.iter().map(|cell| (cell.across.unwrap(), cell.value)).collect();
    assert_eq!(cells[..6], [(10, 1), (10, 2), (20, 1), (10, 4), (20, 2), (40, 1)]);
    // Nothing of it is taken again.
    let mut again = Made::default();
    assert_eq!(matrix.run(&mut again, series.clone()).unwrap(), series);
    assert!(again.taken.is_empty());
}

#[test]
fn shards_climb_every_series_once() {
    let across = Some(Ladder { from: 10, factor: 2.0, most: 100 });
    let variants = vec!["a".to_owned(), "b".to_owned(), "c".to_owned()];
    let whole = Climb { across, variants, ..climb(4, 100.0) };
    let all = whole.run(&mut Made::default(), vec![]).unwrap();
    for count in [1, 2, 5, 40] {
        let mut found = vec![];
        for number in 0..count {
            let shard = Climb { shard: Shard { number, count }, ..whole.clone() };
            found.extend(shard.run(&mut Made::default(), vec![]).unwrap());
        }
        let order = |series: &Series| (series.variant.clone(), series.across);
        found.sort_by_key(order);
        assert_eq!(found, all, "{count}");
    }
}

#[test]
fn values_that_a_step_has_had_are_passed_over() {
    let change: fn(&Cell, &mut Step) = |_, step| step.amount = step.amount.max(50.0);
    let series = climb(200, 100.0).run(&mut Made { change, ..Made::default() }, vec![]).unwrap();
    assert_eq!(values(&series[0]), [1, 64, 128]);
    let found = Climb { counts_values: false, ..climb(4, 100.0) };
    let series = found.run(&mut Made { change, ..Made::default() }, vec![]).unwrap();
    assert_eq!(values(&series[0]), [1, 2, 4]);
}
