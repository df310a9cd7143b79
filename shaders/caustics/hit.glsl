// Light placed where it lands (section 6.3): what the passes of the variant `hit` share. Rays are followed down through the position
// map, which is read as a surface: between four texels that hold the receiver it is bilinear. Heights are of box space.

#include "caustics/ray.glsl"
#include "caustics/pyramid.glsl"

layout(push_constant) uniform Hits {
    vec2 center; // of the box along U and W, from the rays' reference point, metres
    vec2 texels_per_m;
    float middle; // height of the box's centre along V, from the rays' reference point, metres
    float half_height; // of the box, metres
    float texel_area_m2;
    float absorption_per_m; // K of eq. 4-17
    uint map_size; // texels a side
    uint levels; // of the position map's pyramid
    uint triangles; // of the refined water
    uint vertices;
    vec3 up; // of the world, along U, V, W
    float receiver; // index of this one
    vec2 shadow_center; // of the shadow map's box along U and W, from the reference point, metres
    vec2 shadow_texels_per_m;
    float shadow_middle; // height of that box's centre along V, from the reference point, metres
    float shadow_top; // of its top
    uint columns; // vertices of the refined water along x
    float units; // of light that is added up, of an I_c of 1
} plane;

layout(std430, set = 0, binding = 0) readonly buffer Heights {
    float list[]; // of the position map's texels, row by row
} heights;

#if defined(SHADOW_ON) || defined(LAYERS_SEVERAL)
layout(set = 0, binding = 1) uniform sampler nearest;
#endif

layout(std430, set = 0, binding = 3) readonly buffer Pyramid {
    vec2 list[];
} pyramid;

// Whole vectors: where a load costs by its number, as on a CPU, the members one by one would take longer.
layout(std430, set = 0, binding = 4) readonly buffer Rays {
    vec4 list[]; // three a ray
} rays;

// Steps of a ray through the position map, of a texel each: more than a map has texels along a side.
const int MOST_STEPS = 32768;
// Steps that are left out together where the ray passes above all that is near.
const int STRIDE = 8;

Ray ray_at(uint index) {
    vec4 from = rays.list[3u * index];
    vec4 on = rays.list[3u * index + 1u];
    vec4 light = rays.list[3u * index + 2u];
    return Ray(from.xyz, from.w, on.xy, on.z, on.w, light.xyz, light.w);
}

bool is_receiver(float height) {
    return height > -1.0e29;
}

// The border's texels go on beyond it.
float height_at(ivec2 texel) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(int(plane.map_size) - 1));
    return heights.list[uint(inside.y) * plane.map_size + uint(inside.x)];
}

#include "caustics/layers-{LAYERS}.glsl"

struct Surface {
    float height; // below -1e29 where one of the four texels holds no receiver and `whole` was asked for
    float steepness; // greatest difference of neighbouring texels' heights
};

// The surface at a place in texels, of those above one another the nearest to the height `about`. Without `whole`, a texel that holds
// no receiver has that height.
Surface surface_at(vec2 place, float about, bool whole) {
    vec2 from = place - 0.5;
    vec2 base = floor(from);
    vec2 t = from - base;
    ivec2 texel = ivec2(base);
    float a = height_near(texel, about);
    float b = height_near(texel + ivec2(1, 0), about);
    float c = height_near(texel + ivec2(0, 1), about);
    float d = height_near(texel + ivec2(1, 1), about);
    if (whole && !is_receiver(min(min(a, b), min(c, d)))) {
        return Surface(-1.0e30, 0.0);
    }
    a = is_receiver(a) ? a : about;
    b = is_receiver(b) ? b : about;
    c = is_receiver(c) ? c : about;
    d = is_receiver(d) ? d : about;
    vec2 along_u = vec2(b - a, d - c);
    vec2 along_w = vec2(c - a, d - b);
    float u = mix(along_u.x, along_u.y, t.y);
    float w = mix(along_w.x, along_w.y, t.x);
    return Surface(a + along_u.x * t.x + w * t.y, length(vec2(u, w)));
}

