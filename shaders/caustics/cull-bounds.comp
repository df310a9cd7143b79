#version 450

// The texels that a word of water triangles can light on the uppermost and on the lowest plane (section 6.1). A ray's place is linear
// in the plane's height, so that between the two planes the bounds lie inside those in between.

layout(local_size_x = 64) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 1) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(std430, set = 0, binding = 2) buffer Bounds {
    vec4 list[]; // least and greatest place on the uppermost plane, then on the lowest, texels
} bounds;

void main() {
    uint word = gl_GlobalInvocationID.x;
    if (word >= cull.words) {
        return;
    }
    vec4 first = vec4(1.0e30, 1.0e30, -1.0e30, -1.0e30);
    vec4 last = first;
    for (uint i = 0u; i < 32u; i++) {
        uint triangle = 32u * word + i;
        if (triangle < cull.triangles) {
            Ray a = rays.list[indices.list[3u * triangle]];
            Ray b = rays.list[indices.list[3u * triangle + 1u]];
            Ray c = rays.list[indices.list[3u * triangle + 2u]];
            // A triangle none of whose rays enters lights nothing.
            if (max(a.enters, max(b.enters, c.enters)) > 0.0) {
                vec2 at_a = texel_place(a, cull.first_height);
                vec2 at_b = texel_place(b, cull.first_height);
                vec2 at_c = texel_place(c, cull.first_height);
                first.xy = min(first.xy, min(at_a, min(at_b, at_c)));
                first.zw = max(first.zw, max(at_a, max(at_b, at_c)));
                at_a = texel_place(a, cull.last_height);
                at_b = texel_place(b, cull.last_height);
                at_c = texel_place(c, cull.last_height);
                last.xy = min(last.xy, min(at_a, min(at_b, at_c)));
                last.zw = max(last.zw, max(at_a, max(at_b, at_c)));
            }
        }
    }
    bounds.list[2u * word] = first;
    bounds.list[2u * word + 1u] = last;
}
