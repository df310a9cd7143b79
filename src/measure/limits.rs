//! The device's own limits, measured in the same process, so that a pass can be shown as a fraction of them.

use std::collections::BTreeMap;

use ash::vk;

use super::machine::Machine;
use super::statistics::{median, relative_mad, summarize};
use crate::gpu::{
    Blend, Buffer, BufferDesc, Error, Frame, Image, ImageDesc, Load, Mode, Pass, Recorder, ShaderLibrary,
};
use crate::host_block;
use crate::report::record::{Limits, Summary};

/// A load grows until it lasts this long: far above the resolution of a timestamp, short enough for every run.
const LEAST_MS: f64 = 8.0;
const SAMPLES: usize = 5;
/// Limits that scatter more than this are doubted.
const NOISY: f64 = 0.1;
const COPY_BYTES: u64 = 64 << 20;
const THREADS: u32 = 1 << 14;
/// Eight chains of four components, a multiplication and an addition each.
const FLOPS_PER_ITERATION: f64 = 64.0;
/// A side of the target of fill and blend rates.
const SIDE: u32 = 1024;
const BYTES: vk::Format = vk::Format::R8G8B8A8_UNORM;

host_block! {
    struct MultiplyAdd {
        iterations: u32,
        factor: f32,
    }
}

/// Measures copy bandwidth (bytes read and written), multiply-adds, and the fill and additive blend rates of an 8-bit
/// RGBA target. `None` for what has no timestamps.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn measure(machine: &mut Machine) -> Result<Limits, Error> {
    let Machine { recorder, shaders, .. } = machine;
    let samples: BTreeMap<String, Summary> = [
        ("copy_gb_s", copy(recorder, shaders)?),
        ("fma_gflops", multiply_add(recorder, shaders)?),
        ("fill_gpix_s", fill(recorder, shaders, BYTES, SIDE, Blend::Replace)?),
        ("blend_gpix_s", fill(recorder, shaders, BYTES, SIDE, Blend::Add)?),
    ]
    .into_iter()
    .filter_map(|(name, rates)| Some((name.to_owned(), summarize(&rates)?)))
    .collect();
    let rate = |name: &str| samples.get(name).map(|rates| rates.median);
    Ok(Limits {
        copy_gb_s: rate("copy_gb_s"),
        fma_gflops: rate("fma_gflops"),
        fill_gpix_s: rate("fill_gpix_s"),
        blend_gpix_s: rate("blend_gpix_s"),
        samples,
    })
}

/// Doubts about limits whose samples scatter: something else used the device, or its clock moved.
pub fn warnings(limits: &Limits) -> Vec<String> {
    let spread = |rates: &Summary| relative_mad(&rates.samples).filter(|&spread| spread > NOISY);
    let noisy = limits.samples.iter().filter_map(|(name, rates)| Some((name, spread(rates)?)));
    noisy.map(|(name, spread)| format!("the limit {name} scatters by {:.0} %", 100.0 * spread)).collect()
}

/// The additive blend rate of a target of four 32-bit floats, in 10^9 pixels a second; `None` without timestamps. The
/// device must blend into such targets.
///
/// # Errors
/// Any error of the Vulkan layer.
pub fn float_blend_gpix_s(machine: &mut Machine) -> Result<Option<f64>, Error> {
    let Machine { recorder, shaders, .. } = machine;
    // As many bytes as the other targets have.
    Ok(median(&fill(recorder, shaders, vk::Format::R32G32B32A32_SFLOAT, SIDE / 2, Blend::Add)?))
}

/// Runs `record` with a growing load and returns `amount` in 10^9 a second at a load that lasts, sample after sample; none
/// without timestamps.
fn rate(
    recorder: &mut Recorder,
    amount: impl Fn(u32) -> f64,
    record: impl Fn(&mut Frame<'_>, u32) -> Result<(), Error>,
) -> Result<Vec<f64>, Error> {
    let mut once = |load: u32| -> Result<Option<f64>, Error> {
        let sample = recorder.run(Mode::Timestamped, |frame| record(frame, load))?;
        Ok(sample.passes.first().and_then(|p| p.gpu_ms).filter(|&ms| ms > 0.0))
    };
    once(1)?;
    let mut load = 1;
    while load < 1 << 16 && once(load)?.is_some_and(|ms| ms < LEAST_MS) {
        load *= 2;
    }
    let mut rates = Vec::with_capacity(SAMPLES);
    for _ in 0..SAMPLES {
        rates.extend(once(load)?.map(|ms| amount(load) / ms * 1e-6));
    }
    Ok(rates)
}

fn copy(recorder: &mut Recorder, shaders: &ShaderLibrary) -> Result<Vec<f64>, Error> {
    let device = shaders.device();
    // Uploaded, not only allocated: a driver may map untouched pages to one of zeros.
    let bytes = vec![1u8; COPY_BYTES as usize];
    let from = crate::gpu::transfer::upload(device, "limits/copy-source", vk::BufferUsageFlags::empty(), &bytes)?;
    let to = Buffer::new(device, BufferDesc::new("limits/copy-destination", COPY_BYTES))?;
    let pass = Pass::copy("copy", "", &from, &to);
    rate(
        recorder,
        |load| 2.0 * COPY_BYTES as f64 * f64::from(load),
        |frame, load| (0..load).try_for_each(|_| frame.copy(&pass)),
    )
}

fn multiply_add(recorder: &mut Recorder, shaders: &ShaderLibrary) -> Result<Vec<f64>, Error> {
    let desc = BufferDesc::new("limits/results", u64::from(THREADS) * 16).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    let results = Buffer::new(shaders.device(), desc)?;
    let pass = Pass::compute("multiply-add", "", "limits/multiply-add.comp")
        .with("results", &results)
        .constants::<MultiplyAdd>()
        .build(shaders)?;
    let iterations = |load: u32| 64 * load;
    rate(
        recorder,
        |load| f64::from(THREADS) * f64::from(iterations(load)) * FLOPS_PER_ITERATION,
        |frame, load| {
            frame.compute(&pass, |dispatch| {
                let constants = MultiplyAdd { iterations: iterations(load), factor: 0.5 };
                dispatch.constants(&constants).threads(THREADS, 1, 1);
            })
        },
    )
}

fn fill(
    recorder: &mut Recorder,
    shaders: &ShaderLibrary,
    format: vk::Format,
    side: u32,
    blend: Blend,
) -> Result<Vec<f64>, Error> {
    let desc = ImageDesc::new_2d("limits/target", format, side, side).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    let target = Image::new(shaders.device(), desc)?.view()?;
    let pass = Pass::graphics("fill", "", "common/fullscreen.vert", "limits/constant.frag")
        .color(&target, Load::Clear([0.0; 4]), blend)
        .build(shaders)?;
    rate(
        recorder,
        |load| f64::from(side) * f64::from(side) * f64::from(load),
        |frame, load| {
            frame.graphics(&pass, |draw| {
                for _ in 0..load {
                    draw.vertices(3);
                }
            })
        },
    )
}
