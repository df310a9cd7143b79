//! The description of a pass in tables and records.

use std::sync::Arc;

use super::executable::Executable;
use super::shader::Compiler;
use crate::named;

named! {
    /// The part of the machine that a pass keeps busy.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum PassKind {
        /// Draws.
        Graphics = "graphics",
        /// Dispatches.
        Compute = "compute",
        /// Copies.
        Transfer = "transfer",
        /// Work of the processor.
        Host = "host",
    }
}

/// One row of the pass table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PassInfo {
    /// The paper's name for it, in kebab case; also the debug label, the timing tag and the report's column.
    pub name: &'static str,
    /// Section of the paper.
    pub section: &'static str,
    /// Graphics, compute, transfer or host.
    pub kind: PassKind,
    /// Paths under `shaders/`, in the order of the stages.
    pub shaders: Vec<String>,
    /// Names of the resources read, in the order of their bindings.
    pub reads: Vec<String>,
    /// Names of the resources written, in the order of their bindings, then attachments.
    pub writes: Vec<String>,
    /// Blend state of each colour target.
    pub blend: Vec<&'static str>,
    /// State of the depth and stencil test.
    pub depth: Option<&'static str>,
    /// Depth and stencil state of the draws that alternate with the pass's own.
    pub counting: Option<&'static str>,
    /// The compiler of the binaries; `None` where no shader runs.
    pub compiler: Option<Compiler>,
    /// The SPIR-V of each stage.
    pub binaries: Vec<Binary>,
    /// The shaders as the driver's compiler made them; `None` where the device does not tell, or was not asked to.
    pub executables: Option<Vec<Executable>>,
}

/// The SPIR-V of one stage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binary {
    /// Path of the shader under `shaders/`.
    pub name: String,
    /// Lower-case hexadecimal SHA-256 of the words, little-endian.
    pub sha256: String,
    /// Size in bytes.
    pub bytes: u64,
    /// Number of its SPIR-V instructions.
    pub instructions: u64,
    /// The compiler that made it.
    pub compiler: Compiler,
}

impl PassInfo {
    /// Name and section, as debug labels and the names of its objects have them.
    pub(super) fn label(&self) -> String {
        label(self.name, self.section)
    }

    /// A pass of host work.
    pub fn host(name: &'static str, section: &'static str, reads: &[&str], writes: &[&str]) -> Arc<Self> {
        Self::without_shaders(name, section, PassKind::Host, reads, writes)
    }

    pub(super) fn without_shaders(
        name: &'static str,
        section: &'static str,
        kind: PassKind,
        reads: &[&str],
        writes: &[&str],
    ) -> Arc<Self> {
        let owned = |words: &[&str]| words.iter().map(|&w| w.to_owned()).collect();
        Arc::new(PassInfo {
            name,
            section,
            kind,
            shaders: Vec::new(),
            reads: owned(reads),
            writes: owned(writes),
            blend: Vec::new(),
            depth: None,
            counting: None,
            compiler: None,
            binaries: Vec::new(),
            executables: None,
        })
    }
}

/// A pass's name with its section, where it has one.
pub(super) fn label(name: &str, section: &str) -> String {
    if section.is_empty() { name.to_owned() } else { format!("{name} ({section})") }
}
