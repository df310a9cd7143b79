// All meshes in one, or a piece of them, in world space but for the offset of their object.

#include "gas/object.glsl"

struct Vertex {
    vec3 position; // m
    vec3 normal; // unit
};

// Of its vertices and its object; read as one vector, as links are.
struct Triangle {
    uvec3 vertices;
    uint object;
};

layout(set = 0, binding = 4, std430) readonly buffer Vertices {
    Vertex vertices[];
};

layout(set = 0, binding = 5, std430) readonly buffer Triangles {
    uvec4 triangles[]; // each a Triangle
};

Triangle triangle_at(uint triangle) {
    uvec4 words = triangles[triangle];
    return Triangle(words.xyz, words.w);
}

layout(set = 0, binding = 6, std430) readonly buffer Objects {
    Object objects[];
};
