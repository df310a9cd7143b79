//! Intervals: what a value can be over a piece of a ray or of a map. The rounding of the last bits is not tracked.

use std::ops::{Add, Mul, Neg, Sub};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// Lower end, no greater than `high`.
    pub(super) low: f64,
    /// Upper end.
    pub(super) high: f64,
}

impl Interval {
    /// Both ends, in either order.
    pub(super) fn between(a: f64, b: f64) -> Self {
        Interval { low: a.min(b), high: a.max(b) }
    }

    pub(super) fn point(value: f64) -> Self {
        Interval { low: value, high: value }
    }

    pub(super) fn around(center: f64, radius: f64) -> Self {
        Interval { low: center - radius, high: center + radius }
    }

    pub(super) fn center(self) -> f64 {
        (self.low + self.high) / 2.0
    }

    pub(super) fn radius(self) -> f64 {
        (self.high - self.low) / 2.0
    }

    /// The largest absolute value.
    pub(super) fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    pub(super) fn clamp(self, low: f64, high: f64) -> Self {
        Interval { low: self.low.clamp(low, high), high: self.high.clamp(low, high) }
    }

    pub(super) fn halves(self) -> [Self; 2] {
        let center = self.center();
        [Interval { high: center, ..self }, Interval { low: center, ..self }]
    }

    pub(super) fn square(self) -> Self {
        let [a, b] = [self.low * self.low, self.high * self.high];
        let low = if self.low <= 0.0 && self.high >= 0.0 { 0.0 } else { a.min(b) };
        Interval { low, high: a.max(b) }
    }

    /// The sine's slope is at most 1; the bound is as tight as the interval is narrow.
    pub(super) fn sin(self) -> Self {
        Interval::around(self.center().sin(), self.radius()).clamp(-1.0, 1.0)
    }

    pub(super) fn cos(self) -> Self {
        Interval::around(self.center().cos(), self.radius()).clamp(-1.0, 1.0)
    }

    /// The quotient by an interval above 0.
    pub(super) fn over(self, divisor: Interval) -> Self {
        self * Interval { low: 1.0 / divisor.high, high: 1.0 / divisor.low }
    }
}

impl Add for Interval {
    type Output = Interval;

    fn add(self, other: Interval) -> Interval {
        Interval { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }
}

impl Sub for Interval {
    type Output = Interval;

    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Interval;

    fn mul(self, other: Interval) -> Interval {
        let products = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        let low = products.into_iter().fold(f64::INFINITY, f64::min);
        let high = products.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Interval { low, high }
    }
}

impl Mul<f64> for Interval {
    type Output = Interval;

    fn mul(self, factor: f64) -> Interval {
        self * Interval::point(factor)
    }
}
