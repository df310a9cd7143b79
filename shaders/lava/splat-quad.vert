#version 450

// The splat of splat.geom where there is no geometry stage: four vertices for each instance.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/surface.glsl"

layout(location = 0) in vec2 place;

layout(location = 0) out vec2 disc;
layout(location = 1) out float eye_depth_m;
layout(location = 2) flat out vec3 center_m;

void main() {
    Splat splat = splat_at(place);
    disc = vec2(float(gl_VertexIndex & 1), float(gl_VertexIndex >> 1)) * 2.0 - 1.0;
    center_m = splat.center_m;
    gl_Position = scene.view_projection * vec4(corner_of(splat, disc), 1.0);
    eye_depth_m = gl_Position.w;
}
