#version 450
#pragma variants SHADOW=off,on LAYERS=one,several

// The triangles of the refined water that do not land whole on one surface (section 6.3), by reference planes as in section 4.4, of
// which each texel has its own, at its height and as steep as the surface there: it takes the part of the beam that it covers, where
// nothing of the receiver stands in the beam's way.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "caustics/unfinished.glsl"
#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/cover.glsl"
#include "caustics/water-triangle.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

// Invocations that share the texels of a triangle.
const uint SHARING = 8u;
// A texel's plane is level where a beam would light more than 1 / this of its width there, where the surface is steeper than this or
// would move the beam by more than a texel, and under beams that it would hardly move.
const float LEAST_TURNED = 0.25;
const float STEEPEST = 8.0;
const float LEAST_MOVED = 0.3;

// True where the receiver stands between the surface of that layer at a texel and the light: a beam ends at the first surface that it
// meets. Texel after texel, but where nothing near the way is high enough.
bool is_hidden(vec2 place, int layer, float height, vec2 slope, float top) {
    vec2 back = -slope * plane.texels_per_m;
    vec2 path = abs(back) * (top - height);
    if (max(path.x, path.y) > float(plane.map_size)) {
        // Beside the map nothing hides it.
        float part = part_over_map(place, back * (top - height)).y;
        top = height + (top - height) * part;
        path *= part;
    }
    int steps = int(min(max(path.x, path.y), float(MOST_STEPS)));
    int from = 0;
    // The way leaves the texel halfway through its first step, or not at all.
    float before = steps > 0 ? height + 0.5 * (top - height) / float(steps) : top;
    int room = layer;
    if (layer > 0 && room_at(ivec2(floor(place)), before) != layer) {
        return true;
    }
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
                if (is_in_map(texel)) {
                    // Under another surface the way may pass it between two steps.
                    int next = room_at(texel, height + rise);
                    if (next < 0 || (room > 0 && room_at(texel, before) > next)) {
                        return true;
                    }
                    room = next;
                }
                before = height + rise;
            }
            is_cut = is_cut || i <= to;
        } else {
            room = 0;
        }
    }
    is_cut = is_cut || from < steps;
    return false;
}

// A straddling triangle's three rays: places at height 0, and how they move with each metre of descent, in texels.
struct Beam {
    vec2 a;
    vec2 b;
    vec2 c;
    vec2 lean_a;
    vec2 lean_b;
    vec2 lean_c;
};

// The texels on the beam's way down: rows of a rectangle, and of each the columns of a strip along the way.
struct Way {
    ivec2 from;
    ivec2 to;
    float middle; // of the strip in row 0
    float shift; // of it from row to row
    float half_width;
    int columns; // of a row at the most
};

Way way_of(Beam beam, float top, float bottom, float reach) {
    float last = float(plane.map_size) - 1.0;
    vec2 top_a = beam.a - beam.lean_a * top;
    vec2 top_b = beam.b - beam.lean_b * top;
    vec2 top_c = beam.c - beam.lean_c * top;
    vec2 end_a = beam.a - beam.lean_a * bottom;
    vec2 end_b = beam.b - beam.lean_b * bottom;
    vec2 end_c = beam.c - beam.lean_c * bottom;
    vec2 low = min(min(top_a, min(top_b, top_c)), min(end_a, min(end_b, end_c))) - reach;
    vec2 high = max(max(top_a, max(top_b, top_c)), max(end_a, max(end_b, end_c))) + reach;
    ivec2 from = ivec2(clamp(low, vec2(0.0), vec2(last)));
    ivec2 to = ivec2(clamp(high, vec2(0.0), vec2(last)));
    vec2 start = (top_a + top_b + top_c) / 3.0;
    vec2 way = (end_a + end_b + end_c) / 3.0 - start;
    float along = length(way);
    vec2 across = along > 1.0e-3 ? vec2(-way.y, way.x) / along : vec2(0.0, 1.0);
    vec3 top_off = abs(vec3(dot(top_a - start, across), dot(top_b - start, across), dot(top_c - start, across)));
    vec3 end_off = abs(vec3(dot(end_a - start, across), dot(end_b - start, across), dot(end_c - start, across)));
    vec3 off = max(top_off, end_off);
    // A texel's corner lies 0.71 from its centre.
    float half_strip = max(off.x, max(off.y, off.z)) + reach + 0.71;
    if (abs(across.x) <= 1.0e-3) {
        return Way(from, to, 0.0, 0.0, 1.0e6, to.x - from.x + 1);
    }
    float shift = -across.y / across.x;
    float half_width = half_strip / abs(across.x);
    int columns = int(min(2.0 * half_width + 4.0, float(to.x - from.x + 1)));
    return Way(from, to, start.x - 0.5 + shift * (0.5 - start.y), shift, half_width, columns);
}

// First and last column in a row.
vec2 columns_of(Way way, int y) {
    float middle = way.middle + way.shift * float(y);
    return vec2(max(float(way.from.x), floor(middle - way.half_width)), min(float(way.to.x), ceil(middle + way.half_width)));
}

