#version 450

// Each triangle of the refined water once, where its light lands (section 6.3): its flux over the texels that it covers there, by the
// exact area of each. Those whose corners do not land on one surface are listed for the next pass. The thesis only names the idea.
// An invocation takes the two triangles of a cell, which share most of their texels.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/cover.glsl"
#include "caustics/water-triangle.glsl"

layout(std430, set = 0, binding = 5) readonly buffer Landings {
    vec4 list[];
} landings;

// Texels of a triangle's rectangle beyond which it is listed instead: those of two beside each other are at most four times as many,
// and a driver may end all loops together after 65,535 turns.
const float MOST_TEXELS = 8000.0;

// True where the surface is at that place, to half a texel.
bool is_on_surface(vec3 at) {
    float texel_m = sqrt(plane.texel_area_m2);
    Surface surface = surface_at(at.xy, 0.0, true);
    return abs(surface.height - at.z) <= 0.5 * texel_m * length(vec2(1.0, min(surface.steepness / texel_m, 4.0)));
}

// True where the surface between three landings is theirs.
bool lies_flat(vec3 a, vec3 b, vec3 c) {
    for (int i = 0; i < 4; i++) {
        vec3 weights = i == 0 ? vec3(1.0 / 3.0) : (i == 1 ? vec3(0.5, 0.5, 0.0) : (i == 2 ? vec3(0.0, 0.5, 0.5) : vec3(0.5, 0.0, 0.5)));
        if (!is_on_surface(a * weights.x + b * weights.y + c * weights.z)) {
            return false;
        }
    }
    return true;
}

// A beam of slope s lights 1 / (1 + s . grad h) of the map's area that it lights across V. Farther from 1 it is left to the planes of
// the texels: what is divided by changes too much from texel to texel there.
const float TURNED = 0.2;
// Least area of a triangle, of the square of its longest side, that its own corners tell the surface's slope by.
const float LEAST_AREA = 0.05;

// What light that lands is divided by: I_c is flux per area perpendicular to the beam, whatever the surface's slope (eq. 4-18).
// Between the corners' own places, so that an error of the rays' depth moves the light and changes none of it.
float divisor(Ray ray_a, Ray ray_b, Ray ray_c, vec3 a, vec3 b, vec3 c) {
    vec2 to_b = b.xy - a.xy;
    vec2 to_c = c.xy - a.xy;
    float there = to_b.x * to_c.y - to_b.y * to_c.x;
    float longest = max(dot(to_b, to_b), max(dot(to_c, to_c), dot(to_b - to_c, to_b - to_c)));
    if (abs(there) < LEAST_AREA * longest || longest < 0.01) {
        vec2 slope = (ray_a.slope + ray_b.slope + ray_c.slope) / 3.0;
        return 1.0 + dot(steepness_at(ivec2(floor((a.xy + b.xy + c.xy) / 3.0))) * plane.texels_per_m, slope);
    }
    // On the plane across V at their mean height.
    vec3 rise = vec3(a.z, b.z, c.z) - (a.z + b.z + c.z) / 3.0;
    vec2 back = ray_a.slope * rise.x;
    to_b += (ray_b.slope * rise.y - back) * plane.texels_per_m;
    to_c += (ray_c.slope * rise.z - back) * plane.texels_per_m;
    return (to_b.x * to_c.y - to_b.y * to_c.x) / there;
}

void list_it(uint triangle, vec2 heights) {
    uint at = atomicAdd(straddling.count, 1u);
    straddling.list[at] = Straddler(triangle, heights.x, heights.y);
}

// A triangle that lands whole: its corners in texels, and its flux over its area there; no light for any other.
struct Landed {
    vec2 p;
    vec2 q;
    vec2 r;
    vec2 low;
    vec2 high;
    float light;
};

