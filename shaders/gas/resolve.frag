#version 450

// Section "Combining A-buffer and volume rendering techniques": the list of surface fragments and the list of sections, both sorted, are
// merged and blended front to back by their masks, as compositing 32 sub-pixels would. Only what is visible is shaded. Where the depth ranges
// of neighbours of two objects overlap they intersect: by Carpenter's estimate a share of the front one's area shows the other.

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

layout(location = 0) out vec4 radiance;

const uint FULL = 0xffffffffu;
const uint SUBPIXELS = 32u;

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
    uvec2 place = uvec2(gl_FragCoord.xy);
    uint pixel = place.y * frame.counts.x + place.x;
    vec3 ray = ray_direction(vec2(place) + 0.5);
    uvec4 mine = pixels[pixel];
    vec3 color = vec3(0.0);
    // One transparency while every mask was full, then one for each sub-pixel.
    float whole = 1.0;
    float parts[SUBPIXELS];
    bool is_split = false;
    uint fragment = heads[pixel];
    uint section = 0u;
    while (fragment != NONE || section < mine.w) {
        uvec4 link = uvec4(NONE, 0u, 0u, 0u);
        float depth = 1.0e30;
        if (fragment != NONE) {
            link = links[fragment];
            depth = mean_depth(link);
        }
        if (section < mine.w) {
            vec4 extent = sections[mine.x + section].extent;
            if (0.5 * (extent.x + extent.y) < depth) {
                vec3 gas = sections[mine.x + section].color.xyz;
                if (is_split) {
                    float left = 0.0;
                    for (uint i = 0u; i < SUBPIXELS; i++) {
                        left += parts[i];
                        parts[i] *= extent.z;
                    }
                    color += gas * (left / float(SUBPIXELS));
                } else {
                    color += gas * whole;
                    whole *= extent.z;
                }
                section++;
                continue;
            }
        }
        if (link.y != FULL && !is_split) {
            for (uint i = 0u; i < SUBPIXELS; i++) {
                parts[i] = whole;
            }
            is_split = true;
        }
        float opacity = opacity_of(colors[fragment]);
        // What of this fragment, where both are, shows its neighbour instead.
        uint both = 0u; // sub-pixels
        float share = 0.0;
        if (link.x != NONE) {
            uvec4 next = links[link.x];
            if (surfaces[link.x].y != surfaces[fragment].y) {
                both = link.y & next.y;
                share = share_behind(link, next) * opacity_of(colors[link.x]);
            }
        }
        float seen = 0.0;
        float seen_in_both = 0.0;
        if (is_split) {
            for (uint i = 0u; i < SUBPIXELS; i++) {
                uint bit = 1u << i;
                if ((link.y & bit) != 0u) {
                    float part = parts[i] / float(SUBPIXELS);
                    seen += part;
                    seen_in_both += (both & bit) != 0u ? part : 0.0;
                    parts[i] *= 1.0 - opacity;
                }
            }
        } else {
            seen = whole;
            seen_in_both = whole * (float(bitCount(both)) / float(SUBPIXELS));
            whole *= 1.0 - opacity;
        }
        if (seen > 0.0) {
            float others = seen_in_both * share;
            color += shaded(fragment, ray) * (opacity * (seen - others));
            if (others > 0.0) {
                color += shaded(link.x, ray) * (opacity * others);
            }
        }
        fragment = link.x;
    }
    float left = whole;
    if (is_split) {
        left = 0.0;
        for (uint i = 0u; i < SUBPIXELS; i++) {
            left += parts[i] / float(SUBPIXELS);
        }
    }
    radiance = vec4(color + frame.background.xyz * left, 1.0 - left);
}
