#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached

// Empty space (ours; the paper evaluates its functions everywhere). The greatest density of each brick of the box around a
// volume, by a bound that holds for all of its points: of a function, of the samples of a file, or of the entries of its
// table. A brick whose density is so small that a ray through all of the volume loses no more than a given optical depth by
// it is empty.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/loops.glsl"
#include "gas/volumes-several.glsl"
#include "gas/bound-{DENSITY}.glsl"

layout(set = 0, binding = 30, std430) buffer Bricks {
    float brick_bounds[]; // a table a volume; x runs fastest
};

layout(push_constant, std430) uniform Brick {
    uint volume;
    float lost_depth; // of a ray through the volume, in brick_bounds that are taken for empty
} brick;

// Bricks overlap by this much, so that a point which rounding puts into its neighbour is bounded by both.
const float OVERLAP = 1.0e-3;
const float ROUNDING = 1.0001; // of sums and products

// The farthest inside the solid that a point of the box is, see inwardness.
float most_inward(vec3 low, vec3 high) {
    vec3 nearest = max(max(low, -high), 0.0);
    uint shape = in_hand.shape;
    if (shape == BOX) {
        vec3 inside = 1.0 - nearest;
        return min(inside.x, min(inside.y, inside.z));
    }
    if (shape == SPHERE) {
        return 1.0 - length(nearest);
    }
    vec2 radii = in_hand.radii;
    vec2 heights = clamp(0.5 * vec2(low.y, high.y) + 0.5, 0.0, 1.0);
    float radius = max(mix(radii.x, radii.y, heights.x), mix(radii.x, radii.y, heights.y));
    return min(1.0 - nearest.y, radius - length(nearest.xz));
}

void main() {
    uint n = counts.bricks;
    uvec3 at = gl_GlobalInvocationID;
    if (at.x >= n || at.y >= n || at.z >= n) {
        return;
    }
    uint v = brick.volume;
    take_volume(v);
    vec3 low = 2.0 * (vec3(at) - OVERLAP) / float(n) - 1.0;
    vec3 high = 2.0 * (vec3(at) + 1.0 + OVERLAP) / float(n) - 1.0;
    float inside = most_inward(low, high);
    float bound = 0.0;
    if (inside >= -1.0e-3) {
        bound = gas_bound(v, low, high);
        bound = bound < 1.0e30 ? bound : 1.0e30; // also where it is none
        float falloff = in_hand.falloff;
        if (falloff > 0.0) {
            float t = clamp((inside + 1.0e-5) / falloff, 0.0, 1.0);
            bound *= t * t * (3.0 - 2.0 * t);
        }
        bound *= ROUNDING;
        bound = in_hand.is_solid != 0u ? -log(1.0 - clamp(bound, 0.0, 0.9999)) : bound;
    }
    float most_m = 2.0 * length(in_hand.half_extent_m);
    bool is_empty = bound * in_hand.tau_per_m * most_m <= brick.lost_depth;
    brick_bounds[((v * n + at.z) * n + at.y) * n + at.x] = is_empty ? 0.0 : bound;
}
