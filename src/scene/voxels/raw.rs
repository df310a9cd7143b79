//! Samples as they stand in a file, in any of the numbers that the formats know.

use std::io::{ErrorKind, Read};

use crate::scene::binary::{ByteOrder, allocate};
use crate::scene::error::{Fault, Place};

/// Number of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Unsigned8,
    Signed8,
    Unsigned16,
    Signed16,
    Unsigned32,
    Signed32,
    Unsigned64,
    Signed64,
    Float32,
    Float64,
}

impl Kind {
    pub(super) fn bytes(self) -> u64 {
        match self {
            Self::Unsigned8 | Self::Signed8 => 1,
            Self::Unsigned16 | Self::Signed16 => 2,
            Self::Unsigned32 | Self::Signed32 | Self::Float32 => 4,
            Self::Unsigned64 | Self::Signed64 | Self::Float64 => 8,
        }
    }

    fn decode(self, order: ByteOrder, bytes: &[u8], values: &mut Vec<f32>) {
        macro_rules! decode {
            ($type:ty) => {{
                let chunks = bytes.as_chunks::<{ size_of::<$type>() }>().0.iter();
                match order {
                    ByteOrder::Little => values.extend(chunks.map(|&chunk| <$type>::from_le_bytes(chunk) as f32)),
                    ByteOrder::Big => values.extend(chunks.map(|&chunk| <$type>::from_be_bytes(chunk) as f32)),
                }
            }};
        }
        match self {
            Self::Unsigned8 => decode!(u8),
            Self::Signed8 => decode!(i8),
            Self::Unsigned16 => decode!(u16),
            Self::Signed16 => decode!(i16),
            Self::Unsigned32 => decode!(u32),
            Self::Signed32 => decode!(i32),
            Self::Unsigned64 => decode!(u64),
            Self::Signed64 => decode!(i64),
            Self::Float32 => decode!(f32),
            Self::Float64 => decode!(f64),
        }
    }
}

/// Order and numbers of the samples in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Raw {
    /// Samples along x, y and z; x runs fastest in the file.
    pub(super) size: [u32; 3],
    /// Type of a value.
    pub(super) kind: Kind,
    /// Order of a value's bytes.
    pub(super) order: ByteOrder,
    /// Values of a sample.
    pub(super) components: u64,
    /// Samples whose values of one component stand next to each other: 1 where all values of a sample do.
    pub(super) together: u64,
}

impl Raw {
    /// Samples of the grid.
    pub(super) fn count(&self) -> u64 {
        self.size.map(u64::from).iter().product()
    }

    /// Bytes of all components.
    ///
    /// # Errors
    /// More than a file can have.
    pub(super) fn bytes(&self) -> Result<u64, Fault> {
        let [x, y, z] = self.size;
        let bytes = self.count().checked_mul(self.components).and_then(|values| values.checked_mul(self.kind.bytes()));
        bytes.filter(|&bytes| bytes < 1 << 48).ok_or_else(|| {
            let reason = format!("its {x} x {y} x {z} samples of {} values are more than a file has", self.components);
            Fault::new(Place::Whole, reason)
        })
    }

    /// Passes when so many bytes hold the samples.
    pub(super) fn check_bytes(&self, found: u64) -> Result<(), Fault> {
        let needed = self.bytes()?;
        if found >= needed {
            return Ok(());
        }
        let ([x, y, z], each) = (self.size, self.components * self.kind.bytes());
        let reason =
            format!("{found} bytes of samples, but {x} x {y} x {z} of {each} bytes each make {needed}; it is cut off");
        Err(Fault::new(Place::Whole, reason))
    }

    /// Passes when there is such a component, counted from 0.
    pub(super) fn check_component(&self, component: u32) -> Result<(), Fault> {
        if u64::from(component) < self.components {
            return Ok(());
        }
        let last = self.components - 1;
        Err(Fault::new(Place::Whole, format!("it has no component {component}: give `volume-component` 0 to {last}")))
    }

