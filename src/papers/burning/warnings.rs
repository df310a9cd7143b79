//! Warnings of a run: of what the mesh and the fire's place do to it.

use super::Burning;
use super::parameters::{TICKS_PER_S, Variant};

/// Diagonals by which a solid chars at least that is to be seen to do so.
const SHALLOWEST: f32 = 1e-3;

/// Of the object, and of a fire that has not come to it by the last tick.
pub fn warnings(paper: &Burning) -> Vec<String> {
    let mut warnings = Vec::new();
    if paper.model.degenerate > 0 {
        let count = paper.model.degenerate;
        warnings.push(format!("{count} triangles of the mesh have two corners in one place and are left out"));
    }
    if paper.variant == Variant::Solid && !paper.model.is_closed {
        warnings.push(
            "the mesh is not closed: how deep a solid chars follows from the volume that it encloses; close it, or \
             burn it as `shell`"
                .to_owned(),
        );
    } else if paper.variant == Variant::Solid && paper.model.char_depth < SHALLOWEST {
        warnings.push(format!(
            "the mesh encloses next to nothing: a solid chars as deep as three quarters of its volume over its surface, {} \
             diagonals here; burn it as `shell`",
            paper.model.char_depth
        ));
    }
    let nearest = paper.model.rest.iter().map(|vertex| vertex.boundary_distance).fold(f32::INFINITY, f32::min);
    let radius = paper.parameters.speed_per_s * (paper.ticks() as f64 / TICKS_PER_S) as f32;
    if paper.ticks() > 0 && nearest > radius {
        warnings.push(format!(
            "nothing burns: the heat boundary has a radius of {radius} after {} ticks, and the object begins at \
             {nearest}; move `source` nearer or burn longer",
            paper.ticks()
        ));
    }
    warnings
}
