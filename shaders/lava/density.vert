#version 450

// A particle of the cluster as a point (section 6.1).

#include "lava/density.glsl"

layout(location = 0) in vec3 position;

layout(location = 0) flat out vec3 center_m;

void main() {
    center_m = position;
    // A point whose centre is clipped vanishes whole: rounding must not push one on the border out.
    vec2 place = clamp(2.0 * position.xz / grid.space_m.xz - 1.0, -1.0, 1.0);
    gl_Position = vec4(place, 0.5, 1.0);
    gl_PointSize = grid.point_size_px;
}
