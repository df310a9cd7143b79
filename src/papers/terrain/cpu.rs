//! Section 4's first application: everything on the processor, by rows on all cores.

use std::sync::Arc;

use ash::vk;
use glam::Vec4;
use rayon::prelude::*;

use super::blocks::TerrainBlock;
use super::caster::{Caster, Footprint};
use super::drape::Drape;
use super::hit::{Hit, NO_DEPTH, Surface};
use super::parameters::{Interpolation, Parameters};
use super::pyramid::Texel;
use super::relief::{Field, FieldWork, Relief};
use super::scene::Seen;
use super::shading::{color_of, normal_of};
use super::stage::Stage;
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, ImageView, Load, Location};
use crate::gpu::{Pass, PassInfo, ShaderLibrary};
use crate::host_block;
use crate::measure::Target;
use crate::scene::HeightMap;

host_block! {
    struct Size {
        columns: u32,
    }
}

const SKY: Hit = Hit { depth_m: NO_DEPTH, place: [0.0; 2], surface: Surface::Sky, shift: 0, map: 0, steps: 0 };

/// What the passes of the processor write, and how its picture gets to the device.
pub struct Cpu {
    width: u32,
    footprint: Footprint,
    interpolation: Interpolation,
    reliefs: Vec<Relief>,
    drape: Option<Drape>,
    hits: Vec<Hit>,
    normals: Vec<Vec4>,
    /// What is left of the sunlight; empty where no shadows are thrown.
    sunlit: Vec<f32>,
    colors: Vec<[u8; 4]>,
    infos: [Arc<PassInfo>; 4],
    shown: Shown,
}

/// Copies of the targets that the device can read.
struct Shown {
    depth: Arc<Buffer>,
    normal: Arc<Buffer>,
    colors: Arc<Buffer>,
    picture: Arc<ImageView>,
    found: Arc<ImageView>,
    show: Pass,
}

impl Cpu {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        maps: &[Arc<HeightMap>],
        drape: Option<&Drape>,
    ) -> Result<Self, Error> {
        let (width, height) = (parameters.width, parameters.height);
        let device = shaders.device();
        let pixels = u64::from(width) * u64::from(height);
        let buffer = |name: &str, pixel_bytes: u64| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let desc = BufferDesc::new(format!("{label}/{name}"), pixels * pixel_bytes).usage(usage);
            Buffer::new(device, desc.location(Location::Upload))
        };
        let colors = buffer("colors", 4)?;
        let image =
            |name: &str, format| Stage::Fragment.image(device, format!("{label}/{name}"), format, (width, height));
        let picture = image("picture", vk::Format::R8G8B8A8_UNORM)?;
        let found = image("depth", vk::Format::R32G32B32A32_SFLOAT)?;
        let depth = buffer("depth", 16)?;
        let show = Pass::graphics("show", "4", "common/fullscreen.vert", "terrain/show.frag")
            .with("colors", &colors)
            .with("depths", &depth)
            .constants::<Size>()
            .color(&picture, Load::Discard, Blend::Replace)
            .color(&found, Load::Discard, Blend::Replace)
            .build(shaders)?;
        let shown = Shown { depth, normal: buffer("normal", 16)?, colors, picture, found, show };
        let infos = [
            PassInfo::host("depth", "3", &["land", "levels"], &["depth"]),
            PassInfo::host("normal", "4", &["land", "levels", "depth"], &["normal"]),
            PassInfo::host("shadow", "2", &["land", "levels", "depth"], &["shadow"]),
            PassInfo::host("illumination", "4", &["light", "depth", "normal"], &["picture"]),
        ];
        let count = pixels as usize;
        Ok(Cpu {
            width,
            footprint: parameters.lod.into(),
            interpolation: parameters.interpolation,
            reliefs: maps.iter().map(|map| Relief::new(map, parameters.interpolation)).collect(),
            drape: drape.cloned(),
            sunlit: if parameters.shadows { vec![1.0; count] } else { Vec::new() },
            hits: vec![SKY; count],
            normals: vec![Vec4::ZERO; count],
            colors: vec![[0; 4]; count],
            infos,
            shown,
        })
    }

    /// The three passes.
    pub fn record(&mut self, frame: &mut Frame<'_>, seen: &Seen) {
        let Cpu {
            width,
            footprint,
            interpolation,
            ref reliefs,
            ref drape,
            ref mut sunlit,
            ref mut hits,
            ref mut normals,
            ref mut colors,
            ref infos,
            ..
        } = *self;
        let maps = || reliefs.iter().zip(&seen.terrains);
        frame.host(&infos[0], || {
            hits.par_iter_mut().for_each(|hit| *hit = SKY);
            for (relief, terrain) in maps() {
                relief.with(Depths { terrain, footprint, interpolation, width, hits });
            }
        });
        frame.host(&infos[1], || {
            for (index, (relief, terrain)) in maps().enumerate() {
                relief.with(Normals { terrain, interpolation, width, map: index as u32, hits, normals });
            }
        });
        if !sunlit.is_empty() {
            frame.host(&infos[2], || {
                sunlit.par_iter_mut().for_each(|sunlit| *sunlit = 1.0);
                for (relief, terrain) in maps() {
                    relief.with(Shadows { terrain, interpolation, width, hits, sunlit });
                }
            });
        }
        frame.host(&infos[3], || {
            let rows = colors.par_chunks_mut(width as usize).enumerate();
            rows.for_each(|(y, row)| {
                for (x, color) in row.iter_mut().enumerate() {
                    let pixel = y * width as usize + x;
                    let sunlit = sunlit.get(pixel).copied().unwrap_or(1.0);
                    let place = (x as u32, y as u32);
                    *color = color_of(&seen.light, drape.as_ref(), place, &hits[pixel], normals[pixel], sunlit);
                }
            });
        });
    }

    /// Puts the targets where the device can read them, and draws the picture's bytes into an image.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn show(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let depths: Vec<[f32; 4]> = self.hits.iter().map(|hit| hit.to_texel()).collect();
        self.shown.depth.write(0, bytemuck::cast_slice(&depths))?;
        self.shown.normal.write(0, bytemuck::cast_slice(&self.normals))?;
        self.shown.colors.write(0, bytemuck::cast_slice(&self.colors))?;
        frame.graphics(&self.shown.show, |draw| {
            draw.constants(&Size { columns: self.width }).vertices(3);
        })
    }

    /// What [`Cpu::show`] wrote of the depths.
    pub fn depth(&self) -> &Arc<ImageView> {
        &self.shown.found
    }

    pub fn picture(&self) -> &Arc<ImageView> {
        &self.shown.picture
    }

    pub fn targets(&self) -> Vec<Target> {
        vec![Target::table("depth", &self.shown.depth, 4), Target::table("normal", &self.shown.normal, 4)]
    }
}

