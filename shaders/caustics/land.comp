#version 450
#pragma variants LAYERS=one,several

// Each triangle of the refined water once, where its light lands (section 6.3): its flux over the texels that it covers there, by the
// exact area of each and linear between its corners. Those whose corners do not land on one surface are listed for the next pass. The
// thesis only names the idea. An invocation takes the two triangles of a cell, which share most of their texels.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/unfinished.glsl"
#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/cover.glsl"
#include "caustics/water-triangle.glsl"
#include "caustics/landing.glsl"

layout(std430, set = 0, binding = 5) readonly buffer Landings {
    vec4 list[]; // a Landing each
} landings;

layout(std430, set = 0, binding = 11) readonly buffer Intensities {
    float list[]; // I_c where each ray lands, negative where the light is turned over, 0 where it is not known
} intensities;

// Texels of a triangle's rectangle beyond which it is listed instead: those of two beside each other are at most four times as many,
// and a driver may end all loops together after 65,535 turns.
const float MOST_TEXELS = 8000.0;

// True where the surface is at that place, to half a texel.
bool is_on_surface(vec3 at) {
    float texel_m = sqrt(plane.texel_area_m2);
    Surface surface = surface_at(at.xy, at.z, true);
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
        return 1.0 + dot(steepness_at(ivec2(floor((a.xy + b.xy + c.xy) / 3.0)), (a.z + b.z + c.z) / 3.0) * plane.texels_per_m, slope);
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
    bool straddles;
    vec2 p;
    vec2 q;
    vec2 r;
    vec2 low;
    vec2 high;
    float light;
    vec2 middle;
    vec2 rise; // of the light from texel to texel, of its mean
    float height; // at its middle, metres
    vec2 climb; // of the height from texel to texel
};

// By which light may rise from texel to texel: of a texel that is covered in part the light is not told to the last digit. What rises
// more is on few texels, which show as edges whatever is done.
const float MOST_RISE = 0.15;

// How what has these values at a triangle's corners rises from texel to texel; not at all where it is too thin to tell.
vec2 gradient_of(vec2 p, vec2 q, vec2 r, vec3 values) {
    vec2 to_q = q - p;
    vec2 to_r = r - p;
    float there = to_q.x * to_r.y - to_q.y * to_r.x;
    if (abs(there) < 1.0e-3) {
        return vec2(0.0);
    }
    vec2 more = vec2(values.y - values.x, values.z - values.x);
    return (more.x * vec2(to_r.y, -to_r.x) + more.y * vec2(-to_q.y, to_q.x)) / there;
}

// How the light of a triangle rises from texel to texel, of its mean: linear between its corners', as far as they are known and
// none of it is turned over.
vec2 rise_of(vec2 p, vec2 q, vec2 r, vec3 lights) {
    float mean = (lights.x + lights.y + lights.z) / 3.0;
    if (min(lights.x, min(lights.y, lights.z)) * max(lights.x, max(lights.y, lights.z)) <= 0.0) {
        return vec2(0.0);
    }
    vec2 rise = gradient_of(p, q, r, lights / mean);
    return rise * min(1.0, MOST_RISE / max(abs(rise.x) + abs(rise.y), 1.0e-9));
}

// The light of a triangle about the middle of what a row of texels and its rectangle have in common, of its mean, at its own middle.
float light_in_row(Landed whole, float y) {
    return 1.0 + whole.rise.y * (0.5 * (max(y, whole.low.y) + min(y + 1.0, whole.high.y)) - whole.middle.y);
}

// And of what a texel of that row has in common with it.
float light_in_texel(Landed whole, float of_row, float x) {
    float middle = 0.5 * (max(x, whole.low.x) + min(x + 1.0, whole.high.x)) - whole.middle.x;
    return max(of_row + whole.rise.x * middle, 0.0);
}

// The height of a triangle at the middle of a texel.
float height_in_texel(Landed whole, float x, float y) {
    return whole.height + dot(whole.climb, vec2(x, y) + 0.5 - whole.middle);
}

