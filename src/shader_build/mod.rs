//! GLSL 4.50 to SPIR-V, 1.5 by glslang and 1.4 by naga: includes, line numbers, reflection.
//!
//! The build script compiles every shader with [`compile_dir`] and embeds the binaries as [`EMBEDDED`];
//! `--shader-dir` calls the same function at run time, and takes the binaries of the texts that it finds unchanged. Layouts are built from the [`Interface`] of
//! glslang's binary; naga's has passed [`check_same_interface`] and fits them too.
//!
//! # Files
//!
//! Below the shader folder, `.vert`, `.geom`, `.frag` and `.comp` files are shaders, named by their path
//! (`caustics/position-map.frag`); their first line is `#version 450`. `#include "common/refraction.glsl"`
//! takes a path from the shader folder, wherever it stands; each file is pasted once, at its first include.
//!
//! One file makes several shaders where a line of it lists variants. `terrain/depth.comp` with
//!
//! ```glsl
//! #pragma variants BASE=plane,curved LOD=pixel,exact
//! #include "terrain/base-{BASE}.glsl"
//! ```
//!
//! makes four, each named by its values: `terrain/depth-plane-pixel.comp` and so on. No shader is named
//! `terrain/depth.comp` then. An include of the file, or of what it includes, puts the value for a name in
//! braces; code asks `#ifdef BASE_PLANE`, as the pragma's line becomes `#define BASE_PLANE 1` and so on.
//! Everything that goes by a shader's name, passes, records, [`NAGA_EXCEPTIONS`] and `--shader-dir`, knows the
//! variants alone; an error names the file and the line that were written.
//!
//! A folder may be anybody's, so files, texts after includes and variants have bounds, several times what our own shaders
//! need. How much a compiler takes for a text within them is the compiler's: the command line has it tried in a process with limits.
//!
//! # The GLSL that both compilers accept
//!
//! Tried with glslang 0.9.1 and naga 30.0.1; the binaries of both were run and compared.
//!
//! - Resources: `texture2D` and `sampler` apart, joined where they are used: `texture(sampler2D(t, s), uv)`
//!   (a `texelFetch` needs no sampler with `#extension GL_EXT_samplerless_texture_functions : require`).
//!   A texture and a sampler may be function parameters, a `sampler2D` may not. No arrays of descriptors.
//! - Images carry a format (`layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D`); buffers are
//!   `readonly` or plain, never `writeonly` or `coherent`.
//! - A block that ends in a run-time array and has other members goes without an instance name.
//! - Push constants say `layout(push_constant, std430)`, or naga lays out arrays and `mat2` as std140 does;
//!   no member offsets. No `mat2` and no structure of less than 16 bytes in a uniform block.
//! - Arrays have one dimension (naga swaps the dimensions of nested ones).
//! - Varyings are scalars, vectors or arrays of them: no matrices, blocks or `component`.
//!   `gl_PerVertex` and `gl_FragCoord` are not redeclared.
//! - An `inout` or `out` argument is a whole variable or a swizzle: no member, component or element.
//! - The right side of `&&` and `||` is always evaluated by naga: neither side effects nor guarded
//!   accesses there. `?:`, `if` and `switch` evaluate what they take.
//! - `for` and `while`, not `do`. A vector takes `%` with a vector only (`u % uvec2(3u)`).
//! - Unknown to naga: atomics, subgroups, `.length()` of a run-time array, every `memoryBarrier*` (use
//!   `barrier()`), `textureGather`, `frexp`, `modf`, `umulExtended`, `matrixCompMult`, `interpolateAt*`,
//!   `precise`, `double`, `constant_id`, `gl_WorkGroupSize`, `gl_ClipDistance`, `gl_Layer`.
//!   `outerProduct` is valid for square matrices only.
//!
//! A shader that needs more stands in [`NAGA_EXCEPTIONS`] with its reason and runs with glslang alone.

mod agreement;
#[cfg(embedded_shaders)]
mod embedded;
mod error;
mod exceptions;
mod explicit_layout;
mod glslang;
mod include;
mod interface;
mod layout;
mod naga;
mod reflection;
mod spirv;
#[cfg(test)]
mod tests;
mod variants;

use std::fmt;
use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};

use include::Files;
use variants::Definition;

pub use agreement::check_same_interface;
#[cfg(embedded_shaders)]
pub use embedded::{EMBEDDED, embedded_interface};
pub use error::{DirectiveProblem, Error, InterfaceMismatch, ReflectError};
pub use exceptions::{NAGA_EXCEPTIONS, check_exceptions};
pub use include::Source;
pub use interface::{
    Binding, BindingKind, Block, Format, ImageFormat, ImageShape, Interface, Location, Member, Sampling, Scalar,
};
pub use layout::{HostBlock, LayoutMismatch};
pub use spirv::{capabilities, extensions, instruction_count};

/// The stage of a shader, told by the ending of its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    Vertex,
    Geometry,
    Fragment,
    Compute,
}

