use glam::DVec2;

/// Map coordinates of a grid, north up, as its source states them: degrees of longitude and latitude, or units of a projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates {
    /// East (x) and north (y) of the middle of the first column's and row's sample.
    pub north_west: DVec2,
    /// From one column east to the next, and from one row south to the next, both positive.
    pub step: DVec2,
}

impl Coordinates {
    /// Column and row, both of any fraction, at which a place lies; whole numbers are the middles of samples.
    pub fn node(&self, place: DVec2) -> DVec2 {
        (place - self.north_west) * DVec2::new(1.0, -1.0) / self.step
    }

    /// The north-west and the south-east corner of a picture of so many columns and rows: half a step beyond its outermost
    /// samples' middles.
    pub fn corners(&self, columns: u32, rows: u32) -> [DVec2; 2] {
        let south_east = DVec2::new(1.0, -1.0) * self.step;
        let first = self.north_west - south_east / 2.0;
        [first, first + south_east * DVec2::new(columns.into(), rows.into())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_half_a_step_beyond_the_nodes() {
        let grid = Coordinates { north_west: DVec2::new(139.0, 40.0), step: DVec2::new(0.5, 0.25) };
        let [first, last] = grid.corners(4, 8);
        assert_eq!((first, last), (DVec2::new(138.75, 40.125), DVec2::new(140.75, 38.125)));
        assert_eq!((grid.node(first), grid.node(last)), (DVec2::splat(-0.5), DVec2::new(3.5, 7.5)));
    }
}
