#version 450

// Writes the sum of a texel and of a bilinear sample half a texel further.

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D source;
layout(set = 0, binding = 1) uniform sampler linear;
layout(set = 1, binding = 0, rgba32f) uniform writeonly image2D result;

void main() {
    ivec2 size = imageSize(result);
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= size.x || pixel.y >= size.y) {
        return;
    }
    vec4 texel = texelFetch(sampler2D(source, linear), pixel, 0);
    vec2 uv = (vec2(pixel) + 1.0) / vec2(size);
    imageStore(result, pixel, texel + textureLod(sampler2D(source, linear), uv, 0.0));
}
