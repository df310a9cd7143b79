#version 450

#pragma variants SIMULATION=free,sph

// Eq. 6.3's quotient and the normals from finite differences of the heights (section 6.4). Near the borders the height
// sinks to 0 and the normal turns upwards; the differences are those of the heights that have sunk, so that splats lie
// along the slope that is drawn. Where nothing was accepted the height is 0; a fluid's sinks to its bed, over the columns beside its front.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform texture2D accumulated_depths;

layout(push_constant, std430) uniform Grid {
    vec2 space_m; // along x and z
    vec2 columns; // grid points along x and z
    float border_m;
} grid;

#include "lava/bed.glsl"

#ifdef SIMULATION_SPH
float ground_m(ivec2 column) {
    return bed_at((vec2(column) + 0.5) / grid.columns).z;
}
#endif

layout(location = 0) out vec4 normal_height;

// 1 inside, falling to 0 at the borders.
float fraction_at(ivec2 column) {
    vec2 place_m = (vec2(column) + 0.5) * grid.space_m / grid.columns;
    vec2 to_border_m = min(place_m, grid.space_m - place_m);
    float nearest_m = min(to_border_m.x, to_border_m.y);
    return grid.border_m > 0.0 ? clamp(nearest_m / grid.border_m, 0.0, 1.0) : 1.0;
}

#ifdef SIMULATION_SPH
// Columns around one that count at its front.
const int FRONT = 1;

// Height above the ground. A column at the front has as large a part of it as there is lava around it, one without lava as large a part
// of the mean beside it: the front would be a stair of columns.
float lava_m(ivec2 column, float ground) {
    float weights = 0.0;
    float covered = 0.0;
    float sum = 0.0;
    for (int z = -FRONT; z <= FRONT; z++) {
        for (int x = -FRONT; x <= FRONT; x++) {
            ivec2 at = clamp(column + ivec2(x, z), ivec2(0), ivec2(grid.columns) - 1);
            vec4 sums = texelFetch(accumulated_depths, at, 0);
            float weight = exp(-0.5 * float(x * x + z * z));
            weights += weight;
            if (sums.a > 0.0) {
                covered += weight;
                sum += weight * (sums.r / sums.a - ground_m(at));
            }
        }
    }
    float share = clamp(2.0 * covered / weights - 0.5, 0.0, 1.0);
    float mean = sum / max(covered, 1.0e-20);
    vec4 own = texelFetch(accumulated_depths, column, 0);
    if (own.a > 0.0) {
        // A drop of one column keeps half of it.
        share = max(share, 0.5);
        mean = mix(mean, own.r / own.a - ground, share);
    }
    return share * mean;
}

float height_at(ivec2 column) {
    float ground = ground_m(column);
    return ground + fraction_at(column) * lava_m(column, ground);
}
#else
float height_at(ivec2 column) {
    vec4 sums = texelFetch(accumulated_depths, column, 0);
    return sums.a > 0.0 ? fraction_at(column) * sums.r / sums.a : 0.0;
}
#endif

// Height difference per metre along one axis: central, at the sides one-sided.
float slope(ivec2 column, ivec2 axis, float spacing_m) {
    ivec2 last = ivec2(grid.columns) - 1;
    ivec2 before = max(column - axis, ivec2(0));
    ivec2 after = min(column + axis, last);
    ivec2 steps = after - before;
    int count = steps.x + steps.y;
    return count > 0 ? (height_at(after) - height_at(before)) / (float(count) * spacing_m) : 0.0;
}

void main() {
    ivec2 column = ivec2(gl_FragCoord.xy);
    vec2 spacing_m = grid.space_m / grid.columns;
    vec2 slopes = vec2(slope(column, ivec2(1, 0), spacing_m.x), slope(column, ivec2(0, 1), spacing_m.y));
    vec3 normal = normalize(vec3(-slopes.x, 1.0, -slopes.y));
    vec3 turned = normalize(mix(vec3(0.0, 1.0, 0.0), normal, fraction_at(column)));
    normal_height = vec4(turned, height_at(column));
}
