#version 450

#pragma variants VEINS=none,solid COUNT=one,several

// Section "Combining A-buffer and volume rendering techniques": surface fragments and the gas's sections, sorted into
// one list, are blended front to back by their masks, as compositing 32 sub-pixels would. Only what is visible is
// shaded. Where the depth ranges of neighbouring fragments of two objects overlap they intersect: by Carpenter's
// estimate a fraction of the front one's area shows the other.
//
// A compute stage: as a fragment stage it lost groups of sub-pixels on lavapipe and took many times as long; why is not
// known.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/band.glsl"
#include "gas/progress.glsl"
#include "gas/lights-{COUNT}.glsl"
#include "gas/lists.glsl"

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    uvec4 object_words[]; // six of each Object, see object.glsl
};

#include "gas/nodes.glsl"

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(set = 0, binding = 12, std430) readonly buffer Pixels {
    Pixel pixels[];
};

layout(set = 0, binding = 14, std430) readonly buffer Attenuations {
    float attenuations[];
};

layout(set = 0, binding = 17, rgba32f) uniform writeonly image2D radiance;

const uint FULL = 0xffffffffu;

// Read as vectors, as links are.
Surface surface_at(uint fragment) {
    uvec4 surface = surfaces[fragment];
    return Surface(surface.x, surface.y, surface.z, uintBitsToFloat(surface.w));
}

Color color_at(uint fragment) {
    uvec2 color = colors[fragment];
    return Color(color.x, color.y);
}

// What an object is made of, as far as shading asks for it.
struct Material {
    vec3 checker_color;
    float checker_edge_m;
    vec3 offset_m;
    float highlight_strength;
    float highlight_exponent;
    float fade_m;
};

Material material_of(uint object) {
    vec4 checkers = uintBitsToFloat(object_words[6u * object + 1u]);
    vec4 place = uintBitsToFloat(object_words[6u * object + 2u]);
    vec4 ends = uintBitsToFloat(object_words[6u * object + 3u]);
    return Material(checkers.xyz, checkers.w, place.xyz, place.w, ends.x, ends.w);
}

// The fragment's own, less what fades before the opaque surfaces that end the pixel's tracing.
float seen_opacity(Color color, float fade_m, float depth_m, float end_m) {
    float t = fade_m > 0.0 ? clamp((end_m - depth_m) / fade_m, 0.0, 1.0) : 1.0;
    return opacity_of(color) * (t * t * (3.0 - 2.0 * t));
}

#include "gas/checkers.glsl"
#include "gas/veins-{VEINS}.glsl"

// Light that fragment f sends to the eye, per opacity. The highlight is Phong's.
vec3 shaded(uint f, Surface surface, Material material, vec3 color, float depth_m, vec3 ray) {
    vec3 point = frame.eye + ray * depth_m;
    vec3 direction = normalize(ray);
    vec3 normal = unpack_normal(surface.normal);
    normal = dot(normal, ray) > 0.0 ? -normal : normal;
    vec3 albedo = checkered(material, color, point, normal, ray);
    albedo = veined(surface.object, material.offset_m, albedo, point, normal, ray);
    vec3 sum = albedo * frame.ambient;
    uint l = 0u;
    do {
        take_light(l);
        LightRay to_light = ray_to_light(point);
        float facing = dot(normal, to_light.direction);
        if (facing > 0.0) {
            vec3 light = irradiance(to_light.distance_m);
            if (counts.attenuations != 0u) {
                light *= 1.0 - attenuations[f * light_count + l];
            }
            float mirrored = max(dot(reflect(direction, normal), to_light.direction), 0.0);
            sum += light * (albedo * facing + material.highlight_strength * pow(mirrored, material.highlight_exponent));
        }
        l++;
    } while (l < light_count);
    is_cut = is_cut || l < light_count;
    return sum;
}

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (!is_in_band(pixel)) {
        return;
    }
    read_counts();
    read_lights();
    uint list = list_of(pixel);
    if (!is_due(RESOLVE, list)) {
        return;
    }
    vec3 ray = ray_direction(vec2(pixel) + 0.5);
    uint head = heads[list];
    float end_m = pixels[list].end_m;
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
                Section gas = sections[node & ~SECTION];
                group_color += gas.color * transmittance;
                transmittance *= gas.transparency;
                node = gas.next;
            } else {
                link = link_at(node);
                is_met = (link.mask & bit) != 0u;
                if (!is_met) {
                    group &= ~link.mask;
                    node = link.next;
                }
            }
        } while (node != NONE && transmittance > 0.0 && !is_met);
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
            float fraction = 0.0;
            uint behind = fragment_at(link.next);
            Link next = Link(NONE, 0u, 0.0, 0.0);
            float overlap = 0.0;
            if (behind != NONE) {
                next = link_at(behind);
                overlap = fraction_behind(link, next);
            }
            if (overlap > 0.0) {
                uint object = surfaces[behind].y;
                float fade_m = uintBitsToFloat(object_words[6u * object + 3u].w);
                float shown = overlap * seen_opacity(color_at(behind), fade_m, mean_depth(next), end_m);
                if (shown > 0.0 && object != surface.object) {
                    bool is_there = (next.mask & bit) != 0u;
                    fraction = is_there ? shown : 0.0;
                    narrowed &= is_there ? next.mask : ~next.mask;
                }
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
                i++;
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
    } while (remaining != 0u && !is_stopped);
    imageStore(radiance, ivec2(pixel), vec4(color, opacity));
    uvec4 place = uvec4(remaining, group, node, floatBitsToUint(transmittance));
    uvec4 sums = uvec4(floatBitsToUint(group_color), floatBitsToUint(opacity));
    State state = State(place, sums, floatBitsToUint(color));
    leave(RESOLVE, list, remaining == 0u, before, state);
}
