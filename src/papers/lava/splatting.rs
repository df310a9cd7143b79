//! Stage three (chapter 7): the surface as splats, or by rays in their place, blended and normalised.

use std::sync::Arc;

use super::FLOORS;
use super::blending::Blending;
use super::culling::Kept;
use super::deferred::{Deferred, SplatShading};
use super::march::March;
use super::normalisation::Normalisation;
use super::parameters::{Parameters, SurfaceDraw};
use super::rock::Rock;
use super::scene::{Scene, Sheet};
use super::splats::Splats;
use super::targets::{Context, DEPTH, EMPTY, FLOATS};
use super::visibility::Visibility;
use crate::gpu::{Blend, Device, Error, Frame, ImageView, Load, Pass, ShaderLibrary};

/// The stage.
pub struct Splatting {
    /// The scene that is drawn: surface, uniform block, rock and emission.
    pub(super) scene: Scene,
    drawing: Drawing,
    /// Eye-space depth of the nearest splat plus epsilon, as a fraction of [`depth_range_m`](super::depth_range_m).
    pub depth: Arc<ImageView>,
    /// Weighted colours, sum of weights in alpha.
    pub sums: Arc<ImageView>,
    /// The picture.
    pub normalisation: Normalisation,
}

/// By [`SurfaceDraw`].
enum Drawing {
    Splats(SplatPasses),
    March(March),
}

/// The thesis's.
struct SplatPasses {
    splats: Splats,
    /// Depths of eq. 7.1.
    visibility: Visibility,
    shading: Shading,
    floor: Pass,
}

/// By [`SplatShading`].
enum Shading {
    /// Sums of eq. 7.2.
    Gouraud(Blending),
    Deferred(Deferred),
}

impl Splatting {
    /// The stage on these textures. `instanced` splats are quads without a geometry stage.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        sheet: Sheet<'_>,
        rock: &Rock,
        instanced: bool,
        draw: SurfaceDraw,
    ) -> Result<Self, Error> {
        let context = Context { shaders, label, parameters };
        let scene = Scene::new(context, sheet, rock)?;
        let depth = context.target("visibility", DEPTH, parameters.width, parameters.height)?;
        let sums = context.target("accumulated-colors", FLOATS, parameters.width, parameters.height)?;
        let drawing = match draw {
            SurfaceDraw::Splats => {
                let splats = Splats::new(context, &scene, instanced)?;
                let visibility = Visibility::new(context, &scene, &splats, &depth)?;
                let shading = match parameters.splat_shading {
                    SplatShading::Gouraud => Shading::Gouraud(Blending::new(context, &scene, &splats, &depth, &sums)?),
                    SplatShading::Deferred => {
                        Shading::Deferred(Deferred::new(context, &scene, &splats, &depth, &sums)?)
                    }
                };
                let floor = splats
                    .pass(&scene, FLOORS[2].1, "7.1", EMPTY)
                    .color(&sums, Load::Keep, Blend::Masked)
                    .build(shaders)?;
                Drawing::Splats(SplatPasses { splats, visibility, shading, floor })
            }
            SurfaceDraw::March => Drawing::March(March::new(context, &scene, &depth, &sums)?),
        };
        let normalisation = Normalisation::new(context, &sums)?;
        Ok(Splatting { scene, drawing, depth, sums, normalisation })
    }

    /// Sets the numbers of [`DRAWN`](super::DRAWN) of the next frames.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_drawn(&mut self, parameters: &Parameters, rock: &Rock) -> Result<(), Error> {
        self.scene.set(parameters, rock)?;
        self.normalisation.set_tone(parameters);
        match &mut self.drawing {
            Drawing::March(march) => march.set_rays(parameters),
            Drawing::Splats(SplatPasses { splats, shading, .. }) => {
                splats.set_eye(parameters);
                if let Shading::Deferred(deferred) = shading {
                    deferred.set_rays(parameters);
                }
            }
        }
        Ok(())
    }

    /// The splats' normals and depths; `None` where their colours are blended, or rays are drawn.
    pub fn deferred(&self) -> Option<&Deferred> {
        match &self.drawing {
            Drawing::Splats(SplatPasses { shading: Shading::Deferred(deferred), .. }) => Some(deferred),
            _ => None,
        }
    }

    /// Reads back the splats that the last frame drew; `None` where those are all, or rays are drawn.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn kept(&self, device: &Arc<Device>) -> Result<Option<Kept>, Error> {
        match &self.drawing {
            Drawing::Splats(SplatPasses { splats, .. }) => splats.kept(device),
            Drawing::March(_) => Ok(None),
        }
    }

    /// Draws the surface; the rock has drifted `drift_m` along x.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, drift_m: f32) -> Result<(), Error> {
        match &self.drawing {
            Drawing::Splats(SplatPasses { splats, visibility, shading, .. }) => {
                splats.cull(frame)?;
                visibility.record(frame, splats)?;
                match shading {
                    Shading::Gouraud(blending) => blending.record(frame, splats, drift_m)?,
                    Shading::Deferred(deferred) => deferred.record(frame, splats, drift_m)?,
                }
            }
            Drawing::March(march) => march.record(frame, drift_m)?,
        }
        self.normalisation.record(frame)
    }

    /// Draws the splats, where there are any, with an empty fragment stage. It changes no texture.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub(super) fn record_floor(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        match &self.drawing {
            Drawing::Splats(SplatPasses { splats, floor, .. }) => frame.graphics(floor, |draw| splats.draw(draw)),
            Drawing::March(_) => Ok(()),
        }
    }
}
