//! Compiles every shader with both compilers and embeds the binaries.

// The build script needs only a part of the module that the library uses whole, and `embedded_shaders`, which
// this script sets for the library, is unknown to the script itself.
#[allow(dead_code, unused_imports, unexpected_cfgs)]
#[path = "src/shader_build/mod.rs"]
mod shader_build;

use std::env;
use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use shader_build::{CompiledShader, NAGA_EXCEPTIONS, check_exceptions, compile_dir};

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=shaders");
    // All of it: whether the working tree is dirty is part of every record.
    println!("cargo::rerun-if-changed=src");
    describe_build();
    println!("cargo::rustc-check-cfg=cfg(embedded_shaders)");
    println!("cargo::rustc-cfg=embedded_shaders");
    match embed_shaders() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            println!("cargo::error={message}");
            ExitCode::FAILURE
        }
    }
}

/// Tells the library which commit, compiler and profile it is built from, as far as they are known.
fn describe_build() {
    for path in [".git/HEAD", ".git/logs/HEAD"] {
        if Path::new(path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let answer = |program: OsString, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).output().ok().filter(|o| o.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = answer("git".into(), &["rev-parse", "HEAD"]);
    let dirty = answer("git".into(), &["--no-optional-locks", "status", "--porcelain"]).map(|s| !s.is_empty());
    let rustc = env::var_os("RUSTC").and_then(|rustc| answer(rustc, &["-V"]));
    let facts = [
        ("FUMAROLE_GIT_COMMIT", commit),
        ("FUMAROLE_GIT_DIRTY", dirty.map(|d| d.to_string())),
        ("FUMAROLE_RUSTC", rustc),
        ("FUMAROLE_PROFILE", env::var("PROFILE").ok()),
    ];
    for (name, value) in facts {
        if let Some(value) = value {
            println!("cargo::rustc-env={name}={value}");
        }
    }
}

/// Writes each binary to a file of its own and the table that includes them: as lists of numbers in Rust they would take the
/// compiler ten times as long as their reading.
fn embed_shaders() -> Result<(), String> {
    let shaders = compile_dir(Path::new("shaders"), &[]).map_err(|error| error.to_string())?;
    check_exceptions(&shaders, NAGA_EXCEPTIONS).map_err(|error| error.to_string())?;
    let folder = env::var_os("OUT_DIR").ok_or("cargo sets no OUT_DIR; build with cargo")?;
    let folder = Path::new(&folder);
    let (mut binaries, mut table) = (String::new(), String::new());
    for (index, CompiledShader { name, stage, text_sha256, glslang, naga }) in shaders.iter().enumerate() {
        binaries += &embed(folder, &format!("GLSLANG_{index}"), glslang)?;
        let naga = match naga {
            Ok(words) => {
                binaries += &embed(folder, &format!("NAGA_{index}"), words)?;
                format!("Ok(&NAGA_{index})")
            }
            Err(reason) => format!("Err({reason:?})"),
        };
        let _infallible = writeln!(
            table,
            "EmbeddedShader {{ name: {name:?}, stage: Stage::{stage:?}, text_sha256: {text_sha256:?}, glslang: &GLSLANG_{index}, \
             naga: {naga} }},"
        );
    }
    let table = format!(
        "{binaries}/// Every shader, sorted by name.\npub static EMBEDDED: &[EmbeddedShader] = &[\n{table}];\n"
    );
    write(&folder.join("shaders.rs"), table.as_bytes())
}

/// Writes SPIR-V words as a file of that name, in the target's order of bytes, and gives the Rust source of their static.
fn embed(folder: &Path, name: &str, words: &[u32]) -> Result<String, String> {
    let is_big = env::var("CARGO_CFG_TARGET_ENDIAN").is_ok_and(|endian| endian == "big");
    let order = if is_big { u32::to_be_bytes } else { u32::to_le_bytes };
    let bytes: Vec<u8> = words.iter().copied().flat_map(order).collect();
    write(&folder.join(format!("{name}.spv")), &bytes)?;
    Ok(format!(
        "static {name}: [u32; {}] = bytemuck::must_cast(*include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{name}.spv\")));\n",
        words.len()
    ))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    fs::write(path, bytes).map_err(|error| format!("writing {}: {error}; free space or clean", path.display()))
}
