#version 450

#pragma variants VEINS=none,solid COUNT=one,several

// Pixels that `resolve` does not finish in one dispatch (resolve.comp), from the start of their lists, in as many as it takes:
// sub-pixels that all masks treat alike are composited together, whose state a pixel can hold.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/lights-{COUNT}.glsl"
#include "gas/lists.glsl"
#include "gas/material.glsl"
#include "gas/veins-{VEINS}.glsl"
#include "gas/shaded.glsl"

void main() {
    read_counts();
    read_lights();
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    uint list = list_of(pixel);
    if (!is_due(RESOLVE, list)) {
        return;
    }
    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    uint head = heads[list];
    float end_m = uintBitsToFloat(pixels[list].z);
    vec3 color = vec3(0.0);
    float opacity = 0.0;
    // Sub-pixels that all masks treat alike are composited together: the group of the lowest that is left shrinks to
    // those on its side of every mask that it meets. One loop goes through the lists of all groups, one after the
    // other.
    uint remaining = FULL;
    uint group = FULL;
    vec3 group_color = vec3(0.0);
    float transmittance = 1.0;
    uint node = head;
    State before = NO_STATE;
    if (is_carried(RESOLVE)) {
        before = state_of(list);
        remaining = before.a.x;
        group = before.a.y;
        node = before.a.z;
        transmittance = uintBitsToFloat(before.a.w);
        group_color = uintBitsToFloat(before.b.xyz);
        opacity = uintBitsToFloat(before.b.w);
        color = uintBitsToFloat(before.c);
    }
    bool is_stopped = false;
    do {
        uint bit = remaining & (~remaining + 1u);
        // Gas, and fragments beside the group: a loop of its own, since a processor that does many pixels in step would
        // shade whenever one of them passes through gas.
        Link link = Link(NONE, 0u, 0.0, 0.0);
        bool is_met = false; // a fragment of the group
        do {
            made++;
            if (node == NONE || transmittance <= 0.0) {
                // An empty list.
            } else if (is_section(node)) {
                vec4 gas = uintBitsToFloat(sections[2u * (node & ~SECTION) + 1u]);
                group_color += gas.xyz * transmittance;
                transmittance *= gas.w;
                node = sections[2u * (node & ~SECTION)].w;
            } else {
                link = link_at(node);
                is_met = (link.mask & bit) != 0u;
                if (!is_met) {
                    group &= ~link.mask;
                    node = link.next;
                }
            }
        } while (all(bvec3(node != NONE, transmittance > 0.0, !is_met)));
        bool is_passed = node == NONE || transmittance <= 0.0;
        if (is_met && !is_passed) {
            uint narrowed = group & link.mask;
            Surface surface = surface_at(node);
            Color at_node = color_at(node);
            Material material = material_of(surface.object);
            float depth_m = mean_depth(link);
            float own = seen_opacity(at_node, material.fade_m, depth_m, end_m);
            float taken = transmittance * own;
            // The fraction of this fragment that shows its neighbour instead.
            uint behind = fragment_at(link.next);
            Link next = Link(NONE, 0u, 0.0, 0.0);
            float overlap = 0.0;
            if (behind != NONE) {
                next = link_at(behind);
                overlap = fraction_behind(link, next);
            }
            float fraction = shown_behind(behind, overlap, next, surface.object, end_m);
            if (fraction > 0.0) {
                bool is_there = (next.mask & bit) != 0u;
                fraction = is_there ? fraction : 0.0;
                narrowed &= is_there ? next.mask : ~next.mask;
            }
            uint count = fraction > 0.0 ? 2u : 1u;
            vec3 light = vec3(0.0);
            uint i = 0u;
            do {
                if (i > 0u) {
                    surface = surface_at(behind);
                    at_node = color_at(behind);
                    material = material_of(surface.object);
                    depth_m = mean_depth(next);
                }
                float weight = i == 0u ? 1.0 - fraction : fraction;
                uint f = i == 0u ? node : behind;
                light += shaded(f, surface, material, color_of(at_node), depth_m, ray) * (taken * weight);
                if (i < count) {
                    i++;
                }
            } while (i < count);
            // Nothing is kept of a fragment that was not shaded to its end.
            is_cut = is_cut || i < count;
            if (!is_cut) {
                group = narrowed;
                group_color += light;
                transmittance *= 1.0 - own;
                node = link.next;
            }
        }
        is_stopped = is_cut || (!is_passed && !is_met);
        if (!is_stopped && (node == NONE || transmittance <= 0.0)) {
            float size = float(bitCount(group)) / 32.0;
            color += (group_color + frame.background * transmittance) * size;
            opacity += (1.0 - transmittance) * size;
            remaining &= ~group;
            group = remaining;
            group_color = vec3(0.0);
            transmittance = 1.0;
            node = head;
        }
        is_stopped = is_stopped || made >= MOST_MADE;
    } while (all(bvec2(remaining != 0u, !is_stopped)));
    imageStore(radiance, ivec2(pixel), vec4(color, opacity));
    uvec4 place = uvec4(remaining, group, node, floatBitsToUint(transmittance));
    uvec4 sums = uvec4(floatBitsToUint(group_color), floatBitsToUint(opacity));
    State state = State(place, sums, floatBitsToUint(color));
    leave(RESOLVE, list, remaining == 0u, before, state);
}
