//! Medians of a short pass, which the device's clock has rounded to its steps.

use super::*;

/// Milliseconds of a step of the clock.
const STEP_MS: f64 = 83e-6;

/// Two processes whose samples of the pass `splat` are so many steps long, on a device that tells a period or none; one sample
/// in nine is a step longer where the clock shows how it goes.
fn stepping(noise: &mut Noise, steps: u32, period_ns: Option<f64>, shows: bool) -> [Input; 1] {
    let runs = (0..2).map(|process| {
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
    for (period_ns, shows) in [(Some(83.0), false), (Some(83.0), true), (Some(1.0), true), (None, true)] {
        let mut verdict = |of_a: u32, of_b: u32| {
            let [a, b] = [of_a, of_b].map(|steps| stepping(&mut noise, steps, period_ns, shows));
            let comparison = compared(&a, &b, None);
            let splat = &comparison.runs[0].passes[0].time;
            assert!(splat.interval.is_some_and(|[low, high]| low < high), "{splat:?}");
            splat.verdict
        };
        // About 2 us: a step is 4 %.
        assert_eq!([verdict(24, 25), verdict(25, 24)], [Verdict::Unclear; 2], "{period_ns:?} {shows}");
        assert_eq!([verdict(24, 50), verdict(50, 24)], [Verdict::Slower, Verdict::Faster], "{period_ns:?} {shows}");
        // Of milliseconds a step is nothing.
        assert_eq!([verdict(24_000, 25_000), verdict(24_000, 24_001)], [Verdict::Slower, Verdict::Same]);
    }
}
