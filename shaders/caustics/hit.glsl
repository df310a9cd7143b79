// Light placed where it lands (section 6.3): what the passes of the variant `hit` share. Rays are followed down through the position
// map, which is read as a surface: between four texels that hold the receiver it is bilinear. Heights are of box space.

#include "caustics/ray.glsl"

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
} plane;

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(std430, set = 0, binding = 3) readonly buffer Pyramid {
    vec2 list[]; // least and greatest height, level after level, row by row
} pyramid;

// Steps of a ray through the position map; of a texel each, where it moves no farther than that many.
const int HIT_STEPS = 64;

// What a beam's light is divided by at the least on a surface that turns away from it.
const float GRAZING = 0.25;

bool is_receiver(float height) {
    return height > -1.0e29;
}

// The border's texels go on beyond it.
float height_at(ivec2 texel) {
    ivec2 inside = clamp(texel, ivec2(0), ivec2(int(plane.map_size) - 1));
    return texelFetch(sampler2D(position_map, nearest), inside, 0).r;
}

struct Surface {
    float height; // below -1e29 where one of the four texels holds no receiver and `whole` was asked for
    float steepness; // greatest difference of neighbouring texels' heights
};

// The surface at a place in texels. Without `whole`, a texel that holds no receiver has the height `instead`.
Surface surface_at(vec2 place, float instead, bool whole) {
    vec2 from = place - 0.5;
    vec2 base = floor(from);
    vec2 t = from - base;
    ivec2 texel = ivec2(base);
    float a = height_at(texel);
    float b = height_at(texel + ivec2(1, 0));
    float c = height_at(texel + ivec2(0, 1));
    float d = height_at(texel + ivec2(1, 1));
    if (whole && !is_receiver(min(min(a, b), min(c, d)))) {
        return Surface(-1.0e30, 0.0);
    }
    a = is_receiver(a) ? a : instead;
    b = is_receiver(b) ? b : instead;
    c = is_receiver(c) ? c : instead;
    d = is_receiver(d) ? d : instead;
    vec2 along_u = vec2(b - a, d - c);
    vec2 along_w = vec2(c - a, d - b);
    float u = mix(along_u.x, along_u.y, t.y);
    float w = mix(along_w.x, along_w.y, t.x);
    return Surface(a + along_u.x * t.x + w * t.y, length(vec2(u, w)));
}

// Least and greatest height near a rectangle of texels, from the four entries of the pyramid that hold it. Where nothing is, the
// least is above the greatest.
vec2 heights_between(vec2 one, vec2 other) {
    vec2 last = vec2(float(plane.map_size) - 1.0);
    uvec2 from = uvec2(clamp(min(one, other) - 1.0, vec2(0.0), last));
    uvec2 to = uvec2(clamp(max(one, other) + 1.0, vec2(0.0), last));
    uint first = 0u;
    uint level_size = plane.map_size;
    for (uint level = 0u; level < 16u; level++) {
        uvec2 span = to - from;
        if (max(span.x, span.y) <= 1u || level + 1u >= plane.levels) {
            break;
        }
        from /= 2u;
        to /= 2u;
        first += level_size * level_size;
        level_size = (level_size + 1u) / 2u;
    }
    vec2 a = pyramid.list[first + from.y * level_size + from.x];
    vec2 b = pyramid.list[first + from.y * level_size + to.x];
    vec2 c = pyramid.list[first + to.y * level_size + from.x];
    vec2 d = pyramid.list[first + to.y * level_size + to.x];
    return vec2(min(min(a.x, b.x), min(c.x, d.x)), max(max(a.y, b.y), max(c.y, d.y)));
}

// The same from up to sixteen entries of a finer level: for what must not be taken for more than it is.
vec2 heights_within(vec2 one, vec2 other) {
    vec2 last = vec2(float(plane.map_size) - 1.0);
    uvec2 from = uvec2(clamp(min(one, other) - 1.0, vec2(0.0), last));
    uvec2 to = uvec2(clamp(max(one, other) + 1.0, vec2(0.0), last));
    uint first = 0u;
    uint level_size = plane.map_size;
    for (uint level = 0u; level < 16u; level++) {
        uvec2 span = to - from;
        if (max(span.x, span.y) <= 3u || level + 1u >= plane.levels) {
            break;
        }
        from /= 2u;
        to /= 2u;
        first += level_size * level_size;
        level_size = (level_size + 1u) / 2u;
    }
    vec2 range = vec2(1.0e30, -1.0e30);
    for (uint y = from.y; y <= to.y; y++) {
        for (uint x = from.x; x <= to.x; x++) {
            vec2 entry = pyramid.list[first + y * level_size + x];
            range = vec2(min(range.x, entry.x), max(range.y, entry.y));
        }
    }
    return range;
}

