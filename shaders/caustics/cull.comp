#version 450
#pragma variants PLANES=even,fitted

// The pairs of water triangle and plane that may light a texel of the plane's own cell (section 6.1). An invocation has one triangle
// and 128 planes: the group as a whole is held against the least and greatest height that the position map has where the triangle
// passes it, then groups of 32 and of 8 planes, then single planes, and at last the texels that it passes, each of which has one plane.

layout(local_size_x = 64) in;

#include "caustics/cull.glsl"
#include "caustics/pyramid.glsl"

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
    vec2 list[];
} pyramid;

layout(std430, set = 0, binding = 4) readonly buffer Cells {
    Cell list[];
} cells;

layout(std430, set = 0, binding = 5) buffer Kept {
    uint list[]; // a bit for each pair, triangle after triangle
} kept;

layout(std430, set = 0, binding = 6) readonly buffer Heights {
    float list[]; // of the position map's texels, row by row
} heights;

const uint GROUP = 8u;
// Groups of 32 planes of an invocation.
const uint PARTS = 4u;
const vec2 NOWHERE = vec2(1.0e30, -1.0e30);

// Texels beyond which the planes of a group of 32 are kept unseen: a driver may end all loops of an invocation after 65,535 turns
// together.
const uint MOST_TEXELS = 8192u;

// A rectangle of texels.
struct Rectangle {
    uvec2 from;
    uvec2 to;
    bool is_empty;
};

// The texels between two places and so far around.
Rectangle rectangle(vec2 low, vec2 high, float slack) {
    float size = float(cull.map_size);
    low -= slack;
    high += slack;
    bool meets_map = low.x < size && low.y < size && high.x >= 0.0 && high.y >= 0.0;
    return Rectangle(uvec2(clamp(low, vec2(0.0), vec2(size - 1.0))), uvec2(clamp(high, vec2(0.0), vec2(size - 1.0))), !meets_map);
}

// What single precision leaves of places far away, and a rasteriser's rounding.
float slack_at(vec2 low, vec2 high) {
    vec2 farthest = max(abs(low), abs(high));
    return 0.1 + 1.0e-5 * max(farthest.x, farthest.y);
}

// Least and greatest height, of those that the four entries around the rectangle have in common with the heights from `lower` to
// `upper`.
vec2 heights_within(Rectangle texels, float lower, float upper) {
    vec2 found = NOWHERE;
    if (texels.is_empty) {
        return found;
    }
    // The finest level on which it is no more than two entries wide and high, or the one above it.
    uvec2 span = texels.to - texels.from;
    uint longest = max(span.x, span.y);
    uint level = longest > 1u ? min(uint(findMSB(longest - 1u)) + 1u, cull.levels) : 1u;
    uint first = first_entry(level, cull.levels, cull.map_size);
    texels.from >>= level;
    texels.to >>= level;
    for (uint i = 0u; i < 4u; i++) {
        uvec2 at = uvec2((i & 1u) == 0u ? texels.from.x : texels.to.x, i < 2u ? texels.from.y : texels.to.y);
        vec2 range = pyramid.list[first + at.y * row_of_entries(cull.map_size) + at.x];
        if (range.x < upper && range.y >= lower) {
            found = vec2(min(found.x, range.x), max(found.y, range.y));
        }
    }
    return found;
}

vec2 texel_place(Ray ray, float height) {
    vec2 place = ray.origin.xz + ray.slope * (ray.origin.y - height) - cull.center;
    return place * cull.texels_per_m + 0.5 * float(cull.map_size);
}

// The plane whose cell holds a height of the receiver's, of equal cells from a first to a last: the height is so many of them under the
// first one's top. Nearer to a boundary than single precision tells, in cells, the cell's own numbers decide.
float by_cell(float place, float height, float first, float last, float near) {
    float plane = clamp(first + floor(place), first, last);
    if (abs(place - round(place)) < near) {
        Cell cell = cells.list[uint(plane)];
        plane += height < cell.lower ? 1.0 : (height >= cell.upper ? -1.0 : 0.0);
    }
    return clamp(plane, first, last);
}