// True where a triangle passes the square of that half side about 0.5.
bool passes(vec2 p, vec2 q, vec2 r, float half_side) {
    p -= 0.5;
    q -= 0.5;
    r -= 0.5;
    vec2 least = min(p, min(q, r));
    vec2 most = max(p, max(q, r));
    vec2 to_q = q - p;
    vec2 to_r = r - q;
    vec2 to_p = p - r;
    // How far the square's middle is on the inner side of each side of the triangle, and what the square adds.
    float turn = to_q.x * to_r.y < to_q.y * to_r.x ? -1.0 : 1.0;
    vec3 inside = turn * vec3(to_q.y * p.x - to_q.x * p.y, to_r.y * q.x - to_r.x * q.y, to_p.y * r.x - to_p.x * r.y);
    inside += half_side * vec3(abs(to_q.x) + abs(to_q.y), abs(to_r.x) + abs(to_r.y), abs(to_p.x) + abs(to_p.y));
    return min(inside.x, min(inside.y, inside.z)) >= 0.0 && max(least.x, least.y) <= half_side && min(most.x, most.y) >= -half_side;
}

void main() {
    uint groups = 64u / SHARING * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    int part = int(element(64u) % SHARING);
    uint at = element(64u) / SHARING;
    for (; at < straddling.count; at += groups) {
        Straddler straddler = straddling.list[at];
        Ray a = ray_at(indices.list[3u * straddler.triangle]);
        Ray b = ray_at(indices.list[3u * straddler.triangle + 1u]);
        Ray c = ray_at(indices.list[3u * straddler.triangle + 2u]);
        Beam beam = Beam(place_at(a.origin, a.slope, 0.0), place_at(b.origin, b.slope, 0.0), place_at(c.origin, c.slope, 0.0),
            a.slope * plane.texels_per_m, b.slope * plane.texels_per_m, c.slope * plane.texels_per_m);
        vec2 slope = (a.slope + b.slope + c.slope) / 3.0;
        vec2 lean = (beam.lean_a + beam.lean_b + beam.lean_c) / 3.0;
        // By which a beam may be moved across a texel, in texels.
        float steepest = STEEPEST * max(abs(slope.x), abs(slope.y));
        float most_moved = steepest < LEAST_MOVED ? 0.0 : min(steepest, 1.0);
        float reach = LEAST_WIDTH + (0.5 + LEAST_WIDTH) * most_moved;
        Way way = way_of(beam, straddler.top, straddler.bottom, reach);

        float lowest = min(a.origin.y, min(b.origin.y, c.origin.y)) - plane.middle;
        vec3 origin = (a.origin + b.origin + c.origin) / 3.0;
        float secant = (a.secant + b.secant + c.secant) / 3.0;
        vec3 face = face_of(a, b, c);
        float flux = max(-dot(face, a.incident + b.incident + c.incident) / 3.0, 0.0) * secant;
        int layer = 0;
        for (; layer < layer_count(); layer++) {
            // Every eighth texel of the rows one after the other: a number in the row, and the row.
            float rows_a_column = 1.0 / float(way.columns);
            int skipped = int((float(part) + 0.5) * rows_a_column);
            int y = way.from.y + skipped;
            int number = part - skipped * way.columns;
            while (y <= way.to.y) {
                // The next texel that the beam passes at its height. What follows costs far more than the search, and a processor of
                // several lanes takes it for all of them together: each has found one then.
                bool is_passed = false;
                ivec2 texel = ivec2(0);
                float height = 0.0;
                vec2 p = vec2(0.0);
                vec2 q = vec2(0.0);
                vec2 r = vec2(0.0);
                while (y <= way.to.y && !is_passed) {
                    vec2 columns = columns_of(way, y);
                    texel = ivec2(int(columns.x) + number, y);
                    height = height_of(layer, texel);
                    bool is_met = float(texel.x) <= columns.y && is_receiver(height) && height < lowest;
                    p = beam.a - beam.lean_a * height - vec2(texel);
                    q = beam.b - beam.lean_b * height - vec2(texel);
                    r = beam.c - beam.lean_c * height - vec2(texel);
                    is_passed = is_met && passes(p, q, r, 0.5 + reach);
                    number += int(SHARING);
                    int rows = int((float(number) + 0.5) * rows_a_column);
                    number -= rows * way.columns;
                    y += rows;
                }
                if (!is_passed) {
                    continue;
                }
                float turned = 1.0;
                vec2 steepness = most_moved > 0.0 ? steepness_at(texel, height) : vec2(0.0);
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
                float covered = left_of(row, 0.0) - left_of(row, 1.0);
                float share = covered / area_of(p, q, r);
                vec2 place = vec2(texel) + 0.5;
                if (share <= 0.0 || abs(covered) < 1.0e-6 || is_hidden(place, layer, height, slope, straddler.top)) {
                    continue;
                }
                float descent = origin.y - plane.middle - height;
                vec2 beside = (place - 0.5 * float(plane.map_size)) / plane.texels_per_m + plane.center;
                vec3 point = vec3(beside.x, height + plane.middle, beside.y);
                if (reaches(point, vec3(beside - slope * descent, origin.y).xzy)) {
                    add_light(texel, layer, share * flux / turned * exp(-plane.absorption_per_m * (descent * secant)));
                }
            }
            is_cut = is_cut || y <= way.to.y;
        }
        is_cut = is_cut || layer < layer_count();
    }
    if (is_cut || is_shadow_cut || at < straddling.count) {
        atomicAdd(unfinished.straddle, 1u);
    }
}
