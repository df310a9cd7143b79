//! `flames` (3.6): particles of fire and smoke, one group a block of the combustion-ready area.

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::buffers::Buffers;
use super::draw::Draw;
use super::fire_layer;
use super::model::Model;
use super::parameters::Parameters;
use super::parts::Parts;
use super::ping_pong::{PingPong, Work, build, new};
use crate::gpu::transfer::{update, upload};
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Camera;

host_block! {
    /// The uniform block of `burning/billboards.glsl`, which says what each member is.
    pub(super) struct BillboardsBlock {
        right: Vec3,
        particle_radius: f32,
        up: Vec3,
        depth_scale: f32,
        depth_offset: f32,
        layer_scale: u32,
        last_pixel: [u32; 2],
        fire_light: f32,
        _pad: f32,
        layer_size: [u32; 2],
    }
}

host_block! {
    /// The group of a block in a tick (`burning/flames.glsl`).
    pub struct Group {
        /// In the pool of fire particles.
        pub first_fire: u32,
        /// In the pool of smoke particles.
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
        /// Ticks since it was born.
        pub age_ticks: f32,
        /// Its whole life, 0 when it is not there.
        pub life_ticks: f32,
        /// The block that it was born in.
        pub block: f32,
        /// Two numbers of its own, 0 to 1.
        pub random: [f32; 2],
    }
}

/// The pass with its buffers.
pub struct Flames {
    steps: PingPong<4>,
    /// The uniform block of `burning/billboards.glsl`.
    pub(super) billboards: Arc<Buffer>,
    /// [`Group`] of each block, and an end.
    pub groups: Arc<Buffer>,
    /// [`Particle`]s: fire, then smoke.
    pub particles: Arc<Buffer>,
}

impl Flames {
    /// `None` where there is neither fire nor smoke. A restart puts all flames out.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        buffers: &mut Buffers,
        model: &Model,
        (draw, parts): (&Draw, Option<&Parts>),
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
        let block = billboards(parameters, &draw.camera);
        let billboards =
            upload(device, &name("billboards"), vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?;

        let step = |shader: &str| Pass::compute("flames", "3.6", shader).with("constants", &buffers.constants);
        let share = step("burning/flames-groups.comp")
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .with("Groups", &groups)
            .with("Listed", &listed);
        let chunks = &buffers.vertex_chunks;
        let near = chunks.list(shaders, &name("vertices-ready"))?;
        let visit = chunks.listing(step("burning/chunks-visited-ready.comp"), &near).with("Clock", &buffers.clock);
        let list = step("burning/flames-ready.comp")
            .with("Labels", &buffers.labels)
            .with("Cells", &buffers.cells)
            .with("Clock", &buffers.clock)
            .with("Alive", &buffers.alive)
            .with("Groups", &groups)
            .with("Listed", &listed)
            .with("Ready", &ready);
        let list = chunks.visiting(list, &near);
        let burn = match parts {
            None => step("burning/flames-whole.comp"),
            Some(parts) => parts.posing(step("burning/flames-parts.comp")),
        };
        let burn = burn
            .with("billboards", &billboards)
            .with("Blocks", &buffers.blocks)
            .with("Clock", &buffers.clock)
            .with("Groups", &groups)
            .with("Listed", &listed)
            .with("Ready", &ready)
            .with("Particles", &particles);
        let state = new("NewState", &buffers.states);
        let rotations = new("NewRotations", &buffers.rotations);
        let steps = PingPong::new([
            (build(shaders, visit, &[])?, chunks.lists()),
            (build(shaders, share, &[])?, Work::Elements(1)),
            (build(shaders, list, &[state])?, Work::Indirect),
            (build(shaders, burn, &[state, rotations])?, Work::Elements(particle_count)),
        ]);
        Ok(Some(Flames { steps, billboards, groups, particles }))
    }

    /// Turns fire and smoke towards the camera of the next frames.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn set_camera(&self, parameters: &Parameters, camera: &Camera) -> Result<(), Error> {
        let block = billboards(parameters, camera);
        update(&self.billboards, bytemuck::bytes_of(&block))
    }

    /// Advances the particles by the tick that writes the state of index `tick`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: usize) -> Result<(), Error> {
        self.steps.record(frame, tick)
    }
}

/// The picture's axes in space, and the conversion of its depth to a distance.
fn billboards(parameters: &Parameters, camera: &Camera) -> BillboardsBlock {
    let view = camera.view();
    let projection = camera.projection(parameters.aspect());
    BillboardsBlock {
        right: view.row(0).truncate(),
        particle_radius: parameters.particle_radius,
        up: view.row(1).truncate(),
        // For a distance w along the view, depth = -m22 + m32 / w, columns before rows.
        depth_scale: projection.w_axis.z,
        depth_offset: projection.z_axis.z,
        layer_scale: parameters.fire_scale,
        last_pixel: [parameters.width - 1, parameters.height - 1],
        fire_light: parameters.fire_light,
        _pad: 0.0,
        layer_size: fire_layer::size(parameters),
    }
}
