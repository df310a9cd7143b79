//! Nearness to the device's limits of passes that do one thing: copies, fills, blends, multiply-adds, vertices, triangles
//! and empty invocations, of other sizes than those that the limits were measured with. Each is to read 90 to 105 %, or the
//! benchmark fails.
//! A pass and the limits behind its floor are measured in turn, round after round; a share is the median of the rounds.

use std::error::Error;
use std::sync::Arc;

use ash::vk;
use fumarole::gpu::{
    self, Blend, Buffer, BufferDesc, Draw, Frame, Image, ImageDesc, ImageView, Load, Mode, Pass, Recorder,
    ShaderLibrary, transfer,
};
use fumarole::host_block;
use fumarole::measure::floor::floor;
use fumarole::measure::limits;
use fumarole::measure::machine::{Machine, MachineOptions};
use fumarole::measure::statistics::median;

host_block! {
    struct MultiplyAdd {
        iterations: u32,
        factor: f32,
    }
}

const ROUNDS: usize = 40;
const FRAMES: usize = 5;
const ITERATIONS: u32 = 3_000;
const TIMES: u32 = 12;

type Record = Box<dyn Fn(&mut Frame<'_>) -> Result<(), gpu::Error>>;

/// A pass that does one thing, and which limits bound it.
struct Pure {
    name: String,
    limits: Vec<String>,
    record: Record,
}

impl Pure {
    fn new(name: &str, limits: &[&str], record: impl Fn(&mut Frame<'_>) -> Result<(), gpu::Error> + 'static) -> Self {
        let limits = limits.iter().map(|&limit| limit.to_owned()).collect();
        Pure { name: name.to_owned(), limits, record: Box::new(record) }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    fumarole::gpu::pin_software_threads();
    let mut machine = Machine::open(&MachineOptions::default(), &[])?;
    println!("{}", machine.description());
    let is_cpu = machine.device.physical().device_type == fumarole::gpu::physical::DeviceType::Cpu;
    let passes = passes(&mut machine.recorder, &machine.shaders)?;
    println!("{:28}{:>16}   each round", "pass", "share of limit");
    let mut outside = Vec::new();
    for Pure { name, limits: wanted, record } in &passes {
        let mut shares = Vec::new();
        // The first round compiles.
        for round in 0..=ROUNDS {
            let limits = limits::measure_some(&mut machine, |limit| wanted.iter().any(|wanted| wanted == limit))?;
            let mut times = Vec::new();
            for _ in 0..FRAMES {
                let sample = machine.recorder.run(Mode::Timestamped, |frame| record(frame))?;
                times.extend(sample.passes.first().and_then(|pass| pass.gpu_ms));
            }
            let sample = machine.recorder.run(Mode::Counted, |frame| record(frame))?;
            let pass = &sample.passes[0];
            let (Some(work), Some(ms)) = (&pass.work, median(&times)) else {
                println!("{name}: this device cannot time it");
                break;
            };
            let found = floor(work, &pass.counts.unwrap_or_default(), pass.info.kind, &limits, is_cpu);
            shares.extend(found.filter(|_| round > 0).map(|floor| floor.ms / ms));
        }
        let rounds: Vec<String> = shares.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
        let share = median(&shares).unwrap_or(f64::NAN);
        println!("{name:28}{:>14.1} %   {}", 100.0 * share, rounds.join(" "));
        outside.extend((!(0.90..=1.05).contains(&share)).then_some(name.as_str()));
    }
    if outside.is_empty() { Ok(()) } else { Err(format!("outside of 90 to 105 %: {}", outside.join(", ")).into()) }
}

fn passes(recorder: &mut Recorder, shaders: &ShaderLibrary) -> Result<Vec<Pure>, Box<dyn Error>> {
    let device = shaders.device();
    let mut passes = Vec::new();
    let bytes = vec![3u8; 96 << 20];
    let from = transfer::upload(device, "source", vk::BufferUsageFlags::empty(), &bytes)?;
    let to = Buffer::new(device, BufferDesc::new("destination", bytes.len() as u64))?;
    let copy = Pass::copy("copy", "", &from, &to);
    passes.push(Pure::new("copy of 96 MiB", &["copy_gb_s", "small_copy_gb_s"], move |frame| frame.copy(&copy)));

    let formats = [
        (vk::Format::R8G8B8A8_UNORM, "rgba8"),
        (vk::Format::R32_SFLOAT, "r32f"),
        (vk::Format::R16G16B16A16_SFLOAT, "rgba16f"),
        (vk::Format::R32G32B32A32_SFLOAT, "rgba32f"),
    ];
    for (format, name) in formats {
        for (blend, what) in [(Blend::Replace, "fill"), (Blend::Add, "blend")] {
            let target = target(shaders, format)?;
            let pass = |load| {
                Pass::graphics("pixels", "", "common/fullscreen.vert", "limits/constant.frag")
                    .color(&target, load, blend)
                    .build(shaders)
            };
            let covered = |draw: &mut Draw<'_>| {
                draw.vertices(3);
            };
            let cleared = pass(Load::Clear([0.0; 4]))?;
            recorder.run(Mode::Plain, |frame| frame.graphics(&cleared, covered))?;
            let pass = pass(if blend == Blend::Replace { Load::Discard } else { Load::Keep })?;
            let record = move |frame: &mut Frame<'_>| (0..TIMES).try_for_each(|_| frame.graphics(&pass, covered));
            let rate = limits::pixel_rate(format, blend == Blend::Add).ok_or("its rate is measured")?;
            passes.push(Pure::new(
                &format!("{what} of {name}"),
                &[&rate, "vertex_gvertices_s", "empty_draw_ms"],
                record,
            ));
        }
    }

    let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
    let threads = 1 << 15;
    let results = Buffer::new(device, BufferDesc::new("results", u64::from(threads) * 16).usage(usage))?;
    let multiply_add = Pass::compute("multiply-add", "", "limits/multiply-add.comp")
        .with("results", &results)
        .whole(&["results"])
        .multiply_adds(|counts| Some(32 * u64::from(ITERATIONS) * counts.compute_invocations?))
        .constants::<MultiplyAdd>()
        .build(shaders)?;
    let record = move |frame: &mut Frame<'_>| {
        frame.compute(&multiply_add, |dispatch| {
            dispatch.constants(&MultiplyAdd { iterations: ITERATIONS, factor: 0.25 }).threads(threads, 1, 1);
        })
    };
    passes.push(Pure::new("multiply-adds", &["fma_gflops", "empty_dispatch_ms"], record));

    let nothing = Buffer::new(device, BufferDesc::new("nothing", 4).usage(usage))?;
    let idle = Pass::compute("idle", "", "limits/idle.comp").with("nothing", &nothing).build(shaders)?;
    let record = move |frame: &mut Frame<'_>| {
        frame.compute(&idle, |dispatch| {
            (0..30).for_each(|_| {
                dispatch.threads(700_000, 1, 1);
            });
        })
    };
    passes.push(Pure::new("empty invocations", &["issue_ginvocations_s", "empty_dispatch_ms"], record));

    let small = target(shaders, vk::Format::R8G8B8A8_UNORM)?;
    let outside = Pass::graphics("vertices", "", "limits/outside.vert", "limits/constant.frag")
        .color(&small, Load::Discard, Blend::Replace)
        .build(shaders)?;
    let record = move |frame: &mut Frame<'_>| {
        frame.graphics(&outside, |draw: &mut Draw<'_>| {
            (0..40).for_each(|_| {
                draw.vertices(600_000);
            });
        })
    };
    passes.push(Pure::new("vertices", &["vertex_gvertices_s", "empty_draw_ms"], record));
    let indices: Vec<u32> = (0..900_000).map(|index| index % 3).collect();
    let usage = vk::BufferUsageFlags::INDEX_BUFFER;
    let indices = transfer::upload(device, "indices", usage, bytemuck::cast_slice(&indices))?;
    let triangles = Pass::graphics("triangles", "", "limits/flat.vert", "limits/constant.frag")
        .indices(&indices)
        .color(&small, Load::Discard, Blend::Replace)
        .build(shaders)?;
    let record = move |frame: &mut Frame<'_>| {
        frame.graphics(&triangles, |draw: &mut Draw<'_>| {
            (0..12).for_each(|_| {
                draw.indices(900_000);
            });
        })
    };
    passes.push(Pure::new("triangles", &["vertex_gvertices_s", "triangle_gtriangles_s", "empty_draw_ms"], record));
    Ok(passes)
}

fn target(shaders: &ShaderLibrary, format: vk::Format) -> Result<Arc<ImageView>, gpu::Error> {
    let desc = ImageDesc::new_2d("target", format, 1200, 900).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    Image::new(shaders.device(), desc)?.view()
}
