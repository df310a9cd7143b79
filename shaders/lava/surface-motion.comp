#version 450

// The motion of the surface in the middle of each column of the grid, for its crust: the speeds along x and z of the particles around it, by
// the weights of surface-temperature; the mean temperature of the lava under it, by the kernel along x and z alone; and the depth of
// lava above the ground.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

#include "lava/sph.glsl"
#include "lava/sph-began.glsl"
#include "lava/bed.glsl"
#include "lava/crowded.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) readonly buffer Heat {
    vec2 list[]; // kelvin as the step ends
} heat;

layout(set = 0, binding = 6) uniform texture2D normal_height;

layout(set = 0, binding = 7, rgba32f) uniform image2D motion;

const float HALVES_A_SUPPORT = 4.8; // the kernel's radius is 2.4 distances of particles
const float MOST_HALVINGS = 40.0;

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec2 columns = imageSize(motion);
    if (column.x >= columns.x || column.y >= columns.y) {
        return;
    }
    vec2 share = (vec2(column) + 0.5) / vec2(columns);
    vec2 middle_m = share * flow.space_m.xz;
    vec3 place_m = vec3(middle_m.x, texelFetch(normal_height, column, 0).w, middle_m.y);
    ivec2 cell = cell_of(vec3(place_m.x, 0.0, place_m.z)).xz;
    int highest = int(flow.counts.y) - 1;
    vec2 way_m = vec2(0.0);
    float warmth = 0.0;
    vec2 weights = vec2(0.0);
    bool is_crowded = false;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_of(cell, ivec2(x, z), 0, highest);
            // Of too many the highest. All count alike for the mean temperature, so that none may be left out.
            uint first = max(stretch.x, max(stretch.y, MOST) - MOST);
            is_crowded = is_crowded || first > stretch.x;
            for (uint i = first; i < stretch.y; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz) / flow.support_m;
                float halvings = min(HALVES_A_SUPPORT * abs(way.y), MOST_HALVINGS);
                float near = kernel(length(way.xz));
                float weight = near * exp2(-halvings);
                weights += vec2(weight, near);
                way_m += weight * (predicted.list[i].xz - began_m(i).xz);
                warmth += near * heat.list[i].x;
            }
        }
    }
    if (is_crowded) {
        crowded.by_motion = 1u;
    }
    bool is_there = weights.x > 0.0;
    vec3 found = is_there ? vec3(way_m / (weights.x * flow.time_step_s), warmth / weights.y) : vec3(0.0);
    imageStore(motion, column, vec4(found, max(place_m.y - bed_at(share).z, 0.0)));
}
