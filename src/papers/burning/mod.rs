//! `burning`: D. E. Amarasinghe's burning and melting objects, chapters 3 to 6.
//!
//! ```text
//! each tick of 1/60 s:
//!   heat-boundary ─► (refinement) ─► internal-deformation ─► block-weights ─► block-rotation ─┐
//!     ┌──────────────────────────────────────────────────────────────────────────────────────┘
//!     └─► (parts ─► bending ─► falling, or puddle) ─► flames ─┐
//!     ┌─────────────────────────────────────────────┘
//! each frame:
//!     └─► vertex-mapping ─► surface-removal ─► normals ─► (flame-lights) ─► draw ─► (draw-ground ─► draw-puddle)
//!     ┌───────────────────────────────────────────────────────────────────────────────────────────┘
//!     └─► (smoke-volume) ─► draw-fire ─► (tone)
//! ```
//!
//! The simulation advances in ticks alone, so its state depends on the simulated time and not on the frame rate; the
//! state lives on the device, and a frame sends it constants at most (3.7.4).

mod appearance;
mod axes;
mod bending;
mod beside;
mod block_rotation;
mod block_weights;
mod buffers;
mod choices;
mod chunks;
mod connection;
mod draw;
mod draw_fire;
mod draw_ground;
mod draw_puddle;
mod draw_wire;
mod estimate;
pub mod experiments;
mod falling;
mod fire_layer;
mod flame_lights;
mod flames;
mod framing;
mod heat_boundary;
mod internal_deformation;
#[cfg(test)]
mod layouts;
mod level_of_detail;
mod loading;
pub mod materials;
pub mod model;
mod normals;
pub mod parameters;
mod parts;
mod ping_pong;
mod puddle;
pub mod reference;
mod refinement;
pub mod setup;
mod smoke_volume;
mod surface_removal;
mod targets;
mod texture;
mod tone;
mod vertex_mapping;
mod warnings;

use std::sync::Arc;

use self::bending::Bending;
use self::block_rotation::block_rotation;
use self::block_weights::block_weights;
use self::draw::Draw;
use self::draw_fire::DrawFire;
use self::draw_ground::{DrawGround, ash};
use self::draw_puddle::DrawPuddle;
use self::draw_wire::DrawWire;
use self::falling::Falling;
use self::flame_lights::{FlameLights, fire_lights};
use self::heat_boundary::heat_boundary;
use self::internal_deformation::InternalDeformation;
use self::loading::Loading;
use self::materials::Appearances;
use self::model::Model;
use self::normals::Normals;
use self::ping_pong::PingPong;
use self::puddle::Puddle;
use self::refinement::Refinement;
use self::surface_removal::SurfaceRemoval;
use self::tone::ToneMapping;
use self::vertex_mapping::{Shown, VertexMapping};
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, Device, Error, Feature, Frame, ImageView, Mode, Recorder, ShaderLibrary};
use crate::measure::{Paper, Target};
use crate::scene::{Camera, Mesh};

pub use self::bending::{Hinge, Load, Sizes};
pub use self::beside::Beside;
pub use self::buffers::{BlockCounts, Buffers, Counts, RestVertex, VertexState};
pub use self::chunks::{ChunkBuffers, Visits};
pub use self::connection::Connection;
pub use self::flame_lights::{FireLight, LIGHT_CELLS};
pub use self::flames::{Flames, Group, Particle};
pub use self::framing::seen_from;
pub use self::parameters::{Heat, Look, Material, Parameters, Shading, TICKS_PER_S, Variant};
pub use self::parts::{Bend, MOST_PARTS, Part, Parts, SEARCH_TICKS};
pub use self::puddle::{Film, PUDDLE_CELLS, PUDDLE_HALF_WIDTH};
pub use self::smoke_volume::{SMOKE_CELLS, SmokeGrid, SmokeVolume};
pub use self::texture::{Level, Texture, with_levels};
pub use crate::papers::tone::Tone;

/// Features that a device needs for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 1] = [Feature::BlendRgba16Float];

/// Slices that one frame records at most, more than the longest time step has: those of frames that are left out before
/// a late picture would not fit into memory at once.
const MOST_SLICES: u64 = 1024;

