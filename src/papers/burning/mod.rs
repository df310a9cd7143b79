//! `burning`: D. E. Amarasinghe's burning and melting objects, chapters 3 to 6.
//!
//! ```text
//! each tick of 1/60 s:
//!   heat-boundary ─► (refinement) ─► internal-deformation ─► block-weights ─► block-rotation ─► flames ─┐
//!     ┌──────────────────────────────────────────────────────────────────────────────────────────────┘
//! each frame:
//!     └─► vertex-mapping ─► surface-removal ─► normals ─► draw ─► draw-fire
//! ```
//!
//! The simulation advances in ticks alone, so its state depends on the simulated time and not on the frame rate; the state lives on
//! the device, and a frame sends it constants at most (3.7.4).

mod blocks;
mod deformation;
mod drawing;
pub mod experiments;
mod flames;
mod framing;
mod heat;
#[cfg(test)]
mod layouts;
mod loading;
pub mod model;
mod normals;
pub mod parameters;
pub mod reference;
mod refinement;
mod removal;
pub mod setup;
mod state;
mod texture;
mod wire;

use std::sync::Arc;

use self::blocks::Blocks;
use self::deformation::Deformation;
use self::drawing::Drawing;
use self::heat::HeatBoundary;
use self::loading::Loading;
use self::model::Model;
use self::normals::Normals;
use self::refinement::Refinement;
use self::removal::SurfaceRemoval;
use self::wire::Wire;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Device, Error, Feature, Frame, ImageView, Mode, Recorder, ShaderLibrary};
use crate::measure::{Paper, Target};
use crate::scene::{Camera, Mesh};

pub use self::flames::{Flames, Group, Particle};
pub use self::framing::seen_from;
pub use self::parameters::{Material, Parameters, Shading, TICKS_PER_S, Variant};
pub use self::state::{BlockCounts, Buffers, Counts, RestVertex, VertexState};
pub use self::texture::{Level, Texture};

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 0] = [];

/// Slices that one frame records at most, more than the longest time step has: those of frames that are left out before a late
/// picture would not fit into memory at once.
const MOST_SLICES: u64 = 1024;

/// The paper under one variant.
pub struct Burning {
    device: Arc<Device>,
    variant: Variant,
    parameters: Parameters,
    model: Model,
    buffers: Buffers,
    loading: Option<Loading>,
    heat: HeatBoundary,
    refinement: Option<Refinement>,
    deformation: Deformation,
    blocks: Blocks,
    removal: SurfaceRemoval,
    normals: Normals,
    drawing: Drawing,
    wire: Option<Wire>,
    flames: Option<Flames>,
    /// Slices of ticks since the fire was lit, and at the start.
    slices: u64,
    start_slices: u64,
    next_frame: u32,
    /// Whether the stream and the normals are those of the state.
    is_shaded: bool,
}

