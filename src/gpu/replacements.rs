//! Shaders of a folder in the place of built-in ones, and what one process compiled of them for another.

use std::io::{self, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use bytemuck::{cast_slice, cast_slice_mut};
use serde::{Deserialize, Serialize};

use super::error::Error;
use crate::shader_build::{self, CompiledShader, EMBEDDED, EmbeddedShader, Stage};

/// Shaders of a folder, compiled.
pub struct Replacements {
    /// All of the folder, sorted by name.
    pub(super) shaders: Vec<CompiledShader>,
    /// Path of the folder; empty without one.
    pub(super) folder: String,
}

impl Replacements {
    /// Compiles the folder, if one is given; it needs no device.
    ///
    /// # Errors
    /// As [`ShaderLibrary::new`](super::ShaderLibrary::new).
    pub fn read(folder: Option<&Path>) -> Result<Self, Error> {
        Replacements::read_with(folder, &mut |_, _| ())
    }

    /// The same, and calls `begin` with a shader's name and the bytes of its text before it goes to the compilers.
    ///
    /// # Errors
    /// As [`ShaderLibrary::new`](super::ShaderLibrary::new).
    pub fn read_with(folder: Option<&Path>, begin: &mut dyn FnMut(&str, usize)) -> Result<Self, Error> {
        let Some(dir) = folder else { return Ok(Replacements { shaders: Vec::new(), folder: String::new() }) };
        let folder = dir.display().to_string();
        match replace(dir, begin) {
            Ok(shaders) => Ok(Replacements { shaders, folder }),
            Err(problem) => Err(Error::Shader { name: folder, problem }),
        }
    }

    /// Writes those that are not built in for a process that [takes](take_compiled) them.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn hand_over(&self, mut to: impl Write) -> io::Result<()> {
        for shader in self.shaders.iter().filter(|s| shader_build::find(EMBEDDED, &s.name, &s.text_sha256).is_none()) {
            let naga = shader.naga.as_ref().map(Vec::len).map_err(Clone::clone);
            let head = Head {
                name: shader.name.clone(),
                text_sha256: shader.text_sha256,
                glslang_words: shader.glslang.len(),
                naga_words: naga,
            };
            serde_json::to_writer(&mut to, &head)?;
            to.write_all(b"\n")?;
            to.write_all(cast_slice(&shader.glslang))?;
            to.write_all(cast_slice(shader.naga.as_deref().unwrap_or_default()))?;
        }
        to.flush()
    }
}

/// A shader's line before its words.
#[derive(Serialize, Deserialize)]
struct Head {
    name: String,
    text_sha256: [u8; 32],
    glslang_words: usize,
    naga_words: Result<usize, String>,
}

/// Shaders that another process of this program compiled as last.
static COMPILED: Mutex<Vec<CompiledShader>> = Mutex::new(Vec::new());

/// Takes what another process of this program [handed over](Replacements::hand_over), in place of what was taken before: where a folder
/// has a shader of that name and text, it is not compiled again. What is cut off is left out.
pub fn take_compiled(from: &[u8]) {
    let mut shaders = Vec::new();
    let mut rest = from;
    while let Some((shader, after)) = next(rest) {
        shaders.push(shader);
        rest = after;
    }
    *COMPILED.lock().unwrap_or_else(PoisonError::into_inner) = shaders;
}

fn next(from: &[u8]) -> Option<(CompiledShader, &[u8])> {
    let line = from.split_inclusive(|&byte| byte == b'\n').next()?;
    let head: Head = serde_json::from_slice(line).ok()?;
    let mut rest = &from[line.len()..];
    let mut words = |count: usize| {
        let bytes = rest.get(..count.checked_mul(4)?)?;
        rest = &rest[bytes.len()..];
        let mut words = vec![0; count];
        cast_slice_mut(&mut words).copy_from_slice(bytes);
        Some(words)
    };
    let glslang = words(head.glslang_words)?;
    let naga = match head.naga_words {
        Ok(count) => Ok(words(count)?),
        Err(reason) => Err(reason),
    };
    let stage = Stage::from_file_name(&head.name)?;
    Some((CompiledShader { name: head.name, stage, text_sha256: head.text_sha256, glslang, naga }, rest))
}