#include "caustics/planes-{PLANES}.glsl"

// The three rays of a triangle: places on the uppermost plane in texels, and how they move with each unit of descent.
struct Beam {
    vec2 a;
    vec2 b;
    vec2 c;
    vec2 a_lean;
    vec2 b_lean;
    vec2 c_lean;
};

// All places of a beam from a plane to another, texels.
void hull(Beam beam, float from, float to, out vec2 low, out vec2 high) {
    float first = descent_to(from);
    float on = descent_to(to) - first;
    vec2 a = beam.a + beam.a_lean * first;
    vec2 b = beam.b + beam.b_lean * first;
    vec2 c = beam.c + beam.c_lean * first;
    vec2 a_last = a + beam.a_lean * on;
    vec2 b_last = b + beam.b_lean * on;
    vec2 c_last = c + beam.c_lean * on;
    low = min(min(a, min(b, c)), min(a_last, min(b_last, c_last)));
    high = max(max(a, max(b, c)), max(a_last, max(b_last, c_last)));
}

// Least and greatest height of the cells from one to another where the beam passes them.
vec2 heights_met(Beam beam, uint from, uint to) {
    vec2 low;
    vec2 high;
    hull(beam, float(from), float(to), low, high);
    return heights_within(rectangle(low, high, 0.9 + slack_at(low, high)), cells.list[to].lower, cells.list[from].upper);
}

// The planes from `from` on and before `to` that the beam may light: it is straight from the first to the last and so lies between
// its ends; heights that it meets there bound the planes, and these the way.
void narrow(Beam beam, inout uint from, inout uint to) {
    if (from < to) {
        vec2 heights = heights_met(beam, from, to - 1u);
        if (heights.x > heights.y) {
            to = from;
            return;
        }
        // A cell more on each side for what rounding may do.
        uint above = uint(max(plane_of(heights.y) - 1.0, 0.0));
        uint under = uint(plane_of(heights.x)) + 2u;
        from = max(from, above);
        to = min(to, under);
    }
}

// Of some planes from `base` on, those of which the beam may cover a sample of a texel whose height lies in the cell: by the texels
// that it passes from the first plane to the last, of which each has one plane.
uint covered(Beam beam, uint base, uint planes) {
    vec2 low;
    vec2 high;
    hull(beam, float(base + uint(findLSB(planes))), float(base + uint(findMSB(planes))), low, high);
    float slack = slack_at(low, high);
    Rectangle texels = rectangle(low, high, slack);
    uvec2 span = texels.to - texels.from + 1u;
    if (texels.is_empty) {
        return 0u;
    }
    if (max(span.x, span.y) > MOST_TEXELS || span.x * span.y > MOST_TEXELS) {
        return planes;
    }
    // The square of the samples of a texel.
    float half_side = 0.5 - cull.inset + slack;
    uint found = 0u;
    uint count = span.x * span.y;
    uvec2 texel = texels.from;
    uint at = texel.y * cull.map_size + texel.x;
    for (uint i = 0u; i < count; i++) {
        float height = heights.list[at];
        vec2 middle = vec2(texel) + 0.5;
        bool ends = texel.x >= texels.to.x;
        texel = ends ? uvec2(texels.from.x, texel.y + 1u) : uvec2(texel.x + 1u, texel.y);
        at += ends ? cull.map_size + 1u - span.x : 1u;

        bool is_held = height > -1.0e29;
        float plane = is_held ? plane_of(height) : 0.0;
        float descent = descent_to(plane);
        // From the texel's middle, where numbers are small.
        vec2 p = beam.a + beam.a_lean * descent - middle;
        vec2 q = beam.b + beam.b_lean * descent - middle;
        vec2 r = beam.c + beam.c_lean * descent - middle;
        vec2 to_q = q - p;
        vec2 to_r = r - q;
        vec2 to_p = p - r;
        // How far it is on the inner side of each side of the triangle, and what the square adds.
        float turn = to_q.x * to_r.y < to_q.y * to_r.x ? -1.0 : 1.0;
        vec3 inside = turn * vec3(to_q.y * p.x - to_q.x * p.y, to_r.y * q.x - to_r.x * q.y, to_p.y * r.x - to_p.x * r.y);
        vec3 added = half_side * vec3(abs(to_q.x) + abs(to_q.y), abs(to_r.x) + abs(to_r.y), abs(to_p.x) + abs(to_p.y));
        inside += added;
        vec2 least = min(p, min(q, r));
        vec2 most = max(p, max(q, r));
        bool is_met = min(inside.x, min(inside.y, inside.z)) >= 0.0 && max(least.x, least.y) <= half_side
            && min(most.x, most.y) >= -half_side;
        uint bit = uint(plane) - base;
        found |= is_held && is_met && bit < 32u ? 1u << bit : 0u;
    }
    return found & planes;
}

