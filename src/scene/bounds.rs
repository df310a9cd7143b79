use glam::Vec3;

/// An axis-aligned box, corners included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Corner with the smallest coordinates, in the unit of the points.
    pub min: Vec3,
    /// Corner with the largest coordinates, in the unit of the points.
    pub max: Vec3,
}

impl Bounds {
    /// The bounds of no points at all: `min` is +infinity, `max` -infinity. It is neutral under
    /// [`Bounds::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`; [`Bounds::EMPTY`] without any.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |bounds, point| Self { min: bounds.min.min(point), max: bounds.max.max(point) })
    }

    /// True for a box that holds no point.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The middle of the box; the origin when the box is empty.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        self.min * 0.5 + self.max * 0.5
    }

    /// The vector from `min` to `max`; its length is the diameter of the box. Zero when the box is
    /// empty.
    pub fn diagonal(&self) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        self.max - self.min
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// True for a point inside the box or on its surface.
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn union_holds_the_points_of_both() {
        let a = Bounds::of_points([Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 4.0, 3.0)]);
        let b = Bounds::of_points([Vec3::new(5.0, -2.0, 2.5)]);
        let both = a.union(&b);
        assert_eq!(both.min, Vec3::new(-1.0, -2.0, 2.0));
        assert_eq!(both.max, Vec3::new(5.0, 4.0, 3.0));
        assert_eq!(both.center(), Vec3::new(2.0, 1.0, 2.5));
        assert_eq!(both.diagonal(), Vec3::new(6.0, 6.0, 1.0));
        assert!(both.contains(b.min) && both.contains(both.max));
        assert!(!both.contains(Vec3::new(5.1, 0.0, 2.5)));
    }

    #[test]
    fn empty_bounds_are_neutral_and_finite() {
        let some = Bounds::of_points([Vec3::ONE, Vec3::ZERO]);
        assert_eq!(Bounds::EMPTY.union(&some), some);
        assert!(Bounds::of_points([]).is_empty() && !some.is_empty());
        assert_eq!(Bounds::EMPTY.center(), Vec3::ZERO);
        assert_eq!(Bounds::EMPTY.diagonal(), Vec3::ZERO);
        assert!(!Bounds::EMPTY.contains(Vec3::ZERO));
    }
}
