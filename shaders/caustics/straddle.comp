#version 450
#pragma variants SHADOW=off,on

// The triangles of the refined water that do not land whole on one surface (section 6.3), by reference planes as in section 4.4, of
// which each texel has its own, at its height: it takes the part of the beam that it covers there, where nothing of the receiver
// stands in the beam's way.

layout(local_size_x = 64) in;

#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/cover.glsl"
#include "caustics/water-triangle.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

// Invocations that share a triangle's rows of texels, and triangles that they take one after the other at the most.
const uint SHARING = 8u;
const uint IN_TURN = 16u;

// Set where the driver leaves a loop before its end.
bool is_cut = false;

// True where the receiver stands between a texel and the light: a beam ends at the first surface that it meets. Texel after texel,
// but where nothing near the way is high enough.
bool is_hidden(vec2 place, float height, vec2 slope, float top) {
    vec2 back = -slope * plane.texels_per_m;
    vec2 path = abs(back) * (top - height);
    int steps = int(min(max(path.x, path.y), float(MOST_STEPS)));
    int from = 0;
    for (; from < steps; from += STRIDE) {
        int to = min(from + STRIDE, steps);
        float least = (top - height) * float(from) / float(steps);
        float most = (top - height) * float(to) / float(steps);
        vec2 near = heights_between(place + back * least, place + back * most);
        if (near.y > height + least) {
            int i = from + 1;
            for (; i <= to; i++) {
                float rise = (top - height) * float(i) / float(steps);
                ivec2 texel = ivec2(floor(place + back * rise));
                if (is_in_map(texel) && height_at(texel) > height + rise) {
                    return true;
                }
            }
            is_cut = is_cut || i <= to;
        }
    }
    is_cut = is_cut || from < steps;
    return false;
}

void main() {
    uint group = gl_GlobalInvocationID.x / SHARING;
    uint groups = (plane.triangles + IN_TURN - 1u) / IN_TURN;
    if (group >= groups) {
        return;
    }
    float last = float(plane.map_size) - 1.0;
    uint at = group;
    for (; at < straddling.count; at += groups) {
        Straddler straddler = straddling.list[at];
        Ray a = rays.list[indices.list[3u * straddler.triangle]];
        Ray b = rays.list[indices.list[3u * straddler.triangle + 1u]];
        Ray c = rays.list[indices.list[3u * straddler.triangle + 2u]];
        vec2 top_a = place_at(a.origin, a.slope, straddler.top);
        vec2 top_b = place_at(b.origin, b.slope, straddler.top);
        vec2 top_c = place_at(c.origin, c.slope, straddler.top);
        vec2 end_a = place_at(a.origin, a.slope, straddler.bottom);
        vec2 end_b = place_at(b.origin, b.slope, straddler.bottom);
        vec2 end_c = place_at(c.origin, c.slope, straddler.bottom);
        vec2 low = min(min(top_a, min(top_b, top_c)), min(end_a, min(end_b, end_c))) - LEAST_WIDTH;
        vec2 high = max(max(top_a, max(top_b, top_c)), max(end_a, max(end_b, end_c))) + LEAST_WIDTH;
        ivec2 from = ivec2(clamp(low, vec2(0.0), vec2(last)));
        ivec2 to = ivec2(clamp(high, vec2(0.0), vec2(last)));
        // Where its way is long, the beam keeps to a strip along it.
        vec2 start = (top_a + top_b + top_c) / 3.0;
        vec2 way = (end_a + end_b + end_c) / 3.0 - start;
        float along = length(way);
        vec2 across = along > 1.0e-3 ? vec2(-way.y, way.x) / along : vec2(0.0, 1.0);
        vec3 top_off = abs(vec3(dot(top_a - start, across), dot(top_b - start, across), dot(top_c - start, across)));
        vec3 end_off = abs(vec3(dot(end_a - start, across), dot(end_b - start, across), dot(end_c - start, across)));
        vec3 off = max(top_off, end_off);
        // A texel's corner lies 0.71 from its centre.
        float half_strip = max(off.x, max(off.y, off.z)) + LEAST_WIDTH + 0.71;

        float lowest = min(a.origin.y, min(b.origin.y, c.origin.y)) - plane.middle;
        vec3 origin = (a.origin + b.origin + c.origin) / 3.0;
        vec2 slope = (a.slope + b.slope + c.slope) / 3.0;
        float secant = (a.secant + b.secant + c.secant) / 3.0;
        vec3 face = face_of(a, b, c);
        float flux = max(-dot(face, a.incident + b.incident + c.incident) / 3.0, 0.0) * secant;
        int y = from.y + int(gl_GlobalInvocationID.x % SHARING);
        for (; y <= to.y; y += int(SHARING)) {
            vec2 columns = vec2(from.x, to.x);
            if (abs(across.x) > 1.0e-3) {
                float middle = start.x - across.y * (float(y) + 0.5 - start.y) / across.x - 0.5;
                columns = vec2(max(columns.x, floor(middle - half_strip / abs(across.x))), min(columns.y, ceil(middle + half_strip / abs(across.x))));
            }
            int x = int(columns.x);
            for (; x <= int(columns.y); x++) {
                ivec2 texel = ivec2(x, y);
                float height = height_at(texel);
                if (!is_receiver(height) || height >= lowest) {
                    continue;
                }
                vec2 p = place_at(a.origin, a.slope, height) - vec2(texel);
                vec2 q = place_at(b.origin, b.slope, height) - vec2(texel);
                vec2 r = place_at(c.origin, c.slope, height) - vec2(texel);
                if (any(lessThan(max(p, max(q, r)), vec2(-LEAST_WIDTH))) || any(greaterThan(min(p, min(q, r)), vec2(1.0 + LEAST_WIDTH)))) {
                    continue;
                }
                widen(p, q, r);
                Row row;
                row.p = side_in_row(p, q, 0.0, 1.0);
                row.q = side_in_row(q, r, 0.0, 1.0);
                row.r = side_in_row(r, p, 0.0, 1.0);
                float share = (left_of(row, 0.0) - left_of(row, 1.0)) / area_of(p, q, r);
                vec2 place = vec2(texel) + 0.5;
                if (share < 1.0e-6 || is_hidden(place, height, slope, straddler.top)) {
                    continue;
                }
                float descent = origin.y - plane.middle - height;
                vec2 beside = (place - 0.5 * float(plane.map_size)) / plane.texels_per_m + plane.center;
                vec3 point = vec3(beside.x, height + plane.middle, beside.y);
                if (reaches(point, vec3(beside - slope * descent, origin.y).xzy)) {
                    add_light(texel, share * flux * exp(-plane.absorption_per_m * (descent * secant)));
                }
            }
            is_cut = is_cut || x <= int(columns.y);
        }
        is_cut = is_cut || y <= to.y;
    }
    if (is_cut || at < straddling.count) {
        atomicAdd(unfinished.invocations, 1u);
    }
}
