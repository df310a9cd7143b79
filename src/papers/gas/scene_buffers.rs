//! The scene on the device: all meshes together, volumes, lights, and what changes from frame to frame.

use std::sync::Arc;

use ash::vk;

use super::blocks::{CountsBlock, FrameBlock, GasUse, LightBlock, ObjectBlock, VolumeBlock, offsets};
use super::blue_noise;
use super::capacity::Capacity;
use super::context::Context;
use super::grid_buffers::GridBuffers;
use super::model::Object;
use super::parameters::{Jitter, Parameters};
use super::pieces::{Piece, pieces};
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, BufferDesc, Error, Location};

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;

/// Buffers of the scene, by the names the shaders give them.
pub struct SceneBuffers {
    /// One [`FrameBlock`].
    pub frame: Arc<Buffer>,
    /// One [`CountsBlock`].
    pub counts: Arc<Buffer>,
    /// Volumes and the solid textures of surfaces, [`VolumeBlock`]s.
    pub volumes: Arc<Buffer>,
    /// [`LightBlock`]s.
    pub lights: Arc<Buffer>,
    /// The random table of the fog's front, floats.
    pub offsets: Arc<Buffer>,
    /// The grids of the volumes, where they are of files.
    grids: Option<GridBuffers>,
    /// The mask of blue noise, if it is used: ranks.
    pub jitter: Arc<Buffer>,
    /// Triangles of all objects with their vertices, at least one.
    pub pieces: Vec<Piece>,
    /// [`ObjectBlock`]s.
    pub objects: Arc<Buffer>,
    /// The objects without their meshes.
    objects_without_meshes: Vec<Object>,
}

impl SceneBuffers {
    /// # Errors
    /// [`Error::Limit`] for meshes beyond what the device binds; what Vulkan answers.
    pub fn new(context: &Context<'_>, objects: &[Object]) -> Result<Self, Error> {
        let (device, parameters) = (context.shaders.device(), context.parameters);
        // Scenes are small: beyond a limit is a mesh of the user's alone.
        let storage = |what: &str, bytes: &[u8]| {
            upload(device, &context.name(what), STORAGE, bytes).map_err(|error| error.set_by("object"))
        };
        let mut volumes: Vec<VolumeBlock> =
            parameters.volumes.iter().map(|v| VolumeBlock::of_volume(v, parameters.steps)).collect();
        volumes.extend(objects.iter().flat_map(Object::solid_textures).map(VolumeBlock::of_texture));
        if volumes.is_empty() {
            volumes.push(bytemuck::Zeroable::zeroed());
        }
        let lights: Vec<LightBlock> = parameters.lights.iter().map(LightBlock::from).collect();
        let mask = match parameters.jitter {
            Jitter::Random => vec![0],
            Jitter::BlueNoise => blue_noise::mask(parameters.seed),
        };
        let mapped = |what: &str, bytes: usize, usage| {
            Buffer::new(
                device,
                BufferDesc::new(context.name(what), bytes as u64).usage(usage).location(Location::Upload),
            )
        };
        let grids = parameters.volume_grids().map(|grids| GridBuffers::new(context, &grids)).transpose()?;
        Ok(SceneBuffers {
            grids,
            frame: mapped("frame", size_of::<FrameBlock>(), vk::BufferUsageFlags::UNIFORM_BUFFER)?,
            counts: mapped("counts", size_of::<CountsBlock>(), STORAGE)?,
            volumes: storage("volumes", bytemuck::cast_slice(&volumes))?,
            lights: storage("lights", bytemuck::cast_slice(&lights))?,
            offsets: storage("offsets", bytemuck::cast_slice(&offsets(parameters.seed)))?,
            jitter: storage("jitter", bytemuck::cast_slice(&mask))?,
            pieces: pieces(context, objects)?,
            objects: mapped("objects", size_of::<ObjectBlock>() * objects.len().max(1), STORAGE)?,
            objects_without_meshes: objects.iter().map(Object::without_mesh).collect(),
        })
    }

    /// A pass with the samples of files, where densities are taken from them.
    pub fn samples(&self, pass: PassBuilder) -> PassBuilder {
        match &self.grids {
            Some(grids) => pass.with("Grids", &grids.grids).with("Samples", &grids.samples),
            None => pass,
        }
    }

    /// A pass with the light of a file's temperatures, where its densities are taken from files themselves.
    pub fn glow(&self, parameters: &Parameters, pass: PassBuilder) -> PassBuilder {
        match &self.grids {
            Some(grids) if parameters.density_cache.is_none() => pass.with("Glow", &grids.glow),
            _ => pass,
        }
    }

    /// Some surface is a gas.
    pub fn has_surface_gas(&self) -> bool {
        self.objects_without_meshes.iter().any(|object| object.gas.is_some())
    }

    /// Some surface has veins.
    pub fn has_veins(&self) -> bool {
        self.objects_without_meshes.iter().any(|object| object.veins.is_some())
    }

    /// A pass with the solid textures of surfaces.
    pub fn solid_textures(&self, pass: PassBuilder) -> PassBuilder {
        pass.with("Volumes", &self.volumes).with("Offsets", &self.offsets)
    }

    /// A pass with what its shader takes densities from.
    pub fn densities(&self, pass: PassBuilder) -> PassBuilder {
        match &self.grids {
            Some(_) => self.samples(pass),
            None => pass.with("Offsets", &self.offsets),
        }
    }

    /// Writes the frame and the objects of the scene's frame `number`; the device is idle.
    pub fn write(&self, parameters: &Parameters, number: u32, gas: GasUse, capacity: Capacity) -> Result<(), Error> {
        let block = FrameBlock::new(parameters, number, capacity);
        self.frame.write(0, bytemuck::bytes_of(&block))?;
        self.counts.write(0, bytemuck::bytes_of(&CountsBlock::new(parameters, gas, capacity)))?;
        let mut textures = parameters.volumes.len()..;
        let mut blocks: Vec<ObjectBlock> =
            self.objects_without_meshes.iter().map(|o| ObjectBlock::new(o, number, &mut textures)).collect();
        if blocks.is_empty() {
            blocks.push(bytemuck::Zeroable::zeroed());
        }
        self.objects.write(0, bytemuck::cast_slice(&blocks))
    }
}
