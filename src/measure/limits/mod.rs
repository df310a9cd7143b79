//! The device's own limits, measured in the same process, so that a pass can be shown as a fraction of them.
//!
//! Each is the time of a load that does one thing and as little else as possible (`loads.rs`). Loads grow until they last, and
//! are then measured several times in turn; every sample is kept.

mod loads;

use std::collections::BTreeMap;

use ash::vk;

use super::machine::Machine;
use super::statistics::{relative_mad, summarize};
use crate::gpu::{Blend, Error, Feature, Frame, Mode, Recorder};
use crate::report::record::{Limits, Summary};

/// A load grows until it lasts this long: far above what a pass takes to begin and end, short enough for every run.
const LEAST_MS: f64 = 16.0;
const SAMPLES: usize = 5;
/// Limits that scatter more than this are doubted.
const NOISY: f64 = 0.1;
/// Bytes of the copied buffer: beyond the caches.
pub(super) const COPY_BYTES: u64 = 64 << 20;
/// Bytes of the small copied buffer: inside them.
const SMALL_COPY_BYTES: u64 = 1 << 20;

/// Formats of colour attachments that are filled and blended, with the name of the rate; the record has the first under
/// its own fields.
pub(crate) const FORMATS: [(vk::Format, &str); 4] = [
    (vk::Format::R8G8B8A8_UNORM, ""),
    (vk::Format::R32_SFLOAT, "r32f_"),
    (vk::Format::R16G16B16A16_SFLOAT, "rgba16f_"),
    (vk::Format::R32G32B32A32_SFLOAT, "rgba32f_"),
];

/// Name of the fill or blend rate of a format's attachments; `None` for one that is not measured.
pub fn pixel_rate(format: vk::Format, blends: bool) -> Option<String> {
    let name = FORMATS.iter().find(|(known, _)| *known == format)?.1;
    Some(format!("{}_{name}gpix_s", if blends { "blend" } else { "fill" }))
}

/// Measures every limit; what the device cannot time or do is absent.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn measure(machine: &mut Machine) -> Result<Limits, Error> {
    measure_some(machine, |_| true)
}

/// Measures the limits whose names are wanted: as the record's samples have them, `copy_gb_s` and so on.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn measure_some(machine: &mut Machine, is_wanted: impl Fn(&str) -> bool) -> Result<Limits, Error> {
    let Machine { recorder, shaders, .. } = machine;
    let mut loads = vec![
        ("copy_gb_s".to_owned(), loads::copy(shaders, COPY_BYTES)?),
        ("small_copy_gb_s".to_owned(), loads::copy(shaders, SMALL_COPY_BYTES)?),
        ("fma_gflops".to_owned(), loads::multiply_add(shaders)?),
        ("issue_ginvocations_s".to_owned(), loads::issue(shaders)?),
        ("vertex_gvertices_s".to_owned(), loads::vertices(shaders)?),
        ("triangle_gtriangles_s".to_owned(), loads::triangles(shaders)?),
        ("empty_draw_ms".to_owned(), loads::empty_draw(shaders)?),
        ("empty_dispatch_ms".to_owned(), loads::empty_dispatch(shaders)?),
    ];
    for (format, _) in FORMATS {
        for blend in [Blend::Replace, Blend::Add] {
            let blends = blend == Blend::Add;
            if let Some(name) = pixel_rate(format, blends).filter(|_| !blends || can_blend(shaders.device(), format)) {
                loads.push((name, loads::fill(recorder, shaders, format, blend)?));
            }
        }
    }
    loads.retain(|(name, _)| is_wanted(name));
    for (_, load) in &mut loads {
        load.grow(recorder)?;
    }
    // In turn, so that what else the machine does for a moment is in one sample of each and not in all of one.
    for _ in 0..SAMPLES {
        for (_, load) in &mut loads {
            load.sample(recorder)?;
        }
    }
    let samples: BTreeMap<String, Summary> =
        loads.into_iter().filter_map(|(name, load)| Some((name, summarize(&load.samples)?))).collect();
    let rate = |name: &str| samples.get(name).map(|rates| rates.median);
    Ok(Limits {
        copy_gb_s: rate("copy_gb_s"),
        fma_gflops: rate("fma_gflops"),
        fill_gpix_s: rate("fill_gpix_s"),
        blend_gpix_s: rate("blend_gpix_s"),
        vertex_gvertices_s: rate("vertex_gvertices_s"),
        triangle_gtriangles_s: rate("triangle_gtriangles_s"),
        issue_ginvocations_s: rate("issue_ginvocations_s"),
        empty_draw_ms: rate("empty_draw_ms"),
        empty_dispatch_ms: rate("empty_dispatch_ms"),
        samples,
    })
}

