//! Least time of a pass: its counted work at the limits that the device was measured at.
//!
//! Each kind of work is a term of its own. A device that is a GPU does them at the same time, so that the longest is the
//! floor. A CPU's front end is serial: vertices and the set-up of triangles come before the rest, of which again the longest
//! counts. Bytes that are merely bound give no term.

use super::limits::{COPY_BYTES, pixel_rate};
use crate::gpu::{Counts, PassKind, Work};
use crate::report::record::Limits;

/// The least time of a pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Floor {
    /// Milliseconds.
    pub ms: f64,
    /// The kind of work that takes most of it.
    pub bound: &'static str,
    /// Milliseconds of each kind of work that is known.
    pub terms: Vec<(&'static str, f64)>,
}

/// Kinds of work that the front end of a CPU device does one after the other.
const FRONT_END: [&str; 2] = ["vertices", "triangles"];

/// The floor of a pass's work in one frame; `None` where nothing of it is known.
pub fn floor(work: &Work, counts: &Counts, kind: PassKind, limits: &Limits, is_cpu: bool) -> Option<Floor> {
    let known = [
        ("vertices", at(counts.vertices, limits.vertex_gvertices_s)),
        ("triangles", at(work.triangles, limits.triangle_gtriangles_s)),
        ("memory", memory_ms(work, limits)),
        ("fill", pixels_ms(work, limits, false)),
        ("blend", pixels_ms(work, limits, true)),
        ("multiply-adds", at(work.multiply_adds.map(|count| 2 * count), limits.fma_gflops)),
        ("invocations", at(counts.compute_invocations, limits.issue_ginvocations_s)),
        ("launch", launch_ms(work, kind, limits)),
    ];
    let terms: Vec<(&str, f64)> =
        known.into_iter().filter_map(|(name, ms)| Some((name, ms.filter(|&ms| ms > 0.0)?))).collect();
    let longest =
        |of: &dyn Fn(&str) -> bool| terms.iter().filter(|(name, _)| of(name)).map(|(_, ms)| *ms).fold(0.0, f64::max);
    let ms = if is_cpu {
        let front_end: f64 = terms.iter().filter(|(name, _)| FRONT_END.contains(name)).map(|(_, ms)| ms).sum();
        front_end + longest(&|name| !FRONT_END.contains(&name))
    } else {
        longest(&|_| true)
    };
    let bound = terms.iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
    Some(Floor { ms, bound, terms })
}

/// Milliseconds of `count` at 10^9 a second.
fn at(count: Option<u64>, giga_per_second: Option<f64>) -> Option<f64> {
    Some(count? as f64 / giga_per_second.filter(|&rate| rate > 0.0)? * 1e-6)
}

/// Less than the measured copy may lie in caches, which the rate of the small one then stands for.
fn memory_ms(work: &Work, limits: &Limits) -> Option<f64> {
    let small = limits.samples.get("small_copy_gb_s").map(|rates| rates.median);
    let rates = [limits.copy_gb_s, small.filter(|_| work.memory_bytes < COPY_BYTES)];
    at(Some(work.memory_bytes), rates.into_iter().flatten().reduce(f64::max))
}

/// Attachments of one pass are filled and blended together: the slowest counts. A format that was not measured counts as
/// the fastest that was.
fn pixels_ms(work: &Work, limits: &Limits, blends: bool) -> Option<f64> {
    let prefix = if blends { "blend_" } else { "fill_" };
    let rates = || limits.samples.iter().filter(|(name, _)| name.starts_with(prefix)).map(|(_, rates)| rates.median);
    let times = work.kept.iter().filter(|kept| kept.blends == blends).filter_map(|kept| {
        let measured = pixel_rate(kept.format, blends).and_then(|name| limits.samples.get(&name));
        at(Some(kept.samples), measured.map(|rates| rates.median).or_else(|| rates().reduce(f64::max)))
    });
    times.reduce(f64::max)
}