impl Stage {
    /// The stage of `.vert`, `.geom`, `.frag` and `.comp` files; none for any other ending.
    pub fn from_file_name(name: &str) -> Option<Stage> {
        match name.rsplit_once('.')?.1 {
            "vert" => Some(Stage::Vertex),
            "geom" => Some(Stage::Geometry),
            "frag" => Some(Stage::Fragment),
            "comp" => Some(Stage::Compute),
            _ => None,
        }
    }
}

/// The two compilers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Compiler {
    /// The reference compiler: it has every shader and is the default of every pass.
    #[default]
    Glslang,
    /// Wherever it has a binary; glslang elsewhere.
    Naga,
}

impl fmt::Display for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Compiler::Glslang => "glslang",
            Compiler::Naga => "naga",
        })
    }
}

/// A shader compiled by the build script.
#[derive(Clone, Copy, Debug)]
pub struct EmbeddedShader {
    /// Path below the shader folder, with `/`: `caustics/position-map.frag`; of a variant with its values.
    pub name: &'static str,
    /// Stage by the file's extension.
    pub stage: Stage,
    /// SHA-256 of the text that the compilers saw.
    pub text_sha256: [u8; 32],
    /// SPIR-V words of glslang.
    pub glslang: &'static [u32],
    /// SPIR-V words of naga, or why there are none.
    pub naga: Result<&'static [u32], &'static str>,
}

/// A shader compiled from its file.
#[derive(Clone, Debug)]
pub struct CompiledShader {
    /// Path below the shader folder, with `/`: `caustics/position-map.frag`; of a variant with its values.
    pub name: String,
    /// Stage by the file's extension.
    pub stage: Stage,
    /// SHA-256 of the text that the compilers saw.
    pub text_sha256: [u8; 32],
    /// SPIR-V words of glslang.
    pub glslang: Vec<u32>,
    /// SPIR-V words of naga, or why there are none.
    pub naga: Result<Vec<u32>, String>,
}

impl From<&EmbeddedShader> for CompiledShader {
    fn from(embedded: &EmbeddedShader) -> CompiledShader {
        CompiledShader {
            name: embedded.name.to_owned(),
            stage: embedded.stage,
            text_sha256: embedded.text_sha256,
            glslang: embedded.glslang.to_vec(),
            naga: embedded.naga.map(<[u32]>::to_vec).map_err(str::to_owned),
        }
    }
}

/// A compiler's message about a source, with the line in the text that it saw.
struct Diagnostic {
    line: Option<usize>,
    message: String,
}

impl Diagnostic {
    fn without_line(message: &str) -> Diagnostic {
        Diagnostic { line: None, message: message.to_owned() }
    }

    fn into_error(self, shader: &str, compiler: Compiler, source: &Source) -> Error {
        let origin = self.line.and_then(|line| source.origin(line));
        Error::Compile {
            shader: shader.to_owned(),
            compiler,
            path: origin.map_or(source.path(), |(path, _)| path).to_owned(),
            line: origin.map(|(_, line)| line),
            message: self.message.split_whitespace().collect::<Vec<_>>().join(" "),
        }
    }
}

/// Compiles every shader below `root`, sorted by name. Files with other endings are left alone. A shader whose text is that of
/// one of its name in `known`, sorted by name and made by the same compilers, is taken from there: compiling all takes seconds.
///
/// # Errors
/// The first file that cannot be read, link to a folder, include that cannot be resolved, list of variants that is
/// misspelt, name that two files make, bound that is broken and shader that glslang refuses.
/// A shader that naga refuses, or gives another interface, is no error here but the reason in
/// [`CompiledShader::naga`], which [`check_exceptions`] judges.
pub fn compile_dir(root: &Path, known: &[EmbeddedShader]) -> Result<Vec<CompiledShader>, Error> {
    compile_dir_with(root, &|name, sha256| find(known, name, sha256), &mut |_, _| ())
}

/// The shader of that name and text among `known`, which are sorted by name.
pub fn find(known: &[EmbeddedShader], name: &str, text_sha256: &[u8; 32]) -> Option<CompiledShader> {
    let at = known.binary_search_by(|known| known.name.cmp(name)).ok()?;
    (known[at].text_sha256 == *text_sha256).then(|| CompiledShader::from(&known[at]))
}

