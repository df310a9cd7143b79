//! naga: compiles what lies inside its GLSL subset.

use std::error::Error;
use std::panic;

use ::naga::back::spv::{self, BindingMap, PipelineOptions, WriterFlags, ZeroInitializeWorkgroupMemoryMode};
use ::naga::front::glsl::{Frontend, Options};
use ::naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use ::naga::valid::{ValidationFlags, Validator};
use ::naga::{Barrier, Block, Module, ShaderStage, Statement, TypeInner};

use super::{Diagnostic, Stage, explicit_layout};

const CONTINUE: &str = "naga's `continue` skips the condition of a do-while loop; use `if`, `while` or `for`";

/// Text that naga 30.0.1 accepts and translates wrongly, and what to write instead.
const MISCOMPILED: &[(&str, &str)] = &[
    ("gl_WorkGroupSize", "naga writes invalid SPIR-V for gl_WorkGroupSize; use a constant"),
    ("do{", "write `do {`, which is searched for `continue`"),
];

/// The line, from 0, of a do-while loop in which there is a `continue`.
fn continued_do_while(text: &str) -> Option<usize> {
    let has_continue = |start: &usize| {
        let mut depth = 0;
        let mut is_in = |c: char| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth > 0
        };
        let body = &text[start + "do ".len()..];
        let end = body.find(|c| !is_in(c)).unwrap_or(body.len());
        body[..end].contains("continue")
    };
    let mut loops = text.match_indices("do {").map(|(start, _)| start);
    loops.find(has_continue).map(|start| text[..start].matches('\n').count())
}

/// Compiles flattened GLSL 4.50 to SPIR-V 1.4, adding nothing that the source does not say.
pub fn compile(stage: Stage, text: &str) -> Result<Vec<u32>, Diagnostic> {
    let shader_stage = match stage {
        Stage::Vertex => ShaderStage::Vertex,
        Stage::Fragment => ShaderStage::Fragment,
        Stage::Compute => ShaderStage::Compute,
        Stage::Geometry => return Err(Diagnostic::without_line("naga has no geometry stage")),
    };
    // naga panics on some GLSL that it does not know, such as an `inout` argument that is a member.
    panic::catch_unwind(|| translate(shader_stage, text)).unwrap_or_else(|panic| {
        let message = panic.downcast_ref::<String>().map(String::as_str);
        let message = message.or_else(|| panic.downcast_ref::<&str>().copied());
        Err(Diagnostic::without_line(&format!("naga panicked: {}", message.unwrap_or("it gives no message"))))
    })
}

fn translate(shader_stage: ShaderStage, text: &str) -> Result<Vec<u32>, Diagnostic> {
    let mut module = Frontend::default().parse(&Options::from(shader_stage), text).map_err(|errors| {
        match errors.errors.first() {
            Some(error) => {
                Diagnostic { line: error.location(text).map(|at| at.line_number as usize), message: error.to_string() }
            }
            None => Diagnostic::without_line("naga names no reason"),
        }
    })?;
    refuse_miscompiled(&module, text)?;
    let entry_points = module.entry_points.iter_mut().map(|entry_point| &mut entry_point.function);
    for function in module.functions.iter_mut().map(|(_, function)| function).chain(entry_points) {
        widen_barriers(&mut function.body);
    }
    let info =
        Validator::new(ValidationFlags::all(), spv::supported_capabilities()).validate(&module).map_err(|error| {
            Diagnostic {
                line: error.location(text).map(|at| at.line_number as usize),
                message: describe_chain(error.as_inner()),
            }
        })?;
    let pipeline = PipelineOptions { shader_stage, entry_point: "main".to_owned() };
    let words = spv::write_vec(&module, &info, &writer_options(), Some(&pipeline))
        .map_err(|error| Diagnostic::without_line(&describe_chain(&error)))?;
    explicit_layout::strip(&words).map_err(|problem| Diagnostic::without_line(&problem))
}

/// Refuses what naga accepts and translates wrongly.
fn refuse_miscompiled(module: &Module, text: &str) -> Result<(), Diagnostic> {
    for (pattern, message) in MISCOMPILED {
        if let Some(index) = text.lines().position(|line| line.contains(pattern)) {
            return Err(Diagnostic { line: Some(index + 1), message: (*message).to_owned() });
        }
    }
    if let Some(index) = continued_do_while(text) {
        return Err(Diagnostic { line: Some(index + 1), message: CONTINUE.to_owned() });
    }
    let is_array = |inner: &TypeInner| matches!(inner, TypeInner::Array { .. });
    let nested = module.types.iter().find(|(_, ty)| match ty.inner {
        TypeInner::Array { base, .. } => is_array(&module.types[base].inner),
        _ => false,
    });
    if let Some((handle, _)) = nested {
        let span = module.types.get_span(handle);
        return Err(Diagnostic {
            line: span.is_defined().then(|| span.location(text).line_number as usize),
            message: "naga swaps the dimensions of nested arrays; use one dimension".to_owned(),
        });
    }
    Ok(())
}

/// Makes GLSL's `barrier()` hold a whole workgroup. naga 30.0.1 reads it as every kind of barrier at once, subgroups' among
/// them, and so writes one that holds a subgroup only: invocations of other subgroups read shared memory too early.
fn widen_barriers(block: &mut Block) {
    for statement in block.iter_mut() {
        match statement {
            Statement::ControlBarrier(barrier) => *barrier = Barrier::WORK_GROUP,
            Statement::Block(inner) => widen_barriers(inner),
            Statement::If { accept, reject, .. } => {
                widen_barriers(accept);
                widen_barriers(reject);
            }
            Statement::Switch { cases, .. } => cases.iter_mut().for_each(|case| widen_barriers(&mut case.body)),
            Statement::Loop { body, continuing, .. } => {
                widen_barriers(body);
                widen_barriers(continuing);
            }
            _ => {}
        }
    }
}

/// Every option spelt out: naga's defaults flip Y, clamp depth, bound loops, zero workgroup memory and
/// guard divisions, which glslang does not, so that a comparison of the two would compare these.
fn writer_options() -> spv::Options<'static> {
    spv::Options {
        // The first with `OpCopyLogical`, and the last of which layers do not forbid layouts outside of buffers.
        lang_version: (1, 4),
        flags: WriterFlags::DEBUG,
        // With an empty map this means: keep the sets and bindings of the source.
        fake_missing_bindings: true,
        binding_map: BindingMap::default(),
        capabilities: None,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Unchecked,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: ZeroInitializeWorkgroupMemoryMode::None,
        force_loop_bounding: false,
        ray_query_initialization_tracking: false,
        trace_ray_argument_validation: false,
        use_storage_input_output_16: false,
        debug_info: None,
        task_dispatch_limits: None,
        mesh_shader_primitive_indices_clamp: false,
        emit_int_div_checks: false,
    }
}

fn describe_chain(error: &dyn Error) -> String {
    let mut message = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        message.push_str(": ");
        message.push_str(&cause.to_string());
        source = cause.source();
    }
    message
}
