//! glslang: compiles every shader.

use ::glslang::error::{GlslangError, GlslangErrorLog};
use ::glslang::{
    Compiler as Glslang, CompilerOptions, GlslProfile, ShaderInput, ShaderMessage, ShaderSource, ShaderStage,
    SourceLanguage, SpirvVersion, Target, VulkanVersion,
};

use super::{Diagnostic, Stage};

/// Compiles flattened GLSL 4.50 to SPIR-V 1.5, unoptimised, with its names.
pub fn compile(stage: Stage, text: &str) -> Result<Vec<u32>, Diagnostic> {
    let compiler = Glslang::acquire().ok_or_else(|| Diagnostic::without_line("glslang could not be initialised"))?;
    let options = CompilerOptions {
        source_language: SourceLanguage::GLSL,
        // Not Vulkan 1.3: its `LocalSizeId` would need the device feature `maintenance4`.
        target: Target::Vulkan { version: VulkanVersion::Vulkan1_2, spirv_version: SpirvVersion::SPIRV1_5 },
        version_profile: Some((450, GlslProfile::Core)),
        messages: ShaderMessage::SPV_RULES | ShaderMessage::VULKAN_RULES,
    };
    let source = ShaderSource::from(text);
    let defines: Option<&[(&str, Option<&str>)]> = None;
    ShaderInput::new(&source, shader_stage(stage), &options, defines, None)
        .and_then(|input| compiler.create_shader(input))
        .and_then(|shader| shader.compile())
        .map_err(|error| diagnose(&error))
}

fn shader_stage(stage: Stage) -> ShaderStage {
    match stage {
        Stage::Vertex => ShaderStage::Vertex,
        Stage::Geometry => ShaderStage::Geometry,
        Stage::Fragment => ShaderStage::Fragment,
        Stage::Compute => ShaderStage::Compute,
    }
}

fn diagnose(error: &GlslangError) -> Diagnostic {
    match error {
        GlslangError::PreprocessError(log)
        | GlslangError::ParseError(log)
        | GlslangError::MapIoError(log)
        | GlslangError::LinkError(log) => first_error(log),
        other => Diagnostic::without_line(&other.to_string()),
    }
}

/// The first error of a log of lines such as `ERROR: 0:12: 'x' : undeclared identifier`.
fn first_error(GlslangErrorLog { log, .. }: &GlslangErrorLog) -> Diagnostic {
    let Some(error) = log.lines().find_map(|line| line.strip_prefix("ERROR: ")) else {
        return Diagnostic::without_line(log);
    };
    let located = error.strip_prefix("0:").and_then(|rest| {
        let (line, message) = rest.split_once(": ")?;
        Some((line.parse().ok()?, message))
    });
    match located {
        Some((line, message)) => Diagnostic { line: Some(line), message: message.trim().to_owned() },
        None => Diagnostic::without_line(error),
    }
}
