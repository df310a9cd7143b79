#version 450

// Temperature of the surface, and of what glows of it, in the middle of each column of the grid, and how far the rock has been carried: the particles' around it, by the kernel along x and z,
// and by how far above or below the surface they lie, half the weight for each half distance of particles. They are taken
// where the step has brought them, from the cells in which it began.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

#include "lava/sph.glsl"
#include "lava/face.glsl"
#include "lava/crowded.glsl"
#include "lava/stretches.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) readonly buffer Heat {
    vec2 list[]; // kelvin as the step ends
} heat;

layout(set = 0, binding = 6) uniform texture2D normal_height;

layout(set = 0, binding = 7, rgba32f) uniform image2D temperatures;

layout(set = 0, binding = 8, std430) readonly buffer Carried {
    vec4 list[]; // metres along x and z, of both layings of the rock
} carried;

layout(set = 0, binding = 9, rgba32f) uniform image2D surface_carried;

layout(set = 0, binding = 10, std430) readonly buffer Face {
    float radiance;
} face;

const float HALVES_A_SUPPORT = 4.8; // the kernel's radius is 2.4 distances of particles
const float MOST_HALVINGS = 40.0;

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec2 columns = imageSize(temperatures);
    if (column.x >= columns.x || column.y >= columns.y) {
        return;
    }
    vec2 middle_m = (vec2(column) + 0.5) / vec2(columns) * flow.space_m.xz;
    vec3 place_m = vec3(middle_m.x, texelFetch(normal_height, column, 0).w, middle_m.y);
    ivec2 cell = cell_of(vec3(place_m.x, 0.0, place_m.z)).xz;
    // Lower ones weigh 2^-40 of one at the surface, and 2^-35 if the step has moved them by the kernel's radius.
    float reach_m = MOST_HALVINGS / HALVES_A_SUPPORT * flow.support_m;
    float weights = 0.0;
    float sum = 0.0;
    vec4 carried_m = vec4(0.0);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_near(cell, ivec2(x, z), place_m.y, reach_m, MOST);
            for (uint i = stretch.x; i < stretch.y; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz) / flow.support_m;
                float halvings = min(HALVES_A_SUPPORT * abs(way.y), MOST_HALVINGS);
                float weight = kernel(length(way.xz)) * exp2(-halvings);
                weights += weight;
                sum += weight * heat.list[i].x;
                carried_m += weight * carried.list[i];
            }
        }
    }
    if (is_crowded) {
        crowded.by_temperature = 1u;
    }
    bool is_there = weights > 0.0;
    float kelvin = is_there ? sum / weights : 0.0;
    vec2 found = is_there ? vec2(face_k(kelvin, face.radiance), 1.0) : vec2(0.0);
    imageStore(temperatures, column, vec4(found, flow.share, kelvin));
    imageStore(surface_carried, column, is_there ? carried_m / weights : vec4(0.0));
}
