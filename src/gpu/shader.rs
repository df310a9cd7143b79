//! Shader modules: which compiler's binary a pass runs, and the interface that its descriptor layouts come from.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use ash::vk;

use super::access::Stages;
use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;
use super::pass_info::Binary;
use super::physical::{Feature, PhysicalDevice};
use super::pipeline_store::PipelineStore;
use super::replacements::Replacements;
use crate::content;
use crate::shader_build::{self, EMBEDDED, Interface, Stage, embedded_interface};

pub use crate::shader_build::{Compiler, warm_up as warm_up_compilers};

/// The shaders embedded in the program, or those of a directory compiled at start in their place, and the modules and
/// pipelines that passes have made of them.
pub struct ShaderLibrary {
    device: Arc<Device>,
    compiler: Compiler,
    replaced: Vec<shader_build::CompiledShader>,
    /// Folder that they are from; empty without.
    folder: String,
    /// Modules, programs and pipelines of its shaders.
    pub(super) pipelines: PipelineStore,
}

impl ShaderLibrary {
    /// The embedded shaders; those under `replacements` (laid out as `shaders/`) are compiled now and used instead.
    ///
    /// # Errors
    /// [`Error::Shader`] with the original file and line when a replacement does not compile.
    pub fn new(device: &Arc<Device>, compiler: Compiler, replacements: Option<&Path>) -> Result<Self, Error> {
        Ok(ShaderLibrary::with(device, compiler, Replacements::read(replacements)?))
    }

    /// The embedded shaders, and those that were compiled before the device was opened.
    pub fn with(device: &Arc<Device>, compiler: Compiler, replacements: Replacements) -> Self {
        let Replacements { shaders: replaced, folder } = replacements;
        ShaderLibrary { device: device.clone(), compiler, replaced, folder, pipelines: PipelineStore::default() }
    }

    /// Names the shader folder where a pass that could not be built of the built-in shaders' counterparts may be its
    /// fault.
    pub fn blamed(&self, error: Error) -> Error {
        match error {
            Error::Pass { .. } | Error::Unsupported { .. } if !self.replaced.is_empty() => Error::Shader {
                name: self.folder.clone(),
                problem: format!("{error}; keep the inputs, outputs and blocks of the shader that it replaces"),
            },
            other => other,
        }
    }

    /// The device that the modules are made on.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Objects that the library keeps for passes to come, by kind: what is alive beside buffers and the like once all passes
    /// are gone.
    pub fn kept(&self) -> [(Kind, usize); 4] {
        self.pipelines.kept()
    }

    /// True while a pass holds one of the pipelines.
    pub fn is_in_use(&self) -> bool {
        self.pipelines.is_in_use()
    }

    /// Forgets the modules and pipelines that were made: the next passes make theirs again, as the first time.
    pub fn forget_pipelines(&self) {
        self.pipelines.clear();
    }

    /// Loads one shader by its path under `shaders/`.
    ///
    /// # Errors
    /// [`Error::Shader`] for a name that is not there.
    pub fn module(&self, name: &str) -> Result<Arc<ShaderModule>, Error> {
        self.module_by(name, self.compiler)
    }

    /// Loads one shader as `compiler` made it, or glslang where naga makes none.
    pub(crate) fn module_by(&self, name: &str, compiler: Compiler) -> Result<Arc<ShaderModule>, Error> {
        self.pipelines.module(name, compiler, || self.make_module(name, compiler))
    }

    fn make_module(&self, name: &str, compiler: Compiler) -> Result<Arc<ShaderModule>, Error> {
        let problem = |problem: String| Error::Shader { name: name.to_owned(), problem };
        // The interface is glslang's for both: naga's names are gone, and the build has checked the two alike.
        let (glslang, naga, interface): (&[u32], Option<&[u32]>, _) =
            if let Some(shader) = self.replaced.iter().find(|s| s.name == name) {
                let interface = Interface::reflect(&shader.glslang).map(Cow::Owned);
                (&shader.glslang, shader.naga.as_deref().ok(), interface)
            } else if let Some(place) = EMBEDDED.iter().position(|s| s.name == name) {
                let shader = &EMBEDDED[place];
                (shader.glslang, shader.naga.ok(), embedded_interface(place).map(Cow::Borrowed))
            } else {
                return Err(problem("no such shader is built in".into()));
            };
        let interface = interface.map_err(|e| problem(e.to_string()))?;
        let (words, compiler) = match (compiler, naga) {
            (Compiler::Naga, Some(words)) => (words, Compiler::Naga),
            _ => (glslang, Compiler::Glslang),
        };
        if let Some(capability) = unknown_capability(words, self.device.physical()) {
            return Err(problem(format!("it wants SPIR-V capability {capability}, with which no device is opened")));
        }
        // Each wants a feature or an extension of the device, some of them no capability.
        if let Some(extension) = shader_build::extensions(words).next() {
            return Err(problem(format!("it wants SPIR-V extension {extension}, with which no device is opened")));
        }
        let sha256 = content::sha256(&words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>());
        let info = vk::ShaderModuleCreateInfo::default().code(words);
        // SAFETY: the words are a SPIR-V module that one of the two compilers wrote, of capabilities that the device was
        // opened with; they outlive the call.
        let raw =
            unsafe { self.device.raw.create_shader_module(&info, None) }.context("creating shader module", name)?;
        self.device.live().add(Kind::ShaderModule);
        self.device.name(raw, name);
        Ok(Arc::new(ShaderModule {
            raw,
            device: self.device.clone(),
            name: name.to_owned(),
            interface,
            compiler,
            sha256,
            bytes: 4 * words.len() as u64,
            instructions: shader_build::instruction_count(words),
        }))
    }
}

/// The first capability that a device is not opened with. The numbers are those of the SPIR-V specification.
fn unknown_capability(words: &[u32], physical: &PhysicalDevice) -> Option<u32> {
    /// Matrix, Shader, Sampled1D, Image1D, StorageImageExtendedFormats, ImageQuery, DerivativeControl: every device's.
    const ALWAYS: [u32; 7] = [0, 1, 43, 44, 49, 50, 51];
    const GEOMETRY: u32 = 2;
    shader_build::capabilities(words).find(|capability| match *capability {
        GEOMETRY => !physical.has(Feature::GeometryShader),
        other => !ALWAYS.contains(&other),
    })
}

/// One stage's module with its interface.
pub struct ShaderModule {
    /// Handle.
    pub(crate) raw: vk::ShaderModule,
    device: Arc<Device>,
    /// Path under `shaders/`.
    pub name: String,
    /// Bindings, inputs, outputs and push constants.
    pub interface: Cow<'static, Interface>,
    /// The compiler of the binary.
    pub compiler: Compiler,
    sha256: String,
    bytes: u64,
    instructions: u64,
}

impl ShaderModule {
    /// The identity of the binary.
    pub fn binary(&self) -> Binary {
        Binary {
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            bytes: self.bytes,
            instructions: self.instructions,
            compiler: self.compiler,
        }
    }

    pub(crate) fn stage(&self) -> Stages {
        match self.interface.stage {
            Stage::Vertex => Stages::VERTEX,
            Stage::Geometry => Stages::GEOMETRY,
            Stage::Fragment => Stages::FRAGMENT,
            Stage::Compute => Stages::COMPUTE,
        }
    }
}

impl Drop for ShaderModule {
    fn drop(&mut self) {
        // SAFETY: pipelines do not need their modules once created.
        unsafe { self.device.raw.destroy_shader_module(self.raw, None) };
        self.device.live().remove(Kind::ShaderModule);
    }
}
