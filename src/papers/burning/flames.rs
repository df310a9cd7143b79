//! `flames` and `draw-fire` (3.6): particles of fire and smoke, one group a block of the combustion-ready area.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::drawing::Drawing;
use super::model::Model;
use super::parameters::Parameters;
use super::state::Buffers;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, Load, Pass, ShaderLibrary, Topology};
use crate::host_block;

host_block! {
    /// The uniform block of `burning/billboards.glsl`, which says what each member is.
    pub(super) struct BillboardsBlock {
        right: Vec3,
        particle_radius: f32,
        up: Vec3,
        depth_scale: f32,
        depth_offset: f32,
        _pad: [f32; 3],
    }
}

host_block! {
    /// What a tick knows of a block's group (`burning/flames.glsl`).
    pub struct Group {
        pub first_fire: u32,
        pub first_smoke: u32,
        /// In the list of ready vertices.
        pub first_ready: u32,
        /// Live vertices of the block, 0 outside the combustion-ready area.
        pub weight: u32,
    }
}

host_block! {
    /// `burning/flames.glsl`
    pub struct Particle {
        /// Diagonals.
        pub position: Vec3,
        pub age_ticks: f32,
        /// Its whole life, 0 when it is not there.
        pub life_ticks: f32,
        /// The block that it was born in.
        pub block: f32,
        /// Two numbers of its own, 0 to 1.
        pub random: [f32; 2],
    }
}

/// The passes with their buffers.
pub struct Flames {
    /// For either turn of the states.
    turns: [[Pass; 3]; 2],
    draw: Pass,
    /// [`Group`] of each block, and an end.
    pub groups: Arc<Buffer>,
    /// [`Particle`]s: fire, then smoke.
    pub particles: Arc<Buffer>,
    particle_count: u32,
    vertices: u32,
}

impl Flames {
    /// `None` where there is neither fire nor smoke. A restart puts all flames out.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        buffers: &mut Buffers,
        model: &Model,
        drawing: &Drawing,
    ) -> Result<Option<Self>, Error> {
        let particle_count = parameters.fire + parameters.smoke;
        if particle_count == 0 {
            return Ok(None);
        }
        let device = shaders.device();
        let name = |what: &str| format!("{label}/{what}");
        let storage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let empty =
            |what: &str, bytes: usize| Buffer::new(device, BufferDesc::new(name(what), bytes as u64).usage(storage));
        let blocks = model.grid.cell_count() as usize;
        let groups = empty("flame-groups", size_of::<Group>() * (blocks + 1))?;
        let listed = empty("listed-vertices", 4 * blocks)?;
        let ready = empty("ready-vertices", 4 * model.rest.len())?;
        let none = vec![0; size_of::<Particle>() * particle_count as usize];
        let particles = upload(device, &name("particles"), storage, &none)?;
        buffers.keep(shaders, &particles)?;
        let block = billboards(parameters, drawing);
        let billboards =
            upload(device, &name("billboards"), vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?;

        let step = |shader: &str| Pass::compute("flames", "3.6", shader).with("constants", &buffers.constants);
        let share = step("burning/flames-groups.comp")
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .with("Groups", &groups)
            .with("Listed", &listed)
            .build(shaders)?;
        let turn = |turn: usize| -> Result<[Pass; 3], Error> {
            let list = step("burning/flames-ready.comp")
                .with("NewState", &buffers.states[turn])
                .with("Labels", &buffers.labels)
                .with("Cells", &buffers.cells)
                .with("Alive", &buffers.alive)
                .with("Groups", &groups)
                .with("Listed", &listed)
                .with("Ready", &ready)
                .build(shaders)?;
            let burn = step("burning/flames.comp")
                .with("billboards", &billboards)
                .with("NewState", &buffers.states[turn])
                .with("Blocks", &buffers.blocks)
                .with("NewRotations", &buffers.rotations[turn])
                .with("Clock", &buffers.clock)
                .with("Groups", &groups)
                .with("Ready", &ready)
                .with("Particles", &particles)
                .build(shaders)?;
            Ok(Pass::steps([share.clone(), list, burn]))
        };
        let turns = [turn(0)?, turn(1)?];
        let draw = Pass::graphics("draw-fire", "3.6", "burning/draw-fire.vert", "burning/draw-fire.frag")
            .with("constants", &buffers.constants)
            .with("view", &drawing.view)
            .with("billboards", &billboards)
            .with("Particles", &particles)
            .with("mesh_depth", &drawing.depth)
            .color(&drawing.picture, Load::Keep, Blend::Premultiplied)
            .topology(Topology::TriangleStrip)
            .build(shaders)?;
        Ok(Some(Flames { turns, draw, groups, particles, particle_count, vertices: model.rest.len() as u32 }))
    }

    /// Moves the flames on in the tick that leaves its state in buffer `turn`.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, turn: usize) -> Result<(), Error> {
        let [share, list, burn] = &self.turns[turn];
        frame.compute(share, |dispatch| {
            dispatch.threads(1, 1, 1);
        })?;
        frame.compute(list, |dispatch| {
            dispatch.threads(self.vertices, 1, 1);
        })?;
        frame.compute(burn, |dispatch| {
            dispatch.threads(self.particle_count, 1, 1);
        })
    }

    /// Draws the particles over the mesh.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn draw(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.draw, |draw| {
            draw.instances(4, self.particle_count);
        })
    }
}

/// The picture's axes in space, and how its depth is turned into a distance.
fn billboards(parameters: &Parameters, drawing: &Drawing) -> BillboardsBlock {
    let view = drawing.camera.view();
    let projection = drawing.camera.projection(parameters.aspect());
    BillboardsBlock {
        right: view.row(0).truncate(),
        particle_radius: parameters.particle_radius,
        up: view.row(1).truncate(),
        // For a distance w along the view, depth = -m22 + m32 / w, columns before rows.
        depth_scale: projection.w_axis.z,
        depth_offset: projection.z_axis.z,
        _pad: [0.0; 3],
    }
}
