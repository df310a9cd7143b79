#version 450

// A level of the position map's pyramid (section 6.1): least and greatest height in a square of texels; the finest and the one above
// it together. Places without a receiver have neither.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(std430, set = 0, binding = 2) buffer Pyramid {
    vec2 list[]; // least and greatest height, level after level, row by row
} pyramid;

layout(push_constant) uniform Level {
    uint from; // first entry of the finer level; this one's own where it is the finest
    uint from_size; // entries a side of the finer level
    uint to; // first entry of this level
    uint to_size; // entries a side
} level;

vec2 joined(vec2 a, vec2 b) {
    return vec2(min(a.x, b.x), max(a.y, b.y));
}

vec2 finer(uint x, uint y) {
    uint last = level.from_size - 1u;
    return pyramid.list[level.from + min(y, last) * level.from_size + min(x, last)];
}

// A texel of the map, as an entry of the finest level.
vec2 finest(uint x, uint y) {
    uint last = level.to_size - 1u;
    uvec2 texel = uvec2(min(x, last), min(y, last));
    float height = texelFetch(sampler2D(position_map, nearest), ivec2(texel), 0).r;
    vec2 bounds = height > -1.0e29 ? vec2(height) : vec2(1.0e30, -1.0e30);
    pyramid.list[texel.y * level.to_size + texel.x] = bounds;
    return bounds;
}

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    bool is_finest = level.from == level.to;
    uint size = is_finest ? (level.to_size + 1u) / 2u : level.to_size;
    if (max(at.x, at.y) >= size) {
        return;
    }
    uvec2 first = 2u * at;
    if (is_finest) {
        vec2 bounds = joined(joined(finest(first.x, first.y), finest(first.x + 1u, first.y)),
            joined(finest(first.x, first.y + 1u), finest(first.x + 1u, first.y + 1u)));
        if (level.to_size > 1u) {
            pyramid.list[level.to_size * level.to_size + at.y * size + at.x] = bounds;
        }
    } else {
        pyramid.list[level.to + at.y * size + at.x] =
            joined(joined(finer(first.x, first.y), finer(first.x + 1u, first.y)),
                joined(finer(first.x, first.y + 1u), finer(first.x + 1u, first.y + 1u)));
    }
}
