//! Medians of a short pass, which the device's clock has rounded to its steps.

use super::*;

/// Milliseconds of a step of the clock.
const STEP_MS: f64 = 83e-6;

/// Processes whose samples of the pass `splat` are so many steps long, on a device that tells a period or none; one sample
/// in nine is a step longer where the clock shows how it goes.
fn stepping(noise: &mut Noise, processes: u32, steps: u32, (period_ns, shows): (Option<f64>, bool)) -> [Input; 1] {
    let runs = (0..processes).map(|process| {
        let mut splat = [f64::from(steps) * STEP_MS; 9];
        splat[4] += if shows { STEP_MS } else { 0.0 };
        Run { process, ..with_passes(&noise.frame_times(FRAMES, 5.0, 0.01), &[], &splat) }
    });
    let mut side = input("x.json", runs.collect());
    side.record.environment.device.timestamp_period = period_ns;
    [side]
}

#[test]
fn medians_of_neighbouring_steps_are_no_certain_difference() {
    let mut noise = Noise::new(1);
    for clock in [(Some(83.0), false), (Some(83.0), true), (Some(1.0), true), (None, true)] {
        let mut verdict = |of_a: u32, of_b: u32| {
            let [a, b] = [of_a, of_b].map(|steps| stepping(&mut noise, 2, steps, clock));
            let comparison = compared(&a, &b, None);
            let splat = &comparison.runs[0].passes[0].time;
            assert!(splat.interval.is_some_and(|[low, high]| low < high), "{splat:?}");
            splat.verdict
        };
        // About 2 us: a step is 4 %.
        assert_eq!([verdict(24, 25), verdict(25, 24)], [Verdict::Unclear; 2], "{clock:?}");
        assert_eq!([verdict(24, 50), verdict(50, 24)], [Verdict::Slower, Verdict::Faster], "{clock:?}");
        // Of milliseconds a step is nothing.
        assert_eq!([verdict(24_000, 25_000), verdict(24_000, 24_001)], [Verdict::Slower, Verdict::Same]);
    }
}

/// Twelve blocks, in which all medians of a side are alike: they may all be off alike.
#[test]
fn blocks_of_neighbouring_steps_are_no_certain_difference() {
    let mut noise = Noise::new(1);
    let options = Options { design: Design::Blocks, ..Options::default() };
    for clock in [(Some(83.0), false), (None, true)] {
        let mut verdict = |of_a: u32, of_b: u32| {
            let [a, b] = [of_a, of_b].map(|steps| stepping(&mut noise, 24, steps, clock));
            let splat = &compare(&a, &b, &options).unwrap().runs[0].passes[0].time;
            assert!(splat.interval.is_some_and(|[low, high]| low < high), "{splat:?}");
            splat.verdict
        };
        assert_eq!([verdict(24, 25), verdict(25, 24)], [Verdict::Unclear; 2], "{clock:?}");
        assert_eq!([verdict(24, 50), verdict(50, 24)], [Verdict::Slower, Verdict::Faster], "{clock:?}");
        assert_eq!([verdict(24_000, 25_000), verdict(24_000, 24_001)], [Verdict::Slower, Verdict::Same]);
    }
}