fn launch_ms(work: &Work, kind: PassKind, limits: &Limits) -> Option<f64> {
    let one = match kind {
        PassKind::Graphics => limits.empty_draw_ms,
        PassKind::Compute => limits.empty_dispatch_ms,
        PassKind::Transfer | PassKind::Host => None,
    };
    Some(one? * f64::from(work.launches))
}

#[cfg(test)]
mod tests {
    use ash::vk;

    use super::*;
    use crate::gpu::Kept;
    use crate::measure::statistics::summarize;

    fn limits() -> Limits {
        let rates = [("fill_gpix_s", 2.0), ("fill_r32f_gpix_s", 4.0), ("blend_gpix_s", 1.0), ("small_copy_gb_s", 20.0)];
        Limits {
            copy_gb_s: Some(10.0),
            fma_gflops: Some(50.0),
            vertex_gvertices_s: Some(0.01),
            triangle_gtriangles_s: Some(0.02),
            issue_ginvocations_s: Some(1.0),
            empty_draw_ms: Some(0.05),
            empty_dispatch_ms: Some(0.02),
            samples: rates.iter().filter_map(|(name, rate)| Some(((*name).to_owned(), summarize(&[*rate])?))).collect(),
            ..Limits::default()
        }
    }

    fn drawn() -> (Work, Counts) {
        let kept = |format, blends, samples| Kept { format, blends, samples };
        let work = Work {
            memory_bytes: 100_000_000,
            triangles: Some(20_000),
            kept: vec![
                kept(vk::Format::R8G8B8A8_UNORM, false, 8_000_000),
                kept(vk::Format::R32_SFLOAT, false, 8_000_000),
                kept(vk::Format::R8G8B8A8_UNORM, true, 3_000_000),
            ],
            launches: 2,
            ..Work::default()
        };
        (work, Counts { vertices: Some(50_000), ..Counts::default() })
    }

    #[test]
    fn a_gpu_does_everything_at_once_and_a_cpu_its_front_end_first() {
        let (work, counts) = drawn();
        let gpu = floor(&work, &counts, PassKind::Graphics, &limits(), false).unwrap();
        let expected =
            [("vertices", 5.0), ("triangles", 1.0), ("memory", 10.0), ("fill", 4.0), ("blend", 3.0), ("launch", 0.1)];
        assert_eq!(gpu.terms.len(), expected.len());
        for ((name, ms), (expected_name, expected_ms)) in gpu.terms.iter().zip(expected) {
            assert_eq!(*name, expected_name);
            assert!((ms - expected_ms).abs() < 1e-9, "{name}: {ms}");
        }
        assert!((gpu.ms - 10.0).abs() < 1e-9 && gpu.bound == "memory");
        let cpu = floor(&work, &counts, PassKind::Graphics, &limits(), true).unwrap();
        assert!((cpu.ms - 16.0).abs() < 1e-9 && cpu.bound == "memory", "{cpu:?}");
    }

    #[test]
    fn small_work_may_lie_in_caches_and_unmeasured_formats_are_as_fast_as_any() {
        let work = Work {
            memory_bytes: 1_000_000,
            kept: vec![Kept { format: vk::Format::R32G32_SFLOAT, blends: false, samples: 400_000 }],
            ..Work::default()
        };
        let found = floor(&work, &Counts::default(), PassKind::Graphics, &limits(), false).unwrap();
        assert!((found.ms - 0.1).abs() < 1e-9 && found.bound == "fill", "{found:?}");
        assert!((found.terms[0].1 - 0.05).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn what_is_not_known_gives_no_term() {
        let (work, counts) = drawn();
        let none = floor(&work, &counts, PassKind::Graphics, &Limits::default(), false);
        assert_eq!(none, None);
        let formula = Work { multiply_adds: Some(1_000_000), launches: 1, ..Work::default() };
        let counts = Counts { compute_invocations: Some(10_000), ..Counts::default() };
        let found = floor(&formula, &counts, PassKind::Compute, &limits(), true).unwrap();
        assert_eq!(found.bound, "multiply-adds");
        assert!((found.ms - 0.04).abs() < 1e-9, "{found:?}");
        let names: Vec<&str> = found.terms.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["multiply-adds", "invocations", "launch"]);
    }
}
