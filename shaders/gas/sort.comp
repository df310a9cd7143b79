#version 450

// Each pixel's list by mean depth ("average z value"), then object, then triangle: a merge sort of the links, for any
// length. The extent of the tracing is found here as well: it ends at the depth where the masks of the opaque fragments
// cover the pixel. The sections that `volume` will make are counted and their slots reserved, so that `volume` needs no
// atomics.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/volume.glsl"
#include "gas/lists.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) buffer Links {
    Link links[];
};

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    Surface surfaces[];
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    Color colors[];
};

layout(set = 0, binding = 11, std430) buffer Counters {
    uint fragment_count; // that the band wants, beyond the capacity as well
    uint section_count;
    uint most_fragments; // in a band before
    uint most_sections;
};

layout(set = 0, binding = 12, std430) buffer Pixels {
    Pixel pixels[];
};

bool stands_before(uint a, uint b) {
    float depth_a = mean_depth(links[a]);
    float depth_b = mean_depth(links[b]);
    if (depth_a != depth_b) {
        return depth_a < depth_b;
    }
    Surface surface_a = surfaces[a];
    Surface surface_b = surfaces[b];
    return surface_a.object != surface_b.object ? surface_a.object < surface_b.object
        : surface_a.triangle < surface_b.triangle;
}

// Merges runs of 1, 2, 4, ... links until one run is left.
uint sorted(uint unsorted) {
    uint head = unsorted;
    for (uint run = 1u; run != 0u; run *= 2u) {
        uint p = head;
        uint tail = NONE;
        uint merges = 0u;
        head = NONE;
        while (p != NONE) {
            merges++;
            uint q = p;
            uint p_left = 0u;
            for (uint i = 0u; i < run; i++) {
                if (q != NONE) {
                    p_left++;
                    q = links[q].next;
                }
            }
            uint q_left = run;
            while (p_left > 0u || (q_left > 0u && q != NONE)) {
                bool take_p = p_left > 0u;
                if (take_p && q_left > 0u && q != NONE) {
                    take_p = !stands_before(q, p);
                }
                uint taken = take_p ? p : q;
                if (take_p) {
                    p = links[p].next;
                    p_left--;
                } else {
                    q = links[q].next;
                    q_left--;
                }
                if (tail == NONE) {
                    head = taken;
                } else {
                    links[tail].next = taken;
                }
                tail = taken;
            }
            p = q;
        }
        if (tail != NONE) {
            links[tail].next = NONE;
        }
        if (merges <= 1u) {
            break;
        }
    }
    return head;
}

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    uint at = list_of(pixel);
    uint head = sorted(heads[at]);
    heads[at] = head;

    float end = frame.yon_m;
    uint covered = 0u;
    for (uint f = head; f != NONE && covered != 0xffffffffu; f = links[f].next) {
        if (opacity_of(colors[f]) >= 1.0) {
            covered |= links[f].mask;
            if (covered == 0xffffffffu) {
                end = min(end, mean_depth(links[f]));
            }
        }
    }

    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    vec2 extent = vec2(1.0e30, 0.0);
    uint cuts = 0u;
    for (uint v = 0u; v < counts.volumes; v++) {
        vec2 segment = intersect(volume_segment(v, frame.eye, ray), vec2(frame.hither_m, end));
        if (segment.x < segment.y) {
            extent = vec2(min(extent.x, segment.x), max(extent.y, segment.y));
            cuts += 2u;
        }
    }
    uint wanted = 0u;
    if (cuts > 0u) {
        for (uint f = head; f != NONE; f = links[f].next) {
            float depth = mean_depth(links[f]);
            if (depth > extent.x && depth < extent.y) {
                cuts++;
            }
        }
        wanted = cuts - 1u;
    }
    uint first = 0u;
    if (wanted > 0u) {
        first = atomicAdd(section_count, wanted);
        if (first + wanted > frame.section_capacity) {
            wanted = 0u; // counted: the host grows the buffers and repeats the run
        }
    }
    pixels[at] = Pixel(first, wanted, end, 0u);
}