    /// Reads one component of every sample. The caller has checked that the file holds them.
    pub(super) fn read(&self, mut input: impl Read, component: u32) -> Result<Vec<f32>, Fault> {
        /// A multiple of every number's bytes.
        const BLOCK_BYTES: u64 = 1 << 20;
        let mut samples = allocate::<f32>(self.count() as usize)?;
        samples.clear();
        let (mut bytes, mut block) = (Vec::new(), Vec::new());
        let (mut left, mut number) = (self.bytes()?, 0_u64);
        while left > 0 {
            bytes.resize(left.min(BLOCK_BYTES) as usize, 0);
            input.read_exact(&mut bytes).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => Fault::new(Place::Whole, "its samples end early; it is cut off"),
                _ => Fault::foreign(Place::Whole, &error),
            })?;
            left -= bytes.len() as u64;
            if self.components == 1 {
                self.kind.decode(self.order, &bytes, &mut samples);
                continue;
            }
            block.clear();
            self.kind.decode(self.order, &bytes, &mut block);
            let is_of = |at: u64| at / self.together % self.components == u64::from(component);
            samples.extend((number..).zip(&block).filter(|(at, _)| is_of(*at)).map(|(_, value)| *value));
            number += block.len() as u64;
        }
        Ok(samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(kind: Kind, order: ByteOrder) -> Raw {
        Raw { size: [2, 1, 1], kind, order, components: 1, together: 1 }
    }

    #[test]
    fn every_number_is_read_in_both_orders() {
        macro_rules! check {
            ($kind:ident, $type:ty, $low:expr, $high:expr) => {
                let (low, high): ($type, $type) = ($low, $high);
                for order in [ByteOrder::Little, ByteOrder::Big] {
                    let bytes = [low, high].map(|n| match order {
                        ByteOrder::Little => n.to_le_bytes(),
                        ByteOrder::Big => n.to_be_bytes(),
                    });
                    let values = raw(Kind::$kind, order).read(bytes.as_flattened(), 0).unwrap();
                    assert_eq!(values, [low as f32, high as f32]);
                }
            };
        }
        check!(Unsigned8, u8, 3, 255);
        check!(Signed8, i8, -128, 127);
        check!(Unsigned16, u16, 258, 65_535);
        check!(Signed16, i16, -32_768, 258);
        check!(Unsigned32, u32, 0x0102_0304, u32::MAX);
        check!(Signed32, i32, i32::MIN, 0x0102_0304);
        check!(Unsigned64, u64, 0x0102_0304_0506_0708, u64::MAX);
        check!(Signed64, i64, i64::MIN, 0x0102_0304_0506_0708);
        check!(Float32, f32, -1.5, 3e38);
        check!(Float64, f64, -0.25, 1e300);
    }

    #[test]
    fn components_are_picked_wherever_their_axis_stands() {
        // The value tells place and component.
        let size = [3, 2, 2];
        for together in [1, 3, 6, 12] {
            let raw = Raw { size, kind: Kind::Unsigned8, order: ByteOrder::Little, components: 4, together };
            let place = |at: u64| at / (together * 4) * together + at % together;
            let bytes: Vec<u8> = (0..48).map(|at| (10 * (at / together % 4) + place(at)) as u8).collect();
            for component in 0..4 {
                let expected: Vec<f32> = (0..12).map(|at| (10 * component + at) as f32).collect();
                assert_eq!(raw.read(bytes.as_slice(), component).unwrap(), expected, "{together}");
            }
            assert!(raw.check_component(3).is_ok() && raw.check_component(4).is_err());
        }
    }

    #[test]
    fn what_is_too_short_is_cut_off() {
        let raw = raw(Kind::Signed16, ByteOrder::Little);
        assert!(raw.check_bytes(4).is_ok() && raw.check_bytes(5).is_ok());
        let message = raw.check_bytes(3).unwrap_err().to_string();
        assert_eq!(message, "3 bytes of samples, but 2 x 1 x 1 of 2 bytes each make 4; it is cut off");
        assert!(raw.read([0_u8; 3].as_slice(), 0).unwrap_err().to_string().contains("cut off"));
    }
}
