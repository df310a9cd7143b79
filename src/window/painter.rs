//! Draws the interface: its triangles in passes of the project's own layer, in the interface's own order, where it has
//! changed.

use std::collections::{HashMap, HashSet, VecDeque};
use std::sync::Arc;

use ash::vk;
use egui::epaint::{ClippedPrimitive, ClippedShape, ImageData, ImageDelta, Mesh, Primitive};
use egui::{ColorImage, TextureFilter, TextureId};

use super::area::Area;
use super::damage::{Canvas, Sheet};
use crate::gpu::transfer::{copy_rectangle, upload_rectangle, upload_rows};
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
    canvas: Canvas,
    /// Textures that have changed since the shapes were last taken over.
    redrawn: HashSet<TextureId>,
    /// Texels on their way to the window's picture.
    bytes: Vec<[u8; 4]>,
    staging: Option<Arc<Buffer>>,
}

/// A texture of the interface.
struct Texture {
    /// Absent where it was only copied to the window so far.
    view: Option<Arc<ImageView>>,
    /// Texels that the view does not hold yet.
    waiting: Option<Arc<ColorImage>>,
    size: [usize; 2],
    filter: TextureFilter,
    /// No texel lets anything through.
    is_opaque: bool,
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
struct Run {
    texture: TextureId,
    area: Area,
    first: u32,
    count: u32,
}

/// Meshes of one frame, in the buffers' order.
#[derive(Default)]
struct Batch {
    corners: Vec<Corner>,
    indices: Vec<u32>,
    /// The runs of each rectangle, in the interface's order.
    runs: Vec<VecDeque<Run>>,
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
            canvas: Canvas::default(),
            redrawn: HashSet::new(),
            bytes: Vec::new(),
            staging: None,
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
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size;
        if width == 0 || height == 0 {
            return Ok(());
        }
        // New letters beside those that are there change nothing.
        if id != LETTERS {
            self.redrawn.insert(id);
        } else if delta.pos.is_none() {
            self.canvas.forget();
        }
        let is_opaque = image.pixels.iter().fold(u8::MAX, |least, pixel| least & pixel.a()) == u8::MAX;
        let filter = delta.options.magnification;
        match (delta.pos, self.textures.get_mut(&id)) {
            (Some([column, row]), Some(texture)) => {
                texture.is_opaque &= is_opaque;
                let device = self.shaders.device().clone();
                let patch = texels(&device, image)?;
                let view = self.uploaded(id)?;
                let Some(view) = view else { return Ok(()) };
                copy_rectangle(&device, &patch, &view, (column as u32, row as u32), (width as u32, height as u32))
            }
            (None, Some(texture)) if texture.size == image.size && texture.filter == filter => {
                (texture.is_opaque, texture.waiting) = (is_opaque, Some(image.clone()));
                Ok(())
            }
            (None, _) => {
                let waiting = Some(image.clone());
                let texture = Texture { view: None, waiting, size: image.size, filter, is_opaque, pass: None };
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

    /// The view of a texture with all its texels; `None` for one that is not there.
    fn uploaded(&mut self, id: TextureId) -> Result<Option<Arc<ImageView>>, Error> {
        let Some(texture) = self.textures.get_mut(&id) else { return Ok(None) };
        if let Some(image) = texture.waiting.take() {
            match &texture.view {
                Some(view) => fill(self.shaders.device(), view, &image)?,
                None => texture.view = Some(texels(self.shaders.device(), &image)?),
            }
        }
        Ok(texture.view.clone())
    }

    /// Lays the part of a picture that lies in `area` onto the window's picture, texel by pixel.
    fn copy(&mut self, sheet: Sheet, area: Area, target: &Arc<ImageView>) -> Result<bool, Error> {
        let waiting = self.textures.get(&sheet.texture).and_then(|texture| texture.waiting.clone());
        let (wide, high) = sheet.place.size();
        let Some(image) = waiting.filter(|image| image.size == [wide as usize, high as usize]) else {
            return Ok(false);
        };
        let is_blue_first = match target.image().desc().format {
            vk::Format::B8G8R8A8_UNORM => true,
            vk::Format::R8G8B8A8_UNORM => false,
            _ => return Ok(false),
        };
        let (width, height) = area.size();
        let rows = (area.top - sheet.place.top) as usize..(area.bottom - sheet.place.top) as usize;
        let first = (area.left - sheet.place.left) as usize;
        self.bytes.clear();
        for row in rows {
            let start = row * image.size[0] + first;
            self.bytes.extend(image.pixels[start..start + width as usize].iter().map(|pixel| {
                let [red, green, blue, alpha] = pixel.to_array();
                if is_blue_first { [blue, green, red, alpha] } else { [red, green, blue, alpha] }
            }));
        }
        let bytes = bytemuck::cast_slice::<[u8; 4], u8>(&self.bytes);
        let device = self.shaders.device();
        let staging = match &self.staging {
            Some(staging) if staging.size_bytes() >= bytes.len() as u64 => staging.clone(),
            _ => {
                let desc = BufferDesc::new("interface staging", bytes.len() as u64).location(Location::Upload);
                self.staging.insert(Buffer::new(device, desc)?).clone()
            }
        };
        staging.write(0, bytes)?;
        upload_rectangle(&staging, target, (area.left, area.top), (width, height))?;
        Ok(true)
    }

    /// The window's picture as it was last drawn.
    pub fn picture(&self) -> Option<Arc<ImageView>> {
        self.target.as_ref().filter(|target| target.is_drawn).map(|target| target.view.clone())
    }

    /// Takes the shapes of a frame over, whose places are in points of `pixels_per_point`.
    pub fn take(&mut self, pixels_per_point: f32, shapes: Vec<ClippedShape>) {
        let textures = &self.textures;
        let is_opaque = |id: TextureId| textures.get(&id).is_some_and(|texture| texture.is_opaque);
        self.canvas.change(shapes, pixels_per_point, &self.redrawn, is_opaque);
        self.redrawn.clear();
    }

    /// Keeps the shapes that there are, and takes over which textures have changed.
    pub fn take_textures(&mut self) {
        self.canvas.change_textures(&self.redrawn);
        self.redrawn.clear();
    }

    /// Draws what has changed into the window's picture, and gives it; `None` where it would be what it is. `tessellate` makes
    /// triangles of shapes.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn paint(
        &mut self,
        (width, height, format): (u32, u32, vk::Format),
        tessellate: impl Fn(Vec<ClippedShape>) -> Vec<ClippedPrimitive>,
    ) -> Result<Option<Arc<ImageView>>, Error> {
        let view = self.sized(width, height, format)?;
        let areas = self.canvas.stale((width, height));
        if areas.is_empty() {
            return Ok(None);
        }
        let is_whole = areas == [Area::whole((width, height))];
        let mut batch = Batch::default();
        for area in areas {
            let mut seen = self.canvas.seen_in(area);
            if let Some(sheet) = seen.picture
                && (is_whole || !self.copy(sheet, area, &view)?)
            {
                seen.shapes.insert(0, self.canvas.shape_of(sheet));
            }
            if !is_whole && !seen.is_covered {
                seen.shapes.insert(0, self.canvas.ground(area));
            }
            if !seen.shapes.is_empty() {
                batch.add(area, tessellate(seen.shapes), self.canvas.pixels_per_point());
            }
        }
        self.fill(&batch)?;
        // The first of a whole picture clears, with or without triangles of its own.
        let mut groups: Vec<(TextureId, Vec<Run>)> = Vec::new();
        groups.extend(is_whole.then(|| (LETTERS, batch.take(LETTERS))));
        while let Some(texture) = batch.next_texture() {
            groups.push((texture, batch.take(texture)));
        }
        let mut passes = Vec::new();
        for (texture, runs) in groups {
            let is_first = is_whole && passes.is_empty();
            passes.extend(self.pass(texture, is_first, &view)?.map(|pass| (pass, runs)));
        }
        self.draw(&passes, Screen { pixels: [width as f32, height as f32] })?;
        self.canvas.settle();
        if let Some(target) = &mut self.target {
            target.is_drawn = true;
        }
        Ok(Some(view))
    }

    fn draw(&mut self, passes: &[(Pass, Vec<Run>)], screen: Screen) -> Result<(), Error> {
        // Pictures that were copied are all that there was.
        if passes.is_empty() {
            return Ok(());
        }
        self.recorder.run(Mode::Plain, |frame| {
            for (pass, runs) in passes {
                frame.graphics(pass, |draw| {
                    draw.constants(&screen);
                    for run in runs {
                        let corner = (run.area.left, run.area.top);
                        draw.scissor(corner, run.area.size()).indices_from(run.first, run.count);
                    }
                })?;
            }
            Ok::<(), Error>(())
        })?;
        Ok(())
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
        self.canvas.forget();
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

    /// Writes corners and indices into the buffers, made larger where they must be.
    fn fill(&mut self, batch: &Batch) -> Result<(), Error> {
        let device = self.shaders.device().clone();
        let (corners, indices): (&[u8], &[u8]) =
            (bytemuck::cast_slice(&batch.corners), bytemuck::cast_slice(&batch.indices));
        if self.corners.size_bytes() < corners.len() as u64 {
            self.corners = self::corners(&device, corners.len() as u64 * 2)?;
            self.forget_passes();
        }
        if self.indices.size_bytes() < indices.len() as u64 {
            self.indices = self::indices(&device, indices.len() as u64 * 2)?;
            self.forget_passes();
        }
        self.corners.write(0, corners)?;
        self.indices.write(0, indices)
    }

    /// The pass that draws with a texture; `None` for one that is not there.
    fn pass(&mut self, id: TextureId, is_first: bool, target: &Arc<ImageView>) -> Result<Option<Pass>, Error> {
        let Some(picture) = self.uploaded(id)? else { return Ok(None) };
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
                .with("picture", &picture)
                .with("picture_sampler", sampler)
                .color(0, target, load)
                .build(&self.shaders)?,
            None => Pass::graphics("interface", "", "window/interface.vert", "window/interface.frag")
                .vertices::<Corner>(&self.corners)
                .indices(&self.indices)
                .constants::<Screen>()
                .with("picture", &picture)
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

impl Batch {
    /// Adds what is seen in a rectangle.
    fn add(&mut self, area: Area, primitives: Vec<ClippedPrimitive>, pixels_per_point: f32) {
        let mut runs = VecDeque::new();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(Mesh { vertices, indices, texture_id }) = primitive else { continue };
            let clip = Area::of_clip(clip_rect, pixels_per_point).and_then(|clip| clip.common(area));
            let Some(clip) = clip.filter(|_| !indices.is_empty()) else { continue };
            let base = self.corners.len() as u32;
            self.corners.extend(vertices.iter().map(|vertex| Corner {
                place: [vertex.pos.x * pixels_per_point, vertex.pos.y * pixels_per_point],
                texel: [vertex.uv.x, vertex.uv.y],
                tint: u32::from_le_bytes(vertex.color.to_array()),
            }));
            let (first, count) = (self.indices.len() as u32, indices.len() as u32);
            self.indices.extend(indices.iter().map(|index| base + index));
            runs.push_back(Run { texture: texture_id, area: clip, first, count });
        }
        self.runs.push(runs);
    }

    /// The texture that some rectangle is to be drawn with next.
    fn next_texture(&self) -> Option<TextureId> {
        self.runs.iter().find_map(|runs| runs.front()).map(|run| run.texture)
    }

    /// The next runs of all rectangles, as far as they are drawn with that texture: none lies over another's.
    fn take(&mut self, texture: TextureId) -> Vec<Run> {
        let count = |runs: &VecDeque<Run>| runs.iter().take_while(|run| run.texture == texture).count();
        self.runs.iter_mut().flat_map(|runs| runs.drain(..count(runs))).collect()
    }
}

/// The texture of the interface's letters and fills.
const LETTERS: TextureId = TextureId::Managed(0);

/// An image of these texels.
fn texels(device: &Arc<Device>, image: &ColorImage) -> Result<Arc<ImageView>, Error> {
    let [width, height] = image.size.map(|side| side as u32);
    let desc = ImageDesc::new_2d("interface texture", vk::Format::R8G8B8A8_UNORM, width, height);
    let view = Image::new(device, desc.usage(vk::ImageUsageFlags::SAMPLED))?.view()?;
    fill(device, &view, image)?;
    Ok(view)
}

/// Gives an image of that size these texels.
fn fill(device: &Arc<Device>, view: &Arc<ImageView>, image: &ColorImage) -> Result<(), Error> {
    let [width, height] = image.size.map(|side| side as u32);
    let pixels: &[u8] = bytemuck::cast_slice(&image.pixels);
    upload_rows(device, view, (width, height), |first, bytes| {
        let start = first as usize * width as usize * 4;
        bytes.copy_from_slice(&pixels[start..start + bytes.len()]);
    })
}

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