/// The paper under one variant: its buffers, and its passes in the order in which they are recorded.
pub struct Burning {
    device: Arc<Device>,
    variant: Variant,
    parameters: Parameters,
    model: Model,
    buffers: Buffers,
    loading: Option<Loading>,
    heat_boundary: PingPong<5>,
    refinement: Option<Refinement>,
    internal_deformation: InternalDeformation,
    block_weights: PingPong<2>,
    block_rotation: PingPong<1>,
    parts: Option<Parts>,
    bending: Option<Bending>,
    falling: Option<Falling>,
    puddle: Option<Puddle>,
    flames: Option<Flames>,
    vertex_mapping: VertexMapping,
    surface_removal: SurfaceRemoval,
    normals: Normals,
    fire_lights: Option<Arc<Buffer>>,
    flame_lights: Option<FlameLights>,
    draw: Draw,
    draw_wire: Option<DrawWire>,
    draw_ground: Option<DrawGround>,
    draw_puddle: Option<DrawPuddle>,
    draw_fire: Option<DrawFire>,
    tone: Option<ToneMapping>,
    /// Slices of ticks since the fire was lit.
    slices: u64,
    /// Slices before frame 0.
    start_slices: u64,
    next_frame: u32,
    /// The state that stream and normals were last made of.
    shown: Shown,
    /// They are those of the newest state.
    is_shaded: bool,
}