// The finest level of the pyramid on which a rectangle of texels is no wider than so many entries and one more: the first entry of its
// list; the rectangle, a texel wider on each side, in its entries.
void climb(vec2 one, vec2 other, uint widest, out uvec2 from, out uvec2 to, out uint at) {
    vec2 last = vec2(float(plane.map_size) - 1.0);
    uvec2 first = uvec2(clamp(min(one, other) - 1.0, vec2(0.0), last));
    uvec2 end = uvec2(clamp(max(one, other) + 1.0, vec2(0.0), last));
    uvec2 span = end - first;
    uint longest = max(span.x, span.y);
    // By halves until it is no wider, and once more where its ends lie so.
    uint level = longest > widest ? uint(findMSB(longest / (widest + 1u))) : 0u;
    level += uint(any(greaterThan((end >> level) - (first >> level), uvec2(widest))));
    level += uint(any(greaterThan((end >> level) - (first >> level), uvec2(widest))));
    level = clamp(level, 1u, plane.levels);
    from = first >> level;
    to = end >> level;
    at = first_entry(level, plane.levels, plane.map_size);
}

// The part of a way that lies over the map, or a texel beside it, from 0 at its begin to 1 at its end; the first above the second where
// none does.
vec2 part_over_map(vec2 from, vec2 way) {
    vec2 safe = mix(way, vec2(1.0e-6), lessThan(abs(way), vec2(1.0e-6)));
    vec2 one = (vec2(-1.0) - from) / safe;
    vec2 other = (vec2(float(plane.map_size) + 1.0) - from) / safe;
    vec2 enter = min(one, other);
    vec2 leave = max(one, other);
    return vec2(max(max(enter.x, enter.y), 0.0), min(min(leave.x, leave.y), 1.0));
}

// Least and greatest height near a rectangle of texels, from the four entries of the pyramid that hold it. Where nothing is, the
// least is above the greatest.
vec2 heights_between(vec2 one, vec2 other) {
    uvec2 from;
    uvec2 to;
    uint at;
    climb(one, other, 1u, from, to, at);
    uint first = at + from.y * row_of_entries(plane.map_size);
    uint last = at + to.y * row_of_entries(plane.map_size);
    vec2 upper = joined(pyramid.list[first + from.x], pyramid.list[first + to.x]);
    vec2 lower = joined(pyramid.list[last + from.x], pyramid.list[last + to.x]);
    return joined(upper, lower);
}

// The same from up to sixteen entries of a finer level: for what must not be taken for more than it is.
vec2 heights_within(vec2 one, vec2 other) {
    uvec2 from;
    uvec2 to;
    uint at;
    climb(one, other, 3u, from, to, at);
    vec2 range = NOTHING;
    for (uint y = from.y; y <= to.y; y++) {
        for (uint x = from.x; x <= to.x; x++) {
            range = joined(range, pyramid.list[at + y * row_of_entries(plane.map_size) + x]);
        }
    }
    return range;
}

// Where a ray is at a height, in texels.
vec2 place_at(vec3 origin, vec2 slope, float height) {
    vec2 place = origin.xz + slope * (origin.y - plane.middle - height) - plane.center;
    return place * plane.texels_per_m + 0.5 * float(plane.map_size);
}

// Of the differences on two sides of a texel the mean, or the lesser where an edge lies on one side.
float difference(float before, float here, float after) {
    float one = here - before;
    float other = after - here;
    if (!is_receiver(before)) {
        return is_receiver(after) ? other : 0.0;
    }
    if (!is_receiver(after)) {
        return one;
    }
    float lesser = min(abs(one), abs(other));
    float greater = max(abs(one), abs(other));
    return greater > 4.0 * lesser + sqrt(plane.texel_area_m2) ? (abs(one) < abs(other) ? one : other) : 0.5 * (one + other);
}

// How the surface of that height rises from a texel to the next, along U and along W, metres; level where the texel holds no receiver.
vec2 steepness_at(ivec2 texel, float about) {
    float here = height_near(texel, about);
    if (!is_receiver(here)) {
        return vec2(0.0);
    }
    return vec2(difference(height_near(texel - ivec2(1, 0), here), here, height_near(texel + ivec2(1, 0), here)),
        difference(height_near(texel - ivec2(0, 1), here), here, height_near(texel + ivec2(0, 1), here)));
}