// Lists the triangle where it straddles.
Landed landed(uint triangle, Ray ray_a, Ray ray_b, Ray ray_c, vec4 a, vec4 b, vec4 c, vec2 base) {
    Landed whole = Landed(vec2(0.0), vec2(0.0), vec2(0.0), vec2(1.0e6), vec2(-1.0e6), 0.0);
    float least = min(a.w, min(b.w, c.w));
    vec2 low = min(a.xy, min(b.xy, c.xy));
    vec2 high = max(a.xy, max(b.xy, c.xy));
    float size = float(plane.map_size);
    bool misses = any(greaterThanEqual(low, vec2(size))) || any(lessThan(high, vec2(0.0)));
    if (least < -1.5 || (least >= 0.0 && misses)) {
        return whole;
    }
    vec2 rectangle = min(high, vec2(size)) - max(low, vec2(0.0)) + 2.0;
    bool is_one = least >= 0.0 && rectangle.x * rectangle.y <= MOST_TEXELS;
    float turned = is_one ? divisor(ray_a, ray_b, ray_c, a.xyz, b.xyz, c.xyz) : 0.0;
    if (abs(turned - 1.0) > TURNED || !lies_flat(a.xyz, b.xyz, c.xyz)) {
        vec2 heights = heights_met(ray_a, ray_b, ray_c);
        if (heights.x <= heights.y) {
            list_it(triangle, heights);
        }
        return whole;
    }
    vec3 face = face_of(ray_a, ray_b, ray_c);
    float flux = max(-dot(face, ray_a.incident * a.w + ray_b.incident * b.w + ray_c.incident * c.w) / 3.0, 0.0);
    whole.p = a.xy - base;
    whole.q = b.xy - base;
    whole.r = c.xy - base;
    widen(whole.p, whole.q, whole.r);
    whole.low = min(whole.p, min(whole.q, whole.r));
    whole.high = max(whole.p, max(whole.q, whole.r));
    whole.light = flux / (area_of(whole.p, whole.q, whole.r) * turned);
    return whole;
}

void main() {
    uint first = 6u * element(64u);
    if (first >= 3u * plane.triangles) {
        return;
    }
    uvec4 corners = uvec4(indices.list[first], indices.list[first + 1u], indices.list[first + 2u], indices.list[first + 5u]);
    vec4 a = landings.list[corners.x];
    vec4 b = landings.list[corners.y];
    vec4 c = landings.list[corners.z];
    vec4 d = landings.list[corners.w];
    Ray ray_a = rays.list[corners.x];
    Ray ray_b = rays.list[corners.y];
    Ray ray_c = rays.list[corners.z];
    Ray ray_d = rays.list[corners.w];
    // Small numbers keep their digits.
    float size = float(plane.map_size);
    vec2 base = clamp(floor(min(min(a.xy, b.xy), min(c.xy, d.xy))), vec2(-1.0), vec2(size));
    // As the mesh lists them: a, b, c and c, b, d.
    Landed one = landed(first / 3u, ray_a, ray_b, ray_c, a, b, c, base);
    Landed other = landed(first / 3u + 1u, ray_c, ray_b, ray_d, c, b, d, base);
    vec2 low = min(one.low, other.low);
    vec2 high = max(one.high, other.high);
    ivec2 origin = ivec2(base);
    ivec2 from = max(ivec2(floor(low)), -origin);
    ivec2 to = min(ivec2(floor(high)), ivec2(int(plane.map_size) - 1) - origin);
    bool is_cut = false;
    int y = from.y;
    for (; y <= to.y; y++) {
        Row row;
        row.p = side_in_row(one.p, one.q, float(y), one.light);
        row.q = side_in_row(one.q, one.r, float(y), one.light);
        row.r = side_in_row(one.r, one.p, float(y), one.light);
        Row beside;
        beside.p = side_in_row(other.p, other.q, float(y), other.light);
        beside.q = side_in_row(other.q, other.r, float(y), other.light);
        beside.r = side_in_row(other.r, other.p, float(y), other.light);
        vec2 ends = joined(ends_of(row), ends_of(beside));
        int x = int(max(floor(ends.x), float(from.x)));
        int last = int(min(floor(ends.y), float(to.x)));
        float before = left_of(row, float(x)) + left_of(beside, float(x));
        while (x <= last) {
            // A low word that is full is left for a moment: this is rare, and a place of its own makes the rest faster.
            bool is_full = false;
            ivec2 texel = origin + ivec2(x, y);
            while (x <= last && !is_full) {
                texel = origin + ivec2(x, y);
                x++;
                float after = left_of(row, float(x)) + left_of(beside, float(x));
                is_full = add_low(texel, max(before - after, 0.0));
                before = after;
            }
            if (is_full) {
                add_high(texel);
            }
        }
        is_cut = is_cut || x <= last;
    }
    if (is_cut || y <= to.y) {
        atomicAdd(unfinished.land, 1u);
    }
}
