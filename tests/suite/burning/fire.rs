//! A fire on the device, and its buffers.

use std::sync::Arc;

use bytemuck::Pod;
use fumarole::gpu::transfer::read_buffer;
use fumarole::gpu::{Buffer, Compiler, Device, Mode, Recorder};
use fumarole::measure::Paper;
use fumarole::papers::burning::model::with_triangles;
use fumarole::papers::burning::{BlockCounts, Burning, Counts, Look, Parameters, Variant, VertexState};
use fumarole::scene::{Mesh, shapes};

use crate::common::shaders_by;

/// A closed object of about 1,000 triangles.
pub fn ball() -> Mesh {
    with_triangles(&shapes::sphere(32, 32), 1000)
}

/// The text's own look.
pub fn text() -> Parameters {
    Parameters { look: Look::Dissertation, ..Parameters::default() }
}

/// Small pictures of a fast fire.
pub fn quick() -> Parameters {
    Parameters { width: 32, height: 24, speed_per_s: 0.5, flammability: 20, blocks: [4, 4, 4], ..text() }
}

pub struct Fire {
    pub paper: Burning,
    recorder: Recorder,
    device: Arc<Device>,
}

/// The simulation's buffers, as bits.
#[derive(PartialEq)]
pub struct State {
    pub vertices: Vec<VertexState>,
    pub rotations: Vec<[f32; 4]>,
    pub labels: Vec<u32>,
    pub cells: Vec<u32>,
    pub blocks: Vec<BlockCounts>,
    pub removed: Vec<u32>,
    pub counts: Counts,
}

impl Fire {
    pub fn new(device: &Arc<Device>, variant: Variant, parameters: &Parameters, mesh: &Mesh) -> Self {
        Self::compiled(device, Compiler::Glslang, variant, parameters, mesh)
    }

    pub fn compiled(
        device: &Arc<Device>,
        compiler: Compiler,
        variant: Variant,
        parameters: &Parameters,
        mesh: &Mesh,
    ) -> Self {
        parameters.validate().unwrap();
        let shaders = shaders_by(device, compiler);
        let paper = Burning::new(&shaders, "test", variant, parameters, mesh).unwrap();
        Fire { paper, recorder: Recorder::new(device).unwrap(), device: device.clone() }
    }

    /// A shell of [`quick`] numbers.
    pub fn shell(device: &Arc<Device>, mesh: &Mesh) -> Self {
        Self::new(device, Variant::Shell, &quick(), mesh)
    }

    pub fn frame(&mut self, number: u32) {
        self.recorder.run(Mode::Plain, |frame| self.paper.record(frame, number)).unwrap();
    }

    /// Ticks of the simulation passes alone.
    pub fn ticks(&mut self, count: u32) {
        for done in (0..count).step_by(50) {
            let batch = 50.min(count - done);
            let Fire { paper, recorder, .. } = self;
            recorder.run(Mode::Plain, |frame| (0..batch).try_for_each(|_| paper.tick(frame))).unwrap();
        }
    }

    pub fn read<T: Pod>(&self, buffer: &Arc<Buffer>) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&read_buffer(&self.device, buffer).unwrap())
    }

    pub fn state(&self) -> State {
        let (vertices, rotations) = self.paper.state();
        let buffers = self.paper.buffers();
        State {
            vertices: self.read(vertices),
            rotations: self.read(rotations),
            labels: self.read(&buffers.labels),
            cells: self.read(&buffers.cells),
            blocks: self.read(&buffers.blocks),
            removed: self.read(&buffers.removed),
            counts: self.paper.counts().unwrap(),
        }
    }
}
