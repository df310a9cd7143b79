//! Draws the interface: its triangles in one pass of the project's own layer, in the interface's own order.

use std::collections::HashMap;
use std::sync::Arc;

use ash::vk;
use egui::epaint::{ClippedPrimitive, ImageData, ImageDelta, Mesh, Primitive};
use egui::{TextureFilter, TextureId};

use crate::gpu::transfer::{copy_rectangle, upload_rows};
use crate::gpu::{
    Blend, Buffer, BufferDesc, Compiler, Device, Error, Image, ImageDesc, ImageView, Load, Location, Mode, Pass,
    Recorder, Sampler, ShaderLibrary,
};
use crate::host_block;

host_block! {
    /// Corner of a triangle.
    struct Corner {
        place: [f32; 2],
        texel: [f32; 2],
        tint: u32,
    }
}

host_block! {
    struct Screen {
        pixels: [f32; 2],
    }
}

/// Draws the interface into a picture of the window's size.
pub struct Painter {
    recorder: Recorder,
    shaders: ShaderLibrary,
    samplers: [Arc<Sampler>; 2],
    textures: HashMap<TextureId, Texture>,
    corners: Arc<Buffer>,
    indices: Arc<Buffer>,
    target: Option<Target>,
    /// A pass of the target's format: all others share its pipeline.
    model: Option<Pass>,
    /// What was drawn last.
    drawn: (Vec<Corner>, Vec<u32>),
    runs: Vec<Run>,
    has_new_texels: bool,
}

/// A texture of the interface.
struct Texture {
    view: Arc<ImageView>,
    filter: TextureFilter,
    /// Draws with it, over what is there; made when it is first drawn with.
    pass: Option<Pass>,
}

/// The picture of the window.
struct Target {
    view: Arc<ImageView>,
    /// Draws with the texture of the interface's letters, after clearing.
    first: Option<Pass>,
    is_drawn: bool,
}

/// Triangles of one texture inside one rectangle.
#[derive(Debug, Clone, PartialEq)]
struct Run {
    texture: TextureId,
    clip: egui::Rect,
    first: u32,
    count: u32,
}

impl Painter {
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn new(device: &Arc<Device>) -> Result<Self, Error> {
        Ok(Painter {
            recorder: Recorder::new(device)?,
            shaders: ShaderLibrary::new(device, Compiler::Glslang, None)?,
            samplers: [
                Sampler::new(device, "interface nearest", vk::Filter::NEAREST)?,
                Sampler::new(device, "interface linear", vk::Filter::LINEAR)?,
            ],
            textures: HashMap::new(),
            corners: corners(device, 1 << 19)?,
            indices: indices(device, 1 << 18)?,
            target: None,
            model: None,
            drawn: Default::default(),
            runs: Vec::new(),
            has_new_texels: false,
        })
    }

