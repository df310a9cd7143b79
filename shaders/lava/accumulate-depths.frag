#version 450

// Numerator and denominator of eq. 6.3: the splat's height times its Gaussian in red, the Gaussian in alpha.

#include "lava/depth-splat.glsl"
#include "lava/gaussian.glsl"

layout(location = 0) flat in vec3 center_m;

layout(location = 0) out vec4 accumulated;

// Grid points lie at multiples of the spacing, so many lie on the radius but for rounding: they count, everywhere.
const float ON_THE_RADIUS = 1.00001;

void main() {
    vec2 across_m = gl_FragCoord.xy / grid.columns * grid.space_m - center_m.xz;
    float ratio_squared = dot(across_m, across_m) / (grid.radius_m * grid.radius_m);
    if (ratio_squared > ON_THE_RADIUS) {
        discard;
    }
    float weight = gaussian(ratio_squared);
    accumulated = vec4(weight * center_m.y, 0.0, 0.0, weight);
}
