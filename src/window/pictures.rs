//! The worker's pictures as textures of the interface, of the size that they have on the screen where that is smaller than
//! they are.

use std::collections::HashMap;

use egui::{Color32, ColorImage, Context, TextureHandle, TextureOptions, Vec2};

use super::protocol::{Frame, Picture};
use super::reduction::reduced;
use super::session::Session;

/// Index of the difference among the large pictures, behind the sides.
pub const DIFFERENCE: usize = 2;

/// Textures of the last frame.
#[derive(Default)]
pub struct Pictures {
    /// Those of the sides, and their difference.
    large: [Large; 3],
    /// Small picture of each target, by the target's name.
    pub thumbnails: HashMap<String, TextureHandle>,
    /// A frame has come since the last update.
    pub is_new: bool,
    /// A line for the clipboard.
    pub to_copy: Option<String>,
}

/// A picture in the middle of the window.
#[derive(Default)]
struct Large {
    texture: Option<TextureHandle>,
    /// Pixels of the screen that it takes.
    shown: Option<[usize; 2]>,
    /// Pixels that the texture was made for.
    made: Option<[usize; 2]>,
}

impl Pictures {
    /// Takes over the pictures of a new frame.
    pub fn update(&mut self, context: &Context, session: &Session) {
        let Some(frame) = session.frame.as_ref().filter(|_| std::mem::take(&mut self.is_new)) else { return };
        for (index, large) in self.large.iter_mut().enumerate() {
            large.make(context, picture(frame, index));
        }
        self.thumbnails.retain(|name, _| frame.thumbnails.iter().any(|thumbnail| thumbnail.name == *name));
        for thumbnail in &frame.thumbnails {
            let mut texture = self.thumbnails.remove(&thumbnail.name);
            let image = thumbnail.picture.as_ref().and_then(|picture| image(picture, None));
            place(context, &mut texture, "thumbnail", image, TextureOptions::LINEAR);
            self.thumbnails.extend(texture.map(|texture| (thumbnail.name.clone(), texture)));
        }
    }

    /// Makes those anew that have another size on the screen than they were made for.
    pub fn fit(&mut self, context: &Context, session: &Session) {
        let Some(frame) = &session.frame else { return };
        for (index, large) in self.large.iter_mut().enumerate().filter(|(_, large)| large.shown != large.made) {
            large.make(context, picture(frame, index));
        }
    }

    /// Texture of a side, or of the difference, and how many pixels of the screen it takes where those are fewer than its own.
    pub fn shown(&mut self, index: usize, shown: Option<[usize; 2]>) -> Option<&TextureHandle> {
        let large = self.large.get_mut(index)?;
        large.shown = shown;
        large.texture.as_ref()
    }
}

/// The pixels of a rectangle that shows a picture of `size` smaller than it is.
pub fn small_size(points: Vec2, pixels_per_point: f32, size: Vec2) -> Option<[usize; 2]> {
    let pixels = (points * pixels_per_point).round();
    let is_small = pixels.x <= size.x && pixels.y <= size.y && pixels != size;
    is_small.then_some([pixels.x as usize, pixels.y as usize])
}

/// A side's picture, or the difference.
fn picture(frame: &Frame, index: usize) -> Option<&Picture> {
    match index {
        DIFFERENCE => frame.difference.as_ref().map(|difference| &difference.picture),
        side => frame.sides.get(side)?.picture.as_ref(),
    }
}

impl Large {
    fn make(&mut self, context: &Context, picture: Option<&Picture>) {
        let image = picture.and_then(|picture| image(picture, self.shown));
        place(context, &mut self.texture, "picture", image, TextureOptions::NEAREST);
        self.made = self.shown;
    }
}

fn place(
    context: &Context,
    texture: &mut Option<TextureHandle>,
    name: &str,
    image: Option<ColorImage>,
    options: TextureOptions,
) {
    let Some(image) = image else {
        *texture = None;
        return;
    };
    match texture {
        Some(texture) => texture.set(image, options),
        None => *texture = Some(context.load_texture(name, image, options)),
    }
}

/// The picture as it is in a file, opaque; made smaller where its size on the screen is.
fn image(picture: &Picture, shown: Option<[usize; 2]>) -> Option<ColorImage> {
    let size = [picture.width as usize, picture.height as usize];
    let bytes = &picture.block.bytes;
    if bytes.len() != size[0] * size[1] * 4 || bytes.is_empty() {
        return None;
    }
    if let Some((shown, pixels)) = shown.and_then(|shown| Some((shown, reduced(bytes, size, shown)?))) {
        return Some(ColorImage::new(shown, pixels));
    }
    let opaque = |pixel: &[u8]| Color32::from_rgb(pixel[0], pixel[1], pixel[2]);
    Some(ColorImage::new(size, bytes.chunks_exact(4).map(opaque).collect()))
}