    /// Takes new and changed textures over.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn update(&mut self, changes: &[(TextureId, ImageDelta)]) -> Result<(), Error> {
        for (id, delta) in changes {
            self.change(*id, delta)?;
        }
        Ok(())
    }

    /// Forgets textures.
    pub fn free(&mut self, ids: &[TextureId]) {
        ids.iter().for_each(|id| drop(self.textures.remove(id)));
    }

    fn change(&mut self, id: TextureId, delta: &ImageDelta) -> Result<(), Error> {
        self.has_new_texels = true;
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size.map(|side| side as u32);
        if width == 0 || height == 0 {
            return Ok(());
        }
        let fits = |view: &ImageView| (view.width(), view.height()) == (width, height);
        let pixels: &[u8] = bytemuck::cast_slice(&image.pixels);
        let row_bytes = width as usize * 4;
        let rows = |first: u32, bytes: &mut [u8]| {
            let start = first as usize * row_bytes;
            bytes.copy_from_slice(&pixels[start..start + bytes.len()]);
        };
        let device = self.shaders.device().clone();
        let fresh = |name: &str| -> Result<Arc<ImageView>, Error> {
            let desc = ImageDesc::new_2d(name, vk::Format::R8G8B8A8_UNORM, width, height);
            let view = Image::new(&device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
            upload_rows(&device, &view, (width, height), rows)?;
            Ok(view)
        };
        let filter = delta.options.magnification;
        match (delta.pos, self.textures.get_mut(&id)) {
            (Some([column, row]), Some(texture)) => {
                let patch = fresh("interface patch")?;
                copy_rectangle(&device, &patch, &texture.view, (column as u32, row as u32), (width, height))
            }
            (None, Some(texture)) if fits(&texture.view) && texture.filter == filter => {
                upload_rows(&device, &texture.view, (width, height), rows)
            }
            (None, _) => {
                let texture = Texture { view: fresh("interface texture")?, filter, pass: None };
                self.textures.insert(id, texture);
                if id == LETTERS
                    && let Some(target) = &mut self.target
                {
                    target.first = None;
                }
                Ok(())
            }
            // A patch of what was freed.
            (Some(_), None) => Ok(()),
        }
    }

    /// The window's picture as it was last drawn.
    pub fn picture(&self) -> Option<Arc<ImageView>> {
        self.target.as_ref().filter(|target| target.is_drawn).map(|target| target.view.clone())
    }

    /// Draws `primitives`, whose places are in points of `pixels_per_point`, into the window's picture, and gives it;
    /// `None` where it would be what it is.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn paint(
        &mut self,
        (width, height, format): (u32, u32, vk::Format),
        pixels_per_point: f32,
        primitives: &[ClippedPrimitive],
    ) -> Result<Option<Arc<ImageView>>, Error> {
        let view = self.sized(width, height, format)?;
        let has_changed = self.fill(primitives, pixels_per_point)?;
        if !has_changed && !self.has_new_texels && self.target.as_ref().is_some_and(|target| target.is_drawn) {
            return Ok(None);
        }
        let runs = std::mem::take(&mut self.runs);
        // The first clears, with or without triangles of its own.
        let mut groups = vec![(LETTERS, 0..0)];
        for (index, run) in runs.iter().enumerate() {
            match groups.last_mut() {
                Some((texture, range)) if *texture == run.texture => range.end = index + 1,
                _ => groups.push((run.texture, index..index + 1)),
            }
        }
        let mut passes = Vec::new();
        for (texture, range) in groups {
            passes.extend(self.pass(texture, passes.is_empty(), &view)?.map(|pass| (pass, range)));
        }
        let screen = Screen { pixels: [width as f32, height as f32] };
        self.recorder.run(Mode::Plain, |frame| {
            for (pass, range) in &passes {
                frame.graphics(pass, |draw| {
                    draw.constants(&screen);
                    for run in &runs[range.clone()] {
                        let low = |side: f32| (side * pixels_per_point).round().max(0.0) as u32;
                        let (left, top) = (low(run.clip.min.x), low(run.clip.min.y));
                        let (right, bottom) = (low(run.clip.max.x), low(run.clip.max.y));
                        let size = (right.saturating_sub(left), bottom.saturating_sub(top));
                        draw.scissor((left, top), size).indices_from(run.first, run.count);
                    }
                })?;
            }
            Ok::<(), Error>(())
        })?;
        self.runs = runs;
        self.has_new_texels = false;
        if let Some(target) = &mut self.target {
            target.is_drawn = true;
        }
        Ok(Some(view))
    }

    /// The window's picture in that size and format.
    fn sized(&mut self, width: u32, height: u32, format: vk::Format) -> Result<Arc<ImageView>, Error> {
        if let Some(target) = &self.target {
            let view = &target.view;
            if view.image().desc().format != format {
                self.model = None;
            } else if (view.width(), view.height()) == (width, height) {
                return Ok(view.clone());
            }
        }
        let desc = ImageDesc::new_2d("interface", format, width, height);
        let view = Image::new(self.shaders.device(), desc.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT))?.view()?;
        self.forget_passes();
        self.target = Some(Target { view: view.clone(), first: None, is_drawn: false });
        Ok(view)
    }

    /// The passes name the buffers and the picture: they are made anew with them.
    fn forget_passes(&mut self) {
        self.textures.values_mut().for_each(|texture| texture.pass = None);
        if let Some(target) = &mut self.target {
            target.first = None;
        }
    }

    /// Writes corners and indices into the buffers, made larger where they must be; false where all is as it was.
    fn fill(&mut self, primitives: &[ClippedPrimitive], pixels_per_point: f32) -> Result<bool, Error> {
        let meshes = primitives.iter().filter_map(|clipped| match &clipped.primitive {
            Primitive::Mesh(mesh) if !mesh.indices.is_empty() => Some((clipped.clip_rect, mesh)),
            _ => None,
        });
        let (mut all, mut order, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        for (clip, Mesh { vertices, indices, texture_id }) in meshes {
            let base = all.len() as u32;
            all.extend(vertices.iter().map(|vertex| Corner {
                place: [vertex.pos.x * pixels_per_point, vertex.pos.y * pixels_per_point],
                texel: [vertex.uv.x, vertex.uv.y],
                tint: u32::from_le_bytes(vertex.color.to_array()),
            }));
            let (first, count) = (order.len() as u32, indices.len() as u32);
            order.extend(indices.iter().map(|index| base + index));
            runs.push(Run { texture: *texture_id, clip, first, count });
        }
        let bytes_of = bytemuck::cast_slice::<Corner, u8>;
        if bytes_of(&all) == bytes_of(&self.drawn.0) && order == self.drawn.1 && runs == self.runs {
            return Ok(false);
        }
        let device = self.shaders.device().clone();
        let (wanted_corners, wanted_indices) = (bytes_of(&all), bytemuck::cast_slice(&order));
        if self.corners.size_bytes() < wanted_corners.len() as u64 {
            self.corners = corners(&device, wanted_corners.len() as u64 * 2)?;
            self.forget_passes();
        }
        if self.indices.size_bytes() < wanted_indices.len() as u64 {
            self.indices = self::indices(&device, wanted_indices.len() as u64 * 2)?;
            self.forget_passes();
        }
        self.corners.write(0, wanted_corners)?;
        self.indices.write(0, wanted_indices)?;
        self.drawn = (all, order);
        self.runs = runs;
        Ok(true)
    }

    /// The pass that draws with a texture; `None` for one that is not there.
    fn pass(&mut self, id: TextureId, is_first: bool, target: &Arc<ImageView>) -> Result<Option<Pass>, Error> {
        let Some(texture) = self.textures.get(&id) else { return Ok(None) };
        let made = if is_first { self.target.as_ref().and_then(|t| t.first.clone()) } else { texture.pass.clone() };
        if made.is_some() {
            return Ok(made);
        }
        let sampler = &self.samplers[usize::from(texture.filter == TextureFilter::Linear)];
        let load = if is_first { Load::Clear([0.0, 0.0, 0.0, 1.0]) } else { Load::Keep };
        let pass = match &self.model {
            Some(model) => model
                .rebind()
                .vertices(&self.corners)
                .indices(&self.indices)
                .with("picture", &texture.view)
                .with("picture_sampler", sampler)
                .color(0, target, load)
                .build(&self.shaders)?,
            None => Pass::graphics("interface", "", "window/interface.vert", "window/interface.frag")
                .vertices::<Corner>(&self.corners)
                .indices(&self.indices)
                .constants::<Screen>()
                .with("picture", &texture.view)
                .with("picture_sampler", sampler)
                .color(target, load, Blend::Premultiplied)
                .build(&self.shaders)?,
        };
        self.model.get_or_insert_with(|| pass.clone());
        match self.textures.get_mut(&id) {
            Some(texture) if !is_first => texture.pass = Some(pass.clone()),
            _ => {
                if let Some(target) = &mut self.target {
                    target.first = Some(pass.clone());
                }
            }
        }
        Ok(Some(pass))
    }
}

/// The texture of the interface's letters and fills.
const LETTERS: TextureId = TextureId::Managed(0);

fn corners(device: &Arc<Device>, size_bytes: u64) -> Result<Arc<Buffer>, Error> {
    filled(device, BufferDesc::new("interface corners", size_bytes).usage(vk::BufferUsageFlags::VERTEX_BUFFER))
}

fn indices(device: &Arc<Device>, size_bytes: u64) -> Result<Arc<Buffer>, Error> {
    filled(device, BufferDesc::new("interface indices", size_bytes).usage(vk::BufferUsageFlags::INDEX_BUFFER))
}

/// A mapped buffer of zeros: a pass reads all of what it binds.
fn filled(device: &Arc<Device>, desc: BufferDesc) -> Result<Arc<Buffer>, Error> {
    let buffer = Buffer::new(device, desc.location(Location::Upload))?;
    buffer.write(0, &vec![0; buffer.size_bytes() as usize])?;
    Ok(buffer)
}
