#version 450

// Caustics map combined with the diffuse map (section 5.2.2): I_c x I_d of eq. 4-19, the light's intensity in I_c.

layout(set = 0, binding = 0) uniform texture2D caustics_map;
layout(set = 0, binding = 1) uniform texture2D diffuse_map;
layout(set = 0, binding = 2) uniform sampler nearest;

layout(push_constant) uniform Combine {
    vec3 intensity; // of the light, linear RGB
} combine;

layout(location = 0) out vec4 lit;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float caustics = texelFetch(sampler2D(caustics_map, nearest), texel, 0).r;
    vec4 diffuse = texelFetch(sampler2D(diffuse_map, nearest), texel, 0);
    lit = vec4(combine.intensity * caustics * diffuse.rgb, diffuse.a);
}
