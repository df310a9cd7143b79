#version 450

#pragma variants COUNT=one,several

// Each pixel's list by mean depth ("average z value"), then object, then triangle: runs of up to eight in registers, which are
// merged, for any length. The extent of the tracing is found here as well: it ends at the depth where the masks of the opaque fragments
// cover the pixel. The sections that `volume` will make are counted and their slots reserved, so that `volume` needs no
// atomics, and pixels that have some are listed for it.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/volumes-{COUNT}.glsl"
#include "gas/lists.glsl"
#include "gas/counters.glsl"
#include "gas/gas-pixels.glsl"

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
    uvec4 pixels[]; // each a Pixel
};

float mean_depth_of(uvec4 link) {
    return 0.5 * (uintBitsToFloat(link.z) + uintBitsToFloat(link.w));
}

// Triangles are numbered object by object.
bool stands_before(uint a, uvec4 link_a, uint b, uvec4 link_b) {
    float depth_a = mean_depth_of(link_a);
    float depth_b = mean_depth_of(link_b);
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

// Merges runs of 1, 2, 4, ... links until one run is left; true when it is. Else the next dispatch goes on.
bool is_sorted(inout Merge m) {
    bool is_done = false;
    do {
        if (m.p != NONE || m.is_parted) {
            // To the run behind.
            do {
                if (!m.is_parted && m.p_left < m.run && m.q != NONE) {
                    m.p_left++;
                    m.q = links[m.q].x;
                    made++;
                }
                if (!m.is_parted && (m.p_left == m.run || m.q == NONE)) {
                    m.is_parted = true;
                    m.q_left = m.run;
                    m.merges++;
                }
            } while (all(bvec2(!m.is_parted, made < MOST_MADE)));
            bool is_merged = false;
            if (m.is_parted) {
                uvec4 p_link = m.p != NONE ? links[m.p] : uvec4(NONE);
                uvec4 q_link = m.q != NONE ? links[m.q] : uvec4(NONE);
                do {
                    bool has_p = m.p_left > 0u;
                    bool has_q = m.q_left > 0u && m.q != NONE;
                    if (has_p || has_q) {
                        bool take_p = has_p;
                        if (has_p && has_q) {
                            take_p = !stands_before(m.q, q_link, m.p, p_link);
                        }
                        uint taken = take_p ? m.p : m.q;
                        uint after = take_p ? p_link.x : q_link.x;
                        uvec4 link = after != NONE ? links[after] : uvec4(NONE);
                        if (take_p) {
                            m.p = after;
                            p_link = link;
                            m.p_left--;
                        } else {
                            m.q = after;
                            q_link = link;
                            m.q_left--;
                        }
                        if (m.tail == NONE) {
                            m.head = taken;
                        } else {
                            links[m.tail].x = taken;
                        }
                        m.tail = taken;
                        made++;
                    } else {
                        is_merged = true;
                    }
                } while (all(bvec2(!is_merged, made < MOST_MADE)));
            }
            if (is_merged) {
                m.p = m.q;
                m.p_left = 0u;
                m.is_parted = false;
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
    } while (all(bvec2(!is_done, made < MOST_MADE)));
    return is_done;
}

// Up to 8 fragments in order; what is not there stands at the end.
struct Run {
    vec4 depths[2];
    uvec4 nodes[2];
    uvec4 masks[2];
};

const float NOWHERE_M = 1.0e30;
const Run NO_RUN = Run(vec4[2](vec4(NOWHERE_M), vec4(NOWHERE_M)), uvec4[2](uvec4(NONE), uvec4(NONE)),
    uvec4[2](uvec4(0u), uvec4(0u)));
const uint MOST_OF_RUN = 8u;
const uint MOST_RUNS = 8u; // of a list that is cut into them; a longer one is merged from its links on

bool has_depth(Run run, float depth) {
    return any(equal(run.depths[0], vec4(depth))) || any(equal(run.depths[1], vec4(depth)));
}

// What is farther than the fragment moves on by one.
void insert(inout Run run, float depth, uint node, uint mask) {
    bvec4 later = greaterThan(run.depths[0], vec4(depth));
    bvec4 latest = greaterThan(run.depths[1], vec4(depth));
    bvec4 moved = bvec4(false, later.xyz);
    bvec4 moved_last = bvec4(later.w, latest.xyz);
    vec4 depths = vec4(depth, run.depths[0].xyz);
    uvec4 nodes = uvec4(node, run.nodes[0].xyz);
    uvec4 masks = uvec4(mask, run.masks[0].xyz);
    run.depths[1] = mix(run.depths[1],
        mix(vec4(depth), vec4(run.depths[0].w, run.depths[1].xyz), moved_last), latest);
    run.nodes[1] = mix(run.nodes[1],
        mix(uvec4(node), uvec4(run.nodes[0].w, run.nodes[1].xyz), moved_last), latest);
    run.masks[1] = mix(run.masks[1],
        mix(uvec4(mask), uvec4(run.masks[0].w, run.masks[1].xyz), moved_last), latest);
    run.depths[0] = mix(run.depths[0], mix(vec4(depth), depths, moved), later);
    run.nodes[0] = mix(run.nodes[0], mix(uvec4(node), nodes, moved), later);
    run.masks[0] = mix(run.masks[0], mix(uvec4(mask), masks, moved), later);
}

// The second fragment becomes the first, the first the last.
void turn(inout Run run) {
    vec4 depths = run.depths[0];
    uvec4 nodes = run.nodes[0];
    uvec4 masks = run.masks[0];
    run.depths[0] = vec4(depths.yzw, run.depths[1].x);
    run.nodes[0] = uvec4(nodes.yzw, run.nodes[1].x);
    run.masks[0] = uvec4(masks.yzw, run.masks[1].x);
    run.depths[1] = vec4(run.depths[1].yzw, depths.x);
    run.nodes[1] = uvec4(run.nodes[1].yzw, nodes.x);
    run.masks[1] = uvec4(run.masks[1].yzw, masks.x);
}

// Fragments of it between two depths.
uint count_between(Run run, vec2 extent) {
    uvec4 counts = uvec4(greaterThan(run.depths[0], vec4(extent.x))) * uvec4(lessThan(run.depths[0], vec4(extent.y)))
        + uvec4(greaterThan(run.depths[1], vec4(extent.x))) * uvec4(lessThan(run.depths[1], vec4(extent.y)));
    return counts.x + counts.y + counts.z + counts.w;
}

// Each slot is given once: the first of as many groups as there are parts asks for one more of each part.
void add_gas_pixel(uvec2 pixel) {
    uint slot = atomicAdd(gas_pixel_count, 1u);
    gas_pixels[slot] = pixel.x | (pixel.y << 16u);
    if ((slot & ((64u << band.part_bits) - 1u)) == 0u) {
        atomicMax(gas_groups[0], (slot >> (6u + band.part_bits)) + 1u);
    }
}

const uint MERGING = 0u;
const uint COVERING = 1u; // the end of the tracing is looked for
const uint COUNTING = 2u; // of the sections

void main() {
    read_volumes();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
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
    bool is_begun = is_carried(SORT);
    if (is_begun) {
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

    uint next = is_begun ? NONE : head;
    uint last = NONE;
    uint runs = 0u;
    bool is_moved = false;
    bool has_equal = false; // depths in a run, of which the triangles are not asked here
    Run run = NO_RUN;
    while (next != NONE && runs < MOST_RUNS) {
        run = NO_RUN;
        uint count = 0u;
        float farthest_m = 0.0;
        while (next != NONE && count < MOST_OF_RUN) {
            uvec4 link = links[next];
            float depth = mean_depth_of(link);
            has_equal = has_equal || has_depth(run, depth);
            is_moved = is_moved || depth < farthest_m;
            farthest_m = max(farthest_m, depth);
            insert(run, depth, next, link.y);
            next = link.x;
            count++;
        }
        bool is_all = runs == 0u && next == NONE && !has_equal;
        float end_m = NOWHERE_M;
        while (count > 0u) {
            uint node = run.nodes[0].x;
            head = last == NONE ? node : head;
            if (is_moved && last != NONE) {
                links[last].x = node;
            }
            if (is_all && covered != 0xffffffffu) {
                covered |= opacity_of(Color(0u, colors[node].y)) >= 1.0 ? run.masks[0].x : 0u;
                end_m = run.depths[0].x;
            }
            last = node;
            turn(run);
            count--;
        }
        end = is_all && covered == 0xffffffffu ? min(end, end_m) : end;
        runs++;
    }
    if (is_moved) {
        links[last].x = next;
        heads[at] = head;
    }
    bool is_one_run = !is_begun && runs <= 1u && next == NONE && !has_equal;
    if (is_one_run) {
        phase = COVERING; // which is done
    } else if (!is_begun) {
        merge = Merge(NONE, NONE, head, head, 0u, 0u, next == NONE && !has_equal ? MOST_OF_RUN : 1u, 0u, false);
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
        uint farthest = NONE;
        do {
            if (f != NONE && covered != 0xffffffffu) {
                uvec2 link = links[f].xy;
                covered |= opacity_of(Color(0u, colors[f].y)) >= 1.0 ? link.y : 0u;
                farthest = f;
                f = link.x;
                made++;
            }
        } while (all(bvec3(f != NONE, covered != 0xffffffffu, made < MOST_MADE)));
        if (covered == 0xffffffffu && farthest != NONE) {
            end = min(end, mean_depth_of(links[farthest]));
        }
    }

    bool is_done = false;
    if (phase != MERGING && !(phase == COVERING && f != NONE && covered != 0xffffffffu)) {
        vec3 ray = ray_direction(vec2(pixel) + 0.5);
        vec2 extent = vec2(1.0e30, 0.0);
        uint ends = 0u;
        uint v = 0u;
        do {
            if (v < volume_count) {
                take_volume(v);
                vec2 segment = intersect(volume_segment(frame.eye, ray), vec2(frame.hither_m, end));
                if (segment.x < segment.y) {
                    extent = vec2(min(extent.x, segment.x), max(extent.y, segment.y));
                    ends += 2u;
                }
                v++;
            }
        } while (v < volume_count);
        if (v == volume_count) {
            if (phase == COVERING) {
                phase = COUNTING;
                f = ends > 0u && !is_one_run ? head : NONE;
                cuts = ends + (ends > 0u && is_one_run ? count_between(run, extent) : 0u);
            }
            do {
                if (f != NONE) {
                    uvec4 link = links[f];
                    float depth = mean_depth_of(link);
                    cuts += uint(depth > extent.x && depth < extent.y);
                    f = link.x;
                    made++;
                }
            } while (all(bvec2(f != NONE, made < MOST_MADE)));
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
    pixels[at] = uvec4(first, wanted, floatBitsToUint(end), 0u);
    if (wanted > 0u) {
        add_gas_pixel(pixel);
    }

    State state = State(uvec4(f, covered, floatBitsToUint(end), cuts), uvec4(0u), uvec3(phase, 0u, 0u));
    if (phase == MERGING) {
        state = State(uvec4(merge.head, merge.tail, merge.p, merge.q),
            uvec4(merge.p_left, merge.q_left, merge.run, merge.merges), uvec3(phase, uint(merge.is_parted), 0u));
    }
    leave(SORT, at, is_done, before, state);
}