impl Burning {
    /// Makes every resource and pass and burns up to the first frame; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// Those of the Vulkan layer. The caller has validated `parameters` and `mesh`.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        mesh: &Mesh,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let largest_bytes = u64::from(device.physical().limits.max_storage_buffer_range);
        let model = Model::new(mesh, variant, parameters, largest_bytes)?;
        let mut buffers = Buffers::new(shaders, label, variant, parameters, &model)?;
        let is_refined = variant.refines() && model.levels > 0;
        let refinement =
            is_refined.then(|| Refinement::new(shaders, label, parameters, &mut buffers, &model)).transpose()?;
        let appearances = Appearances::new(shaders, label, variant, parameters, &model)?;
        let has_light = parameters.has_linear_light();
        let fire_lights = has_light.then(|| fire_lights(shaders, label)).transpose()?;
        let lights = fire_lights.as_ref();
        let seen = (appearances.as_ref(), lights);
        let draw = Draw::new(shaders, label, (variant, parameters), &buffers, seen, &model)?;
        let has_wire = parameters.shading == Shading::Wire;
        let draw_wire = has_wire.then(|| DrawWire::new(shaders, &buffers, &draw, &model)).transpose()?;
        let has_parts = parameters.collapses(variant);
        let parts = has_parts.then(|| Parts::new(shaders, label, &mut buffers, &model)).transpose()?;
        let bending = parts.as_ref().map(|parts| Bending::new(shaders, label, parameters, &mut buffers, parts, &model));
        let bending = bending.transpose()?.flatten();
        let falling =
            parts.as_ref().map(|parts| Falling::new(shaders, label, &mut buffers, parts, &model)).transpose()?;
        let has_puddle = parameters.has_puddle(variant);
        let puddle = has_puddle.then(|| Puddle::new(shaders, label, &mut buffers)).transpose()?;
        let draw_puddle =
            puddle.as_ref().map(|puddle| DrawPuddle::new(shaders, label, &buffers, (&draw, lights), puddle));
        let draw_puddle = draw_puddle.transpose()?;
        let ash = parameters.has_ash(variant).then(|| ash(shaders, label, &mut buffers)).transpose()?;
        let seen_ash = ash.as_ref().filter(|_| parameters.has_ground());
        let draw_ground =
            seen_ash.zip(lights).map(|seen| DrawGround::new(shaders, &buffers, &draw, seen)).transpose()?;
        let flames = Flames::new(shaders, label, parameters, &mut buffers, &model, (&draw, parts.as_ref()))?;
        let draw_fire = flames
            .as_ref()
            .map(|flames| DrawFire::new(shaders, label, parameters, &buffers, (&draw, flames), lights))
            .transpose()?;
        let shining = flames.as_ref().zip(lights);
        let flame_lights =
            shining.map(|(flames, lights)| FlameLights::new(shaders, &buffers, flames, lights)).transpose()?;
        let fire = flames.as_ref().zip(draw_fire.as_ref());
        let tone = lights.map(|_| ToneMapping::new(shaders, parameters, &draw, fire)).transpose()?;
        let mut burning = Burning {
            device: device.clone(),
            variant,
            loading: (!parameters.preload).then(|| Loading::new(device, &buffers)).transpose()?,
            heat_boundary: heat_boundary(shaders, variant, &buffers, parts.as_ref())?,
            internal_deformation: InternalDeformation::new(shaders, label, (variant, parameters), &buffers, &model)?,
            block_weights: block_weights(shaders, parameters, &buffers, refinement.is_some(), &model)?,
            block_rotation: block_rotation(shaders, variant, &buffers, &model)?,
            flames,
            vertex_mapping: VertexMapping::new(shaders, &buffers, parts.as_ref(), &model)?,
            surface_removal: SurfaceRemoval::new(
                shaders,
                label,
                (variant, parameters),
                &mut buffers,
                refinement.as_ref(),
                parts.as_ref().zip(ash.as_ref()),
                &model,
            )?,
            parts,
            bending,
            falling,
            puddle,
            refinement,
            normals: Normals::new(shaders, &buffers, appearances.as_ref(), &model)?,
            fire_lights,
            flame_lights,
            draw,
            draw_wire,
            draw_ground,
            draw_puddle,
            draw_fire,
            tone,
            parameters: parameters.clone(),
            model,
            buffers,
            slices: 0,
            start_slices: 0,
            next_frame: 0,
            shown: Shown::NONE,
            is_shaded: false,
        };
        burning.burn_to_first_frame()?;
        Ok(burning)
    }

    /// Simulates what is due before frame 0 and makes it the start.
    fn burn_to_first_frame(&mut self) -> Result<(), Error> {
        self.start_slices = self.parameters.slices_before();
        self.burn_until(self.start_slices)?;
        if self.start_slices > 0 { self.buffers.save(&self.device) } else { Ok(()) }
    }

    /// Simulates up to a number of slices, in submissions of its own.
    fn burn_until(&mut self, slices: u64) -> Result<(), Error> {
        /// Few enough for one submission.
        const BATCH: u64 = 64;
        let mut recorder = Recorder::new(&self.device)?;
        while self.slices < slices {
            let end = slices.min(self.slices + BATCH);
            recorder.run(Mode::Plain, |frame| self.simulate(frame, end, None))?;
        }
        Ok(())
    }

    /// Ticks since the fire was lit.
    pub fn ticks(&self) -> u64 {
        self.slices / u64::from(self.parameters.time_division)
    }

    /// Records one tick of the simulation passes alone.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn tick(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let end = (self.ticks() + 1) * u64::from(self.parameters.time_division);
        self.simulate(frame, end, None)
    }

    /// Records the passes of the ticks up to a number of slices, and `vertex-mapping` after `mapped_tick`.
    fn simulate(&mut self, frame: &mut Frame<'_>, end: u64, mapped_tick: Option<u64>) -> Result<(), Error> {
        let division = self.parameters.time_division;
        while self.slices < end {
            let slice = (self.slices % u64::from(division)) as u32;
            let tick = 1 - self.newest();
            if slice == 0 {
                self.heat_boundary.record(frame, tick)?;
                if let Some(refinement) = &self.refinement {
                    refinement.record(frame)?;
                }
            }
            self.internal_deformation.record(frame, self.ticks() + 1, slice)?;
            self.slices += 1;
            if slice + 1 < division {
                continue;
            }
            self.block_weights.record(frame, tick)?;
            self.block_rotation.record(frame, tick)?;
            if let (Some(parts), Some(falling)) = (&self.parts, &self.falling) {
                parts.record(frame, self.ticks())?;
                self.bending.as_ref().map_or(Ok(()), |bending| bending.record(frame, self.ticks()))?;
                falling.record(frame, self.ticks())?;
            }
            if let Some(puddle) = &self.puddle {
                puddle.record(frame, tick)?;
            }
            if let Some(flames) = &self.flames {
                flames.record(frame, tick)?;
            }
            if mapped_tick == Some(self.ticks()) {
                self.vertex_mapping.record(frame, tick, self.shown)?;
            }
            self.surface_removal.mark(frame, self.ticks())?;
            self.is_shaded = false;
        }
        Ok(())
    }

    /// Ping-pong index of the buffers that the last whole tick wrote.
    fn newest(&self) -> usize {
        (self.ticks() % 2) as usize
    }

    /// The method and every number.
    pub fn made_of(&self) -> (Variant, &Parameters) {
        (self.variant, &self.parameters)
    }

    /// The object, prepared.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The refinement pattern, of an object that is refined.
    pub fn refinement(&self) -> Option<&Refinement> {
        self.refinement.as_ref()
    }

    /// Every buffer.
    pub fn buffers(&self) -> &Buffers {
        &self.buffers
    }

    /// Position and L of the last whole tick, and the rotations of its blocks.
    pub fn state(&self) -> (&Arc<crate::gpu::Buffer>, &Arc<crate::gpu::Buffer>) {
        let newest = self.newest();
        (&self.buffers.states[newest], &self.buffers.rotations[newest])
    }

    /// Fire and smoke, where there is any.
    pub fn flames(&self) -> Option<&Flames> {
        self.flames.as_ref()
    }

    /// Sets the camera, the light of the flames, the exposure and the tone of the next frames; false where another level
    /// of detail suits the camera, which is built in. The caller has validated them.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn set_seen(&mut self, seen: &Parameters) -> Result<bool, Error> {
        let Parameters { camera, fire_light, exposure, tone, .. } = *seen;
        let parameters = Parameters { camera, fire_light, exposure, tone, ..self.parameters.clone() };
        let level = |of: &Parameters| refinement::drawn_level(of, &self.model, self.model.levels);
        if self.refinement.is_some() && level(&parameters) != level(&self.parameters) {
            return Ok(false);
        }
        let camera = framing::camera(&parameters, &self.model);
        self.draw.set_camera(&parameters, camera)?;
        if let Some(flames) = &self.flames {
            flames.set_camera(&parameters, &camera)?;
        }
        if let Some(tone) = &mut self.tone {
            tone.set_tone(&parameters);
        }
        self.parameters = parameters;
        Ok(true)
    }

    /// The camera of the picture.
    pub fn camera(&self) -> &Camera {
        &self.draw.camera
    }

    /// The counts of the device up to the last frame.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn counts(&self) -> Result<Counts, Error> {
        let bytes = read_buffer(&self.device, &self.buffers.clock)?;
        Ok(bytemuck::pod_read_unaligned(&bytes[..size_of::<Counts>()]))
    }
}

