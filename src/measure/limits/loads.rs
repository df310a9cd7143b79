//! The loads behind the limits.

use std::sync::Arc;

use ash::vk;

use super::Workload;
use crate::gpu::{
    Blend, Buffer, BufferDesc, Draw, Error, Image, ImageDesc, ImageView, Load, Mode, Pass, Recorder, ShaderLibrary,
    transfer,
};
use crate::host_block;

/// Threads of the multiply-adds, each with eight chains of four components, a multiplication and an addition each.
const THREADS: u32 = 1 << 14;
const FLOPS_PER_ITERATION: f64 = 64.0;
const ITERATIONS: u32 = 64;
/// A side of the target of fill and blend rates: a few megabytes, as a picture has, and no power of two, whose rows share
/// their places in caches.
const SIDE: u32 = 1008;
/// Invocations of a dispatch, vertices and triangles of a draw: so many that what a call costs is nothing beside them.
const INVOCATIONS: u32 = 1 << 20;
const VERTICES: u32 = 3 << 17;
const TRIANGLES: u32 = 1 << 17;

host_block! {
    struct MultiplyAdd {
        iterations: u32,
        factor: f32,
    }
}

/// Bytes read and written by copies of a buffer of `bytes`, in 10^9 a second.
pub fn copy(shaders: &ShaderLibrary, bytes: u64) -> Result<Workload, Error> {
    let device = shaders.device();
    // Uploaded, not only allocated: a driver may map untouched pages to one of zeros.
    let contents = vec![1u8; bytes as usize];
    let from = transfer::upload(device, "limits/copy-source", vk::BufferUsageFlags::empty(), &contents)?;
    let to = Buffer::new(device, BufferDesc::new("limits/copy-destination", bytes))?;
    let pass = Pass::copy("copy", "", &from, &to);
    Ok(Workload::new(2.0 * bytes as f64, move |frame, load| (0..load).try_for_each(|_| frame.copy(&pass))))
}

/// Operations of multiply-adds in 10^9 a second, two each.
pub fn multiply_add(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let desc = BufferDesc::new("limits/results", u64::from(THREADS) * 16).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    let results = Buffer::new(shaders.device(), desc)?;
    let pass = Pass::compute("multiply-add", "", "limits/multiply-add.comp")
        .with("results", &results)
        .constants::<MultiplyAdd>()
        .build(shaders)?;
    let operations = f64::from(THREADS) * f64::from(ITERATIONS) * FLOPS_PER_ITERATION;
    Ok(Workload::new(operations, move |frame, load| {
        frame.compute(&pass, |dispatch| {
            let constants = MultiplyAdd { iterations: ITERATIONS * load, factor: 0.5 };
            dispatch.constants(&constants).threads(THREADS, 1, 1);
        })
    }))
}

/// Invocations of a kernel that does nothing, in 10^9 a second.
pub fn issue(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let pass = idle(shaders)?;
    Ok(Workload::new(f64::from(INVOCATIONS), move |frame, load| {
        frame.compute(&pass, |dispatch| {
            (0..load).for_each(|_| {
                dispatch.threads(INVOCATIONS, 1, 1);
            });
        })
    }))
}

/// Milliseconds of a pass with one dispatch of one workgroup that does nothing.
pub fn empty_dispatch(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let pass = idle(shaders)?;
    Ok(Workload::time(move |frame, load| {
        (0..load).try_for_each(|_| frame.compute(&pass, |dispatch| dispatch.threads(1, 1, 1)))
    }))
}

fn idle(shaders: &ShaderLibrary) -> Result<Pass, Error> {
    let desc = BufferDesc::new("limits/nothing", 4).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
    let nothing = Buffer::new(shaders.device(), desc)?;
    Pass::compute("idle", "", "limits/idle.comp").with("nothing", &nothing).build(shaders)
}

/// Vertices of triangles outside the picture, none of them shared, in 10^9 a second. Points would be slower: a driver that
/// shades vertices one after the other has a way of its own for them.
pub fn vertices(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let target = target(shaders, vk::Format::R8G8B8A8_UNORM, 64)?;
    let pass = Pass::graphics("vertices", "", "limits/outside.vert", "limits/constant.frag")
        .color(&target, Load::Clear([0.0; 4]), Blend::Replace)
        .build(shaders)?;
    Ok(Workload::new(f64::from(VERTICES), move |frame, load| {
        frame.graphics(&pass, |draw| {
            for _ in 0..load {
                draw.vertices(VERTICES);
            }
        })
    }))
}

/// Triangles without area, of three vertices that are shaded once, in 10^9 a second.
pub fn triangles(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let target = target(shaders, vk::Format::R8G8B8A8_UNORM, 64)?;
    let indices: Vec<u32> = (0..3 * TRIANGLES).map(|index| index % 3).collect();
    let usage = vk::BufferUsageFlags::INDEX_BUFFER;
    let indices = transfer::upload(shaders.device(), "limits/indices", usage, bytemuck::cast_slice(&indices))?;
    let pass = Pass::graphics("triangles", "", "limits/flat.vert", "limits/constant.frag")
        .indices(&indices)
        .color(&target, Load::Clear([0.0; 4]), Blend::Replace)
        .build(shaders)?;
    Ok(Workload::new(f64::from(TRIANGLES), move |frame, load| {
        frame.graphics(&pass, |draw| {
            for _ in 0..load {
                draw.indices(3 * TRIANGLES);
            }
        })
    }))
}

/// Milliseconds of a pass with one draw that covers nothing.
pub fn empty_draw(shaders: &ShaderLibrary) -> Result<Workload, Error> {
    let target = target(shaders, vk::Format::R8G8B8A8_UNORM, 64)?;
    let pass = Pass::graphics("empty", "", "limits/flat.vert", "limits/constant.frag")
        .color(&target, Load::Discard, Blend::Replace)
        .build(shaders)?;
    Ok(Workload::time(move |frame, load| (0..load).try_for_each(|_| frame.graphics(&pass, |draw| draw.vertices(3)))))
}

/// Pixels of a constant colour, in 10^9 a second. Each fill is a render pass of its own: of opaque ones in the same, a
/// driver may draw the last alone.
pub fn fill(
    recorder: &mut Recorder,
    shaders: &ShaderLibrary,
    format: vk::Format,
    blend: Blend,
) -> Result<Workload, Error> {
    let target = target(shaders, format, SIDE)?;
    let pass = |load| {
        Pass::graphics("fill", "", "common/fullscreen.vert", "limits/constant.frag")
            .color(&target, load, blend)
            .build(shaders)
    };
    let covered = |draw: &mut Draw<'_>| {
        draw.vertices(3);
    };
    // Blending reads what is there, and what a clear takes is not the blend's.
    let cleared = pass(Load::Clear([0.0; 4]))?;
    recorder.run(Mode::Plain, |frame| frame.graphics(&cleared, covered))?;
    let measured = if blend == Blend::Replace { pass(Load::Discard)? } else { pass(Load::Keep)? };
    Ok(Workload::new(f64::from(SIDE) * f64::from(SIDE), move |frame, load| {
        (0..load).try_for_each(|_| frame.graphics(&measured, covered))
    }))
}

fn target(shaders: &ShaderLibrary, format: vk::Format, side: u32) -> Result<Arc<ImageView>, Error> {
    let desc = ImageDesc::new_2d("limits/target", format, side, side).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    Image::new(shaders.device(), desc)?.view()
}