/// Compiles a directory, of which at least one shader has a built-in one's name: else it would change nothing, in silence.
fn replace(dir: &Path, begin: &mut dyn FnMut(&str, usize)) -> Result<Vec<CompiledShader>, String> {
    let shaders = compile(dir, begin)?;
    if shaders.iter().any(|s| EMBEDDED.iter().any(|built_in| built_in.name == s.name)) {
        Ok(shaders)
    } else {
        Err(format!("none of its {} shaders replaces a built-in one; lay it out as shaders/", shaders.len()))
    }
}

fn compile(dir: &Path, begin: &mut dyn FnMut(&str, usize)) -> Result<Vec<CompiledShader>, String> {
    let compiled = COMPILED.lock().unwrap_or_else(PoisonError::into_inner);
    let known = |name: &str, text_sha256: &[u8; 32]| {
        let taken = || compiled.iter().find(|s| s.name == name && s.text_sha256 == *text_sha256).cloned();
        shader_build::find(EMBEDDED, name, text_sha256).or_else(taken)
    };
    shader_build::compile_dir_with(dir, &known, begin).map_err(|e| e.to_string())
}

/// Bytes of the binaries that are built in.
pub fn built_in_shader_bytes() -> u64 {
    let words = |shader: &EmbeddedShader| shader.glslang.len() + shader.naga.map_or(0, <[u32]>::len);
    EMBEDDED.iter().map(|shader| 4 * words(shader) as u64).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shader(name: &str, naga: Result<Vec<u32>, String>) -> CompiledShader {
        let stage = Stage::from_file_name(name).unwrap();
        CompiledShader { name: name.into(), stage, text_sha256: [7; 32], glslang: vec![10, 2_560, 3], naga }
    }

    #[test]
    fn what_is_handed_over_arrives_whole_as_far_as_it_goes() {
        let made = [shader("a/\"b\".vert", Ok(vec![u32::MAX, 10])), shader("c.comp", Err("none\nat all".into()))];
        let mut bytes = Vec::new();
        Replacements { shaders: made.to_vec(), folder: String::new() }.hand_over(&mut bytes).unwrap();
        let mut arrived = Vec::new();
        let mut rest = &bytes[..];
        while let Some((shader, after)) = next(rest) {
            arrived.push(shader);
            rest = after;
        }
        assert_eq!(format!("{arrived:?}"), format!("{made:?}"));
        assert!(rest.is_empty());
        // Cut off anywhere, and with nonsense in it, nothing half arrives.
        for cut in 0..bytes.len() {
            let first = next(&bytes[..cut]);
            assert!(first.is_none_or(|(shader, _)| format!("{shader:?}") == format!("{:?}", made[0])), "{cut}");
        }
        assert!(next(b"{}\n").is_none());
    }

    #[test]
    fn built_in_shaders_are_not_handed_over() {
        let mut bytes = Vec::new();
        let own = Replacements { shaders: vec![CompiledShader::from(&EMBEDDED[0])], folder: String::new() };
        own.hand_over(&mut bytes).unwrap();
        assert!(bytes.is_empty());
    }

    #[test]
    fn what_was_taken_is_not_compiled_again() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("terrain/sky.frag");
        std::fs::create_dir(folder.path().join("terrain")).unwrap();
        let begun = |text: &str| {
            std::fs::write(&file, format!("#version 450\n{text}\nvoid main() {{}}\n")).unwrap();
            let mut begun = Vec::new();
            let made = compile(folder.path(), &mut |name, _| begun.push(name.to_owned())).unwrap();
            (begun, made)
        };
        let (first, made) = begun("");
        assert_eq!(first, ["terrain/sky.frag"]);
        let mut bytes = Vec::new();
        Replacements { shaders: made.clone(), folder: String::new() }.hand_over(&mut bytes).unwrap();
        take_compiled(&bytes);
        let (second, taken) = begun("");
        assert!(second.is_empty());
        assert_eq!(format!("{taken:?}"), format!("{made:?}"));
        // Another text has another binary.
        assert_eq!(begun("// changed").0, ["terrain/sky.frag"]);
        take_compiled(&[]);
        assert_eq!(begun("").0, ["terrain/sky.frag"]);
    }
}