/// The same, with what is `known` of a name and the SHA-256 of a text, and calls `begin` with a shader's name and the bytes of its
/// text before it goes to the compilers.
///
/// # Errors
/// As [`compile_dir`].
pub fn compile_dir_with(
    root: &Path,
    known: &dyn Fn(&str, &[u8; 32]) -> Option<CompiledShader>,
    begin: &mut dyn FnMut(&str, usize),
) -> Result<Vec<CompiledShader>, Error> {
    let mut listed = Vec::new();
    list_files(root, "", 0, &mut listed)?;
    let files = Files::of(root);
    let too_many = |of, limit| Err(Error::TooMany { path: root.to_owned(), of, limit });
    let mut shaders = Vec::new();
    let mut limit = SPARE_BYTES;
    for (file, stage) in &listed {
        let (variants, bytes) = Source::list_variants(&files, file)?;
        limit += TIMES_FILES * bytes as u64;
        if shaders.len() + variants.len() > MOST_SHADERS {
            return too_many("shaders, variants among them", MOST_SHADERS);
        }
        let named = |variant: Vec<Definition>| (variants::shader_name(file, &variant), file, *stage, variant);
        shaders.extend(variants.into_iter().map(named));
    }
    shaders.sort_by(|a, b| a.0.cmp(&b.0));
    if let Some(twice) = shaders.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let files = [twice[0].1.clone(), twice[1].1.clone()];
        return Err(Error::MadeTwice { shader: twice[0].0.clone(), files });
    }
    let read = |(_, file, _, variant): &(_, &String, _, Vec<Definition>)| Source::read(&files, file, variant.clone());
    // Before the first is compiled, which takes longer; one text at a time, or many large ones would be in memory.
    let mut bytes = 0;
    for shader in &shaders {
        bytes += read(shader)?.text.len() as u64;
        if bytes > limit {
            return Err(Error::TooMuch { path: root.to_owned(), bytes, limit });
        }
    }
    shaders.iter().map(|shader| compile(&shader.0, shader.2, &read(shader)?, known, begin)).collect()
}

/// Of a folder with its variants; our own are 505.
const MOST_SHADERS: usize = 4096;
/// Of a folder, those of other endings and folders among them; our own has 540.
const MOST_ENTRIES: usize = 8192;
/// Folders in each other.
const MOST_FOLDERS: usize = 16;
/// Bytes of all shaders after their includes, and as many times the bytes of their own files. Our own have 9 MB of 0.6.
const SPARE_BYTES: u64 = 4 << 20;
const TIMES_FILES: u64 = 32;

fn list_files(folder: &Path, prefix: &str, depth: usize, files: &mut Vec<(String, Stage)>) -> Result<(), Error> {
    let read_error = |source| Error::Read { path: folder.to_owned(), source };
    let too_many = |of, limit| Err(Error::TooMany { path: folder.to_owned(), of, limit });
    if depth > MOST_FOLDERS {
        return too_many("folders in each other", MOST_FOLDERS);
    }
    for (count, entry) in fs::read_dir(folder).map_err(read_error)?.enumerate() {
        if count >= MOST_ENTRIES {
            return too_many("files", MOST_ENTRIES);
        }
        if files.len() > MOST_SHADERS {
            return too_many("shaders", MOST_SHADERS);
        }
        let entry = entry.map_err(read_error)?;
        let file_name = entry.file_name();
        let name = format!("{prefix}{}", file_name.to_string_lossy());
        let kind = entry.file_type().map_err(read_error)?;
        if kind.is_dir() {
            list_files(&entry.path(), &format!("{name}/"), depth + 1, files)?;
        } else if kind.is_symlink() && entry.path().is_dir() {
            // It may lead out of the folder or around in it; to leave it out would ignore edits in silence.
            return Err(Error::LinkedFolder { path: entry.path() });
        } else if let Some(stage) = Stage::from_file_name(&name) {
            files.push((name, stage));
        }
    }
    Ok(())
}

fn compile(
    name: &str,
    stage: Stage,
    source: &Source,
    known: &dyn Fn(&str, &[u8; 32]) -> Option<CompiledShader>,
    begin: &mut dyn FnMut(&str, usize),
) -> Result<CompiledShader, Error> {
    let text_sha256 = Sha256::digest(&source.text).into();
    if let Some(known) = known(name, &text_sha256) {
        return Ok(known);
    }
    begin(name, source.text.len());
    let glslang = glslang::compile(stage, &source.text)
        .map_err(|diagnostic| diagnostic.into_error(name, Compiler::Glslang, source))?;
    let interface =
        Interface::reflect(&glslang).map_err(|source| Error::Reflect { shader: name.to_owned(), source })?;
    let naga = naga::compile(stage, &source.text)
        .map_err(|diagnostic| diagnostic.into_error(name, Compiler::Naga, source).to_string())
        .and_then(|words| check_fit(&interface, &words).map(|()| words));
    let listed = NAGA_EXCEPTIONS.iter().find(|(exception, _)| *exception == name);
    Ok(CompiledShader {
        name: name.to_owned(),
        stage,
        text_sha256,
        glslang,
        naga: naga.map_err(|reason| listed.map_or(reason, |(_, listed)| (*listed).to_owned())),
    })
}

/// Compiles an empty shader of each stage: glslang makes its tables of names at the first of each, in 0.1 s and some 20 MiB.
pub fn warm_up() {
    for stage in [Stage::Vertex, Stage::Geometry, Stage::Fragment, Stage::Compute] {
        // What it says of a shader without outputs matters to nobody.
        let _ = glslang::compile(stage, "#version 450\nvoid main() {}\n");
    }
}

/// Why naga's binary cannot stand in for the one that `interface` was read from, if so.
fn check_fit(interface: &Interface, naga: &[u32]) -> Result<(), String> {
    let naga = Interface::reflect(naga).map_err(|error| error.to_string())?;
    check_same_interface(interface, &naga).map_err(|error| error.to_string())
}
