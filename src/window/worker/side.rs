//! One side: a paper's method with its resources, and the frame that it stands at.

use std::sync::Arc;
use std::time::Instant;

use super::choice::Resolved;
use super::describe;
use crate::gpu::{FrameSample, Mode, PassSample, ShaderLibrary};
use crate::image::{Raster, Rgba8};
use crate::measure::machine::Machine;
use crate::measure::parameter::Given;
use crate::measure::picture;
use crate::measure::study::Study;
use crate::measure::{Error, Paper, Target, Variant};
use crate::scene::notes;
use crate::window::protocol::{PassInfo, SideBuilt, TargetInfo};

/// A paper's method, made.
pub struct Side<S: Study> {
    /// Parameters that it is made of.
    pub resolved: Resolved<S>,
    scene: S::Scene,
    /// Notes on what readers passed over in its files, a line each.
    pub notes: Vec<String>,
    /// The method.
    pub paper: S::Paper,
    shaders: Arc<ShaderLibrary>,
    /// Goes before the names of its resources.
    prefix: String,
    at: At,
    /// The frame whose buffers are known to suffice.
    settled: Option<u32>,
    passes: Vec<PassInfo>,
    build_ms: Option<f64>,
    load_ms: Option<f64>,
}

/// Position of the state of a paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum At {
    /// On the way to that frame at most, without having drawn one.
    Before(u32),
    /// It has drawn that frame.
    Drawn(u32),
    /// A frame was begun and not finished.
    Spoiled,
}

impl<S: Study> Side<S> {
    /// Loads the input and makes the method; `label` goes before the names of its resources.
    ///
    /// # Errors
    /// Those of the input and of the Vulkan layer.
    pub fn new(
        machine: &Machine,
        shaders: Arc<ShaderLibrary>,
        resolved: Resolved<S>,
        label: &str,
    ) -> Result<Self, Error> {
        let Resolved { study, variant, .. } = &resolved;
        notes::take();
        let started = Instant::now();
        let scene = study.load()?;
        let notes = notes::take();
        let load_ms = started.elapsed().as_secs_f64() * 1e3;
        let started = Instant::now();
        study.estimate(&machine.device, &scene, *variant).check(&machine.device, variant.as_str())?;
        let made = study.make(&shaders, label, &scene, *variant);
        let paper = made.map_err(|error| shaders.blamed(error))?;
        let build_ms = started.elapsed().as_secs_f64() * 1e3;
        Ok(Side {
            resolved,
            scene,
            notes,
            paper,
            shaders,
            prefix: format!("{label}/"),
            at: At::Spoiled,
            settled: None,
            passes: Vec::new(),
            build_ms: Some(build_ms),
            load_ms: Some(load_ms),
        })
    }

    /// Takes over a set-up that differs in `changed`, where that needs no new paper.
    ///
    /// # Errors
    /// Those of numbers that cannot be together, and of the Vulkan layer.
    pub fn reconfigure(&mut self, resolved: &Resolved<S>, changed: &Given) -> Result<bool, Error> {
        if !resolved.study.reconfigure(&self.scene, &mut self.paper, changed)? {
            return Ok(false);
        }
        self.resolved = resolved.clone();
        (self.settled, self.build_ms, self.load_ms) = (None, None, None);
        Ok(true)
    }

