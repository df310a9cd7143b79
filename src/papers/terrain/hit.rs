//! The hit of a pixel's ray, as the passes hand it on.

/// Depth of a ray that meets nothing, metres.
pub const NO_DEPTH: f32 = 1.0e30;

/// The surfaces that a ray may meet; numbered as `shaders/terrain/terrain.glsl` does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    Sky,
    Base,
    Terrain,
    WallWest,
    WallEast,
    WallNorth,
    WallSouth,
    /// The camera stands in the ground.
    Inside,
}

impl Surface {
    const ALL: [Surface; 8] = [
        Surface::Sky,
        Surface::Base,
        Surface::Terrain,
        Surface::WallWest,
        Surface::WallEast,
        Surface::WallNorth,
        Surface::WallSouth,
        Surface::Inside,
    ];

    /// As a record has it.
    pub fn as_str(self) -> &'static str {
        match self {
            Surface::Sky => "sky",
            Surface::Base => "base",
            Surface::Terrain => "terrain",
            Surface::WallWest => "west wall",
            Surface::WallEast => "east wall",
            Surface::WallNorth => "north wall",
            Surface::WallSouth => "south wall",
            Surface::Inside => "inside",
        }
    }
}

/// A texel of the target `depth`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Along the view's axis, metres; [`NO_DEPTH`] for the sky.
    pub depth_m: f32,
    /// u and v in nodes of the map; one that goes once round has two more on each side.
    pub place: [f32; 2],
    /// The surface that is met.
    pub surface: Surface,
    /// The level that the surface was taken from, counted from the data.
    pub shift: u32,
    /// Number of the map, 0 to 15.
    pub map: u32,
    /// Segments of the ray that were tried until the map's surface was met, up to 4095; 0 where none was.
    pub steps: u32,
}

impl Hit {
    pub const SKY: Hit = Hit { depth_m: NO_DEPTH, place: [0.0; 2], surface: Surface::Sky, shift: 0, map: 0, steps: 0 };

    /// The level of a ray whose loops the driver ended: no map has so many.
    const UNFINISHED: u32 = 31;

    /// True of a ray that the driver left before its end.
    pub fn is_unfinished(&self) -> bool {
        self.surface == Surface::Sky && self.shift == Hit::UNFINISHED
    }

    pub fn from_texel(texel: [f32; 4]) -> Self {
        let code = texel[3] as u32;
        Hit {
            depth_m: texel[0],
            place: [texel[1], texel[2]],
            surface: Surface::ALL[(code & 7) as usize],
            shift: code >> 3 & 31,
            map: code >> 8 & 15,
            steps: code >> 12,
        }
    }

    pub fn to_texel(self) -> [f32; 4] {
        let code = self.surface as u32 + 8 * self.shift + 256 * self.map + 4096 * self.steps.min(4095);
        [self.depth_m, self.place[0], self.place[1], code as f32]
    }
}
