#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/land.glsl"
#include "terrain/mesh.glsl"

layout(location = 0) out vec4 depth;

void main() {
    float depth_m = 1.0 / gl_FragCoord.w;
    vec2 pixel = floor(gl_FragCoord.xy);
    vec3 direction = land.corner.xyz + pixel.x * land.across.xyz + pixel.y * land.down.xyz;
    vec2 place = land.eye.xy + depth_m * direction.xy;
    depth = vec4(depth_m, clamp(place, vec2(0.0), vec2(land.size.xy - 1)), surface_code(mesh.surface, 0));
}
