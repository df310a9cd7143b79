//! The window on the screen: device, surface and swapchain, made anew as the window changes.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::TexturesDelta;
use egui::epaint::{ClippedPrimitive, ClippedShape};
use winit::window::Window;

use super::painter::Painter;
use crate::gpu::surface::{Display, Surface};
use crate::gpu::swapchain::{Form, PresentMode, Presented, Swapchain};
use crate::gpu::{Device, Error, ImageView, Instance};

/// Means by which a window shows itself.
pub struct Screen {
    // In the order in which they are dropped: each needs what follows.
    painter: Painter,
    shown: Option<Arc<ImageView>>,
    swapchain: Option<Swapchain>,
    surface: Arc<Surface>,
    device: Arc<Device>,
    window: Arc<Window>,
    mode: PresentMode,
    is_stale: bool,
    /// Form of the surface that the swapchain was last made anew for because another might fit it better.
    refitted: Option<Form>,
}

/// The end of a frame of the interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drawn {
    /// It is on the screen; drawing it took so long, without waiting for the display.
    Yes(Duration),
    /// It equals what is on the screen already.
    Unchanged,
    /// The window has no pixels, or the display no image to spare: it is to be drawn again when that changes.
    Later {
        /// The display may have one soon.
        is_soon: bool,
    },
}

impl Screen {
    /// Opens the best device that can present to the window.
    ///
    /// # Errors
    /// [`Error::NoDevice`] where none can; any error of the Vulkan layer.
    pub fn new(window: &Arc<Window>, validate: bool, mode: PresentMode) -> Result<Self, Error> {
        let instance = Instance::for_display(validate, &Display::of(window)?)?;
        let surface = Surface::new(&instance, window)?;
        let able = surface.devices()?.into_iter().filter(|device| device.lacks(&[]).is_empty());
        let best = able.min_by_key(|device| (device.device_type, device.index));
        let best = best.ok_or_else(|| Error::NoDevice { reason: "none can present to this display".into() })?;
        let device = Device::open_presenting(&instance, best)?;
        Ok(Screen {
            painter: Painter::new(&device)?,
            shown: None,
            swapchain: None,
            surface,
            device,
            window: window.clone(),
            mode,
            is_stale: true,
            refitted: None,
        })
    }

    /// The device that draws the interface.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// The longest side of a texture in pixels.
    pub fn most_texels(&self) -> usize {
        self.device.physical().limits.max_image_dimension2_d as usize
    }

    /// The window has another size: the swapchain is made anew before the next frame.
    pub fn resized(&mut self) {
        self.is_stale = true;
    }

    /// The contents of the screen may be lost: it is shown again with the next frame, changed or not.
    pub fn exposed(&mut self) {
        self.shown = None;
    }

    /// Takes over what changed of the textures, whether or not the frame is drawn.
    ///
    /// # Errors
    /// Any error of the Vulkan layer.
    pub fn update(&mut self, textures: &TexturesDelta) -> Result<(), Error> {
        self.painter.update(&textures.set)
    }

    /// Draws a frame of the interface, of which `tessellate` makes triangles, and shows it.
    ///
    /// # Errors
    /// Any error of the Vulkan layer, as a lost device.
    pub fn draw(
        &mut self,
        pixels_per_point: f32,
        shapes: Vec<ClippedShape>,
        tessellate: impl Fn(Vec<ClippedShape>) -> Vec<ClippedPrimitive>,
    ) -> Result<Drawn, Error> {
        self.painter.take(pixels_per_point, shapes);
        self.show(tessellate)
    }

    /// Draws textures that have changed where the last frame's shapes show them.
    ///
    /// # Errors
    /// As [`Screen::draw`].
    pub fn draw_textures(
        &mut self,
        tessellate: impl Fn(Vec<ClippedShape>) -> Vec<ClippedPrimitive>,
    ) -> Result<Drawn, Error> {
        self.painter.take_textures();
        self.show(tessellate)
    }

    fn show(&mut self, tessellate: impl Fn(Vec<ClippedShape>) -> Vec<ClippedPrimitive>) -> Result<Drawn, Error> {
        // Of a window that changes while it is drawn to, the second picture is the right one; a display that never
        // settles gets its next chance with the next frame. It took as long as all of its pictures.
        let mut painted = Duration::ZERO;
        for _ in 0..3 {
            if self.is_stale {
                self.make_swapchain()?;
            }
            let Some(swapchain) = &mut self.swapchain else { return Ok(Drawn::Later { is_soon: false }) };
            let started = Instant::now();
            let (width, height) = swapchain.extent();
            let format = swapchain.picture_format();
            let picture = match (self.painter.paint((width, height, format), &tessellate)?, &self.shown) {
                (Some(picture), _) => picture,
                (None, Some(_)) => return Ok(Drawn::Unchanged),
                (None, None) => self.painter.picture().ok_or_else(|| Error::Pass {
                    pass: "interface".into(),
                    problem: "it has drawn nothing yet".into(),
                })?,
            };
            painted += started.elapsed();
            match swapchain.present(&picture)? {
                Presented::Shown => {
                    self.shown = Some(picture);
                    return Ok(Drawn::Yes(painted));
                }
                Presented::Suboptimal => {
                    self.shown = Some(picture);
                    // Once for each form: a display may call every swapchain suboptimal that it is given.
                    let form = swapchain.surface_form()?;
                    if self.refitted.replace(form) == Some(form) {
                        return Ok(Drawn::Yes(painted));
                    }
                    self.is_stale = true;
                }
                Presented::Busy => {
                    self.shown = None;
                    return Ok(Drawn::Later { is_soon: true });
                }
                Presented::Stale => (self.is_stale, self.shown) = (true, None),
                Presented::SurfaceLost => {
                    (self.is_stale, self.shown, self.refitted) = (true, None, None);
                    self.swapchain = None;
                    self.surface = Surface::new(self.device.instance(), &self.window)?;
                }
            }
        }
        Ok(Drawn::Later { is_soon: true })
    }

    /// Forgets textures that no frame names any more.
    pub fn free(&mut self, textures: &TexturesDelta) {
        self.painter.free(&textures.free);
    }

    fn make_swapchain(&mut self) -> Result<(), Error> {
        let size = self.window.inner_size();
        let old = self.swapchain.take();
        self.shown = None;
        let made = Swapchain::new(&self.device, &self.surface, (size.width, size.height), self.mode, old)?;
        // A window without pixels is asked again when it changes.
        self.is_stale = made.is_none();
        self.swapchain = made;
        Ok(())
    }
}
