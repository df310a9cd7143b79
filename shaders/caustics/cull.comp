#version 450

// The pairs of water triangle and plane that may light a texel of the plane's own cell (section 6.1). An invocation has one triangle
// and 32 planes: the group as a whole is held against the least and greatest height that the position map has where the triangle
// passes it, then groups of 8 planes, then single planes, and at last single texels.

layout(local_size_x = 32) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 1) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(std430, set = 0, binding = 2) readonly buffer Steps {
    uint groups; // 1 for a step that is taken
    uint planes;
    uint texels;
} steps;

layout(std430, set = 0, binding = 3) readonly buffer Pyramid {
    vec2 list[]; // least and greatest height, level after level, row by row
} pyramid;

layout(std430, set = 0, binding = 4) readonly buffer Cells {
    Cell list[];
} cells;

layout(std430, set = 0, binding = 5) buffer Kept {
    uint list[]; // a bit for each pair, plane after plane
} kept;

const uint GROUP = 8u;
const vec2 NOWHERE = vec2(1.0e30, -1.0e30);

// Turns through the pyramid beyond which a pair is kept unseen: a driver may end all loops of an invocation after 65,535 together.
const uint MOST_TURNS = 512u;

shared uint masks[32];
shared uint firsts[32]; // first entry of each level of the pyramid
shared uint sizes[32]; // entries a side

// A rectangle of texels, and what a rasteriser's rounding and single precision may add to it.
struct Rectangle {
    uvec2 from;
    uvec2 to;
    bool is_empty;
};

Rectangle rectangle(vec2 low, vec2 high) {
    float size = float(cull.map_size);
    // A texel for the rasteriser's rounding, and what single precision leaves of places far away.
    vec2 farthest = max(abs(low), abs(high));
    float slack = 1.0 + 1.0e-5 * max(farthest.x, farthest.y);
    low -= slack;
    high += slack;
    bool meets_map = low.x < size && low.y < size && high.x >= 0.0 && high.y >= 0.0;
    return Rectangle(uvec2(clamp(low, vec2(0.0), vec2(size - 1.0))), uvec2(clamp(high, vec2(0.0), vec2(size - 1.0))), !meets_map);
}

// The finest level on which a rectangle is no more than two entries wide and high, or the one above it.
uint level_of(Rectangle texels) {
    uvec2 span = texels.to - texels.from;
    uint longest = max(span.x, span.y);
    return longest > 1u ? min(uint(findMSB(longest - 1u)) + 1u, cull.levels - 1u) : 0u;
}

// Least and greatest height, of those that the four entries around the rectangle have in common with the heights from `lower` to
// `upper`.
vec2 heights_within(Rectangle texels, float lower, float upper) {
    vec2 found = NOWHERE;
    if (texels.is_empty) {
        return found;
    }
    uint level = level_of(texels);
    uint first = firsts[level];
    uint level_size = sizes[level];
    texels.from >>= level;
    texels.to >>= level;
    for (uint i = 0u; i < 4u; i++) {
        uvec2 at = uvec2((i & 1u) == 0u ? texels.from.x : texels.to.x, i < 2u ? texels.from.y : texels.to.y);
        vec2 range = pyramid.list[first + at.y * level_size + at.x];
        if (range.x < upper && range.y >= lower) {
            found = vec2(min(found.x, range.x), max(found.y, range.y));
        }
    }
    return found;
}

// The sides of a triangle, each by its inner normal and what it adds: not below 0 inside.
struct Sides {
    vec3 x;
    vec3 y;
    vec3 added;
    vec3 reach; // by which a point a texel away along x and along y may be further inside
};

// True where the square around a middle may have a point inside.
bool touches(Sides sides, vec2 middle, float half_side) {
    vec3 inside = sides.x * middle.x + sides.y * middle.y + sides.added + sides.reach * half_side;
    return min(inside.x, min(inside.y, inside.z)) >= 0.0;
}

// Every second bit of a number, from the lowest on.
uint every_second(uint bits) {
    bits &= 0x55555555u;
    bits = (bits | (bits >> 1u)) & 0x33333333u;
    bits = (bits | (bits >> 2u)) & 0x0f0f0f0fu;
    bits = (bits | (bits >> 4u)) & 0x00ff00ffu;
    return (bits | (bits >> 8u)) & 0x0000ffffu;
}

// True where a triangle may cover a sample of a texel whose height lies in the cell: down the pyramid from the entries that hold
// the triangle, in Morton order.
bool covers(vec2 a, vec2 b, vec2 c, Cell cell) {
    Rectangle texels = rectangle(min(a, min(b, c)), max(a, max(b, c)));
    if (texels.is_empty) {
        return false;
    }
    vec2 farthest = max(abs(a), max(abs(b), abs(c)));
    // What rounding adds, of a rasteriser and here.
    float slack = 0.1 + 1.0e-5 * max(farthest.x, farthest.y);
    float turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) < 0.0 ? -1.0 : 1.0;
    Sides sides;
    sides.x = turn * vec3(a.y - b.y, b.y - c.y, c.y - a.y);
    sides.y = turn * vec3(b.x - a.x, c.x - b.x, a.x - c.x);
    // From the first corner, where numbers are small.
    sides.added = -vec3(0.0, sides.x.y * (b.x - a.x) + sides.y.y * (b.y - a.y), 0.0);
    sides.reach = abs(sides.x) + abs(sides.y);

    uint top = level_of(texels);
    if (top > 14u) {
        return true; // beyond what 32 bits number
    }
    uvec2 base = (texels.from >> top) << top;
    uint end = 4u << (2u * top);
    uint place = 0u; // of the first texel of an entry
    uint level = top;
    for (uint turns = 0u; turns < MOST_TURNS && place < end; turns++) {
        uvec2 texel = base + uvec2(every_second(place), every_second(place >> 1u));
        uvec2 at = texel >> level;
        uint size = sizes[level];
        bool is_met = all(lessThanEqual(texel, texels.to)) && max(at.x, at.y) < size;
        if (is_met) {
            vec2 range = pyramid.list[firsts[level] + at.y * size + at.x];
            float entry = float(1u << level);
            // The square of the samples of the entry's texels.
            is_met = range.x < cell.upper && range.y >= cell.lower
                && touches(sides, vec2(texel) + 0.5 * entry - a, 0.5 * entry - cull.inset + slack);
        }
        if (is_met && level == 0u) {
            return true;
        }
        if (is_met) {
            level--;
        } else {
            place += 1u << (2u * level);
            level = min(uint(findLSB(place)) / 2u, top);
        }
    }
    return place < end;
}

