#version 450

// Every particle as a point in the simulation space (figure 5.2).

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"

layout(set = 0, binding = 1) uniform texture2D positions;

layout(push_constant, std430) uniform Points {
    uint width; // of the texture
    float size_px;
} points;

layout(location = 0) flat out float height_m;

void main() {
    uint index = uint(gl_VertexIndex);
    vec3 position_m = texelFetch(positions, ivec2(index % points.width, index / points.width), 0).xyz;
    height_m = position_m.y;
    gl_Position = scene.view_projection * vec4(position_m, 1.0);
    gl_PointSize = points.size_px;
}
