// Section "Volume rendering". The viewer's ray goes through the volumes of a pixel up to the depth that `sort` found, cut at
// every fragment and at every entry and exit of a volume (figure 1). What the march finds of a section becomes a fragment with
// a full mask at its depth in the pixel's list.

layout(local_size_x = 64) in;

layout(set = 0, binding = 36, std430) readonly buffer GasPixels {
    uint gas_groups[3];
    uint gas_pixel_count;
    uint gas_pixels[]; // see gas-pixels.glsl
};

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) buffer Links {
    uvec4 links[]; // each a Link
};

layout(set = 0, binding = 12, std430) buffer Pixels {
    uvec4 pixels[]; // each a Pixel
};

layout(set = 0, binding = 13, std430) buffer Sections {
    uvec4 sections[]; // two of each section of gas
};

#include "gas/lattice.glsl"

void set_next(uint list, uint node, uint next) {
    if (node == NONE) {
        heads[list] = next;
    } else if (is_section(node)) {
        sections[2u * (node & ~SECTION)].w = next;
    } else {
        links[node].x = next;
    }
}

void main() {
    read_scene();
    uint listed = 64u * (band.part * gl_NumWorkGroups.x + gl_WorkGroupID.x) + gl_LocalInvocationID.x;
    if (listed >= gas_pixel_count) {
        return;
    }
    uint words = gas_pixels[listed];
    uvec2 pixel = uvec2(words & 0xffffu, words >> 16u);
    uint pixel_index = pixel.y * frame.size.x + pixel.x;
    uint list = list_of(pixel);
    Pixel reserved = pixel_of_words(pixels[list]);
    if (!is_turn_of(pixel) || !is_due(VOLUME, list)) {
        return;
    }
    bool is_lent = !is_on_lattice(pixel);
    take_pixel(pixel, pixel_index);
    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    float end = reserved.end_m;
    vec2 segments[MAX_VOLUMES];
    float depth = 1.0e30;
    uint v = 0u;
    for (; v < volume_count; v++) {
        take_volume(v);
        segments[v] = intersect(volume_segment(frame.eye, ray), vec2(frame.hither_m, end));
        if (segments[v].x < segments[v].y) {
            depth = min(depth, segments[v].x);
        }
    }
    is_cut = v < volume_count;
    uint previous = NONE; // fragment or section, of the list's start
    uint fragment = heads[list];
    uint used = 0u;
    uint evaluations = 0u;
    uint number = 0u;
    float transparency = 1.0;
    Gas begun = NOTHING;
    State before = NO_STATE;
    if (is_carried(VOLUME)) {
        before = state_of(list);
        depth = uintBitsToFloat(before.a.x);
        fragment = before.a.y;
        previous = before.a.z;
        used = before.a.w;
        number = before.b.x;
        transparency = uintBitsToFloat(before.b.y);
        evaluations = reserved.evaluations;
        uint slot = reserved.first_section + used;
        if (before.b.z > 0u) {
            vec4 light = uintBitsToFloat(sections[2u * slot + 1u]);
            begun = Gas(light.xyz, light.w, before.b.z, 0u, false);
        }
        take_up(uvec4(before.b.w, before.c), sections[2u * slot]);
    }
    bool is_done = depth >= end || used >= reserved.section_count;
    bool is_stopped = false;
    do {
        float next = end;
        bool is_found = false;
        bool is_over = false; // found, or there is none
        do {
            if (fragment != NONE) {
                uvec4 link = links[fragment];
                float cut = 0.5 * (uintBitsToFloat(link.z) + uintBitsToFloat(link.w));
                is_found = cut > depth;
                if (is_found) {
                    next = min(next, cut);
                } else {
                    previous = fragment;
                    fragment = link.x;
                }
            }
            if (fragment == NONE || is_found) {
                is_over = true;
            }
        } while (all(bvec2(fragment != NONE, !is_found)));
        bool has_gas = false;
        bool has_more = false;
        for (v = 0u; v < volume_count; v++) {
            if (segments[v].x < segments[v].y && segments[v].y > depth) {
                has_more = true;
                if (segments[v].x > depth) {
                    next = min(next, segments[v].x);
                } else {
                    has_gas = true;
                    next = min(next, segments[v].y);
                }
            }
        }
        is_stopped = is_cut || !is_over || v < volume_count;
        is_done = is_done || (!is_stopped && (!has_more || next <= depth));
        if (!is_stopped && !is_done) {
            if (has_gas) {
                Gas gas = begun;
                if (is_lent && begun.increments == 0u) {
                    gas = taken(pixel, used, vec2(depth, next));
                }
                if (!gas.is_done) {
                    gas = march(pixel_index, ray, segments, vec2(depth, next), transparency, number, begun);
                }
                evaluations += gas.evaluations;
                uint slot = reserved.first_section + used;
                is_stopped = !gas.is_done;
                vec3 place = vec3(depth, next, float(gas.increments));
                sections[2u * slot] = is_stopped ? second_left() : uvec4(floatBitsToUint(place), fragment);
                sections[2u * slot + 1u] = floatBitsToUint(vec4(gas.color, gas.transparency));
                if (is_stopped) {
                    begun = gas;
                } else {
                    begun = NOTHING;
                    number += gas.increments;
                    transparency *= gas.transparency;
                    set_next(list, previous, slot | SECTION);
                    previous = slot | SECTION;
                    used++;
                    is_done = ends_at(transparency);
                }
            }
            if (!is_stopped) {
                depth = next;
                is_done = is_done || depth >= end || used >= reserved.section_count;
            }
        }
    } while (all(bvec2(!is_done, !is_stopped)));
    uint made_sections = is_done ? used : reserved.section_count;
    pixels[list] = uvec4(reserved.first_section, made_sections, floatBitsToUint(end), evaluations);
    uvec4 place = uvec4(floatBitsToUint(depth), fragment, previous, used);
    uvec4 first = first_left();
    State state = State(place, uvec4(number, floatBitsToUint(transparency), begun.increments, first.x), first.yzw);
    leave(VOLUME, list, is_done, before, state);
}
