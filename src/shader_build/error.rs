use std::path::PathBuf;

use super::Compiler;

/// Why a shader could not be read, compiled, reflected or accepted. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("reading {}: {source}; name a shader folder whose files can be read", path.display())]
    Read {
        /// File or folder that was to be read.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    #[error("reading shader {}: the first line must be `#version 450`", path.display())]
    Version {
        /// File of the shader.
        path: PathBuf,
    },
    #[error("{}:{line}: {problem}", path.display())]
    Directive {
        /// File with the line.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The fault in the line.
        problem: DirectiveProblem,
    },
    #[error(
        "{}{}: {compiler} refuses the shader `{shader}`: {message}",
        path.display(),
        line.map(|line| format!(":{line}")).unwrap_or_default()
    )]
    Compile {
        /// Name of the shader: its path under the shader folder, with the values of its variants.
        shader: String,
        /// Compiler that refuses it.
        compiler: Compiler,
        /// File that the message is about, which may be an included one.
        path: PathBuf,
        /// Line in `path`, from 1; absent when the compiler names none (a missing `main`).
        line: Option<usize>,
        /// The compiler's message on one line.
        message: String,
    },
    #[error(
        "shader `{shader}` must build with naga too, but: {reason}; rewrite it or give the reason in NAGA_EXCEPTIONS"
    )]
    NagaRefused {
        /// Name of the shader.
        shader: String,
        /// naga's message, or the construct outside its subset.
        reason: String,
    },
    #[error("`{}` and `{}` both make the shader `{shader}`; rename one", files[0], files[1])]
    MadeTwice {
        /// Name that both make.
        shader: String,
        /// Their paths under the shader folder.
        files: [String; 2],
    },
    #[error(
        "reading the shader folder {}: its shaders have {bytes} bytes or more after their includes, beyond the limit \
         of {limit} for files of that size; take out variants",
        path.display()
    )]
    TooMuch {
        /// Folder of the shaders.
        path: PathBuf,
        /// Bytes up to the shader that is too much.
        bytes: u64,
        /// Most bytes.
        limit: u64,
    },
    #[error("reading the shader folder {}: it has more than {limit} {of}; take some out", path.display())]
    TooMany {
        /// Folder of the shaders.
        path: PathBuf,
        /// Things of which there are too many.
        of: &'static str,
        /// Most of them.
        limit: usize,
    },
    #[error("reading shaders: {} is a link to a folder, not followed; put the folder itself there", path.display())]
    LinkedFolder {
        /// The link.
        path: PathBuf,
    },
    #[error("NAGA_EXCEPTIONS lists `{shader}`, {problem}; remove the entry")]
    StaleException {
        /// Name of the shader in the table.
        shader: String,
        /// Reason why it does not belong there, as a clause.
        problem: &'static str,
    },
    #[error("shader `{shader}`: {source}")]
    Reflect {
        /// Name of the shader.
        shader: String,
        /// The fault in its binary's interface.
        source: ReflectError,
    },
}

/// A fault in a preprocessor line that the includes depend on, or a bound that a line is the first to break.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum DirectiveProblem {
    #[error("expected `#include \"path/from/the/shader/folder.glsl\"`")]
    IncludeSyntax,
    #[error("no included file `{0}`; paths start at the shader folder and may not be absolute or use `..`")]
    IncludeMissing(String),
    #[error("include cycle: {0}; move what both need into a third file")]
    IncludeCycle(String),
    #[error("more than 64 files include each other; include what they need at one place")]
    IncludeDepth,
    #[error("the shader includes more than 511 files; put some of them together")]
    IncludeCount,
    #[error("`#include` inside `#if`; move it out, a file is included once whatever the condition")]
    IncludeConditional,
    #[error(
        "expected `#pragma variants NAME=value,value NAME=value,value`: names in capitals, values in small letters and digits, \
         none twice, at most 16 names, 64 letters in each and 256 combinations"
    )]
    VariantsSyntax,
    #[error("`#pragma variants` stands once, in the shader's own file and outside `#if`; move it there")]
    VariantsPlace,
    #[error("`#line` is not supported; remove it, lines are mapped to their files already")]
    Line,
    #[error("the shader has more than 524288 bytes after its includes; make it shorter")]
    TextLength,
}

/// A binary whose interface cannot be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("reflecting the SPIR-V binary: {0}")]
pub struct ReflectError(pub String);

/// Place at which naga's binary would not fit the layouts built from glslang's.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("glslang and naga disagree on {what}: {glslang} against {naga}")]
pub struct InterfaceMismatch {
    /// The binding, member or location in question.
    pub what: String,
    /// Its form in glslang's binary.
    pub glslang: String,
    /// Its form in naga's binary.
    pub naga: String,
}
