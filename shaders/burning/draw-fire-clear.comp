#version 450

// Nothing reaches any line of tiles before the particles of a chunk are asked (ours).

layout(local_size_x = 88) in; // three groups fill a line

layout(set = 0, binding = 116, r32ui) uniform writeonly uimage2D line_masks;

void main() {
    imageStore(line_masks, ivec2(gl_GlobalInvocationID.xy), uvec4(0u));
}