void main() {
    uint word = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint lane = gl_LocalInvocationID.x;
    uint triangle = 32u * word + lane;
    uint base = 32u * gl_WorkGroupID.z;
    uint from = base;
    uint to = min(base + 32u, cull.planes);
    uint mask = 0u;
    uint first_entry = 0u;
    uint level_size = cull.map_size;
    for (uint level = 0u; level < min(lane, cull.levels); level++) {
        first_entry += level_size * level_size;
        level_size = (level_size + 1u) / 2u;
    }
    firsts[lane] = first_entry;
    sizes[lane] = level_size;
    barrier();
    if (word < cull.words && triangle < cull.triangles) {
        Ray a = rays.list[indices.list[3u * triangle]];
        Ray b = rays.list[indices.list[3u * triangle + 1u]];
        Ray c = rays.list[indices.list[3u * triangle + 2u]];
        // Without a lit corner nothing is lit. With an unlit one far away, rounding leaves light at the others, as in the level map.
        bool enters = max(a.enters, max(b.enters, c.enters)) > 0.0;
        float highest = max(a.origin.y, max(b.origin.y, c.origin.y));
        if (!enters) {
            to = from;
        }
        // The way from the first plane to the last is linear, and so lies between its ends: heights that it meets bound the planes, and
        // these the way.
        for (uint round = 0u; round < 3u * steps.groups; round++) {
            if (from < to) {
                float first = cells.list[from].height;
                float last = cells.list[to - 1u].height;
                vec2 a_first = texel_place(a, first);
                vec2 b_first = texel_place(b, first);
                vec2 c_first = texel_place(c, first);
                vec2 a_last = texel_place(a, last);
                vec2 b_last = texel_place(b, last);
                vec2 c_last = texel_place(c, last);
                vec2 low = min(min(a_first, min(b_first, c_first)), min(a_last, min(b_last, c_last)));
                vec2 high = max(max(a_first, max(b_first, c_first)), max(a_last, max(b_last, c_last)));
                vec2 heights = heights_within(rectangle(low, high), cells.list[to - 1u].lower, cells.list[from].upper);
                // A cell more on each side for what rounding may do.
                vec2 places = (cull.top - heights.yx) * cull.cells_per_m;
                uint above = uint(clamp(places.x - 1.0, 0.0, float(cull.planes)));
                uint under = uint(clamp(places.y + 2.0, 0.0, float(cull.planes)));
                from = max(from, above);
                to = heights.x > heights.y ? from : min(to, under);
            }
        }
        for (uint group = from / GROUP * GROUP; group < to && from < to; group += GROUP) {
            uint first = max(from, group);
            uint end = min(to, group + GROUP);
            bool may_meet = true;
            if (steps.groups == 1u) {
                float upper_height = cells.list[first].height;
                float lower_height = cells.list[end - 1u].height;
                vec2 a_first = texel_place(a, upper_height);
                vec2 b_first = texel_place(b, upper_height);
                vec2 c_first = texel_place(c, upper_height);
                vec2 a_last = texel_place(a, lower_height);
                vec2 b_last = texel_place(b, lower_height);
                vec2 c_last = texel_place(c, lower_height);
                vec2 low = min(min(a_first, min(b_first, c_first)), min(a_last, min(b_last, c_last)));
                vec2 high = max(max(a_first, max(b_first, c_first)), max(a_last, max(b_last, c_last)));
                vec2 heights = heights_within(rectangle(low, high), cells.list[end - 1u].lower, cells.list[first].upper);
                may_meet = heights.x <= heights.y;
            }
            if (may_meet) {
                for (uint plane = first; plane < end; plane++) {
                    Cell cell = cells.list[plane];
                    if (highest > cell.height) {
                        vec2 at_a = texel_place(a, cell.height);
                        vec2 at_b = texel_place(b, cell.height);
                        vec2 at_c = texel_place(c, cell.height);
                        bool is_kept = true;
                        if (steps.planes == 1u) {
                            vec2 low = min(at_a, min(at_b, at_c));
                            vec2 high = max(at_a, max(at_b, at_c));
                            vec2 heights = heights_within(rectangle(low, high), cell.lower, cell.upper);
                            is_kept = heights.x <= heights.y;
                        }
                        if (is_kept && steps.texels == 1u) {
                            is_kept = covers(at_a, at_b, at_c, cell);
                        }
                        mask |= is_kept ? 1u << (plane - base) : 0u;
                    }
                }
            }
        }
    }
    // From planes of a triangle to triangles of a plane.
    masks[lane] = mask;
    barrier();
    uint plane = base + lane;
    if (word < cull.words && plane < cull.planes) {
        uint bits = 0u;
        for (uint i = 0u; i < 32u; i++) {
            bits |= (masks[i] >> lane & 1u) << i;
        }
        kept.list[plane * cull.words + word] = bits;
    }
}