// Where a ray is at a height, in texels.
vec2 place_at(vec3 origin, vec2 slope, float height) {
    vec2 place = origin.xz + slope * (origin.y - plane.middle - height) - plane.center;
    return place * plane.texels_per_m + 0.5 * float(plane.map_size);
}

// The first place where a ray meets the receiver: texels in x and y, the height in z, and in w 1, or 0 where it meets nothing that
// the map holds. A receiver is solid below what the light sees of it: what enters by its side is lost.
vec4 first_hit(vec3 origin, vec2 slope) {
    float start = origin.y - plane.middle;
    float top = min(plane.half_height, start);
    float bottom = -plane.half_height;
    // Near the ray's place nothing is higher than the highest there, nor lower than the lowest.
    for (int i = 0; i < 3; i++) {
        vec2 range = heights_between(place_at(origin, slope, top), place_at(origin, slope, bottom));
        if (range.x > range.y) {
            return vec4(0.0);
        }
        top = min(top, range.y);
        bottom = max(bottom, range.x);
    }
    if (top < bottom) {
        return vec4(0.0);
    }
    vec2 path = abs(place_at(origin, slope, bottom) - place_at(origin, slope, top));
    int steps = int(clamp(ceil(max(path.x, path.y)), 1.0, float(HIT_STEPS)));
    float above = top;
    float height = top;
    float found = -1.0e30;
    for (int i = 0; i <= steps; i++) {
        // Exactly the lowest at the end, where nothing can be missed.
        height = i == steps ? bottom : mix(top, bottom, float(i) / float(steps));
        found = height_at(ivec2(floor(place_at(origin, slope, height))));
        if (found >= height) {
            break;
        }
        above = height;
    }
    if (found < height) {
        return vec4(0.0);
    }
    vec2 end = place_at(origin, slope, height);
    if (found > above) {
        // Stepped in at the side: of a slope that goes on rising, or of an edge.
        vec2 ahead = slope * plane.texels_per_m;
        ivec2 onward = abs(ahead.x) > abs(ahead.y) ? ivec2(ahead.x > 0.0 ? 1 : -1, 0) : ivec2(0, ahead.y > 0.0 ? 1 : -1);
        float beyond = height_at(ivec2(floor(end)) + onward);
        float rise = is_receiver(beyond) ? abs(beyond - found) : 0.0;
        if (found - above > 1.5 * rise + 2.0 * sqrt(plane.texel_area_m2)) {
            return vec4(0.0);
        }
    }
    // Over a texel's length the surface is nearly straight.
    float over = above - surface_at(place_at(origin, slope, above), found, false).height;
    float under = surface_at(end, found, false).height - height;
    float fraction = over + under > 1.0e-9 ? clamp(over / (over + under), 0.0, 1.0) : 1.0;
    float met = mix(above, height, fraction);
    return vec4(place_at(origin, slope, met), met, 1.0);
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

// What light that lands on a map's texel is divided by: a beam of slope s lights 1 / (1 + s . grad h) of the map's area that it
// lights across V, and I_c is flux per area perpendicular to the beam, whatever the surface's slope (eq. 4-18).
float turned(vec2 place, vec2 slope) {
    ivec2 texel = ivec2(floor(place));
    float here = height_at(texel);
    if (!is_receiver(here)) {
        return 1.0;
    }
    float along_u = difference(height_at(texel - ivec2(1, 0)), here, height_at(texel + ivec2(1, 0)));
    float along_w = difference(height_at(texel - ivec2(0, 1)), here, height_at(texel + ivec2(0, 1)));
    return max(1.0 + dot(vec2(along_u, along_w) * plane.texels_per_m, slope), GRAZING);
}

// Sign: a ray with slope s moves by +s for a metre of descent, so that over a surface that rises ahead of it (s . grad h > 0) it
// lands sooner and its beam covers less of the map.
float landed_weight(vec4 hit, vec3 origin, vec2 slope, float secant) {
    float descent = origin.y - plane.middle - hit.z;
    return exp(-plane.absorption_per_m * (max(descent, 0.0) * secant)) * secant / turned(hit.xy, slope);
}
