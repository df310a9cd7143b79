//! The worker's pictures as textures of the interface, uploaded when they change.

use std::collections::HashMap;

use egui::{Color32, ColorImage, Context, TextureHandle, TextureOptions};

use super::protocol::Picture;
use super::session::Session;

/// Textures of the last frame.
#[derive(Default)]
pub struct Pictures {
    /// Picture of each side; `None` where it is not drawn.
    pub sides: [Option<TextureHandle>; 2],
    /// Heat map of the distance of both sides; `None` unless it is asked for.
    pub difference: Option<TextureHandle>,
    /// Small picture of each target, by the target's name.
    pub thumbnails: HashMap<String, TextureHandle>,
    /// A frame has come since the last update.
    pub is_new: bool,
    /// Pictures are shown smaller than they are, and filtered.
    pub is_small: bool,
    was_small: bool,
    /// A line for the clipboard.
    pub to_copy: Option<String>,
}

impl Pictures {
    /// Takes over the pictures of a new frame.
    pub fn update(&mut self, context: &Context, session: &Session) {
        let has_changed = std::mem::take(&mut self.is_new);
        if !has_changed && self.was_small == self.is_small {
            return;
        }
        self.was_small = self.is_small;
        let Some(frame) = &session.frame else { return };
        let options = if self.is_small { TextureOptions::LINEAR } else { TextureOptions::NEAREST };
        for (index, texture) in self.sides.iter_mut().enumerate() {
            let picture = frame.sides.get(index).and_then(|side| side.picture.as_ref());
            place(context, texture, "picture", picture, options);
        }
        let difference = frame.difference.as_ref().map(|difference| &difference.picture);
        place(context, &mut self.difference, "difference", difference, options);
        self.thumbnails.retain(|name, _| frame.thumbnails.iter().any(|thumbnail| thumbnail.name == *name));
        for thumbnail in &frame.thumbnails {
            let mut texture = self.thumbnails.remove(&thumbnail.name);
            place(context, &mut texture, "thumbnail", thumbnail.picture.as_ref(), TextureOptions::LINEAR);
            self.thumbnails.extend(texture.map(|texture| (thumbnail.name.clone(), texture)));
        }
    }
}

fn place(
    context: &Context,
    texture: &mut Option<TextureHandle>,
    name: &str,
    picture: Option<&Picture>,
    options: TextureOptions,
) {
    let Some(image) = picture.and_then(image) else {
        *texture = None;
        return;
    };
    match texture {
        Some(texture) => texture.set(image, options),
        None => *texture = Some(context.load_texture(name, image, options)),
    }
}

/// The picture as it is in a file: opaque.
fn image(picture: &Picture) -> Option<ColorImage> {
    let size = [picture.width as usize, picture.height as usize];
    let bytes = &picture.block.bytes;
    if bytes.len() != size[0] * size[1] * 4 || bytes.is_empty() {
        return None;
    }
    let opaque = |pixel: &[u8]| Color32::from_rgb(pixel[0], pixel[1], pixel[2]);
    Some(ColorImage::new(size, bytes.chunks_exact(4).map(opaque).collect()))
}
