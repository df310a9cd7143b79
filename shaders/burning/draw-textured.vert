#version 450

// A vertex of the mesh with its corner's own texture coordinate, which stays apart where corners are welded.

#include "burning/seen.glsl"

layout(set = 0, binding = 46, std430) readonly buffer TextureCoordinates {
    vec2 texture_coordinates[];
};

layout(location = 4) out vec2 texture_coordinate;

void main() {
    see(uint(gl_VertexIndex));
    texture_coordinate = texture_coordinates[gl_VertexIndex];
}
