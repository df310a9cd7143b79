#version 450

// Each triangle of the refined water once, where its light lands (section 6.3): its flux over the texels that it covers there, by the
// exact area of each. One that is thinner than a texel by far is spread along its length. Those whose corners do not land on one
// surface are listed for the next pass. The thesis only names the idea.

layout(local_size_x = 64) in;

#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/water-triangle.glsl"

layout(std430, set = 0, binding = 5) readonly buffer Landings {
    vec4 list[];
} landings;

// Texels of a triangle's rectangle beyond which it is listed instead.
const float MOST_TEXELS = 40000.0;
// Area in texels below which a triangle has length alone.
const float THIN = 0.02;

// Integral of clamp(u, 0, 1).
float ramp(float u) {
    float c = clamp(u, 0.0, 1.0);
    return 0.5 * c * c + max(u - 1.0, 0.0);
}

// The part of a side that lies in the row of texels from y to y + 1: x at its two ends, and how far it goes down.
vec3 side_in_row(vec2 a, vec2 b, float y) {
    float rise = b.y - a.y;
    float run = abs(rise) > 1.0e-6 ? (b.x - a.x) / rise : 0.0;
    float from = clamp(a.y, y, y + 1.0);
    float to = clamp(b.y, y, y + 1.0);
    float low = min(a.x, b.x);
    float high = max(a.x, b.x);
    return vec3(clamp(a.x + (from - a.y) * run, low, high), clamp(a.x + (to - a.y) * run, low, high), to - from);
}

// Signed area right of that part, in the texel from x to x + 1.
float right_of(vec3 side, float x) {
    float u = x + 1.0 - side.x;
    float v = x + 1.0 - side.y;
    float mean = abs(v - u) > 1.0e-3 ? (ramp(v) - ramp(u)) / (v - u) : clamp(0.5 * (u + v), 0.0, 1.0);
    return side.z * mean;
}

// True where the surface between three landings is theirs, to half a texel of their plane.
bool lies_flat(vec4 a, vec4 b, vec4 c) {
    float texel_m = sqrt(plane.texel_area_m2);
    for (int i = 0; i < 4; i++) {
        vec3 weights = i == 0 ? vec3(1.0 / 3.0) : (i == 1 ? vec3(0.5, 0.5, 0.0) : (i == 2 ? vec3(0.0, 0.5, 0.5) : vec3(0.5, 0.0, 0.5)));
        vec3 at = a.xyz * weights.x + b.xyz * weights.y + c.xyz * weights.z;
        Surface surface = surface_at(at.xy, 0.0, true);
        float steepness = length(vec2(1.0, min(surface.steepness / texel_m, 4.0)));
        if (abs(surface.height - at.z) > 0.5 * texel_m * steepness) {
            return false;
        }
    }
    return true;
}

// True where something may lie on a beam's way.
bool may_meet(Ray a, Ray b, Ray c) {
    float size = float(plane.map_size);
    float top = min(plane.half_height, max(a.origin.y, max(b.origin.y, c.origin.y)) - plane.middle);
    float bottom = -plane.half_height;
    for (int i = 0; i < 2; i++) {
        vec2 top_a = place_at(a.origin, a.slope, top);
        vec2 top_b = place_at(b.origin, b.slope, top);
        vec2 top_c = place_at(c.origin, c.slope, top);
        vec2 end_a = place_at(a.origin, a.slope, bottom);
        vec2 end_b = place_at(b.origin, b.slope, bottom);
        vec2 end_c = place_at(c.origin, c.slope, bottom);
        vec2 first = min(min(top_a, min(top_b, top_c)), min(end_a, min(end_b, end_c)));
        vec2 last = max(max(top_a, max(top_b, top_c)), max(end_a, max(end_b, end_c)));
        if (any(greaterThanEqual(first, vec2(size))) || any(lessThan(last, vec2(0.0)))) {
            return false;
        }
        vec2 range = heights_within(first, last);
        if (range.x > range.y) {
            return false;
        }
        top = min(top, range.y);
        bottom = max(bottom, range.x);
    }
    return true;
}

void list_it(uint triangle) {
    uint at = atomicAdd(straddling.list[0], 1u);
    straddling.list[at + 1u] = triangle;
}

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle >= plane.triangles) {
        return;
    }
    uvec3 corners = uvec3(indices.list[3u * triangle], indices.list[3u * triangle + 1u], indices.list[3u * triangle + 2u]);
    vec4 a = landings.list[corners.x];
    vec4 b = landings.list[corners.y];
    vec4 c = landings.list[corners.z];
    float least = min(a.w, min(b.w, c.w));
    float size = float(plane.map_size);
    if (least < -1.5) {
        return;
    }
    Ray ray_a = rays.list[corners.x];
    Ray ray_b = rays.list[corners.y];
    Ray ray_c = rays.list[corners.z];
    vec2 low = min(a.xy, min(b.xy, c.xy));
    vec2 high = max(a.xy, max(b.xy, c.xy));
    vec2 box = min(high, vec2(size)) - max(low, vec2(0.0)) + 2.0;
    if (least >= 0.0 && (any(greaterThanEqual(low, vec2(size))) || any(lessThan(high, vec2(0.0))))) {
        return;
    }
    if (least < 0.0 || box.x * box.y > MOST_TEXELS || !lies_flat(a, b, c)) {
        if (may_meet(ray_a, ray_b, ray_c)) {
            list_it(triangle);
        }
        return;
    }

    vec3 face = face_of(ray_a, ray_b, ray_c);
    float flux = max(-dot(face, ray_a.incident * a.w + ray_b.incident * b.w + ray_c.incident * c.w) / 3.0, 0.0);
    // Small numbers keep their digits.
    vec2 base = clamp(floor(low), vec2(-1.0), vec2(size));
    vec2 p = a.xy - base;
    vec2 q = b.xy - base;
    vec2 r = c.xy - base;
    vec2 to_q = q - p;
    vec2 to_r = r - p;
    float area = 0.5 * (to_q.x * to_r.y - to_q.y * to_r.x);
    float longest = sqrt(max(dot(to_q, to_q), max(dot(to_r, to_r), dot(r - q, r - q))));
    if (abs(area) < THIN * max(longest, 1.0)) {
        uint count = uint(clamp(4.0 * longest, 0.0, 500.0)) + 6u;
        for (uint i = 0u; i < count; i++) {
            vec2 at = fract(0.5 + float(i) * vec2(0.7548777, 0.5698403));
            at = at.x + at.y > 1.0 ? 1.0 - at : at;
            ivec2 texel = ivec2(base + floor(p + to_q * at.x + to_r * at.y));
            if (is_in_map(texel)) {
                add_light(texel, flux / float(count));
            }
        }
        return;
    }
    float light = flux / area;
    ivec2 origin = ivec2(base);
    ivec2 from = max(ivec2(floor(min(p, min(q, r)))), -origin);
    ivec2 to = min(ivec2(floor(max(p, max(q, r)))), ivec2(int(plane.map_size) - 1) - origin);
    for (int y = from.y; y <= to.y; y++) {
        vec3 side_p = side_in_row(p, q, float(y));
        vec3 side_q = side_in_row(q, r, float(y));
        vec3 side_r = side_in_row(r, p, float(y));
        for (int x = from.x; x <= to.x; x++) {
            float covered = -(right_of(side_p, float(x)) + right_of(side_q, float(x)) + right_of(side_r, float(x)));
            if (abs(covered) > 1.0e-5) {
                add_light(origin + ivec2(x, y), max(covered * light, 0.0));
            }
        }
    }
}
