// All meshes in one, or a piece of them, in world space but for the offset of their object.

#include "common/texels.glsl"
#include "gas/object.glsl"

// Of its vertices and its object.
struct Triangle {
    uvec3 vertices;
    uint object;
};

layout(set = 0, binding = 4, rgba32f) uniform readonly image2D vertices; // of each its place in m, then its unit normal

layout(set = 0, binding = 5, rgba32ui) uniform readonly uimage2D triangles; // each a Triangle

vec3 position_of(uint vertex) {
    return imageLoad(vertices, texel_of(2u * vertex)).xyz;
}

vec3 normal_of(uint vertex) {
    return imageLoad(vertices, texel_of(2u * vertex + 1u)).xyz;
}

Triangle triangle_at(uint triangle) {
    uvec4 words = imageLoad(triangles, texel_of(triangle));
    return Triangle(words.xyz, words.w);
}

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    Object objects[];
};