fn can_blend(device: &crate::gpu::Device, format: vk::Format) -> bool {
    let feature = match format {
        vk::Format::R32_SFLOAT => Feature::BlendR32Float,
        vk::Format::R16G16B16A16_SFLOAT => Feature::BlendRgba16Float,
        vk::Format::R32G32B32A32_SFLOAT => Feature::BlendRgba32Float,
        _ => return true,
    };
    device.physical().has(feature)
}

/// A doubt about limits whose samples scatter: something else used the device, or its clock moved.
pub fn warning(limits: &Limits) -> Option<String> {
    let spread = |rates: &Summary| relative_mad(&rates.samples).filter(|&spread| spread > NOISY);
    let noisy = limits.samples.iter().filter_map(|(name, rates)| Some((name, spread(rates)?)));
    let noisy: Vec<String> = noisy.map(|(name, spread)| format!("{name} {:.0} %", 100.0 * spread)).collect();
    (!noisy.is_empty()).then(|| format!("limits of the device scatter: {}", noisy.join(", ")))
}

type Record = Box<dyn Fn(&mut Frame<'_>, u32) -> Result<(), Error>>;

/// Work of one kind that can be made any number of times as large.
struct Workload {
    /// Amount that it does when it is made once; `None` where its time is looked for and no rate.
    amount: Option<f64>,
    /// Records it so many times as large, under one name.
    record: Record,
    times: u32,
    /// Amounts in 10^9 a second, or milliseconds of one.
    samples: Vec<f64>,
}

impl Workload {
    fn new(amount: f64, record: impl Fn(&mut Frame<'_>, u32) -> Result<(), Error> + 'static) -> Self {
        Workload { amount: Some(amount), record: Box::new(record), times: 1, samples: Vec::new() }
    }

    fn time(record: impl Fn(&mut Frame<'_>, u32) -> Result<(), Error> + 'static) -> Self {
        Workload { amount: None, record: Box::new(record), times: 1, samples: Vec::new() }
    }

    /// Makes it so large that it lasts.
    fn grow(&mut self, recorder: &mut Recorder) -> Result<(), Error> {
        // The first use compiles the pipeline.
        self.run_ms(recorder)?;
        while let Some(ms) = self.run_ms(recorder)?.filter(|&ms| ms < LEAST_MS && self.times < 1 << 14) {
            self.times = (f64::from(self.times) * (LEAST_MS / ms).min(2.0)).ceil() as u32;
        }
        Ok(())
    }

    /// Adds a sample; none without timestamps.
    fn sample(&mut self, recorder: &mut Recorder) -> Result<(), Error> {
        // Once unseen: after another load, threads, clocks and caches are still as that one left them.
        self.run_ms(recorder)?;
        if let Some(ms) = self.run_ms(recorder)? {
            let times = f64::from(self.times);
            self.samples.push(self.amount.map_or(ms / times, |amount| amount * times / ms * 1e-6));
        }
        Ok(())
    }

    fn run_ms(&self, recorder: &mut Recorder) -> Result<Option<f64>, Error> {
        let sample = recorder.run(Mode::Timestamped, |frame| (self.record)(frame, self.times))?;
        Ok(sample.passes.first().and_then(|pass| pass.gpu_ms).filter(|&ms| ms > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;

    #[test]
    fn limits_whose_samples_scatter_are_doubted_by_name() {
        let limits = |rates: &[f64]| Limits {
            samples: summarize(rates).into_iter().map(|rates| ("copy_gb_s".to_owned(), rates)).collect(),
            ..Limits::default()
        };
        assert_eq!(warning(&limits(&[9.9, 10.0, 10.1, 10.0, 10.2])), None);
        let doubt = warning(&limits(&[2.7, 18.3, 5.0, 10.0, 14.0])).unwrap();
        assert!(doubt.contains("scatter: copy_gb_s"), "{doubt}");
        assert_eq!(warning(&Limits::default()), None);
    }
}
