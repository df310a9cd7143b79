#version 450

// The position map as a list, which kernels read faster than an image where a CPU samples, and a level of its pyramid (section 6.1);
// the finest and the one above it together.

#include "caustics/pyramid.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(std430, set = 0, binding = 2) buffer Pyramid {
    vec2 list[];
} pyramid;

layout(std430, set = 0, binding = 3) buffer Heights {
    float list[]; // of the texels, row by row
} heights;

layout(push_constant) uniform Level {
    uint number; // from 1
    uint count; // of levels
    uint map_size; // texels a side
} level;

// Entries a side.
uint size_of(uint number) {
    return (level.map_size + (1u << number) - 1u) >> number;
}

vec2 texel(uint x, uint y) {
    uint last = level.map_size - 1u;
    x = min(x, last);
    y = min(y, last);
    float height = texelFetch(sampler2D(position_map, nearest), ivec2(uvec2(x, y)), 0).r;
    heights.list[y * level.map_size + x] = height;
    return height > -1.0e29 ? vec2(height) : NOTHING;
}

// An entry of the finest level.
vec2 finest(uint x, uint y) {
    uint last = size_of(1u) - 1u;
    x = min(x, last);
    y = min(y, last);
    vec2 entry = joined(joined(texel(2u * x, 2u * y), texel(2u * x + 1u, 2u * y)),
        joined(texel(2u * x, 2u * y + 1u), texel(2u * x + 1u, 2u * y + 1u)));
    pyramid.list[y * row_of_entries(level.map_size) + x] = entry;
    return entry;
}

// An entry of the level under this one.
vec2 finer(uint x, uint y) {
    uint last = size_of(level.number - 1u) - 1u;
    uint first = first_entry(level.number - 1u, level.count, level.map_size);
    return pyramid.list[first + min(y, last) * row_of_entries(level.map_size) + min(x, last)];
}

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    bool is_finest = level.number == 1u;
    uint to = is_finest ? 2u : level.number;
    if (max(at.x, at.y) >= size_of(to)) {
        return;
    }
    uint x = 2u * at.x;
    uint y = 2u * at.y;
    vec2 entry = NOTHING;
    if (is_finest) {
        entry = joined(joined(finest(x, y), finest(x + 1u, y)), joined(finest(x, y + 1u), finest(x + 1u, y + 1u)));
    } else {
        entry = joined(joined(finer(x, y), finer(x + 1u, y)), joined(finer(x, y + 1u), finer(x + 1u, y + 1u)));
    }
    if (to <= level.count) {
        pyramid.list[first_entry(to, level.count, level.map_size) + at.y * row_of_entries(level.map_size) + at.x] = entry;
    }
}
