//! The drape over the terrain in place of its colours.

use glam::{UVec2, Vec2, Vec3};

use crate::measure::ParameterError;

/// A picture over the first map, or what is drawn of the terrain itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Drape {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
    draping: Draping,
}

/// The place of a draped picture; what else lies over the terrain of all maps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Draping {
    /// Its corners on the map's.
    WholeMap,
    /// In columns and rows of the map's samples: its north-west corner, and from it to the south-east one.
    Placed { corner: Vec2, cells: Vec2 },
    /// Lines of equal height over the terrain's colours, so many metres apart, every fifth a wide one.
    Contours { interval_m: f32 },
    /// Colours by the angle between the surface that is lit and the base.
    Slope,
    /// Colours by height, of which so many metres are a true one.
    Hypsometric { scale: f32 },
}

impl Drape {
    /// Of `width` x `height` texels, 8-bit sRGB with an opacity that is ignored, the north-west one first.
    ///
    /// # Errors
    /// A side of 0, and a number of texels other than `width` times `height`.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Result<Self, ParameterError> {
        let is_whole = width > 0 && height > 0 && texels.len() as u64 == u64::from(width) * u64::from(height);
        let value = format!("{width}x{height}");
        ParameterError::check(is_whole, "drape", value, "its texels do not fill a picture of that size")?;
        Ok(Drape { width, height, texels, draping: Draping::WholeMap })
    }

    /// A single white texel.
    pub fn white() -> Self {
        Drape { width: 1, height: 1, texels: vec![[255; 4]], draping: Draping::WholeMap }
    }

    /// The picture at a place of its own, of a positive size: around it the ground keeps its colour.
    pub fn placed(self, corner: Vec2, cells: Vec2) -> Self {
        Drape { draping: Draping::Placed { corner, cells }, ..self }
    }

    /// No picture: what is drawn of the terrain itself. Numbers are finite and above 0.
    pub fn of_terrain(draping: Draping) -> Self {
        Drape { draping, ..Self::white() }
    }

    pub fn draping(&self) -> Draping {
        self.draping
    }

    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// That many bytes of whole rows.
    pub fn rows_from(&self, first_row: u32, bytes: usize) -> &[u8] {
        let rows = &self.texels[first_row as usize * self.width as usize..];
        &bytemuck::cast_slice(rows)[..bytes]
    }

    /// Its colour at a fraction of its sides, 0 to 1 from the west and from the north, linear; nothing beside a picture with
    /// a place of its own, and the border's beside another.
    pub fn color(&self, uv: Vec2) -> Option<Vec3> {
        if matches!(self.draping, Draping::Placed { .. }) && uv.clamp(Vec2::ZERO, Vec2::ONE) != uv {
            return None;
        }
        let size = UVec2::new(self.width, self.height);
        let texel = (uv * size.as_vec2() - 0.5).clamp(Vec2::ZERO, size.as_vec2() - 1.0);
        let (a, t) = (texel.as_uvec2(), texel.fract());
        let b = (a + 1).min(size - 1);
        let at = |x: u32, y: u32| {
            let texel = self.texels.get((y * self.width + x) as usize).copied().unwrap_or_default();
            Vec3::from_array([texel[0], texel[1], texel[2]].map(decode))
        };
        let (north, south) = (at(a.x, a.y).lerp(at(b.x, a.y), t.x), at(a.x, b.y).lerp(at(b.x, b.y), t.x));
        Some(north.lerp(south, t.y))
    }
}

/// sRGB to linear.
fn decode(encoded: u8) -> f32 {
    let c = f32::from(encoded) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}
