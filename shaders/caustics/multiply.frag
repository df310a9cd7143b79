#version 450

// The caustics map of a sample plane, multiplied into the plane's slice by the blend state (section 5.2.1).

layout(set = 0, binding = 0) uniform texture2D caustics_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(push_constant) uniform Combine {
    vec3 intensity; // of the light, linear RGB
} combine;

layout(location = 0) out vec4 factor;

void main() {
    float caustics = texelFetch(sampler2D(caustics_map, nearest), ivec2(gl_FragCoord.xy), 0).r;
    factor = vec4(combine.intensity * caustics, 1.0);
}
