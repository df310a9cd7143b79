#version 450

// Section "Combining A-buffer and volume rendering techniques": the list of surface fragments and the list of sections, both sorted, are
// merged and blended front to back by their masks, as compositing 32 sub-pixels would. Only what is visible is shaded. Where the depth ranges
// of neighbours of two objects overlap they intersect: by Carpenter's estimate a share of the front one's area shows the other.
//
// A compute stage: as a fragment stage it lost groups of sub-pixels on lavapipe and took many times as long; why is not known.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/light.glsl"
#include "gas/lists.glsl"
#include "gas/object.glsl"

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    Object objects[];
};

layout(set = 0, binding = 7, std430) readonly buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) readonly buffer Links {
    uvec4 links[];
};

layout(set = 0, binding = 9, std430) readonly buffer Surfaces {
    uvec4 surfaces[];
};

layout(set = 0, binding = 10, std430) readonly buffer Colors {
    uvec2 colors[];
};

layout(set = 0, binding = 12, std430) readonly buffer Pixels {
    uvec4 pixels[];
};

layout(set = 0, binding = 13, std430) readonly buffer Sections {
    Section sections[];
};

layout(set = 0, binding = 14, std430) readonly buffer Attenuations {
    float attenuations[];
};

layout(push_constant, std430) uniform Shading {
    uint is_attenuated; // whether light-attenuation has run
} shading;

layout(set = 0, binding = 17, rgba32f) uniform writeonly image2D radiance;

const uint FULL = 0xffffffffu;

// Light that a fragment sends to the eye, per opacity. The highlight is Phong's.
vec3 shaded(uint f, vec3 ray) {
    uvec4 surface = surfaces[f];
    vec3 albedo = color_of(colors[f]);
    vec3 point = frame.eye.xyz + ray * mean_depth(links[f]);
    vec3 direction = normalize(ray);
    vec3 normal = unpack_normal(surface.x);
    normal = dot(normal, ray) > 0.0 ? -normal : normal;
    float strength = objects[surface.y].offset.w;
    float exponent = objects[surface.y].detail.x;
    vec3 sum = albedo * frame.ambient.xyz;
    for (uint l = 0u; l < frame.counts.z; l++) {
        vec4 way = towards_light(l, point);
        float facing = dot(normal, way.xyz);
        if (facing > 0.0) {
            vec3 light = irradiance(l, way.w);
            if (shading.is_attenuated != 0u) {
                light *= 1.0 - attenuations[f * frame.counts.z + l];
            }
            float mirrored = max(dot(reflect(direction, normal), way.xyz), 0.0);
            sum += light * (albedo * facing + strength * pow(mirrored, exponent));
        }
    }
    return sum;
}

void main() {
    uvec2 place = gl_GlobalInvocationID.xy;
    if (place.x >= frame.counts.x || place.y >= frame.counts.y) {
        return;
    }
    uint pixel = place.y * frame.counts.x + place.x;
    vec3 ray = ray_direction(vec2(place) + 0.5);
    uvec4 mine = pixels[pixel];
    vec3 color = vec3(0.0);
    float opacity = 0.0;
    // Sub-pixels that all masks treat alike are composited together: the group of the lowest that is left shrinks to those on
    // its side of every mask that it meets. One loop goes through the lists of all groups, one after the other.
    uint remaining = FULL;
    uint group = FULL;
    vec3 group_color = vec3(0.0);
    float left = 1.0;
    uint fragment = heads[pixel];
    uint section = 0u;
    while (remaining != 0u) {
        uint bit = remaining & (~remaining + 1u);
        float depth = 1.0e30;
        uvec4 link = uvec4(NONE, 0u, 0u, 0u);
        if (fragment != NONE) {
            link = links[fragment];
            depth = mean_depth(link);
        }
        bool is_gas = false;
        Section gas;
        if (section < mine.w) {
            gas = sections[mine.x + section];
            is_gas = 0.5 * (gas.extent.x + gas.extent.y) < depth;
        }
        if (left <= 0.0 || (fragment == NONE && !is_gas)) {
            float size = float(bitCount(group)) / 32.0;
            color += (group_color + frame.background.xyz * left) * size;
            opacity += (1.0 - left) * size;
            remaining &= ~group;
            group = remaining;
            group_color = vec3(0.0);
            left = 1.0;
            fragment = heads[pixel];
            section = 0u;
        } else if (is_gas) {
            group_color += gas.color.xyz * left;
            left *= gas.extent.z;
            section++;
        } else if ((link.y & bit) == 0u) {
            group &= ~link.y;
            fragment = link.x;
        } else {
            group &= link.y;
            // The share of this fragment that shows its neighbour instead.
            float share = 0.0;
            if (link.x != NONE) {
                uvec4 next = links[link.x];
                if ((next.y & bit) != 0u && surfaces[link.x].y != surfaces[fragment].y) {
                    share = share_behind(link, next) * opacity_of(colors[link.x]);
                    group &= share > 0.0 ? next.y : FULL;
                }
            }
            float taken = left * opacity_of(colors[fragment]);
            uint count = share > 0.0 ? 2u : 1u;
            for (uint i = 0u; i < count; i++) {
                float part = i == 0u ? 1.0 - share : share;
                group_color += shaded(i == 0u ? fragment : link.x, ray) * (taken * part);
            }
            left *= 1.0 - opacity_of(colors[fragment]);
            fragment = link.x;
        }
    }
    imageStore(radiance, ivec2(place), vec4(color, opacity));
}
