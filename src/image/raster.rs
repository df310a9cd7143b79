use super::Error;

/// The values of a [`Raster`], tightly packed, unchanged from the target or buffer they come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    F32(Vec<f32>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    U16(Vec<u16>),
    U8(Vec<u8>),
}

impl Samples {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::U32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::U8(values) => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl From<Vec<f32>> for Samples {
    fn from(values: Vec<f32>) -> Self {
        Self::F32(values)
    }
}

impl From<Vec<u32>> for Samples {
    fn from(values: Vec<u32>) -> Self {
        Self::U32(values)
    }
}

impl From<Vec<i32>> for Samples {
    fn from(values: Vec<i32>) -> Self {
        Self::I32(values)
    }
}

impl From<Vec<u16>> for Samples {
    fn from(values: Vec<u16>) -> Self {
        Self::U16(values)
    }
}

impl From<Vec<u8>> for Samples {
    fn from(values: Vec<u8>) -> Self {
        Self::U8(values)
    }
}

/// Layout of the values of a [`Raster`]; the last dimension varies fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// `[layers][height][width][channels]`, the top row first; 1 to 4 channels.
    Image { layers: u32, height: u32, width: u32, channels: u32 },
    /// `[rows][columns]`: a buffer of `rows` elements of `columns` values each.
    Table { rows: usize, columns: usize },
}

impl Shape {
    /// The dimensions, slowest first: four of an image, two of a table.
    pub fn dimensions(&self) -> Vec<u64> {
        match *self {
            Self::Image { layers, height, width, channels } => {
                [layers, height, width, channels].map(u64::from).to_vec()
            }
            Self::Table { rows, columns } => vec![rows as u64, columns as u64],
        }
    }
}

/// A render target or a buffer at full precision, as [`write`](super::write) takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    shape: Shape,
    samples: Samples,
    are_numbers: bool,
}

/// A raster seen as pictures: a table is one layer of one channel, a row a line.
pub(super) struct Planes {
    /// Layers, at least 1.
    pub layers: usize,
    /// Rows of a layer.
    pub height: usize,
    /// Pixels of a row.
    pub width: usize,
    /// Channels of a pixel, 1 to 4.
    pub channels: usize,
}

impl Raster {
    /// An image of `layers` layers, laid out as [`Shape::Image`] says.
    ///
    /// # Errors
    /// [`Error::Channels`] unless there are 1 to 4; [`Error::Length`] when `samples` does not fill the shape exactly.
    pub fn image(
        width: u32,
        height: u32,
        channels: u32,
        layers: u32,
        samples: impl Into<Samples>,
    ) -> Result<Self, Error> {
        let shape = Shape::Image { layers, height, width, channels };
        if !(1..=4).contains(&channels) {
            let what = format!("an image of {channels} channels");
            return Err(Error::Channels { what });
        }
        Self::new(shape, samples.into())
    }

    /// A buffer of `rows` elements of `columns` values each.
    ///
    /// # Errors
    /// [`Error::Length`] when `samples` does not fill the shape exactly.
    pub fn table(rows: usize, columns: usize, samples: impl Into<Samples>) -> Result<Self, Error> {
        Self::new(Shape::Table { rows, columns }, samples.into())
    }

    fn new(shape: Shape, samples: Samples) -> Result<Self, Error> {
        // Cannot overflow: three u32 and at most 4 channels, or two u64.
        let expected: u128 = shape.dimensions().iter().map(|&n| u128::from(n)).product();
        if expected != samples.len() as u128 {
            return Err(Error::Length {
                what: format!("a raster of shape {:?}", shape.dimensions()),
                expected: expected.to_string(),
                found: samples.len(),
            });
        }
        Ok(Self { shape, samples, are_numbers: false })
    }

    /// The same, of which several channels of floats are no colours but numbers: coordinates, say.
    pub fn of_numbers(self) -> Self {
        Raster { are_numbers: true, ..self }
    }

    pub(super) fn are_numbers(&self) -> bool {
        self.are_numbers
    }

    pub fn shape(&self) -> Shape {
        self.shape
    }

    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    pub(super) fn planes(&self) -> Planes {
        match self.shape {
            Shape::Image { layers, height, width, channels } => Planes {
                layers: layers as usize,
                height: height as usize,
                width: width as usize,
                channels: channels as usize,
            },
            Shape::Table { rows, columns } => Planes { layers: 1, height: rows, width: columns, channels: 1 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_must_be_filled_exactly() {
        assert!(Raster::image(3, 2, 4, 2, vec![0u8; 48]).is_ok());
        for length in [47, 49, 0] {
            let error = Raster::image(3, 2, 4, 2, vec![0u8; length]).unwrap_err();
            assert!(matches!(error, Error::Length { .. }), "{error}");
        }
        assert!(Raster::table(5, 3, vec![0u32; 15]).is_ok());
        assert!(Raster::table(5, 3, vec![0u32; 16]).is_err());
        assert!(Raster::image(1, 1, 5, 1, vec![0u16; 5]).is_err());
        assert!(Raster::image(1, 1, 0, 1, Vec::<u16>::new()).is_err());
    }

    #[test]
    fn absurd_shapes_are_refused_without_overflow() {
        let sides = u32::MAX;
        assert!(Raster::image(sides, sides, 4, sides, vec![0u8]).is_err());
        assert!(Raster::table(usize::MAX, usize::MAX, vec![0u8]).is_err());
    }
}
