// All meshes in one, in world space but for the offset of their object.

#include "gas/object.glsl"

struct Vertex {
    vec4 position; // m
    vec4 normal;
};

layout(set = 0, binding = 4, std430) readonly buffer Vertices {
    Vertex vertices[];
};

layout(set = 0, binding = 5, std430) readonly buffer Triangles {
    uvec4 triangles[]; // three vertices, object
};

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    Object objects[];
};
