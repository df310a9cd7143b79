#version 450

// A caustics map that was drawn at a multiple of its size, averaged down: the light of each texel from many places in it.

layout(set = 0, binding = 0) uniform texture2D drawn_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(push_constant) uniform Coverage {
    uint multiple; // texels a side of the drawn map in a texel
} coverage;

layout(location = 0) out float caustics;

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * int(coverage.multiple);
    float sum = 0.0;
    for (int y = 0; y < int(coverage.multiple); y++) {
        for (int x = 0; x < int(coverage.multiple); x++) {
            sum += texelFetch(sampler2D(drawn_map, nearest), first + ivec2(x, y), 0).r;
        }
    }
    caustics = sum / float(coverage.multiple * coverage.multiple);
}
