#version 450

// The metaball of eq. 6.2 at one grid point of four planes. With a = r / h the polynomial is
// 1 - 22/9 a^2 + 17/9 a^4 - 4/9 a^6 = (1 - a^2)^2 (1 - 4/9 a^2), which needs no cancelling of large terms.

#include "lava/density.glsl"

layout(location = 0) flat in vec3 center_m;

layout(location = 0) out vec4 density;

void main() {
    vec2 across_m = gl_FragCoord.xy / grid.columns * grid.space_m.xz - center_m.xz;
    vec4 up_m = grid.plane_heights_m - center_m.y;
    vec4 a_squared = (dot(across_m, across_m) + up_m * up_m) / (grid.radius_m * grid.radius_m);
    vec4 inside = max(1.0 - a_squared, 0.0);
    density = grid.peak * inside * inside * (1.0 - 4.0 / 9.0 * a_squared);
}
