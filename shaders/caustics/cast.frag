#version 450

// Caustics casting by projective texture mapping (section 4.6): colour = (I_c x I_d) + I_a, eq. 4-19 and 4-20. The combined map
// holds the product; it lights only the surface that the position map saw, the rest of the receiver has ambient light alone.

layout(location = 0) in vec3 world;
layout(location = 1) in vec3 world_normal;

#include "caustics/box.glsl"
#include "caustics/cast.glsl"

layout(set = 0, binding = 1) uniform texture2D combined_map;
layout(set = 0, binding = 2) uniform texture2D position_map;
layout(set = 0, binding = 3) uniform sampler nearest;

layout(location = 0) out vec4 color;

void main() {
    vec3 point = to_box(receiver.bounds, world);
    float texels = receiver.bounds.texels;
    vec2 place = (point.xz / receiver.bounds.extent.xz + 0.5) * texels - 0.5;
    vec2 base = floor(place);
    vec2 fraction = place - base;

    // A texel belongs to this surface when its height differs by no more than the surface rises over a texel and a half.
    vec3 normal = normalize(world_normal);
    float facing = dot(normal, receiver.bounds.v);
    float cos_light = max(facing, 0.05);
    float rise = sqrt(1.0 - cos_light * cos_light) / cos_light;
    float texel_m = max(receiver.bounds.extent.x, receiver.bounds.extent.z) / texels;
    float tolerance_m = texel_m * (1.5 * rise + 0.5) + receiver.height_slack_m;

    vec3 lit = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 corner = vec2(float(i & 1), float(i >> 1));
        vec2 weights = mix(1.0 - fraction, fraction, corner);
        ivec2 texel = ivec2(clamp(base + corner, vec2(0.0), vec2(texels - 1.0)));
        float height = texelFetch(sampler2D(position_map, nearest), texel, 0).r;
        float weight = abs(height - point.y) <= tolerance_m ? weights.x * weights.y : 0.0;
        lit += weight * texelFetch(sampler2D(combined_map, nearest), texel, 0).rgb;
        total += weight;
    }
    // Texels of other surfaces say nothing about this one: the rest is spread over those that match.
    // Where it faces away I_d is 0, whatever its lit neighbours across the silhouette hold.
    lit = total > 0.0 && facing > 0.0 ? lit / total : vec3(0.0);
    color = vec4(lit + receiver.albedo * receiver.ambient, 1.0);
}
