#version 450
#pragma variants LAYERS=one,several

// Caustics casting by projective texture mapping (section 4.6): colour = (I_c x I_d) + I_a, eq. 4-19 and 4-20. The combined map
// holds the product; it lights only the surface that the position map saw, and with LAYERS=several those below it that have maps of
// their own; the rest of the receiver has ambient light alone.

layout(location = 0) in vec3 world;
layout(location = 1) in vec3 world_normal;

#include "caustics/box.glsl"
#include "caustics/cast.glsl"

layout(set = 0, binding = 1) uniform texture2D combined_map;
layout(set = 0, binding = 2) uniform texture2D position_map;
layout(set = 0, binding = 3) uniform sampler nearest;
#ifdef LAYERS_SEVERAL
layout(set = 0, binding = 4) uniform texture2DArray hidden_positions;
layout(set = 0, binding = 5) uniform texture2DArray hidden_light; // combined maps
#endif

layout(location = 0) out vec4 color;

const float STEEPEST = 0.12; // cosine of the steepest face against the light

void main() {
    vec3 point = to_box(receiver.bounds, world);
    float texels = receiver.bounds.texels;
    vec2 place = (point.xz / receiver.bounds.extent.xz + 0.5) * texels - 0.5;
    vec2 base = floor(place);
    vec2 fraction = place - base;

    // A texel belongs to this surface when its height is that of the face's plane there, but for what a curved surface leaves it
    // within a texel. A face that is seen nearly edge-on by the light would pass for any height: it counts as one of 83 degrees.
    vec3 face = cross(dFdx(world), dFdy(world));
    vec3 face_box = vec3(dot(receiver.bounds.u, face), dot(receiver.bounds.v, face), dot(receiver.bounds.w, face));
    face_box *= face_box.y < 0.0 ? -1.0 : 1.0;
    vec2 slope = -face_box.xz / max(face_box.y, max(STEEPEST * length(face), 1.0e-30));
    vec2 texel_m = receiver.bounds.extent.xz / texels;
    float tolerance_m = 0.5 * max(texel_m.x, texel_m.y) * (1.0 + length(slope)) + receiver.height_slack_m;

    vec3 lit = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 corner = vec2(float(i & 1), float(i >> 1));
        vec2 weights = mix(1.0 - fraction, fraction, corner);
        ivec2 texel = ivec2(clamp(base + corner, vec2(0.0), vec2(texels - 1.0)));
        float height = texelFetch(sampler2D(position_map, nearest), texel, 0).r;
        float expected = point.y + dot(slope, (corner - fraction) * texel_m);
        vec3 light = texelFetch(sampler2D(combined_map, nearest), texel, 0).rgb;
#ifdef LAYERS_SEVERAL
        int layers = textureSize(sampler2DArray(hidden_positions, nearest), 0).z;
        for (int layer = 0; layer < layers && abs(height - expected) > tolerance_m; layer++) {
            height = texelFetch(sampler2DArray(hidden_positions, nearest), ivec3(texel, layer), 0).r;
            light = texelFetch(sampler2DArray(hidden_light, nearest), ivec3(texel, layer), 0).rgb;
        }
#endif
        float weight = abs(height - expected) <= tolerance_m ? weights.x * weights.y : 0.0;
        lit += weight * light;
        total += weight;
    }
    // Texels of other surfaces say nothing about this one: the rest is spread over those that match, as long as they are a quarter of
    // all, the least weight that the nearest can have. A smaller part fades: it must not light a place in shadow in full.
    // Where it faces away I_d is 0, whatever its lit neighbours across the silhouette hold.
    float facing = dot(world_normal, receiver.bounds.v);
    lit = facing > 0.0 ? lit / max(total, 0.25) : vec3(0.0);
    color = vec4(lit + receiver.albedo * receiver.ambient, 1.0);
}