Landed landed(Ray ray_a, Ray ray_b, Ray ray_c, Landing a, Landing b, Landing c, vec3 lights, vec2 base) {
    Landed whole = Landed(false, vec2(0.0), vec2(0.0), vec2(0.0), vec2(1.0e6), vec2(-1.0e6), 0.0, vec2(0.0), vec2(0.0), 0.0, vec2(0.0));
    float least = min(a.weight, min(b.weight, c.weight));
    vec2 low = min(a.place.xy, min(b.place.xy, c.place.xy));
    vec2 high = max(a.place.xy, max(b.place.xy, c.place.xy));
    float size = float(plane.map_size);
    bool misses = any(greaterThanEqual(low, vec2(size + LEAST_WIDTH))) || any(lessThan(high, vec2(-LEAST_WIDTH)));
    if (least < -1.5 || (least >= 0.0 && misses)) {
        return whole;
    }
    vec2 rectangle = min(high, vec2(size)) - max(low, vec2(0.0)) + 2.0;
    bool is_one = least >= 0.0 && rectangle.x * rectangle.y <= MOST_TEXELS;
    float turned = is_one ? divisor(ray_a, ray_b, ray_c, a.place, b.place, c.place) : 0.0;
    if (abs(turned - 1.0) > TURNED || !lies_flat(a.place, b.place, c.place)) {
        whole.straddles = true;
        return whole;
    }
    vec3 face = face_of(ray_a, ray_b, ray_c);
    float flux = max(-dot(face, ray_a.incident * a.weight + ray_b.incident * b.weight + ray_c.incident * c.weight) / 3.0, 0.0);
    whole.p = a.place.xy - base;
    whole.q = b.place.xy - base;
    whole.r = c.place.xy - base;
    whole.middle = (whole.p + whole.q + whole.r) / 3.0;
    whole.rise = rise_of(whole.p, whole.q, whole.r, lights);
    whole.height = (a.place.z + b.place.z + c.place.z) / 3.0;
    whole.climb = gradient_of(whole.p, whole.q, whole.r, vec3(a.place.z, b.place.z, c.place.z));
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
    Landing a = landing_of(landings.list[corners.x]);
    Landing b = landing_of(landings.list[corners.y]);
    Landing c = landing_of(landings.list[corners.z]);
    Landing d = landing_of(landings.list[corners.w]);
    Ray ray_a = ray_at(corners.x);
    Ray ray_b = ray_at(corners.y);
    Ray ray_c = ray_at(corners.z);
    Ray ray_d = ray_at(corners.w);
    // Small numbers keep their digits.
    float size = float(plane.map_size);
    vec2 base = clamp(floor(min(min(a.place.xy, b.place.xy), min(c.place.xy, d.place.xy))), vec2(-1.0), vec2(size));
    // As the mesh lists them: a, b, c and c, b, d.
    vec3 lights = vec3(intensities.list[corners.x], intensities.list[corners.y], intensities.list[corners.z]);
    Landed one = landed(ray_a, ray_b, ray_c, a, b, c, lights, base);
    Landed other = landed(ray_c, ray_b, ray_d, c, b, d, vec3(lights.zy, intensities.list[corners.w]), base);
    if (one.straddles || other.straddles) {
        vec2 heights = heights_met(ray_a, ray_b, ray_c, ray_d);
        if (one.straddles && heights.x <= heights.y) {
            list_it(first / 3u, heights);
        }
        if (other.straddles && heights.x <= heights.y) {
            list_it(first / 3u + 1u, heights);
        }
    }
    vec2 low = min(one.low, other.low);
    vec2 high = max(one.high, other.high);
    ivec2 origin = ivec2(base);
    ivec2 from = max(ivec2(floor(low)), -origin);
    ivec2 to = min(ivec2(floor(high)), ivec2(int(plane.map_size) - 1) - origin);
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
        float one_in_row = light_in_row(one, float(y));
        float other_in_row = light_in_row(other, float(y));
        float before = left_of(row, float(x));
        float before_beside = left_of(beside, float(x));
        while (x <= last) {
            // A low word that is full is left for a moment: this is rare, and a place of its own makes the rest faster.
            bool is_full = false;
            ivec2 texel = origin + ivec2(x, y);
            int layer = 0;
            while (x <= last && !is_full) {
                texel = origin + ivec2(x, y);
                float one_in_texel = light_in_texel(one, one_in_row, float(x));
                float other_in_texel = light_in_texel(other, other_in_row, float(x));
                float one_height = height_in_texel(one, float(x), float(y));
                float other_height = height_in_texel(other, float(x), float(y));
                x++;
                float after = left_of(row, float(x));
                float after_beside = left_of(beside, float(x));
                float of_one = (before - after) * one_in_texel;
                float of_other = (before_beside - after_beside) * other_in_texel;
                layer = layer_near(texel, of_one > of_other ? one_height : other_height);
                is_full = add_low(texel, layer, max(of_one + of_other, 0.0));
                before = after;
                before_beside = after_beside;
            }
            if (is_full) {
                add_high(texel, layer);
            }
        }
        is_cut = is_cut || x <= last;
    }
    if (is_cut || y <= to.y) {
        atomicAdd(unfinished.land, 1u);
    }
}