impl Burning {
    /// Makes every resource and pass and burns up to the first frame; `label` goes before the names of the resources.
    ///
    /// # Errors
    /// What the Vulkan layer answers. The caller has validated `parameters` and `mesh`.
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
        let refinement = if variant.refines() && model.levels > 0 {
            Some(Refinement::new(shaders, label, parameters, &mut buffers, &model)?)
        } else {
            None
        };
        let drawing = Drawing::new(shaders, label, parameters, &buffers, &model)?;
        let wire = match parameters.shading {
            Shading::Wire => Some(Wire::new(shaders, &buffers, &drawing, &model)?),
            _ => None,
        };
        let flames = Flames::new(shaders, label, parameters, &mut buffers, &model, &drawing)?;
        let loading = if parameters.preload { None } else { Some(Loading::new(device, &buffers)?) };
        let mut burning = Burning {
            device: device.clone(),
            variant,
            loading,
            heat: HeatBoundary::new(shaders, &buffers, &model)?,
            deformation: Deformation::new(shaders, variant, &buffers, &model)?,
            blocks: Blocks::new(shaders, &buffers, &model)?,
            removal: SurfaceRemoval::new(shaders, label, variant, &buffers, refinement.as_ref(), &model)?,
            refinement,
            normals: Normals::new(shaders, &buffers, &model)?,
            drawing,
            wire,
            flames,
            parameters: parameters.clone(),
            model,
            buffers,
            slices: 0,
            start_slices: 0,
            next_frame: 0,
            is_shaded: false,
        };
        burning.burn_to_first_frame()?;
        Ok(burning)
    }

    /// What was there before frame 0 becomes the start.
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
            recorder.run(Mode::Plain, |frame| self.simulate(frame, end))?;
            self.is_shaded = false;
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
    /// What the Vulkan layer answers.
    pub fn tick(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let end = (self.ticks() + 1) * u64::from(self.parameters.time_division);
        self.is_shaded = false;
        self.simulate(frame, end)
    }

    fn simulate(&mut self, frame: &mut Frame<'_>, slices: u64) -> Result<(), Error> {
        while self.slices < slices {
            if self.slice(frame)? {
                self.removal.mark(frame, self.turn())?;
            }
        }
        Ok(())
    }

    /// Records the next slice of a tick, all but the marks of surface-removal; whether it was the tick's last.
    fn slice(&mut self, frame: &mut Frame<'_>) -> Result<bool, Error> {
        let parts = self.parameters.time_division;
        let part = (self.slices % u64::from(parts)) as u32;
        let turn = 1 - self.turn();
        if part == 0 {
            self.heat.record(frame, turn)?;
            if let Some(refinement) = &self.refinement {
                refinement.record(frame)?;
            }
        }
        self.deformation.record(frame, turn, part, parts)?;
        let is_last = part + 1 == parts;
        if is_last {
            self.blocks.record(frame, turn)?;
            if let Some(flames) = &self.flames {
                flames.record(frame, turn)?;
            }
        }
        self.slices += 1;
        Ok(is_last)
    }

    /// Which buffer holds the state of the last whole tick.
    fn turn(&self) -> usize {
        (self.ticks() % 2) as usize
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
        let turn = self.turn();
        (&self.buffers.states[turn], &self.buffers.rotations[turn])
    }

    /// Fire and smoke, where there is any.
    pub fn flames(&self) -> Option<&Flames> {
        self.flames.as_ref()
    }

    pub fn camera(&self) -> &Camera {
        &self.drawing.camera
    }

    /// What the device has counted up to the last frame.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
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
        self.is_shaded = false;
        Ok(())
    }

    /// Frame `number` shows the object after all ticks that are due by its end. A frame with several ticks maps, compacts and
    /// shades after the last; one without draws the last one's again.
    ///
    /// # Errors
    /// What the Vulkan layer answers; [`Error::Pass`] for a frame before the last without a restart between them.
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
        let last_tick = due / u64::from(self.parameters.time_division);
        let mut is_mapped = self.is_shaded;
        while self.slices < due {
            if self.slice(frame)? {
                self.is_shaded = false;
                is_mapped = self.ticks() == last_tick;
                if is_mapped {
                    self.blocks.map(frame, self.turn())?;
                }
                self.removal.mark(frame, self.turn())?;
            }
        }
        if !self.is_shaded {
            if !is_mapped {
                self.blocks.map(frame, self.turn())?;
            }
            self.removal.compact(frame, self.turn())?;
            self.normals.record(frame)?;
            self.is_shaded = true;
        }
        self.drawing.record(frame)?;
        if let Some(wire) = &self.wire {
            wire.record(frame)?;
        }
        match &self.flames {
            Some(flames) => flames.draw(frame),
            None => Ok(()),
        }
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.model.degenerate > 0 {
            let count = self.model.degenerate;
            warnings.push(format!("{count} triangles of the mesh have two corners in one place and are left out"));
        }
        if self.variant == Variant::Solid && !self.model.is_closed {
            warnings.push(
                "the mesh is not closed: how deep a solid chars follows from the volume that it encloses; close it, or burn it \
                 as `shell`"
                    .to_owned(),
            );
        }
        let nearest = self.model.rest.iter().map(|vertex| vertex.boundary_distance).fold(f32::INFINITY, f32::min);
        let radius = self.parameters.speed_per_s * (self.ticks() as f64 / TICKS_PER_S) as f32;
        if self.ticks() > 0 && nearest > radius {
            warnings.push(format!(
                "nothing burns: the heat boundary has a radius of {radius} after {} ticks, and the object begins at \
                 {nearest}; move --source nearer or burn longer",
                self.ticks()
            ));
        }
        warnings
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.drawing.picture
    }

    fn targets(&self) -> Vec<Target> {
        let (state, rotations) = self.state();
        let buffers = &self.buffers;
        let mut targets = vec![
            Target::table("rest", &buffers.rest, 4),
            Target::table("state", state, 4),
            Target::words("labels", &buffers.labels, 1),
            Target::words("triangle-labels", &buffers.triangle_labels, 1),
            Target::words("alive", &buffers.alive, 1),
            Target::words("removed", &buffers.removed, 1),
            Target::words("cells", &buffers.cells, 1),
            Target::integers("blocks", &buffers.blocks, 8),
            Target::table("rotations", rotations, 4),
            Target::table("mapped", &buffers.mapped, 4),
            Target::table("normals", &buffers.normals, 4),
            Target::table("colors", &buffers.colors, 4),
            Target::image("depth", &self.drawing.depth),
            Target::image("picture", &self.drawing.picture),
        ];
        if let Some(refinement) = &self.refinement {
            targets.push(Target::integers("statuses", &refinement.statuses, 1));
        }
        if let Some(surface) = &self.drawing.surface {
            targets.push(Target::table("texture-coordinates", &surface.coordinates, 2));
        }
        if let Some(flames) = &self.flames {
            targets.push(Target::words("flame-groups", &flames.groups, 4));
            targets.push(Target::table("particles", &flames.particles, 8));
        }
        targets
    }
}
