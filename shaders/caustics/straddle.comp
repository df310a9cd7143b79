#version 450
#pragma variants SHADOW=off,on

// The triangles of the refined water that do not land whole on one surface (section 6.3), by reference planes as in section 4.4, of
// which each texel has its own, at its height and as steep as the surface there: it takes the part of the beam that it covers, where
// nothing of the receiver stands in the beam's way.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/cover.glsl"
#include "caustics/water-triangle.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

// Invocations that share a triangle's rows of texels, and triangles that they take one after the other at the most.
const uint SHARING = 8u;
const uint IN_TURN = 16u;
// A texel's plane is level where a beam would light more than 1 / this of its width there, where the surface is steeper than this or
// would move the beam by more than a texel, and under beams that it would hardly move.
const float LEAST_TURNED = 0.25;
const float STEEPEST = 8.0;
const float LEAST_MOVED = 0.3;

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
    uint group = element(64u) / SHARING;
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
        // Places of the rays at height 0, and how they move with each metre of descent, in texels.
        vec2 at_a = place_at(a.origin, a.slope, 0.0);
        vec2 at_b = place_at(b.origin, b.slope, 0.0);
        vec2 at_c = place_at(c.origin, c.slope, 0.0);
        vec2 lean_a = a.slope * plane.texels_per_m;
        vec2 lean_b = b.slope * plane.texels_per_m;
        vec2 lean_c = c.slope * plane.texels_per_m;
        vec2 top_a = at_a - lean_a * straddler.top;
        vec2 top_b = at_b - lean_b * straddler.top;
        vec2 top_c = at_c - lean_c * straddler.top;
        vec2 end_a = at_a - lean_a * straddler.bottom;
        vec2 end_b = at_b - lean_b * straddler.bottom;
        vec2 end_c = at_c - lean_c * straddler.bottom;
        vec2 slope = (a.slope + b.slope + c.slope) / 3.0;
        vec2 lean = (lean_a + lean_b + lean_c) / 3.0;
        // By which a beam may be moved across a texel, in texels.
        float steepest = STEEPEST * max(abs(slope.x), abs(slope.y));
        float most_moved = steepest < LEAST_MOVED ? 0.0 : min(steepest, 1.0);
        float reach = LEAST_WIDTH + 0.5 * most_moved;
        vec2 low = min(min(top_a, min(top_b, top_c)), min(end_a, min(end_b, end_c))) - reach;
        vec2 high = max(max(top_a, max(top_b, top_c)), max(end_a, max(end_b, end_c))) + reach;
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
        float half_strip = max(off.x, max(off.y, off.z)) + reach + 0.71;

        float lowest = min(a.origin.y, min(b.origin.y, c.origin.y)) - plane.middle;
        vec3 origin = (a.origin + b.origin + c.origin) / 3.0;
        float secant = (a.secant + b.secant + c.secant) / 3.0;
        vec3 face = face_of(a, b, c);
        float flux = max(-dot(face, a.incident + b.incident + c.incident) / 3.0, 0.0) * secant;
        int y = from.y + int(element(64u) % SHARING);
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
                vec2 p = at_a - lean_a * height - vec2(texel);
                vec2 q = at_b - lean_b * height - vec2(texel);
                vec2 r = at_c - lean_c * height - vec2(texel);
                if (any(lessThan(max(p, max(q, r)), vec2(-reach))) || any(greaterThan(min(p, min(q, r)), vec2(1.0 + reach)))) {
                    continue;
                }
                float turned = 1.0;
                vec2 steepness = most_moved > 0.0 ? steepness_at(texel) : vec2(0.0);
                float across_it = 1.0 + dot(steepness, lean);
                if (across_it > LEAST_TURNED && (abs(steepness.x) + abs(steepness.y)) * max(abs(lean.x), abs(lean.y)) < most_moved) {
                    // From the level plane to the one as steep as the surface, where the beam lights 1 / turned of the area.
                    turned = across_it;
                    p -= lean * (dot(p - 0.5, steepness) / turned);
                    q -= lean * (dot(q - 0.5, steepness) / turned);
                    r -= lean * (dot(r - 0.5, steepness) / turned);
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
                    add_light(texel, share * flux / turned * exp(-plane.absorption_per_m * (descent * secant)));
                }
            }
            is_cut = is_cut || x <= int(columns.y);
        }
        is_cut = is_cut || y <= to.y;
    }
    if (is_cut || at < straddling.count) {
        atomicAdd(unfinished.straddle, 1u);
    }
}
