#version 450

// The pairs of water triangle and plane that may light a texel of the plane's own cell (section 6.1): a word's pairs together, then
// each alone, against the least and greatest height in the four entries of the pyramid that hold its texels, and then texel by texel
// or nearly so.

layout(local_size_x = 64) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 1) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(std430, set = 0, binding = 2) readonly buffer Bounds {
    vec4 list[];
} bounds;

layout(std430, set = 0, binding = 3) readonly buffer Pyramid {
    vec2 list[]; // least and greatest height, level after level, row by row
} pyramid;

layout(std430, set = 0, binding = 4) readonly buffer Cells {
    Cell list[];
} cells;

layout(std430, set = 0, binding = 5) buffer Kept {
    uint list[]; // a bit for each pair, plane after plane
} kept;

// True where a rectangle of texels, and what a rasteriser's rounding adds to it, may meet a height of the cell.
bool meets(vec2 low, vec2 high, Cell cell) {
    float size = float(cull.map_size);
    // A texel for the rasteriser's rounding, and what single precision leaves of places far away.
    vec2 farthest = max(abs(low), abs(high));
    float slack = 1.0 + 1.0e-5 * max(farthest.x, farthest.y);
    low -= slack;
    high += slack;
    if (!(low.x < size && low.y < size && high.x >= 0.0 && high.y >= 0.0)) {
        return false;
    }
    uvec2 from = uvec2(clamp(low, vec2(0.0), vec2(size - 1.0)));
    uvec2 to = uvec2(clamp(high, vec2(0.0), vec2(size - 1.0)));
    uint first = 0u;
    uint level_size = cull.map_size;
    for (uint level = 0u; level < 16u; level++) {
        uvec2 span = to - from;
        if (max(span.x, span.y) <= 1u || level + 1u >= cull.levels) {
            break;
        }
        from /= 2u;
        to /= 2u;
        first += level_size * level_size;
        level_size = (level_size + 1u) / 2u;
    }
    for (uint i = 0u; i < 4u; i++) {
        uvec2 at = uvec2((i & 1u) == 0u ? from.x : to.x, i < 2u ? from.y : to.y);
        vec2 range = pyramid.list[first + at.y * level_size + at.x];
        if (range.x < cell.upper && range.y >= cell.lower) {
            return true;
        }
    }
    return false;
}

// Greatest signed distance of a square's points from the side from `a` to `b`, times the side's length, positive inside.
float inside_by(vec2 a, vec2 b, float turn, vec2 middle, float half_side) {
    vec2 across = turn * vec2(a.y - b.y, b.x - a.x);
    return dot(across, middle - a) + (abs(across.x) + abs(across.y)) * half_side;
}

// The same for a triangle, down to its texels where it is no longer than six of them: the pyramid's entries that it meets.
bool triangle_meets(vec2 a, vec2 b, vec2 c, Cell cell) {
    float size = float(cull.map_size);
    vec2 farthest = max(abs(a), max(abs(b), abs(c)));
    float slack = 1.0e-5 * max(farthest.x, farthest.y);
    vec2 low = clamp(min(a, min(b, c)) - 1.0 - slack, vec2(0.0), vec2(size - 1.0));
    vec2 high = clamp(max(a, max(b, c)) + 1.0 + slack, vec2(0.0), vec2(size - 1.0));
    uvec2 from = uvec2(low);
    uvec2 to = uvec2(high);
    uint first = 0u;
    uint level_size = cull.map_size;
    float entry = 1.0; // texels a side
    for (uint level = 0u; level < 16u; level++) {
        uvec2 span = to - from;
        if (max(span.x, span.y) <= 7u || level + 1u >= cull.levels) {
            break;
        }
        from /= 2u;
        to /= 2u;
        first += level_size * level_size;
        level_size = (level_size + 1u) / 2u;
        entry *= 2.0;
    }
    // Half an entry, and what rounding adds, of a rasteriser and here.
    float half_side = 0.5 * entry + 0.1 + slack;
    float turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) < 0.0 ? -1.0 : 1.0;
    uvec2 count = min(to - from + 1u, uvec2(8u));
    for (uint i = 0u; i < count.x * count.y; i++) {
        uvec2 at = from + uvec2(i % count.x, i / count.x);
        vec2 range = pyramid.list[first + at.y * level_size + at.x];
        if (range.x < cell.upper && range.y >= cell.lower) {
            vec2 middle = (vec2(at) + 0.5) * entry;
            float inside = min(inside_by(a, b, turn, middle, half_side),
                min(inside_by(b, c, turn, middle, half_side), inside_by(c, a, turn, middle, half_side)));
            if (inside >= 0.0) {
                return true;
            }
        }
    }
    return false;
}

void main() {
    uint word = gl_GlobalInvocationID.x;
    uint plane = gl_GlobalInvocationID.y;
    if (word >= cull.words || plane >= cull.planes) {
        return;
    }
    Cell cell = cells.list[plane];
    vec4 first = bounds.list[2u * word];
    vec4 last = bounds.list[2u * word + 1u];
    float span = cull.first_height - cull.last_height;
    float fraction = span > 0.0 ? clamp((cull.first_height - cell.height) / span, 0.0, 1.0) : 0.0;
    vec4 together = mix(first, last, fraction);
    uint bits = 0u;
    if (first.x <= first.z && meets(together.xy, together.zw, cell)) {
        for (uint i = 0u; i < 32u; i++) {
            uint triangle = 32u * word + i;
            if (triangle < cull.triangles) {
                Ray a = rays.list[indices.list[3u * triangle]];
                Ray b = rays.list[indices.list[3u * triangle + 1u]];
                Ray c = rays.list[indices.list[3u * triangle + 2u]];
                // Without a lit corner nothing is lit. With an unlit one far away, rounding leaves light at the others, as in the level map.
                float highest = max(a.origin.y, max(b.origin.y, c.origin.y));
                if (max(a.enters, max(b.enters, c.enters)) > 0.0 && highest > cell.height) {
                    vec2 at_a = texel_place(a, cell.height);
                    vec2 at_b = texel_place(b, cell.height);
                    vec2 at_c = texel_place(c, cell.height);
                    if (meets(min(at_a, min(at_b, at_c)), max(at_a, max(at_b, at_c)), cell)
                        && triangle_meets(at_a, at_b, at_c, cell)) {
                        bits |= 1u << i;
                    }
                }
            }
        }
    }
    kept.list[plane * cull.words + word] = bits;
}
