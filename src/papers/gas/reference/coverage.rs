//! Coverage of a pixel by a triangle, in double precision, by cutting it (Sutherland and Hodgman).

use glam::DVec2;

/// The part of a convex polygon inside the pixel whose lower corner is `pixel`.
pub fn cut(polygon: &[DVec2], pixel: DVec2) -> Vec<DVec2> {
    let mut piece: Vec<DVec2> = polygon.iter().map(|&p| p - pixel).collect();
    let sides: [fn(DVec2) -> f64; 4] = [|p| p.x, |p| 1.0 - p.x, |p| p.y, |p| 1.0 - p.y];
    for inside in sides {
        let mut kept = Vec::new();
        for (i, &from) in piece.iter().enumerate() {
            let to = piece[(i + 1) % piece.len()];
            let (a, b) = (inside(from), inside(to));
            if a >= 0.0 {
                kept.push(from);
            }
            if (a >= 0.0) != (b >= 0.0) {
                kept.push(from + (to - from) * (a / (a - b)));
            }
        }
        piece = kept;
    }
    piece
}

/// Area of a polygon of either orientation.
pub fn area(polygon: &[DVec2]) -> f64 {
    let twice: f64 = (0..polygon.len()).map(|i| polygon[i].perp_dot(polygon[(i + 1) % polygon.len()])).sum();
    twice.abs() / 2.0
}
