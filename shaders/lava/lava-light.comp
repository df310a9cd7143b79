#version 450

// The fluid's surface as lamps for what lies beside it (chapter 9, "Look at other shading techniques"): squares of columns, with
// the mean of the place, the direction and the glow of those that have lava, by their area.

#extension GL_EXT_samplerless_texture_functions : require

#define SIMULATION_SPH

layout(local_size_x = 8, local_size_y = 8) in;

#include "lava/scene.glsl"
#include "lava/ground.glsl"
#include "lava/glow.glsl"
#include "lava/lamps.glsl"

layout(set = 0, binding = 1) uniform texture2D normal_height;

layout(set = 0, binding = 2, std430) buffer Lamps {
    vec4 list[]; // three of each Lamp
} lamps;

layout(push_constant, std430) uniform Squares {
    uvec2 count;
    uint side; // columns
    uint step; // columns along either axis that one in their middle stands for
} squares;

const uint MOST_SIDE = 254u; // lavapipe ends all loops of a shader after 65,535 iterations

void main() {
    uvec2 square = gl_GlobalInvocationID.xy;
    if (square.x >= squares.count.x || square.y >= squares.count.y) {
        return;
    }
    uvec2 columns = uvec2(scene.columns);
    uint steps = min((squares.side + squares.step - 1u) / squares.step, MOST_SIDE);
    vec2 column_m = scene.space_m.xz / scene.columns;
    vec4 place = vec4(0.0);
    vec3 area = vec3(0.0);
    vec3 light = vec3(0.0);
    for (uint z = 0u; z < steps; z++) {
        for (uint x = 0u; x < steps; x++) {
            uvec2 within = uvec2(x, z) * squares.step;
            uvec2 first = square * squares.side + within;
            if (first.x >= columns.x || first.y >= columns.y) {
                continue;
            }
            uvec2 count = min(uvec2(squares.step), min(uvec2(squares.side) - within, columns - first));
            uvec2 column = first + count / 2u;
            vec4 surface = texelFetch(normal_height, ivec2(column), 0);
            vec2 across = (vec2(column) + 0.5) * column_m;
            vec3 place_m = vec3(across.x, surface.w, across.y);
            float all_m2 = float(count.x * count.y) * column_m.x * column_m.y;
            float here = is_bare(place_m) ? 0.0 : all_m2 / max(surface.y, 0.05);
            place += here * vec4(place_m, 1.0);
            area += here * surface.xyz;
            light += here * glow_of(place_m);
        }
    }
    uint at = square.y * squares.count.x + square.x;
    float weight = max(place.w, 1.0e-12);
    // What folds hide from each other does not shine out of the square.
    float shining = length(area);
    lamps.list[3u * at] = vec4(place.xyz / weight, shining);
    lamps.list[3u * at + 1u] = vec4(area / max(shining, 1.0e-12), float(squares.count.x * squares.count.y));
    lamps.list[3u * at + 2u] = vec4(light / weight, 0.0);
}
