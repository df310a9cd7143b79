#version 450

#pragma variants VEINS=none,solid COUNT=one,several

// Section "Combining A-buffer and volume rendering techniques": surface fragments and the gas's sections, sorted into
// one list, are blended front to back by their masks: each of 32 sub-pixels has a transparency of its own. Only what is visible is
// shaded, once. Where the depth ranges of neighbouring fragments of two objects overlap they intersect: by Carpenter's
// estimate a fraction of the front one's area shows the other.
//
// A compute stage: as a fragment stage it lost groups of sub-pixels on lavapipe and took many times as long; why is not
// known. A pixel that this dispatch does not finish is left to resolve-rest.comp.

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

// Of each sub-pixel the transparency of what was met so far, by four.
struct Clear {
    vec4 a;
    vec4 b;
    vec4 c;
    vec4 d;
    vec4 e;
    vec4 f;
    vec4 g;
    vec4 h;
};

// Those of four sub-pixels from `first` on that are in the mask, 0 for the others.
vec4 within(vec4 clear, uint mask, uint first) {
    ivec4 bits = ivec4(uvec4(mask) << (uvec4(31u, 30u, 29u, 28u) - first)) >> uvec4(31u);
    return uintBitsToFloat(floatBitsToUint(clear) & uvec4(bits));
}

Clear within(Clear clear, uint mask) {
    return Clear(within(clear.a, mask, 0u), within(clear.b, mask, 4u), within(clear.c, mask, 8u),
        within(clear.d, mask, 12u), within(clear.e, mask, 16u), within(clear.f, mask, 20u), within(clear.g, mask, 24u),
        within(clear.h, mask, 28u));
}

float sum_of(Clear clear) {
    vec4 sum = ((clear.a + clear.b) + (clear.c + clear.d)) + ((clear.e + clear.f) + (clear.g + clear.h));
    return (sum.x + sum.y) + (sum.z + sum.w);
}

// Behind what takes that fraction of a part of it.
Clear behind_of(Clear clear, Clear part, float taken) {
    return Clear(clear.a - part.a * taken, clear.b - part.b * taken, clear.c - part.c * taken, clear.d - part.d * taken,
        clear.e - part.e * taken, clear.f - part.f * taken, clear.g - part.g * taken, clear.h - part.h * taken);
}

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
    Clear clear = Clear(vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0));
    uint left = FULL; // sub-pixels that something may shine through
    float lent = 0.0; // of the fragment before, what shows this one instead, in sub-pixels
    vec3 color = vec3(0.0); // in sub-pixels
    uint node = head;
    bool is_passed = false;
    bool is_stopped = false;
    do {
        // Gas, and fragments that nothing shines on: a loop of its own, since a processor that does many pixels in step would
        // shade whenever one of them passes through gas.
        Link link = Link(NONE, 0u, 0.0, 0.0);
        bool is_met = false; // a fragment that is seen
        do {
            made++;
            if (node == NONE || (left == 0u && lent <= 0.0)) {
                // An empty list.
            } else if (is_section(node)) {
                uint slot = 2u * (node & ~SECTION);
                vec4 gas = uintBitsToFloat(sections[slot + 1u]);
                color += gas.xyz * sum_of(clear);
                clear = behind_of(clear, clear, 1.0 - gas.w);
                left = gas.w > 0.0 ? left : 0u;
                node = sections[slot].w;
            } else {
                link = link_at(node);
                is_met = (link.mask & left) != 0u || lent > 0.0;
                node = is_met ? node : link.next;
            }
        } while (all(bvec3(node != NONE, any(bvec2(left != 0u, lent > 0.0)), !is_met)));
        is_passed = node == NONE || (left == 0u && lent <= 0.0);
        if (is_met && !is_passed) {
            Surface surface = surface_at(node);
            Color at_node = color_at(node);
            Material material = material_of(surface.object);
            float depth_m = mean_depth(link);
            float own = seen_opacity(at_node, material.fade_m, depth_m, end_m);
            // The fraction of this fragment that shows its neighbour instead.
            uint behind = fragment_at(link.next);
            Link next = Link(NONE, 0u, 0.0, 0.0);
            float overlap = 0.0;
            if (behind != NONE) {
                next = link_at(behind);
                overlap = fraction_behind(link, next);
            }
            float fraction = shown_behind(behind, overlap, next, surface.object, end_m);
            Clear part = within(clear, link.mask);
            float seen = sum_of(part) * own;
            float shared_with_next = sum_of(within(part, next.mask)) * own * fraction;
            vec3 light = shaded(node, surface, material, color_of(at_node), depth_m, ray);
            // Nothing is kept of a fragment that was not shaded to its end.
            if (!is_cut) {
                color += light * (seen - shared_with_next + lent);
                lent = shared_with_next;
                clear = behind_of(clear, part, own);
                left &= own < 1.0 ? FULL : ~link.mask;
                node = link.next;
            }
        }
        is_stopped = is_cut || made >= MOST_MADE || (!is_passed && !is_met);
        is_passed = is_passed || node == NONE || (left == 0u && lent <= 0.0);
    } while (all(bvec2(!is_passed, !is_stopped)));
    float through = sum_of(clear);
    vec3 seen_color = (color + frame.background * through) / 32.0;
    imageStore(radiance, ivec2(pixel), vec4(seen_color, 1.0 - through / 32.0));
    State state = State(uvec4(FULL, FULL, head, floatBitsToUint(1.0)), uvec4(0u), uvec3(0u));
    leave(RESOLVE, list, is_passed && !is_cut, NO_STATE, state);
}
