#version 450

// Each pixel's list by mean depth ("average z value"), then object, then triangle: a merge sort of the links, for any
// length. The extent of the tracing is found here as well: it ends at the depth where the masks of the opaque fragments
// cover the pixel. The sections that `volume` will make are counted and their slots reserved, so that `volume` needs no
// atomics.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-several.glsl"
#include "gas/lists.glsl"
#include "gas/counters.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

// Read and written as vectors: each member that is read by itself costs as much as all of them.
layout(set = 0, binding = 8, std430) buffer Links {
    uvec4 links[]; // each a Link
};

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(set = 0, binding = 12, std430) buffer Pixels {
    Pixel pixels[];
};

float depth_of(uint fragment) {
    vec2 depths = uintBitsToFloat(links[fragment].zw);
    return 0.5 * (depths.x + depths.y);
}

// Triangles are numbered object by object.
bool stands_before(uint a, uint b) {
    float depth_a = depth_of(a);
    float depth_b = depth_of(b);
    return depth_a < depth_b || (depth_a == depth_b && surfaces[a].z < surfaces[b].z);
}

// A merge sort on its way: runs of `run` links are merged two by two, what is merged hangs on `head`.
struct Merge {
    uint head;
    uint tail;
    uint p; // of the run in front
    uint q; // of the run behind
    uint p_left;
    uint q_left;
    uint run;
    uint merges;
    bool is_parted; // q has its place, so that p and q are being merged
};

// Merges runs of 1, 2, 4, ... links until one run is left; true when it is.
bool is_sorted(inout Merge m) {
    bool is_done = false;
    bool is_stopped = false; // the next dispatch goes on
    while (!is_done && !is_stopped) {
        while (m.p != NONE && !is_stopped) {
            while (!m.is_parted && m.p_left < m.run && m.q != NONE) {
                m.p_left++;
                m.q = links[m.q].x;
            }
            bool is_parted = m.is_parted || m.p_left == m.run || m.q == NONE;
            if (is_parted && !m.is_parted) {
                m.is_parted = true;
                m.q_left = m.run;
                m.merges++;
            }
            while (m.is_parted && (m.p_left > 0u || (m.q_left > 0u && m.q != NONE))) {
                bool take_p = m.p_left > 0u;
                if (take_p && m.q_left > 0u && m.q != NONE) {
                    take_p = !stands_before(m.q, m.p);
                }
                uint taken = take_p ? m.p : m.q;
                if (take_p) {
                    m.p = links[m.p].x;
                    m.p_left--;
                } else {
                    m.q = links[m.q].x;
                    m.q_left--;
                }
                if (m.tail == NONE) {
                    m.head = taken;
                } else {
                    links[m.tail].x = taken;
                }
                m.tail = taken;
            }
            is_stopped = !m.is_parted || m.p_left > 0u || (m.q_left > 0u && m.q != NONE);
            if (!is_stopped) {
                made += m.run;
                m.p = m.q;
                m.p_left = 0u;
                m.is_parted = false;
                is_stopped = made >= MOST_MADE;
            }
        }
        if (m.p == NONE && !m.is_parted) {
            if (m.tail != NONE) {
                links[m.tail].x = NONE;
            }
            is_done = m.merges <= 1u;
            if (!is_done) {
                m = Merge(NONE, NONE, m.head, m.head, 0u, 0u, m.run * 2u, 0u, false);
            }
        }
    }
    return is_done;
}

const uint MERGING = 0u;
const uint COVERING = 1u; // the end of the tracing is looked for
const uint COUNTING = 2u; // of the sections

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    read_volumes();
    uint at = list_of(pixel);
    if (!is_due(SORT, at)) {
        return;
    }
    uint head = heads[at];
    Merge merge = Merge(NONE, NONE, head, head, 0u, 0u, 1u, 0u, false);
    uint phase = MERGING;
    uint f = NONE;
    uint covered = 0u;
    float end = frame.yon_m;
    uint cuts = 0u;
    State before = NO_STATE;
    if (is_carried(SORT, at)) {
        before = state_of(at);
        phase = before.c.x;
        if (phase == MERGING) {
            merge = Merge(before.a.x, before.a.y, before.a.z, before.a.w, before.b.x, before.b.y, before.b.z, before.b.w,
                before.c.y != 0u);
        } else {
            f = before.a.x;
            covered = before.a.y;
            end = uintBitsToFloat(before.a.z);
            cuts = before.a.w;
        }
    }
    if (phase == MERGING) {
        if (is_sorted(merge)) {
            head = merge.head;
            heads[at] = head;
            f = head;
            phase = COVERING;
        }
    }
    if (phase == COVERING) {
        uint last = f;
        while (f != NONE && covered != 0xffffffffu) {
            uvec2 link = links[f].xy;
            covered |= opacity_of(Color(0u, colors[f].y)) >= 1.0 ? link.y : 0u;
            last = f;
            f = link.x;
        }
        end = covered == 0xffffffffu && last != NONE ? min(end, depth_of(last)) : end;
    }

    bool is_done = false;
    if (phase != MERGING && !(phase == COVERING && f != NONE && covered != 0xffffffffu)) {
        vec3 ray = ray_direction(vec2(pixel) + 0.5);
        vec2 extent = vec2(1.0e30, 0.0);
        uint ends = 0u;
        uint v = 0u;
        for (; v < volume_count; v++) {
            take_volume(v);
            vec2 segment = intersect(volume_segment(frame.eye, ray), vec2(frame.hither_m, end));
            if (segment.x < segment.y) {
                extent = vec2(min(extent.x, segment.x), max(extent.y, segment.y));
                ends += 2u;
            }
        }
        if (v == volume_count) {
            if (phase == COVERING) {
                phase = COUNTING;
                f = ends > 0u ? head : NONE;
                cuts = ends;
            }
            while (f != NONE) {
                uvec4 link = links[f];
                float depth = 0.5 * (uintBitsToFloat(link.z) + uintBitsToFloat(link.w));
                cuts += uint(depth > extent.x && depth < extent.y);
                f = link.x;
            }
            is_done = f == NONE;
        }
    }
    uint wanted = is_done && cuts > 0u ? cuts - 1u : 0u;
    uint first = 0u;
    if (wanted > 0u) {
        first = atomicAdd(section_count, wanted);
        if (first + wanted > frame.section_capacity) {
            if (first >= MOST_SLOTS) {
                atomicAdd(section_count, 0u - wanted);
            }
            wanted = 0u; // counted: the host grows the buffers and repeats the run
        }
    }
    pixels[at] = Pixel(first, wanted, end, 0u);

    State state = State(uvec4(f, covered, floatBitsToUint(end), cuts), uvec4(0u), uvec3(phase, 0u, 0u));
    if (phase == MERGING) {
        state = State(uvec4(merge.head, merge.tail, merge.p, merge.q),
            uvec4(merge.p_left, merge.q_left, merge.run, merge.merges), uvec3(phase, uint(merge.is_parted), 0u));
    }
    leave(SORT, at, is_done, before, state);
}
