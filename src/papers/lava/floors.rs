//! What the passes that draw many points cost at least: the same vertices and primitives with an empty fragment stage,
//! nothing written.

/// Each pass that draws points or splats with the pass that is its floor. The splats of stage three are the same twice.
pub const FLOORS: [(&str, &str); 4] = [
    ("density", "density-floor"),
    ("accumulate-depths", "accumulate-depths-floor"),
    ("visibility", "splats-floor"),
    ("blending", "splats-floor"),
];

pub(super) const EMPTY: &str = "common/empty.frag";
