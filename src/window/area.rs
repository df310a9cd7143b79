//! Rectangles of whole pixels.

use egui::Rect;

/// A rectangle of whole pixels that is not empty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Area {
    /// First column, from 0 at the window's left edge.
    pub left: u32,
    /// First row, from 0 at the window's upper edge.
    pub top: u32,
    /// Column after the last one.
    pub right: u32,
    /// Row after the last one.
    pub bottom: u32,
}

impl Area {
    /// The rectangle from the upper left corner on.
    pub fn whole((width, height): (u32, u32)) -> Self {
        Area { left: 0, top: 0, right: width, bottom: height }
    }

    /// The pixels between corners that lie on pixels' edges.
    pub fn between(left: f32, top: f32, right: f32, bottom: f32) -> Option<Self> {
        // What is not a number, or lies before the first pixel, becomes zero.
        let [left, top, right, bottom] = [left, top, right, bottom].map(|side| side as u32);
        (left < right && top < bottom).then_some(Area { left, top, right, bottom })
    }

    /// The pixels that a clip of the interface leaves, corners in points.
    pub fn of_clip(clip: Rect, pixels_per_point: f32) -> Option<Self> {
        let pixel = |side: f32| (side * pixels_per_point).round();
        Self::between(pixel(clip.min.x), pixel(clip.min.y), pixel(clip.max.x), pixel(clip.max.y))
    }

    /// The part in both.
    pub fn common(self, other: Area) -> Option<Self> {
        let (left, top) = (self.left.max(other.left), self.top.max(other.top));
        let (right, bottom) = (self.right.min(other.right), self.bottom.min(other.bottom));
        (left < right && top < bottom).then_some(Area { left, top, right, bottom })
    }

    /// The least that holds both.
    pub fn around(self, other: Area) -> Self {
        Area {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    /// All of the other lies in it.
    pub fn holds(self, other: Area) -> bool {
        self.common(other) == Some(other)
    }

    /// Width and height.
    pub fn size(self) -> (u32, u32) {
        (self.right - self.left, self.bottom - self.top)
    }

    /// Number of its pixels.
    pub fn pixels(self) -> u64 {
        let (width, height) = self.size();
        u64::from(width) * u64::from(height)
    }

    /// Pixels that a rectangle around both has beyond the two.
    pub fn waste(self, other: Area) -> i64 {
        self.around(other).pixels() as i64 - self.pixels() as i64 - other.pixels() as i64
    }
}
