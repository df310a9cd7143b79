//! Pipelines by everything that they are made from. A paper makes passes of one name, shaders and state more than once: a step of
//! a pyramid for each level, all passes anew for buffers that have grown. Only the first compiles; threads that ask at once may
//! each make one.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ash::vk;

use super::device::Device;
use super::error::Error;
use super::live::Kind;
use super::pipeline::{Pipeline, Topology, VertexLayout};
use super::program::Program;
use super::render_pass::{Blend, DepthTest, Targets};
use super::shader::{Compiler, ShaderModule};

/// Modules, programs and pipelines of the shaders of one library.
#[derive(Default)]
pub(super) struct PipelineStore {
    /// By the compiler that was asked for, which may not be the one that made them.
    modules: Table<Compiler, ShaderModule>,
    /// By the pass that they are named after.
    programs: Table<&'static str, Program>,
    /// By their state.
    pipelines: Table<PipelineState, Pipeline>,
}

/// Objects that are made once.
struct Table<K, T>(Mutex<Vec<(K, Arc<T>)>>);

impl<K, T> Default for Table<K, T> {
    fn default() -> Self {
        Table(Mutex::default())
    }
}

impl<K: PartialEq, T> Table<K, T> {
    fn lock(&self) -> MutexGuard<'_, Vec<(K, Arc<T>)>> {
        // Each change is one push: what a panic leaves is whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The object of that key that `is_it` is true of; `make` makes the first, while others may ask for theirs.
    ///
    /// # Errors
    /// Those of `make`.
    fn find_or_make(
        &self,
        key: K,
        is_it: impl Fn(&T) -> bool,
        make: impl FnOnce() -> Result<Arc<T>, Error>,
    ) -> Result<Arc<T>, Error> {
        let kept = self.lock().iter().find(|(of, made)| *of == key && is_it(made)).map(|(_, made)| made.clone());
        if let Some(made) = kept {
            return Ok(made);
        }
        let made = make()?;
        self.lock().push((key, made.clone()));
        Ok(made)
    }

    fn count(&self) -> usize {
        self.lock().len()
    }

    fn clear(&self) {
        let made = std::mem::take(&mut *self.lock());
        drop(made);
    }
}

/// All that distinguishes the pipelines of one program.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PipelineState {
    /// Name and section of the pass, which the pipeline is named after.
    pub label: (&'static str, &'static str),
    /// Paths under `shaders/`, in the order of the stages.
    pub shaders: Vec<String>,
    /// State of the rasterizer; `None` of a compute pipeline.
    pub raster: Option<RasterState>,
}

/// State of a graphics pipeline beside its stages.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RasterState {
    colors: Vec<(vk::Format, Blend)>,
    depth: Option<(vk::Format, DepthTest)>,
    culled: vk::CullModeFlags,
    vertices: VertexLayout,
    topology: Topology,
}

impl RasterState {
    /// Load operations, views and extent are no part of a pipeline's state.
    pub fn new(targets: &Targets, vertices: &VertexLayout, topology: Topology) -> Self {
        RasterState {
            colors: targets.colors.iter().map(|(target, blend)| (target.view.image().desc().format, *blend)).collect(),
            depth: targets.depth.as_ref().map(|(target, test)| (target.view.image().desc().format, *test)),
            culled: targets.culled,
            vertices: vertices.clone(),
            topology,
        }
    }
}

impl PipelineStore {
    /// The module of a shader; `make` makes the first.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn module(
        &self,
        name: &str,
        compiler: Compiler,
        make: impl FnOnce() -> Result<Arc<ShaderModule>, Error>,
    ) -> Result<Arc<ShaderModule>, Error> {
        self.modules.find_or_make(compiler, |made| made.name == name, make)
    }

    /// The program of a pass of these modules; the first is made.
    ///
    /// # Errors
    /// Those of [`Program::new`].
    pub fn program(
        &self,
        device: &Arc<Device>,
        pass: &'static str,
        modules: &[Arc<ShaderModule>],
    ) -> Result<Arc<Program>, Error> {
        let is_it = |made: &Program| {
            made.modules.len() == modules.len() && made.modules.iter().zip(modules).all(|(a, b)| Arc::ptr_eq(a, b))
        };
        self.programs.find_or_make(pass, is_it, || Program::new(device, pass, modules.to_vec()))
    }

    /// The pipeline of a program in a state; `make` makes the first.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn pipeline(
        &self,
        program: &Arc<Program>,
        state: PipelineState,
        make: impl FnOnce() -> Result<Arc<Pipeline>, Error>,
    ) -> Result<Arc<Pipeline>, Error> {
        self.pipelines.find_or_make(state, |made| Arc::ptr_eq(&made.program, program), make)
    }

    /// Live objects by kind.
    pub fn kept(&self) -> [(Kind, usize); 4] {
        let programs = self.programs.count();
        [
            (Kind::ShaderModule, self.modules.count()),
            (Kind::DescriptorSetLayout, programs),
            (Kind::PipelineLayout, programs),
            (Kind::Pipeline, self.pipelines.count()),
        ]
    }

    /// True while a pass holds a pipeline.
    pub fn is_in_use(&self) -> bool {
        self.pipelines.lock().iter().any(|(_, pipeline)| Arc::strong_count(pipeline) > 1)
    }

    /// Passes that are made from here on compile anew.
    pub fn clear(&self) {
        self.pipelines.clear();
        self.programs.clear();
        self.modules.clear();
    }
}
