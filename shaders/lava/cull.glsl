// Culling of splats (chapter 9): clusters of splats that follow each other, and those of their splats that may be seen.

const uint CLUSTER = 64u; // splats

layout(push_constant, std430) uniform Cull {
    vec3 eye_m;
    uint splats;
    uint clusters;
} cull;
