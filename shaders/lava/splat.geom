#version 450

// A place of the surface into a splat: four vertices on its tangent plane (section 7.1). The thesis hands tangent,
// binormal, centre and vertex to the fragment stage; the vertex in units of the radius along both is the same.

#extension GL_EXT_samplerless_texture_functions : require

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

#include "lava/scene.glsl"
#include "lava/surface.glsl"

layout(location = 0) in vec2 place_m[];

layout(location = 0) out vec2 disc;
layout(location = 1) out float eye_depth_m;
layout(location = 2) flat out vec3 center_m;

void main() {
    Splat splat = splat_at(place_m[0]);
    for (int i = 0; i < 4; i++) {
        disc = vec2(float(i & 1), float(i >> 1)) * 2.0 - 1.0;
        gl_Position = scene.view_projection * vec4(corner_of(splat, disc), 1.0);
        eye_depth_m = gl_Position.w;
        center_m = splat.center_m;
        EmitVertex();
    }
    EndPrimitive();
}
