#version 450

// The slices of the illumination map put together, nearest to the light first (section 5.2.1): the first slice that holds the
// receiver at this texel hides all that follow.

layout(set = 0, binding = 0) uniform texture2DArray illumination_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(push_constant) uniform Slices {
    uint count;
    float top; // of the box, metres of box space
    float cell_height; // metres
} slices;

layout(location = 0) out vec4 lit;
layout(location = 1) out float position; // height of the slice's plane: what the cast may light

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    lit = vec4(0.0);
    position = -1.0e30;
    for (uint i = 0u; i < slices.count; i++) {
        vec4 slice = texelFetch(sampler2DArray(illumination_map, nearest), ivec3(texel, int(i)), 0);
        if (slice.a > 0.0) {
            lit = slice;
            position = slices.top - (float(i) + 0.5) * slices.cell_height;
            break;
        }
    }
}