impl Paper for Burning {
    fn restart(&mut self) -> Result<(), Error> {
        self.buffers.restore(&self.device)?;
        self.slices = self.start_slices;
        self.next_frame = 0;
        self.shown = Shown::NONE;
        self.is_shaded = false;
        Ok(())
    }

    /// Frame `number` shows the object after all ticks that are due by its end. A frame with several ticks maps,
    /// compacts and shades after the last; one without draws the last one's again.
    ///
    /// # Errors
    /// Those of the Vulkan layer; [`Error::Pass`] for a frame before the last without a restart between them.
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        if number < self.next_frame {
            let problem =
                format!("frame {number} comes before frame {}, the next; restart the paper first", self.next_frame);
            return Err(Error::Pass { pass: "heat-boundary".into(), problem });
        }
        self.next_frame = number + 1;
        let due = self.parameters.slices_due(number);
        if due > self.slices + MOST_SLICES {
            self.burn_until(due - MOST_SLICES)?;
        }
        if let Some(loading) = &self.loading {
            loading.record(frame)?;
        }
        let shown_tick = due / u64::from(self.parameters.time_division);
        let ends_a_tick = self.ticks() < shown_tick;
        self.simulate(frame, due, Some(shown_tick))?;
        if !self.is_shaded {
            let newest = self.newest();
            if !ends_a_tick {
                self.vertex_mapping.record(frame, newest, self.shown)?;
            }
            self.surface_removal.compact(frame, newest)?;
            self.normals.record(frame, self.shown)?;
            self.shown = Shown::after(self.ticks());
            self.is_shaded = true;
        }
        if let Some(flame_lights) = &self.flame_lights {
            flame_lights.record(frame)?;
        }
        self.draw.record(frame)?;
        if let Some(draw_wire) = &self.draw_wire {
            draw_wire.record(frame)?;
        }
        if let Some(draw_ground) = &self.draw_ground {
            draw_ground.record(frame)?;
        }
        if let Some(draw_puddle) = &self.draw_puddle {
            draw_puddle.record(frame, self.newest())?;
        }
        if let Some(draw_fire) = &mut self.draw_fire {
            draw_fire.record(frame)?;
        }
        if let Some(tone) = &self.tone {
            tone.record(frame)?;
        }
        Ok(())
    }

    /// The passes that advance the state have nothing to do.
    fn repeat(&mut self) -> bool {
        self.next_frame = self.next_frame.saturating_sub(1);
        true
    }

    fn advance(&mut self, frame: &mut Frame<'_>, number: u32, most: u32) -> Result<u32, Error> {
        let due = number.checked_sub(1).map_or(self.start_slices, |before| self.parameters.slices_due(before));
        self.simulate(frame, due.min(self.slices + u64::from(most)), None)?;
        Ok(u32::try_from(due.saturating_sub(self.slices)).unwrap_or(u32::MAX))
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    fn warnings(&self) -> Vec<String> {
        warnings::warnings(self)
    }

    fn camera(&self) -> Option<Camera> {
        Some(self.draw.camera)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.draw.picture
    }

    fn targets(&self) -> Vec<Target> {
        targets::targets(self)
    }
}