struct Depths<'a> {
    terrain: &'a TerrainBlock,
    footprint: Footprint,
    interpolation: Interpolation,
    width: u32,
    hits: &'a mut [Hit],
}

impl FieldWork for Depths<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let caster =
            Caster { terrain: self.terrain, field, footprint: self.footprint, interpolation: self.interpolation };
        self.hits.par_chunks_mut(self.width as usize).enumerate().for_each(|(y, row)| {
            for (x, hit) in row.iter_mut().enumerate() {
                *hit = caster.find(caster.direction(x as u32, y as u32), *hit);
            }
        });
    }
}

struct Shadows<'a> {
    terrain: &'a TerrainBlock,
    interpolation: Interpolation,
    width: u32,
    hits: &'a [Hit],
    sunlit: &'a mut [f32],
}

impl FieldWork for Shadows<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let width = self.width as usize;
        let footprint = Footprint::Data;
        let caster = Caster { terrain: self.terrain, field, footprint, interpolation: self.interpolation };
        self.sunlit.par_chunks_mut(width).zip(self.hits.par_chunks(width)).enumerate().for_each(|(y, (row, hits))| {
            for (x, (sunlit, hit)) in row.iter_mut().zip(hits).enumerate() {
                if hit.surface != Surface::Sky && caster.is_shadowed(caster.direction(x as u32, y as u32), hit) {
                    *sunlit = 0.0;
                }
            }
        });
    }
}

struct Normals<'a> {
    terrain: &'a TerrainBlock,
    interpolation: Interpolation,
    width: u32,
    map: u32,
    hits: &'a [Hit],
    normals: &'a mut [Vec4],
}

impl FieldWork for Normals<'_> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let width = self.width as usize;
        let caster =
            Caster { terrain: self.terrain, field, footprint: Footprint::Data, interpolation: self.interpolation };
        self.normals.par_chunks_mut(width).zip(self.hits.par_chunks(width)).enumerate().for_each(|(y, (row, hits))| {
            for (x, (normal, hit)) in row.iter_mut().zip(hits).enumerate().filter(|(_, (_, hit))| hit.map == self.map) {
                *normal = normal_of(&caster, caster.direction(x as u32, y as u32), hit);
            }
        });
    }
}
