#version 450

#pragma variants OPACITY=plain,gas

// What the triangles leave in the pixels of their boxes, appended to the pixels' lists.

#include "gas/counts.glsl"
#include "gas/footprint.glsl"
#include "gas/loops.glsl"
#include "gas/lists.glsl"
#include "gas/counters.glsl"
#include "gas/fragment.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[]; // of each pixel's list
};

layout(set = 0, binding = 8, std430) buffer Links {
    uvec4 links[]; // each a Link
};

layout(set = 0, binding = 9, std430) buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(location = 0) flat in vec4 corners_ab;
layout(location = 1) flat in vec4 corners_cd;
layout(location = 2) flat in uint seen_triangle;

void main() {
    read_counts();
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    Fragment fragment = fragment_of(facet_of(seen_triangle), corners_ab, corners_cd, vec2(pixel));
    if (!fragment.is_there) {
        return;
    }
    uint slot = atomicAdd(fragment_count, 1u);
    if (slot >= frame.fragment_capacity) {
        if (slot >= MOST_SLOTS) {
            atomicAdd(fragment_count, 0xffffffffu);
        }
        return; // counted: the host grows the buffers and repeats the run
    }
    fragment.link.next = atomicExchange(heads[list_of(pixel)], slot);
    links[slot] = link_words(fragment.link);
    surfaces[slot] = surface_words(fragment.surface);
    colors[slot] = color_words(fragment.color);
}
