use glam::{DMat3, DVec3};

use crate::scene::error::{Fault, Place};

/// Samples on a grid of three axes, which need not be at right angles.
///
/// Space is x to the right, y backwards and z upwards as the one sees it whom the thing faces: of a patient left,
/// posterior and superior. A file that knows no such directions has its own x, y and z.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelGrid {
    size: [u32; 3],
    steps: [DVec3; 3],
    samples: Vec<f32>,
}

impl VoxelGrid {
    /// Most samples along an axis.
    pub const MOST_SIDE: u64 = 65_536;

    /// A grid of `size` samples, the first axis fastest; `steps` go from a sample to the next of each axis, in the file's
    /// unit.
    ///
    /// # Errors
    /// Another number of samples; steps that are not finite or lie in a plane.
    pub fn new(size: [u32; 3], steps: [DVec3; 3], samples: Vec<f32>) -> Result<Self, Fault> {
        let expected: u64 = size.map(u64::from).iter().product();
        if samples.len() as u64 != expected {
            let [x, y, z] = size;
            let reason = format!("{} samples for {x} x {y} x {z}, which needs {expected}", samples.len());
            return Err(Fault::new(Place::Whole, reason));
        }
        check_steps(steps).map(|()| Self { size, steps, samples })
    }

    /// Samples along each axis, the fastest first.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// From a sample to the next of each axis, in the file's unit.
    pub fn steps(&self) -> [DVec3; 3] {
        self.steps
    }

    /// The first axis fastest; not all need be finite.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// The same, without the rest.
    pub fn into_samples(self) -> Vec<f32> {
        self.samples
    }
}

/// Passes where three steps span space, none beyond what single precision holds.
pub(super) fn check_steps(steps: [DVec3; 3]) -> Result<(), Fault> {
    const RANGE: std::ops::RangeInclusive<f64> = 1e-12..=1e12;
    let lengths = steps.map(DVec3::length);
    let volume = DMat3::from_cols_array_2d(&steps.map(|s| s.to_array())).determinant().abs();
    // By the lengths' product it is 1 at right angles.
    if lengths.iter().all(|length| RANGE.contains(length)) && volume > 1e-3 * lengths.iter().product::<f64>() {
        return Ok(());
    }
    let text = steps.map(|step| format!("({:?}, {:?}, {:?})", step.x, step.y, step.z)).join(", ");
    let reason = format!("its axes go {text} from sample to sample; they must span space, in steps of 1e-12 to 1e12");
    Err(Fault::new(Place::Whole, reason))
}

/// The sizes of a grid's axes, fastest first.
///
/// # Errors
/// A size of 0 or beyond [`VoxelGrid::MOST_SIDE`].
pub(super) fn check_size(size: [u64; 3]) -> Result<[u32; 3], String> {
    if size.iter().all(|side| (1..=VoxelGrid::MOST_SIDE).contains(side)) {
        return Ok(size.map(|side| side as u32));
    }
    let [x, y, z] = size;
    Err(format!("asks for {x} x {y} x {z} samples; an axis has 1 to {}", VoxelGrid::MOST_SIDE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_span_space() {
        let new = |steps| VoxelGrid::new([1, 2, 1], steps, vec![0.0, 1.0]);
        assert!(new(DMat3::IDENTITY.to_cols_array_2d().map(DVec3::from)).is_ok());
        let flat = new([DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 1e-9)]).unwrap_err().to_string();
        assert!(flat.contains("must span space"), "{flat}");
        assert!(new([DVec3::X, DVec3::Y, DVec3::NAN]).is_err() && new([DVec3::X, DVec3::Y, DVec3::ZERO]).is_err());
        assert!(VoxelGrid::new([2, 2, 1], [DVec3::X, DVec3::Y, DVec3::Z], vec![0.0]).is_err());
        assert!(check_size([1, 0, 1]).is_err() && check_size([1, 65_537, 1]).is_err());
    }
}
