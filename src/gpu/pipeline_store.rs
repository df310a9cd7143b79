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
    made: Mutex<Made>,
}

#[derive(Default)]
struct Made {
    /// Modules by the compiler that was asked for: they may be another's.
    modules: Vec<(Compiler, Arc<ShaderModule>)>,
    /// Programs by the pass that they are named after.
    programs: Vec<(&'static str, Arc<Program>)>,
    pipelines: Vec<(PipelineState, Arc<Pipeline>)>,
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
    fn lock(&self) -> MutexGuard<'_, Made> {
        // Each change is one push: what a panic leaves is whole.
        self.made.lock().unwrap_or_else(PoisonError::into_inner)
    }

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
        let is_it = |made: &&(Compiler, Arc<ShaderModule>)| made.0 == compiler && made.1.name == name;
        let kept = self.lock().modules.iter().find(is_it).map(|made| made.1.clone());
        if let Some(module) = kept {
            return Ok(module);
        }
        let module = make()?;
        self.lock().modules.push((compiler, module.clone()));
        Ok(module)
    }

    /// The program of a pass of these modules; the first is made.
    ///
    /// # Errors
    /// Those of [`Program::new`].
    pub fn program(
        &self,
        device: &Arc<Device>,
        pass: &'static str,
        modules: Vec<Arc<ShaderModule>>,
    ) -> Result<Arc<Program>, Error> {
        let is_it = |made: &&(&str, Arc<Program>)| {
            made.0 == pass
                && made.1.modules.len() == modules.len()
                && made.1.modules.iter().zip(&modules).all(|(a, b)| Arc::ptr_eq(a, b))
        };
        let kept = self.lock().programs.iter().find(is_it).map(|made| made.1.clone());
        if let Some(program) = kept {
            return Ok(program);
        }
        let program = Program::new(device, pass, modules)?;
        self.lock().programs.push((pass, program.clone()));
        Ok(program)
    }

    /// The pipeline of a program in a state; `make` makes the first. Others may ask for theirs meanwhile.
    ///
    /// # Errors
    /// Those of `make`.
    pub fn pipeline(
        &self,
        program: &Arc<Program>,
        state: PipelineState,
        make: impl FnOnce() -> Result<Arc<Pipeline>, Error>,
    ) -> Result<Arc<Pipeline>, Error> {
        let is_it = |made: &&(PipelineState, Arc<Pipeline>)| made.0 == state && Arc::ptr_eq(&made.1.program, program);
        let kept = self.lock().pipelines.iter().find(is_it).map(|made| made.1.clone());
        if let Some(pipeline) = kept {
            return Ok(pipeline);
        }
        let pipeline = make()?;
        self.lock().pipelines.push((state, pipeline.clone()));
        Ok(pipeline)
    }

    /// Live objects by kind.
    pub fn kept(&self) -> [(Kind, usize); 4] {
        let made = self.lock();
        let programs = made.programs.len();
        [
            (Kind::ShaderModule, made.modules.len()),
            (Kind::DescriptorSetLayout, programs),
            (Kind::PipelineLayout, programs),
            (Kind::Pipeline, made.pipelines.len()),
        ]
    }

    /// True while a pass holds a pipeline.
    pub fn is_in_use(&self) -> bool {
        self.lock().pipelines.iter().any(|(_, pipeline)| Arc::strong_count(pipeline) > 1)
    }

    /// Passes that are made from here on compile anew.
    pub fn clear(&self) {
        let made = std::mem::take(&mut *self.lock());
        drop(made);
    }
}