void main() {
    uint triangle = element(64u);
    if (triangle >= cull.triangles) {
        return;
    }
    uint base = 32u * PARTS * gl_WorkGroupID.z;
    Ray a = rays.list[indices.list[3u * triangle]];
    Ray b = rays.list[indices.list[3u * triangle + 1u]];
    Ray c = rays.list[indices.list[3u * triangle + 2u]];
    float top = cells.list[0].height;
    vec2 texels = descent_texels();
    Beam beam =
        Beam(texel_place(a, top), texel_place(b, top), texel_place(c, top), a.slope * texels, b.slope * texels, c.slope * texels);
    float highest = max(a.origin.y, max(b.origin.y, c.origin.y));
    // Without a lit corner nothing is lit. With an unlit one far away, rounding leaves light at the others, as in the level map.
    bool enters = max(a.enters, max(b.enters, c.enters)) > 0.0;
    uint first = base;
    uint end = enters ? min(base + 32u * PARTS, plane_count()) : base;
    for (uint round = 0u; round < 3u * steps.groups; round++) {
        narrow(beam, first, end);
    }
    uint words = triangle * cull.words + base / 32u;
    for (uint word = 0u; word < min(PARTS, cull.words - base / 32u); word++) {
        kept.list[words + word] = 0u;
    }
    // From the first plane on, not from a word's: what a beam may light on a few planes is then one part, whose texels are seen once.
    for (uint part_base = first; part_base < end; part_base += 32u) {
        uint from = part_base;
        uint to = min(end, part_base + 32u);
        if (steps.groups == 1u) {
            narrow(beam, from, to);
        }
        uint mask = 0u;
        for (uint group = from / GROUP * GROUP; group < to && from < to; group += GROUP) {
            uint group_first = max(from, group);
            uint group_end = min(to, group + GROUP);
            bool may_meet = true;
            if (steps.groups == 1u) {
                vec2 heights = heights_met(beam, group_first, group_end - 1u);
                may_meet = heights.x <= heights.y;
            }
            for (uint plane = group_first; plane < group_end && may_meet; plane++) {
                bool is_kept = highest > cells.list[plane].height;
                if (is_kept && steps.planes == 1u) {
                    vec2 heights = heights_met(beam, plane, plane);
                    is_kept = heights.x <= heights.y;
                }
                mask |= is_kept ? 1u << (plane - part_base) : 0u;
            }
        }
        if (mask != 0u && steps.texels == 1u) {
            mask = covered(beam, part_base, mask);
        }
        uint word = words + (part_base - base) / 32u;
        uint bit = part_base % 32u;
        if (mask != 0u) {
            kept.list[word] |= mask << bit;
            // Shifted twice, since all 32 at once shift nothing.
            uint rest = (mask >> 1u) >> (31u - bit);
            if (rest != 0u) {
                kept.list[word + 1u] |= rest;
            }
        }
    }
}
