//! Densities of files: samples on a grid, interpolated.

use glam::{DMat3, DVec3};

use crate::choice;

/// Samples of the density of a volume, in the middle of whose box they lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Samples along each axis, the fastest first.
    pub size: [u32; 3],
    /// From a sample to the next of each axis, metres in the world; they span space.
    pub steps_m: [DVec3; 3],
    /// 0 where the density is 0, 1 where it is 1; beyond these it is cut off once it is interpolated.
    pub samples: Vec<f32>,
    /// Light of a black body of each sample's temperature, linear RGB; none without temperatures.
    pub glow: Vec<[f32; 3]>,
}

choice! {
    /// Interpolation between the samples of a grid.
    pub enum Filter {
        /// Linear along each axis.
        Trilinear = ("trilinear", "Linear along each axis, of 8 samples"),
        /// Catmull's and Rom's cubic along each axis.
        Tricubic = (
            "tricubic",
            "The cubic of Catmull and Rom along each axis, of 64 samples: smooth, and through the samples",
        ),
    }
}

impl Grid {
    /// Of a volume whose own grid is not there: nothing.
    pub fn empty() -> Self {
        Grid { size: [1; 3], steps_m: [DVec3::X, DVec3::Y, DVec3::Z], samples: vec![0.0], glow: Vec::new() }
    }

    /// Samples along each axis for each metre in the world.
    pub fn samples_per_metre(&self) -> DMat3 {
        let [x, y, z] = self.steps_m;
        DMat3::from_cols(x, y, z).inverse()
    }

    /// Half the extents of the box around the grid, whose samples are in the middles of their cells; metres.
    pub fn half_extent_m(&self) -> DVec3 {
        let half = |(&count, step): (&u32, &DVec3)| step.abs() * (f64::from(count) / 2.0);
        self.size.iter().zip(&self.steps_m).map(half).sum()
    }
}