    /// Draws frame `number` to its end, in submissions of bounded length; `proceed` is told the steps that are left to it
    /// and says whether to go on. A fresh one is drawn with the passes that advance the state, even if the state is there.
    /// `None` when it did not go on.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn draw(
        &mut self,
        machine: &mut Machine,
        number: u32,
        (mode, is_fresh): (Mode, bool),
        mut proceed: impl FnMut(u32) -> bool,
    ) -> Result<Option<FrameSample>, Error> {
        loop {
            let is_repeated = self.at == At::Drawn(number) && !is_fresh && self.paper.repeat();
            if !is_repeated {
                self.set_off(number)?;
                if !picture::advance(&picture::NEVER, machine, &mut self.paper, number, &mut proceed)? {
                    return Ok(None);
                }
            }
            self.at = At::Spoiled;
            let sample = machine.recorder.run(mode, |frame| self.paper.record_picture(frame, number))?.clone();
            self.at = At::Drawn(number);
            if self.paper.settle(&self.shaders)? {
                self.settled = Some(number);
                if !is_repeated {
                    self.passes = self.listed(&sample.passes);
                }
                return Ok(Some(sample));
            }
        }
    }

    /// Draws frame `number` up to its first `passes`.
    ///
    /// # Errors
    /// As [`Side::draw`].
    pub fn draw_first(
        &mut self,
        machine: &mut Machine,
        number: u32,
        passes: u32,
        mut proceed: impl FnMut(u32) -> bool,
    ) -> Result<Option<FrameSample>, Error> {
        if self.settled != Some(number) && self.draw(machine, number, (Mode::Plain, true), &mut proceed)?.is_none() {
            return Ok(None);
        }
        self.set_off(number)?;
        if !picture::advance(&picture::NEVER, machine, &mut self.paper, number, proceed)? {
            return Ok(None);
        }
        self.at = At::Spoiled;
        let record = |frame: &mut crate::gpu::Frame<'_>| self.paper.record_picture(frame, number);
        Ok(Some(machine.recorder.run_first(Mode::Plain, passes as usize, record)?.clone()))
    }

    /// Goes back to the start, unless the state stands before frame `number`.
    fn set_off(&mut self, number: u32) -> Result<(), Error> {
        let is_before = match self.at {
            At::Before(at) => at <= number,
            At::Drawn(at) => at < number,
            At::Spoiled => false,
        };
        if !is_before {
            self.paper.restart()?;
        }
        self.at = At::Before(number);
        Ok(())
    }

    fn listed(&self, samples: &[PassSample]) -> Vec<PassInfo> {
        describe::passes(samples, &self.targets(), &self.prefix)
    }

    /// Targets that hold values.
    pub fn targets(&self) -> Vec<TargetInfo> {
        self.paper.targets().iter().filter_map(|target| describe::target(target, &self.prefix)).collect()
    }

    /// The target of a name.
    pub fn target(&self, name: &str) -> Option<Target> {
        self.paper.targets().into_iter().find(|target| target.name == name)
    }

    /// As it is built.
    pub fn built(&self) -> SideBuilt {
        let view = self.paper.picture();
        SideBuilt {
            size: [view.width(), view.height()],
            build_ms: self.build_ms,
            load_ms: self.load_ms,
            passes: self.passes.clone(),
            targets: self.targets(),
        }
    }

    /// Names of its passes, in the paper's order.
    pub fn pass_names(&self) -> Vec<String> {
        self.passes.iter().map(|pass| pass.name.clone()).collect()
    }

    /// Names of the targets that the passes of a frame have written, or all its passes.
    pub fn written(&self, first: Option<&FrameSample>) -> Vec<String> {
        let own = |name: &String| name.strip_prefix(&self.prefix).unwrap_or(name).to_owned();
        let written: Vec<String> = match first {
            None => self.passes.iter().flat_map(|pass| pass.writes.iter().cloned()).collect(),
            Some(sample) => sample.passes.iter().flat_map(|pass| pass.info.writes.iter().map(own)).collect(),
        };
        let targets = self.targets().into_iter();
        targets.filter(|target| written.contains(&target.resource)).map(|target| target.name).collect()
    }

    /// The picture, where a pass has written it.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn picture(&self, machine: &Machine) -> Result<Option<Rgba8>, Error> {
        let view = self.paper.picture();
        match crate::gpu::transfer::read_image(&machine.device, view) {
            Ok(texels) => Ok(Some(Rgba8::new(view.width(), view.height(), texels)?)),
            Err(crate::gpu::Error::ReadBeforeWrite { .. }) => Ok(None),
            Err(other) => Err(other.into()),
        }
    }

    /// A target's values, where a pass has written them.
    ///
    /// # Errors
    /// Of a name that is none; those of the Vulkan layer.
    pub fn values(&self, machine: &Machine, name: &str) -> Result<Option<Raster>, Error> {
        let target = self.target(name).ok_or_else(|| {
            let known: Vec<String> = self.paper.targets().into_iter().map(|target| target.name).collect();
            Error::Input(format!("{name}: no such target; there are {}", known.join(", ")))
        })?;
        match picture::read_target(&machine.device, &target) {
            Ok(raster) => Ok(Some(raster)),
            Err(Error::Gpu(crate::gpu::Error::ReadBeforeWrite { .. })) => Ok(None),
            Err(other) => Err(other),
        }
    }
}
